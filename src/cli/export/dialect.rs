//! `tautline export --for`: a model as a text of another program.

use std::path::Path;

use anyhow::Result;
use tautline_import::{Dialect, read_description_text};
use tautline_workflow::exporting::{DialectText, WrittenValue, dialect_text};
use tautline_workflow::identification::{Identification, identify_session};

use super::{Arguments, identified};
use crate::output::{confirm, note, say, write_file};
use crate::{BadInput, input, table};
use tautline_core::estimation::Control;

/// Names of the dialects.
pub fn names() -> [&'static str; Dialect::ALL.len()] {
    Dialect::ALL.map(|dialect| dialect.name)
}

pub fn run(arguments: &Arguments, name: &str) -> Result<()> {
    let dialect = Dialect::named(name);
    let dialect = dialect.ok_or_else(|| BadInput::new(format!("--for: found no {name}")))?;
    let onto = arguments.onto.as_deref();
    let text = onto.map(read_description_text).transpose()?;
    let file = onto.map(|path| path.display().to_string());
    let session = input::session(&arguments.dataset)?;
    let fit = match session.measurements.is_empty() {
        true => None,
        false if arguments.effects.is_empty() => Some(of_session(&session)?),
        false => {
            let mut dataset = session.dataset();
            arguments.hypotheses.add_to(&mut dataset.robot)?;
            Some(identified(arguments, &dataset)?)
        }
    };
    let model = fit.as_ref().map_or(&session.robot, |fit| &fit.model);
    let written = dialect_text(
        model,
        fit.as_ref(),
        dialect,
        file.as_deref().zip(text.as_deref()),
    );
    let written = written.map_err(BadInput::new)?;
    for notice in &written.notices {
        note!("{notice}");
    }
    deliver(arguments.out.as_deref(), &written)
}

fn of_session(session: &tautline_session::Session) -> Result<Identification> {
    let fit = identify_session(session, &mut |_| Control::Continue);
    fit.map_err(|error| BadInput::new(format!("{}: {error}", session.name)))
}

/// Writes the text if it was asked for, and prints the values that change.
fn deliver(out: Option<&Path>, written: &DialectText) -> Result<()> {
    let mut lines = table::texts(&["Value", "unit", "old", "new", "sd", "reason"]);
    for value in &written.values {
        lines.add_row(cells(value));
    }
    match written.values.is_empty() {
        true => say!("No value changes."),
        false => say!("{lines}"),
    }
    say!("{}", written.loss_in_words());
    let Some(out) = out else {
        return Ok(());
    };
    write_file(out, written.text.as_bytes())?;
    confirm!("{}: {} values changed", out.display(), written.values.len());
    Ok(())
}

fn cells(value: &WrittenValue) -> [String; 6] {
    let number = |number: Option<f64>, digits: usize| {
        number.map_or_else(|| "-".to_owned(), |number| format!("{number:.digits$}"))
    };
    let digits = value
        .new
        .split_once('.')
        .map_or(0, |(_, fraction)| fraction.len());
    [
        value.key.clone(),
        value.unit.to_owned(),
        number(value.old, digits),
        value.new.clone(),
        number(value.sd, digits),
        value.reason.clone(),
    ]
}
