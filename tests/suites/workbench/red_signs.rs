//! The primary button is the remedy of the first red sign, on every screen and in every state.

use egui::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use tautline_core::diagnosis::Finding;
use tautline_core::robot::presets;
use tautline_session::{
    Adjustment, CheckKind, CheckPose, CheckRow, ForeignWrite, HomePose, Outcome, PlannedPose,
    Session, Stage, Timestamp, Verification, WinchPair, write_session,
};
use tautline_validation::support::harness::words;
use tautline_workbench::model::command::{
    FileCommand, IdentificationCommand, RecordingCommand, ViewCommand,
};
use tautline_workbench::model::edit::Edit;
use tautline_workbench::model::next_step;
use tautline_workbench::model::phase::{Phase, Screen};
use tautline_workbench::shell::App;

use crate::measured::{Measured, document, give, press};
use crate::support::workbench;

/// Poses that are planned where none are.
const POSES: usize = 25;

/// Number of red signs on the screen.
fn red_signs(harness: &Harness<'_, App>) -> usize {
    harness.query_all_by_label("Problem:").count()
}

/// The primary button of a phase; empty without one.
fn primary(harness: &Harness<'_, App>, phase: Phase) -> String {
    let step = next_step::of(&harness.state().state.model, phase, POSES).expect("a session");
    step.action.map_or_else(String::new, |action| action.title)
}

/// Checks that the primary button is the remedy of the first red sign on the screen, if there is one.
pub fn is_the_remedy(harness: &Harness<'_, App>, phase: Phase) {
    let problems = next_step::problems(&harness.state().state.model, phase);
    let Some(first) = problems.first() else {
        let said = words(harness);
        assert_eq!(red_signs(harness), 0, "{phase:?} has no remedy: {said:?}");
        return;
    };
    let remedy = first.remedy.as_ref().map_or("", |remedy| &remedy.title);
    assert_eq!(primary(harness, phase), remedy, "{phase:?}: {}", first.text);
}

/// The parts of a phase, one of which is shown at a time.
fn parts(phase: Phase) -> &'static [(Role, &'static str)] {
    match phase {
        Phase::Precalibration => &[
            (Role::Tab, "Winches"),
            (Role::Tab, "Force sensors"),
            (Role::Tab, "Home platform"),
        ],
        Phase::Identification => &[(Role::Button, "Geometry"), (Role::Button, "Model doctor")],
        _ => &[],
    }
}

/// Shows all phases with all their parts; returns the number of red signs.
fn look_at_all(harness: &mut Harness<'_, App>) -> usize {
    let mut seen = 0;
    for phase in Phase::ALL {
        give(harness, ViewCommand::Go(Screen::Phase(phase)));
        is_the_remedy(harness, phase);
        seen += red_signs(harness);
        for (role, part) in parts(phase) {
            let found = harness.query_by_role_and_label(*role, part);
            let Some(part) = found else {
                continue;
            };
            part.click_accesskit();
            harness.run_ok();
            is_the_remedy(harness, phase);
            seen += red_signs(harness);
        }
    }
    seen
}

fn at(seconds: i64) -> Timestamp {
    Timestamp::from_unix_seconds(seconds)
}

fn mini() -> Session {
    Session::new("red", presets::find("mini").expect("a preset").robot, at(0))
}

/// MINI with sixteen poses that its description explains.
fn measured() -> Session {
    let measured = Measured::mini(16, &[]);
    let harness = measured.opened();
    document(&harness).session().clone()
}

/// An attempt to write, which ended so.
fn written(outcome: Outcome) -> Adjustment {
    Adjustment {
        time: at(2),
        operator: "Ada".into(),
        controller: String::new(),
        changes: Vec::new(),
        outcome,
        read_back: Vec::new(),
        restores: false,
    }
}

/// Sessions with a problem, the phase that reports it, and its primary button.
fn wrong_sessions() -> Vec<(&'static str, Session, Phase, &'static str)> {
    let change = |mut session: Session, change: &dyn Fn(&mut Session)| {
        change(&mut session);
        session
    };
    let no_home = change(mini(), &|session| {
        let home = session.robot.home.take().expect("a home pose").pose();
        session.plan = vec![PlannedPose::new(1, &home)];
    });
    let winch = change(mini(), &|session| {
        let pair = |k: u32| WinchPair {
            cable: 2,
            revolutions: f64::from(k),
            length_m: 0.2 * f64::from(k * k),
            tension_n: None,
        };
        session.phases.winch = (0..6).map(pair).collect();
    });
    let without_home_row = change(measured(), &|session| {
        let rows: Vec<usize> = (1..session.measurements.len()).collect();
        session.measurements = session.measurements.select(&rows);
    });
    let reversed = change(measured(), &|session| {
        let revolutions = &mut session.measurements.revolutions;
        for row in 0..revolutions.rows() {
            revolutions.set(row, 2, -revolutions.get(row, 2));
        }
    });
    let foreign = change(measured(), &|session| {
        session.add_foreign_write(ForeignWrite {
            begun: at(1),
            noticed: at(2),
            poses: vec![3],
            changes: Vec::new(),
        });
    });
    let attempt = |outcome: Outcome| {
        change(measured(), &move |session| {
            session.add_adjustment(written(outcome.clone()));
        })
    };
    // One cycle has no repeatability.
    let no_figures = change(measured(), &|session| {
        let pose = |x: f64| CheckPose {
            position_m: [x, 0.0, 0.0],
            orientation_wxyz: None,
        };
        session.add_verification(Verification {
            time: at(3),
            title: String::new(),
            stage: Stage::Before,
            rows: vec![CheckRow {
                kind: CheckKind::Pose,
                target: "P1".into(),
                cycle: 1,
                sample: 0,
                time_s: None,
                commanded: pose(0.1),
                attained: pose(0.101),
            }],
            accepted: None,
        });
    });
    vec![
        (
            "no home",
            no_home,
            Phase::Measuring,
            "Measure the home pose",
        ),
        (
            "a winch",
            winch,
            Phase::Precalibration,
            "Import winch.csv again…",
        ),
        (
            "no home row",
            without_home_row,
            Phase::Identification,
            "Plan 25 poses",
        ),
        (
            "a reversed winch",
            reversed,
            Phase::Identification,
            "Diagnose model",
        ),
        (
            "values of others",
            foreign,
            Phase::Identification,
            "Measure again",
        ),
        (
            "writing failed",
            attempt(Outcome::Failed("Nothing was written.".into())),
            Phase::Adjustment,
            "Identify the pulleys",
        ),
        (
            "writing was interrupted",
            attempt(Outcome::Begun),
            Phase::Adjustment,
            "Choose controller…",
        ),
        (
            "no figures",
            no_figures,
            Phase::Adjustment,
            "Choose controller…",
        ),
    ]
}

