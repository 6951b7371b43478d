"""Plays baked files with Blender's own importer and compares joint positions with the tool's own, to 1 mm.

    pip install bpy; python blender_check.py FOLDER

Reads the FOLDER/*.pose.json that the tests write (see three_check.mjs); of corrected clips what was corrected is told apart. Bones and objects are found by node name: only
names that a file has once are compared. Run by hand.
"""

import json
import sys
from collections import Counter
from pathlib import Path

import bpy
from mathutils import Vector


def check(folder: Path, dump: dict) -> tuple[dict[str, tuple[float, str]], int]:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    fps = 240.0
    bpy.context.scene.render.fps = int(fps)
    bpy.ops.import_scene.gltf(filepath=str(folder / dump["file"]), bone_heuristic="BLENDER", guess_original_bind_pose=False)
    scene = bpy.context.scene
    counts = Counter(dump["names"])
    for owner in list(bpy.data.objects):
        if owner.animation_data:
            owner.animation_data.action = None
            # What another clip left behind is not glTF's: there, what has no channel rests.
            if owner.type == "ARMATURE":
                for bone in owner.pose.bones:
                    bone.matrix_basis.identity()
            # The importer stacks clips as strips that start at frame 1: play the clip's action itself.
            for track in owner.animation_data.nla_tracks:
                track.mute = True
                if track.name == dump["clip"] and track.strips:
                    owner.animation_data.action = track.strips[0].action
                    owner.animation_data.action_slot = track.strips[0].action_slot
    changed = dump.get("changed", [])  # s: where a clip was corrected, from the frame before to the frame after
    worst, count = {}, 0
    for sample in dump["samples"]:
        frame = sample["time"] * fps
        scene.frame_set(int(frame), subframe=frame - int(frame))
        where = "corrected" if any(a < sample["time"] < b for a, b in changed) else "as it was" if changed else ""
        places = {}
        for owner in bpy.data.objects:
            places.setdefault(owner.name, owner.matrix_world.translation)
            if owner.type == "ARMATURE":
                for bone in owner.pose.bones:
                    places[bone.name] = owner.matrix_world @ bone.head
        for node, x, y, z in sample["nodes"]:
            name = dump["names"][node]
            if not name or counts[name] > 1 or name not in places:
                continue
            off = (places[name] - Vector((x, -z, y))).length / dump["unit"]  # Blender is Z-up
            count += 1
            worst[where] = max(worst.get(where, (0.0, "")), (off, f"{name} at {sample['time']:.4f}"))
    return worst, count


def main() -> int:
    folder = Path(sys.argv[1])
    bad = 0
    dumps = sorted(folder.glob("*.pose.json"))
    for path in dumps:
        dump = json.loads(path.read_text())
        if not any(dump["names"]):
            print(f"{path.name}: skipped: no node has a name")
            continue
        worst, count = check(folder, dump)
        good = count > 0 and all(off <= 1e-3 for off, _ in worst.values())
        bad += not good
        told = ", ".join(f"{where} {off * 1000:.4f} mm ({at})".strip() for where, (off, at) in sorted(worst.items()))
        print(f"{path.name}: {'ok' if good else 'BAD'}: at worst of {count}: {told}")
    print(f"{len(dumps)} files, {bad} bad")
    return 1 if bad or not dumps else 0


if __name__ == "__main__":
    sys.exit(main())
