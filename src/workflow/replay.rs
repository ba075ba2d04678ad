//! The simulator of a user compared with the machine: the error of its readings, the part that the identified model explains,
//! and the part that is noise.
//!
//! A simulator is driven to commanded poses, or to the poses that it computes; the platform of the machine is elsewhere, by errors that
//! the identification finds. Readings are compared at the identified pose `q` of the machine. With the prediction `f_M(q)` of the
//! identified model for a reading `y`, the error of that model is the residual of the fit of the pose,
//!
//! `r = f_M(q) - y`.
//!
//! The reading `s` that the simulator predicts at its own pose `p` is transferred to `q` by a model `X`, the drawing or the
//! identified one, whichever is nearer to the simulator; only the difference of `X` from the simulator between `p` and `q` is
//! neglected:
//!
//! `e = r + f_X(q) - f_M(q) - (f_X(p) - s)`.
//!
//! The part of a cause is the root of the difference in squares between the error of the identified model without the cause and
//! its error with it.
//! By noise alone, `r` has the variance `sd^2` times the redundancy of the reading (Baarda 1968).

use std::collections::HashMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tautline_core::diagnosis::Quantity;
use tautline_core::estimation::{
    Control, EstimationError, Globals, Method, Observation, ObservationKind, Poses, Problem,
    RowResidual, residuals_at,
};
use tautline_core::geometry::Pose;
use tautline_core::measurement::{Dataset, Measurements};
use tautline_core::robot::Robot;
use tautline_session::VersionedFile;

use crate::identification::{
    FitVerdict, Identification, IdentificationRequest, group_of, identify, unit_of_reading,
    without_each_effect,
};
use crate::plot::figure::{Axis, Band, Figure, Ink, Marker, Point, Series};
use crate::wording::sentence;
use crate::wording::units::{display_unit, quantity, significant};

/// Smallest part of an error that is attributed to one cause, relative to the error of the drawing.
const LEAST_PART: f64 = 0.05;

/// Errors of the comparison of a simulator with a machine.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// The model is of another robot, or its effects do not fit.
    #[error("{0}")]
    Model(String),
    /// A problem cannot be set up.
    #[error(transparent)]
    Estimation(#[from] EstimationError),
    /// No pose of the simulator was measured.
    #[error(
        "found no pose that was measured, expected the labels {first} to {last} in the column pose"
    )]
    NoPose {
        /// First measured label.
        first: i64,
        /// Last measured label.
        last: i64,
    },
}

/// A simulator beside the machine. Root mean squares are in SI units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ReplayDocument {
    /// Name of the robot.
    pub robot: String,
    /// Number of poses that were simulated and measured.
    pub poses: usize,
    /// The model that is nearer to the simulator; null if it predicts tensions only.
    pub nearest: Option<NearestModel>,
    /// Distance of the platform between the simulator and the identified pose (m), if the simulator or the dataset states a pose.
    pub position_rms_m: Option<f64>,
    /// Probability that noise alone leaves residuals as large as those of the identified model.
    pub p_value: Option<f64>,
    /// The kinds of readings that were measured.
    pub readings: Vec<ReplayedReading>,
}

/// A model of the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum NearestModel {
    /// The robot as `robot.json` describes it.
    Drawing,
    /// The identified model.
    Identified,
}

/// Errors in one kind of reading, root mean square (SI units).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ReplayedReading {
    /// Kind of reading.
    pub reading: String,
    /// SI unit.
    pub unit: String,
    /// Number of readings.
    pub count: usize,
    /// Error of the simulator; null if it does not predict this reading.
    pub simulator_rms: Option<f64>,
    /// Error of the robot as `robot.json` describes it.
    pub drawing_rms: f64,
    /// Error of the identified model.
    pub identified_rms: f64,
    /// Error that noise alone leaves to a right model whose poses are fitted; null where the readings do not determine it.
    pub noise_rms: Option<f64>,
    /// Effects that the identified model has and the drawing lacks, each with its part of the error, largest first.
    pub causes: Vec<ExplainedPart>,
}

/// The part of an error that one cause explains.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ExplainedPart {
    /// The cause.
    pub cause: String,
    /// Its part, root mean square (SI unit of the reading).
    pub rms: f64,
}

