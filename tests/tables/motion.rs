//! Recordings in motion, simulated with a late external instrument whose clock drifts, compared with the truth; what the
//! doctor makes of them.

use std::ops::Range;

use anyhow::Result;
use serde::{Deserialize, Serialize};
use tautline_core::diagnosis::{Finding, Verdict};
use tautline_core::effect::EffectSetting;
use tautline_core::estimation::{Control, Method, ParameterId};
use tautline_core::robot::{PerAxis, Robot, Tracker};
use tautline_core::simulation::{Recording, Simulated, SimulationError, SimulationOptions, record};
use tautline_workflow::identification::{Identification, IdentificationRequest, identify};

use super::counting::{Share, total};
use super::markdown::Table;
use super::simulated::{EntryError, NORMAL_95, asked, preset, setting};
use super::study::Study;

/// Presets that are recorded.
const ROBOTS: [&str; 2] = ["mini", "planar"];
/// Seed of the first recording.
pub const FIRST_SEED: u64 = 1000;

/// What is late in a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Late {
    /// The external instrument, whose clock drifts as well.
    Instrument,
    /// The force sensors.
    Forces,
}

/// Drift of the clock of the external instrument.
const DRIFT: f64 = 5e-5;
/// The error of a delay that counts as found, whatever its interval (s).
const GOOD_S: f64 = 2e-4;
/// Error of the cable per revolution that is hidden beside the latency, and the cable.
const DRUM: (f64, usize) = (0.005, 2);
/// How the robots are recorded.
pub const RECORDING: Recording = Recording {
    duration_s: 60.0,
    rate_hz: 100.0,
    correlation_s: 0.05,
};

impl Late {
    /// Its delay (s).
    fn delay_s(self) -> f64 {
        match self {
            Self::Instrument => 0.034,
            Self::Forces => 0.05,
        }
    }

    fn title(self) -> &'static str {
        match self {
            Self::Instrument => "instrument",
            Self::Forces => "forces",
        }
    }

    /// Effects and their parameter, the delay first, with their sizes.
    fn effects(self) -> Vec<(&'static str, &'static str, f64)> {
        match self {
            Self::Instrument => vec![
                ("tracker_latency", "delay", self.delay_s()),
                ("tracker_clock", "drift", DRIFT),
            ],
            Self::Forces => vec![("force_latency", "delay", self.delay_s())],
        }
    }

    /// Them as settings: as they are hidden, or 0 to be estimated.
    fn settings(self, is_hidden: bool) -> Vec<EffectSetting> {
        let size = |size: f64| if is_hidden { size } else { 0.0 };
        let effects = self.effects().into_iter();
        effects
            .map(|(effect, parameter, hidden)| setting(effect, &[], parameter, size(hidden)))
            .collect()
    }
}

/// A preset with an external instrument as cameras that track markers are.
fn tracked(name: &str) -> Result<Robot> {
    Ok(Robot {
        tracker: Some(Tracker {
            position_sd_m: PerAxis::Same(1e-3),
            orientation_sd_rad: Some(1e-3),
        }),
        ..preset(name)?.robot
    })
}

/// A recording in which something is late, and with a wrong drum if that is wanted.
fn recorded(
    robot: &Robot,
    late: Late,
    recording: &Recording,
    (seed, drum): (u64, bool),
) -> Result<Simulated> {
    let mut effects = late.settings(true);
    if drum {
        let (scale, cable) = DRUM;
        let target = robot.cables[cable].name.as_str();
        effects.push(setting("winch_scale", &[target], "scale", scale));
    }
    let options = SimulationOptions {
        effects,
        ..SimulationOptions::new(0, seed)
    };
    Ok(record(robot, &options, recording)?)
}

/// A preset that is recorded with a seed.
pub type Case = (Late, usize, u64);

/// So many recordings of each preset from a seed on; motions through which no tensions hold the platform are left out.
fn cases(
    late: Late,
    seeds: &Range<u64>,
    drum: fn(u64) -> bool,
    recording: &Recording,
) -> Result<Vec<Case>> {
    let count = (seeds.end - seeds.start) as usize;
    let mut cases = Vec::new();
    for (index, name) in ROBOTS.iter().enumerate() {
        let robot = tracked(name)?;
        let is_feasible = |seed: &u64| {
            let run = recorded(&robot, late, recording, (*seed, drum(*seed)));
            let why = run.as_ref().err().and_then(|error| error.downcast_ref());
            !matches!(why, Some(SimulationError::Infeasible { .. }))
        };
        let feasible = (seeds.start..).filter(is_feasible).take(count);
        cases.extend(feasible.map(|seed| (late, index, seed)));
    }
    Ok(cases)
}

