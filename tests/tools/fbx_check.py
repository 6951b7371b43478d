"""Written FBX files in Blender, imported at their defaults by both of its importers into its default scene (24 fps).

    python3.11 tests/tools/fbx_check.py [FILE.fbx ..]     # without names: all of target/fbx

The python needs `pip install bpy==4.5.*`. `cargo test fbx_out` writes the files, and beside each what it must show: the take's name
and rate, its bones, and where they are on every frame (the file's metres, Y up; "units" of them are a metre of the body). Held: joints
within 0.5 mm, every bone there under its name, one object at the top, actions with the take's name, the scene at the take's rate.
"""

import json
import sys
from pathlib import Path

import bpy
from mathutils import Vector

NEAR = 0.5e-3  # m
FIRST = 1  # the frame on which the importer puts time 0


# File > Import > FBX, and what its menu calls legacy.
IMPORTERS = {"fbx_import": bpy.ops.wm, "fbx": bpy.ops.import_scene}


def check(path, importer):
    """Sentences of what is wrong, and the farthest joint in m."""
    told = json.loads(path.with_suffix(".json").read_text())
    bpy.ops.wm.read_factory_settings(use_empty=True)
    getattr(IMPORTERS[importer], importer)(filepath=str(path))
    scene = bpy.context.scene
    faults = []
    rate = scene.render.fps / scene.render.fps_base
    if abs(rate - told["fps"]) > 1e-3:
        faults.append(f"the scene plays at {rate} fps, not {told['fps']}")
    objects = list(bpy.data.objects)
    found = {bone.name for owner in objects if owner.type == "ARMATURE" for bone in owner.pose.bones}
    found |= {owner.name for owner in objects}
    missing = [name for name in told["bones"] if name not in found]
    if missing:
        faults.append(f"not there: {missing[:5]}")
    tops = [owner.name for owner in objects if owner.parent is None]
    if len(tops) != 1:
        faults.append(f"{len(tops)} objects at the top: {tops[:5]}")
    actions = [action.name for action in bpy.data.actions]
    if not actions or not all(told["take"] in name for name in actions):
        faults.append(f"actions {actions}: the take is {told['take']}")
    worst = (0.0, "")
    for frame, places in enumerate(told["frames"]):
        scene.frame_set(FIRST + frame)
        at = {owner.name: owner.matrix_world.translation for owner in objects}
        for owner in objects:
            if owner.type == "ARMATURE":
                at.update((bone.name, owner.matrix_world @ bone.head) for bone in owner.pose.bones)
        for name, (x, y, z) in zip(told["names"], places):
            if name in at:
                off = (at[name] - Vector((x, -z, y))).length / told["units"]
                worst = max(worst, (off, f"{name} on frame {frame}"))
    if not worst[0] <= NEAR:
        faults.append(f"a joint is {worst[0] * 1e3:.3f} mm off: {worst[1]}")
    return faults, worst


def main():
    folder = Path(__file__).resolve().parents[2] / "target" / "fbx"
    paths = [Path(name) for name in sys.argv[1:]] or sorted(folder.glob("*.fbx"))
    if not paths:
        print(f"{folder} is empty: run `cargo test fbx_out` first")
        return 1
    bad = 0
    for importer, path in ((importer, path) for importer in IMPORTERS for path in paths):
        faults, worst = check(path, importer)
        bad += bool(faults)
        line = f"{importer} {path.name}: {worst[0] * 1e3:.4f} mm at most ({worst[1]})"
        print(line + "".join(f"\n  FAULT {fault}" for fault in faults))
    print(f"Blender {bpy.app.version_string}: {len(paths)} files by {len(IMPORTERS)} importers, {bad} with faults")
    return 1 if bad else 0


sys.exit(main())
