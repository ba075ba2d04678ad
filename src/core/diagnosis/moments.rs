//! What columns say pose by pose: an event is a sum over poses, a wave or a smooth function a weighted sum.

use nalgebra::{DMatrix, DVector};

use super::scores::{Block, Scan};

/// Score and information of columns that act at one pose, or at several together.
#[derive(Debug, Clone)]
pub(super) struct PoseMoments {
    /// Row of the measurements.
    pub row: usize,
    score: DVector<f64>,
    information: DMatrix<f64>,
    /// `V^T C`, what the estimated parameters explain.
    explained: DMatrix<f64>,
}

impl PoseMoments {
    pub fn add(&mut self, other: &Self) {
        self.score += &other.score;
        self.information += &other.information;
        self.explained += &other.explained;
    }

    /// The score test of the columns acting at these poses.
    pub fn block(&self, prior: &[f64]) -> Option<Block> {
        let information = &self.information - self.explained.tr_mul(&self.explained);
        Block::new(&self.score, &information, prior)
    }
}

/// The moments of columns at every pose.
#[derive(Debug, Clone)]
pub(super) struct Moments {
    pub poses: Vec<PoseMoments>,
}

impl Moments {
    /// Of `columns`, before projection, in the rows of a scan.
    pub fn new(columns: &DMatrix<f64>, scan: &Scan) -> Self {
        let of = |block: &crate::estimation::PoseBlock| {
            let (first, count) = (block.rows.start, block.rows.len());
            let columns = columns.rows(first, count);
            PoseMoments {
                row: block.row,
                score: columns.tr_mul(&scan.space.residual.rows(first, count)),
                information: columns.tr_mul(&columns),
                explained: scan.space.basis().rows(first, count).tr_mul(&columns),
            }
        };
        Self {
            poses: scan.linear.poses.iter().map(of).collect(),
        }
    }

    /// Score and information of a single column times the `weights` of each pose (poses x functions).
    pub fn weighted(&self, weights: &DMatrix<f64>) -> (DVector<f64>, DMatrix<f64>) {
        let n = weights.ncols();
        let taken = self.poses.first().map_or(0, |pose| pose.explained.nrows());
        let mut score = DVector::zeros(n);
        let mut information = DMatrix::zeros(n, n);
        let mut explained = DMatrix::zeros(taken, n);
        for (j, pose) in self.poses.iter().enumerate() {
            let row = weights.row(j);
            for k in 0..n {
                score[k] += row[k] * pose.score[0];
                explained
                    .column_mut(k)
                    .axpy(row[k], &pose.explained.column(0), 1.0);
                for q in 0..n {
                    information[(k, q)] += row[k] * row[q] * pose.information[(0, 0)];
                }
            }
        }
        information -= explained.tr_mul(&explained);
        (score, information)
    }
}
