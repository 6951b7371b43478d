# Surefoot's contacts and events as markers and method calls of Godot's animations.
#
{{head}}
#
# Import dock of the .glb: set "Import Script" to this file and reimport. The .events.json must lie beside the .glb. Needs Godot 4.4
# for markers. Marker names are unique in a clip, so they are numbered: foot_down_{{left}}_1, foot_down_{{left}}_2, contact_flat_{{right}}_1.
# Godot renames clips: "steady_walk_loop" arrives as "steady_walk", and . @ " % / : as "_". One that is not found is warned of.
# Root motion is set for a root that is called "root"; where a rig's own has another name, set AnimationPlayer.root_motion_track.
# Run, written again in Python: clip_names beside the importer's rules. Read in Godot's documentation only: all else.
@tool
extends EditorScenePostImport

## Name of a method of the scene's root, as in "surefoot_event": called as surefoot_event(name, foot) at
## each event. Empty: no calls.
const METHOD := ""
const FEET := {"left": "{{left}}", "right": "{{right}}"}


func _post_import(scene: Node) -> Object:
	var sidecar := get_source_file().get_basename() + ".events.json"
	var reports = JSON.parse_string(FileAccess.get_file_as_string(sidecar))
	if not reports is Dictionary:
		push_error("surefoot: %s cannot be read" % sidecar)
		return scene
	var players := scene.find_children("*", "AnimationPlayer", true, false)
	var taken := {}
	for clip: String in reports:
		var found := false
		for player: AnimationPlayer in players:
			for name in clip_names(clip):
				if player.has_animation(name) and not taken.has([player, name]):
					taken[[player, name]] = true
					found = true
					var animation := player.get_animation(name)
					_mark(animation, reports[clip])
					if reports[clip]["root_motion"] == "root":
						_root_motion(player, animation)
					break
		if not found:
			push_warning("surefoot: there is no animation of the clip %s: it has no markers" % clip)
	return scene


## What the importer may call a clip, likeliest first. A node's forbidden letters become "_"; "," and "[" go, since 4.5 they
## become "_" too; then a loop's suffix goes, if no other clip has the name without it.
static func clip_names(clip: String) -> PackedStringArray:
	var names := PackedStringArray()
	for stand_in: String in ["_", ""]:
		var name := clip.validate_node_name().replace(",", stand_in).replace("[", stand_in)
		for one: String in [name, without_loop(name)]:
			if not names.has(one):
				names.append(one)
	return names


## A name without "-loop", "_loop" or "$loop" (the same of loop_mode and cycle), before the digits and "_" at its end.
static func without_loop(name: String) -> String:
	for word: String in ["loop_mode", "loop", "cycle"]:
		var stem := name.rstrip("0123456789_ ")
		var tail := name.substr(stem.length())
		if stem.findn("$" + word) >= 0:
			name = stem.replace("$" + word, "") + tail
		elif stem.to_lower().ends_with("-" + word) or stem.to_lower().ends_with("_" + word):
			name = stem.left(stem.length() - word.length() - 1) + tail
	return name


func _mark(animation: Animation, report: Dictionary) -> void:
	var counts := {}
	var method := -1
	if METHOD != "":
		method = animation.add_track(Animation.TYPE_METHOD)
		animation.track_set_path(method, NodePath("."))
	for event: Dictionary in report["events"]:
		var foot: String = FEET.get(event.get("foot", ""), "")
		_marker(animation, counts, event["name"] if foot == "" else "%s_%s" % [event["name"], foot], event["time"])
		if method >= 0:
			var call := {"method": METHOD, "args": [event["name"], foot]}
			animation.track_insert_key(method, event["time"], call)
	for contact: Dictionary in report["contacts"]:
		_marker(animation, counts, "contact_%s_%s" % [contact["part"], FEET[contact["foot"]]], contact["start"])


func _marker(animation: Animation, counts: Dictionary, name: String, time: float) -> void:
	counts[name] = counts.get(name, 0) + 1
	if animation.has_method("add_marker"):
		animation.call("add_marker", StringName("%s_%d" % [name, counts[name]]), minf(time, animation.length))


## The track of the root: a node or a bone called "Root" or "root".
func _root_motion(player: AnimationPlayer, animation: Animation) -> void:
	for track in animation.get_track_count():
		var path := animation.track_get_path(track)
		var count := path.get_name_count()
		var last := str(path.get_name(count - 1)) if count > 0 else ""
		var bone := str(path.get_concatenated_subnames())
		var leaf := bone if bone != "" else last
		if animation.track_get_type(track) == Animation.TYPE_POSITION_3D and leaf.to_lower() == "root":
			player.root_motion_track = path
