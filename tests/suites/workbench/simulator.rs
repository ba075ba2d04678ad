//! The user's own programs: a simulator beside the machine, and the identified values in the file of another program.

use std::fs;

use egui_kittest::kittest::Queryable;
use tautline_core::kinematics::inverse_kinematics;
use tautline_core::measurement::{Grid, Measurements};
use tautline_import::Dialect;
use tautline_session::write_poses;
use tautline_workbench::model::command::{
    CompareCommand, IdentificationCommand, RobotCommand, ViewCommand,
};
use tautline_workbench::model::phase::{Phase, Screen};

use crate::measured::{Measured, document, give, press};
use crate::support::settle;

#[test]
fn a_simulator_is_compared_with_the_machine() {
    let measured = Measured::mini(30, &[("winch_scale", "cable-3", &[("scale", 0.01)])]);
    let mut harness = measured.opened();
    give(&mut harness, IdentificationCommand::Identify);
    let session = document(&harness).session();
    let data = &session.measurements;
    let mut length_m = Grid::new(session.robot.cable_count());
    for pose in data.commanded.iter().flatten() {
        let cables = inverse_kinematics(&session.robot, pose).expect("in reach");
        let row: Vec<f64> = cables.iter().map(|cable| cable.length_m).collect();
        length_m.push_row(&row);
    }
    let simulated = Measurements {
        labels: data.labels.clone(),
        commanded: data.commanded.clone(),
        length_m,
        ..Measurements::default()
    };
    let file = measured.beside("simulated.csv");
    write_poses(fs::File::create(&file).expect("a file"), &simulated).expect("written");
    give(&mut harness, CompareCommand::Simulator(file));
    settle(&mut harness);
    harness.get_by_label("Simulator and machine");
    harness.get_by_label("simulated.csv: 30 poses");
    harness.get_by_label_contains("nearer to robot.json than to the identified model");
    harness.get_by_label_contains("Length explained by: places of the pulleys (");
    press(&mut harness, "Laser");
    harness.get_by_label("Plot: errors of the simulator and of the identified model");
    let other = measured.beside("other.csv");
    fs::write(&other, "pose,laser\n1,2\n").expect("written");
    give(&mut harness, CompareCommand::Simulator(other));
    settle(&mut harness);
    harness.get_by_label_contains("other.csv");
}

#[test]
fn identified_values_are_taken_into_the_file_of_another_program() {
    let measured = Measured::mini(30, &[]);
    let mut harness = measured.opened();
    give(&mut harness, IdentificationCommand::Identify);
    let robot = document(&harness).session().robot.clone();
    let mut dialects = Dialect::ALL.into_iter();
    let mjcf = dialects
        .find(|dialect| dialect.name == "mjcf")
        .expect("MuJoCo");
    let (file, text) = (measured.beside("mine.xml"), (mjcf.new_text)(&robot));
    fs::write(&file, &text).expect("written");
    give(
        &mut harness,
        ViewCommand::Go(Screen::Phase(Phase::Adjustment)),
    );
    give(&mut harness, RobotCommand::Firmware(file.clone()));
    settle(&mut harness);
    harness.get_by_label_contains("mine.xml: ");
    harness.get_by_label_contains("The text as it is: ");
    harness.get_by_label("Copy lines").click_accesskit();
    harness.step();
    let commands = &harness.output().platform_output.commands;
    let copied = commands.iter().find_map(|command| match command {
        egui::OutputCommand::CopyText(text) => Some(text.clone()),
        _ => None,
    });
    let copied = copied.expect("lines");
    assert!(copied.lines().count() >= 8, "{copied}");
    for line in copied.lines() {
        assert!(line.contains("<body name=\"pulley_"), "{line}");
        assert!(!text.contains(line), "{line}");
    }
    assert_eq!(fs::read_to_string(&file).expect("the file"), text);
    fs::write(&file, "something else").expect("written");
    give(&mut harness, RobotCommand::Firmware(file));
    settle(&mut harness);
    harness.get_by_label_contains("found a text of another kind");
}
