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

    /// Information of the first column at this pose alone.
    pub fn size(&self) -> f64 {
        self.information[(0, 0)]
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
    /// Those of the first column, pose by pose.
    scores: DVector<f64>,
    sizes: Vec<f64>,
    /// Poses x dimensions.
    explained: DMatrix<f64>,
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
        let poses: Vec<PoseMoments> = scan.linear.poses.iter().map(of).collect();
        let taken = scan.space.taken();
        Self {
            scores: DVector::from_iterator(poses.len(), poses.iter().map(|p| p.score[0])),
            sizes: poses.iter().map(PoseMoments::size).collect(),
            explained: DMatrix::from_fn(poses.len(), taken, |j, k| poses[j].explained[(k, 0)]),
            poses,
        }
    }

    /// Score and information of a single column times the `weights` of each pose (poses x functions).
    pub fn weighted(&self, weights: &DMatrix<f64>) -> (DVector<f64>, DMatrix<f64>) {
        let score = weights.tr_mul(&self.scores);
        let mut information = self.explained.tr_mul(weights);
        information = -information.tr_mul(&information);
        for (j, size) in self.sizes.iter().enumerate() {
            let row = weights.row(j);
            information.ger(*size, &row.transpose(), &row.transpose(), 1.0);
        }
        (score, information)
    }
}
