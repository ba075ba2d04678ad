//! Gain of information by single further poses, in addition to the measured ones.

use super::candidates::Candidate;
use super::goal::faults;
use super::information_model::InformationModel;
use super::{PlanError, PlanOptions, with_tension_margin};
use crate::effect::BoundEffect;
use crate::estimation::ExpectedInformation;
use crate::geometry::Pose;
use crate::measurement::Dataset;
use crate::robot::Robot;
use crate::simulation::PlannedRow;

/// Information of some poses, beside that of the measured ones, which is part of the prior information.
#[derive(Debug, Clone)]
pub struct Prospects {
    /// The poses that can be held.
    pub poses: Vec<Pose>,
    /// Information on the geometry.
    pub geometry: ExpectedInformation,
    /// Information on geometry and faults together.
    pub with_faults: ExpectedInformation,
    /// The faults, in the order of their parameters; each has its own effect, from this one on.
    pub faults: Vec<BoundEffect>,
    /// Index of the first fault among the effects of the parameters.
    pub first_fault: usize,
}

/// Robot and expected readings at those of some poses that can be held, together with the measured ones, as input of
/// [`shown_faults`](crate::diagnosis::shown_faults).
///
/// # Errors
/// If the robot cannot be simulated.
pub fn expected_dataset(
    robot: &Robot,
    poses: &[Pose],
    options: &PlanOptions<'_>,
) -> Result<Dataset, PlanError> {
    at_held(robot, poses, options, |model, held| {
        model.dataset(rows(model, held))
    })
}

/// Information that each of these poses would add; effects, method, existing measurements and limits are those of the options.
///
/// # Errors
/// If none of the poses can be held, there is nothing to identify, or the existing measurements cannot be used.
pub fn prospects(
    robot: &Robot,
    poses: &[Pose],
    options: &PlanOptions<'_>,
) -> Result<Prospects, PlanError> {
    at_held(robot, poses, options, |model, held| {
        let geometry = model.information(rows(model, held))?;
        if geometry.parameters.is_empty() {
            return Err(PlanError::NothingToEstimate);
        }
        Ok(Prospects {
            poses: held.iter().map(|held| held.pose).collect(),
            geometry,
            with_faults: model.information_with_faults(rows(model, held))?,
            faults: faults(&model.robot, model.acting()),
            first_fault: model.free_effects(),
        })
    })
}

/// Does `work` with the model and those of the poses that can be held.
fn at_held<T>(
    robot: &Robot,
    poses: &[Pose],
    options: &PlanOptions<'_>,
    work: impl Fn(&InformationModel<'_>, &[Candidate]) -> Result<T, PlanError>,
) -> Result<T, PlanError> {
    let options = PlanOptions {
        poses: poses.len(),
        ..options.clone()
    };
    with_tension_margin(robot, &options, |options, range| {
        let model = InformationModel::new(robot, options, range)?;
        let held = held(&model, poses)?;
        work(&model, &held)
    })
}

/// Expected readings at poses that can be held.
fn rows(model: &InformationModel<'_>, held: &[Candidate]) -> impl Iterator<Item = PlannedRow> {
    let labelled = model.labels().zip(held);
    labelled.map(|(label, held)| held.row(label))
}

/// The poses that can be held.
fn held(model: &InformationModel<'_>, poses: &[Pose]) -> Result<Vec<Candidate>, PlanError> {
    let held: Vec<Candidate> = (poses.iter())
        .filter_map(|pose| Candidate::chosen(model, *pose))
        .collect();
    match held.is_empty() {
        true => Err(PlanError::NotHeld { number: 1 }),
        false => Ok(held),
    }
}
