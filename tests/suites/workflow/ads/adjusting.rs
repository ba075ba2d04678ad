//! Writing values while connections break: afterwards the controller holds all old or all new ones, and the message says which.

use std::time::Duration;

use serde_json::json;
use tautline_core::robot::presets;
use tautline_link::adjusting::{
    ControllerValues, Difference, plan_adjustment, settle_adjustment, write_adjustment,
    write_adjustment_reconnecting,
};
use tautline_link::ads::AdsOptions;
use tautline_link::parameters::parameters_of;
use tautline_link::reconnecting::{Attempts, BackOff, ReconnectPolicy};
use tautline_link::symbols::SymbolController;
use tautline_link::{Controller, GuardedController, LinkError};

use tautline_session::SymbolParameter;
use tautline_validation::support::ads::symbols::{Style, global, mapping};
use tautline_validation::support::ads::{Host, Plant, Protocol};

const VALUES: usize = 6;

/// Entry points of two cables, each coordinate moved by a millimetre or more.
fn new_values() -> Vec<(String, f64)> {
    let robot = presets::find("mini").expect("a preset").robot;
    let points = parameters_of(&robot)
        .into_iter()
        .filter(|p| p.name.contains("entry_point"));
    let moved = points.take(VALUES).zip(1..);
    moved
        .map(|(p, k)| (p.name, p.value + 1e-3 * f64::from(k)))
        .collect()
}

fn held(plant: &Plant) -> Vec<f64> {
    let names: Vec<String> = new_values().into_iter().map(|(name, _)| name).collect();
    let mut reader = plant.client();
    reader.connect().expect("connected");
    reader.read(&names).expect("values")
}

fn policy() -> Attempts<fn(f64)> {
    Attempts {
        back_off: BackOff::default(),
        attempts: 3,
        late_s: 0.0,
        wait: |_| (),
        gives_up: || false,
    }
}

/// After an attempt with a fault the controller holds the values that the message says.
fn attempt(
    protocol: Protocol,
    (kind, number, action): (&str, u64, &str),
    sums: bool,
) -> ControllerValues {
    let at = format!("{action} {kind} {number}, sums {sums}");
    let plant = Plant::speaking(protocol, Style::Arrays);
    let mut client = plant.armed();
    plant.server.order(json!({ "sums": sums }));
    let old = held(&plant);
    plant.server.fault(kind, number, action);
    let written = write_adjustment_reconnecting(&mut client, &new_values(), &mut policy());
    // Where the old values could not even be read nothing was written.
    let holds = written.map_or(ControllerValues::Old, |adjustment| adjustment.holds);
    let new: Vec<f64> = new_values().into_iter().map(|(_, value)| value).collect();
    let holds = match holds {
        ControllerValues::Mixed(names) => settled(&plant, client, (&old, &new), &names),
        holds => holds,
    };
    let now = held(&plant);
    match holds {
        ControllerValues::New => assert_eq!(now, new, "{at}"),
        ControllerValues::Old => assert_eq!(now, old, "{at}"),
        ref other => panic!("{at}: {other:?}"),
    }
    holds
}

/// A mixture of values is left until the operator arms the controller again.
fn settled(
    plant: &Plant,
    mut client: GuardedController<SymbolController>,
    (old, new): (&[f64], &[f64]),
    names: &[String],
) -> ControllerValues {
    assert!(!client.state().armed);
    let amid = held(plant);
    let others = amid.iter().zip(old).filter(|(now, old)| now != old);
    assert_eq!(others.count(), names.len());
    assert!(amid != new);
    client.arm().expect("armed");
    let named = |values: &[f64]| -> Vec<(String, f64)> {
        let names = new_values().into_iter().map(|(name, _)| name);
        names.zip(values.iter().copied()).collect()
    };
    let settled = settle_adjustment(&mut client, &named(old), &named(new));
    settled.expect("settled").holds
}

#[test]
fn the_connection_breaks_at_any_written_value() {
    // Singly written: as many requests as values.
    for number in 1..=VALUES as u64 {
        assert_eq!(
            attempt(Protocol::Ads, ("write", number, "before"), false),
            ControllerValues::Old,
            "{number}"
        );
        let after = attempt(Protocol::Ads, ("write", number, "after"), false);
        assert_eq!(
            after == ControllerValues::New,
            number == VALUES as u64,
            "{number}"
        );
    }
}