/// Identifies a robot from a recording, with what is late.
fn identified(run: &Simulated, late: Late) -> Result<Identification> {
    let effects = late.settings(false);
    let mut request = IdentificationRequest::new(run.dataset.clone(), Method::Joint, &effects)?;
    request.lists_readings = false;
    Ok(identify(&request, &mut |_| Control::Continue)?)
}

/// Recordings of each preset in which the instrument or the forces are late.
#[derive(Debug)]
pub struct Motion {
    /// What is late, in turn.
    pub lates: &'static [Late],
    /// The first seed, and the number of recordings.
    pub seeds: Range<u64>,
}

/// What one recording determines.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Outcome {
    /// Number of samples used.
    samples: usize,
    /// Error of the delay and its stated standard deviation (s).
    pub delay_s: [f64; 2],
    /// Whether the interval of the drift covers it, where a clock drifts.
    is_drift_covered: Option<bool>,
    /// Coordinates of entry points in their intervals.
    pub entries: Share,
    /// Chi-square over the degrees of freedom.
    pub chi2_ratio: f64,
    seconds: f64,
}

impl Outcome {
    fn is_delay_covered(&self) -> bool {
        let [error_s, sd_s] = self.delay_s;
        error_s.abs() < NORMAL_95 * sd_s
    }

    /// Whether the delay is within 0.2 ms of the truth or its interval covers it.
    #[must_use]
    pub fn is_delay_good(&self) -> bool {
        self.delay_s[0].abs() < GOOD_S || self.is_delay_covered()
    }
}

impl Study for Motion {
    type Case = Case;
    type Outcome = Outcome;

    fn cases(&self) -> Result<Vec<Case>> {
        let lates = self.lates.iter();
        let cases = lates.map(|late| cases(*late, &self.seeds, |_| false, &RECORDING));
        Ok(cases.collect::<Result<Vec<_>>>()?.concat())
    }

    fn run(&self, (late, robot, seed): &Case) -> Result<Option<Outcome>> {
        let robot = tracked(ROBOTS[*robot])?;
        let run = recorded(&robot, *late, &RECORDING, (*seed, false))?;
        let found = identified(&run, *late)?;
        let solution = &found.solution;
        let mut outcome = Outcome {
            samples: found.dataset.measurements.len(),
            chi2_ratio: solution.chi2 / solution.degrees_of_freedom,
            seconds: found.seconds,
            ..Outcome::default()
        };
        for one in EntryError::all(solution, &run.truth) {
            if let Some(sd_m) = one.sd_m {
                outcome.entries.count(one.error_m.abs() < NORMAL_95 * sd_m);
            }
        }
        for (index, parameter) in solution.parameters.iter().enumerate() {
            let ParameterId::Effect { effect, .. } = parameter.id else {
                continue;
            };
            if let Some(sd) = solution.standard_deviation(index) {
                let value = found.free_effects()[effect].values[0];
                match effect {
                    0 => outcome.delay_s = [value - late.delay_s(), sd],
                    _ => outcome.is_drift_covered = Some((value - DRIFT).abs() < NORMAL_95 * sd),
                }
            }
        }
        Ok(Some(outcome))
    }

