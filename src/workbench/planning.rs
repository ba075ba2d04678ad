//! Poses to measure, for the window and the commands.

use tautline_core::effect::BoundEffect;
use tautline_core::estimation::{Control, Method};
use tautline_core::planning::{Indices, Plan, PlanError, PlanOptions, PlanProgress, plan};
use tautline_core::simulation::TensionRange;
use tautline_session::{PlannedPose, Session};

use crate::controllers::bounds;

/// Seed of the poses among which is chosen.
pub const SEED: u64 = 1;

/// Part of the range of tensions at each end that planned poses leave free where they can.
const MARGIN: f64 = 0.1;
/// A plan and what to expect of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Outlook {
    /// The poses in their order, the home pose first where it is to be measured.
    pub poses: Vec<PlannedPose>,
    /// What all poses together tell.
    pub expected: Indices,
    /// What as many poses drawn at random would tell.
    pub random: Indices,
    /// Standard deviation of the entry points after so many of the poses, home not counted (m).
    pub after_m: Vec<Option<f64>>,
    /// Length of the way (m).
    pub way_m: f64,
}

/// Chooses so many poses with a seed, after those that are measured already.
///
/// # Errors
/// One sentence, if there is no such plan or the observer cancelled it.
pub fn outlook(
    session: &Session,
    (poses, seed): (usize, u64),
    observe: &mut dyn FnMut(&PlanProgress) -> Control,
) -> Result<Outlook, String> {
    let effects: Result<Vec<BoundEffect>, _> = (session.settings.identification.effects.iter())
        .map(|setting| BoundEffect::from_setting(setting, &session.robot))
        .collect();
    let effects = effects.map_err(|error| error.to_string())?;
    let dataset = session.dataset();
    let (workspace, tension) = bounds(&session.robot);
    let options = PlanOptions {
        workspace: Some(workspace),
        tension: Some(tension),
        effects: &effects,
        // Before more poses than the home pose are measured there is nothing to build on.
        existing: (dataset.measurements.len() > 1).then_some(&dataset.measurements),
        method: match session.settings.identification.method {
            tautline_session::Method::Simple => Method::Simple,
            _ => Method::Joint,
        },
        ..PlanOptions::new(poses, seed)
    };
    let cautious = PlanOptions {
        tension: Some(inner(tension)),
        ..options.clone()
    };
    let planned = match plan(&session.robot, &cautious, observe) {
        Err(PlanError::TooFewPoses { .. } | PlanError::Simulation(_)) => {
            plan(&session.robot, &options, observe)
        }
        planned => planned,
    };
    let planned = planned.map_err(|error| error.to_string())?;
    Ok(Outlook {
        poses: with_home(session, &planned),
        expected: planned.expected.indices,
        random: planned.random.indices,
        after_m: (0..=planned.poses.len())
            .map(|count| planned.after(count).indices.mean_m)
            .collect(),
        way_m: planned.order.travel_m,
    })
}

/// The range without its ends: the real robot differs from its description, and poses that only just can be held may
/// not be held by it.
fn inner(tension: TensionRange) -> TensionRange {
    let margin_n = MARGIN * (tension.upper_n - tension.lower_n);
    TensionRange {
        lower_n: (tension.lower_n + margin_n).min(tension.reference_n),
        upper_n: (tension.upper_n - margin_n).max(tension.reference_n),
        ..tension
    }
}

/// The poses with labels of their own, after the home pose where that is not measured yet.
fn with_home(session: &Session, planned: &Plan) -> Vec<PlannedPose> {
    let measured = &session.measurements.labels;
    let first = measured.iter().copied().fold(0, i64::max).saturating_add(1);
    let home = session.robot.home.filter(|_| !measured.contains(&0));
    let home = home.map(|home| PlannedPose::new(0, &home.pose()));
    let poses = planned.poses.iter().zip(first..);
    home.into_iter()
        .chain(poses.map(|(planned, label)| PlannedPose::new(label, &planned.pose)))
        .collect()
}
