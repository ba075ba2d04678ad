//! The steps of a run at a pose: approaching, prompting, sampling, checking.

use tautline_session::MeasuredPose;

use super::checks::{Checks, jump};
use super::mean::mean_readings;
use super::{MeasuringEvent, MeasuringRun, Stage};
use crate::controller::Sample;

impl MeasuringRun {
    /// Records the motion and waits until the platform is at rest.
    pub(super) fn approach(&mut self, sample: Sample, moving: bool) {
        if let Some(motion) = &mut self.motion {
            motion.record(&sample);
        }
        let since_s = sample.time_s - self.commanded_at_s.unwrap_or(sample.time_s);
        let late = since_s > self.options.timeout_s;
        let label = self.current().unwrap_or(0);
        if moving {
            self.window.clear();
            if late {
                self.hold(format!(
                    "the platform has not arrived at pose {label} after {since_s:.0} s"
                ));
            }
            return;
        }
        if self.note_jump(&sample) {
            self.window.clear();
        }
        let span_s = self.options.settle_time_s;
        self.window.push(sample, span_s);
        let limits = self.options.still;
        let settled = self.window.settled(&self.robot, &limits, span_s);
        let still = settled.as_ref().is_some_and(|s| s.still);
        if still {
            self.stage = Stage::Sampling;
            if let Some(laser) = &self.asked {
                laser.ask(label);
                self.stage = Stage::Asking;
                self.pending.push(MeasuringEvent::LaserWanted { label });
                return;
            }
        } else if late {
            let restless = settled.as_ref().and_then(|s| s.restless.clone());
            let restless = restless.unwrap_or_else(|| "too few readings arrive".to_owned());
            self.hold(format!(
                "the platform does not come to rest at pose {label} within {:.0} s: {restless}",
                self.options.timeout_s
            ));
        }
        self.pending.push(MeasuringEvent::Settling {
            rates: settled.map(|s| s.rates),
            limits,
            remaining_s: self.window.missing_s(span_s),
        });
    }

    /// Warns of a jump since the previous sample, once per channel and pose; returns whether there was one.
    fn note_jump(&mut self, sample: &Sample) -> bool {
        let averaged = self.options.samples;
        let before = self.samples.last().or(self.window.last());
        let found = before.and_then(|before| jump(&self.robot, averaged, (before, sample)));
        let Some((cable, text)) = found else {
            return false;
        };
        if !self.jumped.contains(&cable) {
            self.jumped.push(cable);
            let expected = self.current.and_then(|(_, pose)| (self.predictor)(&pose));
            let motion = self.motion.as_ref().zip(expected.as_ref());
            let multiple = motion.and_then(|(motion, expected)| {
                motion.multiple(&self.robot, cable, (sample, expected))
            });
            let text = multiple.unwrap_or(format!(
                "{text}: waiting until the platform is at rest again."
            ));
            self.warn(cable, text);
        }
        true
    }

    /// Returns to settling after a jump; returns whether there was one.
    fn settle_anew(&mut self, sample: &Sample) -> bool {
        let jumped = self.note_jump(sample);
        if jumped {
            self.samples.clear();
            self.window.clear();
            self.stage = Stage::Approaching;
        }
        jumped
    }

    /// Continues once the laser distance has been typed.
    pub(super) fn wait_for_answer(&mut self, sample: &Sample) {
        if self.settle_anew(sample) {
            return;
        }
        self.window.push(sample.clone(), self.options.settle_time_s);
        let label = self.current().unwrap_or(0);
        if (self.asked.as_ref()).is_none_or(|laser| laser.is_answered(label)) {
            self.stage = Stage::Sampling;
        }
    }

    pub(super) fn collect(&mut self, sample: Sample, laser_problem: Option<String>) {
        if self.settle_anew(&sample) {
            return;
        }
        if let Some(motion) = &mut self.motion {
            motion.record(&sample);
        }
        self.samples.push(sample);
        self.pending.push(MeasuringEvent::Sampling {
            taken: self.samples.len(),
            of: self.options.samples,
        });
        if self.samples.len() >= self.options.samples {
            self.accept(laser_problem);
        }
    }

    /// Checks the mean of the samples and passes it to the caller, unless it cannot be used.
    fn accept(&mut self, laser_problem: Option<String>) {
        let Some((label, pose)) = self.current else {
            return;
        };
        let measured = MeasuredPose {
            started: self.samples.last().and_then(|sample| sample.started),
            ..MeasuredPose::from(mean_readings(label, pose, &self.samples))
        };
        let expected = (self.predictor)(&pose);
        let checks = Checks {
            robot: &self.robot,
            options: &self.options,
            at: &measured.readings,
            label,
            samples: &self.samples,
            laser_problem,
        };
        let warnings = checks.all(self.motion.as_ref(), expected.as_ref());
        let refusal = warnings.iter().find(|w| w.refuses).map(|w| w.text.clone());
        let dead = warnings.iter().filter(|w| w.is_dead_sensor);
        let dead = dead.filter(|w| !self.unprotected.contains(&w.cable));
        let (asked_about, texts): (Vec<_>, Vec<_>) =
            dead.map(|w| (w.cable, w.text.clone())).unzip();
        self.pending
            .extend(warnings.into_iter().map(MeasuringEvent::Warning));
        if let Some(text) = texts.into_iter().next() {
            self.asked_about = asked_about;
            let text = text.trim_end_matches('.');
            self.pause_for(
                format!("{text}: an overload of this cable would not be noticed. Resume only if it may go on without"),
                true,
            );
            return;
        }
        if let Some(text) = refusal {
            self.hold(format!("pose {label} cannot be used: {text}"));
            return;
        }
        if label != 0 {
            let plausible_m = self.options.plausible_m;
            let expected = expected.as_ref();
            let found =
                (self.channels).compare(&self.robot, &measured.readings, expected, plausible_m);
            found.into_iter().for_each(|f| self.warn(f.cable, f.text));
        }
        self.stage = Stage::Storing;
        self.pending
            .push(MeasuringEvent::Measured(Box::new(measured)));
    }
}
