//! The published method against its reference implementation, iterate by iterate.
//!
//! A dataset folder of MINI as Table 1 of Jin et al. 2018 gives it (CAD column as drawing,
//! measured column as truth, cable 7 with its signs mended) is solved here and by
//! `peers/scipy/jin2018.py`, where Python, NumPy and the script are at hand; the reference's
//! iterates, obtained once, are compared with in any case.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use nalgebra::Vector3;
use serde_json::json;
use tautline_core::estimation::published::{PublishedOptions, PublishedResult, identify_published};
use tautline_core::geometry::{Pose, Twist};
use tautline_core::kinematics::{
    applied_wrench, distribute_tension, inverse_kinematics, structure_matrix,
};
use tautline_core::measurement::{Dataset, Grid, Measurements};
use tautline_core::robot::{Robot, presets};

const POSES: usize = 25;
const STEPS_COMPARED: [usize; 4] = [1, 2, 5, 20];

/// MINI as drawn and as measured. Cables arrive from inside the frame here, so that they wrap little.
fn mini() -> (Robot, Robot) {
    let preset = presets::find("mini").expect("the preset of Table 1");
    let mut drawn = preset.robot;
    for cable in &mut drawn.cables {
        cable.pulley.swivel_axis[2] *= -1.0;
    }
    let mut measured = drawn.clone();
    let points = preset.measured_entry_points_m.expect("the measured column");
    for (cable, point) in measured.cables.iter_mut().zip(points) {
        cable.pulley.entry_point_m = point;
    }
    (drawn, measured)
}

/// Numbers in (-1, 1), the same on all machines (Knuth's multiplicative generator).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// Lengths and tensions near 30 N of all cables at a pose.
fn at_pose(robot: &Robot, pose: &Pose) -> Result<(Vec<f64>, Vec<f64>)> {
    let states = inverse_kinematics(robot, pose)?;
    let structure = structure_matrix(robot, pose)?;
    let wrench = applied_wrench(robot, pose)?;
    let m = robot.cable_count();
    let limits = (vec![5.0; m], vec![100.0; m]);
    let found = distribute_tension(&structure, &wrench, &vec![30.0; m], &limits.0, &limits.1);
    let lengths = states.iter().map(|state| state.length_m).collect();
    Ok((lengths, found.tensions_n))
}

/// Readings of the measured MINI at home and 25 poses, with the noise that the description states.
fn dataset() -> Result<Dataset> {
    let (drawn, truth) = mini();
    let laser = truth.laser.context("MINI has a laser")?;
    let mut numbers = Numbers(5);
    let mut measured = Measurements {
        revolutions: Grid::new(8),
        force_n: Grid::new(8),
        ..Measurements::default()
    };
    let unstrained = |(l, t): (&f64, &f64)| (0.6 + l) / (1.0 + t / 4e4);
    let (lengths, tensions) = at_pose(&truth, &Pose::identity())?;
    let at_home: Vec<f64> = lengths.iter().zip(&tensions).map(unstrained).collect();
    for label in 0..=POSES {
        let moved = f64::from(u8::from(label > 0));
        let twist = Twist::from_fn(|k, _| moved * [0.15, 0.1][k / 3] * numbers.next());
        let pose = Pose::identity().perturbed(&twist);
        let (lengths, tensions) = at_pose(&truth, &pose)?;
        let here = lengths.iter().zip(&tensions).map(unstrained);
        let turns: Vec<f64> = here
            .zip(&at_home)
            .zip(&truth.cables)
            .map(|((l, l0), cable)| {
                let noise = moved * 5e-5 * numbers.next();
                (l - l0 + noise) / cable.winch.cable_per_revolution_m()
            })
            .collect();
        let forces: Vec<f64> = tensions.iter().map(|t| 2.0 * t + numbers.next()).collect();
        let origin = pose.transform(&Vector3::from(laser.origin_m));
        let direction = pose.orientation * Vector3::from(laser.direction);
        let distance = (-0.5 - origin.z) / direction.z;
        measured.labels.push(label as i64);
        measured.commanded.push(Some(pose));
        measured.revolutions.push_row(&turns);
        measured.force_n.push_row(&forces);
        measured.laser_m.push(distance + 3e-4 * numbers.next());
    }
    Ok(Dataset {
        robot: drawn,
        measurements: measured,
    })
}

