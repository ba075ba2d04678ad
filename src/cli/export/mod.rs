//! `tautline export`.

mod dialect;

use std::path::PathBuf;

use anyhow::{Result, anyhow};
use clap::ValueEnum;
use clap::builder::PossibleValuesParser;
use tautline_core::estimation::Control;
use tautline_core::measurement::Dataset;
use tautline_session::IdentificationSettings;
use tautline_workflow::exporting::{Table, TableFormat, encode, poses_table};
use tautline_workflow::identification::{
    Identification, IdentificationRequest, identify, readings_table, solved_method, values_table,
};

use crate::BadInput;
use crate::effect_arguments::EstimatedEffects;
use crate::examples::examples;
use crate::hypothesis_arguments::HypothesisFiles;
use crate::input::{self, Measured};
use crate::output::{confirm, is_standard, write_file};
use crate::replace::OutputFile;

#[derive(Debug, clap::Args)]
#[command(after_help = examples(&[
    ("The readings with their residuals, for a spreadsheet", "tautline export mini --table readings -o residuals.csv"),
    ("Poses and identified values, for MATLAB", "tautline export mini --table poses --table values -o mini.mat"),
    ("The lines of a Hangprinter's firmware that change", "tautline export hp4 --for reprap --onto config.g"),
    ("A model as a new file of another program", "tautline export model.json --for klipper -o printer.cfg"),
]))]
pub struct Arguments {
    /// Session file or dataset folder, with --for also a model file; - is a session on standard input
    #[arg(value_name = "SESSION|DATASET")]
    dataset: PathBuf,
    /// File to write: .csv or .parquet with one table, or .mat (MATLAB version 5) with one struct per table; - is CSV on standard output.
    /// With --for the text of the other program (of caspr the cables: NAME_cables.xml, without --onto with the bodies beside it); without it,
    /// only the lines that change are printed
    #[arg(short, long, value_name = "FILE", required_unless_present = "dialect")]
    out: Option<OutputFile>,
    /// Write the identified robot, or the model, as the firmware or simulator describes robots, or as constants in Structured Text; what
    /// it cannot express is said
    #[arg(long = "for", id = "dialect", value_name = "DIALECT", value_parser = PossibleValuesParser::new(dialect::names()), conflicts_with = "table")]
    dialect: Option<String>,
    /// Your file in that dialect, which is not changed: the text that is written has its comments, order and other values
    #[arg(long, value_name = "FILE", requires = "dialect")]
    onto: Option<PathBuf>,
    /// What to write: the measured poses, identified values with their standard deviations, or readings with their residuals; may be repeated
    #[arg(long, value_enum, default_value = "poses")]
    table: Vec<Content>,
    #[command(flatten)]
    effects: EstimatedEffects,
    #[command(flatten)]
    hypotheses: HypothesisFiles,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Content {
    Poses,
    Values,
    Readings,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    match (&arguments.dialect, &arguments.out) {
        (Some(name), _) => dialect::run(arguments, name),
        (None, Some(out)) => tables(arguments, out),
        (None, None) => Err(BadInput::new("--out: not given, expected a file")),
    }
}

fn tables(arguments: &Arguments, file: &OutputFile) -> Result<()> {
    let out = file.display();
    let format = match is_standard(file) {
        true => Some(TableFormat::Csv),
        false => TableFormat::of(file),
    };
    let Some(format) = format else {
        let message =
            format!("--out: found {out}, expected a file that ends in .csv, .parquet or .mat");
        return Err(BadInput::new(message));
    };
    let mut contents = arguments.table.clone();
    contents.dedup();
    if !format.holds_several() && contents.len() > 1 {
        let message = format!(
            "--table: found {} tables for {out}, expected one, or a .mat file",
            contents.len()
        );
        return Err(BadInput::new(message));
    }
    let folder = &arguments.dataset;
    let is_identified = contents.iter().any(|content| *content != Content::Poses);
    let (dataset, fit) = if is_identified {
        let Measured {
            mut dataset,
            identification,
            ..
        } = input::identifiable(folder)?;
        arguments.hypotheses.add_to(&mut dataset.robot)?;
        let fit = identified(arguments, &dataset, &identification)?;
        (dataset, Some(fit))
    } else {
        (input::dataset(folder)?, None)
    };
    let table = |content: &Content| match (content, &fit) {
        (Content::Values, Some(fit)) => values_table(fit),
        (Content::Readings, Some(fit)) => readings_table(fit),
        _ => poses_table(&dataset.measurements),
    };
    let tables: Vec<Table> = contents.iter().map(table).collect();
    let bytes =
        encode(format, &tables).map_err(|why| anyhow!("{out}: cannot be created ({why})"))?;
    write_file(file, &bytes)?;
    for table in &tables {
        let (rows, columns) = (table.rows(), table.columns.len());
        confirm!(
            "{out}: {} with {rows} rows and {columns} columns",
            table.name
        );
    }
    Ok(())
}

/// Identifies with the effects of the arguments, or else with those of a session.
fn identified(
    arguments: &Arguments,
    dataset: &Dataset,
    of_session: &IdentificationSettings,
) -> Result<Identification> {
    let effects = arguments.effects.settings(dataset, of_session)?;
    let method = solved_method(of_session.method);
    let request = IdentificationRequest::new(dataset.clone(), method, &effects);
    let request = request.map_err(BadInput::new)?;
    let fit = identify(&request, &mut |_| Control::Continue).map_err(BadInput::new)?;
    fit.refuse_extrapolation().map_err(BadInput::new)
}
