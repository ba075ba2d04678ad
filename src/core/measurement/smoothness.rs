//! Test of consecutive samples: a motion or separate standstills.
//!
//! Samples of a motion lie on a smooth curve: a polynomial through the samples around one of them, the same from which the
//! rates are taken, predicts that one to within the noise, or at least far better than the samples differ from each other.
//! Readings of separate standstills differ as much from such a curve as from their mean. The sampling rate decides nothing: a
//! slow robot may be sampled slowly.

use super::local_polynomial::{FEWEST, Weights};

/// Largest residual of a smooth curve in the stated standard deviations of its noise. Noise alone gives 0.7 in the median;
/// stated values are up to a factor of two wrong, and moving robots vibrate.
const LARGEST_NOISE: f64 = 3.0;
/// Largest residual relative to the spread of the samples in the window. In the median, independent standstills give 0.6, those
/// of a tour that leads from each to one close by 0.3, a wave that is sampled eight times a period 0.20, and nine times 0.12.
const LARGEST_SHARE: f64 = 0.15;
/// Largest number of windows that are examined.
const MOST_WINDOWS: usize = 500;

/// Samples of one channel.
pub struct SampledChannel<'a> {
    /// Sample at a row.
    pub value: &'a dyn Fn(usize) -> f64,
    /// Stated standard deviation of its noise, in the unit of the samples; 0 if it is unknown.
    pub sd: f64,
}

/// Whether the samples of `channels` at rows with these times (s) are of a motion: in the median over windows of consecutive
/// rows, and over the channels in each, the residual from a smooth curve is as small as their noise, or small compared with
/// their spread.
#[must_use]
pub fn follows_a_motion(times_s: &[f64], channels: &[SampledChannel<'_>]) -> bool {
    let half = FEWEST / 2;
    let number = (times_s.len() + 1).saturating_sub(FEWEST);
    let stride = number.div_ceil(MOST_WINDOWS).max(1);
    let mut excesses = Vec::new();
    for start in (0..number).step_by(stride) {
        let middle = times_s[start + half];
        let around: Vec<f64> = (times_s[start..start + FEWEST].iter())
            .map(|time| time - middle)
            .collect();
        // Times that repeat or are missing determine no curve.
        let Some(weights) = Weights::new(&around) else {
            continue;
        };
        let residual = weights.residual();
        let of = |channel: &SampledChannel<'_>| excess(channel, start, &residual);
        excesses.extend(channels.iter().filter_map(of));
    }
    let middle = excesses.len() / 2;
    !excesses.is_empty() && *excesses.select_nth_unstable_by(middle, f64::total_cmp).1 <= 1.0
}

/// Residual in the middle of a window relative to the largest one of a motion; `None` with a missing sample, or if nothing
/// changes in the window.
fn excess(channel: &SampledChannel<'_>, start: usize, filter: &[f64]) -> Option<f64> {
    let samples: Vec<f64> = (start..start + filter.len()).map(channel.value).collect();
    let mean = samples.iter().sum::<f64>() / samples.len() as f64;
    let squares: f64 = samples.iter().map(|value| (value - mean).powi(2)).sum();
    let spread = (squares / (samples.len() - 1) as f64).sqrt();
    let residual: f64 = filter
        .iter()
        .zip(&samples)
        .map(|(c, value)| c * value)
        .sum();
    let norm = filter.iter().map(|c| c * c).sum::<f64>().sqrt();
    let allowed = (LARGEST_NOISE * channel.sd * norm).max(LARGEST_SHARE * spread);
    (spread > 0.0 && spread.is_finite()).then(|| residual.abs() / allowed)
}

#[cfg(test)]
mod tests {
    use rand::seq::SliceRandom;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// Lengths (m) at 400 rows: two sines of slow motion with noise of `sd`.
    fn slow_motion(step_s: f64, sd: f64, rng: &mut ChaCha8Rng) -> (Vec<f64>, Vec<f64>) {
        let times: Vec<f64> = (0..400).map(|row| step_s * f64::from(row)).collect();
        let length = |time: &f64| {
            let noise = sd * (0..12).map(|_| rng.random::<f64>() - 0.5).sum::<f64>();
            0.3 * (0.2 * time).sin() + 0.1 * (0.31 * time + 1.0).sin() + noise
        };
        let lengths = times.iter().map(length).collect();
        (times, lengths)
    }

    fn is_motion(times: &[f64], lengths: &[f64], sd: f64) -> bool {
        let value = |row: usize| lengths[row];
        follows_a_motion(times, &[SampledChannel { value: &value, sd }])
    }

    #[test]
    fn a_slow_motion_is_one_at_any_rate_and_shuffled_rows_are_none() {
        let mut rng = ChaCha8Rng::seed_from_u64(9);
        for step_s in [0.01, 0.1, 0.256, 0.6] {
            for sd in [1e-5, 2e-4, 2e-3] {
                let (times, mut lengths) = slow_motion(step_s, sd, &mut rng);
                assert!(is_motion(&times, &lengths, sd), "{step_s} s, {sd} m");
                // Without a stated noise, the change within a window has to be larger than the noise.
                if sd < 1e-4 && step_s > 0.05 {
                    assert!(is_motion(&times, &lengths, 0.0), "{step_s} s, {sd} m");
                }
                lengths.shuffle(&mut rng);
                assert!(!is_motion(&times, &lengths, sd.min(2e-4)), "{step_s} s");
            }
        }
    }

    #[test]
    fn standstills_on_a_grid_and_on_a_tour_of_neighbours_are_no_motion() {
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        let times: Vec<f64> = (0..1000).map(f64::from).collect();
        let grid: Vec<f64> = (0..1000)
            .map(|row| 0.1 * f64::from(row % 10) + 0.05 * f64::from(row / 10 % 10))
            .collect();
        assert!(!is_motion(&times, &grid, 2e-4));
        let mut at = 0.0;
        let tour: Vec<f64> = (0..1000)
            .map(|_| {
                at += rng.random_range(-0.05..0.05);
                at
            })
            .collect();
        assert!(!is_motion(&times, &tour, 2e-4));
    }

    #[test]
    fn a_wave_has_to_be_sampled_nine_times_a_period() {
        let times: Vec<f64> = (0..400).map(f64::from).collect();
        // Periods that are no whole number of samples show the wave at every phase.
        for (samples, expected) in [(6.01, false), (8.01, false), (9.01, true), (20.01, true)] {
            let wave = |time: &f64| (std::f64::consts::TAU * time / samples + 0.3).sin();
            let lengths: Vec<f64> = times.iter().map(wave).collect();
            assert_eq!(is_motion(&times, &lengths, 1e-6), expected, "{samples}");
        }
    }

    #[test]
    fn missing_samples_and_repeated_times_decide_nothing() {
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        let (mut times, mut lengths) = slow_motion(0.25, 2e-4, &mut rng);
        lengths[100..150].fill(f64::NAN);
        for row in 200..220 {
            times[row] = times[200];
        }
        assert!(is_motion(&times, &lengths, 2e-4));
        assert!(!is_motion(&times, &vec![f64::NAN; 400], 2e-4));
        assert!(!is_motion(&vec![0.0; 400], &lengths, 2e-4));
        assert!(!is_motion(&times[..5], &lengths, 2e-4));
    }
}
