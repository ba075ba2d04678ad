use std::path::PathBuf;

use super::*;
use crate::session::tests::session;
use crate::{write_dataset, write_robot, write_session};

struct Bench {
    folder: tempfile::TempDir,
}

impl Bench {
    fn new() -> Self {
        Self {
            folder: tempfile::tempdir().expect("a folder"),
        }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn import_text(&self, text: &str) -> Result<Loaded<Import>, String> {
        let path = self.path("x.txt");
        fs::write(&path, text).expect("written");
        import(&path, Some(&session())).map_err(|error| error.to_string())
    }
}

#[test]
fn documents_are_known_by_their_format() {
    let bench = Bench::new();
    let session = session();
    let path = bench.path("a.txt");
    write_session(&path, &session).expect("written");
    let loaded = import(&path, None).expect("a session");
    assert!(matches!(&loaded.value, Import::Session(read) if read.basis() == session.basis()));
    write_robot(&path, &session.robot).expect("written");
    let loaded = import(&path, None).expect("a robot");
    assert_eq!(loaded.value, Import::Robot(Box::new(session.robot.clone())));
    write_dataset(&bench.path("d"), &session.dataset(), &session.phases).expect("written");
    let loaded = import(&bench.path("d"), None).expect("a dataset");
    assert!(matches!(&loaded.value, Import::Dataset(d) if d.phases == session.phases));
    fs::remove_file(bench.path("d").join(POSES)).expect("removed");
    let loaded = import(&bench.path("d"), None).expect("a dataset without poses");
    assert!(matches!(&loaded.value, Import::Dataset(d) if d.dataset.measurements.is_empty()));
}

#[test]
fn tables_are_known_by_their_columns() {
    let bench = Bench::new();
    let is = |text: &str, expected: fn(&Import) -> bool| {
        let loaded = bench.import_text(text).expect(text);
        assert!(expected(&loaded.value), "{text}: {:?}", loaded.value);
    };
    is(
        "pose,length_1_m,length_2_m\n1,1,1\n",
        |i| matches!(i, Import::Poses(poses) if poses.labels == [1]),
    );
    is(
        "pose,x_m,y_m,z_m,length_1_m,length_2_m\n1,0,0,0,1,1\n",
        |i| matches!(i, Import::Poses(_)),
    );
    is(
        "pose,x_m,y_m,z_m,qw,qx,qy,qz\n1,0,0,0,1,0,0,0\n",
        |i| matches!(i, Import::Plan(plan) if plan.len() == 1),
    );
    is(
        "length_m,rev,cable\n1,1,b\n",
        |i| matches!(i, Import::Winch(pairs) if pairs[0].cable == 1),
    );
    is(
        "cable;reading_n;load_n\n1;1,5;2\n",
        |i| matches!(i, Import::Force(pairs) if pairs[0].reading_n == 1.5),
    );
    is("\u{feff}sensor,reading\n1,0.5\n", |i| {
        matches!(i, Import::Home(_))
    });
    is("length_m,tension_n,elongation_m\n1,1,0.1\n", |i| {
        matches!(i, Import::Elongation(_))
    });
    is(
        "kind,target,cycle,cmd_x_m,cmd_y_m,cmd_z_m,x_m,y_m,z_m\npose,P,1,0,0,0,0,0,0\n",
        |i| matches!(i, Import::Check(_)),
    );
    let notices = bench
        .import_text("sensor,reading,who\n1,0.5,me\n")
        .expect("home readings")
        .notices;
    assert!(notices[0].contains("column \"who\": unknown, ignored"));
}

#[test]
fn a_missing_column_is_named_with_its_place() {
    let bench = Bench::new();
    for (header, column) in [
        ("length_1_m,length_2_m", "pose"),
        ("pose,x_m,y_m", "z_m"),
        ("x_m,y_m,z_m", "pose"),
        ("cable,rev", "length_m"),
        ("cable,load_n", "reading_n"),
        ("reading", "sensor"),
        ("length_m,elongation_m", "tension_n"),
        ("kind,target,cycle,x_m,y_m,z_m", "cmd_x_m"),
    ] {
        let text = format!(
            "# a comment\n{header}\n{}\n",
            header.replace(char::is_alphabetic, "1")
        );
        let error = bench.import_text(&text).expect_err(header);
        let expected = format!("x.txt, line 2, column \"{column}\": missing");
        assert!(error.contains(&expected), "{error}");
    }
}

#[test]
fn what_is_not_understood_is_named_beside_what_is() {
    let bench = Bench::new();
    for (text, found) in [
        (
            "",
            "x.txt: found an empty file, expected a session, a robot,",
        ),
        (
            "first,second\n1,2\n",
            "x.txt: found a table with the columns \"first\", \"second\", expected a session",
        ),
        (
            r#"{"format": "tautline-identification", "version": 1}"#,
            "x.txt, /format: found \"tautline-identification\", expected \"tautline-session\" or",
        ),
        ("{}", "x.txt, /format: not given, expected"),
        ("[1]", "found an array of 1, expected a JSON object"),
        ("{\"format\": ", "the file is cut off"),
        ("\u{1}\u{2}", "x.txt"),
    ] {
        let error = bench.import_text(text).expect_err(text);
        assert!(error.contains(found), "{error}");
    }
    fs::write(bench.path("b"), b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR").expect("written");
    let error = import(&bench.path("b"), None).expect_err("a picture");
    assert!(
        error
            .to_string()
            .contains("b: found a binary file, expected a session"),
        "{error}"
    );
    assert!(error.to_string().contains("tautline import"), "{error}");
    fs::write(bench.path("b"), b"\xff\xfep\0").expect("written");
    let error = import(&bench.path("b"), None).expect_err("UTF-16");
    assert!(error.to_string().contains("in Excel: save as"), "{error}");
    let error = import(bench.folder.path(), None).expect_err("no dataset");
    assert!(
        error
            .to_string()
            .contains("found a folder without robot.json"),
        "{error}"
    );
    let error = import(&bench.path("none"), None).expect_err("nothing");
    assert!(error.to_string().contains("none: not found"), "{error}");
}

#[test]
fn tables_of_cables_need_a_robot() {
    let bench = Bench::new();
    let path = bench.path("w.csv");
    fs::write(&path, "cable,rev,length_m\n1,1,1\n").expect("written");
    let error = import(&path, None).expect_err("no robot").to_string();
    assert!(
        error.contains("w.csv: found a table of winch readings, expected an open session"),
        "{error}"
    );
    fs::write(&path, "sensor,reading\n1,1\n").expect("written");
    assert!(import(&path, None).is_ok());
}
