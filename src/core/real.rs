//! The scalar type of the prediction: plain reals or SIMD lanes, one pose per lane.
//!
//! The equations of the model are written once, over [`Real`]. With `f64` they predict one
//! reading; with [`Lanes`] they predict the same reading of several poses at once.

use std::ops::{Add, Div, Mul, Neg, Sub};

use pulp::{Simd, WithSimd};

/// Arithmetic used by the prediction.
pub trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The constant as a value of the type of `self`.
    #[must_use]
    fn lift(self, constant: f64) -> Self;
    /// Square root.
    #[must_use]
    fn sqrt(self) -> Self;
    /// `self * factor + term`, rounded once where the processor can.
    #[must_use]
    fn mul_add(self, factor: Self, term: Self) -> Self;
    /// `self - a * b`, rounded once where the processor can.
    #[must_use]
    fn minus_product(self, a: Self, b: Self) -> Self;
    /// The larger of two values.
    #[must_use]
    fn max(self, other: Self) -> Self;
    /// The smaller of two values.
    #[must_use]
    fn min(self, other: Self) -> Self;
    /// `if_positive` where `self > 0`, else `otherwise`.
    #[must_use]
    fn select_positive(self, if_positive: Self, otherwise: Self) -> Self;
    /// `self` and 1 where it is a number; 0 and 0 where it is NaN.
    #[must_use]
    fn present(self) -> (Self, Self);
    /// Angle of the point `(x, self)`, in `(-pi, pi]`.
    #[must_use]
    fn atan2(self, x: Self) -> Self;
}

impl Real for f64 {
    #[inline(always)]
    fn lift(self, constant: f64) -> Self {
        constant
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        // A fused operation without hardware support is a slow library call.
        self * factor + term
    }
    #[inline(always)]
    fn minus_product(self, a: Self, b: Self) -> Self {
        self - a * b
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        f64::max(self, other)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        f64::min(self, other)
    }
    #[inline(always)]
    fn select_positive(self, if_positive: Self, otherwise: Self) -> Self {
        if self > 0.0 { if_positive } else { otherwise }
    }
    #[inline(always)]
    fn present(self) -> (Self, Self) {
        if self.is_nan() {
            (0.0, 0.0)
        } else {
            (self, 1.0)
        }
    }
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        f64::atan2(self, x)
    }
}

/// A SIMD vector of reals, one pose per lane; aligned to cache lines, as a load across two of them takes
/// twice as long.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Lanes<S: Simd> {
    simd: S,
    value: S::f64s,
}

impl<S: Simd> Lanes<S> {
    /// A value of the same instruction set.
    #[inline(always)]
    fn with(self, value: S::f64s) -> Self {
        Self { value, ..self }
    }
}

/// A [`Real`] that holds one or more poses and can be loaded from and stored to memory.
pub trait Packet: Real + Send + Sync {
    /// Instruction set, which is needed to make a value.
    type Token: Copy + Send + Sync + std::fmt::Debug;
    /// Number of poses in a packet.
    const LANES: usize;
    /// The same value in all lanes.
    fn splat(token: Self::Token, value: f64) -> Self;
    /// Packet number `index` of a slice of whole packets.
    fn load(token: Self::Token, slice: &[f64], index: usize) -> Self;
    /// Writes packet number `index` of a slice of whole packets.
    fn store(self, slice: &mut [f64], index: usize);
    /// Sum over the lanes.
    fn sum(self) -> f64;
    /// Runs a kernel compiled for this instruction set.
    fn run<K: Kernel>(token: Self::Token, kernel: K) -> K::Output;
}

/// A hot piece of code that [`Packet::run`] compiles once per instruction set; its `call` and all
/// it calls must be `#[inline(always)]`.
pub trait Kernel {
    /// Result of the kernel.
    type Output;
    /// Runs the kernel.
    fn call(self) -> Self::Output;
}

struct Vectorized<K>(K);

impl<K: Kernel> WithSimd for Vectorized<K> {
    type Output = K::Output;
    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) -> K::Output {
        self.0.call()
    }
}

