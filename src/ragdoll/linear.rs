//! Small dense systems: six unknowns, by Gauss with pivots. Pure arithmetic.
//!
//! Not `nalgebra`'s: its LU multiplies by the reciprocal of a pivot where this one divides, and its solution differs in the last bits
//! (of 993 of 1000 random systems), so every clip would; and it has no least pivot for singular ones.

/// A 6 x 6 matrix, row by row.
pub(super) type Matrix6 = [[f64; 6]; 6];

/// A factored system.
#[derive(Clone, Copy, Debug)]
pub(super) struct Factored {
    lu: Matrix6,
    order: [usize; 6],
}

impl Factored {
    /// Factors a matrix; pivots nearer to 0 than `least` are set to it, so that a singular one gives large numbers and no NaN.
    pub(super) fn new(mut a: Matrix6, least: f64) -> Factored {
        let mut order = [0, 1, 2, 3, 4, 5];
        for column in 0..6 {
            let mut pivot = column;
            for row in column + 1..6 {
                if a[row][column].abs() > a[pivot][column].abs() {
                    pivot = row;
                }
            }
            a.swap(column, pivot);
            order.swap(column, pivot);
            if a[column][column].abs() < least {
                a[column][column] = if a[column][column] < 0.0 { -least } else { least };
            }
            for row in column + 1..6 {
                let factor = a[row][column] / a[column][column];
                a[row][column] = factor;
                let above = a[column];
                for (value, above) in a[row].iter_mut().zip(above).skip(column + 1) {
                    *value -= factor * above;
                }
            }
        }
        Factored { lu: a, order }
    }

    /// The x of A x = b.
    pub(super) fn solve(&self, b: &[f64; 6]) -> [f64; 6] {
        let mut x = self.order.map(|row| b[row]);
        for row in 1..6 {
            for k in 0..row {
                x[row] -= self.lu[row][k] * x[k];
            }
        }
        for row in (0..6).rev() {
            for k in row + 1..6 {
                x[row] -= self.lu[row][k] * x[k];
            }
            x[row] /= self.lu[row][row];
        }
        x
    }
}

/// Damped least squares: x = Jᵀ (J Jᵀ + λ² I)⁻¹ b, bounded where J is singular. Returns the factors of J Jᵀ + λ² I.
pub(super) fn damped(j: &Matrix6, lambda: f64) -> Factored {
    let mut m = [[0.0; 6]; 6];
    for (r, row) in m.iter_mut().enumerate() {
        for (c, value) in row.iter_mut().enumerate() {
            *value = (0..6).map(|k| j[r][k] * j[c][k]).sum::<f64>() + if r == c { lambda * lambda } else { 0.0 };
        }
    }
    Factored::new(m, 1e-12)
}

/// Jᵀ y.
pub(super) fn transposed(j: &Matrix6, y: &[f64; 6]) -> [f64; 6] {
    let mut x = [0.0; 6];
    for (column, value) in x.iter_mut().enumerate() {
        *value = (0..6).map(|row| j[row][column] * y[row]).sum();
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_what_it_should_and_bounds_what_it_cannot() {
        let mut a = [[0.0; 6]; 6];
        for (r, row) in a.iter_mut().enumerate() {
            for (c, value) in row.iter_mut().enumerate() {
                *value = ((r * 7 + c * 3) % 5) as f64 + if r == c { 4.0 } else { 0.0 };
            }
        }
        let wanted = [1.0, -2.0, 3.0, 0.5, -0.25, 2.0];
        let mut b = [0.0; 6];
        for (r, value) in b.iter_mut().enumerate() {
            *value = (0..6).map(|k| a[r][k] * wanted[k]).sum();
        }
        for (got, want) in Factored::new(a, 1e-9).solve(&b).iter().zip(wanted) {
            assert!((got - want).abs() < 1e-9, "{got} {want}");
        }
        a[5] = a[4];
        let y = damped(&a, 0.05).solve(&b);
        assert!(transposed(&a, &y).iter().all(|x| x.abs() < 1e3));
    }
}
