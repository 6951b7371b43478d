"""Plays baked files in Blender as it is when it is opened: factory settings, 24 frames a second, the importer's own defaults.

    python3.11 -m venv B; B/bin/pip install "bpy==4.5.*"; B/bin/python blender_check.py FOLDER [NAME ...] [--fps 24]

Every clip with a report, every 10 ms (frames and parts of frames), after the file's other clips: each joint within 1 mm of what the file says
(gltf_reference.py), and a joint of a planted foot moves at most 1 mm more than in the file. One process for all files. NAME: a part of the
names of those to check. Exit code 1 where one is BAD, or where no foot is planted in any.
"""

import argparse
import json
import logging
import sys
import tempfile
import time
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
from gltf_reference import Glb, compare  # noqa: E402

BOUND = 1e-3  # m, of every joint, and of a planted foot beyond the file's own motion
logging.disable(logging.INFO)  # what the importer tells of each mesh


def named_copy(glb: Glb, path: Path, folder: Path) -> Path:
    """The file with its nodes called n0, n1, ...: names can be missing, twice there, or too long for Blender."""
    told = json.loads(json.dumps(glb.json))
    for index, node in enumerate(told["nodes"]):
        node["name"] = f"n{index}"
    text = json.dumps(told).encode()
    text += b" " * (-len(text) % 4)
    data = path.read_bytes()
    rest = data[20 + int.from_bytes(data[12:16], "little") :]
    copy = folder / "played.glb"
    length = 20 + len(text) + len(rest)
    copy.write_bytes(b"glTF" + (2).to_bytes(4, "little") + length.to_bytes(4, "little") + len(text).to_bytes(4, "little") + b"JSON" + text + rest)
    return copy


def load(file: Path, fps: float) -> None:
    """A new Blender with the file in it."""
    bpy.ops.wm.read_factory_settings()
    for one in list(bpy.data.objects):  # the factory's cube, light and camera
        bpy.data.objects.remove(one)
    if fps != 24:
        bpy.context.scene.render.fps = int(fps)
    assert bpy.context.scene.render.fps == int(fps)
    bpy.ops.import_scene.gltf(filepath=str(file))
    for one in bpy.data.objects:
        one.modifiers.clear()  # skinning the mesh at every sample only costs time


def play(clip: str) -> bool:
    """Makes a clip the one that is shown, as a click on its action does: nothing is reset first."""
    shown = False
    for owner in bpy.data.objects:
        tracks = owner.animation_data.nla_tracks if owner.animation_data else []
        for track in tracks:
            track.mute = True
        # The importer's NLA tracks carry the clips' names; their actions may be cut short or numbered.
        strips = [track.strips[0] for track in tracks if track.name == clip and track.strips]
        if owner.animation_data:
            owner.animation_data.action = strips[0].action if strips else None
        if strips:
            owner.animation_data.action_slot = strips[0].action_slot
            shown = True
    return shown


def sampled(joints: list[int], times: np.ndarray) -> dict[int, np.ndarray]:
    """World positions of the joints, in glTF's axes."""
    scene = bpy.context.scene
    rate = scene.render.fps / scene.render.fps_base
    bones = {bone.name: (owner, bone) for owner in bpy.data.objects if owner.type == "ARMATURE" for bone in owner.pose.bones}
    found = {joint: np.full((len(times), 3), np.nan) for joint in joints}
    for at, moment in enumerate(times):
        frame = moment * rate
        whole = int(frame + 1e-9)
        scene.frame_set(whole, subframe=max(frame - whole, 0.0))
        for joint in joints:
            owner, bone = bones.get(f"n{joint}", (bpy.data.objects.get(f"n{joint}"), None))
            if owner:
                x, y, z = owner.matrix_world @ bone.head if bone else owner.matrix_world.translation
                found[joint][at] = (x, z, -y)  # Blender is Z-up
    return found


def check(path: Path, fps: float, folder: Path) -> tuple[list[str], int]:
    """What is wrong with a file, and how many spans of planted joints it has; prints its lines."""
    glb = Glb(path)
    dump = path.with_name(path.name + ".pose.json")
    unit = json.loads(dump.read_text())["unit"] if dump.exists() else 1.0
    clips = glb.clips()
    if not clips:
        print(f"{path.name}: BAD: no clip with a report")
        return ["no clip with a report"], 0
    load(named_copy(glb, path, folder), fps)
    joints, problems, planted = glb.joints(), [], 0
    others = [clip.get("name", "") for at, clip in enumerate(glb.json["animations"]) if at not in [one[0] for one in clips]]
    for index, name, report in clips:
        for other in others:
            play(other)
            bpy.context.scene.frame_set(7)
        times = glb.times(index)
        if not play(name):
            print(f"{path.name}: BAD: no action of {name}")
            problems.append(name)
            continue
        told = compare(report, joints, times, glb.places(index, times), sampled(joints, times), unit)
        good = told["off"] <= BOUND and told["more"] <= BOUND
        line = f"{name}: {told['off'] * 1000:.3f} mm at worst of {len(joints)} joints ({told['at']}); planted {told['planted']}: "
        line += f"{told['slid'] * 1000:.3f} mm, {told['more'] * 1000:.3f} beyond the file's ({told['slid_at']})"
        print(f"{path.name}: {'ok' if good else 'BAD'}: {line}", flush=True)
        planted += told["planted"]
        if not good:
            problems.append(name)
    return problems, planted


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--fps", type=float, default=24.0)
    asked = parser.parse_args()
    files = [path for path in sorted(asked.folder.glob("*.glb")) if not asked.names or any(name in path.name for name in asked.names)]
    bad, planted, started = 0, 0, time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        for path in files:
            problems, spans = check(path, asked.fps, Path(folder))
            bad += bool(problems)
            planted += spans
    told = f"Blender {bpy.app.version_string} at {asked.fps:g} fps: {len(files)} files, {bad} bad, {planted} planted"
    print(f"{told}, {time.monotonic() - started:.0f} s")
    return 1 if bad or not planted else 0


if __name__ == "__main__":
    sys.exit(main())
