//! The pictures of a batch: a sheet of small contact sheets with outcome badges, and the coverage of directions and impulses; and
//! which variations move almost as an earlier one does. Bytes only; cells and signatures come from the records, a page at a time.

use super::record::Record;
use super::run::Ended;
use super::{Plan, Variation};
use crate::bake::Baked;
use crate::measure::alike;
use crate::picture::{self, CoveragePoint, Grid, GridCell, Verdict};
use crate::rig::Rig;

/// Heights of the body by which two motions may differ and be one to look at: 2 cm at 1.7 m.
const ALIKE: f64 = 0.02 / 1.7;

/// A small contact sheet, PNG.
pub fn cell(rig: &Rig, baked: &Baked) -> Vec<u8> {
    let flat = baked.performance.timeline.terrain.is_flat();
    let props: Vec<_> = baked.props.iter().filter(|prop| !(flat && prop.ground)).cloned().collect();
    picture::png(&picture::clip_cell(rig, &baked.clip, &baked.report, &props))
}

/// What tells a motion from others.
pub fn signature(baked: &Baked) -> Vec<f32> {
    let timeline = &baked.performance.timeline;
    let places = |time: f64| timeline.pose_at(time).positions(&timeline.body);
    alike::signature(&timeline.body, timeline.duration(), places)
}

/// Index of the earlier variation of the same rig that each resembles.
pub fn alike(plan: &Plan, record: &dyn Fn(&Variation) -> Option<Record>) -> Vec<Option<usize>> {
    let mut found = Vec::with_capacity(plan.variations.len());
    for rig in plan.variations.chunk_by(|a, b| a.rig == b.rig) {
        let first = found.len();
        let signatures: Vec<Vec<f32>> =
            rig.iter().map(|one| record(one).map(|record| record.signature).unwrap_or_default()).collect();
        let own = alike::near_duplicates(&signatures, ALIKE);
        found.extend(own.into_iter().map(|earlier| earlier.map(|index| first + index)));
    }
    found
}

/// The pages of the sheet, PNG, each given to `page` with its number from 0 as it is drawn.
pub fn sheet<E>(
    plan: &Plan,
    endings: &[Ended],
    alike: &[Option<usize>],
    record: &dyn Fn(&Variation) -> Option<Record>,
    page: &mut dyn FnMut(usize, Vec<u8>) -> Result<(), E>,
) -> Result<(), E> {
    let one = |((variation, ended), alike): ((&Variation, &Ended), &Option<usize>)| {
        let (verdict, steps, score, note) = match ended {
            Ended::Done(measured, _) => {
                (verdict(&measured.outcome), measured.steps, Some(measured.plausibility), String::new())
            }
            Ended::Failed(why) => (Verdict::Failed, 0, None, why.clone()),
            Ended::NotRun => (Verdict::Failed, 0, None, "not run".into()),
        };
        GridCell {
            name: variation.name.clone(),
            rig: plan.rig_name(variation).to_owned(),
            verdict,
            steps,
            score,
            duplicate_of: alike.map(|index| plan.variations[index].name.clone()),
            note,
        }
    };
    let cells: Vec<GridCell> = plan.variations.iter().zip(endings).zip(alike).map(one).collect();
    let title = title(plan);
    let grid = Grid { cells: &cells, title: &title, columns: None };
    for number in 0..grid.pages() {
        let image = grid.draw(number, &mut |index| {
            let png = record(&plan.variations[index])?.cell;
            image::load_from_memory(&png).ok().map(|image| image.to_rgba8())
        });
        page(number, picture::small_png(&image))?;
    }
    Ok(())
}

/// Direction and impulse of every variation, coloured by what came of it, as SVG.
pub fn coverage(plan: &Plan, endings: &[Ended], alike: &[Option<usize>]) -> String {
    let one = |((variation, ended), alike): ((&Variation, &Ended), &Option<usize>)| {
        let (direction_deg, impulse_ns, verdict, steps) = match ended {
            Ended::Done(measured, _) => {
                (measured.direction, measured.impulse, verdict(&measured.outcome), measured.steps)
            }
            Ended::Failed(_) | Ended::NotRun => (None, 0.0, Verdict::Failed, 0),
        };
        CoveragePoint {
            name: variation.name.clone(),
            rig: plan.rig_name(variation).to_owned(),
            direction_deg,
            impulse_ns,
            verdict,
            steps,
            duplicate_of: *alike,
        }
    };
    let points: Vec<CoveragePoint> = plan.variations.iter().zip(endings).zip(alike).map(one).collect();
    picture::coverage(&points, &title(plan))
}

/// What is varied, for a heading.
fn title(plan: &Plan) -> String {
    let names: Vec<&str> = plan.sweep.scenarios.iter().map(|input| input.name.as_str()).collect();
    let paths = plan.paths();
    let over = if paths.is_empty() { String::new() } else { format!(" over {}", paths.join(", ")) };
    format!("{}{over}", names.join(", "))
}

fn verdict(outcome: &str) -> Verdict {
    let known = Verdict::ALL.into_iter().find(|verdict| verdict.word() == outcome);
    known.unwrap_or(Verdict::Failed)
}
