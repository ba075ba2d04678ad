//! Projection of the readings orthogonal to all parameters that are always estimated.

use nalgebra::{Cholesky, DMatrix, DVector, SymmetricEigen};

use super::budget::{SINGULAR, WELL_DETERMINED};
use super::dense::transposed_times;

/// Projector onto the space orthogonal to the columns of a design.
#[derive(Debug, Clone)]
pub(super) struct Projector {
    /// Orthonormal basis `V` of the columns.
    basis: DMatrix<f64>,
    /// Matrix for which `design * map = V`.
    map: DMatrix<f64>,
    /// Projected residual.
    pub residual: DVector<f64>,
}

impl Projector {
    /// The projector for `design` (rows x parameters), with the residual of its rows.
    pub fn new(design: &DMatrix<f64>, residual: &DVector<f64>) -> Self {
        let map = orthonormal_map(design);
        let mut projector = Self {
            basis: design * &map,
            map,
            residual: residual.clone(),
        };
        projector.residual -= &projector.basis * projector.basis.tr_mul(residual);
        projector
    }

    /// Rank of the design.
    pub fn rank(&self) -> usize {
        self.basis.ncols()
    }

    /// The basis of the columns.
    pub fn basis(&self) -> &DMatrix<f64> {
        &self.basis
    }

    /// Parameter changes for coordinates in the basis.
    pub fn map(&self) -> &DMatrix<f64> {
        &self.map
    }
}

/// Matrix that orthonormalises the columns of `design`: from the Cholesky factor of its scaled normal matrix, or where the
/// data leave a parameter nearly undetermined, from the eigenvectors.
fn orthonormal_map(design: &DMatrix<f64>) -> DMatrix<f64> {
    if design.is_empty() {
        return DMatrix::zeros(design.ncols(), 0);
    }
    let normal = transposed_times(design, design);
    let scale = normal
        .diagonal()
        .map(|d| if d > 0.0 { d.sqrt().recip() } else { 0.0 });
    let n = normal.nrows();
    let scaled = DMatrix::from_fn(n, n, |i, k| normal[(i, k)] * scale[i] * scale[k]);
    if let Some(factor) = Cholesky::new(scaled.clone()).map(|factor| factor.l())
        && factor.diagonal().min().powi(2) > WELL_DETERMINED
        && let Some(inverse) = factor.solve_lower_triangular(&DMatrix::identity(n, n))
    {
        return DMatrix::from_fn(n, n, |i, k| scale[i] * inverse[(k, i)]);
    }
    let eigen = SymmetricEigen::new(scaled);
    let largest = eigen.eigenvalues.max();
    let kept: Vec<usize> = (0..eigen.eigenvalues.len())
        .filter(|k| eigen.eigenvalues[*k] > SINGULAR * largest)
        .collect();
    DMatrix::from_fn(n, kept.len(), |i, k| {
        scale[i] * eigen.eigenvectors[(i, kept[k])] / eigen.eigenvalues[kept[k]].sqrt()
    })
}
