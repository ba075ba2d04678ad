//! The state of a robot, and the information of one session on it.

use nalgebra::{DMatrix, DVector};

use super::{DatedRun, HistoryError, RobotPart};
use crate::comparison::{
    ComparisonError, DeviationKey, Identified, RigidMotion, data_information, deviation_key,
};
use crate::estimation::{ParameterId, covariance_of};

/// Standard deviation of an effect that a session does not have, over its smallest typical size.
const ABSENT_SD: f64 = 0.1;

#[derive(Debug, Clone, PartialEq)]
struct StateNumber {
    /// Index of the part.
    part: usize,
    /// Axis of a pulley; 0 otherwise.
    axis: usize,
    /// Reference, to which the state is relative: the drawing, the stated plane, the neutral value.
    reference: f64,
    /// Standard deviation of the neutral value of an effect in a session that does not have it; infinite for other parts.
    absent_sd: f64,
    /// The deviation within its tolerance that the number stands for, with the first session that has the deviation.
    deviation: Option<(DeviationKey, usize)>,
}

/// Parts that may change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Followed {
    /// Pulleys, the target plane, and the effects in the models of the sessions.
    Model,
    /// Also the deviations of the parts within their tolerances.
    ModelAndDeviations,
}

/// Components of the state.
pub(super) struct State {
    pub parts: Vec<RobotPart>,
    /// Typical size of a change of each part (m, or the unit of the effect).
    pub typical: Vec<f64>,
    numbers: Vec<StateNumber>,
    /// Deviations of parts within their tolerances, common to all sessions, each with the first session that has it. They come
    /// after the numbers.
    deviations: Vec<(DeviationKey, usize)>,
    /// Derivative of the numbers by a common motion of all parts, in the directions that are free (numbers x directions).
    motion: DMatrix<f64>,
}

/// Typical change of a pulley that has moved (m).
pub(super) const TYPICAL_MOVE_M: f64 = 4e-3;

impl State {
    pub fn of(runs: &[DatedRun<'_>], followed: Followed) -> Result<Self, HistoryError> {
        let first = runs[0].run;
        let names = |run: &Identified<'_>| {
            let cables = run.problem.dataset.robot.cables.iter();
            cables.map(|c| c.name.clone()).collect::<Vec<String>>()
        };
        let cables = names(&first);
        for (index, run) in runs.iter().enumerate() {
            let own = names(&run.run);
            if own != cables {
                return Err(HistoryError::OtherRobot {
                    session: index + 1,
                    error: ComparisonError::OtherCables {
                        first: cables.join(", "),
                        second: own.join(", "),
                    },
                });
            }
        }
        let robot = &first.problem.dataset.robot;
        let mut state = Self {
            parts: Vec::new(),
            typical: Vec::new(),
            numbers: Vec::new(),
            deviations: Vec::new(),
            motion: DMatrix::zeros(0, 0),
        };
        let is_estimated = |id: &ParameterId| {
            let mut all = runs.iter().flat_map(|run| &run.run.solution.parameters);
            all.any(|parameter| parameter.id == *id)
        };
        let mut coordinates = Vec::new();
        let mut known = Vec::new();
        for (cable, of) in robot.cables.iter().enumerate() {
            state.push_part(RobotPart::Pulley(cable), TYPICAL_MOVE_M);
            for axis in 0..3 {
                let id = ParameterId::EntryPoint { cable, axis };
                if is_estimated(&id) {
                    state.push(axis, of.pulley.entry_point_m[axis], f64::INFINITY);
                    coordinates.push(id);
                } else {
                    known.push(id);
                }
            }
        }
        if is_estimated(&ParameterId::PlaneOffset) {
            state.push_part(RobotPart::TargetPlane, TYPICAL_MOVE_M);
            let offset = robot.laser.map_or(0.0, |l| l.target_plane.offset_m);
            state.push(0, offset, f64::INFINITY);
            coordinates.push(ParameterId::PlaneOffset);
        }
        for (session, run) in runs.iter().enumerate() {
            for parameter in &run.run.solution.parameters {
                if let Some(key) = deviation_key(&run.run, &parameter.id) {
                    match followed {
                        _ if state.first_with(&key).is_some() => {}
                        Followed::Model => state.deviations.push((key, session)),
                        Followed::ModelAndDeviations => {
                            state.follow_deviation(&run.run, &parameter.id, (key, session));
                        }
                    }
                    continue;
                }
                let Some((part, number)) = effect_of(&run.run, &parameter.id) else {
                    continue;
                };
                if !state.parts.contains(&part) {
                    let absent_sd = ABSENT_SD * number.smallest;
                    state.push_part(part, number.largest);
                    state.push(0, number.neutral, absent_sd);
                }
            }
        }
        let of_motion = RigidMotion::new(robot);
        let all: Vec<Identified<'_>> = runs.iter().map(|run| run.run).collect();
        let open = of_motion.open_directions(&all, &known);
        let by_motion = of_motion.of_coordinates(&coordinates) * open;
        state.motion = by_motion.resize_vertically(state.numbers.len(), 0.0);
        Ok(state)
    }

