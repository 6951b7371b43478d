"""Runs the helper that `--engine blender` writes, in Blender's Python module, and compares the markers with the sidecar.

    pip install bpy; python blender_engine_check.py FOLDER

FOLDER holds surefoot_blender.py and NAME.glb with NAME.events.json, as `surefoot bake --engine blender` writes them. Run by hand.
"""

import importlib.util
import json
import sys
from pathlib import Path

import bpy


def helper(folder: Path):
    spec = importlib.util.spec_from_file_location("surefoot_blender", folder / "surefoot_blender.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def check(module, file: Path, fps: int) -> list[str]:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.fps = fps
    problems = []
    count = module.load(file)
    reports = json.loads(file.with_suffix(".events.json").read_text())
    for clip, report in reports.items():
        actions = module.actions_of(clip)
        if not actions:
            problems.append(f"no action of {clip}")
        due = sorted(
            [(round(one["time"] * fps), one["name"].startswith("foot") and f"{one['name']}_{one['foot'][0].upper()}" or one["name"]) for one in report["events"]]
            + [(round(one["start"] * fps), f"contact_{one['part']}_{one['foot'][0].upper()}") for one in report["contacts"]]
        )
        for action in actions:
            found = sorted((marker.frame, marker.name) for marker in action.pose_markers)
            if found != due:
                problems.append(f"{action.name}: {found} instead of {due}")
            if json.loads(action["surefoot"]) != report:
                problems.append(f"{action.name}: the report is another one")
            # The keys that the markers stand beside: frame 0 is the clip's 0 s.
            first, last = action.frame_range
            if abs(first) > 0.01 or abs(last - report["duration"] * fps) > 0.6:
                problems.append(f"{action.name}: runs from {first} to {last}")
        if count != len(due) * len(actions):
            problems.append(f"{count} markers are told")
        if module.mark(file.with_suffix(".events.json")) != count:
            problems.append("marking again marks another number")
    return problems


def main() -> int:
    folder = Path(sys.argv[1])
    files = sorted(folder.glob("*.glb"))
    bad = 0
    for file in files:
        for fps in (24, 30, 60):
            problems = check(helper(folder), file, fps)
            bad += bool(problems)
            print(f"{file.name} at {fps} fps: {'BAD' if problems else 'ok'}", *problems, sep="\n  ")
    print(f"{len(files)} files, {bad} bad")
    return 1 if bad or not files else 0


if __name__ == "__main__":
    sys.exit(main())
