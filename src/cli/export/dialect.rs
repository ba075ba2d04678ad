//! `tautline export --for`: a model as a text of another program.

use anyhow::Result;
use tautline_core::estimation::Control;
use tautline_import::{Dialect, read_description_text};
use tautline_workflow::exporting::dialect_text;
use tautline_workflow::identification::identify_session;

use super::{Arguments, identified};
use crate::output::{confirm, say, write_file};
use crate::{BadInput, input, table};

/// Names of the dialects.
pub fn names() -> [&'static str; Dialect::ALL.len()] {
    Dialect::ALL.map(|dialect| dialect.name)
}

pub fn run(arguments: &Arguments, name: &str) -> Result<()> {
    let dialect = Dialect::ALL
        .into_iter()
        .find(|dialect| dialect.name == name);
    let dialect = dialect.ok_or_else(|| BadInput::new(format!("--for: found no {name}")))?;
    let onto = arguments.onto.as_deref();
    let text = onto.map(read_description_text).transpose()?;
    let file = onto.map(|path| path.display().to_string());
    let mut session = input::session(&arguments.dataset)?;
    arguments.hypotheses.add_to(&mut session.robot)?;
    let fit = match (
        session.measurements.is_empty(),
        arguments.effects.is_empty(),
    ) {
        (true, _) => None,
        (false, false) => Some(identified(arguments, &session.dataset())?),
        (false, true) => {
            let fit = identify_session(&session, &mut |_| Control::Continue);
            Some(fit.map_err(|error| BadInput::new(format!("{}: {error}", session.name)))?)
        }
    };
    let model = fit.as_ref().map_or(&session.robot, |fit| &fit.model);
    let onto = file.as_deref().zip(text.as_deref());
    let written = dialect_text(model, fit.as_ref(), dialect, onto).map_err(BadInput::new)?;
    let mut lines = table::texts(&["Value", "unit", "old", "new", "sd", "reason"]);
    for value in &written.values {
        let row = &value.parameter.row;
        let sd = value.sd.map(|sd| format!("{sd:.*}", row.digits));
        let old = onto.map(|_| format!("{:.*}", row.digits, value.parameter.value));
        let [old, sd] = [old, sd].map(|cell| cell.unwrap_or_else(|| "-".to_owned()));
        let (key, unit) = (value.parameter.key.clone(), row.unit.0.to_owned());
        lines.add_row([key, unit, old, value.new.clone(), sd, value.reason.clone()]);
    }
    say!("{lines}");
    say!("{}", written.loss_in_words());
    if let Some(out) = &arguments.out {
        write_file(out, written.text.as_bytes())?;
        confirm!("{}: {} values written", out.display(), written.values.len());
    }
    Ok(())
}
