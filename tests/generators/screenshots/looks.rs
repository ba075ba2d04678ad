//! Pictures of every screen, dialog and plot in both themes, two sizes and at 100 and 200 %, for a person to look at.

use std::path::{Path, PathBuf};

use anyhow::Result;
use egui::{Key, Modifiers, ThemePreference};
use tautline_workbench::model::Selection;
use tautline_workbench::model::command::{
    Answer, Command, CompareCommand, FileCommand, HypothesisCommand, RecordCommand,
    RecordingCommand, ReportCommand, RobotCommand, Setup, ViewCommand,
};
use tautline_workbench::model::comparison::Side;
use tautline_workbench::model::edit::Edit;
use tautline_workbench::model::link::LinkRequest;
use tautline_workbench::model::manual::Page;
use tautline_workbench::model::part::ScreenPart;
use tautline_workbench::model::phase::{Phase, Screen};
use tautline_workbench::shell::AppState;
use tautline_workflow::report::ReportFormat;
use tautline_workflow::templates::Template;

use super::stage::{LARGE, Stage};
use super::{SESSION, files, open, phase, written};

/// Sizes of the window (pixels).
const SIZES: [[f32; 2]; 3] = [[1024.0, 640.0], [1280.0, 800.0], [1920.0, 1080.0]];

struct Looks {
    stage: Stage,
    into: PathBuf,
    /// Only pictures are taken whose names contain this.
    only: Option<String>,
}

impl Looks {
    /// Pictures of the present screen in all themes, sizes and scales.
    fn at(&mut self, name: &str) -> Result<()> {
        if self.only.as_ref().is_some_and(|only| !name.contains(only)) {
            return Ok(());
        }
        for (theme, of) in [
            (ThemePreference::Dark, "dark"),
            (ThemePreference::Light, "light"),
        ] {
            self.stage.give(ViewCommand::Theme(theme));
            for size in SIZES {
                for scale in [1.0, 2.0] {
                    self.take(name, of, size, scale)?;
                }
            }
        }
        self.stage.resize(LARGE, 1.0);
        Ok(())
    }

    /// One picture in the present theme, whose name is `of`.
    fn take(&mut self, name: &str, of: &str, size: [f32; 2], scale: f32) -> Result<()> {
        self.stage.resize(size, scale);
        let file = format!("{name}-{}-{:.0}-{of}.png", size[0], 100.0 * scale);
        files::write_still(&self.into.join(&file), &self.stage.picture()?)?;
        println!("{file}");
        Ok(())
    }
}

/// Takes all pictures, or those whose names contain `only`.
///
/// # Errors
/// If there is no OpenGL, or a file cannot be written.
pub fn write_all(into: &Path, only: Option<&str>) -> Result<()> {
    std::fs::create_dir_all(into)?;
    let into = into.canonicalize()?;
    std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
    let mut looks = Looks {
        stage: Stage::new(LARGE)?,
        into,
        only: only.map(str::to_owned),
    };
    let is_asked = |names: &[&str], only: &str| {
        let mut names = names.iter();
        names.any(|name| name.contains(only) || only.starts_with(name))
    };
    // A text with which no name begins may be anywhere in names.
    let only = only.filter(|only| SECTIONS.iter().any(|(names, _)| is_asked(names, only)));
    for (names, section) in SECTIONS {
        if only.is_none_or(|only| is_asked(names, only)) {
            section(&mut looks)?;
            looks.stage.give(FileCommand::Close);
            looks.stage.give(FileCommand::Answer(Answer::Discard));
        }
    }
    Ok(())
}

/// Takes pictures, beginning at the start screen; may leave a session open.
type Section = fn(&mut Looks) -> Result<()>;

/// Beginnings of the names of pictures, and the function that takes them.
const SECTIONS: [(&[&str], Section); 11] = [
    (&["demo"], demo),
    (&["until"], until),
    (&["start", "compare-empty", "which-sensor"], without_session),
    (&["import", "new-robot"], imports),
    (&["inspector-suspended", "inspector-hall"], other_pulleys),
    (&["phase", "inspector", "doctor"], phases),
    (&["plot"], plots),
    (DIALOGS, dialogs),
    (&["compare"], comparison),
    (&["record"], record),
    (&["hypothesis", "gallery"], hypothesis),
];

/// Beginnings of the names of pictures of dialogs.
const DIALOGS: &[&str] = &[
    "palette", "log", "report", "manual", "about", "connect", "unsaved", "save-as", "menu",
];

