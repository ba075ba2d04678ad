//! Which sensor, how many poses: answers from the expected covariance alone, fast enough to follow a slider.

use tautline_core::geometry::Pose;
use tautline_core::planning::{DesignCriteria, expect, random_poses};
use tautline_core::robot::{Inclinometer, Robot};
use tautline_workflow::wording::units::significant;

use crate::cell::options;
use crate::scaling::size_m;

/// Most poses that can be asked about.
pub const MOST_POSES: usize = 100;
/// Numbers of poses of the curve.
const POSES: [usize; 9] = [5, 8, 12, 18, 25, 35, 50, 70, 100];
/// Standard deviations of lasers of the curve (m).
pub const LASERS_M: [f64; 7] = [0.05e-3, 0.1e-3, 0.2e-3, 0.5e-3, 1e-3, 2e-3, 5e-3];
/// Standard deviation of the inclinometer that is proposed (rad).
const INCLINOMETER_RAD: f64 = 0.5e-3;
/// Gain that is worth a sentence.
const WORTH: f64 = 0.05;
/// Seed of the poses.
const SEED: u64 = 1;

/// What is asked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Question {
    /// Standard deviation of the laser (m); `None`: no laser.
    pub laser_sd_m: Option<f64>,
    /// Number of poses, home not counted.
    pub poses: usize,
    /// Standard deviation of each coordinate of the home position (m).
    pub home_sd_m: f64,
    /// Standard deviation of an inclinometer (rad), if there is one.
    pub inclinometer_sd_rad: Option<f64>,
}

/// The answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// Root mean square position error over the workspace (m); `None` where something is left open.
    pub position_m: Option<f64>,
    /// Root mean square standard deviation of the entry points (m).
    pub entry_m: Option<f64>,
    /// Position error (m) with other lasers: their standard deviations (m).
    pub over_laser: Vec<(f64, Option<f64>)>,
    /// Position error (m) with other numbers of poses.
    pub over_poses: Vec<(usize, Option<f64>)>,
    /// What one change would gain: what, and the position error with it (m).
    pub changes: Vec<(&'static str, Option<f64>)>,
}

/// A robot with poses to ask about.
#[derive(Debug, Clone)]
pub struct Advisor {
    robot: Robot,
    poses: Vec<Pose>,
}

impl Advisor {
    /// Draws the poses, of which each question takes the first ones.
    ///
    /// # Errors
    /// One sentence, if the robot cannot be held at enough poses.
    pub fn new(robot: &Robot) -> Result<Self, String> {
        let options = options(MOST_POSES, SEED, size_m(robot));
        Ok(Self {
            poses: random_poses(robot, &options).map_err(|error| error.to_string())?,
            robot: robot.clone(),
        })
    }

    /// The question as the robot's description answers it.
    #[must_use]
    pub fn question(&self) -> Question {
        Question {
            laser_sd_m: self.robot.laser.map(|laser| laser.sd_m),
            poses: 25,
            home_sd_m: self.robot.home.map_or(0.0, |home| home.position_sd_m),
            inclinometer_sd_rad: self.robot.inclinometer.map(|sensor| sensor.sd_rad),
        }
    }

    /// Answers a question.
    ///
    /// # Errors
    /// One sentence, if there is nothing to identify or a pose cannot be held.
    pub fn answer(&self, question: &Question) -> Result<Answer, String> {
        let all = self.criteria(question, MOST_POSES, &POSES)?;
        let own = self.criteria(question, question.poses, &[question.poses])?;
        let with = |changed: Question| {
            let count = changed.poses.min(MOST_POSES);
            Ok::<_, String>(self.criteria(&changed, count, &[count])?[0].platform_m)
        };
        let over_laser = match (question.laser_sd_m, self.robot.laser) {
            (Some(_), Some(_)) => (LASERS_M.iter())
                .map(|sd| {
                    let changed = Question {
                        laser_sd_m: Some(*sd),
                        ..*question
                    };
                    Ok((*sd, with(changed)?))
                })
                .collect::<Result<Vec<_>, String>>()?,
            _ => Vec::new(),
        };
        let mut changes = Vec::new();
        if let Some(sd) = question.laser_sd_m {
            changes.push((
                "a laser twice as exact",
                with(Question {
                    laser_sd_m: Some(0.5 * sd),
                    ..*question
                })?,
            ));
        }
        changes.push((
            "twice as many poses",
            with(Question {
                poses: 2 * question.poses,
                ..*question
            })?,
        ));
        if question.home_sd_m > 0.0 {
            changes.push((
                "the home pose known twice as well",
                with(Question {
                    home_sd_m: 0.5 * question.home_sd_m,
                    ..*question
                })?,
            ));
        }
        if question.inclinometer_sd_rad.is_none() {
            changes.push((
                "an inclinometer of 0.5 mrad",
                with(Question {
                    inclinometer_sd_rad: Some(INCLINOMETER_RAD),
                    ..*question
                })?,
            ));
        }
        Ok(Answer {
            position_m: own[0].platform_m,
            entry_m: own[0].mean_m,
            over_laser,
            over_poses: POSES
                .into_iter()
                .zip(all.into_iter().map(|criteria| criteria.platform_m))
                .collect(),
            changes,
        })
    }