/// Writes the files of a dataset folder that the script reads.
fn write_folder(data: &Dataset, folder: &Path) -> Result<()> {
    let mut robot = serde_json::to_value(&data.robot)?;
    robot["format"] = json!("tautline-robot");
    robot["version"] = json!(1);
    std::fs::write(folder.join("robot.json"), robot.to_string())?;
    let mut table = String::from("pose,x_m,y_m,z_m,qw,qx,qy,qz");
    for i in 1..=8 {
        write!(table, ",rev_{i}")?;
    }
    for i in 1..=8 {
        write!(table, ",force_{i}_n")?;
    }
    table.push_str(",laser_m\n");
    let measured = &data.measurements;
    for j in 0..measured.len() {
        let pose = measured.commanded[j].context("every pose is commanded")?;
        write!(table, "{}", measured.labels[j])?;
        let orientation = pose.orientation_wxyz();
        let cells = pose.position.iter().chain(&orientation);
        let cells = cells.chain(measured.revolutions.row(j));
        for cell in cells.chain(measured.force_n.row(j)) {
            write!(table, ",{cell:?}")?;
        }
        writeln!(table, ",{:?}", measured.laser_m[j])?;
    }
    std::fs::write(folder.join("poses.csv"), table)?;
    Ok(())
}

/// The script next to the workspace, if it is there and Python has NumPy.
fn reference_script() -> Option<PathBuf> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared");
    let script = workspace.join("peers/scipy/jin2018.py");
    let numpy = Command::new("python3")
        .args(["-c", "import numpy"])
        .output();
    (script.is_file() && numpy.is_ok_and(|o| o.status.success())).then_some(script)
}

/// Entry points (m) of the reference after `steps` steps.
fn reference_entry_points(script: &Path, folder: &Path, steps: usize) -> Result<Vec<f64>> {
    let output = Command::new("python3")
        .arg(script)
        .arg(folder)
        .args(["--iterations", &steps.to_string()])
        .output()?;
    let text = String::from_utf8_lossy(&output.stdout);
    let error = String::from_utf8_lossy(&output.stderr);
    let line: serde_json::Value = serde_json::from_str(&text).context(error.into_owned())?;
    Ok(serde_json::from_value(line["entry_points_m"].clone())?)
}

fn solved(data: &Dataset, differences: Differences) -> Result<PublishedResult> {
    let options = PublishedOptions {
        parameter_difference_m: differences.parameter_m,
        pose_difference: differences.pose,
        ..PublishedOptions::for_robot(&data.robot)
    };
    Ok(identify_published(data, &options)?)
}

fn largest_difference(own: &[[f64; 3]], reference: &[f64]) -> f64 {
    let pairs = own.iter().flatten().zip(reference);
    pairs.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()))
}

/// Steps of the forward differences.
#[derive(Clone, Copy)]
struct Differences {
    parameter_m: f64,
    pose: f64,
}

/// The reference's own: rounding decides its iterates from about 0.1 mm down.
const SHORT: Differences = Differences {
    parameter_m: 1e-6,
    pose: 1e-7,
};
/// Long enough for rounding not to matter.
const LONG: Differences = Differences {
    parameter_m: 1e-3,
    pose: 1e-4,
};

/// A copy of the script with long difference steps.
fn with_long_differences(script: &Path, folder: &Path) -> Result<PathBuf> {
    let text = std::fs::read_to_string(script)?;
    let changed = text
        .replace("h = 1e-7", "h = 1e-4")
        .replace("+= 1e-6", "+= 1e-3")
        .replace("/ 1e-6", "/ 1e-3");
    ensure!(changed.matches("1e-3").count() == 2 && changed.contains("h = 1e-4"));
    let copy = folder.join("long_differences.py");
    std::fs::write(&copy, changed)?;
    Ok(copy)
}

