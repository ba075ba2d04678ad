//! `tautline new`.

use anyhow::Result;
use clap::builder::PossibleValuesParser;
use tautline_core::robot::PartTolerances;
use tautline_workflow::machines::{self, Machine};
use tautline_workflow::templates::Template;

use crate::BadInput;
use crate::examples::examples;
use crate::output::{confirm, write_model};
use crate::replace::OutputFile;

#[derive(Debug, clap::Args)]
#[command(after_help = examples(&[
    ("Eight cables in a frame of 3 m x 2 m x 2 m", "tautline new spatial --width 3 --depth 2 --height 2 -o robot.json"),
    ("The robot of Jin et al. (2018)", "tautline new mini -o mini.json"),
]))]
pub struct Arguments {
    /// Machine to start from
    #[arg(value_name = "NAME", value_parser = PossibleValuesParser::new(machines::names()))]
    name: String,
    /// Width between the pulleys, along x (m); a size other than the usual one
    #[arg(long, value_name = "M")]
    width: Option<f64>,
    /// Depth between the pulleys, along y (m)
    #[arg(long, value_name = "M")]
    depth: Option<f64>,
    /// Height between the pulleys, along z (m); along y for a planar robot
    #[arg(long, value_name = "M")]
    height: Option<f64>,
    /// The robot.json to write; - is standard output
    #[arg(short, long, value_name = "FILE")]
    out: OutputFile,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let out = &arguments.out;
    let Machine {
        mut robot,
        summary,
        assumed,
        ..
    } = machine(arguments)?;
    if let Err(error) = robot.check() {
        return Err(BadInput::new(format!(
            "a robot of this size is not possible: {error}"
        )));
    }
    robot.tolerances.get_or_insert_with(PartTolerances::typical);
    write_model(out, &robot)?;
    confirm!(
        "{}: {summary}, {} cables; correct what is assumed: {assumed}",
        out.display(),
        robot.cable_count()
    );
    Ok(())
}

/// The machine of that name in the requested size.
fn machine(arguments: &Arguments) -> Result<Machine> {
    let name = &arguments.name;
    let given = [
        ("--width", arguments.width),
        ("--depth", arguments.depth),
        ("--height", arguments.height),
    ];
    let first = given.iter().find(|(_, value)| value.is_some());
    let Some((option, _)) = first else {
        let known = machines::find(name);
        return known.ok_or_else(|| BadInput::new(format!("found no machine \"{name}\"")));
    };
    let Some(template) = Template::named(name) else {
        let names = Template::ALL.map(Template::name).join(", ");
        let message = format!("{option}: {name} has one size only, expected one of {names}");
        return Err(BadInput::new(message));
    };
    let mut size_m = template.usual_size_m();
    for (side, (name, value)) in size_m.iter_mut().zip(given) {
        let Some(value) = value else { continue };
        if !(0.05..=500.0).contains(&value) {
            let message = format!("{name}: found {value}, expected 0.05 to 500 metres");
            return Err(BadInput::new(message));
        }
        *side = value;
    }
    Ok(machines::sized(template, size_m))
}
