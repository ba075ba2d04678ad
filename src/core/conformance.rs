//! Conformance with a tolerance (JCGM 106:2012, The role of measurement uncertainty in conformity assessment).

use nalgebra::{DMatrix, DVector, Matrix3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::geometry::Vec3;
use crate::statistics::normal_cdf;

/// Standard deviations to either side of the mean beyond which a normal density is left out: it holds 1e-15 there.
const REACH: f64 = 8.0;
/// Standard deviations below this fraction of the tolerance count as 0, as their densities are lost in rounding.
const EXACT: f64 = 1e-9;
/// Absolute error of an integral at which its interval is no longer divided.
const INTEGRATED: f64 = 1e-8;
/// Largest number of times that an interval is halved.
const DIVISIONS: usize = 30;

/// Conformance probability (JCGM 106:2012, 3.3.7): probability that the distance of a point from its nominal place is within
/// `tolerance` (m), given the best estimate `deviation` of the point from that place (m) and its `covariance` (m^2), for a
/// normal distribution.
///
/// In the principal axes of the covariance, with means `m_k` and standard deviations `s_k`, it is the integral of the
/// density over the ball. Along the last axis it is a difference of two normal distribution functions, along the others
/// it is integrated numerically (Gauss and Kronrod, 7 and 15 points), the least uncertain axis first. The absolute error is below
/// 1e-6. A coordinate without variance is exact.
#[must_use]
pub fn conformance_probability(deviation: &Vec3, covariance: &Matrix3<f64>, tolerance: f64) -> f64 {
    let principal = covariance.symmetric_eigen();
    let mean = principal.eigenvectors.tr_mul(deviation);
    let mut axes = [0, 1, 2].map(|k| Axis {
        mean: mean[k],
        sd: principal.eigenvalues[k].max(0.0).sqrt(),
    });
    for axis in &mut axes {
        if axis.sd < EXACT * tolerance {
            axis.sd = 0.0;
        }
    }
    axes.sort_by(|a, b| a.sd.total_cmp(&b.sd));
    within(&axes, tolerance * tolerance).clamp(0.0, 1.0)
}

/// Number of draws of the joint probability: its standard error is at most 0.4 %.
const DRAWS: usize = 20_000;

/// Probability that several points are all within `tolerance` (m) of their nominal places, given their `deviations` (m) and the
/// joint `covariance` of all coordinates (m^2, 3n x 3n, point by point), for a normal distribution (JCGM 106:2012, 3.3.7). By Monte
/// Carlo with a fixed seed; `None` if the covariance is not positive semidefinite.
#[must_use]
pub fn joint_conformance_probability(
    deviations: &[Vec3],
    covariance: &DMatrix<f64>,
    tolerance: f64,
) -> Option<f64> {
    let scale = covariance.diagonal().amax().max(f64::MIN_POSITIVE);
    // Coordinates that were not estimated have no variance.
    let jitter = DMatrix::identity(covariance.nrows(), covariance.ncols()) * (1e-12 * scale);
    let root = (covariance + jitter).cholesky()?.unpack();
    let mut rng = ChaCha8Rng::seed_from_u64(0);
    let mut drawn = DVector::zeros(covariance.nrows());
    let is_within = |errors: &DVector<f64>| {
        let mut places = deviations.iter().enumerate();
        places.all(|(k, deviation)| (deviation + errors.fixed_rows::<3>(3 * k)).norm() <= tolerance)
    };
    let within = (0..DRAWS).filter(|_| {
        drawn
            .iter_mut()
            .for_each(|one| *one = StandardNormal.sample(&mut rng));
        is_within(&(&root * &drawn))
    });
    Some(within.count() as f64 / DRAWS as f64)
}

/// Distribution of the deviation along a principal axis.
#[derive(Debug, Clone, Copy)]
struct Axis {
    mean: f64,
    sd: f64,
}

/// Probability that the sum of the squares along these axes is at most `square`.
fn within(axes: &[Axis], square: f64) -> f64 {
    let Some((first, rest)) = axes.split_first() else {
        return if square >= 0.0 { 1.0 } else { 0.0 };
    };
    if square < 0.0 {
        return 0.0;
    }
    let Axis { mean, sd } = *first;
    if sd == 0.0 {
        return within(rest, square - mean * mean);
    }
    let radius = square.sqrt();
    if rest.is_empty() {
        return normal_cdf((radius - mean) / sd) - normal_cdf((-radius - mean) / sd);
    }
    let [from, to] = [mean - REACH * sd, mean + REACH * sd];
    let [from, to] = [from.max(-radius), to.min(radius)];
    if from >= to {
        return 0.0;
    }
    // The remaining radius has a vertical tangent at both ends, which the angle removes.
    let density = |angle: f64| {
        let (sine, cosine) = angle.sin_cos();
        let off = (radius * sine - mean) / sd;
        let remaining = within(rest, square * cosine * cosine);
        radius * cosine / sd * (-0.5 * off * off).exp() * remaining
    };
    let [from, to] = [from, to].map(|end| (end / radius).asin());
    let middle = (mean / radius).clamp(-1.0, 1.0).asin();
    // Divided at the peak, so that a narrow one is not missed.
    let both =
        integral(&density, [from, middle], DIVISIONS) + integral(&density, [middle, to], DIVISIONS);
    both / std::f64::consts::TAU.sqrt()
}

/// Nodes of the Kronrod rule with 15 points on 0 to 1; every second one, from the second on, belongs to the Gauss rule with 7.
const NODES: [f64; 8] = [
    0.991_455_371_120_812_6,
    0.949_107_912_342_758_5,
    0.864_864_423_359_769_1,
    0.741_531_185_599_394_4,
    0.586_087_235_467_691_1,
    0.405_845_151_377_397_2,
    0.207_784_955_007_898_47,
    0.0,
];
/// Weights of the Kronrod rule.
const KRONROD: [f64; 8] = [
    0.022_935_322_010_529_224,
    0.063_092_092_629_978_55,
    0.104_790_010_322_250_18,
    0.140_653_259_715_525_92,
    0.169_004_726_639_267_9,
    0.190_350_578_064_785_4,
    0.204_432_940_075_298_9,
    0.209_482_141_084_727_83,
];
/// Weights of the Gauss rule.
const GAUSS: [f64; 4] = [
    0.129_484_966_168_869_7,
    0.279_705_391_489_276_67,
    0.381_830_050_505_118_9,
    0.417_959_183_673_469_4,
];

/// Integral over an interval, which is halved until both rules agree.
fn integral(of: &dyn Fn(f64) -> f64, [from, to]: [f64; 2], divisions: usize) -> f64 {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let (mut kronrod, mut gauss) = (0.0, 0.0);
    for (k, node) in NODES.iter().enumerate() {
        let value = match *node {
            0.0 => of(middle),
            node => of(middle - half * node) + of(middle + half * node),
        };
        kronrod += KRONROD[k] * value;
        if k % 2 == 1 {
            gauss += GAUSS[k / 2] * value;
        }
    }
    if divisions == 0 || (half * (kronrod - gauss)).abs() < INTEGRATED {
        return half * kronrod;
    }
    integral(of, [from, middle], divisions - 1) + integral(of, [middle, to], divisions - 1)
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;

    use super::*;

    fn of(mean: [f64; 3], variances: [f64; 3], tolerance: f64) -> f64 {
        let covariance = Matrix3::from_diagonal(&Vec3::from(variances));
        conformance_probability(&mean.into(), &covariance, tolerance)
    }

    /// J. P. Imhof, Computing the distribution of quadratic forms in normal variables, Biometrika 48 (1961), table 1: the
    /// quadratic form with the weights 0.6, 0.3 and 0.1.
    #[test]
    fn probabilities_are_those_of_imhof() {
        for (square, beyond) in [(0.1_f64, 0.9458), (0.7, 0.5064), (2.0, 0.1240)] {
            let found = 1.0 - of([0.0; 3], [0.6, 0.3, 0.1], square.sqrt());
            assert!((found - beyond).abs() < 5e-5, "{square}: {found}");
        }
    }

    /// With equal variances the distance has a closed form: that of the noncentral chi distribution of 3 degrees of freedom.
    #[test]
    fn equal_variances_have_a_closed_form() {
        for sd in [1e-4, 0.02, 0.3, 1.0, 5.0] {
            for mean in [1e-3, 0.5, 0.97, 1.0, 1.02, 3.0] {
                let density = |x: f64| (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt();
                let (plus, minus) = ((1.0 + mean) / sd, (1.0 - mean) / sd);
                let expected = normal_cdf(minus)
                    - normal_cdf(-plus)
                    - sd / mean * (density(minus) - density(plus));
                let along = Vec3::new(2.0, -1.0, 2.0) / 3.0 * mean;
                let found = of(along.into(), [sd * sd; 3], 1.0);
                assert!(
                    (found - expected).abs() < 1e-6,
                    "{sd} {mean}: {found} {expected}"
                );
            }
        }
    }

    /// Independent points multiply, and points that move together are one; 0.012 is three standard errors of 20,000 draws.
    #[test]
    fn the_joint_probability_has_its_limits_of_independence_and_of_one_motion() {
        let (mean, sd, tolerance) = (Vec3::new(0.4, -0.2, 0.1), 0.5, 1.0);
        let one = of(mean.into(), [sd * sd; 3], tolerance);
        let joint = |covariance: &DMatrix<f64>| {
            joint_conformance_probability(&[mean; 2], covariance, tolerance).expect("semidefinite")
        };
        let independent = joint(&(DMatrix::identity(6, 6) * (sd * sd)));
        assert!((independent - one * one).abs() < 0.012, "{independent}");
        let together = DMatrix::from_fn(6, 6, |i, k| if i % 3 == k % 3 { sd * sd } else { 0.0 });
        assert!((joint(&together) - one).abs() < 0.012);
    }

    #[test]
    fn exact_coordinates_have_no_distribution() {
        let expected = normal_cdf(2.0) - normal_cdf(-4.0);
        let found = of([0.1, 0.0, 0.0], [0.01, 0.0, 0.0], 0.3);
        assert!((found - expected).abs() < 1e-9);
        // Two exact coordinates use up a part of the tolerance.
        let found = of([0.1, 0.24, 0.32], [0.01, 0.0, 0.0], 0.5);
        assert!((found - expected).abs() < 1e-9, "{found}");
        assert_eq!(of([0.3, 0.0, 0.0], [0.0; 3], 0.31), 1.0);
        assert_eq!(of([0.3, 0.0, 0.0], [0.0; 3], 0.29), 0.0);
        // Almost exact is the same as exact, even with the estimate on the limit.
        for tiny in [1e-30, 1e-16, 1e-12] {
            let found = of([0.1, 0.24, 0.32], [0.01, tiny, tiny], 0.5);
            assert!((found - expected).abs() < 1e-5, "{tiny}: {found}");
        }
        for small in [1e-16, 1e-12, 1e-8] {
            let half = of([0.3, 0.0, 0.0], [small, 1e-2 * small, 0.0], 0.3);
            assert!((half - 0.5).abs() < 1e-5, "{small}: {half}");
        }
    }

    /// Drawn points lie within the tolerance as often: four standard errors, which a correct program exceeds in one of
    /// four cases with a probability of 3e-4.
    #[test]
    fn drawn_points_lie_within_as_often() {
        const DRAWN: usize = 200_000;
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let root = Matrix3::new(0.8, 0.0, 0.0, -0.3, 0.5, 0.0, 0.1, 0.4, 0.05);
        let covariance = root * root.transpose();
        for (mean, tolerance) in [
            ([0.2, 0.1, -0.3], 1.0),
            ([0.9, -0.2, 0.3], 1.0),
            ([0.0; 3], 0.4),
            ([2.0, 1.0, 0.0], 1.5),
        ] {
            let mean = Vec3::from(mean);
            let mut draw = || mean + root * Vec3::from_fn(|_, _| rng.sample(StandardNormal));
            let inside = (0..DRAWN).filter(|_| draw().norm() <= tolerance).count();
            let share = inside as f64 / DRAWN as f64;
            let found = conformance_probability(&mean, &covariance, tolerance);
            let error = (found * (1.0 - found) / DRAWN as f64).sqrt();
            assert!((share - found).abs() < 4.0 * error, "{share} {found}");
        }
    }
}