#[test]
fn iterates_equal_those_of_the_reference() -> Result<()> {
    let Some(script) = reference_script() else {
        println!("published method: the reference jin2018.py (or NumPy) is absent, not compared");
        return Ok(());
    };
    let folder = tempfile::tempdir()?;
    let data = dataset()?;
    write_folder(&data, folder.path())?;
    let long = with_long_differences(&script, folder.path())?;
    for (script, differences, limit_m) in [(&script, SHORT, 1e-3), (&long, LONG, 1e-8)] {
        let begin = std::time::Instant::now();
        let result = solved(&data, differences)?;
        println!(
            "published method, differences of {:e} m: {} steps in {:.3} s, {:?}",
            differences.parameter_m,
            result.iterations,
            begin.elapsed().as_secs_f64(),
            result.stop
        );
        for steps in STEPS_COMPARED {
            let reference = reference_entry_points(script, folder.path(), steps)?;
            let off = largest_difference(&result.history[steps].entry_points_m, &reference);
            println!(
                "published method, differences of {:e} m, step {steps}: {off:.1e} m",
                differences.parameter_m
            );
            ensure!(off < limit_m, "step {steps}: {off:e} m");
        }
    }
    Ok(())
}

/// Entry points of cables 2 and 6 (m) that the reference (NumPy 2.4) gave after 1, 2, 5 and 20 steps.
type Frozen = [[[f64; 3]; 2]; 4];

const FROZEN_SHORT: Frozen = [
    [
        [-0.488454842650302, -0.3757652706097407, -0.4415],
        [
            -0.5157895517420668,
            -0.34363477299771694,
            0.42426927176065365,
        ],
    ],
    [
        [-0.48222318742729, -0.37520712541053824, -0.4415],
        [-0.5101630135219314, -0.3435066023578475, 0.4182001467288291],
    ],
    [
        [-0.4761273876794074, -0.3756608308004984, -0.4415],
        [
            -0.5104808712628272,
            -0.34516439850588415,
            0.4185611399186259,
        ],
    ],
    [
        [-0.47485543540564285, -0.3764068582670445, -0.4415],
        [
            -0.5133617873733851,
            -0.34654446133433603,
            0.4217355141162824,
        ],
    ],
];

const FROZEN_LONG: Frozen = [
    [
        [-0.4884399128455521, -0.37573257484386247, -0.4415],
        [
            -0.5152256757734102,
            -0.34329385076623853,
            0.42371462380536856,
        ],
    ],
    [
        [-0.48220494507001344, -0.37515930110377826, -0.4415],
        [-0.50937972761569, -0.343052643482538, 0.41743002461308054],
    ],
    [
        [-0.47611958472200144, -0.375610635052965, -0.4415],
        [
            -0.5095253541211434,
            -0.34467729029681976,
            0.4176078265895264,
        ],
    ],
    [
        [-0.4748544406893137, -0.37635374234308716, -0.4415],
        [-0.5124087167063988, -0.3460824484551391, 0.4207691603672358],
    ],
];

#[test]
fn iterates_equal_recorded_ones_of_the_reference() -> Result<()> {
    let data = dataset()?;
    for (frozen, differences, limit_m) in [(FROZEN_SHORT, SHORT, 1e-3), (FROZEN_LONG, LONG, 1e-8)] {
        let result = solved(&data, differences)?;
        for (steps, reference) in STEPS_COMPARED.iter().zip(&frozen) {
            let own = &result.history[*steps].entry_points_m;
            let off = largest_difference(&[own[1], own[5]], reference.as_flattened());
            ensure!(off < limit_m, "step {steps}: {off:e} m");
        }
    }
    Ok(())
}
