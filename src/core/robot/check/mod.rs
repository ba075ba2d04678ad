//! Consistency of a robot description.
//!
//! Checks of single fields are in `field`, those of several fields together (pulleys,
//! anchors, size of the frame) in `layout`.

mod field;
mod layout;
mod tolerances;

use super::description::inertia_matrix;
use super::{Cable, Home, HomePlatform, Laser, Limits, Platform, Robot, Tracker};
use crate::cable::ElongationSurface;
use crate::effect::{BoundEffect, EffectSetting, Hypothesis, MAX_HYPOTHESES};
use crate::kinematics::MAX_CABLES;
use field::Object;
use nalgebra::Matrix6;

/// Largest asymmetry of a correlation matrix that rounding can cause.
const SYMMETRY: f64 = 1e-9;
/// Smallest pivot of a correlation matrix that counts as invertible.
const LEAST_PIVOT: f64 = 1e-6;

/// An invalid field of a robot description.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{pointer}: {message}")]
pub struct FieldError {
    /// JSON pointer to the field, such as `/cables/3/pulley/radius_m`.
    pub pointer: String,
    /// What was found and what was expected, in one sentence.
    pub message: String,
}

type Checked = Result<(), FieldError>;

impl Robot {
    /// Checks a description for all errors that can be found without measurements.
    ///
    /// # Errors
    /// The first invalid field.
    pub fn check(&self) -> Result<(), FieldError> {
        let root = Object::root();
        root.not_blank("name", &self.name)?;
        if let Some(number) = &self.serial_number {
            root.not_blank("serial_number", number)?;
        }
        root.vector("gravity_m_s2", &self.gravity_m_s2)?;
        if self.gravity().norm() > 100.0 {
            return root.fail("gravity_m_s2", "found more than 100 m/s^2, expected m/s^2");
        }
        if let Some(home) = &self.home {
            check_home(&root.child("home"), home)?;
        }
        check_platform(&root.child("platform"), &self.platform)?;
        if let Some(limits) = &self.limits {
            check_limits(&root.child("limits"), limits)?;
        }
        self.check_instruments(&root)?;
        self.check_cables(&root)?;
        self.check_layout()?;
        self.check_wrench_sd(&root)?;
        if let Some(home_platform) = &self.home_platform {
            check_home_platform(&root.child("home_platform"), home_platform)?;
        }
        self.check_hypotheses(&root)?;
        self.check_effects(&root.child("effects"), &self.effects)?;
        self.check_effects(&root.child("deviations"), &self.deviations)?;
        tolerances::check(self, &root.child("tolerances"))
    }

    fn check_instruments(&self, root: &Object) -> Checked {
        if let Some(laser) = &self.laser {
            check_laser(&root.child("laser"), laser)?;
        }
        if let Some(inclinometer) = &self.inclinometer {
            root.child("inclinometer")
                .positive("sd_rad", inclinometer.sd_rad)?;
        }
        if let Some(tracker) = &self.tracker {
            check_tracker(&root.child("tracker"), tracker)?;
        }
        Ok(())
    }

    fn check_cables(&self, root: &Object) -> Checked {
        let count = self.cables.len();
        if !(1..=MAX_CABLES).contains(&count) {
            let message = format!("found {count} cables, expected 1 to {MAX_CABLES}");
            return root.fail("cables", message);
        }
        let list = root.child("cables");
        for (index, cable) in self.cables.iter().enumerate() {
            let object = list.child(index);
            object.not_blank("name", &cable.name)?;
            if let Some(first) = self.cable_index(&cable.name).filter(|first| *first < index) {
                let message = format!(
                    "found the name {:?} of /cables/{first} again, expected a name of its own",
                    cable.name
                );
                return object.fail("name", message);
            }
            check_cable(&object, cable)?;
        }
        Ok(())
    }

    /// The default is a fraction of the weight, so without gravity the standard deviation must be stated.
    fn check_wrench_sd(&self, root: &Object) -> Checked {
        let stated = self.platform.wrench_sd.is_some();
        let needed = self.has_tensions();
        if needed && !stated && self.gravity().norm() == 0.0 {
            let message = "not given, expected one because without gravity it has no default";
            return root.child("platform").fail("wrench_sd", message);
        }
        Ok(())
    }

    fn check_hypotheses(&self, root: &Object) -> Checked {
        let all = &self.hypotheses;
        if all.len() > MAX_HYPOTHESES {
            let message = format!("found {}, expected at most {MAX_HYPOTHESES}", all.len());
            return root.fail("hypotheses", message);
        }
        let list = root.child("hypotheses");
        let mut ids: Vec<String> = Vec::new();
        for (index, text) in all.iter().enumerate() {
            let id = match Hypothesis::parse(text) {
                Ok(hypothesis) => hypothesis.id().to_owned(),
                Err(error) => return list.fail(index, error.to_string()),
            };
            if ids.contains(&id) {
                let message = format!("found the id \"{id}\" again, expected one of its own");
                return list.fail(index, message);
            }
            ids.push(id);
        }
        Ok(())
    }

