//! Breakdown of every cable's length at a pose: from drum to pulley, around the pulley, to the platform; and the strains
//! due to tension and temperature.
//!
//! With the run `D` from drum to pulley, the wrapped part `rp theta`, the straight part `l_f` and the extra length by
//! sag `s`, the cable under load is `D + rp theta + l_f + s` long. It follows from the unstrained length `L0` of
//! [`CableLaw`]: `D + rp theta + l_f + s = L0 + elastic + other`, with the elastic part `L0 T / EA` (or the measured
//! elongation) and the part `L0 eps` of other strains. The winch has paid out `L0 - L0(home)` since home.
//!
//! Metres, radians, newtons. Effects of the model act as they do in the prediction, at the time and temperature of
//! the home pose.

use super::inverse::{LocatedCable, swivel_angle};
use super::{CablePath, KinematicsError, PulleyGeometry};
use crate::cable::{CableLaw, OutsideMeasuredRange};
use crate::effect::{BetterKnown, BoundEffect, CablePorts, EffectError, PoseContexts};
use crate::geometry::{Pose, Vec3};
use crate::measurement::Measurements;
use crate::robot::{Cable, Robot};

/// Errors of [`length_breakdown`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LengthBreakdownError {
    /// A cable has no path.
    #[error(transparent)]
    Kinematics(#[from] KinematicsError),
    /// An effect of the model does not exist.
    #[error(transparent)]
    Effect(#[from] EffectError),
    /// The number of tensions is not that of the cables.
    #[error("found {found} tensions, expected one for each of the {expected} cables")]
    Tensions {
        /// Number of tensions.
        found: usize,
        /// Number of cables.
        expected: usize,
    },
    /// A cable with weight has no tension, and so no shape.
    #[error("{cable} has weight, but its tension of {tension_n} N is not positive")]
    Slack {
        /// Name of the cable.
        cable: String,
        /// Its tension (N).
        tension_n: f64,
    },
}

/// Parts of one cable's length.
#[derive(Debug, Clone, PartialEq)]
pub struct LengthBreakdown {
    /// Name of the cable.
    pub cable: String,
    /// Length from drum to pulley (m).
    pub run_m: f64,
    /// Length around the pulley (m).
    pub wrapped_m: f64,
    /// Length of the straight line from the pulley to the platform (m).
    pub free_m: f64,
    /// Extra length by sag (m).
    pub sag_m: f64,
    /// Total length under load (m).
    pub total_m: f64,
    /// Elastic elongation due to tension (m), part of the total.
    pub elastic_m: f64,
    /// Elongation due to other strains, such as temperature and creep (m), part of the total.
    pub other_strain_m: f64,
    /// Unstrained length (m).
    pub unstrained_m: f64,
    /// Unstrained length paid out since home (m); `None` without a home pose and tensions there.
    pub paid_out_m: Option<f64>,
    /// Wrap angle (rad).
    pub wrap_rad: f64,
    /// Swivel angle (rad); `None` if the pulley has no zero direction.
    pub swivel_rad: Option<f64>,
    /// Set if the measured elongation had to be extrapolated; the elastic part is then not valid.
    pub outside_surface: Option<OutsideMeasuredRange>,
}

/// A cable at one pose, under the effects of the model.
pub(super) struct ModelledCable {
    /// The cable with the geometry modified by effects.
    pub cable: Cable,
    pub ports: CablePorts,
    pub located: LocatedCable,
    /// Tension, if known.
    pub tension_n: Option<f64>,
}

/// All cables at a pose under tensions (N) and the effects of the model; a cable without a path, or with weight but no
/// tension, is an error of its own.
pub(super) fn modelled_cables(
    robot: &Robot,
    pose: &Pose,
    tensions_n: &[Option<f64>],
) -> Result<Vec<Result<ModelledCable, LengthBreakdownError>>, LengthBreakdownError> {
    if tensions_n.len() != robot.cable_count() {
        return Err(LengthBreakdownError::Tensions {
            found: tensions_n.len(),
            expected: robot.cable_count(),
        });
    }
    let effects: Result<Vec<_>, _> = robot
        .effects_and_deviations()
        .map(|setting| BoundEffect::from_setting(setting, robot))
        .collect();
    let poses: Vec<Pose> = (robot.home.iter().map(|home| home.pose()))
        .chain([*pose])
        .collect();
    let data = Measurements {
        labels: (0..poses.len()).map(|row| row as i64).collect(),
        ..Measurements::default()
    };
    let home = robot.home.map(|_| 0);
    let contexts = PoseContexts::new(robot, &data, home, &poses, BetterKnown::default());
    let known: Vec<f64> = tensions_n.iter().map(|t| t.unwrap_or(0.0)).collect();
    let ports = contexts.cable_ports(poses.len() - 1, robot, &effects?, &known);
    let cables = robot.cables.iter().zip(ports).zip(tensions_n);
    Ok(cables
        .map(|((cable, ports), tension_n)| {
            let mut cable = cable.clone();
            ports.change_geometry(&mut cable);
            let is_taut = |tension: f64| tension > 0.0;
            if let Some(tension_n) = *tension_n
                && ports.weight.value != 0.0
                && !is_taut(tension_n)
            {
                return Err(LengthBreakdownError::Slack {
                    cable: cable.name,
                    tension_n,
                });
            }
            Ok(ModelledCable {
                located: LocatedCable::new(&cable, pose)?,
                cable,
                ports,
                tension_n: *tension_n,
            })
        })
        .collect())
}

/// The robot with the geometry and the stiffness that its effects give it at a pose, and without effects.
///
/// # Errors
/// If a cable has no path, or an effect does not exist.
pub fn effective_geometry(robot: &Robot, pose: &Pose) -> Result<Robot, LengthBreakdownError> {
    let mut effective = robot.clone();
    let cables = modelled_cables(robot, pose, &vec![None; robot.cable_count()])?;
    for (own, modelled) in effective.cables.iter_mut().zip(cables) {
        let ModelledCable { cable, ports, .. } = modelled?;
        *own = cable;
        let compliance = ports.compliance.value;
        own.cable.axial_stiffness_n = (compliance > 0.0).then(|| compliance.recip());
    }
    effective.effects.clear();
    effective.deviations.clear();
    Ok(effective)
}

impl ModelledCable {
    pub fn path(&self) -> &CablePath<f64> {
        &self.located.path
    }

    pub fn pulley(&self) -> &PulleyGeometry<f64> {
        &self.located.pulley
    }

    /// Law of the cable's length under a tension; `down` is the direction of gravity.
    fn law(&self, down: [f64; 3], tension_n: f64) -> CableLaw<'_, f64> {
        CableLaw {
            run: self.cable.winch.length_to_pulley_m,
            tension: tension_n,
            compliance: self.ports.compliance.value,
            strain: self.ports.strain.value,
            weight: Some(self.ports.weight.value).filter(|weight| *weight != 0.0),
            down,
            surface: self.cable.cable.elongation_surface.as_ref(),
        }
    }

    fn breakdown(
        &self,
        down: [f64; 3],
        tension_n: f64,
    ) -> Result<LengthBreakdown, LengthBreakdownError> {
        let law = self.law(down, tension_n);
        let path = self.path();
        let unstrained = law.unstrained(path);
        let span = law.run + path.length;
        let total_m = span + unstrained.sag;
        let other_strain_m = unstrained.length * law.strain;
        let measured = law.surface.map(|s| s.evaluate(span, law.tension));
        Ok(LengthBreakdown {
            run_m: law.run,
            wrapped_m: self.pulley().radius * path.wrap,
            free_m: path.free_length,
            sag_m: unstrained.sag,
            total_m,
            elastic_m: total_m - unstrained.length - other_strain_m,
            other_strain_m,
            unstrained_m: unstrained.length,
            paid_out_m: None,
            wrap_rad: path.wrap,
            swivel_rad: swivel_angle(&self.cable, path)?,
            outside_surface: measured.and_then(Result::err),
            cable: self.cable.name.clone(),
        })
    }
}

