//! Tests of writing to a simulated controller that fails in every way.

use super::*;
use crate::reconnecting::{Attempts, BackOff};
use crate::simulated::{Fault, SimulatedRobot};
use crate::testing::{armed, identified, measured, preset};
use crate::{GuardedController, ManualClock};

fn robot(faults: Vec<Fault>) -> (GuardedController<SimulatedRobot>, ManualClock) {
    let (mut robot, clock) = armed(&preset("mini"), |_| ());
    robot.inner_mut().set_faults(faults);
    (robot, clock)
}

fn new_values() -> Vec<(String, f64)> {
    let names = ["x", "y", "z"].map(|axis| format!("cable-2.entry_point.{axis}_m"));
    names.into_iter().zip([-0.49, -0.37, -0.45]).collect()
}

fn held(robot: &mut GuardedController<SimulatedRobot>) -> Vec<f64> {
    let names: Vec<String> = new_values().into_iter().map(|(name, _)| name).collect();
    robot.read(&names).unwrap()
}

const OLD: [f64; 3] = [-0.5, -0.378, -0.4415];

fn attempt(faults: Vec<Fault>) -> (Adjustment, GuardedController<SimulatedRobot>) {
    let (mut robot, _) = robot(faults);
    let adjustment = write_adjustment(&mut robot, &new_values()).unwrap();
    let old: Vec<f64> = adjustment.old.iter().map(|(_, value)| *value).collect();
    assert_eq!(old, OLD);
    (adjustment, robot)
}

fn differs(times: usize) -> Fault {
    Fault::WriteDiffers {
        name: "cable-2.entry_point.y_m".into(),
        by: 1e-6,
        times,
    }
}

#[test]
fn all_values_arrive() {
    let (adjustment, mut robot) = attempt(Vec::new());
    assert_eq!(
        (adjustment.holds, adjustment.problem),
        (ControllerValues::New, None)
    );
    assert_eq!(held(&mut robot), vec![-0.49, -0.37, -0.45]);
}

#[test]
fn a_write_that_fails_midway_is_taken_back() {
    for after in 0..3 {
        let (adjustment, mut robot) = attempt(vec![Fault::WriteFails { after }]);
        assert_eq!(adjustment.holds, ControllerValues::Old);
        assert!(adjustment.problem.unwrap().contains("did not answer"));
        assert_eq!(held(&mut robot), OLD);
    }
}

#[test]
fn a_value_that_arrives_changed_is_taken_back() {
    let (adjustment, mut robot) = attempt(vec![differs(1)]);
    assert_eq!(adjustment.holds, ControllerValues::Old);
    let problem = adjustment.problem.unwrap();
    assert!(problem.contains("cable-2.entry_point.y_m"), "{problem}");
    assert_eq!(held(&mut robot), OLD);
}

#[test]
fn nothing_more_is_written_once_another_program_has_armed() {
    let new = new_values();
    // After three values all were written and read back, but the other program may change them.
    for after in 0..=3 {
        let (mut robot, _) = robot(vec![Fault::AnotherArms { after }]);
        let mut waited = Vec::new();
        let mut policy = attempts(2, &mut waited);
        let adjustment = write_adjustment_reconnecting(&mut robot, &new, &mut policy).unwrap();
        drop(policy);
        let written = new[..after].iter().map(|(name, _)| name.clone());
        let expected = match after {
            0 => ControllerValues::Old,
            _ => ControllerValues::Mixed(written.collect()),
        };
        assert_eq!(adjustment.holds, expected);
        let problem = adjustment.problem.unwrap();
        assert!(problem.contains("another program is armed"), "{problem}");
        // Nothing was rolled back, and nobody reconnected.
        let held = held(&mut robot);
        let written = held.iter().zip(OLD).filter(|(now, old)| **now != *old);
        assert_eq!((written.count(), waited.len()), (after, 0));
        assert!(matches!(robot.arm(), Err(LinkError::Occupied(_))));
    }
}

#[test]
fn old_values_that_cannot_be_brought_back_are_named() {
    let (adjustment, _) = attempt(vec![differs(9)]);
    let names = vec!["cable-2.entry_point.y_m".to_owned()];
    assert_eq!(adjustment.holds, ControllerValues::Mixed(names));
    let by_hand = format!("by hand: cable-2.entry_point.y_m = {}.", OLD[1]);
    let advice = adjustment.advice;
    assert!(advice.ends_with(&by_hand), "{advice} lacks {by_hand}");
}

