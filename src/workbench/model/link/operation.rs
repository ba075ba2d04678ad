//! The operation of the controller: measuring or verifying.

use std::collections::HashMap;

use tautline_core::geometry::Pose;
use tautline_link::Instrument;
use tautline_link::measuring::{MeasuringEvent, MeasuringRun, Predictor, Stage as Phase};
use tautline_link::verifying::{
    CheckTarget, TypedInstrument, VerifyingEvent, VerifyingOptions, VerifyingRun,
};
use tautline_link::{Activity, Controller};
use tautline_session::{CheckRow, MeasuredPose, Stage};

use super::message::{DriverEvent, PoseDeviation, RunStep};

/// Current operation of the driver thread.
pub(super) enum Operation {
    None,
    Measuring(Box<Measuring>),
    Verifying(Box<Verifying>),
}

impl Operation {
    /// Whether it continues without an answer from the operator or the disk.
    pub fn needs_ticks(&self) -> bool {
        match self {
            Self::None => false,
            Self::Measuring(m) => m.needs_ticks(),
            Self::Verifying(_) => true,
        }
    }

    pub fn has_ended(&self) -> bool {
        match self {
            Self::None => false,
            Self::Measuring(m) => m.run.stage() == Phase::Ended,
            Self::Verifying(v) => v.run.has_ended(),
        }
    }

    /// Ends the operation for a reason.
    pub fn abort(&mut self, why: &str) -> Option<DriverEvent> {
        match std::mem::replace(self, Self::None) {
            Self::None => None,
            Self::Measuring(_) => Some(DriverEvent::RunEnded(Err(why.to_owned()))),
            Self::Verifying(v) => Some(DriverEvent::Verified(v.stage, v.rows, Err(why.to_owned()))),
        }
    }

    /// Controller values at the end of a run that is about to be aborted.
    pub fn values_at_end(&mut self, controller: &mut dyn Controller) -> Option<DriverEvent> {
        let Self::Measuring(measuring) = self else {
            return None;
        };
        let read = measuring.run.values_at_end(controller)?;
        measuring.report(read)
    }

    pub fn measuring(&mut self, change: impl FnOnce(&mut Measuring)) {
        if let Self::Measuring(measuring) = self {
            change(measuring);
        }
    }

    pub fn doing(&self) -> RunStep {
        match self {
            Self::None => RunStep::Nothing,
            Self::Measuring(m) => m.doing,
            Self::Verifying(v) => v.doing,
        }
    }

    /// Remaining time of a verification (s).
    pub fn remaining_s(&self) -> Option<f64> {
        match self {
            Self::Verifying(v) => v.remaining_s(),
            Self::None | Self::Measuring(_) => None,
        }
    }

    pub fn remaining(&self) -> usize {
        match self {
            Self::Measuring(m) => m.remaining,
            Self::None | Self::Verifying(_) => 0,
        }
    }
}

/// Measuring run with the model that predicts its poses.
pub(super) struct Measuring {
    pub run: MeasuringRun,
    pub poses: HashMap<i64, Pose>,
    pub predictor: Predictor,
    pub per_revolution_m: Vec<f64>,
    pub doing: RunStep,
    pub remaining: usize,
}

impl Measuring {
    /// Whether it continues without an answer from the operator or the disk.
    pub fn needs_ticks(&self) -> bool {
        !self.run.is_paused() && self.run.stage() != Phase::Storing
    }

    /// Adds a pose to the run.
    pub fn add(&mut self, label: i64, pose: Pose) {
        self.poses.insert(label, pose);
        self.run.add(label, pose);
    }

    pub fn tick(&mut self, controller: &mut dyn Controller, now_s: f64) -> Vec<DriverEvent> {
        let events = self.run.tick(controller, now_s);
        let reports = events.into_iter().filter_map(|event| self.report(event));
        let reports = reports.collect();
        self.remaining = self.run.remaining();
        reports
    }

    fn report(&mut self, event: MeasuringEvent) -> Option<DriverEvent> {
        Some(match event {
            MeasuringEvent::ValuesAtStart(values) => DriverEvent::ValuesAtStart(values),
            MeasuringEvent::ValuesAtEnd(values) => DriverEvent::ValuesAtEnd(values),
            MeasuringEvent::Commanded { label } => {
                self.doing = RunStep::Moving;
                DriverEvent::Commanded(label)
            }
            MeasuringEvent::Settling {
                rates,
                limits,
                remaining_s,
            } => {
                self.doing = RunStep::Settling {
                    rates,
                    limits,
                    remaining_s,
                };
                return None;
            }
            MeasuringEvent::Sampling { taken, of } => {
                self.doing = RunStep::Sampling { taken, of };
                return None;
            }
            MeasuringEvent::LaserWanted { label } => {
                let pose = self.poses.get(&label);
                let expected = pose.and_then(|pose| (self.predictor)(pose));
                let expected_m = expected.and_then(|expected| expected.laser_m);
                self.doing = RunStep::Asking { label, expected_m };
                return None;
            }
            MeasuringEvent::Measured(pose) => {
                let surprise = self.surprise(&pose);
                DriverEvent::Measured(pose, surprise)
            }
            MeasuringEvent::Warning(warning) => DriverEvent::Warning(warning),
            MeasuringEvent::Skipped { label } => DriverEvent::Skipped(label),
            MeasuringEvent::Paused { reason, .. } => DriverEvent::Paused(reason),
            MeasuringEvent::Finished => DriverEvent::RunEnded(Ok(())),
            MeasuringEvent::Failed(text) if self.run.was_restarted() => {
                DriverEvent::RunRestarted(text)
            }
            MeasuringEvent::Failed(text) => DriverEvent::RunEnded(Err(text)),
        })
    }

