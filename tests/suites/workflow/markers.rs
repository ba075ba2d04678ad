//! From markers seen by cameras to pulleys: unmeasured frames are found, and estimated within their standard deviations.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use serde_json::Value;
use tautline_core::geometry::{Pose, Vec3};
use tautline_core::robot::{PerAxis, Robot, Tracker, presets};
use tautline_core::simulation::{Simulated, SimulationOptions, simulate};
use tautline_session::write_robot;
use tautline_validation::generators::your_data::{
    cameras_see_robot, capture, log, middle_of_markers,
};

use crate::commands::program::{Folder, tautline};

const EFFECTS: [&str; 3] = ["tracker_frame", "tracker_target", "tracker_tilt"];
/// Standard deviations by which a value may be off: one of 27 is further off less than once in 10,000 times.
const MOST: f64 = 4.7;

fn robot() -> Robot {
    let mut robot = presets::find("mini").expect("a preset").robot;
    robot.tracker = Some(Tracker {
        position_sd_m: PerAxis::Same(2e-4),
        orientation_sd_rad: Some(1.1e-3),
    });
    robot
}

fn numbers(value: &Value) -> Vec<f64> {
    let all = value.as_array().expect("a list").iter();
    all.map(|one| one.as_f64().expect("a number")).collect()
}

fn placement(value: &Value) -> Pose {
    let [position, turned] = ["position_m", "orientation_wxyz"].map(|key| numbers(&value[key]));
    Pose::from_parts(
        position.try_into().expect("three"),
        turned.try_into().expect("four"),
    )
}

/// Values and standard deviations of the estimated effects.
struct Estimated<'a>(&'a Value);

impl Estimated<'_> {
    /// Value and standard deviation of a parameter.
    fn of(&self, effect: &str, name: &str) -> [f64; 2] {
        let all = self.0["effects"].as_array().expect("effects");
        let is_it = |one: &&Value| one["effect"] == effect && one["parameter"] == name;
        let own = all.iter().find(is_it).expect("the parameter");
        ["value", "sd"].map(|key| own[key].as_f64().expect("a number"))
    }

    /// Asserts that three parameters of an effect have the expected values within their standard deviations.
    fn check(&self, effect: &str, names: [&str; 3], expected: Vector3<f64>) {
        for (name, expected) in names.into_iter().zip(expected.iter()) {
            let [value, sd] = self.of(effect, name);
            let off = (value - expected) / sd;
            assert!(
                off.abs() < MOST,
                "{effect} {name}: {value} +- {sd} instead of {expected}"
            );
        }
    }
}

/// Twice the Rodrigues parameters.
fn turn(rotation: &UnitQuaternion<f64>) -> Vector3<f64> {
    rotation.imag() * (2.0 / rotation.w)
}

#[test]
fn unknown_frames_and_markers_are_estimated_with_the_pulleys() {
    let mut within = [0, 0];
    for seed in 1..=3 {
        let folder = Folder::new();
        let robot = robot();
        write_robot(folder.join("robot.json").as_ref(), &robot).expect("written");
        let run = simulate(&robot, &SimulationOptions::new(40, seed)).expect("simulated");
        let data = &run.dataset.measurements;
        folder.write("log.csv", &log(data));
        folder.write("capture.csv", &capture(data, seed).expect("a capture"));
        let [log, capture, robot, out] =
            ["log.csv", "capture.csv", "robot.json", "data"].map(|name| folder.join(name));
        tautline(&["import", &log, &capture, "--robot", &robot, "-o", &out]).succeeded();
        let recipe = std::fs::read_to_string(folder.join("data/recipe.json")).expect("a recipe");
        let recipe: Value = serde_json::from_str(&recipe).expect("JSON");
        let found = ["frame", "body"].map(|key| placement(&recipe["instrument"][key]));
        let mut arguments = vec!["identify", &out, "--json", "-"];
        EFFECTS
            .iter()
            .for_each(|effect| arguments.extend(["--effect", effect]));
        let answer = tautline(&arguments).succeeded().json();

        // The frame that was found, relative to the true one: the expected value of the effect.
        let [frame, body] = found;
        let truth = cameras_see_robot();
        let rotation = frame.orientation * truth.orientation;
        let shift = frame.transform(&truth.position);
        let estimated = Estimated(&answer);
        estimated.check("tracker_frame", ["shift_x", "shift_y", "shift_z"], shift);
        estimated.check(
            "tracker_frame",
            ["turn_x", "turn_y", "turn_z"],
            turn(&rotation),
        );
        // Poses were transformed to the platform's origin by a body whose tilt is that of the effect.
        let tilt = ["tilt_x", "tilt_y", "tilt_z"].map(|name| estimated.of("tracker_tilt", name)[0]);
        let tilt = Quaternion::from_parts(1.0, Vector3::from(tilt) * 0.5);
        let point = UnitQuaternion::from_quaternion(tilt) * body.position;
        let expected = middle_of_markers() - point;
        estimated.check("tracker_target", ["x", "y", "z"], expected);
        count(&answer, &run, &mut within);
    }
    // Of 72 coordinates 95 % are within two standard deviations, or so: those of one run depend on each other.
    assert!(within[1] == 72 && within[0] >= 60, "{within:?}");
}

/// Counts the coordinates of the entry points that are within two standard deviations of the truth.
fn count(answer: &Value, run: &Simulated, within: &mut [usize; 2]) {
    let points = answer["entry_points_m"].as_array().expect("points");
    let deviations = answer["entry_points_sd_m"].as_array().expect("deviations");
    for ((point, sd), cable) in points.iter().zip(deviations).zip(&run.truth.cables) {
        let off = Vec3::from_column_slice(&numbers(point)) - Vec3::from(cable.pulley.entry_point_m);
        for (off, sd) in off.iter().zip(numbers(sd)) {
            within[0] += usize::from(off.abs() < 2.0 * sd);
            within[1] += 1;
        }
    }
}
