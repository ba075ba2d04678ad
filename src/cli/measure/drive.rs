//! The measuring run: no pose is commanded before the previous one is on disk.

use crate::output::note;
use std::collections::HashMap;

use crate::BadInput;
use anyhow::{Context, Result, anyhow};
use tautline_core::estimation::Control;
use tautline_core::geometry::Pose;
use tautline_core::sequential::Decision;
use tautline_link::ParameterInfo;
use tautline_link::laser::ManualLaser;
use tautline_link::measuring::{
    MeasuringEvent, MeasuringOptions, MeasuringRun, Stage, largest_sd_m, predict_by,
};
use tautline_session::{MeasuredPose, Phase, RecoveryWriter, Session, SessionChanges};
use tautline_workflow::clock;
use tautline_workflow::controllers::ConnectionSetup;
use tautline_workflow::foreign_writes::{ValuesRead, begin_run, end_run};
use tautline_workflow::identification::identify_session;
use tautline_workflow::sequential::{
    SequentialRun, UntilDocument, end_in_words, progress_in_words,
};
use tautline_workflow::wording::sentence;

use super::document::Skipped;
use crate::live::{Connection, SessionFile, interrupt, typed};

/// Smallest number of poses, home included, at which the precision is checked.
const LEAST: usize = 6;

/// Reason why a run ended.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum RunEnd {
    /// Every pose is measured or skipped.
    #[default]
    Finished,
    /// The requested precision is reached.
    GoodEnough,
    /// A decision ended it; the reason in a few words.
    Decided(&'static str),
    /// The operator interrupted it.
    Interrupted,
    /// The run failed; one sentence.
    Failed(String),
    /// A required answer was not typed; one sentence.
    NotTyped(String),
}

/// Result of a run.
#[derive(Debug, Clone, Default)]
pub struct RunOutcome {
    /// Reason why it ended.
    pub end: RunEnd,
    /// Labels of the poses measured in this run.
    pub measured: Vec<i64>,
    /// Poses that were skipped, with the reasons.
    pub skipped: Vec<Skipped>,
    /// Largest standard deviation of a coordinate that results from the readings (m), if it was requested.
    pub largest_sd_m: Option<f64>,
    /// Whether the controller was restarted: the series cannot be continued then.
    pub restarted: bool,
    /// Changes of the controller's values by somebody else while poses were measured, one sentence each.
    pub foreign_writes: Vec<String>,
    /// Goals and decisions, if it measures until it is certain.
    pub until: Option<UntilDocument>,
}

/// A run with its stop criteria.
pub struct Drive {
    run: MeasuringRun,
    poses: usize,
    stop_at_m: Option<f64>,
    until: Option<SequentialRun>,
    /// Number of poses that were measured before this run.
    rows: usize,
    retries: usize,
    tried: HashMap<i64, usize>,
    ended: RunOutcome,
}

impl Drive {
    /// A run over the planned poses that are not measured yet, or over those that `until` decides on.
    pub fn new(
        session: &Session,
        setup: &ConnectionSetup,
        (stop_at_m, until): (Option<f64>, Option<SequentialRun>),
        retries: usize,
    ) -> Self {
        let planned = session.plan.iter();
        // Poses are decided on only after home, to which all lengths refer.
        let planned = planned.filter(|pose| until.is_none() || pose.label == 0);
        let plan: Vec<(i64, Pose)> = planned.map(|pose| (pose.label, pose.pose())).collect();
        let mut options = MeasuringOptions::of(setup.robot());
        options.tension = setup.tension();
        let poses = until.as_ref().map_or(plan.len(), SequentialRun::at_most);
        let mut run = MeasuringRun::new(plan, setup.robot(), options)
            .predicting(predict_by(setup.robot(), setup.tension()))
            .continuing(&session.measurements.labels);
        if until.is_some() {
            run = run.open_ended();
        }
        Self {
            run,
            poses,
            stop_at_m,
            rows: session.measurements.len(),
            retries,
            tried: HashMap::new(),
            ended: RunOutcome::default(),
            until,
        }
    }

