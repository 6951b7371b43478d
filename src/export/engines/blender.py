# Surefoot's contacts and events as markers of Blender's actions, and the clip made the one that is shown.
#
{{head}}
#
# blender --python surefoot_blender.py -- hero_shove.glb        imports the file, marks its clips and shows the last of them
# or, of files that are imported already, in the text editor:   mark("/path/of/hero_shove.events.json"); show("hero_shove")
# of a clip for a character that is there:                      load("/path/of/hero_shove.glb", onto="Armature")
# A scene without animation takes the clip's frame rate (or yours: load(file, fps=24)); one that has some keeps its own. The frame range
# becomes the clip's. The objects contact_L and contact_R go: each would be a take of its own in an FBX; the markers say the same.
# Markers stand on whole frames: Blender has no others. The times in action["surefoot"] are exact.
"""Surefoot's contacts and events as pose markers of actions."""

import json
import math
import re
import sys
from pathlib import Path

import bpy

FEET = {"left": "{{left}}", "right": "{{right}}"}
CONTACT = re.compile(r"contact_[LR](\.\d{3,})?$")
SHORTEST_CUT = 60  # bytes; from there on a name may be the beginning of a clip's: 4.5 cuts at 63


def moments(report):
    """Everything with a time, in its order: (seconds, name)."""
    found = []
    for event in report["events"]:
        foot = FEET.get(event.get("foot"))
        found.append((event["time"], f"{event['name']}_{foot}" if foot else event["name"]))
    for contact in report["contacts"]:
        found.append((contact["start"], f"contact_{contact['part']}_{FEET[contact['foot']]}"))
    return sorted(found)


def named(name, clip):
    """Whether Blender calls a clip so: as it is, or cut short."""
    return name == clip or (len(name.encode()) >= SHORTEST_CUT and clip.startswith(name))


def strips_of(clip, owners=None):
    """(owner, strip) of the NLA tracks that the importer made of a clip."""
    for owner in bpy.data.objects if owners is None else owners:
        for track in owner.animation_data.nla_tracks if owner.animation_data else []:
            if named(track.name, clip):
                yield from ((owner, strip) for strip in track.strips if strip.action)


def actions_of(clip):
    """The actions that the importer made of a clip: those of the NLA tracks of its name, or of that name."""
    found = [action for action in bpy.data.actions if named(action.name, clip)]
    found += [strip.action for _, strip in strips_of(clip)]
    return sorted(set(found), key=lambda action: action.name)


def rate_of(action, report):
    """Frames a second that the action's keys stand at: the importer's, whatever the scene has now."""
    render = bpy.context.scene.render
    last = action.frame_range[1]
    return last / report["duration"] if last > 0 and report["duration"] > 0 else render.fps / render.fps_base


def mark(sidecar):
    """Marks the actions of every clip that a .events.json tells of; the number of markers."""
    count = 0
    for clip, report in json.loads(Path(sidecar).read_text(encoding="utf-8")).items():
        actions = actions_of(clip)
        if not actions:
            print(f"surefoot: there is no action of {clip}")
        for action in actions:
            for marker in list(action.pose_markers):
                action.pose_markers.remove(marker)
            for seconds, name in moments(report):
                action.pose_markers.new(name).frame = round(seconds * rate_of(action, report))
                count += 1
            action["surefoot"] = json.dumps(report)
    return count


def show(clip, owners=None):
    """Makes a clip the active action of what it moves (of these objects), and the scene's frame range its own."""
    owners = [owner for owner in (bpy.data.objects if owners is None else owners) if owner.animation_data]
    for owner in owners:
        owner.animation_data.action = None
    for owner, strip in strips_of(clip, owners):
        owner.animation_data.action = strip.action
        if hasattr(strip, "action_slot"):
            owner.animation_data.action_slot = strip.action_slot
        if owner.type != "ARMATURE" and any(child.type == "ARMATURE" for child in owner.children_recursive):
            print(f"surefoot: {clip} travels in the object {owner.name}: bake with --engine blender to have it in the armature")
        scene = bpy.context.scene
        scene.frame_start, scene.frame_end = 0, math.ceil(strip.action.frame_range[1] - 0.01)
        scene.frame_set(0)


def drop_contacts():
    """Takes the contact nodes of this and of earlier imports away, with their part of the actions."""
    for owner in [one for one in bpy.data.objects if one.type == "EMPTY" and CONTACT.match(one.name) and not one.children]:
        tracks = owner.animation_data.nla_tracks if owner.animation_data else []
        if not tracks:
            continue  # not the importer's: a person's own object of that name
        for action in {strip.action for track in tracks for strip in track.strips if strip.action}:
            slots = getattr(action, "slots", None)
            for slot in [slot for slot in slots or () if slot.identifier == f"OB{owner.name}"]:
                slots.remove(slot)
            if not slots:
                bpy.data.actions.remove(action)
        bpy.data.objects.remove(owner)


def hand_over(clips, owners, armature):
    """Puts the last of these clips on an armature that was there before, and takes the imported objects away."""
    for clip in clips:
        for owner, strip in strips_of(clip, owners):
            if owner.type == "ARMATURE":
                strip.action.use_fake_user = True
                data = armature.animation_data or armature.animation_data_create()
                data.action = strip.action
                if hasattr(strip, "action_slot"):
                    data.action_slot = strip.action_slot
    for owner in owners:
        bpy.data.objects.remove(owner)


def load(file, fps=None, onto=None):
    """Imports a baked file, marks its clips and shows the last one; the number of markers. `onto`: the name of the armature that
    the clips are for: one with the same bones, as the file's own rig has when it was imported before."""
    sidecar = Path(file).with_suffix(".events.json")
    clip, report = list(json.loads(sidecar.read_text(encoding="utf-8")).items())[-1]
    render = bpy.context.scene.render
    if fps or not bpy.data.actions:
        # Before the import, which writes its keys on frames.
        render.fps, render.fps_base = round(fps or report["fps"]), 1.0
    there = set(bpy.data.objects)
    bpy.ops.import_scene.gltf(filepath=str(file))
    drop_contacts()
    count = mark(sidecar)
    new = [owner for owner in bpy.data.objects if owner not in there]
    show(clip, new)
    if onto:
        hand_over(json.loads(sidecar.read_text(encoding="utf-8")), new, bpy.data.objects[onto])
    return count


if __name__ == "__main__" and "--" in sys.argv:
    for given in sys.argv[sys.argv.index("--") + 1 :]:
        print(f"{given}: {load(given)} markers")
