//! Recordings in motion, simulated with a late external instrument whose clock drifts, compared with the truth; what the
//! doctor makes of them.

use anyhow::{Result, anyhow};
use tautline_core::diagnosis::{Diagnosis, Finding, Verdict};
use tautline_core::effect::EffectSetting;
use tautline_core::estimation::{Control, Method, ParameterId};
use tautline_core::robot::{PerAxis, Robot, Tracker, presets};
use tautline_core::simulation::{Recording, Simulated, SimulationError, SimulationOptions, record};
use tautline_workflow::diagnosis::{TIME_LIMIT_S, diagnose_dataset};
use tautline_workflow::identification::{Identification, IdentificationRequest, identify};

/// What is late in a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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
/// Two-sided 95 %.
const QUANTILE: f64 = 1.959_964;
/// How the robots are recorded.
pub const RECORDING: Recording = Recording {
    duration_s: 60.0,
    rate_hz: 100.0,
    correlation_s: 0.05,
};

impl Late {
    /// Its delay (s).
    #[must_use]
    pub fn delay_s(self) -> f64 {
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

/// Figures of one robot over many recordings.
#[derive(Debug, Clone, Default)]
pub struct MotionRow {
    /// Preset, and what is late.
    pub robot: String,
    /// Number of recordings.
    pub recordings: usize,
    /// Mean number of samples used.
    pub samples: f64,
    /// Mean error of the delay (s).
    pub delay_bias_s: f64,
    /// Root mean square error of the delay (s).
    pub delay_rms_s: f64,
    /// Mean of its stated standard deviations (s).
    pub delay_sd_s: f64,
    /// Share of delays within 0.2 ms of the truth or whose interval covers it.
    pub delay_good: f64,
    /// Share of 95 % intervals that cover the delay.
    pub delay_covered: f64,
    /// Share that cover the drift, where a clock drifts.
    pub drift_covered: Option<f64>,
    /// Share that cover coordinates of entry points.
    pub entry_covered: f64,
    /// Mean chi-square over the degrees of freedom.
    pub chi2_ratio: f64,
    /// Mean time of an identification (s).
    pub seconds: f64,
}

/// Figures of the doctor over many recordings of one robot.
#[derive(Debug, Clone, Default)]
pub struct DoctorRow {
    /// Preset.
    pub robot: String,
    /// Number of recordings.
    pub recordings: usize,
    /// Share in which the latency is named.
    pub latency_named: f64,
    /// Share in which the drift of the clock is named.
    pub clock_named: f64,
    /// Share in which the wrong drum, hidden beside them, is named.
    pub drum_named: f64,
    /// Other causes that were named, with their seeds.
    pub others: Vec<(u64, &'static str)>,
    /// Mean time of a diagnosis (s).
    pub seconds: f64,
}

/// A preset with an external instrument as cameras that track markers are.
///
/// # Errors
/// If there is no such preset.
pub fn tracked(name: &str) -> Result<Robot> {
    let preset = presets::find(name).ok_or_else(|| anyhow!("no preset {name}"))?;
    Ok(Robot {
        tracker: Some(Tracker {
            position_sd_m: PerAxis::Same(1e-3),
            orientation_sd_rad: Some(1e-3),
        }),
        ..preset.robot
    })
}

fn setting(effect: &str, targets: &[String], parameter: &str, value: f64) -> EffectSetting {
    EffectSetting {
        effect: effect.into(),
        targets: targets.to_vec(),
        parameters: [(parameter.to_owned(), value)].into(),
    }
}

/// A recording in which something is late, and with a wrong drum if that is wanted.
///
/// # Errors
/// If it cannot be simulated.
pub fn recorded(
    robot: &Robot,
    late: Late,
    recording: &Recording,
    (seed, drum): (u64, bool),
) -> Result<Simulated> {
    let mut effects = late.settings(true);
    if drum {
        let (scale, cable) = DRUM;
        let target = robot.cables[cable].name.clone();
        effects.push(setting("winch_scale", &[target], "scale", scale));
    }
    let options = SimulationOptions {
        effects,
        ..SimulationOptions::new(0, seed)
    };
    Ok(record(robot, &options, recording)?)
}

/// So many recordings from a seed on, with a wrong drum where that is wanted; motions through which no tensions hold the
/// platform are left out.
fn runs<'a>(
    robot: &'a Robot,
    late: Late,
    recording: &'a Recording,
    (first_seed, count): (u64, usize),
    has_drum: fn(u64) -> bool,
) -> impl Iterator<Item = Result<(u64, Simulated)>> + 'a {
    let recorded = move |seed| {
        let run = recorded(robot, late, recording, (seed, has_drum(seed)));
        run.map(|run| (seed, run))
    };
    let is_infeasible = |error: &anyhow::Error| {
        let why = error.downcast_ref::<SimulationError>();
        matches!(why, Some(SimulationError::Infeasible { .. }))
    };
    let all = (first_seed..).map(recorded);
    all.filter(move |run| !run.as_ref().is_err_and(is_infeasible))
        .take(count)
}

/// Identifies a robot from a recording, with what is late.
///
/// # Errors
/// If the data do not make a problem.
fn identified(run: &Simulated, late: Late) -> Result<Identification> {
    let effects = late.settings(false);
    let mut request = IdentificationRequest::new(run.dataset.clone(), Method::Joint, &effects)?;
    request.lists_readings = false;
    Ok(identify(&request, &mut |_| Control::Continue)?)
}

/// Identifies many recordings of one preset.
///
/// # Errors
/// If the preset is unknown or cannot be simulated.
pub fn study(name: &str, late: Late, recordings: usize, first_seed: u64) -> Result<MotionRow> {
    let robot = tracked(name)?;
    let mut row = MotionRow {
        robot: format!("{name}, {}", late.title()),
        recordings,
        drift_covered: (late == Late::Instrument).then_some(0.0),
        ..MotionRow::default()
    };
    let (mut entries, mut entries_covered) = (0.0_f64, 0.0);
    let share = 1.0 / recordings as f64;
    let seeds = (first_seed, recordings);
    for run in runs(&robot, late, &RECORDING, seeds, |_| false) {
        let (_, run) = run?;
        let found = identified(&run, late)?;
        let solution = &found.solution;
        row.samples += share * found.dataset.measurements.len() as f64;
        row.chi2_ratio += share * solution.chi2 / solution.degrees_of_freedom;
        row.seconds += share * found.seconds;
        for (index, parameter) in solution.parameters.iter().enumerate() {
            let Some(sd) = solution.standard_deviation(index) else {
                continue;
            };
            let covers = |error: f64| f64::from(u8::from(error.abs() < QUANTILE * sd));
            match parameter.id {
                ParameterId::EntryPoint { cable, axis } => {
                    let truth = run.truth.cables[cable].pulley.entry_point_m[axis];
                    entries += 1.0;
                    entries_covered += covers(solution.globals.entry_points[cable][axis] - truth);
                }
                ParameterId::Effect { effect: 0, .. } => {
                    let error = found.free_effects()[0].values[0] - late.delay_s();
                    row.delay_bias_s += share * error;
                    row.delay_rms_s += share * error * error;
                    row.delay_sd_s += share * sd;
                    row.delay_covered += share * covers(error);
                    let good = error.abs() < GOOD_S || covers(error) > 0.0;
                    row.delay_good += share * f64::from(u8::from(good));
                }
                ParameterId::Effect { effect: 1, .. } => {
                    let error = found.free_effects()[1].values[0] - DRIFT;
                    let covered = row.drift_covered.get_or_insert_default();
                    *covered += share * covers(error);
                }
                _ => {}
            }
        }
    }
    row.delay_rms_s = row.delay_rms_s.sqrt();
    row.entry_covered = entries_covered / entries.max(1.0);
    Ok(row)
}

/// What the doctor says about a recording.
///
/// # Errors
/// If the data do not make a problem.
pub fn opinion(run: &Simulated) -> Result<(Diagnosis, f64)> {
    let dataset = run.dataset.clone().into();
    let found = diagnose_dataset(dataset, (0.01, TIME_LIMIT_S), &mut |_| Control::Continue)?;
    Ok((found.diagnosis, found.seconds))
}

/// Effects that a diagnosis names, with their cables.
#[must_use]
pub fn named(diagnosis: &Diagnosis) -> Vec<(&'static str, Vec<usize>)> {
    let findings = diagnosis.findings.iter();
    let named = findings.filter(|finding| finding.verdict() == Verdict::Named);
    let causes = named.filter_map(Finding::cause);
    causes
        .map(|cause| (cause.effect().id(), cause.cables()))
        .collect()
}

/// Asks the doctor about many recordings of one preset, with a wrong drum beside latency and drift where the seed is odd.
///
/// # Errors
/// If the preset is unknown or cannot be simulated.
pub fn doctor_study(
    name: &str,
    recordings: usize,
    first_seed: u64,
    recording: &Recording,
) -> Result<DoctorRow> {
    let robot = tracked(name)?;
    let mut row = DoctorRow {
        robot: name.to_owned(),
        recordings,
        ..DoctorRow::default()
    };
    let share = 1.0 / recordings as f64;
    let seeds = (first_seed, recordings);
    let has_drum = |seed| seed % 2 == 1;
    let (mut drums, mut drums_named) = (0, 0);
    for run in runs(&robot, Late::Instrument, recording, seeds, has_drum) {
        let (seed, run) = run?;
        let drum = has_drum(seed);
        drums += usize::from(drum);
        let (diagnosis, seconds) = opinion(&run)?;
        row.seconds += share * seconds;
        for (effect, cables) in named(&diagnosis) {
            match effect {
                "tracker_latency" => row.latency_named += share,
                "tracker_clock" => row.clock_named += share,
                "winch_scale" if drum && cables == [DRUM.1] => drums_named += 1,
                _ => row.others.push((seed, effect)),
            }
        }
    }
    row.drum_named = f64::from(drums_named) / drums.max(1) as f64;
    Ok(row)
}

/// The tables as Markdown.
#[must_use]
pub fn markdown(rows: &[MotionRow], doctor: &[DoctorRow]) -> String {
    let mut text = String::from(
        "| robot, what is late | recordings | samples used | delay, mean error ms | rms error ms | stated ms | within 0.2 ms or its interval | 95 % intervals cover: delay | drift | entry points | chi-square over dof | solve s |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for row in rows {
        text += &format!(
            "| {} | {} | {:.0} | {:+.3} | {:.3} | {:.3} | {:.1} % | {:.1} % | {} | {:.1} % | {:.3} | {:.2} |\n",
            row.robot,
            row.recordings,
            row.samples,
            1e3 * row.delay_bias_s,
            1e3 * row.delay_rms_s,
            1e3 * row.delay_sd_s,
            100.0 * row.delay_good,
            100.0 * row.delay_covered,
            row.drift_covered
                .map_or("–".into(), |covered| format!("{:.1} %", 100.0 * covered)),
            100.0 * row.entry_covered,
            row.chi2_ratio,
            row.seconds,
        );
    }
    text += "\n| robot | recordings | latency named | drift of the clock named | wrong drum beside them named | other causes named | diagnosis s |\n|---|---|---|---|---|---|---|\n";
    for row in doctor {
        text += &format!(
            "| {} | {} | {:.1} % | {:.1} % | {:.1} % | {} | {:.1} |\n",
            row.robot,
            row.recordings,
            100.0 * row.latency_named,
            100.0 * row.clock_named,
            100.0 * row.drum_named,
            row.others.len(),
            row.seconds,
        );
    }
    text
}
