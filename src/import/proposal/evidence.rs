//! Evidence of the values of a channel for its quantity.

use tautline_channels::Channel;

/// Maximum number of rows that are examined.
const MOST_ROWS: usize = 2000;
/// Minimum number of rows for a conclusion.
const FEWEST_ROWS: usize = 6;
/// Share of the steps of a clock that go forwards: it may be set, and stand still between rows of one moment.
const FORWARDS: f64 = 0.9;
/// Largest deviation of the norm of a quaternion from one, as files round it.
const NORM_TOLERANCE: f64 = 2e-3;
/// Smallest range of tensions relative to their mean: temperatures in one room differ by less.
const VARIES: f64 = 0.15;
/// Range of whole numbers from which on they are encoder counts.
const COUNTS: f64 = 4000.0;

/// Values of some rows, evenly spread.
fn sample(channel: &Channel) -> Vec<f64> {
    let every = channel.values.len().div_ceil(MOST_ROWS).max(1);
    let rows = (0..channel.values.len()).step_by(every);
    let values = rows.map(|row| channel.values.at(row));
    values.filter(|value| !value.is_nan()).collect()
}

/// Whether values increase like those of a clock.
pub(super) fn is_clock(channel: &Channel) -> bool {
    let values = sample(channel);
    let steps = values.windows(2).map(|pair| pair[1] - pair[0]);
    let forwards = steps.clone().filter(|step| *step > 0.0).count() as f64;
    let not_backwards = steps.clone().filter(|step| *step >= 0.0).count() as f64;
    let count = steps.count() as f64;
    not_backwards >= FORWARDS * count && 2.0 * forwards >= count
}

/// Whether four channels are the components of unit quaternions.
pub(super) fn are_quaternion(channels: &[&Channel]) -> bool {
    let rows = channels.first().map_or(0, |first| first.values.len());
    let every = rows.div_ceil(MOST_ROWS).max(1);
    let norm = |row: usize| {
        let squares = channels
            .iter()
            .map(|channel| channel.values.at(row).powi(2));
        squares.sum::<f64>().sqrt()
    };
    let mut norms = (0..rows)
        .step_by(every)
        .map(norm)
        .filter(|norm| !norm.is_nan());
    channels.len() == 4 && rows > 0 && norms.all(|norm| (norm - 1.0).abs() < NORM_TOLERANCE)
}

/// Mean magnitude of a channel.
pub(super) fn magnitude(channel: &Channel) -> f64 {
    let values = sample(channel);
    values.iter().map(|value| value.abs()).sum::<f64>() / values.len().max(1) as f64
}

/// Whether channels are constant, like parameters, or switch between two whole numbers.
pub(super) fn are_settings(channels: &[&Channel]) -> bool {
    let is_setting = |channel: &&Channel| {
        let mut values = sample(channel);
        let is_enough = values.len() >= FEWEST_ROWS;
        values.sort_by(f64::total_cmp);
        values.dedup();
        let switches = values.len() == 2 && values.iter().all(|value| value.fract() == 0.0);
        is_enough && (values.len() < 2 || switches)
    };
    channels.iter().all(is_setting)
}

/// Whether channels look like tensions: cables pull, and not always equally.
pub(super) fn are_tensions(channels: &[&Channel]) -> bool {
    let is_tension = |channel: &&Channel| {
        let values = sample(channel);
        let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
        let [low, high] = channel.summary().range;
        low >= -0.1 * high.abs() && high - low > VARIES * mean && !is_clock(channel)
    };
    !channels.is_empty() && channels.iter().all(is_tension)
}

/// Whether channels look like encoder counts: whole numbers over a large range.
pub(super) fn are_counts(channels: &[&Channel]) -> bool {
    let is_whole = |channel: &&Channel| sample(channel).iter().all(|value| value.fract() == 0.0);
    let range = |channel: &&Channel| {
        let [low, high] = channel.summary().range;
        high - low
    };
    channels.iter().all(is_whole) && channels.iter().map(range).fold(0.0, f64::max) > COUNTS
}
