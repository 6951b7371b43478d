"""Runs what can be run of the helpers for Godot and Unreal without the engines: how they find a clip by its name, and what is called.

    python3 engine_names_check.py FOLDER

FOLDER holds surefoot_godot.gd, surefoot_unreal.py and NAME.events.json, as `surefoot bake --engine godot,unreal` writes them. The two functions of
the Godot helper that tell a clip's name are turned into Python line by line and held against the importer's rules (GLTFDocument::_sanitize_animation_name
and ResourceImporterScene::_pre_fix_node of Godot 4.4 and of master, November 2025; written here from reading them). The Unreal helper runs whole, against
a module `unreal` that keeps what it is told.
"""

import json
import re
import sys
import types
from pathlib import Path


class Text(str):
    """A String of GDScript: the methods that the helper calls."""

    def __add__(self, other):
        return Text(str(self) + other)

    def __radd__(self, other):
        return Text(other + str(self))

    def replace(self, old, new):
        return Text(str.replace(self, old, new))

    def rstrip(self, letters):
        return Text(str.rstrip(self, letters))

    def length(self):
        return len(self)

    def substr(self, start):
        return Text(self[start:])

    def left(self, count):
        return Text(self[:count])

    def findn(self, what):
        return self.lower().find(what.lower())

    def to_lower(self):
        return Text(self.lower())

    def ends_with(self, what):
        return self.endswith(what)

    def validate_node_name(self):
        return Text(re.sub(r'[.:@/"%]', "_", self))


class Names(list):
    def has(self, one):
        return one in self


def godot_functions(script: str) -> dict:
    """clip_names and without_loop of the helper, as Python."""
    lines, kept = [], False
    for line in script.splitlines():
        if not line.startswith("\t"):
            kept = line.startswith(("static func clip_names", "static func without_loop"))
        if kept and line.strip():
            lines.append(line)
    text = "\n".join(lines)
    text = re.sub(r"static func (\w+)\((\w+): \w+\) -> \w+:", r"def \1(\2):", text)
    text = re.sub(r"\bvar (\w+) :?= ", r"\1 = ", text)
    text = re.sub(r"\bfor (\w+): \w+ in", r"for \1 in", text)
    text = re.sub(r'"([^"]*)"', r'Text("\1")', text)
    found = {"Text": Text, "PackedStringArray": Names}
    exec(text, found)  # noqa: S102 the tests' own file
    return found


def stripped(name: str, word: str) -> str:
    """The importer: a name without a loop's suffix, or as it is."""
    stem = re.sub(r"[\s\d_]+$", "", name)
    tail = name[len(stem) :]
    if ("$" + word) in stem.lower():
        return stem.replace("$" + word, "") + tail
    if stem.lower().endswith(("-" + word, "_" + word)):
        return stem[: -len(word) - 1] + tail
    return name


def imported(clips: list[str], stand_in: str) -> dict[str, str]:
    """The importer: what each clip of a file is called afterwards."""
    names = {}
    for clip in clips:
        name = re.sub(r'[.:@/"%]', "_", clip).replace(",", stand_in).replace("[", stand_in)
        count, own = 2, name
        while own in names.values():
            own, count = f"{name}{count}", count + 1
        names[clip] = own
    for clip in clips:
        own = names[clip]
        for word in ("loop_mode", "loop", "cycle"):
            own = stripped(own, word)
        # A rename to a name that is taken is refused.
        if own not in names.values():
            names[clip] = own
    return names


FILES = [
    ["steady_walk_loop"],
    ["steady_walk_loop", "steady_walk"],
    ["steady_walk", "steady_walk_loop", "walk-cycle", "Walk-Loop", "a_loop_mode"],
    ["shove", "big_shove", "shove_2", "walk_loop_2", "walk_loop2"],
    ["take.001", "take@2", "50%", "a/b", "a:c", 'say "no"', "a, b", "left[1]", "idle[2]_loop"],
    ["loop", "cycle", "looped", "loop_walk", "_loop", "x$loop"],
    ["Übergang_loop", "走る_loop", "naïve"],
]


def check_godot(script: str) -> list[str]:
    functions = godot_functions(script)
    problems = []
    for stand_in, version in [("", "4.4"), ("_", "4.5")]:
        for clips in FILES:
            there = imported(clips, stand_in)
            taken = set()
            for clip in clips:
                found = next((name for name in functions["clip_names"](Text(clip)) if name in there.values() and name not in taken), None)
                taken.add(found)
                if found != there[clip]:
                    problems.append(f"Godot {version}: {clip} of {clips} is {there[clip]}, found {found}")
    return problems


