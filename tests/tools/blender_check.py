"""Plays baked files with Blender's own importer and compares joint positions with the tool's own, to 1 mm.

    pip install bpy; python blender_check.py FOLDER

Reads the FOLDER/*.pose.json that the tests write (see three_check.mjs). Bones and objects are found by node name: only
names that a file has once are compared. Run by hand.

Blender's importer (5.0) drops the tangents of CUBICSPLINE keys and joins their values by curves of continuous acceleration,
level at both ends. Surefoot's tangents are those of that curve, but where a foot lands or leaves: there 15 mm are let pass.
"""

import json
import struct
import sys
from collections import Counter
from pathlib import Path

import bpy
from mathutils import Vector


def limit(file: Path, clip: str) -> float:
    """Metres that a joint may be off."""
    data = file.read_bytes()
    gltf = json.loads(data[20 : 20 + struct.unpack_from("<I", data, 12)[0]])
    samplers = [s for a in gltf["animations"] if a.get("name") == clip for s in a["samplers"]]
    return 15e-3 if any(s.get("interpolation") == "CUBICSPLINE" for s in samplers) else 1e-3


def check(folder: Path, dump: dict) -> tuple[tuple[float, str], int]:
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
    worst, count = (0.0, ""), 0
    for sample in dump["samples"]:
        frame = sample["time"] * fps
        scene.frame_set(int(frame), subframe=frame - int(frame))
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
            worst = max(worst, (off, f"{name} at {sample['time']}"))
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
        good = count > 0 and worst[0] <= limit(folder / dump["file"], dump["clip"])
        bad += not good
        print(f"{path.name}: {'ok' if good else 'BAD'}: {worst[0] * 1000:.4f} mm at worst of {count} ({worst[1]})")
    print(f"{len(dumps)} files, {bad} bad")
    return 1 if bad or not dumps else 0


if __name__ == "__main__":
    sys.exit(main())
