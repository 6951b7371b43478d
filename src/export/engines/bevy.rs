//! Surefoot's contacts and events as Bevy's animation events.
//!
{{head}}
//!
//! ```ignore
//! mod surefoot_bevy; // needs the crates bevy 0.19 (features bevy_gltf, gltf_animation) and serde_json
//! app.add_plugins((DefaultPlugins, surefoot_bevy::SurefootPlugin)); // before any glTF is loaded
//! // The trigger's target is the entity with the AnimationPlayer:
//! app.add_observer(|event: On<SurefootEvent>| info!("{} {:?} of {}", event.name, event.foot, event.trigger().target));
//! ```
//!
//! The loader reads the report from the clip's extras; no other file is needed.

use bevy::animation::{AnimationClip, AnimationEvent};
use bevy::app::{App, Plugin};
use bevy::asset::LoadContext;
use bevy::gltf::extensions::{ErasedGltfExtensionHandler, GltfExtensionHandler, GltfExtensionHandlers};
use bevy::gltf::gltf;
use serde_json::Value;

/// A moment of the clip: foot_down, foot_up, push_start, push_end, ball_hit, balance_lost, balance_regained.
#[derive(AnimationEvent, Clone, Debug, PartialEq)]
pub struct SurefootEvent {
    pub name: String,
    /// "{{left}}" or "{{right}}".
    pub foot: Option<String>,
    /// s, in the clip.
    pub time: f32,
}

/// A part of a foot meets the ground, or leaves it.
#[derive(AnimationEvent, Clone, Debug, PartialEq)]
pub struct SurefootContact {
    /// "{{left}}" or "{{right}}".
    pub foot: String,
    /// "heel", "ball" or "flat".
    pub part: String,
    /// It begins; else it ends.
    pub begins: bool,
    /// s, in the clip.
    pub time: f32,
    /// A point of the ground under the foot, in the file's space and units.
    pub position: [f32; 3],
}

/// Lets the glTF loader add the events to every clip that surefoot baked.
pub struct SurefootPlugin;

impl Plugin for SurefootPlugin {
    fn build(&self, _: &mut App) {}

    fn finish(&self, app: &mut App) {
        let handlers = app.world().get_resource::<GltfExtensionHandlers>();
        let handlers = handlers.expect("SurefootPlugin stands beside GltfPlugin (DefaultPlugins has it)");
        handlers.0.write_blocking().push(Box::new(SurefootReader));
    }
}

#[derive(Clone)]
struct SurefootReader;

impl GltfExtensionHandler for SurefootReader {
    fn dyn_clone(&self) -> Box<dyn ErasedGltfExtensionHandler> {
        Box::new(self.clone())
    }

    fn on_animation(&mut self, _: &mut LoadContext<'_>, animation: &gltf::Animation, clip: &mut AnimationClip) {
        let extras = animation.extras().as_ref().and_then(|raw| serde_json::from_str::<Value>(raw.get()).ok());
        if let Some(report) = extras.as_ref().and_then(|extras| extras.get("surefoot")) {
            add_events(report, clip);
        }
    }
}

/// Adds the events of a report (from extras, or from a .events.json) to a clip.
pub fn add_events(report: &Value, clip: &mut AnimationClip) {
    let length = clip.duration();
    let list = |name: &str| report.get(name).and_then(Value::as_array).cloned().unwrap_or_default();
    let text = |object: &Value, name: &str| object.get(name).and_then(Value::as_str).map(str::to_owned);
    // Not beyond the last key: a later event would make the clip longer.
    let time = |object: &Value, name: &str| Some((object.get(name)?.as_f64()? as f32).clamp(0.0, length));
    for event in list("events") {
        let (Some(name), Some(time)) = (text(&event, "name"), time(&event, "time")) else { continue };
        clip.add_event(time, SurefootEvent { name, foot: text(&event, "foot"), time });
    }
    for contact in list("contacts") {
        let (Some(foot), Some(part)) = (text(&contact, "foot"), text(&contact, "part")) else { continue };
        let axis = |at: usize| contact.pointer(&format!("/position/{at}")).and_then(Value::as_f64).unwrap_or(0.0) as f32;
        let position = [axis(0), axis(1), axis(2)];
        for (begins, name) in [(true, "start"), (false, "end")] {
            let Some(time) = time(&contact, name) else { continue };
            let (foot, part) = (foot.clone(), part.clone());
            clip.add_event(time, SurefootContact { foot, part, begins, time, position });
        }
    }
}
