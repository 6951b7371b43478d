//! Clips on other bodies: directions kept, feet held, knees whole. `cargo bench --bench retarget` prints the table.

use super::retarget_grid::{FILES, bodies, clips, measured};
use super::rigs::data;
use surefoot::mocap::retarget::retarget;

#[test]
fn directions_are_the_clips_and_feet_are_held_on_every_body() {
    let Some(data) = data() else { return };
    let bodies = bodies(&data);
    for file in FILES {
        for capture in clips(&data, file, &|name| !name.contains("T-Pose")) {
            for (name, body) in &bodies {
                let row = measured(&capture, &retarget(&capture, body));
                assert!(row.arms < 0.01, "{file} {} {name}: {row:?}", capture.name);
            }
        }
    }
}