    /// Criteria after so many of the first `most` poses.
    fn criteria(
        &self,
        question: &Question,
        most: usize,
        counts: &[usize],
    ) -> Result<Vec<DesignCriteria>, String> {
        let robot = self.asked(question);
        let options = options(most, SEED, size_m(&robot));
        let poses = &self.poses[..most.clamp(1, MOST_POSES)];
        let set = expect(&robot, poses, &options).map_err(|error| error.to_string())?;
        Ok(counts
            .iter()
            .map(|count| set.after(*count).criteria)
            .collect())
    }

    fn asked(&self, question: &Question) -> Robot {
        let mut robot = self.robot.clone();
        match (&mut robot.laser, question.laser_sd_m) {
            (Some(laser), Some(sd_m)) => laser.sd_m = sd_m,
            (laser, _) => *laser = None,
        }
        if let Some(home) = &mut robot.home {
            if home.position_sd_m > 0.0 {
                home.orientation_sd_rad *= question.home_sd_m / home.position_sd_m;
            }
            home.position_sd_m = question.home_sd_m;
            home.covariance = None;
        }
        robot.inclinometer = question
            .inclinometer_sd_rad
            .map(|sd_rad| Inclinometer { sd_rad });
        robot
    }
}

impl Answer {
    /// The answer in a sentence or two.
    #[must_use]
    pub fn sentence(&self, question: &Question) -> String {
        let Some(now) = self.position_m else {
            return "These poses and instruments leave something open: more poses or another instrument are needed.".to_owned();
        };
        let mm = |metres: f64| format!("{} mm", significant(1e3 * metres, 2));
        let laser = question.laser_sd_m.map_or_else(
            || "no laser".to_owned(),
            |sd| format!("a laser of {} (1 sd)", mm(sd)),
        );
        let begin = format!(
            "With {} poses and {laser}, the platform is off by {} in the root mean square.",
            question.poses,
            mm(now)
        );
        let gains = |to: &Option<f64>| to.map_or(0.0, |to| 1.0 - to / now);
        let best = self
            .changes
            .iter()
            .max_by(|a, b| gains(&a.1).total_cmp(&gains(&b.1)));
        match best {
            Some((what, Some(to))) if 1.0 - to / now >= WORTH => {
                format!("{begin} What gains most is {what}: {}.", mm(*to))
            }
            _ => format!("{begin} None of the changes below gains 5 %."),
        }
    }
}

#[cfg(test)]
mod tests {
    use tautline_core::robot::presets;

    use super::*;

    fn advisor(name: &str) -> Advisor {
        Advisor::new(&presets::find(name).expect("there").robot).expect("poses")
    }

    #[test]
    fn better_instruments_and_more_poses_make_no_worse() {
        for name in ["mini", "suspended"] {
            let advisor = advisor(name);
            let question = advisor.question();
            let answer = advisor.answer(&question).expect("an answer");
            let rises = |values: Vec<f64>| {
                values
                    .windows(2)
                    .all(|pair| pair[0] <= pair[1] * (1.0 + 1e-9))
            };
            assert!(
                rises(
                    answer
                        .over_laser
                        .iter()
                        .map(|(_, error)| error.expect("known"))
                        .collect()
                ),
                "{name}"
            );
            assert!(
                rises(
                    answer
                        .over_poses
                        .iter()
                        .rev()
                        .map(|(_, error)| error.expect("known"))
                        .collect()
                ),
                "{name}"
            );
            let now = answer.position_m.expect("known");
            assert!(
                answer
                    .changes
                    .iter()
                    .all(|(_, error)| error.expect("known") <= now * (1.0 + 1e-9)),
                "{name}"
            );
            assert!(
                answer
                    .sentence(&question)
                    .starts_with("With 25 poses and a laser of ")
            );
        }
    }

    #[test]
    fn the_answer_is_that_of_a_plan_at_the_same_poses() {
        let advisor = advisor("mini");
        let question = Question {
            poses: 12,
            ..advisor.question()
        };
        let answer = advisor.answer(&question).expect("an answer");
        let options = options(12, SEED, size_m(&advisor.robot));
        let plan = tautline_core::planning::evaluate(
            &advisor.robot,
            &advisor.poses[..12],
            &options,
            &mut |_| tautline_core::estimation::Control::Continue,
        );
        let expected = plan.expect("a plan").expected.criteria;
        assert_eq!(answer.position_m, expected.platform_m);
        assert_eq!(answer.entry_m, expected.mean_m);
    }
}