impl VersionedFile for ReplayDocument {
    const FORMAT: &'static str = "tautline-replay";
    const VERSION: u32 = 1;
    const MAX_BYTES: u64 = 16 << 20;
}

/// One measured reading with the errors of all models (SI units).
#[derive(Debug, Clone)]
struct ReplayedObservation {
    observation: Observation,
    pose: i64,
    simulator: f64,
    drawing: f64,
    without: Vec<f64>,
}

/// A simulator beside the machine, reading by reading.
#[derive(Debug, Clone)]
pub struct Replay {
    fit: Identification,
    observations: Vec<ReplayedObservation>,
    causes: Vec<String>,
    nearest: Option<NearestModel>,
    position_rms_m: Option<f64>,
    poses: usize,
}

/// Residuals of a model at given poses, by row of the measurements.
type ResidualsByRow = HashMap<usize, RowResidual>;

impl Replay {
    /// Compares readings that a simulator predicts with those of a dataset. `model` is the identified one; the robot of the dataset
    /// is the drawing. Poses are matched by their labels.
    ///
    /// # Errors
    /// If the model does not fit the dataset, or no pose of the simulator was measured.
    pub fn new(
        dataset: &Dataset,
        model: &Robot,
        simulated: &Measurements,
    ) -> Result<Self, ReplayError> {
        let of_poses = |robot: &Robot| {
            let request =
                IdentificationRequest::of_poses(dataset.clone(), robot.clone(), Poses::Estimated);
            request.map_err(ReplayError::Model)
        };
        let fit = identify(&of_poses(model)?, &mut |_| Control::Continue)?;
        let labels = &fit.dataset.measurements.labels;
        let home = fit.problem()?.home_row();
        let measured = fit.solution.poses.iter().copied();
        let measured: Vec<(usize, Pose)> = measured.filter(|(row, _)| Some(*row) != home).collect();
        let pairs = pairs(&measured, labels, simulated);
        if pairs.is_empty() {
            let [first, last] = [labels.iter().min(), labels.iter().max()];
            let [first, last] = [first, last].map(|label| label.copied().unwrap_or_default());
            return Err(ReplayError::NoPose { first, last });
        }
        let at_fit = |robot: &Robot| -> Result<ResidualsByRow, ReplayError> {
            let request = of_poses(robot)?;
            let problem = request.options.problem(&request.dataset, fit.method)?;
            let problem = problem.with_contexts_of(&fit.solution);
            Ok(residuals(&problem, &measured))
        };
        let of_model = at_fit(model)?;
        let of_drawing = at_fit(&dataset.robot)?;
        // Without any other statement, the simulator was driven to the identified poses.
        let stated = pairs
            .iter()
            .map(|pair| pair.stated(simulated, &fit.dataset.measurements));
        let stated: Vec<Option<Pose>> = stated.collect();
        let own_poses = pairs.iter().zip(&stated);
        let own_poses: Vec<(usize, Pose)> = own_poses
            .map(|(pair, stated)| (pair.own, stated.unwrap_or(pair.pose)))
            .collect();
        let of_simulator = |robot: &Robot| -> Result<ResidualsByRow, ReplayError> {
            let own = Dataset {
                robot: robot.clone(),
                measurements: simulated.clone(),
            };
            let problem = Problem::new(&own)?.with_method(Method::Simple);
            Ok(residuals(&problem, &own_poses))
        };
        let [drawn, identified] = [of_simulator(&dataset.robot)?, of_simulator(model)?];
        let measured_readings = fit.analysis.observations.iter();
        let measured_readings: Vec<&Observation> = measured_readings
            .filter(|one| group_of(one.kind).is_some() && of_model.contains_key(&one.row))
            .collect();
        let row_of: HashMap<usize, usize> = pairs.iter().map(|pair| (pair.row, pair.own)).collect();
        let simulated_at = |by_row: &ResidualsByRow, one: &Observation| {
            let is_tension = matches!(one.kind, ObservationKind::Tension(_));
            if is_tension && simulated.force_n.is_empty() {
                return f64::NAN;
            }
            let residual = row_of.get(&one.row).and_then(|own| by_row.get(own));
            residual.map_or(f64::NAN, |residual| of_kind(residual, one.kind))
        };
        let distance = |by_row: &ResidualsByRow| {
            let readings = measured_readings.iter();
            let readings = readings.filter(|one| !matches!(one.kind, ObservationKind::Tension(_)));
            root_mean_square(readings.map(|one| simulated_at(by_row, one) / one.sd))
        };
        let distances = [&drawn, &identified].map(|by_row| distance(by_row).map(|(rms, _)| rms));
        let is_drawn = distances[0] <= distances[1];
        let nearest = distances[0].map(|_| match is_drawn {
            true => NearestModel::Drawing,
            false => NearestModel::Identified,
        });
        let (of_nearest, carried) = match is_drawn {
            true => (&of_drawing, &drawn),
            false => (&of_model, &identified),
        };
        let mut simpler = without_each_effect(model);
        simpler.extend(without_places(model, &dataset.robot));
        let without = simpler.iter().map(|(_, robot)| at_fit(robot));
        let without = without.collect::<Result<Vec<_>, _>>()?;
        let replayed = |one: &&Observation| {
            let row = one.row;
            let of = |by_row: &ResidualsByRow| of_kind(&by_row[&row], one.kind);
            let error_of = |by_row: &ResidualsByRow| one.residual() + of(by_row) - of(&of_model);
            let own = simulated_at(carried, one);
            ReplayedObservation {
                observation: **one,
                pose: labels[row],
                // Tensions do not follow from the pose.
                simulator: match one.kind {
                    ObservationKind::Tension(_) => of(of_nearest) - own,
                    _ => error_of(of_nearest) - own,
                },
                drawing: error_of(&of_drawing),
                without: without.iter().map(error_of).collect(),
            }
        };
        let observations = measured_readings.iter().map(replayed).collect();
        let distances = pairs.iter().zip(&stated).filter_map(|(pair, stated)| {
            let away = stated.as_ref()?.position - pair.pose.position;
            Some(away.norm())
        });
        Ok(Self {
            position_rms_m: root_mean_square(distances).map(|(rms, _)| rms),
            observations,
            causes: simpler.into_iter().map(|(cause, _)| cause).collect(),
            nearest,
            poses: pairs.len(),
            fit,
        })
    }

