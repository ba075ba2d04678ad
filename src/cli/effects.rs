//! `tautline effects`.

use std::path::{Path, PathBuf};

use anyhow::Result;
use tautline_core::effect::{Effect, FORMULA_QUANTITIES, FORMULA_TARGETS, Hypothesis, Scope};
use tautline_core::estimation::Control;
use tautline_core::geometry::Pose;
use tautline_core::robot::Robot;
use tautline_session::{HypothesisFolder, Session};
use tautline_workflow::clock;
use tautline_workflow::effects::{
    EffectDocument, EffectParameterDocument, EffectSearch, EffectsDocument,
};
use tautline_workflow::identification::identify_session;
use tautline_workflow::machines;
use tautline_workflow::report::render;
use tautline_workflow::signature::{Gallery, gallery_document};

use crate::BadInput;
use crate::examples::examples;
use crate::hypothesis_arguments::{HypothesisFiles, of_user};
use crate::input;
use crate::output::{JsonOutput, confirm, line, note, say, write_file};
use crate::replace::OutputFile;
use crate::report_format::report_format;
use crate::table;

/// Robot whose words the texts of effects use if no other is named.
const ROBOT: &str = "mini";

#[derive(Debug, clap::Args)]
#[command(after_help = examples(&[
    ("All effects, with the sizes that are typical", "tautline effects"),
    ("An effect as a hypothesis file, to be copied and changed", "tautline effects --as-text drum_eccentricity > oval_drum.toml"),
    ("What the formulas of a hypothesis may use and change", "tautline effects --quantities"),
    ("What each mistake looks like in the residuals of your robot", "tautline effects mini --gallery gallery.html"),
    ("The list for another program", "tautline effects --json -"),
]))]
pub struct Arguments {
    /// Robot whose hypotheses are listed and whose residuals the gallery shows: a known machine, a robot.json, a session or a dataset folder
    #[arg(value_name = "NAME|ROBOT|DATASET|SESSION")]
    robot: Option<String>,
    #[command(flatten)]
    hypotheses: HypothesisFiles,
    /// Print an effect as the text of a hypothesis file
    #[arg(long, value_name = "ID", conflicts_with_all = ["quantities", "json"])]
    as_text: Option<String>,
    /// List the quantities that the formulas of a hypothesis may use and change
    #[arg(long, conflicts_with = "json")]
    quantities: bool,
    /// Write pictures of the residuals that each effect causes on this robot; the name ends with .html or .pdf
    #[arg(long, value_name = "FILE", conflicts_with_all = ["quantities", "as_text", "json"])]
    gallery: Option<OutputFile>,
    #[command(flatten)]
    json: JsonOutput<EffectsDocument>,
}

pub fn run(arguments: &Arguments) -> Result<()> {
    if arguments.quantities {
        print_quantities();
        return Ok(());
    }
    let mut subject = Subject::of(arguments.robot.as_deref().unwrap_or(ROBOT))?;
    arguments.hypotheses.add_to(&mut subject.robot)?;
    match (&arguments.as_text, &arguments.gallery) {
        (Some(id), _) => print_text(&subject.robot, id),
        (None, Some(path)) => write_gallery(path, &subject),
        (None, None) => {
            let document = EffectsDocument::of(&subject.robot);
            let sources = sources(arguments, &subject)?;
            arguments.json.deliver(&document, || {
                print_table(&document);
                sources.iter().for_each(|line| say!("{line}"));
            })
        }
    }
}

/// A robot with the poses at which it was measured.
struct Subject {
    robot: Robot,
    poses: Vec<Pose>,
    /// Name in the arguments.
    name: String,
}

impl Subject {
    fn of(name: &str) -> Result<Self> {
        let path = Path::new(name);
        if machines::find(name).is_some() || !path.exists() {
            return Ok(Self {
                robot: input::robot(name)?.robot,
                poses: Vec::new(),
                name: name.to_owned(),
            });
        }
        let session = input::session(path)?;
        Ok(Self {
            poses: fitted_poses(&session),
            robot: session.robot,
            name: name.to_owned(),
        })
    }
}

/// The measured poses of a session; none where they cannot be identified.
fn fitted_poses(session: &Session) -> Vec<Pose> {
    let fit = identify_session(session, &mut |_| Control::Continue);
    let poses = fit.map(|fit| fit.solution.poses).unwrap_or_default();
    // The simulation begins at home by itself.
    let home = session.robot.home.map(|_| 0);
    let away = poses.into_iter().filter(|(row, _)| Some(*row) != home);
    away.map(|(_, pose)| pose).collect()
}

