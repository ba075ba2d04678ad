//! Mistakes in the optional tables.

use super::Mistake::File;
use super::{BadInput, case};

pub(super) fn cases() -> Vec<BadInput> {
    let mut cases = phase_1_and_2();
    cases.extend(phase_5());
    cases
}

fn phase_1_and_2() -> Vec<BadInput> {
    vec![
        case(
            "winch: unknown cable",
            File("winch.csv", b"cable,rev,length_m\n\n5,1,0.1\n"),
            &["winch.csv, line 3, column \"cable\": found \"5\""],
        ),
        case(
            "winch: no length",
            File("winch.csv", b"cable,rev\n1,1\n"),
            &["winch.csv, line 1, column \"length_m\": missing"],
        ),
        case(
            "winch: empty cell",
            File("winch.csv", b"cable,rev,length_m\n1,,0.1\n"),
            &["winch.csv, line 2, column \"rev\": found an empty cell, expected a number"],
        ),
        case(
            "winch: millimetres",
            File("winch.csv", b"cable,rev,length_m\n1,1,1257\n"),
            &["winch.csv, line 2, column \"length_m\": found \"1257\""],
        ),
        case(
            "force: text",
            File("force.csv", b"cable,reading_n,load_n\ncable-1,x,1\n"),
            &["force.csv, line 2, column \"reading_n\": found \"x\""],
        ),
        case(
            "force: negative load",
            File("force.csv", b"cable,reading_n,load_n\n1,1,-1\n"),
            &["force.csv, line 2, column \"load_n\": found \"-1\""],
        ),
        case(
            "home: sensor 7",
            File("home.csv", b"sensor,reading\n7,1\n"),
            &["home.csv, line 2, column \"sensor\": found \"7\", expected a sensor from 1 to 6"],
        ),
        case(
            "home: empty",
            File("home.csv", b""),
            &["home.csv: found no line"],
        ),
        case(
            "elongation: zero length",
            File(
                "elongation.csv",
                b"length_m,tension_n,elongation_m\n0,1,0\n",
            ),
            &["elongation.csv, line 2, column \"length_m\": found \"0\""],
        ),
        case(
            "elongation: millimetres",
            File(
                "elongation.csv",
                b"length_m;tension_n;elongation_m\n1,5;10;2,5\n",
            ),
            &["elongation.csv, line 2, column \"elongation_m\": found \"2,5\""],
        ),
    ]
}

fn phase_5() -> Vec<BadInput> {
    vec![
        case(
            "check: unknown kind",
            File("check.csv", b"kind,target,cycle,cmd_x_m,cmd_y_m,cmd_z_m,x_m,y_m,z_m\npoint,1,1,0,0,0,0,0,0\n"),
            &["check.csv, line 2, column \"kind\": found \"point\", expected pose or path"],
        ),
        case(
            "check: cycle twice",
            File("check.csv", b"kind,target,cycle,cmd_x_m,cmd_y_m,cmd_z_m,x_m,y_m,z_m\npose,1,1,0,0,0,0,0,0\npose,1,1,0,0,0,0,0,0\n"),
            &["check.csv, line 3, column \"cycle\""],
        ),
        case(
            "check: path without samples",
            File("check.csv", b"kind,target,cycle,sample,cmd_x_m,cmd_y_m,cmd_z_m,x_m,y_m,z_m\npath,1,1,,0,0,0,0,0,0\n"),
            &["check.csv, line 2, column \"sample\": found an empty cell"],
        ),
        case(
            "check: part of a quaternion",
            File("check.csv", b"kind,target,cycle,cmd_x_m,cmd_y_m,cmd_z_m,x_m,y_m,z_m,qw\npose,1,1,0,0,0,0,0,0,1\n"),
            &["check.csv, line 1, column \"qx\": missing"],
        ),
    ]
}
