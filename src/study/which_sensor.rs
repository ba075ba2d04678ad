//! Choice of sensor and number of poses: predictions from the expected covariance alone, fast enough to follow a slider.

use tautline_core::planning::{Accuracy, PoseSet, USUAL_POSES, expect, random_poses};
use tautline_core::robot::{Inclinometer, Robot};
use tautline_workflow::wording::units::significant;

use crate::cell::options;
use crate::scaling::size_m;

/// Maximum number of poses.
pub const MOST_POSES: usize = 100;
/// Numbers of poses on the curve.
const POSES: [usize; 9] = [5, 8, 12, 18, 25, 35, 50, 70, 100];
/// Standard deviations of lasers on the curve (m).
pub const LASERS_M: [f64; 7] = [0.05e-3, 0.1e-3, 0.2e-3, 0.5e-3, 1e-3, 2e-3, 5e-3];
/// Standard deviation of the proposed inclinometer (rad).
const INCLINOMETER_RAD: f64 = 0.5e-3;
/// Minimum relative gain that is mentioned.
const WORTH: f64 = 0.05;
/// Seed of the poses.
const SEED: u64 = 1;

/// Instruments and number of poses to be assessed.
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

/// Predicted accuracy for a [`Question`], and the gain by changes.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// Root mean square position error over the workspace (m); `None` if parameters are undetermined.
    pub position_m: Option<f64>,
    /// Root mean square standard deviation of the entry points (m).
    pub entry_m: Option<f64>,
    /// Standard deviation of other lasers (m), and the position error with each (m).
    pub over_laser: Vec<(f64, Option<f64>)>,
    /// Other numbers of poses, and the position error with each (m).
    pub over_poses: Vec<(usize, Option<f64>)>,
    /// Single improvements, and the position error with each (m).
    pub changes: Vec<(&'static str, Option<f64>)>,
}

/// Predicts the accuracy of a robot over a fixed sequence of poses.
#[derive(Debug, Clone)]
pub struct Advisor {
    robot: Robot,
    /// The part that does not depend on instruments: poses with tensions, and the prior of the geometry.
    set: PoseSet,
}

impl Advisor {
    /// Draws the poses; each question uses the first ones.
    ///
    /// # Errors
    /// If the robot can hold too few poses or there is nothing to identify.
    pub fn new(robot: &Robot) -> Result<Self, String> {
        let options = options(MOST_POSES, SEED, size_m(robot));
        let set = random_poses(robot, &options).and_then(|poses| expect(robot, &poses, &options));
        Ok(Self {
            set: set.map_err(|error| error.to_string())?,
            robot: robot.clone(),
        })
    }

    /// The question for the instruments in the description of the robot.
    #[must_use]
    pub fn question(&self) -> Question {
        Question {
            laser_sd_m: self.robot.laser.map(|laser| laser.sd_m),
            poses: USUAL_POSES,
            home_sd_m: self.robot.home.map_or(0.0, |home| home.position_sd_m),
            inclinometer_sd_rad: self.robot.inclinometer.map(|sensor| sensor.sd_rad),
        }
    }

    /// Answers a question.
    ///
    /// # Errors
    /// If there is nothing to identify or a pose cannot be held.
    pub fn answer(&self, question: &Question) -> Result<Answer, String> {
        let more = (2 * question.poses).min(MOST_POSES);
        let mut counts = POSES.to_vec();
        counts.extend([question.poses, more]);
        counts.sort_unstable();
        let known = self.accuracy(question, &counts)?;
        let after = |poses: usize| {
            let place = counts.iter().position(|count| *count == poses);
            known[place.unwrap_or(0)]
        };
        let with = |changed: Question| {
            let accuracy = self.accuracy(&changed, &[changed.poses])?;
            Ok::<_, String>(accuracy[0].platform_m)
        };
        let lasers: &[f64] = match (question.laser_sd_m, self.robot.laser) {
            (Some(_), Some(_)) => &LASERS_M,
            _ => &[],
        };
        let over_laser = lasers.iter().map(|sd_m| {
            let changed = Question {
                laser_sd_m: Some(*sd_m),
                ..*question
            };
            Ok((*sd_m, with(changed)?))
        });
        let mut changes = vec![("twice as many poses", after(more).platform_m)];
        for (what, changed) in improved(question) {
            changes.push((what, with(changed)?));
        }
        let now = after(question.poses);
        Ok(Answer {
            position_m: now.platform_m,
            entry_m: now.mean_m,
            over_laser: over_laser.collect::<Result<_, String>>()?,
            over_poses: POSES.map(|poses| (poses, after(poses).platform_m)).into(),
            changes,
        })
    }

    /// Accuracy after each of these ascending numbers of poses.
    fn accuracy(&self, question: &Question, counts: &[usize]) -> Result<Vec<Accuracy>, String> {
        let robot = self.asked(question);
        let most = counts.last().copied().unwrap_or(0);
        let options = options(most, SEED, size_m(&robot));
        let set = self.set.measured_by(&robot, most, &options);
        Ok(set
            .map_err(|error| error.to_string())?
            .accuracy_after(counts))
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

/// Variants of the question with one instrument improved or added, each with its name.
fn improved(question: &Question) -> Vec<(&'static str, Question)> {
    let mut improved = Vec::new();
    if let Some(sd_m) = question.laser_sd_m {
        let better = Question {
            laser_sd_m: Some(0.5 * sd_m),
            ..*question
        };
        improved.push(("a laser twice as accurate", better));
    }
    if question.home_sd_m > 0.0 {
        let better = Question {
            home_sd_m: 0.5 * question.home_sd_m,
            ..*question
        };
        improved.push(("the home pose known twice as well", better));
    }
    if question.inclinometer_sd_rad.is_none() {
        let more = Question {
            inclinometer_sd_rad: Some(INCLINOMETER_RAD),
            ..*question
        };
        improved.push(("an inclinometer of 0.5 mrad", more));
    }
    improved
}

impl Answer {
    /// The answer in one or two sentences.
    #[must_use]
    pub fn sentence(&self, question: &Question) -> String {
        let Some(now) = self.position_m else {
            return "These poses and instruments leave parameters undetermined: add poses or another instrument.".to_owned();
        };
        let mm = |metres: f64| format!("{} mm", significant(1e3 * metres, 2));
        let laser = question.laser_sd_m.map_or_else(
            || "no laser".to_owned(),
            |sd| format!("a laser of {} (1 sd)", mm(sd)),
        );
        let begin = format!(
            "With {} poses and {laser}, the position error of the platform is {} rms.",
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
                format!("{begin} The largest gain comes from {what}: {}.", mm(*to))
            }
            _ => format!("{begin} None of the changes below gains 5 %."),
        }
    }
}

#[cfg(test)]
mod tests {
    use tautline_core::estimation::Control;
    use tautline_core::planning::evaluate;
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
        let all = super::options(MOST_POSES, SEED, size_m(&advisor.robot));
        let poses = random_poses(&advisor.robot, &all).expect("poses");
        let plan = evaluate(&advisor.robot, &poses[..12], &options, &mut |_| {
            Control::Continue
        });
        let expected = plan.expect("a plan").expected.criteria;
        // Readings at more poses are computed together, which rounds differently.
        let same = |a: Option<f64>, b: Option<f64>| {
            (a.expect("known") / b.expect("known") - 1.0).abs() < 1e-9
        };
        assert!(same(answer.position_m, expected.platform_m));
        assert!(same(answer.entry_m, expected.mean_m));
    }
}