/// Screens that need no session.
fn without_session(looks: &mut Looks) -> Result<()> {
    looks.at("start")?;
    looks.stage.give(CompareCommand::Show);
    looks.at("compare-empty")?;
    looks.stage.give(ViewCommand::Go(Screen::WhichSensor));
    looks.at("which-sensor")?;
    looks.stage.give(ViewCommand::Go(Screen::Start));
    Ok(())
}

/// Pulleys of other robots.
fn other_pulleys(looks: &mut Looks) -> Result<()> {
    for (session, name) in [
        ("suspended-sag/session.json", "inspector-suspended"),
        ("hall-creep-and-slip/session.json", "inspector-hall"),
    ] {
        open(&mut looks.stage, session);
        looks.stage.give(ViewCommand::Inspect(Some(1)));
        looks.at(name)?;
    }
    Ok(())
}

/// Two runs of one robot.
fn comparison(looks: &mut Looks) -> Result<()> {
    looks.stage.give(CompareCommand::Show);
    looks.stage.give(CompareCommand::Clear(Side::A));
    for run in ["before.json", "after.json"] {
        let path = Path::new("sessions/before-after").join(run);
        looks.stage.give(CompareCommand::Drop(path));
    }
    looks.at("compare")?;
    looks.stage.show("cable-6, ");
    looks.stage.press_first("cable-6, ");
    looks.at("compare-row")?;
    looks.stage.give(ViewCommand::Go(Screen::Start));
    Ok(())
}

/// The sessions of a robot over a year.
fn record(looks: &mut Looks) -> Result<()> {
    let folder = PathBuf::from("sessions/year-of-mini");
    looks.stage.give(RecordCommand::Open(folder));
    looks.at("record")?;
    looks.stage.press_first("2026-04");
    looks.at("record-row")?;
    looks.stage.give(ViewCommand::Select(Selection::cable(2)));
    looks.at("record-path")?;
    looks.stage.give(ViewCommand::Go(Screen::Start));
    Ok(())
}

/// A hypothesis with and without a mistake, and the gallery of effects.
fn hypothesis(looks: &mut Looks) -> Result<()> {
    written(&mut looks.stage)?;
    looks.at("hypothesis")?;
    let draft = looks.stage.state().model.hypothesis.draft.as_ref();
    let text = draft.map_or("", |draft| draft.text());
    let wrong = text.replace("paid_of(next)", "tension");
    looks.stage.give(HypothesisCommand::SetText(wrong));
    looks.at("hypothesis-mistake")?;
    looks.stage.give(HypothesisCommand::New);
    looks.at("hypothesis-unsaved")?;
    looks.stage.press("Do not save");
    looks.stage.settle();
    looks.at("hypothesis-new")?;
    looks.stage.give(ViewCommand::Go(Screen::Gallery));
    looks.stage.settle();
    looks.at("gallery")?;
    looks.stage.press_first("Effect: Drum out of round");
    looks.at("gallery-chosen")
}

/// Files of other programs: without a robot, a recording, and a log with mistakes.
fn imports(looks: &mut Looks) -> Result<()> {
    let file = |name: &str| Path::new("docs/your-data").join(name);
    looks.stage.give(FileCommand::Open(file("scope.csv")));
    looks.at("import-robot")?;
    looks.stage.press("mini");
    looks.at("import-scope")?;
    looks.stage.give(RecordingCommand::Discard);
    looks.stage.give(RecordingCommand::Show);
    looks.at("import-empty")?;
    for name in ["mistakes.csv", "points.txt"] {
        looks.stage.give(RecordingCommand::Read(file(name)));
    }
    looks.stage.press_first("rev_3, ");
    looks.at("import-mistakes")?;
    looks.stage.give(RecordingCommand::Discard);
    for name in ["log.csv", "capture.csv"] {
        looks.stage.give(RecordingCommand::Read(file(name)));
    }
    looks.at("import-markers")?;
    looks.stage.give(FileCommand::Close);
    looks.stage.give(FileCommand::Answer(Answer::Discard));
    looks.stage.give(FileCommand::New(Template::Suspended));
    looks.at("new-robot")?;
    looks.stage.give(ViewCommand::Go(Screen::NewRobot));
    looks.at("new-robot-empty")?;
    looks.stage.give(FileCommand::Close);
    looks.stage.give(FileCommand::Answer(Answer::Discard));
    Ok(())
}

