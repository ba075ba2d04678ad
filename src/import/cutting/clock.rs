//! Times of the rows of a series.

use tautline_files::{Location, ReadError, quoted};

use crate::median::median;
use crate::recipe::{Mapping, Recipe, is_series};

/// Steps longer than this multiple of the usual step are gaps.
const GAP: f64 = 5.0;
/// Maximum number of steps from which the median is taken.
const MOST_STEPS: usize = 100_000;

/// Times of the rows of a series, with jumps and gaps.
pub(crate) struct Times {
    /// Times (s); NaN where the row has none.
    pub time_s: Option<Vec<f64>>,
    /// Rows before which the clock jumps, and the size of the jump (s).
    pub jumps: Vec<(usize, f64)>,
    /// Rows preceded by a gap, and its length (s).
    pub gaps: Vec<(usize, f64)>,
    /// Median step between rows (s); 0 if there is none.
    pub usual_s: f64,
    closed: bool,
}

impl Times {
    /// Times of a series from the recipe, otherwise from its format.
    pub fn of(mapping: &Mapping<'_>, series: usize, recipe: &Recipe) -> Self {
        let one = mapping.series[series];
        let time_s = match mapping.times[series] {
            Some(mapped) => {
                let values = one.channels[mapped.channel].values.iter();
                let times = values.map(|value| mapped.factor * value + mapped.offset);
                Some(times.collect())
            }
            None => one.time_s.as_ref().map(|times| times.iter().collect()),
        };
        let mut times = Self {
            time_s,
            jumps: Vec::new(),
            gaps: Vec::new(),
            usual_s: 0.0,
            closed: false,
        };
        let clock = recipe
            .clocks
            .iter()
            .find(|clock| is_series(one, &clock.series));
        times.look(clock.is_some_and(|clock| clock.close_jumps));
        if let (Some(clock), Some(time_s)) = (clock, &mut times.time_s) {
            for time in time_s {
                *time += clock.offset_s + clock.drift * (*time - clock.drift_from_s);
            }
        }
        times
    }

    /// Finds jumps and gaps; closes the jumps if `close`.
    fn look(&mut self, close: bool) {
        let Some(time_s) = &mut self.time_s else {
            return;
        };
        let Some(usual) = usual_step(time_s) else {
            return;
        };
        self.usual_s = usual;
        let whole: f64 = usual * time_s.len() as f64;
        let mut shift = 0.0;
        let mut last = time_s[0];
        for (row, time) in time_s.iter_mut().enumerate().skip(1) {
            let step = *time - last;
            last = *time;
            // A clock that was set jumps farther than any recording lasts; a paused recorder leaves a gap.
            let jumps = step < -1e-9 * last.abs().max(1.0) || step > 10.0 * whole.max(3600.0);
            if jumps {
                self.jumps.push((row, step));
                if close {
                    shift += usual - step;
                }
            } else if step > GAP * usual {
                self.gaps.push((row, step));
            }
            *time += shift;
        }
        self.closed = close;
    }

    /// The times, or an error that states what they are needed for.
    pub fn expected_of(
        &self,
        series: &str,
        file: &str,
        what_for: &str,
    ) -> Result<&[f64], ReadError> {
        self.time_s.as_deref().ok_or_else(|| {
            let series = quoted(series);
            let message = format!(
                "the series {series} has no times, expected a channel assigned to time_s {what_for}"
            );
            ReadError::new(file, Location::File, message)
        })
    }

    /// Notices about jumps and gaps.
    pub fn notices(&self, name: &str) -> Vec<String> {
        let mut notices = Vec::new();
        if let Some((row, step)) = self.jumps.first() {
            let more = more(self.jumps.len());
            let done = if self.closed { ": closed" } else { "" };
            notices.push(format!(
                "{name}, row {}: the clock jumps by {step:.3} s{more}{done}",
                row + 1
            ));
        }
        if let Some((row, step)) = self.gaps.first().filter(|_| {
            self.time_s
                .as_ref()
                .is_some_and(|time| time.len() >= super::RECORDING)
        }) {
            notices.push(format!(
                "{name}, row {}: gap of {step:.3} s{}",
                row + 1,
                more(self.gaps.len())
            ));
        }
        notices
    }
}

fn more(count: usize) -> String {
    if count > 1 {
        format!(" and {} more", count - 1)
    } else {
        String::new()
    }
}

/// Median of the forward steps of a clock (s), from a sample of them in long recordings.
pub(super) fn usual_step(time_s: &[f64]) -> Option<f64> {
    let every = time_s.len().div_ceil(MOST_STEPS).max(1);
    let pairs = time_s.windows(2).step_by(every);
    let steps = pairs.map(|pair| pair[1] - pair[0]);
    median(steps.filter(|step| *step > 0.0))
}
