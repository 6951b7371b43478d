//! Functions of a real number, the same to the last bit on every machine.
//!
//! The standard library's are those of the system, which rounds otherwise on another system, or on a processor that has other
//! instructions; a run of a body that balances makes a step of the difference. These are libm's, in Rust: arithmetic alone, in the order
//! in which it is written. Radians.

pub use libm::{
    acos, asin, atan, atan2, cbrt, cos, cosh, exp, hypot, log as ln, log2, log10, pow as powf, sin, sinh, tan, tanh,
};

/// Sine and cosine.
pub fn sin_cos(angle: f64) -> (f64, f64) {
    libm::sincos(angle)
}

/// A power of a number of 32 bits.
pub fn powf32(value: f32, power: f32) -> f32 {
    libm::powf(value, power)
}