impl Packet for f64 {
    type Token = ();
    const LANES: usize = 1;
    #[inline(always)]
    fn splat((): (), value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn load((): (), slice: &[f64], index: usize) -> Self {
        slice[index]
    }
    #[inline(always)]
    fn store(self, slice: &mut [f64], index: usize) {
        slice[index] = self;
    }
    #[inline(always)]
    fn sum(self) -> f64 {
        self
    }
    fn run<K: Kernel>((): (), kernel: K) -> K::Output {
        kernel.call()
    }
}

impl<S: Simd> Packet for Lanes<S> {
    type Token = S;
    const LANES: usize = S::F64_LANES;
    #[inline(always)]
    fn splat(simd: S, value: f64) -> Self {
        Self {
            simd,
            value: simd.splat_f64s(value),
        }
    }
    #[inline(always)]
    fn load(simd: S, slice: &[f64], index: usize) -> Self {
        Self {
            simd,
            value: S::as_simd_f64s(slice).0[index],
        }
    }
    #[inline(always)]
    fn store(self, slice: &mut [f64], index: usize) {
        S::as_mut_simd_f64s(slice).0[index] = self.value;
    }
    #[inline(always)]
    fn sum(self) -> f64 {
        self.simd.reduce_sum_f64s(self.value)
    }
    #[inline(always)]
    fn run<K: Kernel>(simd: S, kernel: K) -> K::Output {
        simd.vectorize(Vectorized(kernel))
    }
}

macro_rules! lane_operator {
    ($trait:ident, $method:ident, $simd_method:ident) => {
        impl<S: Simd> $trait for Lanes<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.with(self.simd.$simd_method(self.value, other.value))
            }
        }
    };
}
lane_operator!(Add, add, add_f64s);
lane_operator!(Sub, sub, sub_f64s);
lane_operator!(Mul, mul, mul_f64s);
lane_operator!(Div, div, div_f64s);

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.with(self.simd.neg_f64s(self.value))
    }
}

impl<S: Simd> Real for Lanes<S> {
    #[inline(always)]
    fn lift(self, constant: f64) -> Self {
        Self::splat(self.simd, constant)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.with(self.simd.sqrt_f64s(self.value))
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        let simd = self.simd;
        self.with(simd.mul_add_e_f64s(self.value, factor.value, term.value))
    }
    #[inline(always)]
    fn minus_product(self, a: Self, b: Self) -> Self {
        let simd = self.simd;
        self.with(simd.negate_mul_add_e_f64s(a.value, b.value, self.value))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.with(self.simd.max_f64s(self.value, other.value))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.with(self.simd.min_f64s(self.value, other.value))
    }
    #[inline(always)]
    fn select_positive(self, if_positive: Self, otherwise: Self) -> Self {
        let simd = self.simd;
        let mask = simd.greater_than_f64s(self.value, simd.splat_f64s(0.0));
        self.with(simd.select_f64s(mask, if_positive.value, otherwise.value))
    }
    #[inline(always)]
    fn present(self) -> (Self, Self) {
        let simd = self.simd;
        let mask = simd.equal_f64s(self.value, self.value);
        let zero = simd.splat_f64s(0.0);
        let one = simd.splat_f64s(1.0);
        (
            self.with(simd.select_f64s(mask, self.value, zero)),
            self.with(simd.select_f64s(mask, one, zero)),
        )
    }
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        atan2_lanes(self, x)
    }
}

/// Numerator and denominator of `(atan(t) - t) / t^3` in `t^2` for `|t| <= tan(pi/8)`
/// (Moshier, Cephes library, atan.c: relative error below 2e-16).
const ATAN_NUMERATOR: [f64; 5] = [
    -8.750_608_600_031_904e-1,
    -1.615_753_718_733_365e1,
    -7.500_855_792_314_705e1,
    -1.228_866_684_490_136_1e2,
    -6.485_021_904_942_025e1,
];
const ATAN_DENOMINATOR: [f64; 5] = [
    2.485_846_490_142_306_3e1,
    1.650_270_098_316_988_5e2,
    4.328_810_604_912_903e2,
    4.853_903_996_359_137e2,
    1.945_506_571_482_614e2,
];

