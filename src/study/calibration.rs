//! One simulated calibration: random stream, simulated run, identification, errors.

use nalgebra::DVector;
use rand::{Rng, RngExt};
use rand_chacha::ChaCha8Rng;
use tautline_core::diagnosis::{DiagnosisOptions, Verdict, diagnose};
use tautline_core::effect::{EffectSetting, Scope};
use tautline_core::estimation::{Control, Options, ParameterId, Problem, Solution, solve};
use tautline_core::robot::Robot;
use tautline_core::simulation::{
    RepeatedRuns, Simulated, SimulationError, SimulationOptions, simulate,
};

use crate::cell::Cell;
use crate::design::stream;
use crate::file::{Fault, StudyFile};

/// Outcome of a calibration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Outcome {
    /// The solver converged.
    Converged = 0,
    /// The solver did not converge.
    NotConverged = 1,
    /// The faults broke the robot: it could not be simulated.
    NotSimulated = 2,
}

/// Verdict of the diagnosis on a calibration, compared with the hidden faults.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Opinion {
    /// No diagnosis was made.
    NotAsked = 0,
    /// Nothing.
    Silent = 1,
    /// It named every hidden fault, alone or among alternatives, and no other.
    Right = 2,
    /// It named a fault that is not present.
    Wrong = 3,
    /// It detected faults but named only some of them, or none.
    Partly = 4,
}

/// Result of one simulated calibration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Calibration {
    /// Outcome.
    pub outcome: Outcome,
    /// Root mean square error of the entry point coordinates (m).
    pub entry_m: f64,
    /// Root mean square position error over the workspace (m); NaN without home pose.
    pub position_m: f64,
    /// Accuracy of poses AP of ISO 9283 (m); NaN without home pose.
    pub accuracy_m: f64,
    /// Chi-square.
    pub chi2: f64,
    /// Its degrees of freedom.
    pub degrees_of_freedom: f64,
    /// Bit set of the hidden faults, by index in the study.
    pub faults: u8,
    /// Verdict of the diagnosis.
    pub opinion: Opinion,
}

/// Simulator of the calibrations of one cell.
pub struct Simulator<'a> {
    study: &'a StudyFile,
    cell: &'a Cell,
    method: tautline_core::estimation::Method,
    runs: RepeatedRuns,
}

impl<'a> Simulator<'a> {
    /// Prepares what the calibrations of a cell share.
    ///
    /// # Errors
    /// If the robot cannot be held at one of its poses.
    pub fn new(
        study: &'a StudyFile,
        cell: &'a Cell,
        method: tautline_core::estimation::Method,
    ) -> Result<Self, SimulationError> {
        Ok(Self {
            study,
            cell,
            method,
            runs: RepeatedRuns::new(&cell.robot, cell.poses.clone(), None)?,
        })
    }

    /// Calibration number `index` of the study, which is number `within` of its cell. Its random numbers
    /// are the stream of that number, so that the result depends on neither machine nor order.
    #[must_use]
    pub fn calibrate(&self, index: u64, within: u64) -> Calibration {
        let mut rng = stream(self.study.seed, index);
        let drawn = self.draw_faults(&mut rng);
        let mut faults = 0;
        for (bit, _) in &drawn {
            faults |= 1 << bit;
        }
        let settings: Vec<EffectSetting> = drawn.into_iter().map(|(_, setting)| setting).collect();
        let Ok(run) = self.simulate(&settings, &mut rng) else {
            return Calibration::failed(Outcome::NotSimulated, faults);
        };
        let mut calibration = self.identify(&run, faults);
        if within < self.study.simulation.diagnosed && calibration.outcome == Outcome::Converged {
            calibration.opinion = self.opinion(&run, &settings);
        }
        calibration
    }

    /// Runs the solver alone, as timed by the command `identify`: from data in memory to the result in memory.
    ///
    /// # Errors
    /// If the data cannot be used.
    pub fn solve(
        &self,
        run: &Simulated,
    ) -> Result<Solution, tautline_core::estimation::EstimationError> {
        let problem = Problem::new(&run.dataset)?.with_method(self.method);
        let problem = problem.with_stated_tolerances();
        solve(&problem, &Options::default(), &mut |_| Control::Continue)
    }

    /// Simulates a run with faults; parts deviate as the tolerances of the robot say.
    fn simulate(
        &self,
        faults: &[EffectSetting],
        rng: &mut ChaCha8Rng,
    ) -> Result<Simulated, SimulationError> {
        let robot = &self.cell.robot;
        if faults.is_empty() && robot.tolerances.is_none() && !robot.hangs_freely() {
            return self.runs.simulate(rng);
        }
        let options = SimulationOptions {
            effects: faults.to_vec(),
            seed: rng.next_u64(),
            ..self.runs.options().clone()
        };
        simulate(robot, &options)
    }

    /// Simulates a run without faults.
    ///
    /// # Errors
    /// If the true robot cannot be held.
    pub fn run(&self, index: u64) -> Result<Simulated, SimulationError> {
        self.simulate(&[], &mut stream(self.study.seed, index))
    }

