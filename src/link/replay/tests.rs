//! A recording is measured again and tells the same.

use super::*;
use crate::clock::ManualClock;
use crate::measuring::{MeasuringEvent, MeasuringOptions, MeasuringRun};
use crate::testing::{armed, drive, measured, preset, readings};

const POSES: usize = 6;

fn recording() -> Dataset {
    let preset = preset("mini");
    let (mut robot, clock) = armed(&preset, |_| ());
    measured(&preset, POSES, &mut robot, &clock)
}

fn replay(dataset: Dataset) -> (ReplayController, ManualClock) {
    let clock = ManualClock::default();
    let mut controller = ReplayController::new(dataset, Arc::new(clock.clone())).unwrap();
    controller.connect().unwrap();
    (controller, clock)
}

fn plan_of(dataset: &Dataset) -> Vec<(i64, Pose)> {
    let m = &dataset.measurements;
    let commanded = m.commanded.iter().map(|pose| pose.unwrap());
    m.labels.iter().copied().zip(commanded).collect()
}

#[test]
fn a_recording_that_is_measured_again_gives_its_readings_at_its_times() {
    let dataset = recording();
    let (mut controller, clock) = replay(dataset.clone());
    controller.arm().unwrap();
    let options = MeasuringOptions::of(&dataset.robot);
    let mut run = MeasuringRun::new(plan_of(&dataset), &dataset.robot, options);
    let events = drive(&mut run, &mut controller, &clock);
    assert_eq!(events.last(), Some(&MeasuringEvent::Finished));
    let again = readings(&events);
    let recorded = &dataset.measurements;
    assert_eq!(again.labels, recorded.labels);
    assert_eq!(again.revolutions, recorded.revolutions);
    assert_eq!(again.force_n, recorded.force_n);
    assert_eq!(again.laser_m, recorded.laser_m);
    for (now_s, then_s) in again.time_s.iter().zip(&recorded.time_s) {
        assert!((now_s - then_s).abs() < 1.0, "{now_s} {then_s}");
    }
}

#[test]
fn only_recorded_poses_can_be_commanded() {
    let dataset = recording();
    let (mut controller, clock) = replay(dataset.clone());
    let pose = dataset.measurements.commanded[3].unwrap();
    assert_eq!(controller.command(&pose), Err(LinkError::NotArmed));
    controller.arm().unwrap();
    let mut other = pose;
    other.position.x += 2e-3;
    let told = controller.command(&other).unwrap_err().to_string();
    assert!(told.contains("no pose was recorded at"), "{told}");
    assert!(
        told.contains("the nearest is pose 3 at a distance of 2.0 mm"),
        "{told}"
    );
    other.position.x = pose.position.x + 5e-5;
    controller.command(&other).unwrap();
    assert_eq!(controller.state().activity, Activity::Moving);
    clock.advance(60.0);
    assert_eq!(controller.state().activity, Activity::Still);
    let sample = controller.sample().unwrap();
    assert_eq!(
        sample.revolutions,
        dataset.measurements.revolutions.row(3).to_vec()
    );
}

#[test]
fn a_pose_recorded_twice_is_given_in_the_order_of_labels() {
    let mut dataset = recording();
    let again: Vec<usize> = (0..=POSES).chain([2]).collect();
    dataset.measurements = dataset.measurements.select(&again);
    dataset.measurements.labels[POSES + 1] = 100;
    dataset.measurements.laser_m[POSES + 1] += 0.01;
    let (mut controller, clock) = replay(dataset.clone());
    controller.arm().unwrap();
    let pose = dataset.measurements.commanded[2].unwrap();
    for row in [2, POSES + 1] {
        controller.command(&pose).unwrap();
        clock.advance(60.0);
        let laser_m = controller.sample().unwrap().laser_m;
        assert_eq!(laser_m, Some(dataset.measurements.laser_m[row]));
    }
}

#[test]
fn parameters_can_be_read_and_not_changed() {
    let dataset = recording();
    let (mut controller, _) = replay(dataset.clone());
    controller.arm().unwrap();
    let known = controller.parameters().unwrap();
    assert_eq!(known, parameters_of(&dataset.robot));
    let names = [known[5].name.clone()];
    assert_eq!(controller.read(&names), Ok(vec![known[5].value]));
    let told = controller.write(&[(known[5].name.clone(), 1.0)]);
    assert!(told.unwrap_err().to_string().contains("a recording"));
}

#[test]
fn what_cannot_be_played_back_is_refused() {
    let clock: Arc<dyn Clock> = Arc::new(ManualClock::default());
    let refused = |change: fn(&mut Dataset)| {
        let mut dataset = recording();
        change(&mut dataset);
        let made = ReplayController::new(dataset, Arc::clone(&clock));
        made.err().unwrap().to_string()
    };
    let told = refused(|d| d.measurements.commanded.clear());
    assert!(told.contains("which poses were commanded"), "{told}");
    let told = refused(|d| d.measurements = Default::default());
    assert!(told.contains("no poses"), "{told}");
    let told = refused(|d| {
        d.measurements.length_m = std::mem::take(&mut d.measurements.revolutions);
    });
    assert!(told.contains("no motor revolutions"), "{told}");
}
