//! Detects when the platform is at rest.

use std::collections::VecDeque;

use tautline_core::robot::Robot;

use super::options::Rates;
use crate::controller::Sample;

/// Smallest number of samples for a rate.
const FEWEST: usize = 5;

/// The latest samples of a platform that may still be settling.
#[derive(Debug, Clone, Default)]
pub struct SettlingWindow {
    samples: VecDeque<Sample>,
}

/// Rates of change, and the reading that exceeds its limit most.
#[derive(Debug, Clone, PartialEq)]
pub struct SettlingState {
    /// Rates of change over the window.
    pub rates: Rates,
    /// Whether no rate exceeds its limit.
    pub still: bool,
    /// The reading that changes too fast, as a sentence.
    pub restless: Option<String>,
}

/// The reading that exceeds its limit most.
#[derive(Default)]
struct Worst {
    excess: f64,
    reading: Option<String>,
}

impl Worst {
    fn note(&mut self, excess: f64, reading: impl FnOnce() -> String) {
        if excess > self.excess.max(1.0) {
            self.excess = excess;
            self.reading = Some(reading());
        }
    }
}

impl SettlingWindow {
    /// Drops all samples.
    pub fn clear(&mut self) {
        self.samples.clear();
    }

    /// The latest sample.
    #[must_use]
    pub fn last(&self) -> Option<&Sample> {
        self.samples.back()
    }

    /// Adds a sample and drops those not needed to span `span_s`.
    pub fn push(&mut self, sample: Sample, span_s: f64) {
        let now_s = sample.time_s;
        self.samples.push_back(sample);
        while self.samples.len() > FEWEST
            && self
                .samples
                .get(1)
                .is_some_and(|s| now_s - s.time_s >= span_s)
        {
            self.samples.pop_front();
        }
    }

    /// Time spanned (s).
    fn span_s(&self) -> f64 {
        let ends = self.samples.front().zip(self.samples.back());
        ends.map_or(0.0, |(first, last)| last.time_s - first.time_s)
    }

    /// Time until the window spans `span_s` (s).
    #[must_use]
    pub fn missing_s(&self, span_s: f64) -> f64 {
        (span_s - self.span_s()).max(0.0)
    }

    /// Compares the rates over the window with limits; `None` until it spans `span_s` with enough samples.
    #[must_use]
    pub fn settled(&self, robot: &Robot, limits: &Rates, span_s: f64) -> Option<SettlingState> {
        if self.samples.len() < FEWEST || self.missing_s(span_s) > 0.0 {
            return None;
        }
        let mut rates = Rates {
            laser_m_per_s: self.slope(|s| s.laser_m),
            ..Rates::default()
        };
        let mut worst = Worst::default();
        worst.note(rates.laser_m_per_s / limits.laser_m_per_s, || {
            let rate_mm = rates.laser_m_per_s * 1e3;
            format!("the laser distance still changes by {rate_mm:.2} mm/s")
        });
        for (index, cable) in robot.cables.iter().enumerate() {
            let turning = self.slope(|s| s.revolutions.get(index).copied());
            let rate = turning * cable.winch.cable_per_revolution_m();
            rates.length_m_per_s = rates.length_m_per_s.max(rate);
            worst.note(rate / limits.length_m_per_s, || {
                let rate_mm = rate * 1e3;
                format!(
                    "the winch of {} still turns by {rate_mm:.2} mm/s",
                    cable.name
                )
            });
            let Some(sensor) = cable.force_sensor else {
                continue;
            };
            let pulling = self.slope(|s| s.force_n.get(index).copied());
            let rate = pulling / sensor.tension_gain.abs();
            rates.tension_n_per_s = rates.tension_n_per_s.max(rate);
            worst.note(rate / limits.tension_n_per_s, || {
                format!(
                    "the tension of {} still changes by {rate:.1} N/s",
                    cable.name
                )
            });
        }
        Some(SettlingState {
            rates,
            still: worst.reading.is_none(),
            restless: worst.reading,
        })
    }

    /// Magnitude of the least-squares slope of a channel; 0 if it was not read.
    fn slope(&self, get: impl Fn(&Sample) -> Option<f64>) -> f64 {
        let read = self
            .samples
            .iter()
            .filter_map(|s| Some((s.time_s, get(s)?)));
        let points: Vec<(f64, f64)> = read.filter(|(_, value)| value.is_finite()).collect();
        let n = points.len() as f64;
        let mean_t = points.iter().map(|p| p.0).sum::<f64>() / n;
        let mean_v = points.iter().map(|p| p.1).sum::<f64>() / n;
        let (mut above, mut below) = (0.0, 0.0);
        for (t, v) in points {
            above += (t - mean_t) * (v - mean_v);
            below += (t - mean_t).powi(2);
        }
        if below > 0.0 {
            (above / below).abs()
        } else {
            0.0
        }
    }
}