    /// The comparison as a document.
    #[must_use]
    pub fn document(&self) -> ReplayDocument {
        let kinds = Quantity::ALL.into_iter();
        ReplayDocument {
            robot: self.fit.dataset.robot.name.clone(),
            poses: self.poses,
            nearest: self.nearest,
            position_rms_m: self.position_rms_m,
            p_value: self.fit.solution.p_value(),
            readings: kinds.filter_map(|kind| self.reading(kind)).collect(),
        }
    }

    fn of_quantity(&self, quantity: Quantity) -> impl Iterator<Item = &ReplayedObservation> {
        let is_of = move |one: &&ReplayedObservation| {
            group_of(one.observation.kind).is_some_and(|(kind, _)| kind == quantity)
        };
        self.observations.iter().filter(is_of)
    }

    fn reading(&self, quantity: Quantity) -> Option<ReplayedReading> {
        let rms = |error: &dyn Fn(&ReplayedObservation) -> f64| {
            root_mean_square(self.of_quantity(quantity).map(error))
        };
        let (identified_rms, count) = rms(&|one| one.observation.residual())?;
        let (drawing_rms, _) = rms(&|one| one.drawing)?;
        let part = |(index, cause): (usize, &String)| {
            let (without, _) = rms(&|one| one.without[index])?;
            let rms = (without.powi(2) - identified_rms.powi(2)).max(0.0).sqrt();
            let cause = cause.clone();
            (rms > LEAST_PART * drawing_rms).then_some(ExplainedPart { cause, rms })
        };
        let mut causes: Vec<_> = self.causes.iter().enumerate().filter_map(part).collect();
        causes.sort_by(|a, b| b.rms.total_cmp(&a.rms));
        let noise = |one: &ReplayedObservation| {
            let redundancy = one.observation.redundancy.unwrap_or(f64::NAN);
            one.observation.sd * redundancy.max(0.0).sqrt()
        };
        Some(ReplayedReading {
            reading: quantity.name().to_owned(),
            unit: unit_of_reading(quantity).to_owned(),
            count,
            simulator_rms: rms(&|one| one.simulator).map(|(rms, _)| rms),
            drawing_rms,
            identified_rms,
            noise_rms: rms(&noise).map(|(rms, _)| rms),
            causes,
        })
    }