/// A run of the demonstration: moving, stopped and verified.
fn demo(looks: &mut Looks) -> Result<()> {
    looks.stage.press("Try the demo robot");
    looks.at("demo-phase-1")?;
    phase(&mut looks.stage, Phase::Measuring);
    looks.stage.give(RobotCommand::Plan(25));
    looks.stage.connect_and_arm();
    looks.at("demo-armed")?;
    looks.stage.press("Start measuring");
    let measured = |state: &AppState| state.model.link.run.as_ref().map_or(0, |run| run.done());
    looks
        .stage
        .wait("twelve poses", |state| measured(state) >= 12);
    looks.stage.give(RobotCommand::Speed(1.0));
    looks.at("demo-measuring")?;
    looks.stage.give(RobotCommand::Stop);
    looks
        .stage
        .wait("the end", |state| !state.model.link.is_measuring());
    looks.at("demo-stopped")?;
    looks.stage.give(RobotCommand::Speed(60.0));
    looks.stage.press("Continue measuring");
    looks
        .stage
        .wait("all poses", |state| !state.model.link.is_measuring());
    looks.stage.press("Next: Identify the pulleys");
    looks.at("demo-identified")?;
    looks.stage.press("Next: Diagnose model");
    looks.at("demo-diagnosed")?;
    looks.stage.press_first("Next: Add to model: ");
    phase(&mut looks.stage, Phase::Adjustment);
    looks.stage.give_parameters();
    looks.at("demo-phase-5")?;
    let verified = |state: &AppState| {
        let open = state.model.open.as_ref();
        open.map_or(0, |open| open.session().verifications().len())
    };
    looks.stage.press("Measure before");
    looks
        .stage
        .wait("a verification", |state| verified(state) == 1);
    looks.stage.press("Write to the controller");
    looks.at("demo-write")?;
    looks.stage.confirm_write("Ada");
    looks.stage.press("Measure after");
    looks
        .stage
        .wait("a verification", |state| verified(state) == 2);
    looks.at("demo-verified")?;
    looks.stage.give(Command::Refuse(
        "winch.csv, line 7: found \"x\", expected a number.".into(),
    ));
    looks.at("demo-error")?;
    looks.stage.give(ViewCommand::Dismiss);
    looks.stage.give(LinkRequest::Disconnect);
    looks.stage.give(FileCommand::Answer(Answer::Discard));
    Ok(())
}

/// A run that measures until the cause is certain: its goals, on the way, and its end.
fn until(looks: &mut Looks) -> Result<()> {
    looks.stage.press("Try the demo robot");
    phase(&mut looks.stage, Phase::Measuring);
    looks.stage.press("Measure until certain");
    looks.at("until-goals")?;
    looks.stage.press("All pulleys are accurate to");
    looks.stage.connect_and_arm();
    looks.stage.press("Start measuring");
    let measured = |state: &AppState| state.model.link.run.as_ref().map_or(0, |run| run.done());
    for (poses, name) in [(3, "until-first"), (11, "until-decides")] {
        looks.stage.wait("poses", |state| measured(state) >= poses);
        looks.stage.give(RobotCommand::Speed(0.1));
        looks.at(name)?;
        looks.stage.give(RobotCommand::Speed(60.0));
    }
    looks
        .stage
        .wait("the end", |state| !state.model.link.is_measuring());
    looks.at("until-ended")?;
    looks.stage.give(LinkRequest::Disconnect);
    looks.stage.give(FileCommand::Answer(Answer::Discard));
    Ok(())
}

fn phases(looks: &mut Looks) -> Result<()> {
    open(&mut looks.stage, SESSION);
    for (step, parts) in [
        (
            Phase::Precalibration,
            &["Winches", "Force sensors", "Home platform"][..],
        ),
        (
            Phase::Modeling,
            &["Elongation", "Pulleys", "Cable lengths", "Description"][..],
        ),
        (Phase::Identification, &["Geometry", "Model doctor"][..]),
    ] {
        phase(&mut looks.stage, step);
        for part in parts {
            looks.stage.press_named(part);
            let part = part.to_lowercase().replace(' ', "-");
            looks.at(&format!("phase-{}-{part}", step.number()))?;
        }
    }
    tolerances(looks)?;
    looks.stage.press_named("Geometry");
    inspector(looks)?;
    looks.stage.press("Check geometry and faults");
    looks.at("phase-4-check")?;
    looks.stage.press_named("Model doctor");
    for show in ["Add to model: ", "Unexplained"] {
        if looks.stage.shows(show) {
            let name = show.to_lowercase().replace([' ', ':'], "");
            looks.at(&format!("doctor-{name}"))?;
        }
    }
    phase(&mut looks.stage, Phase::Measuring);
    looks.at("phase-3")?;
    looks.stage.give(RobotCommand::Plan(12));
    looks.stage.connect_and_arm();
    looks.at("phase-3-planned")?;
    looks.stage.press("Show faults");
    looks.at("phase-3-faults")?;
    looks.stage.press("Hide faults");
    phase(&mut looks.stage, Phase::Adjustment);
    looks.at("phase-5")
}

