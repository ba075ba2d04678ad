//! Budgets and drawings against closed forms.

use super::*;
use crate::cable::ElongationSurface;
use crate::effect::EffectSetting;
use crate::kinematics::{CableDetail, CableDrawing, cable_polyline, samples};
use crate::robot::presets;

/// One cable in the plane x, z: it comes up at the origin, over a pulley of 0.1 m, and goes down to the platform.
fn one_cable(radius_m: f64) -> Robot {
    let mut cable = samples::cable("one", Vec3::zeros(), Vec3::z(), radius_m, Vec3::zeros());
    cable.pulley.swivel_zero = Some([0.0, 1.0, 0.0]);
    samples::robot(&[crate::geometry::Coordinate::X], vec![cable])
}

fn at(x: f64, z: f64) -> Pose {
    Pose::from_parts([x, 0.0, z], [1.0, 0.0, 0.0, 0.0])
}

fn only<T>(mut all: Vec<T>) -> T {
    assert_eq!(all.len(), 1);
    all.remove(0)
}

fn close(value: f64, expected: f64) {
    assert!((value - expected).abs() < 1e-12, "{value} {expected}");
}

#[test]
fn a_cable_straight_down_wraps_half_a_turn() {
    // The anchor is two radii beside the axis and 3 m below: half a turn, then 3 m.
    let mut robot = one_cable(0.1);
    robot.cables[0].cable.axial_stiffness_n = Some(1e4);
    let budget = only(cable_budget(&robot, &at(0.2, -3.0), &[100.0], None).unwrap());
    let wrapped = 0.1 * std::f64::consts::PI;
    close(budget.wrapped_m, wrapped);
    close(budget.free_m, 3.0);
    close(budget.run_m, 0.6);
    close(budget.sag_m, 0.0);
    close(budget.total_m, 3.6 + wrapped);
    close(budget.unstrained_m, (3.6 + wrapped) / 1.01);
    close(budget.elastic_m, budget.unstrained_m * 0.01);
    close(budget.other_strain_m, 0.0);
    close(budget.wrap_rad, std::f64::consts::PI);
    // From y to x about z is a quarter turn back.
    close(budget.swivel_rad.unwrap(), -std::f64::consts::FRAC_PI_2);
    assert_eq!((budget.paid_out_m, budget.outside_surface), (None, None));
}

#[test]
fn a_heavy_cable_hangs_in_the_parabola_of_its_extra_length() {
    // An eyelet at the origin, the platform 4 m beside and 3 m below: chord 5 m, horizontal span 4 m.
    let mut robot = one_cable(0.0);
    robot.cables[0].cable.weight_n_per_m = 2.0;
    let pose = at(4.0, -3.0);
    let budget = only(cable_budget(&robot, &pose, &[500.0], None).unwrap());
    close(budget.sag_m, 4.0 * 16.0 * 5.0 / (24.0 * 500.0 * 500.0));
    close(budget.total_m, 0.6 + 5.0 + budget.sag_m);
    close(budget.unstrained_m, budget.total_m);

    let detail = CableDetail {
        span_parts: 2000,
        ..CableDetail::default()
    };
    let drawing = only(cable_polyline(&robot, &pose, &[Some(500.0)], &detail).unwrap()).unwrap();
    let hanging = &drawing.points[drawing.exit..];
    let length: f64 = hanging.windows(2).map(|p| (p[1] - p[0]).norm()).sum();
    // First order in the sag: the next term of the root is smaller by (slope)^2 / 4 = 2e-5, and the chords by 2e-7.
    let extra = length - 5.0;
    assert!(
        (extra / budget.sag_m - 1.0).abs() < 1e-4,
        "{extra} {}",
        budget.sag_m
    );
    // In the middle w l^2 / 8 T below the chord, across it.
    let middle = hanging[1000] - (hanging[0] + hanging[2000]) / 2.0;
    let across = Vec3::new(-0.6, 0.0, -0.8) * (0.8 * 2.0 * 25.0 / (8.0 * 500.0));
    assert!((middle - across).norm() < 1e-12, "{middle} {across}");
}

#[test]
fn payout_is_the_change_of_the_unstrained_length() {
    let preset = presets::find("mini").unwrap();
    let robot = preset.robot;
    let home = robot.home.unwrap().pose();
    let tensions = preset.tension.tensions(&robot, &home).unwrap().unwrap();
    let still = cable_budget(&robot, &home, &tensions, Some(&tensions)).unwrap();
    assert!(still.iter().all(|b| b.paid_out_m == Some(0.0)));
    let pose = Pose::from_parts([0.1, -0.05, 0.08], [1.0, 0.0, 0.0, 0.0]);
    let held = preset.tension.tensions(&robot, &pose).unwrap().unwrap();
    let moved = cable_budget(&robot, &pose, &held, Some(&tensions)).unwrap();
    for (budget, from) in moved.iter().zip(&still) {
        let change = budget.unstrained_m - from.unstrained_m;
        close(budget.paid_out_m.unwrap(), change);
        let parts = budget.run_m + budget.wrapped_m + budget.free_m + budget.sag_m;
        close(parts, budget.total_m);
        let left = budget.unstrained_m + budget.elastic_m + budget.other_strain_m;
        close(left, budget.total_m);
    }
}