#[test]
fn after_a_lost_connection_nothing_is_claimed() {
    let (adjustment, mut robot) = attempt(vec![Fault::WriteDisconnects { after: 1 }]);
    assert_eq!(adjustment.holds, ControllerValues::Unknown);
    assert!(adjustment.advice.contains("connect and arm it again"));
    robot.inner_mut().set_faults(Vec::new());
    robot.connect().unwrap();
    robot.arm().unwrap();
    let again = write_adjustment(&mut robot, &adjustment.old).unwrap();
    assert_eq!(again.holds, ControllerValues::New);
    assert_eq!(held(&mut robot), OLD);
}

#[test]
fn a_controller_that_is_not_armed_is_left_alone() {
    let (mut robot, _) = robot(Vec::new());
    robot.disarm();
    assert_eq!(
        write_adjustment(&mut robot, &new_values()),
        Err(LinkError::NotArmed)
    );
    robot.arm().unwrap();
    let unknown = [("cable-9.pulley.radius_m".to_owned(), 1.0)];
    assert!(matches!(
        write_adjustment(&mut robot, &unknown),
        Err(LinkError::UnknownParameter(_))
    ));
}

#[test]
fn differences_have_the_deviations_of_what_was_estimated() {
    let preset = preset("mini");
    let (mut robot, clock) = armed(&preset, |_| ());
    let data = measured(&preset, 8, &mut robot, &clock);
    let solution = identified(&data);
    let model = solution.globals.model(&preset.robot);
    let held = robot.parameters().unwrap();
    let plan = plan_adjustment(&held, &model, Some(&solution));
    let changed: Vec<_> = plan.iter().filter(|d| d.is_writable_change()).collect();
    // Entry points, plane offset and home pose; nothing else was estimated.
    assert_eq!(changed.len(), 8 * 3 + 1 + 6);
    assert!(changed.iter().all(|d| d.sd.is_some_and(|sd| sd > 0.0)));
    assert!(
        plan.iter()
            .filter(|d| d.sd.is_none())
            .all(|d| d.difference == Some(0.0))
    );
    let without = plan_adjustment(&held[..3], &model, None);
    assert!(without[3..].iter().all(|d| !d.is_writable_change()));
}

#[test]
fn every_parameter_of_the_controller_is_a_line() {
    let model = preset("mini").robot;
    let mut held = parameters_of(&model);
    held.extend(
        [("winch_scale.cable-3.scale", 0.0201), ("unknown.size", 1.5)].map(|(name, value)| {
            ParameterInfo {
                name: format!("effect.{name}"),
                unit: "1",
                value,
            }
        }),
    );
    let plan = plan_adjustment(&held, &model, None);
    assert_eq!(plan.len(), held.len());
    let changes: Vec<_> = plan
        .iter()
        .filter(|line| line.is_writable_change())
        .collect();
    let [scale] = changes[..] else {
        panic!("{changes:?}");
    };
    assert_eq!(scale.name, "effect.winch_scale.cable-3.scale");
    assert_eq!((scale.in_model, scale.identified), (false, Some(0.0)));
    // The neutral value of the other effect is unknown.
    let unknown: Vec<_> = plan
        .iter()
        .filter(|line| line.is_unknown_effect())
        .collect();
    assert_eq!((unknown.len(), unknown[0].controller), (1, Some(1.5)));
}

fn attempts(attempts: u32, waited: &mut Vec<f64>) -> Attempts<impl FnMut(f64)> {
    Attempts {
        back_off: BackOff::default(),
        attempts,
        late_s: 3.0,
        wait: |pause_s| waited.push(pause_s),
        gives_up: || false,
    }
}

