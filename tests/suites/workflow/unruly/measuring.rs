//! Runs end at an overload, at a second client and after a restart, and keep no reading of such a pose.

use tautline_validation::support::ads::Plant;
use tautline_validation::support::ads::unruly::Unruly;
use tautline_validation::support::program::{Answer, Folder, tautline};

use super::{controller, heard, session, start};

/// Measures MINI; calls `does` when so many poses are on disk.
fn measure(plant: &Plant<Unruly>, file: &str, (poses, does): (usize, &dyn Fn())) -> Answer {
    let controller = controller(plant);
    let words = [
        "measure",
        file,
        "--controller",
        &controller,
        "--robot",
        "mini",
        "--arm",
    ];
    let mark = format!("is on disk ({poses} of");
    heard(start(&words), |line, _| {
        if line.contains(&mark) {
            does();
        }
    })
}

#[test]
fn an_overload_stops_the_run_every_time() {
    let plant = Plant::unruly();
    let folder = Folder::new();
    let file = folder.join("s.json");
    let overload = || plant.show_force(Some((2, 500.0)));
    let stopped = measure(&plant, &file, (4, &overload));
    assert_eq!(stopped.code, Some(1), "{}", stopped.stderr);
    assert!(
        stopped.stderr.contains("cable-3 pulls with"),
        "{}",
        stopped.stderr
    );
    assert!(!stopped.stderr.contains("retrying"), "{}", stopped.stderr);
    let kept = session(&file).measurements.labels.clone();
    assert!(kept.len() < 8, "{kept:?}");
    // The cable is still overloaded: nothing is commanded.
    let target = plant.server.numbers("GVL_Tautline.target");
    let again = measure(&plant, &file, (0, &|| ()));
    assert_eq!(again.code, Some(1), "{}", again.stderr);
    assert!(
        again.stderr.contains("cable-3 pulls with"),
        "{}",
        again.stderr
    );
    assert_eq!(session(&file).measurements.labels, kept);
    assert_eq!(plant.server.numbers("GVL_Tautline.target"), target);
    assert_eq!(plant.server.numbers("GVL_Tautline.kind"), [3.0], "stop");
    plant.show_force(None);
    measure(&plant, &file, (0, &|| ())).succeeded();
    assert_eq!(session(&file).measurements.len(), 26);
}

#[test]
fn a_second_client_ends_the_run() {
    let plant = Plant::unruly();
    let folder = Folder::new();
    let file = folder.join("s.json");
    // With any number, including that of our next command.
    let other = || plant.command_as_another(2.0);
    let stopped = measure(&plant, &file, (5, &other));
    assert_eq!(stopped.code, Some(1), "{}", stopped.stderr);
    assert!(
        stopped.stderr.contains("another client commands it"),
        "{}",
        stopped.stderr
    );
    let kept = session(&file).measurements.len();
    assert!((5..8).contains(&kept), "{kept}");
    assert_eq!(plant.server.numbers("GVL_Tautline.release"), [0.0]);
}

/// Another client writes the drum of a cable.
fn write_drum(plant: &Plant<Unruly>, cable: usize, off_m: f64) {
    let mut drums = plant.server.numbers("GVL_Tautline.drum_diameter");
    drums[cable] += off_m;
    plant
        .server
        .write_as_another("GVL_Tautline.drum_diameter", &drums);
}

#[test]
fn values_written_by_another_client_mark_the_poses_of_the_run() {
    let plant = Plant::unruly();
    let folder = Folder::new();
    let file = folder.join("s.json");
    let run = measure(&plant, &file, (5, &|| write_drum(&plant, 2, 1e-3))).succeeded();
    let said = "While poses 1 to 25 and home were measured, somebody else changed values of the controller: \
                cable-3.winch.drum_diameter_m from 0.04 to 0.041 m.";
    assert!(run.stderr.contains(said), "{}", run.stderr);
    assert!(run.stdout.contains(said), "{}", run.stdout);
    let marked = session(&file);
    let writes: Vec<_> = marked.foreign_writes().collect();
    assert_eq!(writes.len(), 1);
    assert_eq!(writes[0].poses, marked.measurements.labels);
    let log = marked.log().iter();
    assert_eq!(log.filter(|step| step.text.contains(said)).count(), 1);
    let report = folder.join("r.html");
    tautline(&["report", &file, "--out", &report]).succeeded();
    let report = std::fs::read_to_string(&report).expect("a report");
    assert!(report.contains(said), "{report}");
}

#[test]
fn values_written_after_a_kill_are_noticed_by_the_next_command() {
    let plant = Plant::unruly();
    let folder = Folder::new();
    let file = folder.join("s.json");
    let controller = controller(&plant);
    let words = [
        "measure",
        &file,
        "--controller",
        &controller,
        "--robot",
        "mini",
        "--arm",
    ];
    heard(start(&words), |line, child| {
        if line.contains("is on disk (4 of") {
            child.kill().expect("killed");
        }
    });
    let known = plant.server.values();
    write_drum(&plant, 0, 2e-3);
    assert_eq!(plant.server.values(), known, "not by Tautline");
    let next = measure(&plant, &file, (0, &|| ())).succeeded();
    assert!(
        next.stderr
            .contains("somebody else changed values of the controller: cable-1.winch"),
        "{}",
        next.stderr
    );
    let marked = session(&file);
    let writes: Vec<_> = marked.foreign_writes().collect();
    assert_eq!(marked.audit(), []);
    // The poses of the killed run, not those of the next one, which had the new values throughout.
    assert_eq!(writes.len(), 1);
    assert!((4..7).contains(&writes[0].poses.len()), "{:?}", writes[0]);
    assert_eq!(marked.measurements.len(), 26);
}

#[test]
fn poses_before_and_after_a_restart_are_separate_series() {
    let plant = Plant::unruly();
    let folder = Folder::new();
    let file = folder.join("s.json");
    let controller = controller(&plant);
    let broken = measure(&plant, &file, (6, &|| plant.restart(0.05)));
    assert_eq!(broken.code, Some(1), "{}", broken.stderr);
    let kept = session(&file).measurements.labels.clone();
    assert!(kept.len() < 9, "{kept:?}");
    assert_eq!(session(&file).controller_started, Some(0.0));
    // Another call notices it as well, and goes nowhere.
    let number = plant.server.numbers("GVL_Tautline.number");
    let again = measure(&plant, &file, (0, &|| ()));
    assert_eq!(again.code, Some(1), "{}", again.stderr);
    assert!(
        again.stderr.contains("the controller was restarted"),
        "{}",
        again.stderr
    );
    assert_eq!(session(&file).measurements.labels, kept);
    assert_eq!(plant.server.numbers("GVL_Tautline.number"), number);
    // A series of its own begins at home.
    let next = folder.join("next.json");
    let words = [
        "measure",
        &next,
        "--series-of",
        &file,
        "--controller",
        &controller,
        "--arm",
    ];
    tautline(&words).succeeded();
    let series = session(&next);
    assert_eq!(series.measurements.len(), 26);
    assert_eq!(series.plan, session(&file).plan);
    assert_eq!(series.controller_started, Some(1.0));
    tautline(&["adjust", &next, "--controller", &controller, "--dry-run"]).succeeded();
}
