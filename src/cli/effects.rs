//! `tautline effects`.

use anyhow::Result;
use tautline_core::effect::{FORMULA_QUANTITIES, FORMULA_TARGETS};
use tautline_core::robot::Robot;
use tautline_workflow::documents::effects::{
    EffectDocument, EffectParameterDocument, EffectSearch, EffectTarget, EffectsDocument,
};

use crate::BadInput;
use crate::examples::examples;
use crate::hypothesis_arguments::HypothesisFiles;
use crate::input;
use crate::output::{JsonOutput, line, say};
use crate::table;

/// Robot whose words the texts of effects use.
const ROBOT: &str = "mini";

#[derive(Debug, clap::Args)]
#[command(after_help = examples(&[
    ("All effects, with the sizes that are typical", "tautline effects"),
    ("An effect as a hypothesis file, to be copied and changed", "tautline effects --as-text drum_eccentricity > oval_drum.toml"),
    ("What the formulas of a hypothesis may use and change", "tautline effects --quantities"),
    ("The list for another program", "tautline effects --json -"),
]))]
pub struct Arguments {
    #[command(flatten)]
    hypotheses: HypothesisFiles,
    /// Print an effect as the text of a hypothesis file
    #[arg(long, value_name = "ID", conflicts_with_all = ["quantities", "json"])]
    as_text: Option<String>,
    /// List the quantities that the formulas of a hypothesis may use and change
    #[arg(long, conflicts_with = "json")]
    quantities: bool,
    #[command(flatten)]
    json: JsonOutput,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    if arguments.quantities {
        print_quantities();
        return Ok(());
    }
    let mut robot = input::robot(ROBOT)?.robot;
    arguments.hypotheses.add_to(&mut robot)?;
    match &arguments.as_text {
        Some(id) => print_text(&robot, id),
        None => {
            let document = EffectsDocument::of(&robot);
            let print = || print_table(&document);
            arguments.json.deliver(&document, print)
        }
    }
}

fn print_text(robot: &Robot, id: &str) -> Result<()> {
    let bad = |message: String| BadInput::new(format!("--as-text {id}: {message}"));
    let effect = robot.effect(id);
    let effect = effect.ok_or_else(|| bad(format!("unknown effect \"{id}\"")))?;
    let text = effect.as_text(robot);
    line(text.map_err(|error| bad(error.to_string()))?.trim_end());
    Ok(())
}

fn print_quantities() {
    let mut rows = table::texts(&["May be used", "unit", "of", "meaning"]);
    for quantity in FORMULA_QUANTITIES {
        let of = if quantity.is_of_cable() {
            "cable"
        } else {
            "pose"
        };
        rows.add_row([quantity.name, quantity.unit, of, quantity.meaning]);
    }
    say!("{rows}");
    let mut rows = table::texts(&["May be changed", "unit", "of", "meaning"]);
    for target in FORMULA_TARGETS {
        let of = if target.is_of_cable() {
            "cable"
        } else {
            "platform"
        };
        rows.add_row([target.name, target.unit, of, target.meaning]);
    }
    say!("{rows}");
}

/// Lists the effects that `simulate` can hide, whether `identify` can estimate them, and how `diagnose` searches for them.
fn print_table(document: &EffectsDocument) {
    let mut rows = table::texts(&[
        "Effect",
        "title",
        "on",
        "can be estimated",
        "diagnose tests it",
        "parameters (typical size)",
        "typical tolerance",
    ]);
    for effect in &document.effects {
        let parameters: Vec<_> = effect.parameters.iter().map(parameter).collect();
        let freed = if effect.can_be_estimated { "yes" } else { "no" };
        let cells = [
            &effect.effect,
            &effect.title,
            on(effect),
            freed,
            tried(effect),
            &parameters.join(", "),
            &tolerance(effect),
        ];
        rows.add_row(cells);
    }
    say!("{rows}");
}

fn on(effect: &EffectDocument) -> &'static str {
    match effect.on {
        EffectTarget::Cable => "each cable",
        EffectTarget::CableOrAll => "one cable or all",
        EffectTarget::Pair => "two cables",
        EffectTarget::Robot => "the robot",
    }
}

fn tried(effect: &EffectDocument) -> &'static str {
    match effect.diagnosed {
        EffectSearch::Always => "always",
        EffectSearch::AnyPhase => "at any phase",
        EffectSearch::AnyPhaseAndPeriod => "at any phase and period",
        EffectSearch::FromEveryPose => "from every pose on",
        EffectSearch::AtEveryPose => "at every pose",
        EffectSearch::HugeResiduals => "if residuals are huge",
    }
}

fn parameter(p: &EffectParameterDocument) -> String {
    if p.is_given {
        return format!("{} (given)", p.name);
    }
    let [least, most] = p.typical.map(short);
    format!("{} ({least} to {most}{})", p.name, unit(&p.unit))
}

/// A unit after a number.
fn unit(unit: &str) -> String {
    match unit {
        "1" => String::new(),
        unit => format!(" {unit}"),
    }
}

/// By how much sound parts deviate, on small machines and on large ones if they differ.
fn tolerance(effect: &EffectDocument) -> String {
    let mut stated = effect.parameters.iter();
    let stated = stated.find_map(|p| p.tolerance.map(|typical| (unit(&p.unit), typical)));
    let Some((unit, typical)) = stated else {
        return String::new();
    };
    let [small, large] = typical.map(short);
    match small == large {
        true => format!("{small}{unit}"),
        false => format!("{small}{unit}, large machine {large}{unit}"),
    }
}

/// A typical size without insignificant digits.
fn short(size: f64) -> String {
    if size.abs() < 1.0 {
        size.to_string()
    } else {
        format!("{:.1}", size).trim_end_matches(".0").to_owned()
    }
}
