//! `tautline home`.

mod report;

use std::path::PathBuf;

use anyhow::{Result, anyhow};
use tautline_core::geometry::Pose;
use tautline_link::Instrument;
use tautline_session::{HomePose, Phase, Session};
use tautline_workflow::adjusting::held;
use tautline_workflow::controllers::{ConnectionSetup, ControllerChoice};
use tautline_workflow::precalibration::{Calibration, HomeDocument};
use tautline_workflow::wording::count;

use crate::BadInput;
use crate::examples::examples;
use crate::live::{Connection, LinkArguments, SessionFile, interrupt, link_error, typed};
use crate::measure::{refuse_unsettled, require_simulated};
use crate::output::{JsonOutput, notice};
use crate::progress::ProgressLine;

#[derive(Debug, clap::Args)]
#[command(after_help = examples(&[
    ("Five returns of a simulated robot to its home pose", "tautline home run.json --controller sim --repeats 5 --arm"),
    ("A pose that was measured by hand; it is asked for", "tautline home cell.json --position-sd 0.1 --orientation-sd 0.02"),
]))]
pub struct Arguments {
    /// Session file
    #[arg(value_name = "SESSION")]
    session: PathBuf,
    /// Return home before each measurement: sim, replay:DIR, ads:HOST[:PORT]/NETID or opc.tcp://HOST[:PORT]; without it the platform must be at home
    #[arg(long, value_name = "CONTROLLER", requires = "arm")]
    controller: Option<String>,
    /// Allow the robot to move
    #[arg(long)]
    arm: bool,
    #[command(flatten)]
    link: LinkArguments,
    /// Number of measurements of the home pose; poses are typed unless the robot is simulated
    #[arg(long, value_name = "N", default_value_t = 1)]
    repeats: usize,
    /// Standard deviation of one measured position (mm); by default that of the last measurement, else of the robot
    #[arg(long, value_name = "MM")]
    position_sd: Option<f64>,
    /// Standard deviation of one measured rotation about each axis (degrees); by default as for positions
    #[arg(long, value_name = "DEG")]
    orientation_sd: Option<f64>,
    #[command(flatten)]
    json: JsonOutput<HomeDocument>,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let mut file = SessionFile::open(&arguments.session, &mut notice)?;
    let place = arguments.session.display().to_string();
    refuse_unsettled(&file.session, &place)?;
    let sds = sds(arguments, &file.session)?;
    let poses = match &arguments.controller {
        Some(choice) => {
            let choice = choice.parse();
            let choice = choice.map_err(|e| BadInput::new(format!("--controller: {e}")))?;
            returned(arguments, &mut file, &choice)?
        }
        None => {
            typed::require("Nothing was measured: the poses have to be typed")?;
            (1..=arguments.repeats)
                .map(|number| asked(arguments, number))
                .collect::<Result<_>>()?
        }
    };
    let measured_now = poses.len();
    let (position_sd_m, orientation_sd_rad) = sds;
    let measured = poses.into_iter().map(|pose| HomePose {
        position_m: pose.position.into(),
        orientation_wxyz: pose.orientation_wxyz(),
        position_sd_m,
        orientation_sd_rad,
    });
    file.session.phases.home_poses.extend(measured);
    let calibration = Calibration::of(&file.session);
    let average = calibration.home_average;
    let average = average.ok_or_else(|| anyhow!("{place}: the home pose has no mean"))?;
    let robot = calibration.with_home.robot.map_err(BadInput::new)?;
    file.session.robot = robot;
    let text = format!("Home pose measured {}.", count(measured_now, "time"));
    file.log(Phase::Instruments, text);
    file.save()?;
    let document = HomeDocument::of(&average, measured_now);
    arguments
        .json
        .deliver(&document, || report::print(&document))
}