    fn surprise(&self, pose: &MeasuredPose) -> Option<PoseDeviation> {
        let expected = (self.predictor)(&pose.commanded()?)?;
        let revolutions = pose.readings.revolutions.row(0);
        let pairs = revolutions.iter().zip(&expected.revolutions);
        let lengths_m = pairs
            .zip(&self.per_revolution_m)
            .map(|((measured, predicted), per)| (predicted - measured) * per)
            .collect();
        let read_m = pose.readings.laser_at(0);
        let laser_m = expected.laser_m.map(|expected_m| expected_m - read_m);
        Some(PoseDeviation {
            label: pose.label(),
            lengths_m,
            laser_m: laser_m.filter(|off_m| off_m.is_finite()),
        })
    }
}

/// Verification run; the platform first moves home.
pub(super) struct Verifying {
    pub run: VerifyingRun,
    pub stage: Stage,
    rows: Vec<CheckRow>,
    /// Number of rows measured before it was continued.
    begun_with: usize,
    doing: RunStep,
    /// Instrument whose poses the operator types.
    pub typed: Option<TypedInstrument>,
    is_home: bool,
    /// Times of the commands to the first and the last target (s, clock of the controller).
    commanded_s: Option<[f64; 2]>,
}

impl Verifying {
    /// Verification over targets, `rows` of which are measured; without an instrument the operator types the poses.
    pub fn new(
        targets: Vec<CheckTarget>,
        (stage, rows): (Stage, Vec<CheckRow>),
        has_instrument: bool,
    ) -> Self {
        let (options, typed) = match has_instrument {
            true => (VerifyingOptions::default(), None),
            false => (VerifyingOptions::typed(), Some(TypedInstrument::default())),
        };
        Self {
            run: VerifyingRun::new(targets, options)
                .asking(typed.clone())
                .continuing(rows.len()),
            begun_with: rows.len(),
            stage,
            typed,
            rows,
            doing: RunStep::Moving,
            is_home: false,
            commanded_s: None,
        }
    }

    /// Remaining time until the last target is measured (s), from the targets so far.
    pub fn remaining_s(&self) -> Option<f64> {
        let [first_s, last_s] = self.commanded_s?;
        let (RunStep::Verifying { done, of } | RunStep::Locating { number: done, of }) = self.doing
        else {
            return None;
        };
        let ways = done
            .checked_sub(self.begun_with + 1)
            .filter(|ways| *ways > 0)?;
        Some((last_s - first_s) / ways as f64 * (of + 1 - done) as f64)
    }

    pub fn tick(
        &mut self,
        (controller, now_s): (&mut dyn Controller, Option<f64>),
        instrument: Option<&mut (dyn Instrument + 'static)>,
    ) -> Vec<DriverEvent> {
        if !self.is_home && controller.state().activity == Activity::Moving {
            // Sampling updates the state, which shows errors.
            let _ = controller.sample();
            return Vec::new();
        }
        self.is_home = true;
        let event = match (&mut self.typed, instrument) {
            (Some(typed), _) => self.run.tick(controller, typed),
            (None, Some(instrument)) => self.run.tick(controller, instrument),
            (None, None) => None,
        };
        match event {
            None => Vec::new(),
            Some(VerifyingEvent::Wanted { number }) => {
                if let RunStep::Verifying { of, .. } = self.doing {
                    self.doing = RunStep::Locating { number, of };
                }
                Vec::new()
            }
            Some(VerifyingEvent::Commanded { done, of }) => {
                self.doing = RunStep::Verifying { done, of };
                if let Some(now_s) = now_s {
                    let first_s = self.commanded_s.map_or(now_s, |[first_s, _]| first_s);
                    self.commanded_s = Some([first_s, now_s]);
                }
                Vec::new()
            }
            Some(VerifyingEvent::Attained(row)) => {
                self.rows.push(row);
                Vec::new()
            }
            Some(VerifyingEvent::Finished) => {
                let rows = std::mem::take(&mut self.rows);
                vec![DriverEvent::Verified(self.stage, rows, Ok(()))]
            }
            Some(VerifyingEvent::Failed(text)) => {
                let rows = std::mem::take(&mut self.rows);
                vec![DriverEvent::Verified(self.stage, rows, Err(text))]
            }
        }
    }
}