    /// Measures until the end; then everything is in the session file and no autosave is left beside it.
    pub fn run(
        mut self,
        file: &mut SessionFile,
        connection: &mut Connection,
    ) -> Result<RunOutcome> {
        let mut keeper = file.autosave()?;
        self.run = self.run.asking(connection.manual_laser.clone());
        let measured = self.measure(file, connection, &mut keeper);
        if self.run.stage() != Stage::Ended || measured.is_err() {
            connection.stop();
        }
        match measured {
            Ok(end) => self.ended.end = end,
            // If saving fails below, the autosaved poses stay beside the file for the next command.
            Err(error) if error.is::<BadInput>() => {
                self.ended.end = RunEnd::NotTyped(error.to_string());
            }
            Err(error) => self.ended.end = RunEnd::Failed(format!("{error:#}")),
        }
        if let Some(MeasuringEvent::ValuesAtEnd(read)) =
            self.run.values_at_end(&mut *connection.controller)
        {
            self.compare(&read, file, connection);
        }
        self.ended.restarted = self.run.was_restarted();
        let until = self.until.as_ref();
        self.ended.until = until.map(|until| until.document(&file.session.robot));
        super::log(file, &self.ended);
        file.save()?;
        keeper.finish()?;
        Ok(self.ended)
    }

    fn measure(
        &mut self,
        file: &mut SessionFile,
        connection: &mut Connection,
        keeper: &mut RecoveryWriter,
    ) -> Result<RunEnd> {
        if self.is_good_enough(&file.session) {
            return Ok(RunEnd::GoodEnough);
        }
        if let Some(until) = self.until.as_mut().filter(|_| self.run.remaining() == 0) {
            until.ask(&file.session);
        }
        loop {
            if interrupt::requested() {
                return Ok(RunEnd::Interrupted);
            }
            if let Some(decision) = self.until.as_mut().and_then(SequentialRun::poll) {
                let decision = decision.map_err(|error| anyhow!("{}", sentence(&error)))?;
                if let Some(end) = self.follow(decision, file, keeper)? {
                    return Ok(end);
                }
            }
            if self.is_deciding() && connection.stands_still() {
                continue;
            }
            connection.step();
            let now_s = connection.now_s();
            for event in self.run.tick(&mut *connection.controller, now_s) {
                match event {
                    MeasuringEvent::ValuesAtStart(read) => {
                        let read = ValuesRead {
                            controller: &connection.controller.identity(),
                            parameters: &read,
                        };
                        let text = begin_run(&mut file.session, read, clock::now());
                        self.tell_foreign_write(text, file);
                        // A killed run is compared by the next command.
                        file.save()?;
                    }
                    MeasuringEvent::ValuesAtEnd(read) => self.compare(&read, file, connection),
                    MeasuringEvent::Measured(pose) => {
                        self.store(&pose, &mut file.session, keeper)?;
                        if self.is_good_enough(&file.session) {
                            return Ok(RunEnd::GoodEnough);
                        }
                        if let Some(until) = &mut self.until {
                            until.measured(pose.label(), &file.session);
                        }
                    }
                    MeasuringEvent::Skipped { label } => {
                        if let Some(until) = &mut self.until {
                            until.leave_out(label, &file.session);
                        }
                    }
                    MeasuringEvent::Warning(warning) => note!("{}", sentence(&warning.text)),
                    MeasuringEvent::LaserWanted { label } => {
                        if let Some(laser) = &connection.manual_laser {
                            ask_distance(label, laser)?;
                        }
                    }
                    MeasuringEvent::Paused {
                        reason,
                        is_overload: true,
                    } => return Err(anyhow!("{}", sentence(&reason))),
                    MeasuringEvent::Paused { reason, .. } => self.paused(&reason, connection)?,
                    MeasuringEvent::Finished => return Ok(RunEnd::Finished),
                    MeasuringEvent::Failed(text) => return Ok(RunEnd::Failed(text)),
                    MeasuringEvent::Commanded { .. }
                    | MeasuringEvent::Settling { .. }
                    | MeasuringEvent::Sampling { .. } => {}
                }
            }
        }
    }

    fn is_deciding(&self) -> bool {
        let until = self.until.as_ref();
        until.is_some_and(SequentialRun::is_deciding)
    }