    /// The kind of reading in which the simulator errs most, in standard deviations of the reading.
    #[must_use]
    pub fn worst(&self) -> Quantity {
        let error = |quantity: &Quantity| {
            let errors = self.of_quantity(*quantity);
            let errors = errors.map(|one| one.simulator / one.observation.sd);
            root_mean_square(errors).map_or(0.0, |(rms, _)| rms)
        };
        let kinds = Quantity::ALL.into_iter();
        let worst = kinds.max_by(|a, b| error(a).total_cmp(&error(b)));
        worst.unwrap_or(Quantity::Length)
    }

    /// The errors of simulator and identified model over the poses, with the range of two standard deviations of a reading.
    #[must_use]
    pub fn figure(&self, quantity: Quantity) -> Figure {
        let (factor, unit) = display_unit(unit_of_reading(quantity));
        let series = |name: &str, ink, marker, error: &dyn Fn(&ReplayedObservation) -> f64| {
            let points = self.of_quantity(quantity).map(|one| Point {
                pose: Some(one.pose),
                ..Point::new(one.pose as f64, factor * error(one))
            });
            Series::new(name, ink, marker, points.collect())
        };
        let sd = root_mean_square(self.of_quantity(quantity).map(|one| one.observation.sd));
        let limit = 2.0 * factor * sd.map_or(0.0, |(sd, _)| sd);
        Figure {
            x: Axis::whole("Pose"),
            y: Axis::new(format!("Error of the {}", quantity.name()), unit),
            bands: vec![Band::new(
                "two standard deviations of noise",
                [-limit, limit],
            )],
            series: vec![
                series("simulator", Ink::Warning, Marker::Circle, &|one| {
                    one.simulator
                })
                .as_rings(),
                series("identified model", Ink::Accent, Marker::Square, &|one| {
                    one.observation.residual()
                }),
            ],
            has_zero_line: true,
            ..Figure::default()
        }
    }
}

impl ReplayedReading {
    /// Headings of [`Self::cells`].
    pub const HEADINGS: [&str; 7] = [
        "Reading",
        "Number",
        "Simulator",
        "robot.json",
        "Identified model",
        "Noise",
        "Unit",
    ];

    /// The errors in their display unit, as a row of a table.
    #[must_use]
    pub fn cells(&self) -> [String; 7] {
        let (factor, unit) = display_unit(&self.unit);
        let shown = |rms: f64| significant(factor * rms, 3);
        let known = |rms: Option<f64>| rms.map_or_else(|| "\u{2013}".to_owned(), shown);
        [
            sentence(&self.reading),
            self.count.to_string(),
            known(self.simulator_rms),
            shown(self.drawing_rms),
            shown(self.identified_rms),
            known(self.noise_rms),
            unit.to_owned(),
        ]
    }

    /// Explanation of the error of the drawing, in a sentence.
    #[must_use]
    pub fn explained(&self) -> String {
        let parts = self.causes.iter();
        let parts = parts.map(|one| format!("{} ({})", one.cause, quantity(one.rms, &self.unit)));
        let parts = parts.collect::<Vec<_>>().join(", ");
        format!("{} explained by: {parts}.", sentence(&self.reading))
    }
}

impl ReplayDocument {
    /// Results of the comparison, in sentences.
    #[must_use]
    pub fn sentences(&self) -> Vec<String> {
        let nearest = self.nearest.map(|nearest| {
            let [near, far] = match nearest {
                NearestModel::Drawing => ["robot.json", "the identified model"],
                NearestModel::Identified => ["the identified model", "robot.json"],
            };
            format!("The simulator is nearer to {near} than to {far}.")
        });
        let apart = self.position_rms_m.map(|rms_m| {
            let distance = quantity(rms_m, "m");
            format!(
                "It has the platform {distance} from where the readings put it (root mean square)."
            )
        });
        let verdict = FitVerdict::of(self.p_value);
        let doubt = (!verdict.holds()).then(|| {
            "The identified model does NOT explain the readings: a diagnosis looks for the cause.".to_owned()
        });
        [nearest, apart, doubt].into_iter().flatten().collect()
    }
}

