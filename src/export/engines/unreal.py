# Surefoot's contacts and events as Unreal's sync markers, notifies and float curves.
#
{{head}}
#
# Import the .glb or the .fbx, then in the editor (Python Editor Script plugin): select the animation sequences in the Content Browser and run
#   import surefoot_unreal; surefoot_unreal.mark_selected("C:/clips/hero_shove.events.json")
# A sequence gets the report of the longest clip name that its own name is or ends with, and is saved. One whose length is another is told in the
# log and left alone; mark(sequence, report) marks it all the same.
# A notify needs a class: make Animation Notify blueprints called AN_push_start, AN_foot_down, ... in NOTIFY_FOLDER; an event without one
# is told in the log and left out. Sync markers are what the Animation Blueprint's sync groups match.
# Run with a stand-in for the module unreal: report_of, steps, and which calls are made. Read in Unreal's documentation only: the calls themselves.
"""Surefoot's contacts and events on animation sequences."""

import json
import re

import unreal

NOTIFY_FOLDER = "/Game/Surefoot"
TRACK = "Surefoot"
FEET = {"left": "{{left}}", "right": "{{right}}"}
SAME_LENGTH = 0.1  # s; the importer ends a clip on a whole frame


def plain(name):
    """As asset names are: the importer writes "_" for what they cannot hold, and case does not count."""
    return re.sub(r"\W", "_", name).casefold()


def report_of(name, reports):
    """The clip and report for a sequence of that name: the longest clip name that it is or ends with, else the only one; or None."""
    fits = [clip for clip in reports if ("_" + plain(name)).endswith("_" + plain(clip))]
    if not fits and len(reports) == 1:
        fits = list(reports)
    clip = max(fits, key=len, default=None)
    return None if clip is None else (clip, reports[clip])


def mark_selected(sidecar):
    """Marks the selected animation sequences with their reports, and saves them."""
    with open(sidecar, encoding="utf-8") as file:
        reports = json.load(file)
    for asset in unreal.EditorUtilityLibrary.get_selected_assets():
        if not isinstance(asset, unreal.AnimSequence):
            continue
        name = str(asset.get_name())
        clip, report = report_of(name, reports) or (None, None)
        length = unreal.AnimationLibrary.get_sequence_length(asset)
        if report is None:
            unreal.log_warning(f"surefoot: {sidecar} tells nothing of {name}")
        elif abs(length - report["duration"]) > SAME_LENGTH:
            unreal.log_warning(f"surefoot: {name} is {length:.2f} s long and {clip} {report['duration']:.2f} s: not marked")
        else:
            mark(asset, report)
            unreal.log(f"surefoot: {name} has the contacts and events of {clip}")


def mark(sequence, report):
    """Marks one sequence and saves it."""
    library = unreal.AnimationLibrary
    length = library.get_sequence_length(sequence)
    if TRACK in [str(name) for name in library.get_animation_notify_track_names(sequence)]:
        library.remove_animation_sync_markers_by_track(sequence, TRACK)
        library.remove_animation_notify_track(sequence, TRACK)
    library.add_animation_notify_track(sequence, TRACK)
    for event in report["events"]:
        time = min(event["time"], length)
        if event["name"] == "foot_down":
            library.add_animation_sync_marker(sequence, FEET[event["foot"]], time, TRACK)
        notify = f"{NOTIFY_FOLDER}/AN_{event['name']}"
        if unreal.EditorAssetLibrary.does_asset_exist(notify):
            notify_class = unreal.EditorAssetLibrary.load_blueprint_class(notify)
            library.add_animation_notify_event(sequence, TRACK, time, notify_class)
        elif event["name"] != "foot_down":
            unreal.log(f"surefoot: there is no {notify}: no notify at {time:.3f} s")
    for foot, name in FEET.items():
        curve = f"FootContact_{name}"
        times, values = steps(report["contacts"], foot, length)
        if library.does_curve_exist(sequence, curve, unreal.RawCurveTrackTypes.RCT_FLOAT):
            library.remove_curve(sequence, curve)
        library.add_curve(sequence, curve, unreal.RawCurveTrackTypes.RCT_FLOAT, False)
        library.add_float_curve_keys(sequence, curve, times, values)
    if report["root_motion"] == "root":
        sequence.set_editor_property("enable_root_motion", True)
    if not unreal.EditorAssetLibrary.save_loaded_asset(sequence):
        unreal.log_warning(f"surefoot: {sequence.get_name()} could not be saved")


def steps(contacts, foot, length):
    """1 while any part of the foot is on the ground, 0 else, in steps of a millisecond (keys are joined by lines)."""
    spans = []
    for contact in sorted((one for one in contacts if one["foot"] == foot), key=lambda one: one["start"]):
        if spans and contact["start"] <= spans[-1][1] + 1e-3:
            spans[-1][1] = max(spans[-1][1], contact["end"])
        else:
            spans.append([contact["start"], contact["end"]])
    keys = {0.0: 0.0}
    for start, end in spans:
        if start > 1e-3:
            keys[start - 1e-3] = 0.0
        keys[start] = 1.0
        keys[min(end, length)] = 1.0
        if end < length - 1e-3:
            keys[end + 1e-3] = 0.0
    times = sorted(keys)
    return times, [keys[time] for time in times]
