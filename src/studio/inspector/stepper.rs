//! Which of the paper's variants the stepper is, and its constants.

use super::fields::{Number, choice, grid};
use crate::model::scenario::{Stepper, SupportModel, Trigger};
use crate::studio::command::Command;
use crate::studio::document::Edit;
use eframe::egui;

/// Name, hint, value, what it is without a word, least and greatest, and how it is set.
type Factor = (&'static str, &'static str, f64, f64, (f64, f64), fn(&mut Stepper, f64));

/// Its rows.
pub fn ui(ui: &mut egui::Ui, stepper: Stepper, commands: &mut Vec<Command>) {
    let with = |change: &dyn Fn(&mut Stepper)| {
        let mut changed = stepper;
        change(&mut changed);
        Edit::Stepper(changed)
    };
    let default = Stepper::default();
    grid(ui, "stepper", |ui| {
        let hint =
            "in a walk pressure moves under a foot; off: the paper's bare pendulum, which touches the ground in points";
        choice(ui, ("Ankle feedback", hint), &stepper.ankle_feedback, &ON_OFF, commands, |on| {
            with(&|changed| changed.ankle_feedback = on)
        });
        let hint = "legs give and stretch; off: the height is kept";
        choice(ui, ("Leg change", hint), &stepper.leg_change, &ON_OFF, commands, |on| {
            with(&|changed| changed.leg_change = on)
        });
        let supports =
            [("soles", SupportModel::Soles), ("circles", SupportModel::Circles), ("capsules", SupportModel::Capsules)];
        choice(ui, ("Support", "the area under a foot"), &stepper.support, &supports, commands, |support| {
            with(&|changed| changed.support = support)
        });
        let triggers = [("extrapolated", Trigger::Extrapolated), ("projected", Trigger::Projected)];
        let hint = "what leaves that area when it steps: the extrapolated centre of mass, or its bare projection";
        choice(ui, ("Trigger", hint), &stepper.trigger, &triggers, commands, |trigger| {
            with(&|changed| changed.trigger = trigger)
        });
        let factors: [Factor; 4] = [
            ("Spring", "times the leg's stiffness", stepper.spring, default.spring, (0.25, 4.0), |changed, value| {
                changed.spring = value
            }),
            ("Damping", "times the leg's damper", stepper.damping, default.damping, (0.25, 4.0), |changed, value| {
                changed.damping = value
            }),
            (
                "Length bias",
                "times the part of a leg's length error in the length of a step",
                stepper.length_bias,
                default.length_bias,
                (0.0, 2.0),
                |changed, value| changed.length_bias = value,
            ),
            (
                "Pull bias",
                "how far a lasting force as large as the weight moves the foothold, in heights of the centre of mass",
                stepper.pull_bias,
                default.pull_bias,
                (0.0, 2.0),
                |changed, value| changed.pull_bias = value,
            ),
        ];
        for (name, hint, value, default, (low, high), set) in factors {
            let number = Number::new(name, low..=high, hint).unit("×", 0.01, 2).default(default);
            number.row(ui, value, commands, |value| with(&|changed| set(changed, value)));
        }
    });
}

/// A switch's two ways.
const ON_OFF: [(&str, bool); 2] = [("on", true), ("off", false)];