/// A pose that was measured and simulated.
struct PosePair {
    /// Row of the measurements, and of those of the simulator.
    row: usize,
    own: usize,
    /// Identified pose.
    pose: Pose,
}

impl PosePair {
    /// The pose of the simulator, or else the commanded one.
    fn stated(&self, simulated: &Measurements, measured: &Measurements) -> Option<Pose> {
        let at = |data: &Measurements, row: usize| data.commanded.get(row).copied().flatten();
        at(simulated, self.own).or_else(|| at(measured, self.row))
    }
}

fn pairs(measured: &[(usize, Pose)], labels: &[i64], simulated: &Measurements) -> Vec<PosePair> {
    let rows = simulated.labels.iter().enumerate();
    let rows: HashMap<i64, usize> = rows.map(|(row, label)| (*label, row)).collect();
    let pair = |(row, pose): &(usize, Pose)| {
        let (row, pose, own) = (*row, *pose, *rows.get(&labels[*row])?);
        Some(PosePair { row, own, pose })
    };
    measured.iter().filter_map(pair).collect()
}

fn residuals(problem: &Problem<'_>, poses: &[(usize, Pose)]) -> ResidualsByRow {
    let (rows, poses): (Vec<usize>, Vec<Pose>) = poses.iter().copied().unzip();
    let found = residuals_at(problem, &Globals::nominal(problem), &rows, &poses);
    rows.into_iter().zip(found).collect()
}

/// Prediction minus reading; of a tension minus the reading, as a pose does not determine it.
fn of_kind(residual: &RowResidual, kind: ObservationKind) -> f64 {
    let of_cable = |values: &[f64], cable: usize| values.get(cable).copied().unwrap_or(f64::NAN);
    match kind {
        ObservationKind::Length(cable) => of_cable(&residual.length_m, cable),
        ObservationKind::Tension(cable) => -of_cable(&residual.tension_n, cable),
        ObservationKind::Swivel(cable) => of_cable(&residual.swivel_rad, cable),
        ObservationKind::Laser => residual.laser_m,
        ObservationKind::TrackerPosition(axis) => residual.tracked_m[axis],
        ObservationKind::TrackerOrientation(axis) => residual.tracked_rotation_rad[axis],
        ObservationKind::Inclination(axis) => residual.inclination_rad[axis],
        ObservationKind::Equilibrium(_) | ObservationKind::Distance(_) => f64::NAN,
    }
}

/// The model with the pulleys, or with the home pose and the target plane, of the drawing.
fn without_places(model: &Robot, drawing: &Robot) -> Vec<(String, Robot)> {
    let (mut drawn, mut at_drawn_home) = (model.clone(), model.clone());
    for (cable, own) in drawn.cables.iter_mut().zip(&drawing.cables) {
        cable.pulley.entry_point_m = own.pulley.entry_point_m;
    }
    (at_drawn_home.home, at_drawn_home.laser) = (drawing.home, drawing.laser);
    let all = [
        ("places of the pulleys", drawn),
        ("home pose and target plane", at_drawn_home),
    ];
    let all = all.into_iter().filter(|(_, robot)| robot != model);
    all.map(|(name, robot)| (name.to_owned(), robot)).collect()
}

/// Root mean square of the finite numbers, and their count; `None` if there are none.
fn root_mean_square(values: impl Iterator<Item = f64>) -> Option<(f64, usize)> {
    let (square_sum, count) = values
        .filter(|value| value.is_finite())
        .fold((0.0, 0_usize), |(sum, count), value| {
            (sum + value * value, count + 1)
        });
    (count > 0).then(|| ((square_sum / count as f64).sqrt(), count))
}

#[cfg(test)]
mod tests {
    use tautline_core::kinematics::inverse_kinematics;
    use tautline_core::measurement::Grid;
    use tautline_core::robot::presets;
    use tautline_core::simulation::{Simulated, SimulationOptions, simulate};

    use super::*;

