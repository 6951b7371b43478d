//! Least squares over long time series: symmetric positive definite banded systems, solved in linear time.

/// A symmetric banded matrix and right-hand side, built up row by row from weighted equations.
#[derive(Clone, Debug)]
pub struct BandedLeastSquares {
    band: usize,
    matrix: Vec<f64>, // (n x (band + 1)): row i holds A[i][i], A[i][i+1], .., A[i][i+band]
    right: Vec<f64>,  // (n)
}

impl BandedLeastSquares {
    /// For `n` unknowns whose equations never join two unknowns more than `band` apart.
    pub fn new(n: usize, band: usize) -> Self {
        Self { band, matrix: vec![0.0; n * (band + 1)], right: vec![0.0; n] }
    }

    /// Adds weight * (Σ coefficients[k] x[first + k] - value)² to what is minimised.
    pub fn equation(&mut self, first: usize, coefficients: &[f64], value: f64, weight: f64) {
        debug_assert!(coefficients.len() <= self.band + 1, "an equation wider than the band");
        for (i, a) in coefficients.iter().enumerate() {
            let row = first + i;
            for (j, b) in coefficients.iter().enumerate().skip(i) {
                self.matrix[row * (self.band + 1) + j - i] += weight * a * b;
            }
            self.right[row] += weight * a * value;
        }
    }

    /// The minimum, by banded Cholesky. A direction that no equation speaks of stays at 0.
    pub fn solve(mut self) -> Vec<f64> {
        let (n, width) = (self.right.len(), self.band + 1);
        for i in 0..n {
            let pivot = self.matrix[i * width].max(1e-12).sqrt();
            self.matrix[i * width] = pivot;
            for k in 1..width {
                self.matrix[i * width + k] /= pivot;
            }
            for k in 1..width.min(n - i) {
                let factor = self.matrix[i * width + k];
                for l in k..width {
                    self.matrix[(i + k) * width + l - k] -= factor * self.matrix[i * width + l];
                }
            }
        }
        let mut x = self.right;
        for i in 0..n {
            x[i] /= self.matrix[i * width];
            for k in 1..width.min(n - i) {
                x[i + k] -= self.matrix[i * width + k] * x[i];
            }
        }
        for i in (0..n).rev() {
            for k in 1..width.min(n - i) {
                x[i] -= self.matrix[i * width + k] * x[i + k];
            }
            x[i] /= self.matrix[i * width];
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::real;

    #[test]
    fn solves_a_smoothing_problem_to_its_normal_equations() {
        let n = 50;
        let mut system = BandedLeastSquares::new(n, 2);
        for i in 0..n {
            system.equation(i, &[1.0], real::sin(i as f64 * 0.3), 1.0);
        }
        for i in 0..n - 2 {
            system.equation(i, &[1.0, -2.0, 1.0], 0.0, 5.0);
        }
        let x = system.clone().solve();
        for i in 0..n {
            let mut sum = -system.right[i];
            for k in 0..=2 {
                if i + k < n {
                    sum += system.matrix[i * 3 + k] * x[i + k];
                }
                if k > 0 && i >= k {
                    sum += system.matrix[(i - k) * 3 + k] * x[i - k];
                }
            }
            assert!(sum.abs() < 1e-9, "row {i} is off by {sum}");
        }
    }
}