#[test]
fn the_connection_breaks_within_the_answer_to_any_written_value() {
    for number in 1..=VALUES as u64 {
        let held = attempt(Protocol::Ads, ("write", number, "half"), false);
        assert_eq!(
            held == ControllerValues::New,
            number == VALUES as u64,
            "{number}"
        );
    }
}

fn a_correction_that_the_model_lacks_is_ended(protocol: Protocol) {
    let plant = Plant::speaking(protocol, Style::Arrays);
    let held = [0.0, 0.0, 0.0201, 0.0, 0.0, 0.0, 0.0, 0.0];
    let symbol = global("winch_scale");
    plant
        .server
        .carry_out(json!({ "declare": [[symbol, "LREAL", 8, held]] }));
    let robot = &plant.preset.robot;
    let mut mapping = mapping(robot, Style::Arrays);
    mapping.parameters.push(SymbolParameter {
        name: "effect.winch_scale.{cable}.scale".into(),
        symbol,
        element: 0,
        stride: 1,
        scale: 1.0,
    });
    let mut client = plant.server.client(&mapping, robot, AdsOptions::default());
    client.connect().expect("connected");
    client.arm().expect("armed");
    let plan = plan_adjustment(&client.parameters().expect("values"), robot, None);
    assert_eq!(plan.iter().filter(|line| !line.in_model).count(), 8);
    let changes = plan.into_iter().filter(Difference::is_writable_change);
    let values: Vec<_> = changes
        .map(|line| (line.name, line.identified.expect("neutral")))
        .collect();
    assert_eq!(
        values,
        [("effect.winch_scale.cable-3.scale".to_owned(), 0.0)]
    );
    let written = write_adjustment(&mut client, &values).expect("an attempt");
    assert_eq!(written.holds, ControllerValues::New);
    let plan = plan_adjustment(&client.parameters().expect("values"), robot, None);
    assert!(!plan.iter().any(Difference::is_writable_change));
}

fn the_connection_breaks_while_all_values_are_written_at_once(protocol: Protocol) {
    assert_eq!(
        attempt(protocol, ("write", 1, "before"), true),
        ControllerValues::Old
    );
    assert_eq!(
        attempt(protocol, ("write", 1, "after"), true),
        ControllerValues::New
    );
    assert_eq!(
        attempt(protocol, ("write", 1, "half"), true),
        ControllerValues::New
    );
}

#[test]
fn the_connection_breaks_while_values_are_read_back() {
    // Old values twice, the release, new values.
    assert_eq!(
        attempt(Protocol::Ads, ("read", 1, "half"), true),
        ControllerValues::Old
    );
    assert_eq!(
        attempt(Protocol::Ads, ("read", 2, "half"), true),
        ControllerValues::Old
    );
    assert_eq!(
        attempt(Protocol::Ads, ("read", 3, "half"), true),
        ControllerValues::Old
    );
    assert_eq!(
        attempt(Protocol::Ads, ("read", 4, "half"), true),
        ControllerValues::New
    );
}

fn old_values_are_restored_if_one_cannot_be_written(protocol: Protocol) {
    let plant = Plant::speaking(protocol, Style::Single);
    let mut client = plant.armed();
    let old = held(&plant);
    let mut new = new_values();
    new[4].1 = f64::NAN;
    let adjustment = write_adjustment(&mut client, &new).expect("an attempt");
    assert_eq!(adjustment.holds, ControllerValues::Old);
    assert_eq!(held(&plant), old);
}

