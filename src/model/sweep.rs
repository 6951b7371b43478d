//! A sweep: which scenarios and rigs, which of their values vary and how, and what each variation is called. Plain data.
//!
//! A *path* leads to a value of a scenario as in its faults: keys and indices from 0, joined by dots (`push.0.force`). An *axis* is
//! what varies together; the variations are the axes' product, their rows side by side, or a sample of their product.

use toml::Value;

/// The whole.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// Whose values vary; at least one.
    pub scenarios: Vec<Input>,
    /// On which rigs; at least one.
    pub rigs: Vec<Input>,
    /// What a variation's clip and file are called; see `batch::name`.
    pub name: String,
    /// What varies, in the order of the text: the first slowest.
    pub axes: Vec<Axis>,
    /// Variations that are left out.
    pub skips: Vec<Skip>,
    /// How the axes make variations.
    pub combine: Combine,
    /// How each is baked.
    pub bake: BakeSettings,
}

/// A file that a sweep names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Input {
    /// What it is called in names and folders.
    pub name: String,
    /// As the sweep says it: beside the sweep, or `builtin`.
    pub file: String,
    /// Its place in the sweep's text.
    pub path: String,
}

/// What varies together.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The values that it sets.
    pub paths: Vec<AxisPath>,
    /// To what.
    pub values: AxisValues,
}

/// A value of the scenario that an axis sets.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AxisPath {
    /// In the scenario.
    pub path: String,
    /// Its place in the sweep's text.
    pub place: String,
}

/// What an axis sets its paths to.
#[derive(Clone, Debug, PartialEq)]
pub enum AxisValues {
    /// Rows of a value for each path; at least one.
    Rows(Vec<Vec<Choice>>),
    /// Anything between, of one path: for samples only.
    Between {
        /// The least.
        from: f64,
        /// The greatest.
        to: f64,
        /// Evenly in the logarithm.
        log: bool,
    },
}

/// A value and what it is called.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The value.
    pub value: Value,
    /// Its word in names; made from the value where there is none.
    pub name: Option<String>,
}

/// How axes make variations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Combine {
    /// Every row with every row.
    Product,
    /// First rows together, second rows together; axes are equally long. Scenarios and rigs multiply them.
    Zip,
    /// So many points of the product, drawn by a seed; scenarios and rigs multiply them.
    Sample {
        /// How many.
        count: usize,
        /// Starts the draws.
        seed: u64,
        /// Each axis is cut into `count` equal parts and each part drawn from once (a Latin hypercube); else each point by itself.
        stratified: bool,
    },
}

/// Leaves out the variations that meet all of its conditions.
#[derive(Clone, Debug, PartialEq)]
pub struct Skip {
    /// At least one.
    pub conditions: Vec<Condition>,
    /// Its place in the sweep's text.
    pub place: String,
}

/// What a value must be.
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    /// A path of the scenario, or `rig` or `scenario`.
    pub path: String,
    /// Its place in the sweep's text.
    pub place: String,
    /// The test.
    pub test: Test,
}

/// A test of a value.
#[derive(Clone, Debug, PartialEq)]
pub enum Test {
    /// One of these.
    OneOf(Vec<Value>),
    /// A number over the first and under the second, where they are given.
    Within {
        /// Above this.
        above: Option<f64>,
        /// Below this.
        below: Option<f64>,
    },
}

/// As `surefoot bake`'s flags, the same for all.
#[derive(Clone, Debug, PartialEq)]
pub struct BakeSettings {
    /// Frames a second.
    pub fps: f64,
    /// `root`, `hips` or `in-place`.
    pub root: &'static str,
    /// `auto`, `stepper` or `ragdoll`.
    pub drive: &'static str,
    /// Bound on the ragdoll's help: Nm and N; `None` is auto.
    pub assist: Option<[f64; 2]>,
    /// Ground, boxes and balls into the file.
    pub props: bool,
    /// Only a cycle.
    pub looped: bool,
    /// `linear` or `spline`.
    pub curves: &'static str,
    /// Skeletons and clips alone.
    pub only_animation: bool,
    /// With the two nodes that show the contacts.
    pub contact_nodes: bool,
    /// What the clips are written as.
    pub format: super::FileKind,
    /// Engines whose helper stands beside the clips, each once, in the order of [`ENGINES`].
    pub engines: Vec<&'static str>,
}

/// The engines that there are helpers for.
pub const ENGINES: [&str; 6] = ["three", "blender", "bevy", "godot", "unity", "unreal"];

impl Default for BakeSettings {
    fn default() -> BakeSettings {
        BakeSettings {
            fps: 30.0,
            root: "root",
            drive: "auto",
            assist: None,
            props: false,
            looped: false,
            curves: "linear",
            only_animation: false,
            contact_nodes: true,
            format: super::FileKind::Glb,
            engines: Vec::new(),
        }
    }
}
