//! Clock offset and drift between two recorders that observed the same motion.
//!
//! The readings of an instrument are a smooth function of the cable readings, whatever the frame of the instrument and its
//! target on the platform: `y(t) = f(x(t + offset + drift (t - t0)))` with the channels `x` of one recorder and `y` of the
//! other. `f` is a second-degree polynomial that is estimated as well, so that no geometry has to be known. A coarse lag
//! results from the correlation of the speeds; then offset, drift and `f` are fitted by least squares. Standard deviations
//! come from a jackknife over blocks longer than the correlation length of the errors (Künsch 1989, The jackknife and the
//! bootstrap for general stationary observations), because neighbouring samples are not independent. They are
//! conservative, since leaving out a block weakens the polynomial.

mod coarse;
mod fit;
#[cfg(test)]
mod tests;

use tautline_channels::{Source, Values};
use tautline_core::robot::Robot;
use tautline_files::{Location, ReadError, quoted};

use crate::cutting::{Times, main_series};
use crate::recipe::{Clock, Mapping, Recipe, resolve};

/// Minimum number of samples of a recording that can be aligned.
const FEWEST: usize = 100;
/// Maximum number of rows; longer recordings are thinned evenly.
const MOST: usize = 200_000;

/// Channels that were sampled together.
#[derive(Debug, Clone, Default)]
struct Recording {
    /// Ascending (s).
    time_s: Vec<f64>,
    /// One list for each channel; no value is NaN.
    channels: Vec<Vec<f64>>,
}

/// Clock of one recorder relative to another: `offset + drift (t - middle)` is added to its times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClockFit {
    /// Offset at the middle of the overlap (s).
    pub offset_s: f64,
    /// Standard deviation of the offset (s).
    pub offset_sd_s: f64,
    /// Rate difference (s/s), positive if this clock runs slow.
    pub drift: f64,
    /// Standard deviation of the drift (s/s).
    pub drift_sd: f64,
    /// Middle of the overlap on this clock (s).
    pub middle_s: f64,
    /// Fraction of the variance of its channels explained by the other recording (R²).
    pub explained: f64,
}

/// Estimated clock of one series.
#[derive(Debug, Clone, PartialEq)]
pub struct AlignedClock {
    /// The series.
    pub series: String,
    /// Its clock relative to the series of the cables.
    pub fit: ClockFit,
    /// One sentence.
    pub sentence: String,
}

/// Estimates the clocks of all series in use relative to that of the cables and stores them in the recipe.
///
/// # Errors
/// If a channel of the recipe is missing, there is no second clock, or the recordings share no motion.
pub fn align_clocks(
    sources: &[Source],
    recipe: &mut Recipe,
    robot: &Robot,
) -> Result<Vec<AlignedClock>, ReadError> {
    let file = sources.first().map_or("", |source| source.file.as_str());
    let fail = |message: String| ReadError::new(file, Location::File, message);
    let mapping = resolve(sources, recipe, "the recipe", robot.cable_count())?;
    let main = main_series(&mapping);
    let reference = recording(&mapping, main, recipe).ok_or_else(|| {
        let name = quoted(&mapping.series[main].name);
        fail(format!("the series {name} has no times or is too short, expected a recording of the cables to align clocks to"))
    })?;
    let mut found = Vec::new();
    for (k, series) in mapping.series.iter().enumerate() {
        if k == main {
            continue;
        }
        let Some(other) = recording(&mapping, k, &without_clock(recipe, &series.name)) else {
            continue;
        };
        let fit = align(&reference, &other).ok_or_else(|| {
            let (one, other) = (&mapping.series[main].name, &series.name);
            fail(format!("the clocks of {one} and {other} cannot be aligned: expected a motion that both have recorded"))
        })?;
        found.push(AlignedClock {
            sentence: sentence(&series.name, &mapping.series[main].name, &fit),
            series: series.name.clone(),
            fit,
        });
    }
    if found.is_empty() {
        return Err(fail(
            "found one clock only, expected a second recording whose channels are used".into(),
        ));
    }
    for clock in &found {
        let close_jumps = recipe
            .clocks
            .iter()
            .any(|known| known.close_jumps && clock.series.ends_with(&known.series));
        recipe
            .clocks
            .retain(|known| !clock.series.ends_with(&known.series));
        recipe.clocks.push(Clock {
            series: clock.series.clone(),
            offset_s: clock.fit.offset_s,
            drift: clock.fit.drift,
            drift_from_s: clock.fit.middle_s,
            close_jumps,
        });
    }
    Ok(found)
}

fn sentence(series: &str, main: &str, fit: &ClockFit) -> String {
    let direction = if fit.offset_s < 0.0 {
        "ahead of"
    } else {
        "behind"
    };
    let rate = if fit.drift < 0.0 { "fast" } else { "slow" };
    format!(
        "the clock of {series} is {:.5} s (± {:.2} ms) {direction} that of {main} and {:.0} ppm (± {:.1} ppm) {rate}; \
         {:.1} % of its channels follow from the cables",
        fit.offset_s.abs(),
        1e3 * fit.offset_sd_s,
        1e6 * fit.drift.abs(),
        1e6 * fit.drift_sd,
        100.0 * fit.explained
    )
}

/// The recipe without clock correction of a series.
fn without_clock(recipe: &Recipe, series: &str) -> Recipe {
    let mut recipe = recipe.clone();
    for clock in &mut recipe.clocks {
        if series.ends_with(&clock.series) {
            (clock.offset_s, clock.drift) = (0.0, 0.0);
        }
    }
    recipe
}

/// The numeric channels in use of a series, at the rows where all have values.
fn recording(mapping: &Mapping<'_>, series: usize, recipe: &Recipe) -> Option<Recording> {
    let times = Times::of(mapping, series, recipe).time_s?;
    let one = mapping.series[series];
    let own = mapping.quantities.iter().filter(|(quantity, mapped)| {
        mapped.series == series && !mapped.is_text && !quantity.is_text()
    });
    // Quantities that move with the platform carry most information; others, such as forces, are a fallback.
    let any_moves = own.clone().any(|(quantity, _)| quantity.moves());
    let used: Vec<&Values> = own
        .filter(|(quantity, _)| quantity.moves() || !any_moves)
        .map(|(_, mapped)| &one.channels[mapped.channel].values)
        .collect();
    let mut found = Recording {
        time_s: Vec::new(),
        channels: vec![Vec::new(); used.len()],
    };
    let every = times.len().div_ceil(MOST).max(1);
    for (row, time) in times.iter().enumerate().step_by(every) {
        let is_later = found.time_s.last().is_none_or(|last| time > last);
        if time.is_finite() && is_later && used.iter().all(|values| values.at(row).is_finite()) {
            found.time_s.push(*time);
            for (channel, values) in found.channels.iter_mut().zip(&used) {
                channel.push(values.at(row));
            }
        }
    }
    // A constant channel carries no information about time.
    found.channels.retain(|channel| {
        let first = channel.first().copied().unwrap_or(0.0);
        channel.iter().any(|value| *value != first)
    });
    (found.time_s.len() >= FEWEST && !found.channels.is_empty()).then_some(found)
}

/// Estimates the clock of `other` relative to `reference`.
fn align(reference: &Recording, other: &Recording) -> Option<ClockFit> {
    let lag_s = coarse::lag(reference, other)?;
    fit::refine(reference, other, lag_s)
}
