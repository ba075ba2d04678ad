//! `tautline adjust`.

mod files;
mod identified;
mod interrupted;
mod report;
mod writing;

use std::path::PathBuf;

use crate::BadInput;
use anyhow::{Result, anyhow};
use tautline_link::ParameterInfo;
use tautline_link::adjusting::read_parameters;
use tautline_session::Outcome;
use tautline_workflow::adjusting::{
    self, AdjustmentDocument, Doubt, DoubtKind, Purpose, Review, former_values, not_restorable,
    not_restored, revertible,
};
use tautline_workflow::controllers::ConnectionSetup;
use tautline_workflow::wording::sentence;

use crate::examples::examples;
use crate::live::{Connection, RobotArguments, SessionFile, link_error};
use crate::measure::require_simulated;
use crate::method::MethodName;
use crate::output::{self, JsonOutput, note, notice, say};
use crate::replace::OutputFile;
use identified::Identified;
use interrupted::Next;
use writing::write;

#[derive(Debug, clap::Args)]
#[command(after_help = examples(&[
    ("What would change on the controller", "tautline adjust run.json --controller sim --dry-run"),
    ("Write the identified values to it", "tautline adjust run.json --controller sim --arm"),
    ("Restore the values from before", "tautline adjust run.json --controller sim --roll-back --arm"),
    ("For a controller without a link", "tautline adjust mini --structured-text mini.st"),
]), mut_arg("controller", |controller| controller.required(false)))]
pub struct Arguments {
    /// Session file; for --structured-text and --csv without a controller also a dataset folder
    #[arg(value_name = "SESSION|DATASET")]
    session: PathBuf,
    #[command(flatten)]
    robot_arguments: RobotArguments,
    /// Method of identification; by default that of the session
    #[arg(long, value_enum)]
    method: Option<MethodName>,
    /// Write the values even if the identification did not converge
    #[arg(long, alias = "unconverged")]
    allow_unconverged: bool,
    /// Write the values even if the model does not explain the readings
    #[arg(long)]
    allow_unexplained: bool,
    /// Write the values even if a parameter lies far outside its prior
    #[arg(long)]
    allow_implausible: bool,
    /// Write the values even if the diagnosis has a finding that is not in the model
    #[arg(long)]
    allow_finding: bool,
    /// Write the values even if the controller has no parameter for an effect that was identified with them
    #[arg(long)]
    allow_unsupported: bool,
    /// Show what would be written, and write nothing
    #[arg(long)]
    dry_run: bool,
    /// Restore the values from before the last adjustment
    #[arg(long, conflicts_with_all = ["method", "dry_run"])]
    roll_back: bool,
    /// Write the values of the controller and the identified values as a CSV table; - is standard output
    #[arg(long, value_name = "FILE")]
    csv: Option<OutputFile>,
    /// Write the identified values as constants in Structured Text; - is standard output
    #[arg(long, value_name = "FILE")]
    structured_text: Option<OutputFile>,
    #[command(flatten)]
    json: JsonOutput<AdjustmentDocument>,
}

impl Arguments {
    fn deliver(&self, document: &AdjustmentDocument) -> Result<()> {
        self.json.deliver(document, || report::print(document))
    }
}

pub fn run(arguments: &Arguments) -> Result<()> {
    let robot = &arguments.robot_arguments;
    let has_files = arguments.csv.is_some() || arguments.structured_text.is_some();
    // With --arm or --roll-back, the controller was forgotten.
    let is_for_controller = robot.arm || arguments.roll_back;
    if robot.controller.is_none() && has_files && !is_for_controller {
        return files::write_without_controller(arguments);
    }
    let choice = arguments.robot_arguments.choice()?;
    let mut file = SessionFile::open(&arguments.session, &mut notice)?;
    let place = arguments.session.display().to_string();
    require_simulated(&file.session, &choice, &place)?;
    let link = &arguments.robot_arguments.link;
    let changed = link.take(&mut file.session, &choice)?;
    if let Some(open) = adjusting::open(&file.session).cloned() {
        let setup = ConnectionSetup::chosen(&file.session, &[], &choice, Some(&file.controller()));
        let mut connection = Connection::open(&setup, link, arguments.robot_arguments.speed)?;
        return match interrupted::settle(arguments, &mut file, &mut connection, &open)? {
            Next::Done => Ok(()),
            Next::RollBack => {
                let robot = &arguments.robot_arguments;
                robot.require_arm("The former values were not restored")?;
                roll_back(arguments, &mut file, &mut connection)
            }
        };
    }
    if !arguments.dry_run {
        let robot = &arguments.robot_arguments;
        robot.require_arm("Nothing was written to the controller")?;
    }
    if arguments.roll_back {
        let setup = ConnectionSetup::chosen(&file.session, &[], &choice, Some(&file.controller()));
        let mut connection = Connection::open(&setup, link, arguments.robot_arguments.speed)?;
        return roll_back(arguments, &mut file, &mut connection);
    }
    let identified = Identified::of(&file.session, arguments.method)?;
    check_doubts(arguments, &identified.doubts)?;
    let effects = &identified.model.effects;
    let setup = ConnectionSetup::chosen(&file.session, effects, &choice, Some(&file.controller()));
    let mut connection = Connection::open(&setup, link, arguments.robot_arguments.speed)?;
    if changed && !arguments.dry_run {
        file.save()?;
    }
    adjust(arguments, &mut file, &mut connection, &identified)
}