fn tolerances(looks: &mut Looks) -> Result<()> {
    phase(&mut looks.stage, Phase::Modeling);
    looks.stage.press_named("Tolerances");
    looks.at("phase-2-tolerances")?;
    looks.stage.press_named("Stated");
    looks.at("phase-2-tolerances-stated")?;
    looks.stage.give(Command::Undo);
    phase(&mut looks.stage, Phase::Identification);
    Ok(())
}

fn inspector(looks: &mut Looks) -> Result<()> {
    looks.stage.give(ViewCommand::Inspect(Some(2)));
    looks.at("inspector")?;
    looks.stage.give(ViewCommand::Inspect(Some(5)));
    looks.at("inspector-other")?;
    looks.stage.give(ViewCommand::Inspect(None));
    looks.stage.give(ViewCommand::Select(Selection::default()));
    Ok(())
}

fn plots(looks: &mut Looks) -> Result<()> {
    open(&mut looks.stage, SESSION);
    phase(&mut looks.stage, Phase::Identification);
    looks.stage.give(ViewCommand::Select(Selection {
        cable: Some(2),
        pose: Some(17),
    }));
    for tab in [
        "Residuals",
        "By variable",
        "Distances",
        "Tensions",
        "Convergence",
        "Correlation",
        "Statistics",
    ] {
        looks.stage.press_tab(tab);
        if tab == "Residuals" {
            looks.stage.press("Show cursors");
        }
        let tab = tab.to_lowercase().replace(' ', "-");
        looks.at(&format!("plot-{tab}"))?;
    }
    looks.stage.press_named("Residuals");
    looks.stage.press("Plot layout");
    looks.stage.press("Four plots");
    looks.at("plots-four")?;
    looks
        .stage
        .give(ViewCommand::Maximise(Some(ScreenPart::Plots)));
    looks.at("plots-maximised")?;
    looks.stage.give(ViewCommand::Maximise(None));
    looks.stage.press("Plot layout");
    looks.stage.press_first("Open ");
    looks.at("plot-detached")?;
    looks.stage.press("Dock");
    looks.stage.press("Plot layout");
    looks.stage.press("One plot");
    Ok(())
}

fn dialogs(looks: &mut Looks) -> Result<()> {
    open(&mut looks.stage, SESSION);
    looks.stage.give(ViewCommand::Palette(true));
    looks.at("palette")?;
    looks.stage.give(ViewCommand::Palette(false));
    looks.stage.give(ViewCommand::Log(true));
    looks.at("log")?;
    looks.stage.give(ViewCommand::Log(false));
    looks.stage.give(ReportCommand::AskSave(ReportFormat::Pdf));
    looks.at("report")?;
    looks.stage.give(ReportCommand::Cancel);
    for page in [Page::Start, Page::Identification, Page::Plots] {
        looks.stage.give(ViewCommand::Manual(Some(page)));
        looks.at(&format!("manual-{}", page.name().trim_end_matches(".md")))?;
    }
    looks.stage.give(ViewCommand::Manual(None));
    looks.stage.give(ViewCommand::About(true));
    looks.at("about")?;
    looks.stage.give(ViewCommand::About(false));
    looks.stage.give(RobotCommand::Setup(Setup::Open));
    looks.stage.press("Controller with OPC UA");
    for sign_in in ["Name and password", "Certificate"] {
        looks.stage.press(sign_in);
        let name = sign_in.split(' ').next().unwrap_or_default();
        looks.at(&format!("connect-{}", name.to_lowercase()))?;
    }
    looks.stage.give(RobotCommand::Setup(Setup::Close));
    looks.stage.give(Edit::Rename("Another name".into()));
    looks.stage.give(FileCommand::Close);
    looks.at("unsaved")?;
    looks.stage.press_named("Cancel");
    looks
        .stage
        .key(Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    looks.at("save-as")?;
    looks.stage.press_named("Cancel");
    for menu in ["File", "View"] {
        looks.stage.press_named(menu);
        looks.at(&format!("menu-{}", menu.to_lowercase()))?;
        looks.stage.key(Modifiers::NONE, Key::Escape);
    }
    Ok(())
}
