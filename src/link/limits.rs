//! Limits enforced by this program: whatever a controller allows, no pose outside the workspace is commanded and no cable pulls too hard.

use tautline_core::geometry::Pose;
use tautline_core::robot::Robot;
use tautline_core::simulation::{TensionRange, Workspace};

use crate::error::LinkError;

/// Standard deviations by which a reading may exceed the tension limit, as noise.
const NOISE: f64 = 6.0;
/// Largest deviation of an orientation quaternion's norm from 1.
const UNIT: f64 = 1e-6;

/// Workspace and tension limits of a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Limits {
    /// The robot for predicting and reading tensions.
    pub robot: Robot,
    /// Workspace of commanded poses.
    pub workspace: Workspace,
    /// Tension limits of the distribution; a reading above the upper one stops the motion.
    pub tension: TensionRange,
}

impl Limits {
    /// Default limits for a robot.
    #[must_use]
    pub fn of(robot: &Robot) -> Self {
        Self {
            workspace: Workspace::of(robot),
            tension: TensionRange::of(robot),
            robot: robot.clone(),
        }
    }

    /// Checks that the pose is inside the workspace and that tensions within the limits balance the platform there.
    ///
    /// # Errors
    /// [`LinkError::Limit`] otherwise.
    pub fn check_pose(&self, pose: &Pose) -> Result<(), LinkError> {
        if !is_pose(pose) {
            let text = "the commanded pose contains a number that is not finite";
            return Err(LinkError::Limit(text.to_owned()));
        }
        if !self.workspace.contains(pose) {
            let text = format!("{} or its orientation is not in the workspace", place(pose));
            return Err(LinkError::Limit(text));
        }
        if !self.robot.has_tensions() {
            return Ok(());
        }
        let held = self.tension.tensions(&self.robot, pose);
        let held = held.map_err(|e| LinkError::Limit(format!("at {} {e}", place(pose))))?;
        held.map(drop)
            .ok_or_else(|| LinkError::Limit(self.not_held(pose)))
    }

    /// Checks that tensions within the limits balance the platform on the straight way between two poses, where that can be
    /// checked.
    ///
    /// # Errors
    /// [`LinkError::Limit`] otherwise.
    pub fn check_way(&self, from: &Pose, to: &Pose) -> Result<(), LinkError> {
        if self.robot.unchecked_tensions().is_some() {
            return Ok(());
        }
        let held = self.tension.hold_between(&self.robot, from, to);
        held.map_err(|pose| {
            let text = self.not_held(&pose);
            LinkError::Limit(format!("on the way to {} {text}", place(to)))
        })
    }

    fn not_held(&self, pose: &Pose) -> String {
        format!(
            "no tensions between {:.0} N and {:.0} N hold the platform at {}",
            self.tension.lower_n,
            self.tension.upper_n,
            place(pose)
        )
    }

    /// Checks that no cable pulls harder than the limit, beyond the noise of its sensor, or than in the readings
    /// `accepted` (raw, N; empty: none).
    ///
    /// # Errors
    /// [`LinkError::Limit`], naming the cable.
    pub fn check_forces(&self, force_n: &[f64], accepted: &[f64]) -> Result<(), LinkError> {
        for (index, (cable, reading)) in self.robot.cables.iter().zip(force_n).enumerate() {
            let Some(sensor) = cable.force_sensor else {
                continue;
            };
            let tension = sensor.tension_n(*reading);
            let accepted_n = accepted
                .get(index)
                .map(|reading| sensor.tension_n(*reading));
            // A reading of NaN accepts nothing.
            let limit_n = self.tension.upper_n.max(accepted_n.unwrap_or(f64::NAN));
            if tension > limit_n + NOISE * sensor.tension_sd_n {
                return Err(LinkError::Limit(format!(
                    "{} pulls with {tension:.0} N, at most {:.0} N are allowed",
                    cable.name, self.tension.upper_n
                )));
            }
        }
        Ok(())
    }
}

fn place(pose: &Pose) -> String {
    let [x, y, z] = (pose.position * 1e3).into();
    format!("position ({x:.1}, {y:.1}, {z:.1}) mm")
}

/// Whether all numbers of a pose are finite and its quaternion has norm one.
fn is_pose(pose: &Pose) -> bool {
    let wxyz = pose.orientation_wxyz();
    let length = wxyz.iter().map(|q| q * q).sum::<f64>().sqrt();
    // The comparison is false for NaN.
    pose.position.iter().all(|value| value.is_finite()) && (length - 1.0).abs() < UNIT
}

#[cfg(test)]
mod tests {
    use super::Limits;
    use crate::testing::{limits, preset};

    #[test]
    fn a_platform_that_is_too_heavy_is_not_driven_although_a_sensor_is_missing() {
        let mut preset = preset("mini");
        preset.robot.platform.mass_kg = Some(500.0);
        preset.robot.cables[3].force_sensor = None;
        let centre = preset.workspace.centre;
        let refused = limits(&preset).check_pose(&centre).unwrap_err().to_string();
        assert!(
            refused.contains("no tensions between 10 N and 150 N"),
            "{refused}"
        );
        assert_eq!(preset.robot.unchecked_tensions(), None);
        // Without limits in the description, or a mass, nothing can be checked.
        let mut without = preset.clone();
        without.robot.limits = None;
        let said = without.robot.unchecked_tensions().unwrap();
        assert!(said.contains("states no tension limits"), "{said}");
        preset.robot.platform.mass_kg = None;
        let said = preset.robot.unchecked_tensions().unwrap();
        assert!(said.contains("states no mass"), "{said}");
        limits(&preset).check_pose(&centre).unwrap();
    }

    #[test]
    fn poses_that_cannot_be_held_are_refused() {
        let preset = preset("mini");
        let mut limits = limits(&preset);
        let centre = preset.workspace.centre;
        limits.check_pose(&centre).unwrap();
        limits.tension.upper_n = 11.0;
        limits.tension.reference_n = 10.5;
        let held = limits.check_pose(&centre).unwrap_err().to_string();
        assert!(held.contains("no tensions between 10 N and 11 N"), "{held}");
        let mut nowhere = centre;
        nowhere.position.x = f64::NAN;
        let told = limits.check_pose(&nowhere).unwrap_err().to_string();
        assert!(told.contains("a number that is not finite"), "{told}");
        let mut turned = centre;
        let unknown = nalgebra::Quaternion::new(f64::NAN, 0.0, 0.0, 0.0);
        turned.orientation = nalgebra::UnitQuaternion::new_unchecked(unknown);
        assert!(limits.check_pose(&turned).is_err());
    }

    /// Two cables that hold a platform of 39 N in a plane, without stated limits.
    #[test]
    fn statics_that_decide_the_tensions_do_not_widen_the_limits_of_readings() {
        let mut robot = preset("planar").robot;
        robot.cables.drain(..2);
        robot.platform.free.truncate(2);
        robot.limits = None;
        assert!(Limits::of(&robot).tension.upper_n <= 200.0);
        for cable in &mut robot.cables {
            cable.force_sensor = None;
        }
        assert!(Limits::of(&robot).tension.upper_n > 390.0);
    }
}
