//! `tautline export --for`: a model as a text of another program.

use anyhow::Result;
use tautline_import::{Dialect, read_description_text};
use tautline_link::export::identified_constants;
use tautline_workflow::exporting::dialect_text;
use tautline_workflow::identification::FitVerdict;

use super::{Arguments, identified};
use crate::output::{confirm, note, say, write_file};
use crate::{BadInput, input, table};

/// Name of the constants of a controller.
const STRUCTURED_TEXT: &str = "structured-text";

/// Names of the dialects.
pub fn names() -> Vec<&'static str> {
    let dialects = Dialect::ALL.iter().map(|dialect| dialect.name);
    dialects.chain([STRUCTURED_TEXT]).collect()
}

pub fn run(arguments: &Arguments, name: &str) -> Result<()> {
    let dialect = Dialect::ALL
        .into_iter()
        .find(|dialect| dialect.name == name);
    let onto = arguments.onto.as_deref();
    if let (Some(onto), None) = (onto, dialect) {
        let message = format!(
            "--onto: found {}, expected none, as constants are written anew",
            onto.display()
        );
        return Err(BadInput::new(message));
    }
    let text = onto.map(read_description_text).transpose()?;
    let file = onto.map(|path| path.display().to_string());
    let mut session = input::session(&arguments.dataset)?;
    arguments.hypotheses.add_to(&mut session.robot)?;
    let settings = &session.settings.identification;
    let fit = match session.measurements.is_empty() {
        true => None,
        false => Some(identified(arguments, &session.dataset(), settings)?),
    };
    let model = fit.as_ref().map_or(&session.robot, |fit| &fit.model);
    let Some(dialect) = dialect else {
        if let Some(fit) = &fit {
            let verdict = FitVerdict::of(fit.solution.p_value());
            note!("{}: {}", session.name, verdict.words());
        }
        let text = identified_constants(model);
        match &arguments.out {
            Some(out) => {
                write_file(out, text.as_bytes())?;
                confirm!("{}: the constants of {} written", out.display(), model.name);
            }
            None => say!("{}", text.trim_end()),
        }
        return Ok(());
    };
    let onto = file.as_deref().zip(text.as_deref());
    let written = dialect_text(model, fit.as_ref(), dialect, onto).map_err(BadInput::new)?;
    let mut lines = table::texts(&["Value", "unit", "old", "new", "sd", "gain mm", "reason"]);
    for value in &written.values {
        let row = &value.parameter.row;
        let sd = value.sd.map(|sd| format!("{sd:.*}", row.digits));
        let old = onto.map(|_| format!("{:.*}", row.digits, value.parameter.value));
        let gain = value.gain_m.map(|gain_m| format!("{:.2}", 1e3 * gain_m));
        let [old, sd, gain] = [old, sd, gain].map(|cell| cell.unwrap_or_else(|| "-".to_owned()));
        let (key, unit) = (value.parameter.key.clone(), row.unit.0.to_owned());
        lines.add_row([
            key,
            unit,
            old,
            value.new.clone(),
            sd,
            gain,
            value.reason.clone(),
        ]);
    }
    say!("{lines}");
    say!("{}", written.loss_in_words());
    if let Some(out) = &arguments.out {
        if let (None, Some(bodies)) = (onto, dialect.bodies) {
            let name = out.file_name().unwrap_or_default().to_string_lossy();
            match name.strip_suffix("_cables.xml") {
                Some(name) => {
                    let beside = out.with_file_name(format!("{name}_bodies.xml"));
                    write_file(&beside, bodies(model).as_bytes())?;
                    confirm!("{}: the bodies of {} written", beside.display(), model.name);
                }
                None => note!("the bodies are written only beside a file NAME_cables.xml"),
            }
        }
        write_file(out, written.text.as_bytes())?;
        confirm!("{}: {} values written", out.display(), written.values.len());
    }
    Ok(())
}