class Recorder:
    """Stands for the module unreal: keeps the calls."""

    def __init__(self, selected):
        self.calls, self.told = [], []
        self.AnimSequence = Sequence
        self.RawCurveTrackTypes = types.SimpleNamespace(RCT_FLOAT=0)
        self.EditorUtilityLibrary = types.SimpleNamespace(get_selected_assets=lambda: selected)
        self.EditorAssetLibrary = types.SimpleNamespace(
            does_asset_exist=lambda path: path.endswith("AN_push_start"),
            load_blueprint_class=lambda path: path,
            save_loaded_asset=lambda asset: self.calls.append(("save", asset.name)) or True,
        )
        self.AnimationLibrary = self
        self.log = self.log_warning = self.told.append

    def get_sequence_length(self, sequence):
        return sequence.length

    def get_animation_notify_track_names(self, sequence):
        return ["Surefoot"]

    def does_curve_exist(self, *_):
        return False

    def __getattr__(self, name):
        return lambda *words: self.calls.append((name, *words))


class Sequence:
    def __init__(self, name, length):
        self.name, self.length, self.properties = name, length, {}

    def get_name(self):
        return self.name

    def set_editor_property(self, name, value):
        self.properties[name] = value


def unreal_helper(script: Path, selected: list):
    sys.modules["unreal"] = recorder = Recorder(selected)
    helper = types.ModuleType("surefoot_unreal")
    exec(compile(script.read_text(encoding="utf-8"), script.name, "exec"), helper.__dict__)  # noqa: S102
    return helper, recorder


def check_unreal(script: Path, sidecar: Path) -> list[str]:
    problems = []
    helper, _ = unreal_helper(script, [])
    many = {"shove": 1, "big_shove": 2, "walk.loop": 3}
    for name, clip in [
        ("Hero_big_shove", "big_shove"),
        ("Hero_shove", "shove"),
        ("SHOVE", "shove"),
        ("Hero_walk_loop", "walk.loop"),
        ("overshove", None),
        ("Hero_Anim", None),
    ]:
        found = helper.report_of(name, many)
        if (found and found[0]) != clip:
            problems.append(f"Unreal: {name} got {found}, not {clip}")
    if helper.report_of("Hero_Anim", {"shove": 1}) != ("shove", 1):
        problems.append("Unreal: the only report is not taken")
    clip, report = next(iter(json.loads(sidecar.read_text(encoding="utf-8")).items()))
    ours, short, other = Sequence(f"Hero_{clip}", report["duration"] + 0.02), Sequence(f"Hero_{clip}", 0.5), object()
    helper, recorder = unreal_helper(script, [ours, short, other])
    helper.mark_selected(sidecar)
    marks = [call for call in recorder.calls if call[0] == "add_animation_sync_marker"]
    if len(marks) != sum(event["name"] == "foot_down" for event in report["events"]) or any(call[1] is not ours for call in marks):
        problems.append(f"Unreal: {len(marks)} sync markers")
    if [call for call in recorder.calls if call[0] == "save"] != [("save", ours.name)]:
        problems.append("Unreal: not saved once")
    if not any("not marked" in line for line in recorder.told):
        problems.append("Unreal: a sequence of another length is not told")
    if ours.properties != ({"enable_root_motion": True} if report["root_motion"] == "root" else {}):
        problems.append(f"Unreal: {ours.properties}")
    for foot in ("left", "right"):
        times, values = helper.steps(report["contacts"], foot, ours.length)
        inside = [one for one in report["contacts"] if one["foot"] == foot]
        for at, value in zip(times, values):
            within = any(one["start"] - 1e-9 <= at <= one["end"] + 1e-9 for one in inside)
            if within != (value == 1.0):
                problems.append(f"Unreal: FootContact of {foot} is {value} at {at}")
    return problems


def main() -> int:
    folder = Path(sys.argv[1])
    problems = check_godot((folder / "surefoot_godot.gd").read_text(encoding="utf-8"))
    problems += check_unreal(folder / "surefoot_unreal.py", sorted(folder.glob("*.events.json"))[0])
    print(f"helpers for Godot and Unreal: {'BAD' if problems else 'ok'}", *problems, sep="\n  ")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
