//! The plan of a measuring run.

use crate::output::note;
use anyhow::Result;
use tautline_core::estimation::Control;
use tautline_session::{PlannedPose, Session};

use super::Arguments;
use crate::{BadInput, input, standard_input};
use tautline_workflow::controllers::ControllerChoice;
use tautline_workflow::planning::choose_poses;
use tautline_workflow::sequential::plan_home;
use tautline_workflow::wording::count;

/// Poses closer than this are identical (m and rad).
const SAME: f64 = 1e-9;

/// Ensures that the session has a plan: that of the file, else its own, else that of the recording, else a new one.
pub fn complete(
    session: &mut Session,
    arguments: &Arguments,
    choice: &ControllerChoice,
) -> Result<()> {
    if let Some(path) = &arguments.plan {
        let read = standard_input::plan(path, &session.robot)?;
        for notice in &read.notices {
            note!("{notice}");
        }
        return take(session, read.value, &path.display().to_string());
    }
    if !arguments.until.is_empty() {
        // Poses are decided on one by one, after home.
        plan_home(session);
        return Ok(());
    }
    if !session.plan.is_empty() {
        return Ok(());
    }
    if let ControllerChoice::Replay(folder) = choice {
        let m = input::dataset(folder)?.measurements;
        let rows = m.labels.iter().zip(&m.commanded);
        let poses = rows.filter_map(|(label, pose)| Some(PlannedPose::new(*label, pose.as_ref()?)));
        return take(session, poses.collect(), &folder.display().to_string());
    }
    note!("Planning {}.", count(arguments.poses, "pose"));
    let chosen = choose_poses(session, (arguments.poses, arguments.seed), &mut |_| {
        Control::Continue
    });
    session.plan = chosen.map_err(|error| {
        BadInput::new(format!(
            "no {} can be planned: {error}",
            count(arguments.poses, "pose")
        ))
    })?;
    Ok(())
}

/// Adopts the poses of a table after the home pose; measured poses stay.
fn take(session: &mut Session, poses: Vec<PlannedPose>, place: &str) -> Result<()> {
    let labels = &session.measurements.labels;
    for pose in &poses {
        let row = labels.iter().position(|label| *label == pose.label);
        let commanded = row.and_then(|row| session.measurements.commanded.get(row).copied()?);
        let moved = commanded.is_some_and(|c| c.difference(&pose.pose()).amax() > SAME);
        if moved && pose.label != 0 {
            return Err(BadInput::new(format!(
                "{place}: pose {} has already been measured elsewhere",
                pose.label
            )));
        }
    }
    let is_new = |label: i64| poses.iter().all(|pose| pose.label != label);
    let kept = session.plan.iter().copied();
    let mut plan: Vec<PlannedPose> = kept
        .filter(|pose| labels.contains(&pose.label) && is_new(pose.label))
        .collect();
    if let Some(home) = session
        .robot
        .home
        .filter(|_| is_new(0) && !labels.contains(&0))
    {
        plan.push(PlannedPose::new(0, &home.pose()));
    }
    // Lengths are relative to home, so a run starts there.
    let (home, others): (Vec<PlannedPose>, Vec<PlannedPose>) =
        poses.into_iter().partition(|pose| pose.label == 0);
    plan.extend(home.into_iter().chain(others));
    session.plan = plan;
    Ok(())
}