#[test]
fn an_interrupted_adjustment_can_be_settled_by_hand() {
    let plant = Plant::start(Style::Arrays);
    let mut client = plant.armed();
    plant.server.order(json!({"sums": false}));
    plant.server.fault("write", 3, "after");
    let adjustment = write_adjustment(&mut client, &new_values()).expect("an attempt");
    assert_eq!(adjustment.holds, ControllerValues::Unknown);
    client.connect().expect("connected again");
    let unarmed = settle_adjustment(&mut client, &adjustment.old, &new_values()).expect("settled");
    assert!(
        matches!(unarmed.holds, ControllerValues::Mixed(ref names) if names.len() == 3),
        "{unarmed:?}"
    );
    client.arm().expect("armed");
    let settled = settle_adjustment(&mut client, &adjustment.old, &new_values()).expect("settled");
    assert_eq!(settled.holds, ControllerValues::Old);
    let old: Vec<f64> = adjustment.old.iter().map(|(_, value)| *value).collect();
    assert_eq!(held(&plant), old);
}

#[test]
fn a_missing_controller_leaves_an_interrupted_adjustment_open() {
    let plant = Plant::start(Style::Arrays);
    let mut client = plant.armed();
    plant.server.fault("write", 1, "after");
    // The state is asked for before values are written; after that every new connection breaks.
    for _ in 0..3 {
        plant.server.fault("state", 2, "before");
    }
    let adjustment = write_adjustment_reconnecting(&mut client, &new_values(), &mut policy())
        .expect("an attempt");
    assert_eq!(adjustment.holds, ControllerValues::Unknown);
    let problem = adjustment.problem.expect("a problem");
    assert!(problem.contains("Reconnecting failed"), "{problem}");
    client.connect().expect("connected again");
    let settled = settle_adjustment(&mut client, &adjustment.old, &new_values()).expect("settled");
    assert_eq!(settled.holds, ControllerValues::New);
    plant
        .server
        .order(json!({"codes": {global("entry_point"): 0x723}}));
    assert!(settle_adjustment(&mut client, &adjustment.old, &new_values()).is_err());
}

/// Restarts the controller before it is connected again: everything is elsewhere then.
struct Restarting<'p>(&'p Plant, usize);

impl ReconnectPolicy for Restarting<'_> {
    fn restore(&mut self, controller: &mut dyn Controller) -> Result<(), LinkError> {
        if self.1 == 0 {
            self.0.server.order(json!({"restart": 0.1}));
        }
        self.1 += 1;
        policy().restore(controller)
    }

    fn pause(&mut self) {}
}

#[test]
fn the_controller_restarts_while_values_are_written() {
    let plant = Plant::start(Style::Arrays);
    let mut client = plant.armed();
    plant.server.order(json!({"sums": false}));
    let old = held(&plant);
    plant.server.fault("write", 4, "before");
    let mut policy = Restarting(&plant, 0);
    let adjustment = write_adjustment_reconnecting(&mut client, &new_values(), &mut policy);
    let holds = adjustment.expect("an attempt").holds;
    let ControllerValues::Mixed(names) = holds else {
        panic!("{holds:?}");
    };
    let new: Vec<f64> = new_values().into_iter().map(|(_, value)| value).collect();
    assert_eq!(
        settled(&plant, client, (&old, &new), &names),
        ControllerValues::Old
    );
    assert_eq!(held(&plant), old);
}

#[test]
fn a_write_arrives_after_the_reconnection() {
    let plant = Plant::start(Style::Arrays);
    let mut client = plant.client_with(AdsOptions {
        timeout_s: 1.5,
        ..AdsOptions::default()
    });
    client.connect().expect("connected");
    client.arm().expect("armed");
    plant.server.fault("write", 1, "late");
    let mut policy = Attempts {
        back_off: BackOff::default(),
        attempts: 3,
        late_s: 3.0,
        wait: |pause_s| std::thread::sleep(Duration::from_secs_f64(pause_s)),
        gives_up: || false,
    };
    let adjustment = write_adjustment_reconnecting(&mut client, &new_values(), &mut policy);
    // Old values were read first; then the late ones arrived.
    assert_eq!(adjustment.expect("an attempt").holds, ControllerValues::New);
    let new: Vec<f64> = new_values().into_iter().map(|(_, value)| value).collect();
    assert_eq!(held(&plant), new);
}

super::over_all! {
    a_correction_that_the_model_lacks_is_ended,
    the_connection_breaks_while_all_values_are_written_at_once,
    old_values_are_restored_if_one_cannot_be_written,
}
