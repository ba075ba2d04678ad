//! Verification: the platform moves to targets, where an external instrument measures its pose.
//!
//! Every target is approached in the given order, once per cycle, and measured at rest, also the points of a path:
//! the figures are those of the geometry, without dynamic errors of the controller.

mod targets;
#[cfg(test)]
mod tests;
mod typed;

use tautline_core::geometry::{Pose, Twist};
use tautline_session::{CheckPose, CheckRow};

pub use targets::{CheckTarget, circle, cube_edges_m, cube_poses, line};
pub use typed::TypedInstrument;

use crate::controller::{Activity, Controller, Instrument, Sample};
use crate::error::LinkError;

/// Options of a verification run.
#[derive(Debug, Clone, PartialEq)]
pub struct VerifyingOptions {
    /// Number of approaches to each target; ISO 9283 requires 30.
    pub cycles: usize,
    /// Number of measurements averaged at each target.
    pub measurements: usize,
    /// Time at rest before the instrument measures (s), on the controller's clock.
    pub settle_time_s: f64,
    /// Timeout from command to rest (s), on the controller's clock.
    pub timeout_s: f64,
}

impl VerifyingOptions {
    /// Options for poses typed by the operator: each target once.
    #[must_use]
    pub fn typed() -> Self {
        Self {
            cycles: 1,
            measurements: 1,
            ..Self::default()
        }
    }
}

impl Default for VerifyingOptions {
    fn default() -> Self {
        Self {
            cycles: 3,
            measurements: 5,
            settle_time_s: 1.0,
            timeout_s: 60.0,
        }
    }
}

/// Whether rows belong to the first targets of a run, in their order over all cycles.
#[must_use]
pub fn are_first_rows(rows: &[CheckRow], targets: &[CheckTarget]) -> bool {
    let mut pairs = rows.iter().zip(targets.iter().cycle());
    !targets.is_empty()
        && pairs.all(|(row, target)| {
            row.target == target.target
                && row.sample == target.sample
                && row.commanded.position_m == <[f64; 3]>::from(target.pose.position)
        })
}

/// An event of a run.
#[derive(Debug, Clone, PartialEq)]
pub enum VerifyingEvent {
    /// The controller was sent to a target.
    Commanded {
        /// Number of targets commanded so far, including this one, over all cycles.
        done: usize,
        /// Number of targets over all cycles.
        of: usize,
    },
    /// The platform is at rest: the operator must read its pose and answer the [`TypedInstrument`] of the run.
    Wanted {
        /// Number of the target, as in [`Self::Commanded`].
        number: usize,
    },
    /// The instrument has measured a target.
    Attained(CheckRow),
    /// All targets are measured.
    Finished,
    /// The run has failed; the text states why.
    Failed(String),
}

/// A verification run: a state machine that [`Self::tick`] advances.
#[derive(Debug, Clone)]
pub struct VerifyingRun {
    targets: Vec<CheckTarget>,
    options: VerifyingOptions,
    /// Number of targets commanded so far.
    done: usize,
    /// Controller's times of the command in progress, and of the start of rest.
    under_way: Option<(f64, Option<f64>)>,
    measured: Vec<CheckPose>,
    /// The instrument whose readings are typed, if there is one.
    asked: Option<TypedInstrument>,
    /// Whether the operator was asked for the pose at the present target.
    asks: bool,
    ended: bool,
}

impl VerifyingRun {
    /// A run over targets.
    #[must_use]
    pub fn new(targets: Vec<CheckTarget>, options: VerifyingOptions) -> Self {
        Self {
            targets,
            options,
            done: 0,
            under_way: None,
            measured: Vec::new(),
            asked: None,
            asks: false,
            ended: false,
        }
    }

    /// Uses poses typed by the operator; `instrument` is a clone of that passed to [`Self::tick`].
    #[must_use]
    pub fn asking(mut self, instrument: Option<TypedInstrument>) -> Self {
        self.asked = instrument;
        self
    }

    /// Continues a run of which `measured` targets, counted over all cycles, are measured.
    #[must_use]
    pub fn continuing(mut self, measured: usize) -> Self {
        self.done = measured;
        self
    }

    /// Whether the run has ended.
    #[must_use]
    pub fn has_ended(&self) -> bool {
        self.ended
    }

    /// Stops the platform and ends the run.
    ///
    /// # Errors
    /// If the controller cannot be stopped; the run has ended anyway.
    pub fn abort(&mut self, controller: &mut dyn Controller) -> Result<(), LinkError> {
        self.ended = true;
        controller.stop()
    }

