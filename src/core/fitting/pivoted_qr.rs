//! Orthogonal triangularisation with column pivoting, in doubled precision.

use super::double_double::DoubleDouble;

/// Upper triangle `R` of `A P = Q R` and the transformed right-hand side `Q^T b`.
///
/// Householder reflections with column pivoting (Golub, Van Loan, *Matrix Computations*, section
/// 5.4.2): the column with the longest remainder comes next, so that the
/// diagonal of `R` decreases and reveals the numerical rank.
pub(super) struct PivotedQr {
    /// `columns[j][..=j]` is column `j` of `R`.
    columns: Vec<Vec<DoubleDouble>>,
    right_hand_side: Vec<DoubleDouble>,
    /// Index of the column of `A` at each position of `R`.
    pub(super) order: Vec<usize>,
    /// Number of columns that are linearly independent within the tolerance.
    pub(super) rank: usize,
}

impl PivotedQr {
    /// Triangularises the columns and carries the right-hand side along. A column whose remainder
    /// is below `tolerance` times the largest diagonal element depends on those before it.
    pub(super) fn new(
        columns: Vec<Vec<DoubleDouble>>,
        right_hand_side: Vec<DoubleDouble>,
        tolerance: f64,
    ) -> Self {
        let steps = columns.len().min(right_hand_side.len());
        let mut qr = Self {
            order: (0..columns.len()).collect(),
            columns,
            right_hand_side,
            rank: 0,
        };
        let mut largest = 0.0_f64;
        for step in 0..steps {
            let remainder = qr.bring_longest_column_to(step);
            largest = largest.max(remainder);
            if remainder <= tolerance * largest || remainder == 0.0 {
                break;
            }
            qr.reflect(step);
            qr.rank += 1;
        }
        qr
    }

    /// Swaps the column with the longest remainder to position `step`; returns its length.
    fn bring_longest_column_to(&mut self, step: usize) -> f64 {
        let (mut best, mut longest) = (step, -1.0);
        for j in step..self.columns.len() {
            let rest = &self.columns[j][step..];
            let length = DoubleDouble::dot(rest, rest).to_f64();
            if length > longest {
                (best, longest) = (j, length);
            }
        }
        self.columns.swap(step, best);
        self.order.swap(step, best);
        longest.max(0.0).sqrt()
    }

    /// Reflects column `step` onto its diagonal element and applies the reflection to the rest.
    fn reflect(&mut self, step: usize) {
        let mut normal = self.columns[step][step..].to_vec();
        let length = DoubleDouble::dot(&normal, &normal).sqrt();
        // The sign that avoids cancellation in the normal's first element.
        let diagonal = if normal[0].to_f64() > 0.0 {
            -length
        } else {
            length
        };
        normal[0] = normal[0] - diagonal;
        let half_square = -(diagonal * normal[0]);
        let apply = |vector: &mut [DoubleDouble]| {
            let factor = DoubleDouble::dot(&normal, vector) / half_square;
            for (element, normal) in vector.iter_mut().zip(&normal) {
                *element = *element - factor * *normal;
            }
        };
        for column in &mut self.columns[step + 1..] {
            apply(&mut column[step..]);
        }
        apply(&mut self.right_hand_side[step..]);
        self.columns[step][step] = diagonal;
    }

    /// The least-squares solution in the order of the pivoted columns, the first `rank` of them.
    pub(super) fn solve(&self) -> Vec<DoubleDouble> {
        self.back_substitute(&self.right_hand_side[..self.rank])
    }

    /// Columns of `R^-1` of the leading `rank` columns.
    pub(super) fn inverse(&self) -> Vec<Vec<DoubleDouble>> {
        (0..self.rank)
            .map(|k| {
                let mut unit = vec![DoubleDouble::ZERO; self.rank];
                unit[k] = DoubleDouble::ONE;
                self.back_substitute(&unit)
            })
            .collect()
    }

    fn back_substitute(&self, right_hand_side: &[DoubleDouble]) -> Vec<DoubleDouble> {
        let mut x = right_hand_side.to_vec();
        for j in (0..self.rank).rev() {
            x[j] = x[j] / self.columns[j][j];
            for i in 0..j {
                x[i] = x[i] - self.columns[j][i] * x[j];
            }
        }
        x
    }
}
