//! The dials of the balance law, for a body of 89.5 kg with legs of 0.83 m: lengths scale with the leg, times with its root.
//!
//! Found by random search on seeded pushes that no test or benchmark uses.

use crate::maths::seed::Seed;
use crate::stepper::catch::StepTuning;

/// Everything that can be turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuning {
    /// Stepping.
    pub step: StepTuning,
    /// Feedback from ξ to the centre of pressure.
    pub cop_gain: f64,
    /// Share of the angular momentum in ξ.
    pub momentum: f64,
    /// m, ξ so far outside the soles starts a step.
    pub trigger: f64,
    /// m, by which the soles are shrunk for that.
    pub shrunk: f64,
    /// N m, the moment that may be asked for in stance, and more in a swing.
    pub moment: [f64; 2],
    /// 1/s², 1/s: height.
    pub height: [f64; 2],
    /// 1/s², 1/s: pelvis.
    pub pelvis: [f64; 2],
    /// rad/s²: most.
    pub pelvis_most: f64,
    /// 1/s², 1/s: trunk.
    pub trunk: [f64; 2],
    /// 1/s², 1/s: swing foot.
    pub foot: [f64; 2],
    /// 1/s², 1/s: swing foot's turn.
    pub foot_turn: [f64; 2],
    /// Weights of the forces' tasks: sideways, up, level turn, yaw.
    pub weights: [f64; 4],
    /// Weight of the shares.
    pub ridge: f64,
    /// Share of the servo's stiffness and damping that stands by, in the legs and elsewhere.
    pub standby: [f64; 2],
    /// N m/rad and N m s/rad that stand by in the joints of a leg that bears.
    pub bearing: [f64; 2],
    /// m, lift of a step.
    pub lift: [f64; 2],
    /// Share of the observed push that is foreseen.
    pub foreseen: f64,
    /// Share of the weight that each foot keeps while both stand, and that the other bears before one leaves.
    pub least: f64,
    /// As `least` says.
    pub borne: f64,
    /// 1/s², pull of the ground on a sole that came off.
    pub settle: f64,
    /// The trunk turns apart from the pelvis.
    pub apart: bool,
    /// m/s², rad/s²: most of a swing foot.
    pub foot_most: [f64; 2],
    /// So many times as much where it brakes.
    pub brakes: f64,
    /// Share of a swing by which the foot must be off the ground.
    pub rise: f64,
    /// 1/s, how hard a foot that bears is held still.
    pub hold: f64,
    /// Share of a leg's length that it is to use: standing, stepping.
    pub reach: [f64; 2],
    /// Share of a bearing foot's motion that is stopped at once.
    pub snap: f64,
    /// 1/s², how hard a bearing sole is laid flat.
    pub level: f64,
    /// Share of its length that a swinging leg uses.
    pub stretch: f64,
    /// Share of a leg's length that a body at ease stands on.
    pub at_ease: f64,
    /// Share of the sole that is planned with.
    pub inside: f64,
    /// m/s, how fast the wanted height changes.
    pub sink: f64,
    /// m, feet that land farther apart are brought together at once.
    pub wide: f64,
    /// s, the wait that they are spared.
    pub onwards: f64,
    /// Share of its length from which on a swinging leg is steered by its knee.
    pub straight: f64,
    /// Damping of the legs' inverse: bearing, swinging.
    pub damping: [f64; 2],
    /// m, by which the pelvis is held lower.
    pub crouch: f64,
    /// rad before a range's end where the law heeds it, of a foot that bears and of one that swings.
    pub margin: [f64; 2],
    /// 1/s, how hard a sole that gives way follows its shank.
    pub follows: f64,
    /// m, a corner that is to be higher bears nothing; 1/m, how much dearer a higher one is.
    pub lifted: [f64; 2],
    /// Times the plan's own, how far a foothold may be out of reach before the plan that leads gives up.
    pub patience: f64,
}

