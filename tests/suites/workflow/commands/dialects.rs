//! import and export of the texts in which firmware and simulators describe robots. The written texts are checked in
//! `tests/suites/python/test_dialects.py`.

use super::program::{Folder, tautline};

const CONFIG: &str = include_str!("../../fuzz/seeds/foreign_file/config.g");

#[test]
fn a_config_becomes_a_robot_and_the_robot_changes_the_config() {
    let folder = Folder::new();
    folder.write("config.g", CONFIG);
    let [config, robot, new] = ["config.g", "robot.json", "new.g"].map(|name| folder.join(name));
    let read = tautline(&["import", &config, "-o", &robot]).succeeded();
    assert!(
        read.stdout.ends_with("config with 4 cables\n"),
        "{}",
        read.stdout
    );
    assert!(
        read.stderr
            .contains("left out, as they do not change the geometry: M666 J, M669 P")
    );
    let same = tautline(&["export", &robot, "--for", "reprap", "--onto", &config]).succeeded();
    assert!(
        same.stdout.contains("The text as it is: 0.00 mm expected."),
        "{}",
        same.stdout
    );
    let text = std::fs::read_to_string(&robot).expect("a robot");
    folder.write("robot.json", &text.replacen("-1.4205", "-1.4155", 1));
    let answer = tautline(&[
        "export", &robot, "--for", "reprap", "--onto", &config, "-o", &new,
    ]);
    let answer = answer.succeeded();
    assert!(
        answer
            .stdout
            .contains("M669 A.1  mm    -1420.500  -1415.500"),
        "{}",
        answer.stdout
    );
    let written = std::fs::read_to_string(&new).expect("a config");
    assert_eq!(written, CONFIG.replace("-1420.5", "-1415.500"));
    assert_eq!(std::fs::read_to_string(&config).expect("a config"), CONFIG);
}

#[test]
fn what_is_wrong_with_a_text_is_said_with_its_place() {
    let folder = Folder::new();
    folder.write("config.g", &CONFIG.replace("702.4", "abc"));
    folder.write("good.g", CONFIG);
    folder.write(
        "robot.sdf",
        "<?xml version=\"1.0\"?>\n<sdf version=\"1.4\"/>\n",
    );
    let [config, good, gazebo, robot] =
        ["config.g", "good.g", "robot.sdf", "robot.json"].map(|name| folder.join(name));
    let import = |file: &str| tautline(&["import", file, "-o", &robot]);
    import(&config).refused(&[
        "config.g, line 4, column 34",
        "found \"abc\", expected a number",
    ]);
    import(&gazebo).refused(&["robot.sdf, line 2: <sdf>: found no cables, expected frames"]);
    let other = tautline(&["export", "mini", "--for", "reprap", "--onto", &good]);
    other.refused(&["mini: not found"]);
    tautline(&["new", "mini", "-o", &robot]).succeeded();
    let other = tautline(&["export", &robot, "--for", "reprap", "--onto", &good]);
    other.refused(&["found 8 cables in the model, expected the 4 of", "good.g"]);
    let over = tautline(&[
        "export", &robot, "--for", "reprap", "--onto", &good, "-o", &good,
    ]);
    over.refused(&["good.g: is an input of this command, expected another name"]);
}
