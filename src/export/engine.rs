//! What each engine wants of a clip, in one table, and the small file that gives it the clip's contacts and events.
//!
//! A helper serves every clip beside it: it reads `animations[i].extras.surefoot` or the sidecar `CLIP.events.json`. Its text is a
//! template in `engines/`, in the engine's own language; what differs by engine and not by language comes from the table. Those that
//! the tests do not run in their engine say so at their top, and which lines were run in another way. Bytes only; the writer puts them on
//! the disk.

/// An engine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Engine {
    /// As the command line spells it.
    pub name: &'static str,
    /// As its makers spell it.
    pub title: &'static str,
    /// The helper's file.
    pub file: &'static str,
    /// World axes after its own glTF import.
    pub axes: &'static str,
    /// Units of length after its own glTF import.
    pub units: &'static str,
    /// What contacts and events become.
    pub events: &'static str,
    /// What the two feet are called in their names.
    pub feet: [&'static str; 2],
    /// How a clip is known to loop.
    pub looped: &'static str,
    /// What it takes root motion from, and which `--root` that is.
    pub root: &'static str,
    /// The values of `--root` that it can play as they are meant.
    pub modes: &'static [&'static str],
    /// Its skeletons are made of joints alone (in Blender: its armatures of bones), so that the root must be one.
    pub root_is_joint: bool,
    /// On a rig without a root bone the travel is better in the hips than on a new node: an avatar binds by its own bones.
    pub rootless_hips: bool,
    /// Where the tests run the helper; `None`: nowhere.
    pub run_in: Option<&'static str>,
    /// What begins a comment's line.
    comment: &'static str,
    template: &'static str,
}

/// Every engine that there is a helper for.
pub const ENGINES: [Engine; 6] = [
    Engine {
        name: "three",
        title: "three.js",
        file: "surefoot_three.js",
        axes: "Y up, as in the file",
        units: "metres",
        events: "DOM events of an EventTarget: foot_down, push_start, ... and contact_start, contact_end",
        feet: ["left", "right"],
        looped: "the action's own loop mode; a loop's events come again",
        root: "no root motion of its own: `root` and `hips` travel in the scene, `in-place` leaves the way to the program",
        modes: &["root", "hips", "in-place"],
        root_is_joint: false,
        rootless_hips: false,
        run_in: Some("three.js r187 in Chromium"),
        comment: "//",
        template: include_str!("engines/three.js"),
    },
    Engine {
        name: "blender",
        title: "Blender",
        file: "surefoot_blender.py",
        axes: "Z up: x, -z, y of the file",
        units: "metres",
        events: "pose markers of the action, which becomes the active one, and the whole report as its custom property \"surefoot\"",
        feet: ["L", "R"],
        looped: "a Cycles modifier, by hand",
        root: "a bone at the top of the armature: `--root root`, or the hips; it has no root motion of its own",
        modes: &["root", "hips", "in-place"],
        root_is_joint: true,
        rootless_hips: false,
        run_in: Some("Blender 4.5 and 5.0 as a Python module"),
        comment: "#",
        template: include_str!("engines/blender.py"),
    },
    Engine {
        name: "bevy",
        title: "Bevy",
        file: "surefoot_bevy.rs",
        axes: "Y up, as in the file",
        units: "metres",
        events: "animation events of the clip: SurefootEvent and SurefootContact, for observers",
        feet: ["left", "right"],
        looped: "RepeatAnimation of the playing animation; a loop's events come again",
        root: "no root motion of its own: `root` and `hips` travel in the scene, `in-place` leaves the way to the program",
        modes: &["root", "hips", "in-place"],
        root_is_joint: false,
        rootless_hips: false,
        run_in: Some("Bevy 0.19"),
        comment: "//!",
        template: include_str!("engines/bevy.rs"),
    },
    Engine {
        name: "godot",
        title: "Godot",
        file: "surefoot_godot.gd",
        axes: "Y up, as in the file",
        units: "metres",
        events: "markers of the animation, and a method track where METHOD names a method",
        feet: ["L", "R"],
        looped: "a clip whose name begins or ends with \"loop\" or \"cycle\"; a \"_loop\" at its end is cut off",
        root: "AnimationPlayer.root_motion_track, which the script sets: bake with `--root root`",
        modes: &["root", "in-place"],
        root_is_joint: true,
        rootless_hips: false,
        run_in: None,
        comment: "#",
        template: include_str!("engines/godot.gd"),
    },
    Engine {
        name: "unity",
        title: "Unity",
        file: "SurefootEvents.cs",
        axes: "Y up, left-handed: the importer turns the file",
        units: "metres: the importer scales an FBX",
        events: "AnimationEvents that call SurefootEvent(AnimationEvent), and curves FootContact_Left, FootContact_Right for the Animator",
        feet: ["Left", "Right"],
        looped: "Loop Time of the clip, which the script sets where the name begins or ends with \"loop\" or \"cycle\"",
        root: "the Avatar of an FBX (-o take.fbx), never of a .glb: a Generic rig's root node, Root of `--root root` or the hips; a Humanoid's body centre",
        modes: &["root", "hips", "in-place"],
        root_is_joint: false,
        rootless_hips: true,
        run_in: None,
        comment: "//",
        template: include_str!("engines/unity.cs"),
    },
    Engine {
        name: "unreal",
        title: "Unreal Engine",
        file: "surefoot_unreal.py",
        axes: "Z up, left-handed: the importer turns the file",
        units: "centimetres: the importer scales by 100",
        events: "sync markers L and R where a foot comes down, notifies of the classes in NOTIFY_FOLDER, curves FootContact_L, FootContact_R",
        feet: ["L", "R"],
        looped: "the state that plays it",
        root: "the skeleton's root bone alone, at the origin: bake with `--root root`",
        modes: &["root", "in-place"],
        root_is_joint: true,
        rootless_hips: false,
        run_in: None,
        comment: "#",
        template: include_str!("engines/unreal.py"),
    },
];

impl Engine {
    /// The engine of that name.
    pub fn named(name: &str) -> Option<&'static Engine> {
        ENGINES.iter().find(|engine| engine.name == name)
    }

    /// Whether a clip of that root motion plays there as it is meant.
    pub fn takes(&self, root: &str) -> bool {
        self.modes.contains(&root)
    }

    /// The helper's bytes: the same for every clip.
    pub fn helper(&self) -> Vec<u8> {
        let lines = [
            format!(
                "Written by surefoot {} for every clip in this folder; the next bake writes it anew.",
                env!("CARGO_PKG_VERSION")
            ),
            match self.run_in {
                Some(place) => format!("Surefoot's tests run it in {place}."),
                None => format!(
                    "Written by {}'s documentation and NOT RUN in it: try it before you rely on it.",
                    self.title
                ),
            },
            String::new(),
            format!("What {} wants:", self.title),
            format!("  axes         {}; places and forces in the report stay in the file's", self.axes),
            format!("  units        {}", self.units),
            format!("  events       {}", self.events),
            format!("  loop         {}", self.looped),
            format!("  root motion  {}", self.root),
        ];
        let head = lines.map(|line| format!("{} {line}", self.comment).trim_end().to_owned()).join("\n");
        let text = self.template.replace("\r\n", "\n").replace("{{head}}", &head);
        text.replace("{{left}}", self.feet[0]).replace("{{right}}", self.feet[1]).into_bytes()
    }
}
