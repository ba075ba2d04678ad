use std::fs;

use super::*;
use tautline_core::robot::presets;
use tautline_import::{Assignment, PoseReport};
use tautline_session::write_robot;

fn session() -> Session {
    let robot = presets::find("mini").expect("a preset").robot;
    Session::new("test", robot, Timestamp::from_unix_seconds(0))
}

#[test]
fn what_is_opened_is_known_by_its_content() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let open = |path: &Path| open(path, Some(&session()), &|_| true).expect("read").value;
    write_robot(&path("a"), &session().robot).expect("written");
    assert!(matches!(open(&path("a")), Opened::Own(_)));
    fs::write(path("b"), "t;Winch1;Winch2\n0;1,5;2\n1;1,6;2\n").expect("written");
    assert!(matches!(open(&path("b")), Opened::Sources(found) if found.len() == 1));
    let recipe = Recipe {
        channels: vec![Assignment::new("Winch{i}", "rev_{i}")],
        ..Recipe::default()
    };
    tautline_session::write_versioned(&path("c"), &recipe).expect("written");
    assert!(matches!(open(&path("c")), Opened::Recipe(read) if *read == recipe));
}

#[test]
fn reading_is_stopped_where_it_is_wanted() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("long.csv");
    let rows: String = (0..300_000)
        .map(|k| format!("{k},{k}.5,{k}.25\n"))
        .collect();
    fs::write(&path, format!("t,a,b\n{rows}")).expect("written");
    let asked = std::cell::RefCell::new(Vec::new());
    let stopped = open(&path, None, &|part| {
        asked.borrow_mut().push(part);
        part < 0.5
    });
    assert!(stopped.is_err());
    let asked = asked.borrow();
    assert!(asked.len() > 2 && asked.is_sorted() && asked.iter().all(|part| *part < 0.9));
}

#[test]
fn the_last_recipe_of_a_session_is_found_again() {
    let mut session = session();
    assert_eq!(last_recipe(&session), None);
    for channel in ["first", "second"] {
        let recipe = Recipe {
            channels: vec![Assignment::new(channel, "laser_m")],
            ..Recipe::default()
        };
        let kept = recipe_record(&session, &recipe, Timestamp::from_unix_seconds(1));
        session.add_result(kept);
    }
    let found = last_recipe(&session).expect("a recipe");
    assert_eq!(found.channels, [Assignment::new("second", "laser_m")]);
}

#[test]
fn poses_lie_behind_the_channel_at_their_times_or_rows() {
    let pose = PoseReport {
        pose: 1,
        begin_s: Some(2.0),
        end_s: Some(3.5),
        first_row: 20,
        rows: 16,
        readings: Default::default(),
    };
    let course = [(0, 1.0), (20, 2.0), (99, 3.0)];
    let times: Vec<f64> = (0..100).map(|row| f64::from(row) / 10.0).collect();
    let poses = [pose];
    let timed = channel_figure("a", Some("mm"), &course, Some(&times), &poses);
    assert_eq!(timed.spans[0].x, [2.0, 3.5]);
    assert_eq!(timed.curves[0].points[1], [2.0, 2.0]);
    let by_row = channel_figure("a", None, &course, None, &poses);
    assert_eq!(by_row.spans[0].x, [21.0, 36.0]);
    assert_eq!(by_row.curves[0].points[1], [21.0, 2.0]);
}
