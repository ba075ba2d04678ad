use tautline_core::geometry::Pose;
use tautline_core::measurement::{Grid, Measurements};

use super::*;
use crate::phases::{
    CheckKind, CheckPose, CheckRow, ElongationPoint, ForcePair, HomeReading, PoseDistance,
    WinchPair,
};

/// The robot of formats.md, section 1.
const ROBOT_OF_THE_CONTRACT: &str = r#"
{ "format": "tautline-robot", "version": 1, "name": "mini",
  "home": {"position_m": [0,0,0], "orientation_wxyz": [1,0,0,0], "position_sd_m": 1e-4, "orientation_sd_rad": 5e-4},
  "gravity_m_s2": [0,0,-9.80665],
  "platform": {"free": ["x","y","z","rx","ry","rz"], "mass_kg": 2.5, "center_of_mass_m": [0,0,0]},
  "laser": {"origin_m": [0,0,-0.055], "direction": [0,0,-1], "sd_m": 3e-4,
            "target_plane": {"normal": [0,0,1], "offset_m": -0.5, "offset_sd_m": 5e-3}},
  "inclinometer": {"sd_rad": 2e-3}, "tracker": {"position_sd_m": 1e-3, "orientation_sd_rad": 1e-3},
  "cables": [ { "name": "cable-1",
      "pulley": {"entry_point_m": [0.5,-0.378,-0.4415], "entry_point_sd_m": 8e-3, "swivel_axis": [0,0,-1], "swivel_zero": [1,0,0], "swivel_sd_rad": 5e-3, "radius_m": 0.018},
      "platform_anchor_m": [0.06,-0.045,0.05],
      "winch": {"drum_diameter_m": 0.04, "drum_pitch_m": 0.002, "gear_ratio": 1.0, "length_to_pulley_m": 0.6, "length_sd_m": 5e-5},
      "cable": {"axial_stiffness_n": 4e4, "weight_n_per_m": 0.0},
      "force_sensor": {"tension_gain": 2.0, "bias_n": 0.0, "tension_sd_n": 1.0} } ] }"#;

fn dataset() -> Dataset {
    let robot = crate::parse_robot(ROBOT_OF_THE_CONTRACT.as_bytes(), "robot.json");
    let robot = robot.expect("a robot");
    assert!(robot.notices.is_empty(), "{:?}", robot.notices);
    let mut revolutions = Grid::new(1);
    revolutions.push_row(&[0.0]);
    revolutions.push_row(&[-0.1]);
    Dataset {
        robot: robot.value,
        measurements: Measurements {
            labels: vec![0, 1],
            commanded: vec![None, Some(Pose::identity())],
            revolutions,
            laser_m: vec![0.5, 1.0 / 3.0],
            ..Measurements::default()
        },
    }
}

fn phases() -> PhaseData {
    let pose = CheckPose {
        position_m: [0.1, 0.2, 0.3],
        orientation_wxyz: None,
    };
    PhaseData {
        winch: vec![WinchPair {
            cable: 0,
            revolutions: 1.0,
            length_m: 0.1,
            tension_n: None,
        }],
        force: vec![ForcePair {
            cable: 0,
            reading_n: 20.0,
            load_n: 9.8,
        }],
        home: vec![HomeReading {
            sensor: 0,
            reading: 0.1,
        }],
        home_poses: Vec::new(),
        elongation: vec![ElongationPoint {
            length_m: 2.0,
            tension_n: 9.0,
            elongation_m: 1e-3,
        }],
        distances: vec![PoseDistance {
            poses: [0, 1],
            distance_m: 0.25,
            sd_m: 0.001,
            point_m: [0.0, 0.01, 0.0],
        }],
        check: vec![CheckRow {
            kind: CheckKind::Pose,
            target: "P1".into(),
            cycle: 1,
            sample: 0,
            time_s: None,
            commanded: pose,
            attained: pose,
        }],
    }
}

#[test]
fn a_folder_reads_back_as_it_was_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("new").join("deep");
    for phases in [PhaseData::default(), phases()] {
        write_dataset(&path, &dataset(), &phases).expect("written");
        let read = read_dataset(&path).expect("a dataset");
        let mut expected = dataset();
        let distances = phases::distance_readings(&phases.distances, &expected.measurements);
        expected.measurements.distances = distances;
        assert_eq!(read.dataset, expected);
        assert_eq!(read.phases, phases);
        assert!(read.notices.is_empty(), "{:?}", read.notices);
    }
    assert_eq!(
        read_check_file(&path.join("check.csv"))
            .expect("rows")
            .value,
        phases().check
    );
}

#[test]
fn tables_of_another_dataset_are_neither_adopted_nor_deleted() {
    let folder = tempfile::tempdir().expect("a folder");
    write_dataset(folder.path(), &dataset(), &phases()).expect("written");
    let error = write_dataset(folder.path(), &dataset(), &PhaseData::default());
    assert!(
        matches!(error, Err(WriteError::OtherDataset { .. })),
        "{error:?}"
    );
    assert!(folder.path().join("winch.csv").exists());
}

#[cfg(unix)]
#[test]
fn a_pipe_is_refused_and_not_waited_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let pipe = folder.path().join("poses.csv");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    assert!(made.expect("mkfifo").success());
    let refused = read_table_file(&pipe, |reader, file| {
        std::io::read_to_string(reader).map_err(|e| ReadError::io(file, Location::File, &e))
    });
    let refused = refused.expect_err("a pipe").to_string();
    assert!(
        refused.ends_with("is a pipe or a device, expected a file"),
        "{refused}"
    );
    for path in [pipe.as_path(), Path::new("/dev/zero")] {
        let refused = crate::import(path, None).expect_err("no file").to_string();
        assert!(refused.ends_with("expected a file"), "{refused}");
    }
}