    fn table(&self, outcomes: &[(Case, Outcome)]) -> Result<String> {
        let mut table = Table::new(
            "robot, what is late | recordings | samples used | delay, mean error ms | rms error ms | stated ms | within 0.2 ms or its interval | 95 % intervals cover: delay | drift | entry points | chi-square over dof | solve s",
        );
        for kind in outcomes.chunk_by(|(a, _), (b, _)| (a.0, a.1) == (b.0, b.1)) {
            let ((late, robot, _), _) = kind[0];
            let all: Vec<&Outcome> = kind.iter().map(|(_, outcome)| outcome).collect();
            let mean = |value: fn(&Outcome) -> f64| total::<_, f64>(&all, value) / all.len() as f64;
            let percent = |share: Share| 100.0 * share.ratio();
            let drift = Share::of(all.iter().filter_map(|one| one.is_drift_covered), |is| is);
            table.row(format_args!(
                "{}, {} | {} | {:.0} | {:+.3} | {:.3} | {:.3} | {:.1} % | {:.1} % | {} | {:.1} % | {:.3} | {:.2}",
                ROBOTS[robot],
                late.title(),
                all.len(),
                mean(|one| one.samples as f64),
                1e3 * mean(|one| one.delay_s[0]),
                1e3 * mean(|one| one.delay_s[0].powi(2)).sqrt(),
                1e3 * mean(|one| one.delay_s[1]),
                percent(Share::of(&all, |one| one.is_delay_good())),
                percent(Share::of(&all, |one| one.is_delay_covered())),
                match drift.whole {
                    0 => "–".to_owned(),
                    _ => drift.percent(),
                },
                percent(total(&all, |one| one.entries)),
                mean(|one| one.chi2_ratio),
                mean(|one| one.seconds),
            ));
        }
        Ok(table.text())
    }
}

/// Recordings of each preset about which the doctor is asked: the instrument is late, with a wrong drum beside latency and drift where
/// the seed is odd.
#[derive(Debug)]
pub struct AskedInMotion {
    /// The first seed, and the number of recordings.
    pub seeds: Range<u64>,
    /// How the robots are recorded.
    pub recording: Recording,
}

/// Whether the doctor names what is hidden in a recording, and how many other causes.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Said {
    /// The latency.
    pub latency: bool,
    clock: bool,
    /// The wrong drum, if there is one.
    pub drum: Option<bool>,
    others: usize,
    seconds: f64,
}

fn has_drum(seed: u64) -> bool {
    seed % 2 == 1
}

impl Study for AskedInMotion {
    type Case = Case;
    type Outcome = Said;

    fn cases(&self) -> Result<Vec<Case>> {
        cases(Late::Instrument, &self.seeds, has_drum, &self.recording)
    }

    fn run(&self, (late, robot, seed): &Case) -> Result<Option<Said>> {
        let robot = tracked(ROBOTS[*robot])?;
        let run = recorded(&robot, *late, &self.recording, (*seed, has_drum(*seed)))?;
        let told = asked(run.dataset)?;
        let mut said = Said {
            drum: has_drum(*seed).then_some(false),
            seconds: told.seconds,
            ..Said::default()
        };
        let findings = told.diagnosis.findings.iter();
        let named = findings.filter(|finding| finding.verdict() == Verdict::Named);
        for cause in named.filter_map(Finding::cause) {
            match (cause.effect().id(), said.drum) {
                ("tracker_latency", _) => said.latency = true,
                ("tracker_clock", _) => said.clock = true,
                ("winch_scale", Some(_)) if cause.cables() == [DRUM.1] => said.drum = Some(true),
                (other, _) => {
                    said.others += 1;
                    eprintln!("{}, seed {seed}, another cause named: {other}", robot.name);
                }
            }
        }
        Ok(Some(said))
    }

    fn table(&self, outcomes: &[(Case, Said)]) -> Result<String> {
        let mut table = Table::new(
            "robot | recordings | latency named | drift of the clock named | wrong drum beside them named | other causes named | diagnosis s",
        );
        for of_robot in outcomes.chunk_by(|(a, _), (b, _)| a.1 == b.1) {
            let all: Vec<&Said> = of_robot.iter().map(|(_, said)| said).collect();
            let drums = Share::of(all.iter().filter_map(|said| said.drum), |named| named);
            table.row(format_args!(
                "{} | {} | {:.1} % | {:.1} % | {:.1} % | {} | {:.1}",
                ROBOTS[of_robot[0].0.1],
                all.len(),
                100.0 * Share::of(&all, |said| said.latency).ratio(),
                100.0 * Share::of(&all, |said| said.clock).ratio(),
                100.0 * drums.ratio(),
                total::<_, usize>(&all, |said| said.others),
                total::<_, f64>(&all, |said| said.seconds) / all.len() as f64,
            ));
        }
        Ok(table.text())
    }
}
