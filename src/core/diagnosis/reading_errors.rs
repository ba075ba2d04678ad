//! Errors of single readings as columns of the linear problem. A reading affects only the conditions of its own pose,
//! so products with functions of the pose are cheap.

use nalgebra::{DMatrix, DVector};

use super::reduced_problem::ReducedProblem;

/// Score and information of a unit error in the readings of some classes at each pose.
pub(super) struct ReadingErrors {
    score: DVector<f64>,
    /// Squared norm of the whitened error at each pose.
    squares: DVector<f64>,
    /// `U^T` times the whitened error, one column per pose.
    eliminated: DMatrix<f64>,
}

impl ReadingErrors {
    pub fn new(base: &ReducedProblem<'_>, classes: &[usize]) -> Self {
        let errors = base.noise.unit_errors(classes);
        let mut reading_errors = Self {
            score: DVector::zeros(errors.len()),
            squares: DVector::zeros(errors.len()),
            eliminated: DMatrix::zeros(base.eliminated.nrows(), errors.len()),
        };
        for (pose, (first, error)) in errors.iter().enumerate() {
            reading_errors.score[pose] = error.dot(&base.residual.rows(*first, error.len()));
            reading_errors.squares[pose] = error.norm_squared();
            let eliminated = base.eliminated.columns(*first, error.len()) * error;
            reading_errors.eliminated.set_column(pose, &eliminated);
        }
        reading_errors
    }

    /// Score and information of errors that are functions of the pose, one function per column and one row per pose.
    pub fn of(&self, functions: &DMatrix<f64>) -> (DVector<f64>, DMatrix<f64>) {
        let mut weighted = functions.clone();
        for (mut row, square) in weighted.row_iter_mut().zip(self.squares.iter()) {
            row *= *square;
        }
        let eliminated = &self.eliminated * functions;
        let information = functions.transpose() * weighted - eliminated.transpose() * &eliminated;
        (functions.tr_mul(&self.score), information)
    }
}