    /// Follows a decision, which may end the run. The pose and its reason are on disk before the robot moves.
    fn follow(
        &mut self,
        decision: Decision,
        file: &mut SessionFile,
        keeper: &mut RecoveryWriter,
    ) -> Result<Option<RunEnd>> {
        if let Some(known) = &decision.assessment {
            note!("{}", progress_in_words(&file.session.robot, known));
        }
        let end = end_in_words(&decision.step);
        let until = self.until.as_mut();
        let chosen = until.and_then(|until| until.follow(decision, &mut file.session));
        let Some(chosen) = chosen else {
            self.run.close();
            return Ok(end.map(RunEnd::Decided));
        };
        note!("next: pose {} {}", chosen.label, chosen.reason);
        file.log(Phase::Poses, chosen.log_text());
        keeper.write_changes(SessionChanges::of(&file.session, self.rows))?;
        self.run.add(chosen.label, chosen.pose);
        Ok(None)
    }

    /// Saves a pose to disk before it is reported, and reports it before the next one is commanded.
    fn store(
        &mut self,
        pose: &MeasuredPose,
        session: &mut Session,
        keeper: &mut RecoveryWriter,
    ) -> Result<()> {
        let label = pose.label();
        keeper.append_pose(pose)?;
        let appended = session.append_pose(pose);
        appended.map_err(|error| anyhow!("pose {label} cannot be used: {error}"))?;
        self.ended.measured.push(label);
        note!(
            "pose {label} is on disk ({} of {})",
            session.measurements.len(),
            self.poses
        );
        self.run.confirm_stored(label);
        Ok(())
    }

    /// Compares the values of the controller at the end of the run with those at its start.
    fn compare(
        &mut self,
        parameters: &[ParameterInfo],
        file: &mut SessionFile,
        connection: &Connection,
    ) {
        let controller = &connection.controller.identity();
        let read = ValuesRead {
            controller,
            parameters,
        };
        let text = end_run(&mut file.session, read, None, clock::now());
        self.tell_foreign_write(text, file);
    }

    /// Reports that somebody else changed values of the controller.
    fn tell_foreign_write(&mut self, text: Option<String>, file: &mut SessionFile) {
        if let Some(text) = text {
            note!("{text}");
            file.log(Phase::Poses, text.clone());
            self.ended.foreign_writes.push(text);
        }
    }

    /// Retries a pose, or skips it.
    fn paused(&mut self, reason: &str, connection: &Connection) -> Result<()> {
        let state = connection.controller.state();
        let label = self.run.under_way().context("the run waits")?;
        if !state.armed {
            return Err(anyhow!("{}", sentence(reason)));
        }
        let tried = self.tried.entry(label).or_default();
        *tried += 1;
        if *tried <= self.retries {
            note!("{}: retrying.", sentence(reason.trim_end_matches('.')));
            self.run.resume();
            return Ok(());
        }
        if label == 0 {
            return Err(anyhow!(
                "the home pose, which all lengths refer to, cannot be measured: {reason}"
            ));
        }
        note!(
            "{}: pose {label} is skipped.",
            sentence(reason.trim_end_matches('.'))
        );
        let (pose, reason) = (label, reason.to_owned());
        self.ended.skipped.push(Skipped { pose, reason });
        self.run.skip();
        Ok(())
    }

    fn is_good_enough(&mut self, session: &Session) -> bool {
        let Some(limit_m) = self.stop_at_m else {
            return false;
        };
        if session.measurements.len() < LEAST {
            return false;
        }
        let quiet = &mut |_: &_| Control::Continue;
        let fit = identify_session(session, quiet).ok();
        let fit = fit.filter(|fit| fit.solution.converged() && fit.open.is_empty());
        self.ended.largest_sd_m = fit.and_then(|fit| largest_sd_m(&fit.solution));
        self.ended.largest_sd_m.is_some_and(|sd_m| sd_m <= limit_m)
    }
}

/// Asks the operator for the laser distance at a pose.
fn ask_distance(label: i64, laser: &ManualLaser) -> Result<()> {
    let question =
        format!("Laser distance at pose {label} [mm], or - where the laser has no return?");
    let read = |line: &str| match line.trim() {
        "-" => Some(None),
        number => number.parse().ok().map(|mm: f64| Some(mm * 1e-3)),
    };
    let typed = typed::answer(&question, "a number of millimetres or -", read);
    let missing = || BadInput::new(format!("No laser distance was typed for pose {label}."));
    let distance_m = typed.ok_or_else(missing)?;
    laser
        .answer(label, distance_m)
        .map_err(|error| anyhow!("{error}"))
}