/// Direction of gravity; zero without gravity.
pub(super) fn down(robot: &Robot) -> Vec3 {
    robot.gravity().try_normalize(0.0).unwrap_or_default()
}

/// Breaks down the length of every cable at `pose` under `tensions_n`, in the robot's order. With the tensions at
/// home, the length paid out since then is included.
///
/// # Errors
/// If a cable has no path, or weight but no tension, an effect does not exist, or the number of tensions is not that
/// of the cables.
pub fn length_breakdown(
    robot: &Robot,
    pose: &Pose,
    tensions_n: &[f64],
    home_tensions_n: Option<&[f64]>,
) -> Result<Vec<LengthBreakdown>, LengthBreakdownError> {
    let down: [f64; 3] = down(robot).into();
    let at =
        |pose: &Pose, tensions_n: &[f64]| -> Result<Vec<LengthBreakdown>, LengthBreakdownError> {
            let known: Vec<_> = tensions_n.iter().copied().map(Some).collect();
            let cables = modelled_cables(robot, pose, &known)?
                .into_iter()
                .zip(tensions_n);
            cables
                .map(|(cable, tension_n)| cable?.breakdown(down, *tension_n))
                .collect()
        };
    let mut breakdowns = at(pose, tensions_n)?;
    if let (Some(home), Some(tensions_n)) = (&robot.home, home_tensions_n) {
        let from = at(&home.pose(), tensions_n)?;
        for (breakdown, from) in breakdowns.iter_mut().zip(from) {
            breakdown.paid_out_m = Some(breakdown.unstrained_m - from.unstrained_m);
        }
    }
    Ok(breakdowns)
}