    fn check_effects(&self, list: &Object, effects: &[EffectSetting]) -> Checked {
        for (index, effect) in effects.iter().enumerate() {
            self.check_effect(&list.child(index), effect)?;
            if let Err(error) = BoundEffect::from_setting(effect, self) {
                return list.fail(index, error.to_string());
            }
        }
        Ok(())
    }

    fn check_effect(&self, object: &Object, effect: &EffectSetting) -> Checked {
        object.not_blank("effect", &effect.effect)?;
        for (k, target) in effect.targets.iter().enumerate() {
            if self.cable_index(target).is_none() {
                let message = format!("found {target:?}, expected the name of a cable");
                return object.child("targets").fail(k, message);
            }
            if effect.targets[..k].contains(target) {
                let message = format!("found {target:?} again, expected each cable once");
                return object.child("targets").fail(k, message);
            }
        }
        let parameters = object.child("parameters");
        for (name, value) in &effect.parameters {
            parameters.finite(name, *value)?;
        }
        Ok(())
    }
}

fn check_home(object: &Object, home: &Home) -> Checked {
    object.vector("position_m", &home.position_m)?;
    object.quaternion("orientation_wxyz", &home.orientation_wxyz)?;
    object.not_negative("position_sd_m", home.position_sd_m)?;
    object.not_negative("orientation_sd_rad", home.orientation_sd_rad)?;
    match home.covariance {
        Some(rows) => check_covariance(object, &rows),
        None => Ok(()),
    }
}

/// The covariance mixes metres and radians, so symmetry and rank are judged in units of its own standard deviations.
fn check_covariance(object: &Object, rows: &[[f64; 6]; 6]) -> Checked {
    let list = object.child("covariance");
    for (k, row) in rows.iter().enumerate() {
        list.vector(k, row)?;
        list.child(k).positive(k, row[k])?;
    }
    let correlation = Matrix6::from_fn(|i, k| rows[i][k] / (rows[i][i] * rows[k][k]).sqrt());
    let is_symmetric = (correlation - correlation.transpose()).amax() < SYMMETRY;
    let factor = correlation.cholesky();
    let least = factor.map_or(0.0, |factor| factor.l_dirty().diagonal().min());
    if is_symmetric && least > LEAST_PIVOT {
        return Ok(());
    }
    let message =
        "found a matrix that is not a covariance, expected a symmetric and positive definite one";
    object.fail("covariance", message)
}

fn check_platform(object: &Object, platform: &Platform) -> Checked {
    if platform.free.is_empty() {
        return object.fail("free", "found no coordinate, expected at least one");
    }
    for (k, coordinate) in platform.free.iter().enumerate() {
        if platform.free[..k].contains(coordinate) {
            let message = format!(
                "found {} again, expected each coordinate once",
                coordinate.describe()
            );
            return object.child("free").fail(k, message);
        }
    }
    if let Some(mass_kg) = platform.mass_kg {
        object.positive("mass_kg", mass_kg)?;
    }
    object.vector("center_of_mass_m", &platform.center_of_mass_m)?;
    if let Some(inertia) = &platform.inertia_kg_m2 {
        object.vector("inertia_kg_m2", inertia)?;
        if inertia_matrix(inertia).cholesky().is_none() {
            let message = "found an impossible inertia, expected [xx yy zz xy xz yz] of a positive definite matrix";
            return object.fail("inertia_kg_m2", message);
        }
    }
    if let Some(sd) = &platform.wrench_sd {
        let object = object.child("wrench_sd");
        object.positive("force_n", sd.force_n)?;
        object.positive("torque_nm", sd.torque_nm)?;
    }
    Ok(())
}

fn check_limits(object: &Object, limits: &Limits) -> Checked {
    if let Some(workspace) = &limits.workspace {
        let object = object.child("workspace");
        let center = object.child("center");
        center.vector("position_m", &workspace.center.position_m)?;
        center.quaternion("orientation_wxyz", &workspace.center.orientation_wxyz)?;
        for (k, half) in workspace.half_extent_m.iter().enumerate() {
            object.child("half_extent_m").not_negative(k, *half)?;
        }
        object.not_negative("half_rotation_rad", workspace.half_rotation_rad)?;
    }
    if let Some(tension) = &limits.tension {
        let object = object.child("tension");
        object.not_negative("lower_n", tension.lower_n)?;
        object.finite("reference_n", tension.reference_n)?;
        object.finite("upper_n", tension.upper_n)?;
        let within = tension.lower_n..=tension.upper_n;
        if !within.contains(&tension.reference_n) || within.start() == within.end() {
            let message = format!(
                "found {}, expected a tension from lower_n to upper_n, which is larger",
                tension.reference_n
            );
            return object.fail("reference_n", message);
        }
    }
    Ok(())
}

fn check_laser(object: &Object, laser: &Laser) -> Checked {
    object.vector("origin_m", &laser.origin_m)?;
    object.unit_vector("direction", &laser.direction)?;
    object.positive("sd_m", laser.sd_m)?;
    let plane = object.child("target_plane");
    plane.unit_vector("normal", &laser.target_plane.normal)?;
    plane.finite("offset_m", laser.target_plane.offset_m)?;
    match laser.target_plane.offset_sd_m {
        Some(sd) => plane.not_negative("offset_sd_m", sd),
        None => Ok(()),
    }
}

