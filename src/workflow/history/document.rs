//! Machine-readable form of a history: a public format.

use nalgebra::DMatrix;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::history::{History, Jump, OUT_OF_TOLERANCE, RobotPart};
use tautline_core::robot::Robot;
use tautline_session::{Timestamp, VersionedFile};

use super::{RobotHistory, RobotRecord, Tolerance, days_after};

/// The life of one robot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HistoryDocument {
    /// The sessions in the order of time.
    pub sessions: Vec<HistorySession>,
    /// Jumps between two sessions.
    pub changes: Vec<ChangeDocument>,
    /// Steady drifts.
    pub drift: Vec<DriftDocument>,
    /// Date of the next calibration; null without dates.
    pub next_calibration: Option<NextCalibration>,
}

/// A session of a record.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HistorySession {
    /// Name of its file or folder.
    pub path: String,
    /// Time of the readings; null if unknown.
    pub time: Option<Timestamp>,
    /// Entry points with all sessions taken into account (m), cable by cable; null for coordinates that are known exactly.
    pub entry_points_m: Vec<[Option<f64>; 3]>,
    /// Their standard deviations (m).
    pub entry_points_sd_m: Vec<[Option<f64>; 3]>,
}

/// A part that moved or changed, and between which sessions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ChangeDocument {
    /// Part that changed.
    #[serde(flatten)]
    pub changed: Changed,
    /// Indices of sessions: the change happened after the first and not after the second.
    pub between: [usize; 2],
}

/// A part that moved or changed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Changed {
    /// Names of its cables; empty for the target plane and effects of the whole robot.
    pub targets: Vec<String>,
    /// Effect that appeared, ended or changed; null for a moved pulley or target plane.
    pub effect: Option<String>,
    /// Parameter of the effect.
    pub parameter: Option<String>,
    /// Posterior probability.
    pub probability: f64,
    /// Displacement along x, y, z (m), of the target plane its one number; null for an effect.
    pub displacement_m: Option<Vec<f64>>,
    /// Standard deviations of the displacement (m).
    pub sd_m: Option<Vec<f64>>,
    /// Change of the effect's parameter (SI unit); null for a displacement.
    pub change: Option<f64>,
    /// Its standard deviation.
    pub change_sd: Option<f64>,
}

impl Changed {
    /// A jump of a history.
    #[must_use]
    pub fn of(history: &History, robot: &Robot, jump: &Jump) -> Self {
        let (effect, parameter) = effect_of(&history.parts[jump.part]);
        let is_effect = effect.is_some();
        let axes = &history.axes[jump.part];
        let size = spatial(axes, jump.size.as_slice().to_vec());
        let sd = spatial(axes, sds(&jump.covariance));
        Self {
            targets: targets_of(&history.parts[jump.part], robot),
            effect,
            parameter,
            probability: jump.probability,
            change: is_effect.then(|| size[0]),
            change_sd: is_effect.then(|| sd[0]),
            displacement_m: (!is_effect).then_some(size),
            sd_m: (!is_effect).then_some(sd),
        }
    }
}

fn targets_of(part: &RobotPart, robot: &Robot) -> Vec<String> {
    match part {
        RobotPart::Pulley(cable) => vec![robot.cables[*cable].name.clone()],
        RobotPart::TargetPlane => Vec::new(),
        RobotPart::Effect { targets, .. } => targets.clone(),
    }
}

/// Effect and parameter of a part; `None` for pulleys and the target plane.
fn effect_of(part: &RobotPart) -> (Option<String>, Option<String>) {
    match part {
        RobotPart::Effect {
            effect, parameter, ..
        } => (Some(effect.clone()), Some(parameter.clone())),
        RobotPart::Pulley(_) | RobotPart::TargetPlane => (None, None),
    }
}

/// Numbers along x, y and z; coordinates that are known exactly do not change. Numbers without axes are themselves.
fn spatial(axes: &[usize], values: Vec<f64>) -> Vec<f64> {
    if axes.is_empty() {
        return values;
    }
    let mut all = vec![0.0; 3];
    for (axis, value) in axes.iter().zip(values) {
        all[*axis] = value;
    }
    all
}

fn sds(covariance: &DMatrix<f64>) -> Vec<f64> {
    let variances = covariance.diagonal();
    variances.iter().map(|v| v.max(0.0).sqrt()).collect()
}

