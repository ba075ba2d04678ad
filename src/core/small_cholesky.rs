//! Cholesky factorisation of symmetric 6 x 6 matrices, over plain numbers or SIMD lanes.
//!
//! Matrices and factors are stored as their lower triangle row by row, see [`entry`]. A factor `L` of `A = L L^T` holds the
//! reciprocals of its diagonal, so that the kernels multiply instead of dividing.

use crate::real::Real;
use crate::tolerances::SINGULAR_PIVOT;

/// Number of entries of the lower triangle.
pub(crate) const TRIANGLE: usize = 21;

/// Index of entry `(row, column)`, `column <= row`, in a lower triangle of any size.
#[inline(always)]
pub(crate) const fn entry(row: usize, column: usize) -> usize {
    row * (row + 1) / 2 + column
}

/// Replaces `A`, whose diagonal is first multiplied by `1 + damping`, by its factor. A pivot that is NaN, or zero to working
/// precision, gets the reciprocal 0, so that nothing moves along it.
#[inline(always)]
pub(crate) fn factorise<T: Real>(a: &mut [T; TRIANGLE], damping: f64) {
    let zero = a[0].lift(0.0);
    let one = a[0].lift(1.0);
    for k in 0..6 {
        let grown = a[entry(k, k)] * zero.lift(1.0 + damping);
        let mut pivot = grown;
        for q in 0..k {
            let mut sum = a[entry(k, q)];
            for p in 0..q {
                sum = sum.minus_product(a[entry(k, p)], a[entry(q, p)]);
            }
            let value = sum * a[entry(q, q)];
            a[entry(k, q)] = value;
            pivot = pivot.minus_product(value, value);
        }
        let sound = pivot - grown * zero.lift(SINGULAR_PIVOT);
        let inverse = one / sound.select_positive(pivot, one).sqrt();
        a[entry(k, k)] = sound.select_positive(inverse, zero);
    }
}

/// `L^-1 b` in place.
#[inline(always)]
pub(crate) fn forward_substitute<T: Real>(factor: &[T; TRIANGLE], b: &mut [T; 6]) {
    for k in 0..6 {
        let mut sum = b[k];
        for q in 0..k {
            sum = sum.minus_product(factor[entry(k, q)], b[q]);
        }
        b[k] = sum * factor[entry(k, k)];
    }
}

/// `L^-T b` in place.
#[inline(always)]
pub(crate) fn back_substitute<T: Real>(factor: &[T; TRIANGLE], b: &mut [T; 6]) {
    for k in (0..6).rev() {
        for q in k + 1..6 {
            b[k] = b[k].minus_product(factor[entry(q, k)], b[q]);
        }
        b[k] = b[k] * factor[entry(k, k)];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lower triangle of `B^T B` for a matrix `B` with the given last column.
    fn square(last: [f64; 6]) -> [f64; TRIANGLE] {
        let column = |k: usize| -> [f64; 6] {
            std::array::from_fn(|i| {
                if k == 5 {
                    last[i]
                } else {
                    f64::from(i == k) + 0.1 * i as f64
                }
            })
        };
        let mut a = [0.0; TRIANGLE];
        for k in 0..6 {
            for q in 0..=k {
                a[entry(k, q)] = (0..6).map(|i| column(k)[i] * column(q)[i]).sum();
            }
        }
        a
    }

    #[test]
    fn substitutions_solve_the_system() {
        let a = square([0.3, -0.2, 0.5, 0.1, 0.4, 2.0]);
        let b = [1.0, -2.0, 0.5, 3.0, 0.2, -1.0];
        let (mut factor, mut x) = (a, b);
        factorise(&mut factor, 0.0);
        forward_substitute(&factor, &mut x);
        back_substitute(&factor, &mut x);
        for row in 0..6 {
            let product: f64 = (0..6)
                .map(|k| a[entry(row.max(k), row.min(k))] * x[k])
                .sum();
            assert!((product - b[row]).abs() < 1e-12, "{product} {}", b[row]);
        }
    }

    #[test]
    fn what_nothing_determines_does_not_move() {
        // The last column repeats the first.
        let mut factor = square([1.0, 0.1, 0.2, 0.3, 0.4, 0.5]);
        factorise(&mut factor, 0.0);
        assert_eq!(factor[entry(5, 5)], 0.0);
        let mut x = [1.0; 6];
        forward_substitute(&factor, &mut x);
        back_substitute(&factor, &mut x);
        assert_eq!(x[5], 0.0);
        assert!(x.iter().all(|v| v.is_finite()));
    }
}
