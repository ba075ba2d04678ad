//! The question of the sliders as a simulated study, with other lasers and numbers of poses for comparison.

use std::fs;
use std::path::{Path, PathBuf};

use tautline_core::estimation::Control;
use tautline_core::robot::Robot;
use tautline_core::threads::available;
use tautline_session::{Timestamp, parse_versioned_toml, read_robot, write_robot, write_text};
use tautline_workflow::report::ReportError;

use crate::plan::StudyPlan;
use crate::report::write_report;
use crate::run::run;
use crate::which_sensor::Question;
use crate::{StudyError, StudyFile, create_folder, merge};

/// Files of the study in its folder.
const ROBOT: &str = "robot.json";
const STUDY: &str = "study.toml";
const REPORT: &str = "report.html";

/// The study as a file that `tautline study plan` also reads.
fn study_file(robot: &Robot, question: &Question) -> String {
    let lasers = match (robot.laser, question.laser_sd_m) {
        (None, _) => "\"none\"",
        (_, None) => "\"none\", \"class-0.1mm\", \"class-0.3mm\", \"class-1mm\", \"class-3mm\"",
        _ => "\"own\", \"class-0.1mm\", \"class-0.3mm\", \"class-1mm\", \"class-3mm\", \"none\"",
    };
    let mut poses = vec![12, question.poses, 100];
    poses.sort_unstable();
    poses.dedup();
    format!(
        "format = \"tautline-study\"\nversion = 1\nname = \"Which sensor for {}\"\n\n[design]\nrobots = [\"{ROBOT}\"]\n\
         lasers = [{lasers}]\nposes = {poses:?}\nchoice = [\"random\"]\nhome_sd_m = [{:e}]\ninclinometer_sd_rad = [{:e}]\n\n\
         [simulation]\ncalibrations = 400\nshare = 1.0\nchunk = 400\n",
        robot.name.replace(['"', '\\'], "'"),
        question.home_sd_m,
        question.inclinometer_sd_rad.unwrap_or(0.0)
    )
}

/// Checks the prediction for a question by simulation, in an empty folder or that of the same question; the observer receives
/// the numbers of finished and of all calibrations. Returns the path of the report.
///
/// # Errors
/// If the folder holds something else, a cell cannot be predicted, a file cannot be written, or it was cancelled, which
/// keeps finished chunks.
pub fn simulate(
    (robot, question): (&Robot, &Question),
    folder: &Path,
    now: Timestamp,
    observer: &dyn Fn(u64, u64) -> Control,
) -> Result<PathBuf, StudyError> {
    let mut robot = robot.clone();
    if let (Some(laser), Some(sd_m)) = (&mut robot.laser, question.laser_sd_m) {
        laser.sd_m = sd_m;
    }
    let text = study_file(&robot, question);
    let is_same = || {
        let known = fs::read_to_string(folder.join(STUDY)).unwrap_or_default();
        known == text && read_robot(&folder.join(ROBOT)).is_ok_and(|known| known.value == robot)
    };
    let is_empty = fs::read_dir(folder).map_or(true, |mut files| files.next().is_none());
    if !is_empty && !is_same() {
        return Err(StudyError::Input(format!(
            "{}: holds other files, expected an empty folder or that of the same question",
            folder.display()
        )));
    }
    create_folder(folder)?;
    write_robot(&folder.join(ROBOT), &robot)?;
    write_text(&folder.join(STUDY), &text)?;
    let study = parse_versioned_toml::<StudyFile>(text.as_bytes(), STUDY)?.value;
    let plan = StudyPlan::new(study, folder, &mut |_, _| observer(0, 0))?;
    plan.write(folder)?;
    let parts = plan.parts(None).map_err(StudyError::Input)?;
    let all = plan.calibrations();
    run(&plan, folder, &parts, available(), &mut |done| {
        observer(done, all)
    })?;
    let result = merge(&plan, folder)?;
    let path = folder.join(REPORT);
    write_report(&path, &plan, &result, now).map_err(|error| match error {
        ReportError::Write(error) => error.into(),
        error => StudyError::Input(error.to_string()),
    })?;
    Ok(path)
}

#[cfg(test)]
mod tests {
    use tautline_core::robot::presets;

    use super::*;
    use crate::which_sensor::Advisor;

    fn question(name: &str) -> (Robot, Question) {
        let robot = presets::find(name).unwrap().robot;
        let question = Advisor::new(&robot).unwrap().question();
        (robot, question)
    }

    #[test]
    fn every_question_is_a_study_file() {
        for name in ["mini", "hall"] {
            let (mut robot, mut question) = question(name);
            robot.name = "with \"quotes\"".to_owned();
            for laser in [question.laser_sd_m, None] {
                question.laser_sd_m = laser;
                let text = study_file(&robot, &question);
                let read = parse_versioned_toml::<StudyFile>(text.as_bytes(), STUDY).unwrap();
                assert!(read.notices.is_empty(), "{text}");
            }
            robot.laser = None;
            let text = study_file(&robot, &question);
            assert!(text.contains("lasers = [\"none\"]"), "{text}");
        }
    }

    #[test]
    fn a_cancelled_study_goes_on_and_another_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path().join("study");
        let (robot, mut question) = question("planar");
        question.poses = 12;
        let now = Timestamp::from_unix_seconds(0);
        let cancelled = simulate((&robot, &question), &folder, now, &|done, _| {
            if done > 500 {
                Control::Cancel
            } else {
                Control::Continue
            }
        });
        assert!(matches!(cancelled, Err(StudyError::Cancelled)));
        let report = simulate((&robot, &question), &folder, now, &|_, _| Control::Continue);
        let report = fs::read_to_string(report.unwrap()).unwrap();
        assert!(report.contains("Which sensor for"));
        // Another number of poses changes the study, another laser only the robot: both are other questions, and what is
        // there stays.
        let known = fs::read(folder.join(ROBOT)).unwrap();
        let more_poses = Question {
            poses: 13,
            ..question
        };
        question.laser_sd_m = question.laser_sd_m.map(|sd_m| 2.0 * sd_m);
        for other in [more_poses, question] {
            let refused = simulate((&robot, &other), &folder, now, &|_, _| Control::Continue);
            let error = refused.unwrap_err().to_string();
            assert!(error.contains("expected an empty folder"), "{error}");
            assert_eq!(fs::read(folder.join(ROBOT)).unwrap(), known);
        }
    }
}
