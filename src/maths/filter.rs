//! Zero-lag low-pass, derivatives and resampling of uniformly sampled series: f64, DVec2, DVec3. Times in s, rates in Hz.
//!
//! The low-pass is a 2nd-order Butterworth run forward and backward (Winter, "Biomechanics and Motor Control"), its
//! corner corrected for the two passes so that the whole is 3 dB down at the cutoff. Ends are padded by odd reflection
//! about the line from the first to the last sample, so that constants and ramps come back exactly.

use crate::maths::real;
use std::ops::{Add, Mul, Sub};

/// What can be filtered.
pub trait Sample: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<f64, Output = Self> {}
impl<T: Copy + Add<Output = T> + Sub<Output = T> + Mul<f64, Output = T>> Sample for T {}

/// Low-pass without lag: 3 dB down at `cutoff_hz`. A cutoff at or above half the rate gives the series back.
pub fn zero_lag<T: Sample>(samples: &[T], cutoff_hz: f64, hz: f64) -> Vec<T> {
    let count = samples.len();
    if count < 3 || !(cutoff_hz > 0.0 && 1.25 * cutoff_hz < 0.5 * hz) {
        return samples.to_vec();
    }
    let section = Section::butterworth(cutoff_hz, hz);
    let last = count - 1;
    let slope = (samples[last] - samples[0]) * (1.0 / last as f64);
    let line = |index: usize| samples[0] + slope * index as f64;
    // What is off the line is 0 at both ends, so its odd reflection goes on with period 2·last as far as wanted.
    let flat: Vec<T> = (0..count).map(|index| samples[index] - line(index)).collect();
    let reflected = |index: usize| {
        let phase = index % (2 * last);
        if phase <= last { flat[phase] } else { flat[2 * last - phase] * -1.0 }
    };
    let pad = (3.5 * hz / cutoff_hz).ceil() as usize;
    let phase = 2 * last - pad % (2 * last); // where the padded series begins in the period
    let mut padded: Vec<T> = (0..count + 2 * pad).map(|index| reflected(phase + index)).collect();
    section.run(padded.iter_mut());
    section.run(padded.iter_mut().rev());
    (0..count).map(|index| padded[pad + index] + line(index)).collect()
}

/// First derivative: central differences; at the ends, one-sided of the same order.
pub fn derivative<T: Sample>(samples: &[T], hz: f64) -> Vec<T> {
    let count = samples.len();
    let half = 0.5 * hz;
    match count {
        0 => Vec::new(),
        1 => vec![samples[0] * 0.0],
        2 => vec![(samples[1] - samples[0]) * hz; 2],
        _ => (0..count)
            .map(|index| match index {
                0 => (samples[1] * 4.0 - samples[0] * 3.0 - samples[2]) * half,
                index if index == count - 1 => {
                    (samples[index] * 3.0 - samples[index - 1] * 4.0 + samples[index - 2]) * half
                }
                index => (samples[index + 1] - samples[index - 1]) * half,
            })
            .collect(),
    }
}

/// Second derivative: central differences; at the ends, that of the neighbour.
pub fn second_derivative<T: Sample>(samples: &[T], hz: f64) -> Vec<T> {
    let count = samples.len();
    if count < 3 {
        return samples.iter().map(|sample| *sample * 0.0).collect();
    }
    let square = hz * hz;
    (0..count)
        .map(|index| index.clamp(1, count - 2))
        .map(|index| (samples[index + 1] - samples[index] * 2.0 + samples[index - 1]) * square)
        .collect()
}

/// The value at a time (s): a Catmull-Rom curve through the samples, held before the first and after the last.
/// `None` for no samples.
pub fn value_at<T: Sample>(samples: &[T], hz: f64, time: f64) -> Option<T> {
    let last = samples.len().checked_sub(1)?;
    let position = (time * hz).clamp(0.0, last as f64);
    let index = (position as usize).min(last.saturating_sub(1));
    let u = position - index as f64;
    if last == 0 || u == 0.0 {
        return Some(samples[index]);
    }
    let (from, to) = (samples[index], samples[index + 1]);
    let before = if index > 0 { samples[index - 1] } else { from * 2.0 - to };
    let after = if index + 2 <= last { samples[index + 2] } else { to * 2.0 - from };
    let (start, end) = ((to - before) * 0.5, (after - from) * 0.5);
    let (u2, u3) = (u * u, u * u * u);
    Some(
        from * (2.0 * u3 - 3.0 * u2 + 1.0) + start * (u3 - 2.0 * u2 + u) + to * (3.0 * u2 - 2.0 * u3) + end * (u3 - u2),
    )
}

/// The same stretch of time at another rate: samples at 0, 1/to_hz, ... up to the last one's time.
pub fn resample<T: Sample>(samples: &[T], from_hz: f64, to_hz: f64) -> Vec<T> {
    let Some(last) = samples.len().checked_sub(1) else { return Vec::new() };
    if !(from_hz > 0.0 && to_hz > 0.0) {
        return samples.to_vec();
    }
    let count = (last as f64 / from_hz * to_hz + 1e-9).floor() as usize + 1;
    (0..count).filter_map(|index| value_at(samples, from_hz, index as f64 / to_hz)).collect()
}

/// One biquad, normalised.
struct Section {
    b0: f64,
    b1: f64,
    b2: f64,
    a1: f64,
    a2: f64,
}

