"""Runs the helper that `--engine blender` writes, in Blender's Python module: what is active after it, and the markers against the sidecar.

    python3.11 -m venv B; B/bin/pip install "bpy==4.5.*"; B/bin/python blender_engine_check.py FOLDER

FOLDER holds surefoot_blender.py and NAME.glb with NAME.events.json, as `surefoot bake --engine blender` writes them. Each at 24, 25, 30 and 60
frames a second: of a scene that has animation already and keeps its rate, and asked for; and in a new scene, which takes the clip's. Each file
is imported twice, and written as FBX: one take for each armature and clip, none of a helper object. And a copy without meshes is put onto
the armature that was imported from the whole file: its bones are where they are after an import of the whole.
"""

import contextlib
import importlib.util
import io
import json
import logging
import re
import sys
import tempfile
from pathlib import Path

import bpy

logging.disable(logging.INFO)  # what the importer tells of each mesh
RATES = (24, 25, 30, 60)


def helper(folder: Path):
    spec = importlib.util.spec_from_file_location("surefoot_blender", folder / "surefoot_blender.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def takes(path: Path) -> list[str]:
    """The names of the animation stacks of a binary FBX."""
    found = re.findall(rb"S....([^\x00]{1,200}?)\x00\x01AnimStack", path.read_bytes(), re.S)
    return sorted(name.decode() for name in found)


def due_of(report: dict, fps: float) -> list[tuple[int, str]]:
    events = [(one["time"], f"{one['name']}_{one['foot'][0].upper()}" if "foot" in one else one["name"]) for one in report["events"]]
    contacts = [(one["start"], f"contact_{one['part']}_{one['foot'][0].upper()}") for one in report["contacts"]]
    return sorted((round(time * fps), name) for time, name in events + contacts)


def check(module, file: Path, fps: int, way: str) -> list[str]:
    """`way`: "new" scene, "asked" for fps, or a scene that "has" animation at fps."""
    bpy.ops.wm.read_factory_settings()
    if way == "has":
        bpy.context.scene.render.fps = fps
        bpy.data.objects["Cube"].keyframe_insert("location", frame=1)
    reports = json.loads(file.with_suffix(".events.json").read_text())
    rate = fps if way != "new" else round(list(reports.values())[-1]["fps"])
    problems = []
    there = set(bpy.data.objects)
    count = module.load(file, fps) if way == "asked" else module.load(file)
    scene = bpy.context.scene
    if scene.render.fps / scene.render.fps_base != rate:
        problems.append(f"the scene has {scene.render.fps} fps, not {rate}")
    total = 0
    for clip, report in reports.items():
        actions = module.actions_of(clip)
        if len(actions) != 1:
            problems.append(f"{len(actions)} actions of {clip}")
        due = due_of(report, rate)
        for action in actions:
            total += len(due)
            found = sorted((marker.frame, marker.name) for marker in action.pose_markers)
            if found != due:
                problems.append(f"{action.name}: {found} instead of {due}")
            if json.loads(action["surefoot"]) != report:
                problems.append(f"{action.name}: the report is another one")
            # The keys that the markers stand beside: frame 0 is the clip's 0 s.
            first, last = action.frame_range
            if abs(first) > 0.01 or abs(last - report["duration"] * rate) > 0.01:
                problems.append(f"{action.name}: runs from {first} to {last}")
    problems += shown(module, list(reports.items())[-1], [one for one in bpy.data.objects if one not in there], rate)
    if count != total:
        problems.append(f"{count} markers are told")
    if module.mark(file.with_suffix(".events.json")) != count:
        problems.append("marking again marks another number")
    return problems + written(module, file, fps if way == "asked" else None)


def shown(module, last: tuple[str, dict], new: list, rate: float) -> list[str]:
    """What is active, the frame range, and where the travel is."""
    clip, report = last
    problems = []
    action = module.actions_of(clip)[-1]
    armatures = [one for one in new if one.type == "ARMATURE"]
    if not armatures:
        problems.append("no armature")
    for owner in armatures:
        data = owner.animation_data
        if data is None or data.action != action or data.action_slot is None:
            problems.append(f"{owner.name} shows {data and data.action}")
    if module.CONTACT and any(module.CONTACT.match(one.name) for one in bpy.data.objects):
        problems.append("contact nodes are there")
    scene = bpy.context.scene
    if (scene.frame_start, scene.frame_current) != (0, 0) or abs(scene.frame_end - report["duration"] * rate) >= 1:
        problems.append(f"the scene runs from {scene.frame_start} to {scene.frame_end}")
    moved = [one.name for one in new if one.type != "ARMATURE" and one.animation_data and one.animation_data.action]
    if report["root_motion"] == "root" and any(one.children_recursive for one in map(bpy.data.objects.get, moved)):
        problems.append(f"{moved} travel outside of the armature")
    if report["root_motion"] == "root" and report["steps"] > 0 and armatures:
        roots = [bone for bone in armatures[0].pose.bones if bone.parent is None]
        scene.frame_set(0)
        before = [(armatures[0].matrix_world @ bone.head).copy() for bone in roots]
        scene.frame_set(scene.frame_end)
        if max((armatures[0].matrix_world @ bone.head - at).length for bone, at in zip(roots, before)) < 0.02:
            problems.append("no bone at the top of the armature travels")
        scene.frame_set(0)
    return problems


def written(module, file: Path, fps) -> list[str]:
    """A second import, then an FBX of all: takes of armatures alone."""
    module.load(file, fps)
    names = {one.name for one in bpy.data.objects if one.type == "ARMATURE"}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "out.fbx"
        with contextlib.redirect_stdout(io.StringIO()):
            bpy.ops.export_scene.fbx(filepath=str(path), object_types={"ARMATURE", "EMPTY"})
        found = takes(path)
    strange = [name for name in found if name.split("|")[0] not in names]
    clips = json.loads(file.with_suffix(".events.json").read_text())
    lacking = [clip for clip in clips if not any(name.split("|")[-1] == clip for name in found)]
    return [f"takes of no armature: {strange}"] * bool(strange) + [f"no take of {lacking}: {found}"] * bool(lacking)


def without_meshes(file: Path, copy: Path) -> None:
    """The file's skeleton and clips: skins stay, or Blender would make no armature."""
    data = file.read_bytes()
    length = int.from_bytes(data[12:16], "little")
    told = json.loads(data[20 : 20 + length])
    for name in ("meshes", "materials", "textures", "images", "samplers"):
        told.pop(name, None)
    for node in told["nodes"]:
        node.pop("mesh", None)
        node.pop("skin", None)
    text = json.dumps(told).encode()
    text += b" " * (-len(text) % 4)
    parts = [text, data[20 + length :]]
    words = [b"glTF", (2).to_bytes(4, "little"), (20 + sum(map(len, parts))).to_bytes(4, "little"), len(text).to_bytes(4, "little"), b"JSON"]
    copy.write_bytes(b"".join(words + parts))
    copy.with_suffix(".events.json").write_bytes(file.with_suffix(".events.json").read_bytes())


def heads(armature, frames: list[int]) -> list:
    found = []
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        found.append({bone.name: (armature.matrix_world @ bone.head).copy() for bone in armature.pose.bones})
    return found


def check_onto(module, file: Path) -> list[str]:
    """The clip of a file without meshes on the armature of the whole one."""
    bpy.ops.wm.read_factory_settings()
    module.load(file)
    armature = next(one for one in bpy.data.objects if one.type == "ARMATURE")
    frames = list(range(0, bpy.context.scene.frame_end + 1, 5))
    due = heads(armature, frames)
    armature.animation_data.action = None
    for bone in armature.pose.bones:
        bone.matrix_basis.identity()
    there = set(bpy.data.objects)
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / file.name
        without_meshes(file, copy)
        module.load(copy, onto=armature.name)
    problems = [f"{one.name} is left" for one in bpy.data.objects if one not in there]
    off = max((now[name] - place).length for was, now in zip(due, heads(armature, frames)) for name, place in was.items())
    return problems + [f"a bone is {off * 1000:.3f} mm off"] * (off > 1e-4)


def main() -> int:
    folder = Path(sys.argv[1])
    files = [file for file in sorted(folder.glob("*.glb")) if file.with_suffix(".events.json").exists()]
    bad = 0
    for file in files:
        for fps, way in [(30, "new"), *((fps, way) for fps in RATES for way in ("asked", "has"))]:
            problems = check(helper(folder), file, fps, way)
            bad += bool(problems)
            what = {"new": "in a new scene", "asked": f"asked for {fps} fps", "has": f"beside animation at {fps} fps"}[way]
            print(f"{file.name} {what}: {'BAD' if problems else 'ok'}", *problems, sep="\n  ")
        problems = check_onto(helper(folder), file)
        bad += bool(problems)
        print(f"{file.name} onto an armature that is there: {'BAD' if problems else 'ok'}", *problems, sep="\n  ")
    print(f"Blender {bpy.app.version_string}: {len(files)} files, {bad} bad")
    return 1 if bad or not files else 0


if __name__ == "__main__":
    sys.exit(main())
