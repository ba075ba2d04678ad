//! The robots known by name to commands, studies and the Python package: the presets, and every other template at its usual
//! size.

use tautline_core::robot::{Robot, presets};

use crate::templates::Template;

/// A robot that is known by name.
#[derive(Debug, Clone, PartialEq)]
pub struct Machine {
    /// Name in commands.
    pub name: &'static str,
    /// Summary in one line.
    pub summary: String,
    /// The values that are assumed rather than published.
    pub assumed: &'static str,
    /// The nominal robot.
    pub robot: Robot,
    /// Entry points measured by an instrument more accurate than the drawing (m), if any.
    pub measured_entry_points_m: Option<Vec<[f64; 3]>>,
}

/// Names of all machines.
#[must_use]
pub fn names() -> Vec<&'static str> {
    let templates = Template::ALL.map(Template::name);
    let others = templates
        .into_iter()
        .filter(|name| !presets::NAMES.contains(name));
    presets::NAMES.into_iter().chain(others).collect()
}

/// The machine called `name`.
#[must_use]
pub fn find(name: &str) -> Option<Machine> {
    if let Some(preset) = presets::find(name) {
        return Some(Machine {
            name: preset.name,
            summary: preset.summary.to_owned(),
            assumed: preset.assumed,
            robot: preset.robot,
            measured_entry_points_m: preset.measured_entry_points_m,
        });
    }
    let template = Template::named(name)?;
    Some(sized(template, template.usual_size_m()))
}

/// A template with the given width, depth and height between its pulleys (m).
#[must_use]
pub fn sized(template: Template, size_m: [f64; 3]) -> Machine {
    let [width, depth, height] = size_m;
    Machine {
        name: template.name(),
        summary: format!("{}, {width} m x {depth} m x {height} m", template.summary()),
        assumed: "everything: a typical robot of this size",
        robot: template.robot(size_m),
        measured_entry_points_m: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_one_possible_robot() {
        let names = names();
        assert_eq!(
            names,
            [
                "mini",
                "hall",
                "suspended",
                "planar",
                "spatial",
                "hangprinter",
                "facade"
            ]
        );
        for name in &names {
            let machine = find(name).expect(name);
            assert_eq!(machine.name, *name);
            machine.robot.check().expect(name);
        }
        for name in presets::NAMES {
            let preset = presets::find(name).map(|preset| preset.robot);
            assert_eq!(find(name).map(|machine| machine.robot), preset, "{name}");
        }
        assert_eq!(find("maxi"), None);
    }
}
