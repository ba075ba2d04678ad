//! Where the length of every cable goes at a pose: drum to pulley, around the pulley, to the platform; and what
//! tension, temperature and weight make of it.
//!
//! With the run `D` from drum to pulley, the wrapped part `rp theta`, the straight part `l_f` and the extra length by
//! sag `s`, the cable under load is `D + rp theta + l_f + s` long. It is what is left of the unstrained length `L0` of
//! [`CableLaw`]: `D + rp theta + l_f + s = L0 + elastic + other`, with the elastic part `L0 T / EA` (or the measured
//! elongation) and the part `L0 eps` of other strains. What the winch has paid out since home is `L0 - L0(home)`.
//!
//! Metres, radians, newtons. Effects of the model act as they do in the prediction, at the time and temperature of
//! the home pose.

use super::inverse::{LocatedCable, swivel_angle};
use super::{CablePath, KinematicsError, PulleyGeometry};
use crate::cable::{CableLaw, OutsideMeasuredRange};
use crate::effect::{BoundEffect, CablePorts, Circumstances, EffectError};
use crate::geometry::{Pose, Vec3};
use crate::measurement::Measurements;
use crate::robot::{Cable, Robot};

/// Why there is no budget.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BudgetError {
    /// A cable has no path.
    #[error(transparent)]
    Kinematics(#[from] KinematicsError),
    /// An effect of the model does not exist.
    #[error(transparent)]
    Effect(#[from] EffectError),
    /// Not one tension for each cable.
    #[error("found {found} tensions, expected one for each of the {expected} cables")]
    Tensions {
        /// Tensions given.
        found: usize,
        /// Cables.
        expected: usize,
    },
    /// A heavy cable without tension has no shape.
    #[error("{cable} has weight, but a tension of {tension_n} N does not hold it up")]
    Slack {
        /// Name of the cable.
        cable: String,
        /// Its tension (N).
        tension_n: f64,
    },
}

/// The length of one cable, part by part.
#[derive(Debug, Clone, PartialEq)]
pub struct CableBudget {
    /// Name of the cable.
    pub cable: String,
    /// From drum to pulley (m).
    pub run_m: f64,
    /// Around the pulley (m).
    pub wrapped_m: f64,
    /// Straight line from the pulley to the platform (m).
    pub free_m: f64,
    /// Longer than that line because it sags (m).
    pub sag_m: f64,
    /// All of it, under load (m).
    pub total_m: f64,
    /// Of that, stretched by tension (m).
    pub elastic_m: f64,
    /// Of that, by other strains: temperature, creep (m).
    pub other_strain_m: f64,
    /// What would be left without load (m).
    pub unstrained_m: f64,
    /// Unstrained cable paid out since home (m); `None` without a home pose and tensions there.
    pub paid_out_m: Option<f64>,
    /// Wrap angle (rad).
    pub wrap_rad: f64,
    /// Swivel angle (rad); `None` where the pulley has no zero direction.
    pub swivel_rad: Option<f64>,
    /// Set where the measured elongation had to be extrapolated: then the elastic part does not hold.
    pub outside_surface: Option<OutsideMeasuredRange>,
}

/// A cable as the model has it at one pose.
pub(super) struct ModelledCable {
    /// With the geometry that effects give it.
    pub cable: Cable,
    pub ports: CablePorts,
    pub located: LocatedCable,
    /// Where it is known.
    pub tension_n: Option<f64>,
}

/// All cables at a pose under tensions (N), as the effects of the model have them; those that have no path or no
/// tension to hold them up say so.
pub(super) fn modelled(
    robot: &Robot,
    pose: &Pose,
    tensions_n: &[Option<f64>],
) -> Result<Vec<Result<ModelledCable, BudgetError>>, BudgetError> {
    if tensions_n.len() != robot.cable_count() {
        return Err(BudgetError::Tensions {
            found: tensions_n.len(),
            expected: robot.cable_count(),
        });
    }
    let effects: Result<Vec<_>, _> = (robot.effects.iter())
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
    let circumstances = Circumstances::new(robot, &data, home, &poses, None);
    let known: Vec<f64> = tensions_n.iter().map(|t| t.unwrap_or(0.0)).collect();
    let ports = circumstances.cable_ports(poses.len() - 1, robot, &effects?, &known);
    let cables = robot.cables.iter().zip(ports).zip(tensions_n);
    Ok(cables
        .map(|((cable, ports), tension_n)| {
            let mut cable = cable.clone();
            ports.change_geometry(&mut cable);
            if let Some(slack) = tension_n.filter(|tension| tension.is_nan() || *tension <= 0.0)
                && ports.weight.value != 0.0
            {
                return Err(BudgetError::Slack {
                    cable: cable.name,
                    tension_n: slack,
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

impl ModelledCable {
    pub fn path(&self) -> &CablePath<f64> {
        &self.located.path
    }

    pub fn pulley(&self) -> &PulleyGeometry<f64> {
        &self.located.pulley
    }

    /// The law of its length under a tension; `down` is the direction of gravity.
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

    fn budget(&self, down: [f64; 3], tension_n: f64) -> Result<CableBudget, BudgetError> {
        let law = self.law(down, tension_n);
        let path = self.path();
        let unstrained = law.unstrained(path);
        let span = law.run + path.length;
        let total_m = span + unstrained.sag;
        let other_strain_m = unstrained.length * law.strain;
        let measured = law.surface.map(|s| s.evaluate(span, law.tension));
        Ok(CableBudget {
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

/// Direction of gravity, zero without any.
pub(super) fn down(robot: &Robot) -> Vec3 {
    robot.gravity().try_normalize(0.0).unwrap_or_default()
}

/// The length of every cable at `pose` under `tensions_n`, in the robot's order. With the tensions at home it is
/// told what the winches have paid out since.
///
/// # Errors
/// A cable that has no path or no tension to hold it up, an effect that does not exist, or tensions that are not
/// one for each cable.
pub fn cable_budget(
    robot: &Robot,
    pose: &Pose,
    tensions_n: &[f64],
    home_tensions_n: Option<&[f64]>,
) -> Result<Vec<CableBudget>, BudgetError> {
    let down: [f64; 3] = down(robot).into();
    let at = |pose: &Pose, tensions_n: &[f64]| -> Result<Vec<CableBudget>, BudgetError> {
        let known: Vec<_> = tensions_n.iter().copied().map(Some).collect();
        let cables = modelled(robot, pose, &known)?.into_iter().zip(tensions_n);
        cables
            .map(|(cable, tension_n)| cable?.budget(down, *tension_n))
            .collect()
    };
    let mut budgets = at(pose, tensions_n)?;
    if let (Some(home), Some(tensions_n)) = (&robot.home, home_tensions_n) {
        let from = at(&home.pose(), tensions_n)?;
        for (budget, from) in budgets.iter_mut().zip(from) {
            budget.paid_out_m = Some(budget.unstrained_m - from.unstrained_m);
        }
    }
    Ok(budgets)
}

#[cfg(test)]
#[path = "budget_tests.rs"]
mod tests;