/// Rejects values that there is reason to doubt, unless the user allowed them.
fn check_doubts<'a>(
    arguments: &Arguments,
    doubts: impl IntoIterator<Item = &'a Doubt>,
) -> Result<()> {
    for doubt in doubts {
        let (flag, allowed) = match doubt.kind {
            DoubtKind::Unconverged => ("--allow-unconverged", arguments.allow_unconverged),
            DoubtKind::Unexplained => ("--allow-unexplained", arguments.allow_unexplained),
            DoubtKind::Implausible => ("--allow-implausible", arguments.allow_implausible),
            DoubtKind::Finding => ("--allow-finding", arguments.allow_finding),
            DoubtKind::Unsupported => ("--allow-unsupported", arguments.allow_unsupported),
        };
        let why = &doubt.sentence;
        if !arguments.dry_run && !allowed {
            return Err(anyhow!(
                "{why}: nothing was written to the controller; {flag} writes the values anyway"
            ));
        }
        note!("{why}.");
    }
    Ok(())
}

fn adjust(
    arguments: &Arguments,
    file: &mut SessionFile,
    connection: &mut Connection,
    identified: &Identified,
) -> Result<()> {
    let parameters = parameters(connection)?;
    let solution = identified.solution();
    let review = Review::of(&parameters, &identified.model, solution);
    files::write(arguments, &identified.model, &review.lines)?;
    match (&review.adaptation, review.doubt()) {
        (Some(exact), None) => note!("{}.", exact.sentence),
        (_, doubt) => check_doubts(arguments, &doubt)?,
    }
    match adjusting::refusal(&review.lines) {
        Some(why) if !arguments.dry_run => return Err(anyhow!("{}", sentence(&why))),
        why => why.iter().for_each(|why| note!("{why}.")),
    }
    let mut document = AdjustmentDocument::new(connection.controller.identity());
    document.method = Some(identified.document.method.clone());
    document.chi2 = Some(identified.document.chi2);
    document.set_differences(&review.lines);
    let values = review.values_to_write();
    if arguments.dry_run || values.is_empty() {
        document.outcome = if values.is_empty() {
            "nothing_to_write"
        } else {
            "not_written"
        }
        .to_owned();
        return arguments.deliver(&document);
    }
    file.session.add_result(identified.record(&file.session));
    let output = arguments.json.reserve(&document)?;
    let written = write(file, connection, &parameters, &values, Purpose::Adjust)?;
    written.deliver(output, document)?;
    match written.outcome {
        Outcome::Written => Ok(()),
        _ => Err(anyhow!("{}", written.text)),
    }
}

fn roll_back(
    arguments: &Arguments,
    file: &mut SessionFile,
    connection: &mut Connection,
) -> Result<()> {
    let Some(last) = revertible(&file.session) else {
        let place = arguments.session.display();
        return Err(BadInput::new(format!(
            "{place}: the last adjustment was not written, so there is nothing to roll back"
        )));
    };
    let values = former_values(last);
    if values.is_empty() {
        let place = arguments.session.display();
        let kept = not_restored(&file.session).unwrap_or_default();
        return Err(BadInput::new(format!(
            "{place}: none of the previous values can be restored. {kept}"
        )));
    }
    let parameters = parameters(connection)?;
    let mut document = AdjustmentDocument::new(connection.controller.identity());
    document.set_not_restored(&not_restorable(&file.session));
    let output = arguments.json.reserve(&document)?;
    let kept = not_restored(&file.session);
    let written = write(file, connection, &parameters, &values, Purpose::RollBack)?;
    written.deliver(output, document)?;
    match (written.outcome, kept) {
        (Outcome::RolledBack, None) => Ok(()),
        (Outcome::RolledBack, Some(kept)) => Err(anyhow!("{kept}")),
        _ => Err(anyhow!("{}", written.text)),
    }
}

fn parameters(connection: &mut Connection) -> Result<Vec<ParameterInfo>> {
    read_parameters(&mut *connection.controller).map_err(link_error)
}

/// Prints a message that is not part of the document, on standard error if the document goes to standard output.
fn message(arguments: &Arguments, text: &str) {
    if arguments.json.is_text() {
        say!("{text}");
    } else {
        output::message(text);
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Debug, Parser)]
    struct Adjust {
        #[command(flatten)]
        arguments: Arguments,
    }

    #[test]
    fn the_former_name_of_the_flag_is_read() {
        for flag in ["--allow-unconverged", "--unconverged"] {
            let words = ["tautline", "session.json", "--controller", "sim", flag];
            assert!(Adjust::parse_from(words).arguments.allow_unconverged);
        }
    }
}