impl Tuning {
    /// The same for who stands and begins to fall: he steps later, a little less far, on lower hips and with either foot in turn, and heeds more of a
    /// push that goes on. With these dials more stand again (bench `ragdoll`: 93 % for 75 % after 150 to 200 Ns); for who is on his way they are
    /// worse: of 32 who are shoved on their way up stairs 3 fall instead of 1, and one of 20 who are shoved aside in a walk comes half as far.
    pub fn standing(mut self) -> Tuning {
        self.trigger += 0.0125;
        self.foreseen += 0.055;
        self.reach[1] -= 0.016;
        self.step.along -= 0.0215;
        self.step.again += 0.0355;
        self
    }

    /// Another near this one, by that share of the dials' ranges; some dials stay.
    pub fn drawn_near(&self, draw: &mut Seed, share: f64) -> Tuning {
        let mut next = *self;
        let mut turn = |value: &mut f64, low: f64, high: f64| {
            let moves = draw.between(0.0, 1.0) < 0.6;
            let by = draw.between(-0.5, 0.5) * (high - low) * share;
            if moves {
                *value = (*value + by).clamp(low, high);
            }
        };
        let mut longer = 0.0;
        turn(&mut longer, -0.10, 0.10);
        next.step.times.iter_mut().for_each(|time| *time = (*time + longer).clamp(0.16, 0.40));
        turn(&mut next.step.outside, 0.05, 0.35);
        turn(&mut next.step.along, -0.05, 0.2);
        turn(&mut next.step.reach, 0.35, 0.6);
        turn(&mut next.step.span, 0.8, 1.2);
        turn(&mut next.step.clear, 0.08, 0.2);
        turn(&mut next.step.left, -0.3, 0.3);
        turn(&mut next.step.nudge[0], -0.2, 0.2);
        turn(&mut next.step.nudge[1], -0.2, 0.2);
        turn(&mut next.momentum, 0.7, 2.8);
        turn(&mut next.trigger, -0.05, 0.05);
        turn(&mut next.cop_gain, 1.3, 4.0);
        turn(&mut next.moment[0], 40.0, 250.0);
        turn(&mut next.moment[1], 0.0, 700.0);
        turn(&mut next.pelvis[0], 30.0, 140.0);
        turn(&mut next.foreseen, 0.0, 0.9);
        turn(&mut next.lift[0], 0.05, 0.12);
        turn(&mut next.reach[1], 0.82, 0.965);
        turn(&mut next.weights[2], 0.05, 0.6);
        turn(&mut next.crouch, 0.0, 0.12);
        next
    }
}

impl Default for Tuning {
    fn default() -> Tuning {
        Tuning {
            step: StepTuning::default(),
            cop_gain: 2.3,
            momentum: 1.35,
            trigger: -0.02,
            shrunk: 0.03,
            moment: [120.0, 505.0],
            height: [144.0, 20.0],
            pelvis: [75.0, 13.5],
            pelvis_most: 54.0,
            trunk: [100.0, 16.0],
            foot: [700.0, 40.0],
            foot_turn: [600.0, 40.0],
            weights: [1.0, 1.0, 0.3, 0.19],
            ridge: 0.02,
            standby: [0.2, 0.2],
            bearing: [2000.0, 140.0],
            lift: [0.082, 0.1],
            foreseen: 0.3,
            least: 0.06,
            borne: 0.06,
            settle: 1000.0,
            apart: false,
            foot_most: [80.0, 250.0],
            brakes: 1.5,
            rise: 0.25,
            hold: 0.0,
            reach: [0.974, 0.925],
            snap: 0.8,
            level: 800.0,
            stretch: 0.965,
            at_ease: 0.98,
            inside: 1.0,
            sink: 1.6,
            wide: 0.65,
            onwards: 0.7,
            straight: 0.86,
            damping: [0.08, 0.2],
            crouch: 0.0,
            margin: [0.042, 0.1],
            follows: 49.0,
            lifted: [0.006, 300.0],
            patience: 1.0,
        }
    }
}