    /// Advances the run by at most one command or measurement.
    pub fn tick(
        &mut self,
        controller: &mut dyn Controller,
        instrument: &mut dyn Instrument,
    ) -> Option<VerifyingEvent> {
        if self.ended {
            return None;
        }
        let event = self.advance(controller, instrument);
        let event = event.unwrap_or_else(|error| Some(VerifyingEvent::Failed(error.to_string())));
        let ends =
            |e: &VerifyingEvent| matches!(e, VerifyingEvent::Finished | VerifyingEvent::Failed(_));
        self.ended = event.as_ref().is_some_and(ends);
        event
    }

    fn advance(
        &mut self,
        controller: &mut dyn Controller,
        instrument: &mut dyn Instrument,
    ) -> Result<Option<VerifyingEvent>, LinkError> {
        let state = controller.state();
        if let Activity::Fault(text) = state.activity {
            return Err(LinkError::Fault(text));
        }
        let sample = controller.sample()?;
        // The sample itself may reveal that the platform is not where it was sent.
        if let Activity::Fault(text) = controller.state().activity {
            return Err(LinkError::Fault(text));
        }
        let Some((commanded_s, resting_s)) = self.under_way else {
            return self.command(controller, &sample).map(Some);
        };
        if self.asks {
            return self.wait_for_answer(instrument, &sample);
        }
        if sample.time_s - commanded_s > self.options.timeout_s {
            return Err(LinkError::Timeout {
                request: "to bring the platform to rest".to_owned(),
                seconds: self.options.timeout_s,
            });
        }
        if state.activity == Activity::Moving {
            self.under_way = Some((commanded_s, None));
            return Ok(None);
        }
        let since_s = resting_s.unwrap_or(sample.time_s);
        self.under_way = Some((commanded_s, Some(since_s)));
        if sample.time_s - since_s < self.options.settle_time_s {
            return Ok(None);
        }
        if let Some(asked) = &self.asked {
            asked.ask(self.done);
            self.asks = true;
            return Ok(Some(VerifyingEvent::Wanted { number: self.done }));
        }
        self.measured.push(instrument.measure()?);
        if self.measured.len() < self.options.measurements {
            return Ok(None);
        }
        Ok(self.row(&sample).map(VerifyingEvent::Attained))
    }

    /// Continues once the pose has been typed.
    fn wait_for_answer(
        &mut self,
        instrument: &mut dyn Instrument,
        sample: &Sample,
    ) -> Result<Option<VerifyingEvent>, LinkError> {
        if self.asked.as_ref().is_some_and(TypedInstrument::waits) {
            return Ok(None);
        }
        self.asks = false;
        self.measured.push(instrument.measure()?);
        Ok(self.row(sample).map(VerifyingEvent::Attained))
    }

    fn command(
        &mut self,
        controller: &mut dyn Controller,
        sample: &Sample,
    ) -> Result<VerifyingEvent, LinkError> {
        let of = self.targets.len() * self.options.cycles;
        if self.done >= of {
            return Ok(VerifyingEvent::Finished);
        }
        let target = &self.targets[self.done % self.targets.len()];
        controller.command(&target.pose)?;
        self.done += 1;
        self.under_way = Some((sample.time_s, None));
        self.measured.clear();
        Ok(VerifyingEvent::Commanded {
            done: self.done,
            of,
        })
    }

    /// The row of the present target, which completes it.
    fn row(&mut self, sample: &Sample) -> Option<CheckRow> {
        self.under_way = None;
        let index = self.done.checked_sub(1)?;
        let target = self.targets.get(index % self.targets.len())?;
        let commanded = target.pose;
        Some(CheckRow {
            kind: target.kind,
            target: target.target.clone(),
            cycle: (index / self.targets.len()) as i64 + 1,
            sample: target.sample,
            time_s: Some(sample.time_s),
            attained: mean(&commanded, &self.measured),
            commanded: CheckPose {
                position_m: commanded.position.into(),
                orientation_wxyz: Some(commanded.orientation_wxyz()),
            },
        })
    }
}

/// Mean of poses near a reference, with an orientation if all have one.
fn mean(reference: &Pose, measured: &[CheckPose]) -> CheckPose {
    let count = measured.len() as f64;
    let oriented = measured.iter().all(|pose| pose.orientation_wxyz.is_some());
    let wxyz = reference.orientation_wxyz();
    let off = measured.iter().map(|seen| {
        let orientation = seen.orientation_wxyz.unwrap_or(wxyz);
        Pose::from_parts(seen.position_m, orientation).difference(reference)
    });
    let mean = reference.perturbed(&(off.sum::<Twist>() / count));
    CheckPose {
        position_m: mean.position.into(),
        orientation_wxyz: oriented.then(|| mean.orientation_wxyz()),
    }
}
