//! Display form of a controller's parameters, for the adjustment table and the report.

use tautline_core::effect;
use tautline_core::robot::Cable;
use tautline_link::parameters::EffectName;

use super::cable_label;
use super::units::unit_of;

/// Index of the cable that a parameter belongs to.
pub fn cable_of(cables: &[Cable], name: &str) -> Option<usize> {
    let is_of = |cable: &Cable| match EffectName::read(name) {
        Some(name) => name.targets == cable.name,
        None => is_of(name, &cable.name),
    };
    // A name may begin with that of another cable.
    let all = cables.iter().enumerate().filter(|(_, cable)| is_of(cable));
    let longest = all.max_by_key(|(_, cable)| cable.name.len());
    longest.map(|(index, _)| index)
}

fn is_of(name: &str, cable: &str) -> bool {
    name.strip_prefix(cable)
        .is_some_and(|rest| rest.starts_with('.'))
}

/// SI unit of a parameter with `unit` in files; `None` for counts, such as the pose from which an effect acts.
pub fn unit<'a>(name: &str, unit: &'a str) -> Option<&'a str> {
    let Some(name) = EffectName::read(name) else {
        return Some(unit);
    };
    let parameters = effect::find(name.effect).map_or(&[][..], |e| e.parameters());
    match parameters.iter().find(|p| p.name == name.parameter) {
        Some(parameter) if parameter.discrete => None,
        _ => Some(unit_of(name.parameter, unit)),
    }
}

/// Display name of a parameter, which may belong to one of these cables.
pub fn title(name: &str, cables: &[Cable]) -> String {
    if let Some(name) = EffectName::read(name) {
        return effect_title(name);
    }
    let cable = cable_of(cables, name).and_then(|index| Some((index, cables.get(index)?)));
    match cable {
        Some((index, cable)) => {
            let part = name.get(cable.name.len() + 1..).unwrap_or(name);
            let label = cable_label(index, &cable.name);
            format!("{label} {}", words(part).to_lowercase())
        }
        None => words(name),
    }
}

/// An effect, its cable and, if it has several parameters, the parameter: `Winch scale, cable-3`.
fn effect_title(name: EffectName<'_>) -> String {
    let found = effect::find(name.effect);
    let mut parts = vec![found.map_or(name.effect, |found| found.title()).to_owned()];
    if !name.targets.is_empty() {
        parts.push(name.targets.to_owned());
    }
    if found.is_none_or(|found| found.parameters().len() > 1) {
        parts.push(name.parameter.replace('_', " "));
    }
    parts.join(", ")
}

/// Display name of a parameter that does not belong to an effect.
fn words(name: &str) -> String {
    let (part, axis) = name.rsplit_once('.').unwrap_or(("", name));
    let axis = axis.trim_end_matches("_m").trim_end_matches("_rad");
    match part {
        "entry_point" => format!("Entry point {axis}"),
        "platform_anchor" => format!("Platform anchor {axis}"),
        "pulley" => "Pulley radius".to_owned(),
        "winch" => "Drum diameter".to_owned(),
        "home" => match axis.strip_prefix('r') {
            Some(axis) => format!("Home rotation about {axis}"),
            None => format!("Home {axis}"),
        },
        "laser.target_plane" => "Laser target".to_owned(),
        _ => name.replace(['_', '.'], " "),
    }
}

#[cfg(test)]
mod tests {
    use tautline_core::robot::presets;

    use super::*;
    use crate::wording::units::display_unit;

    #[test]
    fn parameters_have_words() {
        let cables = presets::find("mini").expect("a preset").robot.cables;
        for (name, cable, text) in [
            ("cable-2.entry_point.x_m", Some(1), "2 entry point x"),
            ("home.ry_rad", None, "Home rotation about y"),
            (
                "effect.winch_scale.cable-3.scale",
                Some(2),
                "Winch scale, cable-3",
            ),
            (
                "effect.drum_eccentricity.cable-3.phase",
                Some(2),
                "Drum out of round, cable-3, phase",
            ),
            (
                "effect.winch_scale_common.scale",
                None,
                "Winch scale common to all",
            ),
        ] {
            assert_eq!(cable_of(&cables, name), cable, "{name}");
            assert_eq!(title(name, &cables), text);
        }
        assert!(!is_of("cable-10.pulley.radius_m", "cable-1"));
    }

    #[test]
    fn values_are_in_display_units() {
        for (name, in_files, read) in [
            ("effect.winch_scale.cable-3.scale", "1", Some("%")),
            ("effect.pulley_friction.mu", "1", Some("")),
            ("effect.cable_slip.cable-3.pose", "1", None),
            ("effect.cable_slip.cable-3.step", "m", Some("mm")),
            ("home.x_m", "m", Some("mm")),
        ] {
            let unit = unit(name, in_files);
            assert_eq!(unit.map(|unit| display_unit(unit).1), read, "{name}");
        }
    }
}