impl Section {
    /// One pass of two that are together 3 dB down at `cutoff_hz`.
    fn butterworth(cutoff_hz: f64, hz: f64) -> Section {
        // Twice |H|² = 1/(1+r⁴): both are 1/√2 where r⁴ = √2 - 1.
        let corner = cutoff_hz / real::powf(std::f64::consts::SQRT_2 - 1.0, 0.25);
        let k = real::tan(std::f64::consts::PI * (corner / hz).min(0.499));
        let norm = 1.0 / (1.0 + std::f64::consts::SQRT_2 * k + k * k);
        Section {
            b0: k * k * norm,
            b1: 2.0 * k * k * norm,
            b2: k * k * norm,
            a1: 2.0 * (k * k - 1.0) * norm,
            a2: (1.0 - std::f64::consts::SQRT_2 * k + k * k) * norm,
        }
    }

    /// Filters in place, from the steady state of the first sample.
    fn run<'a, T: Sample + 'a>(&self, samples: impl Iterator<Item = &'a mut T>) {
        let mut state: Option<(T, T)> = None;
        for sample in samples {
            let x = *sample;
            let (s1, s2) = state.unwrap_or((x * (1.0 - self.b0), x * (self.b2 - self.a2)));
            let y = x * self.b0 + s1;
            state = Some((x * self.b1 - y * self.a1 + s2, x * self.b2 - y * self.a2));
            *sample = y;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec3, dvec3};
    use std::f64::consts::TAU;

    /// Gain and lag (samples) of the filter for a sine in the middle of a long series.
    fn response(frequency: f64) -> (f64, f64) {
        let hz = 120.0;
        let wave: Vec<f64> = (0..1200).map(|i| real::sin(TAU * frequency * f64::from(i) / hz)).collect();
        let out = zero_lag(&wave, 7.0, hz);
        let (mut in_phase, mut quadrature) = (0.0, 0.0);
        for (i, value) in out.iter().enumerate().take(840).skip(360) {
            let angle = TAU * frequency * i as f64 / hz;
            in_phase += value * real::sin(angle) / 240.0;
            quadrature += value * real::cos(angle) / 240.0;
        }
        (real::hypot(in_phase, quadrature), -real::atan2(quadrature, in_phase) / (TAU * frequency) * hz)
    }

    #[test]
    fn two_hertz_pass_thirty_die_seven_are_three_decibels_down() {
        assert!((response(2.0).0 - 1.0).abs() < 0.01, "{:?}", response(2.0));
        assert!((response(7.0).0 - 0.5_f64.sqrt()).abs() < 0.01, "{:?}", response(7.0));
        assert!(response(30.0).0 < 0.003, "{:?}", response(30.0));
    }

    #[test]
    fn nothing_lags() {
        for frequency in [1.0, 2.0, 5.0] {
            assert!(response(frequency).1.abs() < 1e-6, "{frequency} Hz lags {} samples", response(frequency).1);
        }
    }

    #[test]
    fn constants_and_ramps_come_back_exactly_even_from_short_series() {
        for count in [3, 5, 20, 500] {
            let ramp: Vec<DVec3> =
                (0..count).map(|i| dvec3(3.0, -0.5 * f64::from(i), 1.0 + 0.01 * f64::from(i))).collect();
            for (from, to) in ramp.iter().zip(zero_lag(&ramp, 7.0, 120.0)) {
                assert!(from.distance(to) < 1e-9, "{count}: {from} became {to}");
            }
        }
    }

    #[test]
    fn a_series_that_starts_in_mid_motion_keeps_its_ends() {
        let wave: Vec<f64> = (0..240).map(|i| real::sin(TAU * 1.0 * f64::from(i) / 120.0 + 0.7)).collect();
        let out = zero_lag(&wave, 7.0, 120.0);
        assert!((out[0] - wave[0]).abs() < 1e-9 && (out[239] - wave[239]).abs() < 1e-9);
        let worst = wave.iter().zip(&out).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst < 0.02, "{worst}");
    }

    #[test]
    fn derivatives_of_a_parabola_are_exact() {
        let hz = 50.0;
        let parabola: Vec<f64> = (0..20).map(|i| f64::from(i) / hz).map(|t| 1.0 + 2.0 * t - 4.905 * t * t).collect();
        for (i, speed) in derivative(&parabola, hz).iter().enumerate() {
            assert!((speed - (2.0 - 9.81 * i as f64 / hz)).abs() < 1e-9);
        }
        assert!(second_derivative(&parabola, hz).iter().all(|value| (value + 9.81).abs() < 1e-9));
        assert!(derivative::<f64>(&[], hz).is_empty());
        assert_eq!(second_derivative(&[1.0, 5.0], hz), [0.0, 0.0]);
    }

    #[test]
    fn resampling_keeps_the_curve_and_the_length() {
        let wave: Vec<f64> = (0..=30).map(|i| real::sin(TAU * f64::from(i) / 30.0)).collect();
        let fine = resample(&wave, 30.0, 120.0);
        assert_eq!(fine.len(), 121);
        for (i, value) in fine.iter().enumerate() {
            assert!((value - real::sin(TAU * i as f64 / 120.0)).abs() < 2e-3, "{i}");
        }
        assert!(resample::<f64>(&[], 30.0, 60.0).is_empty());
        assert_eq!(value_at(&wave, 30.0, -1.0), Some(0.0));
    }
}