/// `atan2` without branches: reduce to an angle below pi/8, approximate, unfold.
#[inline(always)]
fn atan2_lanes<S: Simd>(y: Lanes<S>, x: Lanes<S>) -> Lanes<S> {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
    let zero = y.lift(0.0);
    let (abs_y, abs_x) = (y.max(-y), x.max(-x));
    let (small, large) = (abs_y.min(abs_x), abs_y.max(abs_x));
    let beyond = small - large * y.lift(0.414_213_562_373_095);
    let numerator = beyond.select_positive(small - large, small);
    let denominator = beyond.select_positive(small + large, large);
    // Avoids 0/0: the angle is then 0.
    let t = numerator / denominator.max(y.lift(f64::MIN_POSITIVE));
    let z = t * t;
    let mut p = y.lift(ATAN_NUMERATOR[0]);
    let mut q = z + y.lift(ATAN_DENOMINATOR[0]);
    for k in 1..5 {
        p = p.mul_add(z, y.lift(ATAN_NUMERATOR[k]));
        q = q.mul_add(z, y.lift(ATAN_DENOMINATOR[k]));
    }
    let reduced = t.mul_add(z * p / q, t) + beyond.select_positive(y.lift(FRAC_PI_4), zero);
    let first_quadrant = (abs_y - abs_x).select_positive(y.lift(FRAC_PI_2) - reduced, reduced);
    let upper = (-x).select_positive(y.lift(PI) - first_quadrant, first_quadrant);
    (-y).select_positive(-upper, upper)
}

/// Dot product.
#[inline(always)]
pub fn dot<T: Real>(a: [T; 3], b: [T; 3]) -> T {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

/// Sum of squares.
#[inline(always)]
pub fn square_norm<T: Real, const N: usize>(a: [T; N]) -> T {
    let mut sum = a[0] * a[0];
    for k in 1..N {
        sum = a[k].mul_add(a[k], sum);
    }
    sum
}

/// Cross product.
#[inline(always)]
pub fn cross<T: Real>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

// Closures over lanes are compiled for the baseline processor, not for the instruction set chosen at
// run time; hot code therefore uses loops where `map` and `fold` would be more readable.

/// `scale * a`.
#[inline(always)]
pub fn scaled<T: Real, const N: usize>(mut a: [T; N], scale: T) -> [T; N] {
    for v in &mut a {
        *v = *v * scale;
    }
    a
}

/// `-a`.
#[inline(always)]
pub fn negated<T: Real, const N: usize>(mut a: [T; N]) -> [T; N] {
    for v in &mut a {
        *v = -*v;
    }
    a
}

/// Constants as values of the type of `like`.
#[inline(always)]
pub fn constants<T: Real, const N: usize>(like: T, values: [f64; N]) -> [T; N] {
    let mut result = [like; N];
    for k in 0..N {
        result[k] = like.lift(values[k]);
    }
    result
}

/// Unit vector along an axis.
#[inline(always)]
pub fn unit_vector<T: Real>(like: T, axis: usize) -> [T; 3] {
    let mut result = [like.lift(0.0); 3];
    result[axis] = like.lift(1.0);
    result
}

/// `a * factor + b`.
#[inline(always)]
pub fn add_scaled<T: Real>(b: [T; 3], factor: T, a: [T; 3]) -> [T; 3] {
    [
        a[0].mul_add(factor, b[0]),
        a[1].mul_add(factor, b[1]),
        a[2].mul_add(factor, b[2]),
    ]
}

/// `a - b`.
#[inline(always)]
pub fn difference<T: Real>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use pulp::Arch;

    struct CompareAtan2<'a>(&'a [(f64, f64)]);

    impl WithSimd for CompareAtan2<'_> {
        type Output = f64;
        fn with_simd<S: Simd>(self, simd: S) -> f64 {
            let mut worst = 0.0_f64;
            let mut lanes = vec![0.0; S::F64_LANES];
            for (y, x) in self.0 {
                let angle = Lanes::splat(simd, *y).atan2(Lanes::splat(simd, *x));
                angle.store(&mut lanes, 0);
                let expected = f64::atan2(*y, *x);
                for lane in &lanes {
                    worst = worst.max((lane - expected).abs() / expected.abs().max(1e-300));
                }
            }
            worst
        }
    }

    #[test]
    fn vector_atan2_agrees_with_the_scalar_one() {
        let mut points = vec![(0.0, 1.0), (1.0, 1e-12), (1e-9, 1.0), (1.0, -1.0)];
        for k in 0..5000 {
            let angle = f64::from(k).mul_add(0.001_256, -3.13);
            points.push((3.7 * angle.sin(), 3.7 * angle.cos()));
        }
        let worst = Arch::new().dispatch(CompareAtan2(&points));
        assert!(worst < 1e-15, "relative error {worst:e}");
    }
}
