# Surefoot's contacts and events as markers of Blender's actions.
#
{{head}}
#
# blender --python surefoot_blender.py -- hero_shove.glb        imports the file and marks its clips
# or, of files that are imported already, in the text editor:   mark("/path/of/hero_shove.events.json")
# Markers stand on whole frames: Blender has no others. The times in action["surefoot"] are exact.
"""Surefoot's contacts and events as pose markers of actions."""

import json
import sys
from pathlib import Path

import bpy

FEET = {"left": "{{left}}", "right": "{{right}}"}


def moments(report):
    """Everything with a time, in its order: (seconds, name)."""
    found = []
    for event in report["events"]:
        foot = FEET.get(event.get("foot"))
        found.append((event["time"], f"{event['name']}_{foot}" if foot else event["name"]))
    for contact in report["contacts"]:
        found.append((contact["start"], f"contact_{contact['part']}_{FEET[contact['foot']]}"))
    return sorted(found)


def actions_of(clip):
    """The actions that the importer made of a clip: those of the NLA tracks of its name, or of that name."""
    found = [action for action in bpy.data.actions if action.name == clip]
    for owner in bpy.data.objects:
        tracks = owner.animation_data.nla_tracks if owner.animation_data else []
        found += [strip.action for track in tracks if track.name == clip for strip in track.strips if strip.action]
    return sorted(set(found), key=lambda action: action.name)


def mark(sidecar):
    """Marks the actions of every clip that a .events.json tells of; the number of markers."""
    render = bpy.context.scene.render
    rate = render.fps / render.fps_base
    count = 0
    for clip, report in json.loads(Path(sidecar).read_text(encoding="utf-8")).items():
        for action in actions_of(clip):
            for marker in list(action.pose_markers):
                action.pose_markers.remove(marker)
            for seconds, name in moments(report):
                action.pose_markers.new(name).frame = round(seconds * rate)
                count += 1
            action["surefoot"] = json.dumps(report)
    return count


def load(file):
    """Imports a baked file and marks its clips."""
    bpy.ops.import_scene.gltf(filepath=str(file))
    return mark(Path(file).with_suffix(".events.json"))


if __name__ == "__main__" and "--" in sys.argv:
    for given in sys.argv[sys.argv.index("--") + 1 :]:
        print(f"{given}: {load(given)} markers")
