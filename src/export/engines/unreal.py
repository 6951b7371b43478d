# Surefoot's contacts and events as Unreal's sync markers, notifies and float curves.
#
{{head}}
#
# Import the .glb, then in the editor (Python Editor Script plugin): select the animation sequence in the Content Browser and run
#   import surefoot_unreal; surefoot_unreal.mark_selected("C:/clips/hero_shove.events.json")
# A notify needs a class: make Animation Notify blueprints called AN_push_start, AN_foot_down, ... in NOTIFY_FOLDER; an event without one
# is told in the log and left out. Sync markers are what the Animation Blueprint's sync groups match.
"""Surefoot's contacts and events on animation sequences."""

import json

import unreal

NOTIFY_FOLDER = "/Game/Surefoot"
TRACK = "Surefoot"
FEET = {"left": "{{left}}", "right": "{{right}}"}


def mark_selected(sidecar):
    """Marks the selected animation sequences with the report of their name, or the only one that there is."""
    with open(sidecar, encoding="utf-8") as file:
        reports = json.load(file)
    for asset in unreal.EditorUtilityLibrary.get_selected_assets():
        if isinstance(asset, unreal.AnimSequence):
            name = str(asset.get_name())
            report = reports.get(name) or next((reports[clip] for clip in reports if name.endswith(clip)), None)
            if report is None and len(reports) == 1:
                report = next(iter(reports.values()))
            if report is None:
                unreal.log_warning(f"surefoot: {sidecar} tells nothing of {name}")
            else:
                mark(asset, report)


def mark(sequence, report):
    """Marks one sequence."""
    library = unreal.AnimationLibrary
    length = sequence.get_play_length()
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
