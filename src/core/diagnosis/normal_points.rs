//! Low-discrepancy normal variables for averaging over noise.

use nalgebra::{DMatrix, SymmetricEigen};

use crate::statistics::normal_quantile;

/// A matrix `R` with `R R^T` equal to a covariance, which may be singular.
pub(super) fn covariance_root(covariance: &DMatrix<f64>) -> DMatrix<f64> {
    let eigen = SymmetricEigen::new(covariance.clone());
    let mut root = eigen.eigenvectors;
    for (mut column, value) in root.column_iter_mut().zip(eigen.eigenvalues.iter()) {
        column *= value.max(0.0).sqrt();
    }
    root
}

/// Bases of the sequence, one prime number for each dimension.
const PRIMES: [u32; 12] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37];

/// Halton sequence of independent standard normal variables, one point per column.
pub(super) fn normal_points(dimensions: usize, count: usize) -> DMatrix<f64> {
    DMatrix::from_fn(dimensions, count, |row, point| {
        normal_quantile(radical_inverse(
            point as u32 + 1,
            PRIMES[row % PRIMES.len()],
        ))
    })
}

/// Reflects the digits of a number about the radix point.
fn radical_inverse(mut number: u32, base: u32) -> f64 {
    let (mut sum, mut place) = (0.0, 1.0);
    while number > 0 {
        place /= f64::from(base);
        sum += place * f64::from(number % base);
        number /= base;
    }
    sum
}
