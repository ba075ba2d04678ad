//! Projections against dense linear algebra.

use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::super::projector::Projector;

fn random(rows: usize, columns: usize, seed: u64) -> DMatrix<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    DMatrix::from_fn(rows, columns, |_, _| rng.random_range(-1.0..1.0))
}

fn near(one: &DMatrix<f64>, other: &DMatrix<f64>, tolerance: f64) {
    let off = (one - other).amax();
    assert!(off <= tolerance * (1.0 + other.amax()), "{off:e}");
}

/// Projection orthogonal to the columns, by singular value decomposition.
fn dense_projection(design: &DMatrix<f64>) -> DMatrix<f64> {
    let left = design.clone().svd(true, false);
    let largest = left.singular_values.max();
    let kept: Vec<usize> = (0..left.singular_values.len())
        .filter(|k| left.singular_values[*k] > 1e-9 * largest)
        .collect();
    let basis = left.u.unwrap().select_columns(&kept);
    DMatrix::identity(design.nrows(), design.nrows()) - &basis * basis.transpose()
}

/// Columns of very different size, one of them duplicated and one zero, like parameters in different units of which
/// some are undetermined.
fn design() -> DMatrix<f64> {
    let mut design = random(30, 6, 1);
    for (k, scale) in [1.0, 1e4, 1e-4, 1.0, 1.0, 0.0].into_iter().enumerate() {
        design.column_mut(k).scale_mut(scale);
    }
    let twice = design.column(1) * 1e-2;
    design.set_column(4, &twice);
    design
}

#[test]
fn the_space_is_what_the_columns_leave() {
    let design = design();
    let residual = DVector::from_column_slice(random(30, 1, 2).as_slice());
    let projector = Projector::new(&design, &residual);
    assert_eq!(projector.rank(), 4);
    let identity = DMatrix::identity(4, 4);
    near(
        &projector.basis().tr_mul(projector.basis()),
        &identity,
        1e-9,
    );
    near(&(&design * projector.map()), projector.basis(), 1e-12);
    let dense = dense_projection(&design);
    let left = &dense * &residual;
    assert!((&projector.residual - left).amax() < 1e-8);
}