#[cfg(test)]
mod tests {
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
        let breakdown = only(length_breakdown(&robot, &at(0.2, -3.0), &[100.0], None).unwrap());
        let wrapped = 0.1 * std::f64::consts::PI;
        close(breakdown.wrapped_m, wrapped);
        close(breakdown.free_m, 3.0);
        close(breakdown.run_m, 0.6);
        close(breakdown.sag_m, 0.0);
        close(breakdown.total_m, 3.6 + wrapped);
        close(breakdown.unstrained_m, (3.6 + wrapped) / 1.01);
        close(breakdown.elastic_m, breakdown.unstrained_m * 0.01);
        close(breakdown.other_strain_m, 0.0);
        close(breakdown.wrap_rad, std::f64::consts::PI);
        // From y to x about z is a quarter turn back.
        close(breakdown.swivel_rad.unwrap(), -std::f64::consts::FRAC_PI_2);
        assert_eq!(
            (breakdown.paid_out_m, breakdown.outside_surface),
            (None, None)
        );
    }

    #[test]
    fn a_heavy_cable_hangs_in_the_parabola_of_its_extra_length() {
        // An eyelet at the origin, the platform 4 m beside and 3 m below: chord 5 m, horizontal span 4 m.
        let mut robot = one_cable(0.0);
        robot.cables[0].cable.weight_n_per_m = 2.0;
        let pose = at(4.0, -3.0);
        let breakdown = only(length_breakdown(&robot, &pose, &[500.0], None).unwrap());
        close(breakdown.sag_m, 4.0 * 16.0 * 5.0 / (24.0 * 500.0 * 500.0));
        close(breakdown.total_m, 0.6 + 5.0 + breakdown.sag_m);
        close(breakdown.unstrained_m, breakdown.total_m);

        let detail = CableDetail {
            span_parts: 2000,
            ..CableDetail::default()
        };
        let drawing =
            only(cable_polyline(&robot, &pose, &[Some(500.0)], &detail).unwrap()).unwrap();
        let hanging = &drawing.points[drawing.exit..];
        let length: f64 = hanging.windows(2).map(|p| (p[1] - p[0]).norm()).sum();
        // First order in the sag: the next term of the root is smaller by (slope)^2 / 4 = 2e-5, and the chords by 2e-7.
        let extra = length - 5.0;
        assert!(
            (extra / breakdown.sag_m - 1.0).abs() < 1e-4,
            "{extra} {}",
            breakdown.sag_m
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
        let still = length_breakdown(&robot, &home, &tensions, Some(&tensions)).unwrap();
        assert!(still.iter().all(|b| b.paid_out_m == Some(0.0)));
        let pose = Pose::from_parts([0.1, -0.05, 0.08], [1.0, 0.0, 0.0, 0.0]);
        let held = preset.tension.tensions(&robot, &pose).unwrap().unwrap();
        let moved = length_breakdown(&robot, &pose, &held, Some(&tensions)).unwrap();
        for (breakdown, from) in moved.iter().zip(&still) {
            let change = breakdown.unstrained_m - from.unstrained_m;
            close(breakdown.paid_out_m.unwrap(), change);
            let parts = breakdown.run_m + breakdown.wrapped_m + breakdown.free_m + breakdown.sag_m;
            close(parts, breakdown.total_m);
            let left = breakdown.unstrained_m + breakdown.elastic_m + breakdown.other_strain_m;
            close(left, breakdown.total_m);
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
            let breakdowns =
                length_breakdown(&robot, pose, tensions(row), Some(tensions(0))).unwrap();
            for (index, breakdown) in breakdowns.iter().enumerate() {
                let per_revolution = robot.cables[index].winch.cable_per_revolution_m();
                let counted = data.revolutions.get(row, index) * per_revolution;
                let off = breakdown.paid_out_m.unwrap() - counted;
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
        let inside = only(length_breakdown(&robot, &at(0.2, -3.0), &[125.0], None).unwrap());
        close(inside.elastic_m, 2e-3);
        assert_eq!(inside.outside_surface, None);
        let outside = only(length_breakdown(&robot, &at(0.2, -3.0), &[300.0], None).unwrap());
        assert_eq!(outside.outside_surface.unwrap().quantity, "tension");
    }

    /// Checks that the drawings of the cables touch anchors and pulleys.
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
            let breakdowns = length_breakdown(robot, &pose, &tensions, None).unwrap();
            for (drawing, breakdown) in drawings.iter().zip(&breakdowns) {
                let arc = &drawing.points[1..=drawing.exit];
                let length: f64 = arc.windows(2).map(|p| (p[1] - p[0]).norm()).sum();
                // A chord is shorter than an arc of 0.1 rad by 0.1^2 / 24.
                assert!((length / breakdown.wrapped_m - 1.0).abs() < 5e-4);
            }
        }
    }

    #[test]
    fn what_has_no_budget_is_said() {
        let mut robot = one_cable(0.1);
        let pose = at(0.5, -1.0);
        let none = length_breakdown(&robot, &pose, &[], None).unwrap_err();
        assert_eq!(
            none.to_string(),
            "found 0 tensions, expected one for each of the 1 cables"
        );
        robot.cables[0].cable.weight_n_per_m = 1.0;
        let detail = CableDetail::default();
        let drawn = |tension| only(cable_polyline(&robot, &pose, &[tension], &detail).unwrap());
        assert!(matches!(
            drawn(Some(0.0)),
            Err(LengthBreakdownError::Slack { .. })
        ));
        let straight = drawn(None).unwrap();
        assert_eq!(straight.points.len(), straight.exit + 2, "exit and anchor");
        let hanging = drawn(Some(1e-6)).unwrap();
        let [exit, middle, anchor] = [0, 12, 24].map(|k| hanging.points[hanging.exit + k]);
        let chord = anchor - exit;
        // The largest depth times the horizontal share of the chord: a cable straight down cannot sag.
        let depth = (middle - (exit + anchor) / 2.0).norm() / chord.norm();
        close(depth, 0.3 * chord.xy().norm() / chord.norm());
        let inside = length_breakdown(&robot, &at(0.1, 0.0), &[10.0], None).unwrap_err();
        assert!(matches!(inside, LengthBreakdownError::Kinematics(_)));
    }
}