fn check_tracker(object: &Object, tracker: &Tracker) -> Checked {
    for sd in tracker.position_sd_m.each() {
        object.positive("position_sd_m", sd)?;
    }
    match tracker.orientation_sd_rad {
        Some(sd) => object.positive("orientation_sd_rad", sd),
        None => Ok(()),
    }
}

fn check_cable(object: &Object, cable: &Cable) -> Checked {
    check_pulley(&object.child("pulley"), cable)?;
    object.vector("platform_anchor_m", &cable.platform_anchor_m)?;
    let winch = object.child("winch");
    winch.positive("drum_diameter_m", cable.winch.drum_diameter_m)?;
    winch.below("drum_diameter_m", cable.winch.drum_diameter_m, 10.0)?;
    winch.not_negative("drum_pitch_m", cable.winch.drum_pitch_m)?;
    winch.below("drum_pitch_m", cable.winch.drum_pitch_m, 1.0)?;
    winch.positive("gear_ratio", cable.winch.gear_ratio)?;
    winch.not_negative("length_to_pulley_m", cable.winch.length_to_pulley_m)?;
    winch.positive("length_sd_m", cable.winch.length_sd_m)?;
    let material = object.child("cable");
    if let Some(stiffness_n) = cable.cable.axial_stiffness_n {
        material.positive("axial_stiffness_n", stiffness_n)?;
    }
    material.not_negative("weight_n_per_m", cable.cable.weight_n_per_m)?;
    let surface = cable.cable.elongation_surface.as_ref();
    if let Some(message) = surface.and_then(ElongationSurface::check) {
        return material.fail("elongation_surface", message);
    }
    if let Some(sensor) = &cable.force_sensor {
        let object = object.child("force_sensor");
        object.not_zero("tension_gain", sensor.tension_gain)?;
        object.finite("bias_n", sensor.bias_n)?;
        object.positive("tension_sd_n", sensor.tension_sd_n)?;
    }
    Ok(())
}

fn check_pulley(object: &Object, cable: &Cable) -> Checked {
    let pulley = &cable.pulley;
    object.vector("entry_point_m", &pulley.entry_point_m)?;
    for sd in pulley.entry_point_sd_m.each().into_iter().flatten() {
        object.not_negative("entry_point_sd_m", sd)?;
    }
    object.unit_vector("swivel_axis", &pulley.swivel_axis)?;
    if let Some(zero) = &pulley.swivel_zero {
        object.unit_vector("swivel_zero", zero)?;
        object.not_parallel("swivel_zero", zero, "swivel_axis", &pulley.swivel_axis)?;
    }
    if let Some(sd) = pulley.swivel_sd_rad {
        object.positive("swivel_sd_rad", sd)?;
    }
    object.not_negative("radius_m", pulley.radius_m)?;
    object.below("radius_m", pulley.radius_m, 5.0)
}

fn check_home_platform(object: &Object, platform: &HomePlatform) -> Checked {
    let frame = object.child("base_from_reference");
    frame.vector("position_m", &platform.base_from_reference.position_m)?;
    frame.quaternion(
        "orientation_wxyz",
        &platform.base_from_reference.orientation_wxyz,
    )?;
    object.count("sensors", platform.sensors.len(), 6)?;
    object.count("planes", platform.planes.len(), 3)?;
    let planes = object.child("planes");
    for (k, plane) in platform.planes.iter().enumerate() {
        let object = planes.child(k);
        object.unit_vector("normal", &plane.normal)?;
        object.finite("offset_m", plane.offset_m)?;
        for (other, earlier) in platform.planes[..k].iter().enumerate() {
            let name = format!("the normal of plane {other}");
            object.not_parallel("normal", &plane.normal, &name, &earlier.normal)?;
        }
    }
    check_home_sensors(object, platform)
}

/// Six distances determine six coordinates only if every plane has a sensor and none more than three.
fn check_home_sensors(object: &Object, platform: &HomePlatform) -> Checked {
    let sensors = object.child("sensors");
    let mut sensors_on_plane = [0; 3];
    for (k, sensor) in platform.sensors.iter().enumerate() {
        let object = sensors.child(k);
        object.vector("origin_m", &sensor.origin_m)?;
        object.unit_vector("direction", &sensor.direction)?;
        object.positive("sd_m", sensor.sd_m)?;
        match sensors_on_plane.get_mut(sensor.plane) {
            Some(count) => *count += 1,
            None => {
                let message = format!("found {}, expected 0, 1 or 2", sensor.plane);
                return object.fail("plane", message);
            }
        }
        if let Some(curve) = &sensor.curve {
            let object = object.child("curve");
            object.not_zero("a", curve.a)?;
            object.finite("b", curve.b)?;
            object.finite("c", curve.c)?;
        }
    }
    for (plane, count) in sensors_on_plane.iter().enumerate() {
        if !(1..=3).contains(count) {
            let message = format!("found {count} sensors on plane {plane}, expected 1 to 3");
            return object.fail("sensors", message);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