#[test]
fn in_every_session_it_is_the_remedy() {
    let folder = tempfile::tempdir().expect("a folder");
    for (number, (name, session, phase, remedy)) in wrong_sessions().into_iter().enumerate() {
        let path = folder.path().join(format!("{number}.json"));
        write_session(&path, &session).expect("written");
        let mut harness = workbench();
        give(&mut harness, FileCommand::Open(path));
        assert!(look_at_all(&mut harness) > 0, "{name}: nothing is red");
        assert_eq!(primary(&harness, phase), remedy, "{name}");
    }
}

#[test]
fn in_every_state_of_an_identification_it_is_the_remedy() {
    let slip: &[(&str, f64)] = &[("step", 0.02), ("pose", 17.0)];
    let measured = Measured::mini(40, &[("cable_slip", "cable-5", slip)]);
    let mut harness = measured.opened();
    assert_eq!(look_at_all(&mut harness), 0);
    give(&mut harness, IdentificationCommand::Identify);
    assert!(look_at_all(&mut harness) > 1);
    assert_eq!(primary(&harness, Phase::Adjustment), "Go to identification");
    give(&mut harness, IdentificationCommand::Diagnose);
    look_at_all(&mut harness);
    let phase = Phase::Identification;
    assert_eq!(primary(&harness, phase), "Repaired: measure again");
    let diagnosed = document(&harness).diagnosis().expect("a diagnosis").clone();
    let finding: Finding = diagnosed.diagnosis.findings[0].clone();
    let cause = finding.cause().expect("a cause");
    let effects = diagnosed.settings(cause);
    give(&mut harness, Edit::AddEffects(effects, "add it".into()));
    assert_eq!(look_at_all(&mut harness), 0);
    assert_eq!(primary(&harness, phase), "Go to adjustment");
}

/// From the import of a log with two mistakes to the adjustment, by primary buttons alone.
#[test]
fn mistakes_of_an_import_are_corrected_on_the_way() {
    let mut bench = crate::tables::Bench::new();
    let text = crate::importing::example("mistakes.csv");
    let file = bench.write("log.csv", &text);
    give(&mut bench.harness, RecordingCommand::Read(file));
    give(&mut bench.harness, RecordingCommand::Finish);
    let phase = Phase::Identification;
    assert!(look_at_all(&mut bench.harness) > 0);
    for other in [Phase::Measuring, phase] {
        assert_eq!(primary(&bench.harness, other), "Back to import");
        give(&mut bench.harness, ViewCommand::Go(Screen::Phase(other)));
    }
    press(&mut bench.harness, "Next: Back to import");
    assert!(bench.shows("No mistake was found"));
    give(&mut bench.harness, RecordingCommand::Finish);
    assert_eq!(primary(&bench.harness, phase), "Identify the pulleys");
    press(&mut bench.harness, "Next: Identify the pulleys");
    assert_eq!(primary(&bench.harness, phase), "Go to adjustment");
}

/// From a robot without a home pose to its plan.
#[test]
fn a_home_pose_is_measured_before_poses_are_planned() {
    let mut bench = crate::tables::Bench::with_robot(|robot| {
        robot.as_object_mut().expect("a robot").remove("home");
    });
    for phase in [Phase::Precalibration, Phase::Modeling, Phase::Measuring] {
        assert_eq!(primary(&bench.harness, phase), "Measure the home pose");
    }
    give(
        &mut bench.harness,
        ViewCommand::Go(Screen::Phase(Phase::Measuring)),
    );
    press(&mut bench.harness, "Next: Measure the home pose");
    let screen = bench.harness.state().state.model.screen;
    assert_eq!(screen, Screen::Phase(Phase::Precalibration));
    bench.harness.get_by_label("Measured by another instrument");
    let mut phases = bench.session().phases.clone();
    phases.home_poses.push(HomePose {
        position_m: [0.01, 0.02, 0.5],
        orientation_wxyz: [1.0, 0.0, 0.0, 0.0],
        position_sd_m: 1e-3,
        orientation_sd_rad: 1e-3,
    });
    let typed = Edit::SetPhases(Box::new(phases), "type a home pose".into());
    give(&mut bench.harness, typed);
    press(&mut bench.harness, "Next: Apply measured values");
    let home = bench.session().robot.home.expect("a home pose");
    assert_eq!(home.position_m, [0.01, 0.02, 0.5]);
    let phase = Phase::Precalibration;
    assert_eq!(primary(&bench.harness, phase), "Plan 25 poses");
}