#[test]
fn a_lost_connection_is_made_anew_and_only_the_operator_arms_it() {
    let (mut robot, _) = robot(vec![Fault::WriteDisconnects { after: 1 }]);
    let mut waited = Vec::new();
    let mut policy = attempts(2, &mut waited);
    let new = new_values();
    let adjustment = write_adjustment_reconnecting(&mut robot, &new, &mut policy).unwrap();
    drop(policy);
    assert_eq!(
        adjustment.holds,
        ControllerValues::Mixed(vec![new[0].0.clone()])
    );
    assert!(adjustment.advice.contains("Arm the controller again"));
    let problem = adjustment.problem.unwrap();
    assert!(problem.contains("connection"), "{problem}");
    assert!(!robot.state().armed);
    // The same was read twice, a pause apart.
    assert_eq!(waited.iter().filter(|pause| **pause == 3.0).count(), 1);
    robot.inner_mut().set_faults(Vec::new());
    robot.arm().unwrap();
    let settled = settle_adjustment(&mut robot, &adjustment.old, &new).unwrap();
    assert_eq!(settled.holds, ControllerValues::Old);
    assert_eq!(held(&mut robot), OLD);
}

#[test]
fn nobody_waits_for_a_controller_once_it_is_given_up() {
    let (mut robot, _) = robot(vec![Fault::WriteDisconnects { after: 1 }]);
    let mut policy = Attempts {
        back_off: BackOff::default(),
        attempts: 9,
        late_s: 3.0,
        wait: |_| (),
        gives_up: || true,
    };
    let adjustment = write_adjustment_reconnecting(&mut robot, &new_values(), &mut policy);
    let adjustment = adjustment.unwrap();
    assert_eq!(adjustment.holds, ControllerValues::Unknown);
    assert!(adjustment.problem.unwrap().contains("interrupted"));
}