    fn run() -> Simulated {
        let preset = presets::find("mini").expect("a preset");
        let options = SimulationOptions {
            workspace: Some(preset.workspace),
            tension: Some(preset.tension),
            ..SimulationOptions::new(30, 4)
        };
        simulate(&preset.robot, &options).expect("measurements")
    }

    fn identified(dataset: &Dataset) -> Robot {
        let request = IdentificationRequest::new(dataset.clone(), Method::Joint, &[]);
        let request = request.expect("a request");
        let fit = identify(&request, &mut |_| Control::Continue);
        fit.expect("identified").model
    }

    /// Geometric lengths of a robot that is driven to the commanded poses, without tensions.
    fn lengths(robot: &Robot, dataset: &Dataset) -> Measurements {
        let data = &dataset.measurements;
        let mut length_m = Grid::new(robot.cable_count());
        for pose in data.commanded.iter().flatten() {
            let cables = inverse_kinematics(robot, pose).expect("a pose in reach");
            let row: Vec<f64> = cables.iter().map(|cable| cable.length_m).collect();
            length_m.push_row(&row);
        }
        Measurements {
            labels: data.labels.clone(),
            commanded: data.commanded.clone(),
            length_m,
            ..Measurements::default()
        }
    }

    #[test]
    fn a_simulator_of_the_drawing_errs_as_the_drawing_and_a_corrected_one_as_noise() {
        let run = run();
        let model = identified(&run.dataset);
        let nominal = lengths(&run.dataset.robot, &run.dataset);
        let replay = Replay::new(&run.dataset, &model, &nominal).expect("comparable");
        let document = replay.document();
        assert_eq!(document.nearest, Some(NearestModel::Drawing));
        let [length, tension] = [0, 1].map(|index| &document.readings[index]);
        let simulator = length.simulator_rms.expect("simulated");
        assert!((simulator / length.drawing_rms - 1.0).abs() < 1e-6);
        assert!(simulator > 20.0 * length.identified_rms);
        assert_eq!(length.causes[0].cause, "places of the pulleys");
        assert_eq!(
            (tension.reading.as_str(), tension.simulator_rms),
            ("tension", None)
        );
        assert_eq!(replay.worst(), Quantity::Length);
        assert!(document.position_rms_m.is_some_and(|rms_m| rms_m > 1e-3));

        let corrected = lengths(&model, &run.dataset);
        let replay = Replay::new(&run.dataset, &model, &corrected).expect("comparable");
        let document = replay.document();
        assert_eq!(document.nearest, Some(NearestModel::Identified));
        let length = &document.readings[0];
        let simulator = length.simulator_rms.expect("simulated");
        // Residuals of the fit, whose noise has 480 readings: beyond a quarter in one of 10,000 runs.
        assert!((simulator / length.identified_rms - 1.0).abs() < 1e-6);
        assert!((simulator / length.noise_rms.expect("redundant") - 1.0).abs() < 0.25);
        let drawn = replay.figure(Quantity::Length);
        assert!(
            drawn
                .series
                .iter()
                .all(|series| series.points().len() == length.count)
        );
    }

    /// The truth at its own poses differs from the machine by noise and by the uncertainty of the identified places.
    #[test]
    fn the_true_machine_is_a_simulator_with_a_small_error() {
        let run = run();
        let mut simulated = run.dataset.measurements.clone();
        simulated.commanded = simulated.truth.poses.iter().copied().map(Some).collect();
        let model = identified(&run.dataset);
        let replay = Replay::new(&run.dataset, &model, &simulated).expect("comparable");
        let length = &replay.document().readings[0];
        let simulator = length.simulator_rms.expect("simulated");
        assert!(simulator < 0.15 * length.drawing_rms, "{length:?}");
    }

    #[test]
    fn poses_that_were_not_measured_are_refused() {
        let run = run();
        let mut simulated = lengths(&run.dataset.robot, &run.dataset);
        simulated.labels.iter_mut().for_each(|label| *label += 100);
        let failure = Replay::new(&run.dataset, &run.dataset.robot, &simulated);
        assert_eq!(
            failure.expect_err("other poses").to_string(),
            "found no pose that was measured, expected the labels 0 to 30 in the column pose"
        );
    }
}