    /// The first session that has a deviation.
    fn first_with(&self, key: &DeviationKey) -> Option<usize> {
        let followed = self.numbers.iter().filter_map(|n| n.deviation.as_ref());
        let mut known = followed.chain(&self.deviations);
        known
            .find(|(known, _)| known == key)
            .map(|(_, first)| *first)
    }

    /// Adds a deviation to the parts that may change. Numbers of one effect on one cable, such as the two phases of a wave, are
    /// one part.
    fn follow_deviation(
        &mut self,
        run: &Identified<'_>,
        id: &ParameterId,
        deviation: (DeviationKey, usize),
    ) {
        let Some((part, typical)) = part_of_deviation(run, id) else {
            return;
        };
        let known = self.parts.iter().position(|known| *known == part);
        if known.is_none() {
            self.push_part(part, typical);
        }
        self.numbers.push(StateNumber {
            part: known.unwrap_or(self.parts.len() - 1),
            axis: 0,
            reference: 0.0,
            absent_sd: f64::INFINITY,
            deviation: Some(deviation),
        });
    }

    fn push_part(&mut self, part: RobotPart, typical: f64) {
        self.parts.push(part);
        self.typical.push(typical);
    }

    fn push(&mut self, axis: usize, reference: f64, absent_sd: f64) {
        self.numbers.push(StateNumber {
            part: self.parts.len() - 1,
            axis,
            reference,
            absent_sd,
            deviation: None,
        });
    }

    /// Number of numbers that may change.
    pub fn changeable(&self) -> usize {
        self.numbers.len()
    }

    /// Number of numbers, with the deviations.
    pub fn len(&self) -> usize {
        self.numbers.len() + self.deviations.len()
    }

    /// Indices of the numbers of a part.
    pub fn numbers_of(&self, part: usize) -> Vec<usize> {
        let numbers = self.numbers.iter().enumerate();
        let own = numbers.filter(|(_, number)| number.part == part);
        own.map(|(k, _)| k).collect()
    }

    /// Axes of the numbers of a part.
    pub fn axes_of(&self, part: usize) -> Vec<usize> {
        match self.parts[part] {
            RobotPart::Pulley(_) => {
                let numbers = self.numbers_of(part).into_iter();
                numbers.map(|k| self.numbers[k].axis).collect()
            }
            RobotPart::TargetPlane | RobotPart::Effect { .. } => Vec::new(),
        }
    }

    /// Reference value of a number, from which the state counts.
    pub fn reference(&self, number: usize) -> f64 {
        self.numbers[number].reference
    }

    /// Index in the state of a parameter of a run.
    fn index_of(&self, run: &Identified<'_>, id: &ParameterId) -> Option<usize> {
        if let Some(key) = deviation_key(run, id) {
            let is_it = |of: &(DeviationKey, usize)| of.0 == key;
            let of_number = |number: &StateNumber| number.deviation.as_ref().is_some_and(is_it);
            let mut constant = self.deviations.iter();
            let constant = || Some(self.numbers.len() + constant.position(is_it)?);
            return self.numbers.iter().position(of_number).or_else(constant);
        }
        let (part, axis) = match *id {
            ParameterId::EntryPoint { cable, axis } => (RobotPart::Pulley(cable), axis),
            ParameterId::PlaneOffset => (RobotPart::TargetPlane, 0),
            _ => (effect_of(run, id)?.0, 0),
        };
        let part = self.parts.iter().position(|known| *known == part)?;
        let mut numbers = self.numbers.iter();
        numbers.position(|number| number.part == part && number.axis == axis)
    }
}

/// Neutral value of a parameter of an effect, and its smallest and largest possible value.
struct EffectNumber {
    neutral: f64,
    smallest: f64,
    largest: f64,
}

