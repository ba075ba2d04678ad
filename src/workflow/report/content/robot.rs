//! The robot as described by the drawings.

use tautline_core::robot::Robot;

use super::{NONE, number};
use crate::report::document::{Section, Table};
use crate::wording::list;
use crate::wording::units::{mm, quantity, significant};

pub fn section(robot: &Robot) -> Section {
    let mut section = Section::new("Robot");
    section.facts(facts(robot));
    section.table(cables(robot));
    section
}

fn facts(robot: &Robot) -> Vec<(String, String)> {
    let mut facts = Vec::new();
    let mut add = |name: &str, value: String| facts.push((name.to_owned(), value));
    add("Name", robot.name.clone());
    if let Some(number) = &robot.serial_number {
        add("Serial number", number.clone());
    }
    add("Cables", robot.cable_count().to_string());
    let free = robot.platform.freedom();
    let free: Vec<String> = free
        .coordinates()
        .iter()
        .map(|c| c.describe().to_owned())
        .collect();
    add("Free coordinates", list(&free));
    let mass = robot.platform.mass_kg;
    add(
        "Mass of the platform",
        mass.map_or_else(
            || "not given, so static equilibrium is not used".to_owned(),
            |mass| quantity(mass, "kg"),
        ),
    );
    if let Some(home) = &robot.home {
        add(
            "Home pose",
            format!(
                "known to {} mm and {} degrees",
                significant(1e3 * home.position_sd_m, 2),
                significant(home.orientation_sd_rad.to_degrees(), 2)
            ),
        );
    }
    facts
}

fn cables(robot: &Robot) -> Table {
    let caption = "Cables, from the drawing and the first two phases";
    Table::of(caption, 1, &robot.cables).columns(&[
        ("Cable", &|one| one.name.clone()),
        ("Pulley radius mm", &|one| mm(one.pulley.radius_m, 1)),
        ("Drum diameter mm", &|one| mm(one.winch.drum_diameter_m, 1)),
        ("Length noise mm", &|one| mm(one.winch.length_sd_m, 2)),
        ("Tension noise N", &|one| {
            let sensor = one.force_sensor.as_ref();
            sensor.map_or_else(|| NONE.to_owned(), |s| number(s.tension_sd_n, 1))
        }),
        (
            "Stiffness kN",
            &|one| match (&one.cable.elongation_surface, one.cable.axial_stiffness_n) {
                (Some(_), _) => "measured".to_owned(),
                (None, Some(stiffness_n)) => number(1e-3 * stiffness_n, 1),
                (None, None) => "inelastic".to_owned(),
            },
        ),
        ("Weight N/m", &|one| number(one.cable.weight_n_per_m, 3)),
    ])
}