/// A part that drifts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DriftDocument {
    /// Names of its cables; empty for the target plane and effects of the whole robot.
    pub targets: Vec<String>,
    /// Effect whose parameter drifts; null for a pulley or target plane.
    pub effect: Option<String>,
    /// Posterior probability.
    pub probability: f64,
    /// Rate along x, y, z (m per day); of an effect that of its parameter (SI unit per day).
    pub rate_m_per_day: Vec<f64>,
    /// Standard deviations of the rate.
    pub sd: Vec<f64>,
}

/// Forecast of the next calibration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct NextCalibration {
    /// Date; null if it is not due within ten years.
    pub time: Option<Timestamp>,
    /// 95 % interval of the date, as rates of drifts and jumps are not known exactly; null for an end that is not within ten years.
    #[serde(default)]
    pub interval: [Option<Timestamp>; 2],
    /// Probability of being out of tolerance at that time.
    pub probability_out_of_tolerance: f64,
    /// Quantity that has the tolerance.
    #[serde(default)]
    pub tolerance_of: ToleranceOf,
    /// The tolerance (m).
    pub tolerance_m: f64,
    /// Smallest and largest x, y, z of the volume in which the tolerance of the position holds (m); null for the workspace, and
    /// for pulleys.
    #[serde(default)]
    pub volume_m: Option<[[f64; 3]; 2]>,
}

/// Quantity that has a tolerance until the next calibration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ToleranceOf {
    /// The displacement of each pulley from its value in the last session.
    #[default]
    Pulley,
    /// The root mean square position error of the platform over a volume.
    Position,
}

impl NextCalibration {
    /// The forecast after the last session of a record.
    fn of(found: &RobotHistory, last: Timestamp) -> Option<Self> {
        let forecast = found.forecast?;
        let date = |days: Option<f64>| Some(days_after(last, days?));
        let (tolerance_of, volume) = match found.tolerance {
            Tolerance::Pulley(_) => (ToleranceOf::Pulley, None),
            Tolerance::Position { volume, .. } => (ToleranceOf::Position, volume),
        };
        Some(Self {
            time: date(forecast.due_days),
            interval: forecast.interval_days.map(date),
            probability_out_of_tolerance: OUT_OF_TOLERANCE.max(forecast.at_once),
            tolerance_of,
            tolerance_m: found.tolerance.limit_m(),
            volume_m: volume.map(|volume| [volume.low_m, volume.high_m]),
        })
    }
}

impl VersionedFile for HistoryDocument {
    const FORMAT: &'static str = "tautline-history";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 64 << 20;
}

impl HistoryDocument {
    /// The document of a record.
    ///
    /// # Panics
    /// If the record has no sessions; then it has no history either.
    #[must_use]
    pub fn of(record: &RobotRecord, found: &RobotHistory) -> Self {
        let history = &found.history;
        let robot = record.robot();
        let changes = history.jumps.iter().map(|jump| ChangeDocument {
            changed: Changed::of(history, robot, jump),
            between: jump.between,
        });
        let dated = history.evident_drifts().filter(|_| found.is_dated);
        let drift = dated.map(|drift| DriftDocument {
            targets: targets_of(&history.parts[drift.part], robot),
            effect: effect_of(&history.parts[drift.part]).0,
            probability: drift.probability,
            rate_m_per_day: spatial(&history.axes[drift.part], drift.rate.as_slice().to_vec()),
            sd: spatial(&history.axes[drift.part], sds(&drift.covariance)),
        });
        let last = record.sessions.last().and_then(|session| session.time);
        let next_calibration = last.and_then(|last| NextCalibration::of(found, last));
        let sessions = record.sessions.iter().enumerate().map(|(index, session)| {
            let mut values = vec![[None; 3]; robot.cables.len()];
            let mut of_sd = values.clone();
            for (part, of) in history.parts.iter().enumerate() {
                if let RobotPart::Pulley(cable) = of {
                    let state = &history.states[part][index];
                    for (k, axis) in history.axes[part].iter().enumerate() {
                        values[*cable][*axis] = Some(state.value[k]);
                        of_sd[*cable][*axis] = Some(state.covariance[(k, k)].max(0.0).sqrt());
                    }
                }
            }
            let name = session.path.file_name();
            HistorySession {
                path: name.map_or_else(String::new, |name| name.to_string_lossy().into_owned()),
                time: session.time,
                entry_points_m: values,
                entry_points_sd_m: of_sd,
            }
        });
        Self {
            sessions: sessions.collect(),
            changes: changes.collect(),
            drift: drift.collect(),
            next_calibration,
        }
    }
}
