//! Low-discrepancy normal variables for averaging over noise.

use nalgebra::DMatrix;

use crate::statistics::normal_quantile;

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