    fn identify(&self, run: &Simulated, faults: u8) -> Calibration {
        let Ok(solution) = self.solve(run) else {
            return Calibration::failed(Outcome::NotConverged, faults);
        };
        if !solution.converged() {
            return Calibration::failed(Outcome::NotConverged, faults);
        }
        let errors = errors(&solution, &run.truth);
        let entry = |(parameter, error): (&tautline_core::estimation::Parameter, &f64)| {
            matches!(parameter.id, ParameterId::EntryPoint { .. }).then_some(error * error)
        };
        let squares: Vec<f64> = solution
            .parameters
            .iter()
            .zip(errors.iter())
            .filter_map(entry)
            .collect();
        Calibration {
            outcome: Outcome::Converged,
            entry_m: (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt(),
            position_m: self.cell.position_m(&errors).unwrap_or(f64::NAN),
            accuracy_m: self.cell.accuracy_of_poses_m(&errors).unwrap_or(f64::NAN),
            chi2: solution.chi2,
            degrees_of_freedom: solution.degrees_of_freedom,
            faults,
            opinion: Opinion::NotAsked,
        }
    }

    /// Draws the faults of a calibration, each with its rate; returned with their index in the study.
    fn draw_faults(&self, rng: &mut ChaCha8Rng) -> Vec<(usize, EffectSetting)> {
        let mut drawn = Vec::new();
        for (number, fault) in self.study.faults.iter().enumerate() {
            if rng.random_range(0.0..1.0) < fault.rate {
                drawn
                    .extend(setting(fault, &self.cell.robot, rng).map(|setting| (number, setting)));
            }
        }
        drawn
    }

    fn opinion(&self, run: &Simulated, hidden: &[EffectSetting]) -> Opinion {
        let options = DiagnosisOptions {
            alpha: self.study.simulation.alpha,
            ..DiagnosisOptions::default()
        };
        let Ok(diagnosis) = diagnose(&run.dataset, &options, &mut |_| Control::Continue) else {
            return Opinion::NotAsked;
        };
        let mut found = vec![false; hidden.len()];
        let mut unknown = false;
        for finding in &diagnosis.findings {
            let mut is_right = false;
            for bound in finding.causes().flat_map(|cause| &cause.instances) {
                let named = bound.setting(&self.cell.robot);
                for (found, fault) in found.iter_mut().zip(hidden) {
                    let is_it = named.effect == fault.effect && named.targets == fault.targets;
                    *found |= is_it;
                    is_right |= is_it;
                }
            }
            if finding.verdict() == Verdict::Named && !is_right {
                return Opinion::Wrong;
            }
            unknown |= !is_right;
        }
        match (
            diagnosis.findings.is_empty(),
            unknown || found.contains(&false),
        ) {
            (true, _) => Opinion::Silent,
            (false, false) => Opinion::Right,
            (false, true) => Opinion::Partly,
        }
    }
}

impl Calibration {
    fn failed(outcome: Outcome, faults: u8) -> Self {
        Self {
            outcome,
            entry_m: f64::NAN,
            position_m: f64::NAN,
            accuracy_m: f64::NAN,
            chi2: f64::NAN,
            degrees_of_freedom: f64::NAN,
            faults,
            opinion: Opinion::NotAsked,
        }
    }
}

/// Errors of all parameters, in order; zero for effects, planes and tensions, which do not move the platform.
fn errors(solution: &Solution, truth: &Robot) -> DVector<f64> {
    let home = truth
        .home
        .map(|home| solution.globals.home.difference(&home.pose()));
    let error = |parameter: &tautline_core::estimation::Parameter| match parameter.id {
        ParameterId::EntryPoint { cable, axis } => {
            solution.globals.entry_points[cable][axis]
                - truth.cables[cable].pulley.entry_point_m[axis]
        }
        ParameterId::Home(coordinate) => home.map_or(0.0, |off| off[coordinate.index()]),
        _ => 0.0,
    };
    let errors: Vec<f64> = solution.parameters.iter().map(error).collect();
    DVector::from_vec(errors)
}

/// A fault with cable and sizes drawn at random; `None` if it concerns two cables or the robot has no candidate.
fn setting(fault: &Fault, robot: &Robot, rng: &mut ChaCha8Rng) -> Option<EffectSetting> {
    let effect = robot.effect(&fault.effect)?;
    let cable = rng.random_range(0..robot.cable_count().max(1));
    let targets = match effect.scope() {
        Scope::Cable | Scope::CableOrAll => vec![robot.cables.get(cable)?.name.clone()],
        Scope::Robot => Vec::new(),
        Scope::Pair => return None,
    };
    let mut parameters = fault.parameters.clone();
    for parameter in effect.parameters() {
        // Always drawn, so that a given value does not shift the subsequent random numbers.
        let [low, high] = parameter.typical;
        let size = rng.random_range(0.0..1.0_f64);
        let turned = rng.random_range(0..2) == 1;
        let drawn = match low > 0.0 && high > low {
            true => low * (high / low).powf(size),
            false => low + (high - low) * size,
        };
        let is_signed = !parameter.discrete && parameter.bounds[0] < -drawn;
        let drawn = match parameter.discrete {
            true => drawn.round(),
            false if turned && is_signed => -drawn,
            false => drawn,
        };
        parameters.entry(parameter.name.to_owned()).or_insert(drawn);
    }
    Some(EffectSetting {
        effect: fault.effect.clone(),
        targets,
        parameters,
    })
}
