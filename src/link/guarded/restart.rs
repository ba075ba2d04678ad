//! Detection of a controller restart, after which its encoders have lost their zero.

use tautline_core::geometry::Pose;
use tautline_core::robot::Robot;

use crate::controller::Sample;

/// Change of a length without connection that exceeds creep, in standard deviations of a mean reading: the threshold
/// of a jump between two samples at rest.
const JUMP: f64 = 50.0;
/// Difference below which two poses are equal (m and rad).
const SAME: f64 = 1e-6;

/// Last known state of a controller.
#[derive(Debug, Clone, PartialEq)]
pub struct LastState {
    /// Time on its clock (s), if it has its own.
    pub time_s: Option<f64>,
    /// Value that changes with every start, if it reports one.
    pub started: Option<f64>,
    /// Commanded pose at which it stood still, if any.
    pub resting: Option<Pose>,
    /// Motor revolutions at that time.
    pub revolutions: Vec<f64>,
    /// Whether the connection was lost or closed since then.
    pub was_away: bool,
}

impl LastState {
    pub(super) fn of(sample: &Sample, moving: bool) -> Self {
        Self {
            time_s: Some(sample.time_s),
            started: sample.started,
            resting: sample.commanded.filter(|_| !moving),
            revolutions: sample.revolutions.clone(),
            was_away: false,
        }
    }

    /// Evidence that the controller was restarted since this state.
    pub(super) fn restart(&self, now: &Self, robot: &Robot) -> Option<String> {
        if let Some((then, now)) = self
            .started
            .zip(now.started)
            .filter(|(then, now)| then != now)
        {
            return Some(format!("its reported start changed from {then} to {now}"));
        }
        if let Some((then_s, now_s)) = self.time_s.zip(now.time_s).filter(|(then, now)| now < then)
        {
            return Some(format!(
                "its clock ran backwards, from {then_s:.1} s to {now_s:.1} s"
            ));
        }
        let (then, there) = self.resting.zip(now.resting).filter(|_| self.was_away)?;
        if there.difference(&then).amax() > SAME {
            return None;
        }
        let readings = self.revolutions.iter().zip(&now.revolutions);
        robot.cables.iter().zip(readings).find_map(|(cable, (then, now))| {
            let jump_m = (now - then) * cable.winch.cable_per_revolution_m();
            (jump_m.abs() > JUMP * cable.winch.length_sd_m).then(|| {
                let jump_mm = jump_m * 1e3;
                format!(
                    "the encoder of {} jumped by {jump_mm:.1} mm without a motion while it was not connected",
                    cable.name
                )
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::preset;

    #[test]
    fn starts_clocks_and_encoders_tell_a_restart() {
        let robot = preset("mini").robot;
        let seen = LastState {
            time_s: Some(100.0),
            started: Some(7.0),
            resting: Some(Pose::identity()),
            revolutions: vec![1.0; 8],
            was_away: true,
        };
        assert_eq!(seen.restart(&seen, &robot), None);
        let told = |change: fn(&mut LastState)| {
            let mut now = seen.clone();
            change(&mut now);
            seen.restart(&now, &robot)
        };
        assert!(told(|now| now.started = Some(8.0)).is_some());
        assert!(told(|now| now.started = None).is_none());
        let back = told(|now| now.time_s = Some(2.0)).expect("a restart");
        assert!(back.contains("ran backwards"), "{back}");
        assert!(told(|now| now.time_s = Some(200.0)).is_none());
        let jumped = told(|now| now.revolutions[3] += 0.05).expect("a restart");
        assert!(
            jumped.contains("the encoder of cable-4 jumped by"),
            "{jumped}"
        );
        assert!(told(|now| now.revolutions[3] += 1e-4).is_none());
        // Elsewhere, or in motion, encoders may show anything.
        assert!(told(|now| (now.resting, now.revolutions[3]) = (None, 9.0)).is_none());
        let never_away = LastState {
            was_away: false,
            ..seen.clone()
        };
        let mut now = seen.clone();
        now.revolutions[3] += 0.05;
        assert_eq!(never_away.restart(&now, &robot), None);
    }
}
