//! The calls that the subcommands make into the rows above, each with its errors sorted into exit codes.

use super::args::{self, Assist, BakeArgs, Root};
use crate::bake::{BakeError, BakeOptions, Baked, Base, Drive, Helped, RootMotion};
use crate::disk::Failure;
use crate::export::{Exported, Form};
use crate::model::{Clip, ClipReport, Prop, Scenario};
use crate::rig::mannequin::{MannequinOptions, mannequin};
use crate::rig::{Rig, clips};
use crate::{bake, export, picture};
use std::cell::RefCell;
use std::sync::Arc;

/// Moments on a contact sheet.
const MOMENTS: usize = 10;

/// The built-in rig's file, of that height in metres and with legs so many times as long.
pub fn new_rig(height: Option<f64>, leg_scale: Option<f64>) -> Vec<u8> {
    let ordinary = MannequinOptions::default();
    mannequin(&MannequinOptions {
        height: height.unwrap_or(ordinary.height),
        leg_scale: leg_scale.unwrap_or(ordinary.leg_scale),
        ..ordinary
    })
}

impl From<Root> for RootMotion {
    fn from(root: Root) -> RootMotion {
        match root {
            Root::Root => RootMotion::Root,
            Root::Hips => RootMotion::Hips,
            Root::InPlace => RootMotion::InPlace,
        }
    }
}

impl From<args::Curves> for bake::Curves {
    fn from(curves: args::Curves) -> bake::Curves {
        match curves {
            args::Curves::Linear => bake::Curves::Linear,
            args::Curves::Spline => bake::Curves::Spline,
        }
    }
}

/// Runs a scenario on a rig.
pub fn bake(
    rig: &Rig,
    scenario: &Scenario,
    base: Option<Arc<Base>>,
    root: RootMotion,
    args: &BakeArgs,
) -> Result<Baked, Failure> {
    let helped = match args.assist {
        Assist::Auto => Helped::Auto,
        Assist::Off => Helped::Within(Default::default()),
        Assist::Bound(torque, force) => {
            Helped::Within(crate::ragdoll::control::Assist { torque, force: force.unwrap_or(0.0) })
        }
    };
    let drive = match args.drive {
        args::Drive::Auto => Drive::Auto(helped),
        args::Drive::Stepper => Drive::Stepper,
        args::Drive::Ragdoll => Drive::Ragdoll(helped),
    };
    let options = BakeOptions {
        name: args.clip.clone(),
        fps: args.fps,
        seed: args.seed,
        root,
        drive,
        base,
        looped: args.looped,
        curves: args.curves.into(),
        effort: args.effort,
    };
    bake::bake(rig, scenario, &options).map_err(|error| match error {
        BakeError::Unplayed { .. } | BakeError::Base(_) | BakeError::NoCycle { .. } | BakeError::NoGround { .. } => {
            Failure::bad_input(error.to_string())
        }
        BakeError::Overdone { .. } => Failure::bad_input(format!("{}: {error}", args.rig.display())),
        error => Failure::failed(error.to_string()),
    })
}

/// Makes the files of a baked clip.
pub fn exported(rig: &Rig, baked: &Baked, form: Form) -> Result<Exported, Failure> {
    export::baked(rig, baked, form).map_err(|error| Failure::failed(error.to_string()))
}

/// A contact sheet as PNG bytes, with what stands beside the body.
pub fn sheet(rig: &Rig, clip: &Clip, report: &ClipReport, props: &[Prop]) -> Vec<u8> {
    let sampler = RefCell::new(rig.sampler(clip));
    let pose = |time: f64| picture::transforms_of_globals(rig, sampler.borrow_mut().node_globals(time));
    let moments = picture::choose_moments(report, MOMENTS);
    let layout = picture::Layout::fitting(moments.len());
    picture::png(&picture::sheet(&picture::SheetInput {
        rig,
        pose: &pose,
        report,
        overlay: None,
        props,
        moments,
        layout,
    }))
}

/// The props that a picture needs: flat ground it has of its own, without an end.
pub fn seen_props(baked: &Baked) -> Vec<Prop> {
    let flat = baked.performance.timeline.terrain.is_flat();
    baked.props.iter().filter(|prop| !(flat && prop.ground)).cloned().collect()
}

/// A contact sheet of a clip that lies in the rig's file: of that name, or the last one.
pub fn sheet_of_file(rig: &Rig, file: &str, wanted: Option<&str>) -> Result<Vec<u8>, Failure> {
    let names = clips::clip_names(rig);
    let index = match wanted {
        Some(wanted) => names.iter().position(|name| name == wanted),
        None => names.len().checked_sub(1),
    };
    let Some(index) = index else {
        let remedy = match names.is_empty() {
            true => "bake one into it with `surefoot bake`".to_owned(),
            false => format!("it has {}", names.join(", ")),
        };
        let what = wanted.map_or("no clip".to_owned(), |wanted| format!("no clip \"{wanted}\""));
        return Err(Failure::bad_input(format!("{file}: there is {what} in it\n  help: {remedy}")));
    };
    let clip = clips::read_clip(rig, index).map_err(|fault| Failure::bad_input(format!("{file}: {fault}")))?;
    let extras = rig.document.list("animations")[index].pointer("/extras/surefoot");
    let report = extras.and_then(|report| serde_json::from_value(report.clone()).ok());
    let report = report.unwrap_or_else(|| foreign(rig, &clip));
    Ok(sheet(rig, &clip, &report, &picture::seen_in_file(rig, &clip, &report)))
}

/// What is known of a clip that says nothing about itself.
fn foreign(rig: &Rig, clip: &Clip) -> ClipReport {
    use crate::model::report::{Assist, BodyReport, Outcome, Plausibility};
    ClipReport {
        version: 1,
        generator: String::new(),
        fps: clip.fps,
        duration: clip.duration,
        seed: 0,
        root_motion: String::new(),
        drive: String::new(),
        scenario: clip.name.clone(),
        outcome: Outcome::Still,
        steps: 0,
        body: BodyReport { mass: rig.body.mass, height: rig.body.height },
        scuffs: Vec::new(),
        contacts: Vec::new(),
        events: Vec::new(),
        disturbances: Vec::new(),
        assist: Assist::default(),
        torques: Vec::new(),
        plausibility: Plausibility::default(),
        drift: None,
        search: None,
        base: None,
        looped: None,
    }
}