fn write_gallery(path: &Path, subject: &Subject) -> Result<()> {
    let format = report_format("--gallery", path)?;
    let gallery = Gallery::new(&subject.robot, &subject.poses, &mut |_, _| {
        Control::Continue
    });
    let failed = |error| BadInput::new(format!("{}: {error}", subject.name));
    let Some(gallery) = gallery.map_err(failed)? else {
        return Ok(());
    };
    if !subject.poses.is_empty() && gallery.poses != subject.poses.len() + 1 {
        note!(
            "{}: its poses cannot be simulated; the gallery has others",
            subject.name
        );
    }
    let now = clock::now();
    write_file(path, &render(&gallery_document(&gallery), format, now)?)?;
    confirm!(
        "{}: {} effects of {}",
        path.display(),
        gallery.signatures.len(),
        gallery.robot.name
    );
    Ok(())
}

/// Source of each hypothesis, one line each.
fn sources(arguments: &Arguments, subject: &Subject) -> Result<Vec<String>> {
    let effects: Vec<&Effect> = subject.robot.hypothesis_effects().collect();
    if effects.is_empty() {
        return Ok(Vec::new());
    }
    let mut files = arguments.hypotheses.sources()?;
    let beside = HypothesisFolder::read(&Path::new(&subject.name).join("effects"));
    files.extend(beside.hypotheses);
    files.extend(of_user().hypotheses.iter().cloned());
    let mut lines = vec!["Hypotheses:".to_owned()];
    for (effect, text) in effects.iter().zip(&subject.robot.hypotheses) {
        let is_it = |(_, known): &&(PathBuf, Hypothesis)| known.text() == text;
        let file = files.iter().find(is_it);
        let file = file.map_or_else(
            || subject.name.clone(),
            |(file, _)| file.display().to_string(),
        );
        lines.push(format!("   {}: {file}", effect.id()));
    }
    Ok(lines)
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
    let of = |is_of_cable: bool, or: &str| if is_of_cable { "cable" } else { or }.to_owned();
    table::rows(FORMULA_QUANTITIES).print_texts(&[
        ("May be used", &|one| one.name.to_owned()),
        ("unit", &|one| one.unit.to_owned()),
        ("of", &|one| of(one.is_of_cable(), "pose")),
        ("meaning", &|one| one.meaning.to_owned()),
    ]);
    table::rows(FORMULA_TARGETS).print_texts(&[
        ("May be changed", &|one| one.name.to_owned()),
        ("unit", &|one| one.unit.to_owned()),
        ("of", &|one| of(one.is_of_cable(), "platform")),
        ("meaning", &|one| one.meaning.to_owned()),
    ]);
}

/// Lists the effects that `simulate` can hide, whether `identify` can estimate them, and how `diagnose` searches for them.
fn print_table(document: &EffectsDocument) {
    let parameters = |effect: &EffectDocument| {
        let parameters: Vec<_> = effect.parameters.iter().map(parameter).collect();
        parameters.join(", ")
    };
    let freed = |is_freed: bool| if is_freed { "yes" } else { "no" }.to_owned();
    table::rows(&document.effects).print_texts(&[
        ("Effect", &|effect| effect.effect.clone()),
        ("title", &|effect| effect.title.clone()),
        ("on", &|effect| on(effect).to_owned()),
        ("can be estimated", &|effect| freed(effect.can_be_estimated)),
        ("diagnose tests it", &|effect| tried(effect).to_owned()),
        ("parameters (typical size)", &|effect| parameters(effect)),
        ("typical tolerance", &|effect| tolerance(effect)),
    ]);
}

fn on(effect: &EffectDocument) -> &'static str {
    match effect.on {
        Scope::Cable => "each cable",
        Scope::CableOrAll => "one cable or all",
        Scope::Pair => "two cables",
        Scope::Robot => "the robot",
    }
}

fn tried(effect: &EffectDocument) -> &'static str {
    match effect.diagnosed {
        EffectSearch::Always => "always",
        EffectSearch::AnyPhase => "at any phase",
        EffectSearch::AnyPhaseAndPeriod => "at any phase and period",
        EffectSearch::FromEveryPose => "from every pose on",
        EffectSearch::AtEveryPose => "at every pose",
        EffectSearch::AtEveryDistance => "at every distance",
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

/// Tolerance of sound parts, on small and on large machines if these differ.
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
