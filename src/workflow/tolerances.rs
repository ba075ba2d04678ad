//! Tolerances of the parts of a robot for display: typical values in display units, and their influence on the readings.

use tautline_core::diagnosis::{DeviationSensitivity, deviation_sensitivities};
use tautline_core::effect::{Effect, EffectParameter, MachineClass, every_effect};
use tautline_core::measurement::Dataset;
use tautline_core::planning::USUAL_POSES;
use tautline_core::robot::{PartTolerances, Robot, StatedTolerances, Tolerance};
use tautline_core::simulation::{SimulationOptions, TrueGeometry, simulate};
use tautline_session::Session;

use crate::wording::count;
use crate::wording::units::{display_unit, unit_of};

/// Seed of the choice of poses over the workspace of a robot that has not been measured.
const SEED: u64 = 1;

/// A part that deviates from its description, named by the effect that describes the deviation.
#[derive(Debug, Clone, Copy)]
pub struct DeviatingPart {
    /// The effect.
    pub effect: &'static Effect,
    /// Typical tolerance for the robot's class of machine (SI unit); `None` where the catalogue has none.
    pub typical: Option<f64>,
    /// Source of the typical tolerance.
    pub source: Option<&'static str>,
    /// Display units per SI unit.
    pub per_si: f64,
    /// Display unit; may be empty.
    pub unit: &'static str,
}

/// All parts of a robot whose tolerance is one number, in the order of the catalogue. A frame that is both shifted and
/// turned has none.
pub fn deviating_parts(robot: &Robot) -> impl Iterator<Item = DeviatingPart> {
    let class = MachineClass::of(robot);
    let effects = every_effect().filter(|effect| effect.has_tolerance());
    effects.filter_map(move |effect| {
        let parameter = sizes(effect).next()?;
        if sizes(effect).any(|other| other.unit != parameter.unit) {
            return None;
        }
        let (per_si, unit) = display_unit(unit_of(parameter.name, parameter.unit));
        Some(DeviatingPart {
            effect,
            typical: parameter.tolerance.map(|typical| typical.sd(class)),
            source: parameter.tolerance.map(|typical| typical.source),
            per_si,
            unit: if unit == "degrees" { "°" } else { unit },
        })
    })
}

/// Parameters that measure the size of an effect, which all have its tolerance.
fn sizes(effect: &Effect) -> impl Iterator<Item = &'static EffectParameter> {
    let parameters = effect.parameters().iter().enumerate();
    let sizes = parameters.filter(|(k, _)| effect.is_size(*k));
    sizes.map(|(_, parameter)| parameter)
}

/// The typical tolerances of a robot as stated ones, to be changed.
#[must_use]
pub fn typical_as_stated(robot: &Robot) -> StatedTolerances {
    let typical = deviating_parts(robot).filter_map(|part| {
        let typical = Tolerance::Same(part.typical?);
        Some((part.effect.id().to_owned(), typical))
    });
    StatedTolerances {
        factor: 1.0,
        effects: typical.collect(),
    }
}

/// The class of machine of a robot: `a small machine (diagonal of the frame below 4 m)`.
#[must_use]
pub fn class_in_words(robot: &Robot) -> &'static str {
    match MachineClass::of(robot) {
        MachineClass::Small => "a small machine (diagonal of the frame below 4\u{a0}m)",
        MachineClass::Large => "a large machine (diagonal of the frame of 4\u{a0}m or more)",
    }
}

/// Changes of the readings of a robot by deviations of its parts.
#[derive(Debug, Clone)]
pub struct DeviationsInReadings {
    /// The poses of the readings: `41 measured poses`.
    pub poses: String,
    sensitivities: Vec<DeviationSensitivity>,
}

impl DeviationsInReadings {
    /// For the measured poses of a session, or for poses over the workspace where none are measured.
    ///
    /// # Errors
    /// One sentence, if the robot cannot hold poses or its readings do not suffice.
    pub fn of(session: &Session) -> Result<Self, String> {
        let measured = session.dataset();
        let away = measured.measurements.labels.iter().any(|label| *label != 0);
        let (dataset, poses) = match away {
            true => {
                let poses = count(measured.measurements.len(), "measured pose");
                (measured, poses)
            }
            false => (
                over_the_workspace(&session.robot)?,
                format!("{USUAL_POSES} poses of its workspace"),
            ),
        };
        let sensitivities = deviation_sensitivities(&dataset);
        Ok(Self {
            poses,
            sensitivities: sensitivities.map_err(|error| error.to_string())?,
        })
    }

    /// Largest change of a reading by a deviation of one tolerance, in standard deviations of the reading. `sd` is the
    /// tolerance of a part, on a cable or of the robot.
    #[must_use]
    pub fn largest(&self, robot: &Robot, effect: &Effect, sd: impl Fn(Option<&str>) -> f64) -> f64 {
        let own = self.sensitivities.iter();
        let own = own.filter(|one| one.effect.id() == effect.id());
        let changes = own.map(|one| {
            let cable = one.cable.and_then(|cable| robot.cables.get(cable));
            one.largest * sd(cable.map(|cable| cable.name.as_str()))
        });
        changes.fold(0.0, f64::max)
    }