/// Standard deviations of one measurement: position (m), rotation (rad).
fn sds(arguments: &Arguments, session: &Session) -> Result<(f64, f64)> {
    let Some(home) = &session.robot.home else {
        let place = arguments.session.display();
        return Err(BadInput::new(format!(
            "{place}: its robot has no home pose"
        )));
    };
    let last = session.phases.home_poses.last();
    let by_default = last.map_or((home.position_sd_m, home.orientation_sd_rad), |last| {
        (last.position_sd_m, last.orientation_sd_rad)
    });
    let chosen = (
        arguments.position_sd.map_or(by_default.0, |mm| mm * 1e-3),
        arguments
            .orientation_sd
            .map_or(by_default.1, f64::to_radians),
    );
    for (name, sd) in [("position", chosen.0), ("orientation", chosen.1)] {
        if !(sd.is_finite() && sd > 0.0) {
            let message = format!("--{name}-sd: found {sd}, expected a number greater than 0");
            return Err(BadInput::new(message));
        }
    }
    Ok(chosen)
}

/// Returns home before each measurement, which a simulated robot's instrument or the operator makes.
fn returned(
    arguments: &Arguments,
    file: &mut SessionFile,
    choice: &ControllerChoice,
) -> Result<Vec<Pose>> {
    require_simulated(
        &file.session,
        choice,
        &arguments.session.display().to_string(),
    )?;
    arguments.link.take(&mut file.session, choice)?;
    let setup = ConnectionSetup::chosen(&file.session, &[], choice, Some(&file.controller()));
    if !setup.has_instrument() {
        typed::require("The robot was not moved: the poses have to be typed")?;
    }
    let mut connection = Connection::open(&setup, &arguments.link, None)?;
    interrupt::listen()?;
    connection.arm()?;
    let mut instrument = connection.home_instrument.take();
    let mut poses = Vec::new();
    let mut progress = ProgressLine::new();
    for number in 1..=arguments.repeats {
        if !connection.go_home()? {
            return Err(anyhow!(
                "Stopped by the operator: these measurements are discarded"
            ));
        }
        poses.push(match &mut instrument {
            Some(instrument) => seen(instrument.as_mut())?,
            None => asked(arguments, number)?,
        });
        if instrument.is_some() {
            progress.show(|| format!("home, measurement {number} of {}", arguments.repeats));
        }
    }
    if *choice == ControllerChoice::Simulated {
        // The controller keeps its own home pose, independent of the measured one.
        let parameters = connection.controller.parameters().map_err(link_error)?;
        file.session.controller = held(&parameters);
    }
    Ok(poses)
}

fn seen(instrument: &mut dyn Instrument) -> Result<Pose> {
    let seen = instrument.measure().map_err(link_error)?;
    let orientation = seen.orientation_wxyz.unwrap_or([1.0, 0.0, 0.0, 0.0]);
    Ok(Pose::from_parts(seen.position_m, orientation))
}

/// Asks for a pose at the terminal.
fn asked(arguments: &Arguments, number: usize) -> Result<Pose> {
    let question = format!(
        "Home, measurement {number} of {}: x y z [mm] roll pitch yaw [degrees]?",
        arguments.repeats
    );
    let expected = "six numbers: x y z in mm, roll pitch yaw in degrees";
    typed::answer(&question, expected, pose_of)
        .ok_or_else(|| BadInput::new("no pose was typed: these measurements are discarded"))
}

fn pose_of(line: &str) -> Option<Pose> {
    let [x, y, z, angles @ ..]: [f64; 6] = typed::numbers(line)?;
    let position_m = [x, y, z].map(|mm| mm * 1e-3);
    Some(Pose::from_angles(position_m, angles.map(f64::to_radians)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn six_numbers_are_a_pose() {
        let pose = pose_of("1 -2.5 3e1 0 0 90\n").expect("a pose");
        assert_eq!(<[f64; 3]>::from(pose.position), [1e-3, -2.5e-3, 0.03]);
        let turned = pose.orientation * nalgebra::Vector3::x();
        assert!((turned - nalgebra::Vector3::y()).norm() < 1e-12);
        for line in ["", "1 2 3", "1 2 3 4 5 6 7", "1 2 3 0 0 nan"] {
            assert!(pose_of(line).is_none(), "{line}");
        }
    }
}