fn effect_of(run: &Identified<'_>, id: &ParameterId) -> Option<(RobotPart, EffectNumber)> {
    let ParameterId::Effect { effect, parameter } = id else {
        return None;
    };
    let bound = &run.problem.free_effects[*effect];
    let description = bound.effect.parameters()[*parameter];
    let setting = bound.setting(&run.problem.dataset.robot);
    let [smallest, largest] = description.typical_sizes();
    let part = RobotPart::Effect {
        effect: setting.effect,
        targets: setting.targets,
        parameter: description.name.to_owned(),
        unit: description.unit,
    };
    let number = EffectNumber {
        neutral: description.neutral,
        smallest: if smallest > 0.0 {
            smallest
        } else {
            0.1 * largest
        },
        largest,
    };
    Some((part, number))
}

/// The part whose deviation a parameter describes, with the typical size of a fault of the part.
fn part_of_deviation(run: &Identified<'_>, id: &ParameterId) -> Option<(RobotPart, f64)> {
    let ParameterId::Deviation {
        deviation,
        parameter,
    } = id
    else {
        return None;
    };
    let bound = &run.problem.deviations[*deviation].bound;
    let description = bound.effect.parameters()[*parameter];
    let setting = bound.setting(&run.problem.dataset.robot);
    let part = RobotPart::Effect {
        effect: setting.effect,
        targets: setting.targets,
        parameter: description.name.to_owned(),
        unit: description.unit,
    };
    let [_, largest] = description.typical_sizes();
    Some((part, largest))
}

/// Information of one session on the state, relative to the references, and its moment.
pub(super) struct SessionInformation {
    pub information: DMatrix<f64>,
    pub moment: DVector<f64>,
}

/// The information of a session. Its unknowns that are not in the state are eliminated, as is a common motion of all parts
/// except in the first session. `None` if its data do not determine the eliminated unknowns.
pub(super) fn session_information(
    state: &State,
    run: &Identified<'_>,
    session: usize,
) -> Option<SessionInformation> {
    run.solution.covariance.as_ref()?;
    let parameters = &run.solution.parameters;
    let places: Vec<Option<usize>> = parameters
        .iter()
        .map(|p| state.index_of(run, &p.id))
        .collect();
    // The prior of a deviation counts once for all sessions.
    let has_prior = |k: usize| {
        let key = deviation_key(run, &parameters[k].id);
        key.is_none_or(|key| state.first_with(&key) == Some(session))
    };
    let (full, mut moment) = data_information(run, |k| !has_prior(k));
    let reference = |place: &Option<usize>| match place {
        Some(k) if *k < state.changeable() => state.reference(*k),
        _ => 0.0,
    };
    let references = DVector::from_iterator(places.len(), places.iter().map(reference));
    moment -= &full * references;
    let own: Vec<usize> = (0..places.len()).filter(|k| places[*k].is_none()).collect();
    let kept: Vec<usize> = (0..places.len()).filter(|k| places[*k].is_some()).collect();
    let cross = full.select_rows(&kept).select_columns(&own);
    let among = full.select_rows(&own).select_columns(&own);
    let (mut information, mut reduced) = (
        full.select_rows(&kept).select_columns(&kept),
        moment.select_rows(&kept),
    );
    if !own.is_empty() {
        let eliminated = &cross * covariance_of(&among)?;
        information -= &eliminated * cross.transpose();
        reduced -= eliminated * moment.select_rows(&own);
    }
    let count = state.len();
    let mut found = SessionInformation {
        information: DMatrix::zeros(count, count),
        moment: DVector::zeros(count),
    };
    let kept: Vec<usize> = kept.into_iter().filter_map(|k| places[k]).collect();
    for (i, row) in kept.iter().enumerate() {
        found.moment[*row] += reduced[i];
        for (k, column) in kept.iter().enumerate() {
            found.information[(*row, *column)] += information[(i, k)];
        }
    }
    if session > 0 {
        found.remove_motion(&state.motion.clone().resize_vertically(count, 0.0))?;
    }
    for (k, number) in state.numbers.iter().enumerate() {
        if number.absent_sd.is_finite() && !kept.contains(&k) {
            found.information[(k, k)] += number.absent_sd.powi(-2);
        }
    }
    Some(found)
}

impl SessionInformation {
    /// Eliminates motions, given by their derivatives of the state.
    fn remove_motion(&mut self, motion: &DMatrix<f64>) -> Option<()> {
        if motion.ncols() == 0 {
            return Some(());
        }
        let along = &self.information * motion;
        let inverse = covariance_of(&motion.tr_mul(&along))?;
        let weighted = &along * inverse;
        self.moment -= &weighted * motion.tr_mul(&self.moment);
        self.information -= weighted * along.transpose();
        Some(())
    }
}
