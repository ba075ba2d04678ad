//! `tautline new`.

use std::path::PathBuf;

use anyhow::Result;
use clap::builder::PossibleValuesParser;
use tautline_session::write_robot;
use tautline_workflow::templates::Template;

use crate::BadInput;
use crate::output::say;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Common machine to start from
    #[arg(value_name = "TEMPLATE", value_parser = PossibleValuesParser::new(Template::ALL.map(Template::name)))]
    template: String,
    /// Width between the pulleys, along x (m)
    #[arg(long, value_name = "M")]
    width: Option<f64>,
    /// Depth between the pulleys, along y (m)
    #[arg(long, value_name = "M")]
    depth: Option<f64>,
    /// Height between the pulleys, along z (m); along y for a planar robot
    #[arg(long, value_name = "M")]
    height: Option<f64>,
    /// The robot.json to write
    #[arg(short, long, value_name = "FILE")]
    out: PathBuf,
    /// Replace a file that is there
    #[arg(long)]
    replace: bool,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let known = Template::ALL
        .into_iter()
        .find(|template| template.name() == arguments.template);
    // The parser of the arguments accepts no other name.
    let template = known.unwrap_or(Template::Spatial);
    let mut size_m = template.usual_size_m();
    let given = [
        ("--width", arguments.width),
        ("--depth", arguments.depth),
        ("--height", arguments.height),
    ];
    for (side, (name, value)) in size_m.iter_mut().zip(given) {
        let Some(value) = value else { continue };
        if !(0.05..=500.0).contains(&value) {
            let message = format!("{name}: found {value}, expected 0.05 to 500 metres");
            return Err(BadInput::new(message));
        }
        *side = value;
    }
    let out = &arguments.out;
    if out.exists() && !arguments.replace {
        let message = format!(
            "{}: already exists, expected --replace or another name",
            out.display()
        );
        return Err(BadInput::new(message));
    }
    let robot = template.robot(size_m);
    if let Err(error) = robot.check() {
        return Err(BadInput::new(format!(
            "a robot of this size is not possible: {error}"
        )));
    }
    write_robot(out, &robot)?;
    let [width, depth, height] = size_m;
    say!(
        "{}: {}, {width} m x {depth} m x {height} m, {} cables; everything else in it is typical of this size: correct it",
        out.display(),
        template.summary(),
        robot.cable_count()
    );
    Ok(())
}
