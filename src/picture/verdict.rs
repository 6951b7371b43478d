//! What came of a variation, as grids and coverage show it: a word, a colour and a shape, so that no one needs the colours.
//!
//! The colours are Okabe and Ito's, which people who confuse red and green tell apart.

use super::paint::{self, Ink};
use crate::model::report::Outcome;
use glam::DVec2;
use image::RgbaImage;

/// What came of a variation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// Nothing moved.
    Still,
    /// The feet stayed.
    Sway,
    /// It stepped and stands.
    Step,
    /// Balance was lost.
    Fall,
    /// There is no clip.
    Failed,
}

impl From<Outcome> for Verdict {
    fn from(outcome: Outcome) -> Verdict {
        match outcome {
            Outcome::Still => Verdict::Still,
            Outcome::Sway => Verdict::Sway,
            Outcome::Step => Verdict::Step,
            Outcome::Fall => Verdict::Fall,
        }
    }
}

impl Verdict {
    /// From the best to the worst.
    pub const ALL: [Verdict; 5] = [Verdict::Still, Verdict::Sway, Verdict::Step, Verdict::Fall, Verdict::Failed];

    /// One word.
    pub fn word(self) -> &'static str {
        ["still", "sway", "step", "fall", "failed"][self as usize]
    }

    /// sRGB.
    pub fn color(self) -> [u8; 3] {
        [[128, 134, 144], [58, 146, 208], [0, 142, 104], [213, 94, 0], [120, 38, 110]][self as usize]
    }

    /// Its shape about a place: a ring, a disc, a triangle, a cross, a square.
    pub fn draw(self, image: &mut RgbaImage, at: DVec2, radius: f64, color: [u8; 3]) {
        let ink = Ink(color, 1.0);
        let corner = |x: f64, y: f64| at + DVec2::new(x, y) * radius;
        match self {
            Verdict::Still => paint::ring(image, at, radius * 0.8, radius * 0.42, ink),
            Verdict::Sway => paint::disc(image, at, radius, ink),
            Verdict::Step => {
                paint::polygon(image, &[corner(0.0, -1.1), corner(1.05, 0.8), corner(-1.05, 0.8)], ink);
            }
            Verdict::Fall => {
                for side in [1.0, -1.0] {
                    paint::line(image, corner(-0.8, -0.8 * side), corner(0.8, 0.8 * side), radius * 0.55, ink);
                }
            }
            Verdict::Failed => paint::panel(image, corner(-0.9, -0.9), corner(0.9, 0.9), 0.5, ink),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_colours_and_shapes_all_differ() {
        let drawn = |verdict: Verdict| {
            let mut image = RgbaImage::new(20, 20);
            verdict.draw(&mut image, DVec2::splat(10.0), 7.0, [255; 3]);
            image.pixels().map(|pixel| pixel[0] > 128).collect::<Vec<bool>>()
        };
        for (at, one) in Verdict::ALL.into_iter().enumerate() {
            for other in Verdict::ALL.into_iter().skip(at + 1) {
                assert_ne!(one.word(), other.word());
                let apart: u32 = (0..3).map(|c| u32::from(one.color()[c].abs_diff(other.color()[c]))).sum();
                assert!(apart > 90, "{one:?} and {other:?} have nearly one colour");
                let differ = drawn(one).iter().zip(drawn(other)).filter(|(a, b)| **a != *b).count();
                assert!(differ > 30, "{one:?} and {other:?} differ in {differ} pixels of shape");
            }
        }
    }
}