/// A controller that holds values that are not numbers, and misreads values: one of the replacements at each reading in turn.
struct Odd(Vec<(String, f64)>, Vec<Option<(&'static str, f64)>>);

impl Controller for Odd {
    fn identity(&self) -> String {
        "odd".to_owned()
    }
    fn connect(&mut self) -> Result<(), LinkError> {
        Ok(())
    }
    fn disconnect(&mut self) {}
    fn state(&self) -> crate::ControllerState {
        crate::ControllerState {
            activity: crate::Activity::Still,
            armed: true,
        }
    }
    fn arm(&mut self) -> Result<(), LinkError> {
        Ok(())
    }
    fn disarm(&mut self) {}
    fn sample(&mut self) -> Result<crate::Sample, LinkError> {
        Err(LinkError::NotArmed)
    }
    fn home(&mut self) -> Result<(), LinkError> {
        Ok(())
    }
    fn command(&mut self, _: &tautline_core::geometry::Pose) -> Result<(), LinkError> {
        Ok(())
    }
    fn stop(&mut self) -> Result<(), LinkError> {
        Ok(())
    }
    fn parameters(&mut self) -> Result<Vec<ParameterInfo>, LinkError> {
        let held = self.0.iter();
        let held = held.map(|(name, value)| ParameterInfo {
            name: name.clone(),
            unit: "m",
            value: *value,
        });
        Ok(held.collect())
    }
    fn read(&mut self, names: &[String]) -> Result<Vec<f64>, LinkError> {
        let wrong = (!self.1.is_empty()).then(|| self.1.remove(0)).flatten();
        let value = |name: &String| match wrong {
            Some((misread, value)) if misread == name => Some(value),
            _ => {
                let held = self.0.iter().find(|held| held.0 == *name);
                held.map(|held| held.1)
            }
        };
        Ok(names.iter().filter_map(value).collect())
    }
    fn write(&mut self, values: &[(String, f64)]) -> Result<(), LinkError> {
        for (name, value) in values {
            assert!(value.is_finite(), "{name}");
            // The value that is called "stuck" never changes.
            let held = self
                .0
                .iter_mut()
                .find(|held| held.0 == *name && name != "stuck");
            held.into_iter().for_each(|held| held.1 = *value);
        }
        Ok(())
    }
}

#[test]
fn what_is_no_number_is_overwritten_and_cannot_be_restored() {
    let named = |values: [f64; 3]| -> Vec<(String, f64)> {
        let names = ["a", "b", "stuck"].map(str::to_owned);
        names.into_iter().zip(values).collect()
    };
    let mut odd = Odd(named([f64::NAN, 1.0, 3.0]), Vec::new());
    let new = named([4.0, 5.0, 3.0]);
    let written = write_adjustment(&mut odd, &new).unwrap();
    assert_eq!(written.holds, ControllerValues::New);
    let advice = written.advice;
    assert!(
        advice.ends_with("that were not numbers before: a."),
        "{advice}"
    );
    // If one value is not taken over, the others are restored, as far as they were numbers.
    let mut odd = Odd(named([f64::INFINITY, 1.0, 3.0]), Vec::new());
    let adjustment = write_adjustment(&mut odd, &named([4.0, 5.0, 6.0])).unwrap();
    assert_eq!(adjustment.holds, ControllerValues::Old);
    assert!(
        adjustment
            .advice
            .contains("not numbers and cannot be written: a.")
    );
    assert_eq!(odd.0, named([4.0, 1.0, 3.0]));
}

#[test]
fn a_single_wrong_reading_is_no_old_value() {
    let held = || -> Vec<(String, f64)> {
        let names = ["a", "b"].map(str::to_owned);
        names.into_iter().zip([1.0, 2.0]).collect()
    };
    let new: Vec<(String, f64)> = held()
        .into_iter()
        .map(|(name, v)| (name, v + 0.5))
        .collect();
    for wrong in [f64::NAN, f64::INFINITY, 0.0] {
        for before in 0..2 {
            let mut misread = vec![None; before];
            misread.push(Some(("b", wrong)));
            let mut odd = Odd(held(), misread.clone());
            let written = write_adjustment(&mut odd, &new).unwrap();
            assert_eq!(written.old, held(), "{wrong} at reading {before}");
            assert_eq!(written.holds, ControllerValues::New);
            let mut odd = Odd(held(), misread);
            let read = read_parameters(&mut odd).unwrap();
            let values: Vec<f64> = read.iter().map(|p| p.value).collect();
            assert_eq!(values, [1.0, 2.0]);
        }
    }
    // Readings that never agree are no reason to overwrite anything.
    let misread = vec![Some(("b", 0.0)), None, Some(("b", 0.0)), None];
    let mut odd = Odd(held(), misread);
    let told = write_adjustment(&mut odd, &new).unwrap_err().to_string();
    assert!(told.contains("b = 0, then 2"), "{told}");
    assert_eq!(odd.0, held());
}

#[test]
fn old_values_that_changed_since_they_were_read_are_named() {
    let old = [("a".to_owned(), 1.0), ("b".to_owned(), 2.0)];
    let mut odd = Odd(old.to_vec(), Vec::new());
    check_unchanged(&mut odd, &old).unwrap();
    odd.0[1].1 = 2.5;
    let told = check_unchanged(&mut odd, &old).unwrap_err().to_string();
    assert!(told.contains("(b = 2)"), "{told}");
}

#[test]
fn a_controller_that_does_not_come_back_is_told_so() {
    let (mut robot, _) = robot(vec![Fault::WriteDisconnects { after: 1 }]);
    struct Never;
    impl ReconnectPolicy for Never {
        fn restore(&mut self, _: &mut dyn Controller) -> Result<(), LinkError> {
            Err(LinkError::Timeout {
                request: "for its state".to_owned(),
                seconds: 1.0,
            })
        }
        fn pause(&mut self) {}
    }
    let adjustment = write_adjustment_reconnecting(&mut robot, &new_values(), &mut Never).unwrap();
    assert_eq!(adjustment.holds, ControllerValues::Unknown);
    assert!(adjustment.problem.unwrap().contains("Reconnecting failed"));
}

#[test]
fn what_a_controller_holds_is_settled() {
    let new = new_values();
    let names = new.iter().map(|(name, _)| name.clone());
    let old: Vec<(String, f64)> = names.zip(OLD).collect();
    let (mut robot, _) = robot(Vec::new());
    let settled = settle_adjustment(&mut robot, &old, &new).unwrap();
    assert_eq!(settled.holds, ControllerValues::Old);
    robot.write(&new).unwrap();
    let settled = settle_adjustment(&mut robot, &old, &new).unwrap();
    assert_eq!(settled.holds, ControllerValues::New);
    robot.write(&old[..2]).unwrap();
    robot.disarm();
    let settled = settle_adjustment(&mut robot, &old, &new).unwrap();
    assert_eq!(
        settled.holds,
        ControllerValues::Mixed(vec![old[2].0.clone()])
    );
    robot.arm().unwrap();
    let settled = settle_adjustment(&mut robot, &old, &new).unwrap();
    assert_eq!(settled.holds, ControllerValues::Old);
    assert_eq!(held(&mut robot), OLD);
}