#[test]
fn payout_is_what_a_simulated_winch_counts() {
    let preset = presets::find("suspended").unwrap();
    let mut robot = preset.robot;
    robot.effects.push(EffectSetting {
        effect: "pulley_radius".into(),
        targets: vec!["cable-2".into()],
        parameters: [("change".to_owned(), 0.004)].into(),
    });
    let options = crate::simulation::SimulationOptions {
        geometry: crate::simulation::TrueGeometry::Nominal,
        noise: false,
        workspace: Some(preset.workspace),
        tension: Some(preset.tension),
        ..crate::simulation::SimulationOptions::new(4, 9)
    };
    let data = crate::simulation::simulate(&robot, &options)
        .unwrap()
        .dataset
        .measurements;
    let tensions = |row: usize| data.truth.tension_n.row(row);
    for row in 1..data.len() {
        let pose = &data.truth.poses[row];
        let budgets = cable_budget(&robot, pose, tensions(row), Some(tensions(0))).unwrap();
        for (index, budget) in budgets.iter().enumerate() {
            let per_revolution = robot.cables[index].winch.cable_per_revolution_m();
            let counted = data.revolutions.get(row, index) * per_revolution;
            let off = budget.paid_out_m.unwrap() - counted;
            assert!(off.abs() < 1e-9, "{row} {index}: {off}");
        }
    }
}

#[test]
fn a_measured_elongation_replaces_the_stiffness() {
    let mut robot = one_cable(0.1);
    // Elongation 1 mm + 2 mm y for tensions 100 +- 50 N.
    robot.cables[0].cable.elongation_surface = Some(ElongationSurface {
        degree: 1,
        length_center_m: 4.0,
        length_scale_m: 2.0,
        tension_center_n: 100.0,
        tension_scale_n: 50.0,
        coefficients: vec![1e-3, 0.0, 2e-3],
        residual_sd_m: 1e-4,
    });
    let inside = only(cable_budget(&robot, &at(0.2, -3.0), &[125.0], None).unwrap());
    close(inside.elastic_m, 2e-3);
    assert_eq!(inside.outside_surface, None);
    let outside = only(cable_budget(&robot, &at(0.2, -3.0), &[300.0], None).unwrap());
    assert_eq!(outside.outside_surface.unwrap().quantity, "tension");
}

/// The drawing of a robot's cables touches what it should.
fn assert_drawn(robot: &Robot, pose: &Pose, drawings: &[CableDrawing]) {
    for (cable, drawing) in robot.cables.iter().zip(drawings) {
        let points = &drawing.points;
        let anchor = pose.transform(&cable.platform_anchor_m.into());
        assert!((points[points.len() - 1] - anchor).norm() < 1e-12);
        let entry = Vec3::from(cable.pulley.entry_point_m);
        assert!((points[1] - entry).norm() < 1e-12);
        assert!((points[0] - entry + drawing.swivel_axis * 0.1).norm() < 1e-12);
        for point in &points[1..=drawing.exit] {
            let spoke = point - drawing.pulley_centre;
            close(spoke.norm(), drawing.radius_m);
            close(spoke.dot(&drawing.pulley_axis), 0.0);
        }
        close(drawing.pulley_axis.norm(), 1.0);
    }
}

#[test]
fn drawings_follow_the_pulleys() {
    for name in presets::NAMES {
        let preset = presets::find(name).unwrap();
        let pose = preset.workspace.centre;
        let robot = &preset.robot;
        let tensions = preset.tension.tensions(robot, &pose).unwrap().unwrap();
        let detail = CableDetail::default();
        let known: Vec<_> = tensions.iter().copied().map(Some).collect();
        let drawings = cable_polyline(robot, &pose, &known, &detail).unwrap();
        let drawings: Vec<_> = drawings.into_iter().map(Result::unwrap).collect();
        assert_drawn(robot, &pose, &drawings);
        let budgets = cable_budget(robot, &pose, &tensions, None).unwrap();
        for (drawing, budget) in drawings.iter().zip(&budgets) {
            let arc = &drawing.points[1..=drawing.exit];
            let length: f64 = arc.windows(2).map(|p| (p[1] - p[0]).norm()).sum();
            // A chord is shorter than an arc of 0.1 rad by 0.1^2 / 24.
            assert!((length / budget.wrapped_m - 1.0).abs() < 5e-4);
        }
    }
}

#[test]
fn what_has_no_budget_is_said() {
    let mut robot = one_cable(0.1);
    let pose = at(0.5, -1.0);
    let none = cable_budget(&robot, &pose, &[], None).unwrap_err();
    assert_eq!(
        none.to_string(),
        "found 0 tensions, expected one for each of the 1 cables"
    );
    robot.cables[0].cable.weight_n_per_m = 1.0;
    let detail = CableDetail::default();
    let drawn = |tension| only(cable_polyline(&robot, &pose, &[tension], &detail).unwrap());
    assert!(matches!(drawn(Some(0.0)), Err(BudgetError::Slack { .. })));
    let straight = drawn(None).unwrap();
    assert_eq!(straight.points.len(), straight.exit + 2, "exit and anchor");
    let hanging = drawn(Some(1e-6)).unwrap();
    let [exit, middle, anchor] = [0, 12, 24].map(|k| hanging.points[hanging.exit + k]);
    let chord = anchor - exit;
    // The largest depth times the horizontal share of the chord: a cable straight down cannot sag.
    let depth = (middle - (exit + anchor) / 2.0).norm() / chord.norm();
    close(depth, 0.3 * chord.xy().norm() / chord.norm());
    let inside = cable_budget(&robot, &at(0.1, 0.0), &[10.0], None).unwrap_err();
    assert!(matches!(inside, BudgetError::Kinematics(_)));
}