    /// The same with the tolerances of a robot: the stated ones if there are any, otherwise the typical ones.
    #[must_use]
    pub fn of_part(&self, robot: &Robot, part: &DeviatingPart) -> f64 {
        self.largest(robot, part.effect, |cable| match &robot.tolerances {
            Some(PartTolerances::Stated(stated)) => {
                stated.factor * stated.sd_of(part.effect.id(), cable)
            }
            Some(PartTolerances::Typical(_)) | None => part.typical.unwrap_or(0.0),
        })
    }
}

/// Readings without noise of a robot as described.
fn over_the_workspace(robot: &Robot) -> Result<Dataset, String> {
    let mut described = robot.clone();
    described.effects.clear();
    described.deviations.clear();
    described.tolerances = None;
    let options = SimulationOptions {
        geometry: TrueGeometry::Nominal,
        noise: false,
        ..SimulationOptions::new(USUAL_POSES, SEED)
    };
    let run = simulate(&described, &options).map_err(|error| error.to_string())?;
    Ok(Dataset {
        robot: robot.clone(),
        measurements: run.dataset.measurements,
    })
}

#[cfg(test)]
mod tests {
    use tautline_core::robot::presets;
    use tautline_session::Timestamp;

    use super::*;
    use crate::templates::Template;

    #[test]
    fn one_number_states_the_tolerance_of_all_sizes_of_an_effect() {
        let robot = presets::find("mini").expect("a preset").robot;
        let shown: Vec<&str> = deviating_parts(&robot)
            .map(|part| part.effect.id())
            .collect();
        for effect in every_effect().filter(|effect| effect.has_tolerance()) {
            let first = sizes(effect).next().expect("a size");
            for other in sizes(effect) {
                assert_eq!(first.tolerance, other.tolerance, "{}", effect.id());
            }
            assert_eq!(
                shown.contains(&effect.id()),
                sizes(effect).all(|other| other.unit == first.unit),
                "{}",
                effect.id()
            );
        }
        assert!(!shown.contains(&"tracker_frame"), "metres and radians");
    }

    #[test]
    fn typical_tolerances_that_are_stated_are_the_same() {
        for mut robot in [
            Template::Spatial.robot([2.0, 1.6, 1.6]),
            Template::Suspended.robot([10.0, 8.0, 6.0]),
        ] {
            let all = |robot: &Robot| {
                let tolerances = robot.tolerances.as_ref().expect("tolerances");
                let deviations = tautline_core::effect::part_deviations(robot, tolerances);
                let deviations = deviations.into_iter();
                deviations
                    .map(|d| (d.bound.effect.id(), d.bound.cables, d.prior_sd))
                    .collect::<Vec<_>>()
            };
            let typical = all(&robot);
            robot.tolerances = Some(PartTolerances::Stated(typical_as_stated(&robot)));
            assert_eq!(all(&robot), typical);
        }
    }

    #[test]
    fn readings_are_those_measured_or_those_of_the_workspace() {
        for preset in presets::NAMES {
            let mut robot = presets::find(preset).expect("a preset").robot;
            robot.tolerances = Some(PartTolerances::typical());
            let session = Session::new("test", robot.clone(), Timestamp::from_unix_seconds(0));
            let found = DeviationsInReadings::of(&session).expect("readings");
            assert_eq!(found.poses, "25 poses of its workspace");
            let part = |id: &str| {
                let part = deviating_parts(&robot).find(|part| part.effect.id() == id);
                found.of_part(&robot, &part.expect("a part"))
            };
            // Drums and anchors that are off count on every robot; none has an inclinometer.
            for id in ["winch_scale", "platform_anchor"] {
                assert!(part(id) > 0.1, "{preset}, {id}: {}", part(id));
            }
            assert_eq!(part("inclinometer_tilt"), 0.0, "{preset}");

            let run = simulate(&robot, &SimulationOptions::new(30, 2)).expect("simulated");
            let mut measured = session;
            measured.measurements = run.dataset.measurements;
            let found = DeviationsInReadings::of(&measured).expect("readings");
            assert_eq!(found.poses, "31 measured poses");
        }
    }

    #[test]
    fn twice_the_tolerance_changes_readings_twice_as_much() {
        let robot = presets::find("mini").expect("a preset").robot;
        let session = Session::new("test", robot.clone(), Timestamp::from_unix_seconds(0));
        let found = DeviationsInReadings::of(&session).expect("readings");
        let effect = tautline_core::effect::find("winch_scale").expect("an effect");
        let once = found.largest(&robot, effect, |_| 2e-4);
        let of_one = found.largest(&robot, effect, |cable| match cable {
            Some("cable-3") => 4e-4,
            _ => 0.0,
        });
        assert!(of_one <= 2.0 * once && of_one > 0.5 * once);
        assert!((found.largest(&robot, effect, |_| 4e-4) / once - 2.0).abs() < 1e-12);
    }
}
