//! What is left of the readings once everything that is estimated anyway has been fitted.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Part of the largest eigenvalue, of the information in its own scale, below which a direction counts as
/// undetermined.
const SINGULAR: f64 = 1e-12;

/// The space orthogonal to the columns of a design.
#[derive(Debug, Clone)]
pub(super) struct Space {
    /// Orthonormal basis `V` of the columns.
    basis: DMatrix<f64>,
    /// `design * map = V`.
    map: DMatrix<f64>,
    /// Residual without what the columns could still explain.
    pub residual: DVector<f64>,
}

impl Space {
    /// The space left by `design` (rows x parameters), with the residual of its rows.
    pub fn new(design: &DMatrix<f64>, residual: &DVector<f64>) -> Self {
        let map = orthonormal_map(design);
        let mut space = Self {
            basis: design * &map,
            map,
            residual: residual.clone(),
        };
        space.residual -= &space.basis * space.basis.tr_mul(residual);
        space
    }

    /// Number of dimensions taken away.
    pub fn taken(&self) -> usize {
        self.basis.ncols()
    }

    /// The basis of the columns.
    pub fn basis(&self) -> &DMatrix<f64> {
        &self.basis
    }

    /// Step of the parameters from coordinates in the basis.
    pub fn map(&self) -> &DMatrix<f64> {
        &self.map
    }

    /// `columns - V V^T columns`.
    pub fn project(&self, columns: &DMatrix<f64>) -> DMatrix<f64> {
        columns - &self.basis * self.basis.tr_mul(columns)
    }
}

/// Matrix that makes the columns of `design` orthonormal, by the eigenvectors of its scaled normal matrix: a
/// Cholesky factor fails where the data leave a parameter open.
fn orthonormal_map(design: &DMatrix<f64>) -> DMatrix<f64> {
    if design.is_empty() {
        return DMatrix::zeros(design.ncols(), 0);
    }
    let normal = design.tr_mul(design);
    let scale = normal
        .diagonal()
        .map(|d| if d > 0.0 { d.sqrt().recip() } else { 0.0 });
    let scaled = DMatrix::from_fn(normal.nrows(), normal.ncols(), |i, k| {
        normal[(i, k)] * scale[i] * scale[k]
    });
    let eigen = SymmetricEigen::new(scaled);
    let largest = eigen.eigenvalues.max();
    let kept: Vec<usize> = (0..eigen.eigenvalues.len())
        .filter(|k| eigen.eigenvalues[*k] > SINGULAR * largest)
        .collect();
    DMatrix::from_fn(normal.nrows(), kept.len(), |i, k| {
        scale[i] * eigen.eigenvectors[(i, kept[k])] / eigen.eigenvalues[kept[k]].sqrt()
    })
}

/// Largest cosine of the angle between the spans of two sets of projected columns.
pub(super) fn cosine(one: &DMatrix<f64>, other: &DMatrix<f64>) -> f64 {
    let (one, other) = (one * orthonormal_map(one), other * orthonormal_map(other));
    if one.is_empty() || other.is_empty() {
        return 0.0;
    }
    one.tr_mul(&other).singular_values().max().min(1.0)
}
