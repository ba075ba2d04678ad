//! Import of files of other programs.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use tautline_channels::{HAS_MORE_FORMATS, MemoryBudget, Source};
use tautline_core::measurement::Dataset;
use tautline_core::robot::Robot;
use tautline_import::{
    AlignedClock, Imported, Recipe, Suggestion, align_clocks, clock_times, read_recipe,
    read_sources,
};
use tautline_session::{Loaded, Phase as LogPhase, Session, write_versioned};

use super::file::begin;
use super::file_dialog::pick;
use super::file_tasks::{ask_save, file_label, write};
use super::{changed, identification};
use crate::model::command::file_choice::FileRequest;
use crate::model::command::{ALIGNING, CUTTING, READING, RecordingCommand, RecordingOutcome};
use crate::model::dialogs::SaveContent;
use crate::model::edit::Edit;
use crate::model::importing::{Cut, OpenImport};
use crate::model::messages::Cause;
use crate::model::phase::{Phase, Screen};
use crate::model::tasks::TaskHandle;
use crate::model::{Model, OpenSession};
use tautline_workflow::readiness::check_readings;
use tautline_workflow::wording::sentence;
use tautline_workflow::{clock, importing};

/// File extensions for dialogs; the format is recognised by content.
const ENDINGS: &[&str] = &[
    "csv", "txt", "tsv", "c3d", "mat", "npy", "npz", "parquet", "xlsx", "ods", "asc", "dat", "lvm",
    "tdms", "mf4", "h5", "hdf5", "mcap", "bag",
];
/// Number of extensions at the end that need the feature `more-formats`.
const MORE: usize = 4;

pub(super) fn perform(model: &mut Model, command: RecordingCommand) {
    match command {
        RecordingCommand::Show => model.screen = Screen::Import,
        RecordingCommand::Correct => correct(model),
        RecordingCommand::Ask => {
            let endings = match HAS_MORE_FORMATS {
                true => ENDINGS,
                false => &ENDINGS[..ENDINGS.len() - MORE],
            };
            let request = FileRequest::file("Import", endings);
            pick(model, request, RecordingCommand::Read);
        }
        RecordingCommand::Read(path) => read(model, path),
        RecordingCommand::UseRobot(robot) => {
            let name = robot.name.clone();
            begin(model, Session::new(name, *robot, clock::now()), None);
        }
        RecordingCommand::Remove(source) => remove(model, source),
        RecordingCommand::Change(recipe, what, goes_on) => {
            change(model, |open| open.draft.change(what, *recipe, goes_on));
        }
        RecordingCommand::Apply(place) => apply(model, |number, _| number == place),
        RecordingCommand::AlignClocks => align(model),
        RecordingCommand::ShowChannel(place) => {
            if let Some(open) = &mut model.importing.open {
                open.shown = place;
            }
        }
        RecordingCommand::AskRecipe => {
            let request = FileRequest::file("Recipe", &["json"]);
            pick(model, request, RecordingCommand::UseRecipe);
        }
        RecordingCommand::UseRecipe(path) => model.tasks.start(READING, move |_| {
            let result = read_recipe(&path).map_err(|error| error.to_string());
            RecordingOutcome::Recipe(path, result.map(Box::new)).into()
        }),
        RecordingCommand::AskSaveRecipe => ask_save(model, SaveContent::Recipe, "recipe.json"),
        RecordingCommand::SaveRecipe(path) => save(model, path),
        RecordingCommand::Finish => finish(model),
        RecordingCommand::Discard => {
            model.importing.open = None;
            model.importing.waiting.clear();
            (model.importing.replaces, model.importing.corrects) = (false, false);
            model.screen = model.previous_screen();
        }
    }
}

/// Shows the progress of reading; returns whether to continue.
pub(super) fn watch(task: &TaskHandle) -> impl Fn(f64) -> bool + '_ {
    |part| {
        task.tell(Some(part as f32), "");
        !task.cancelled()
    }
}

fn read(model: &mut Model, path: PathBuf) {
    model.messages.resolve(Cause::Opening);
    model.tasks.start(READING, move |task| {
        let result = match read_sources(&[path], &MemoryBudget::default(), &watch(task)) {
            Err(_) if task.cancelled() => Ok(None),
            Err(error) => Err(error.to_string()),
            Ok(sources) => Ok(Some(sources)),
        };
        RecordingOutcome::Read(result).into()
    });
}

/// Adds sources to the import, or begins a new import if the present one is already in a session.
pub(super) fn take(model: &mut Model, sources: Vec<Source>) {
    model.screen = Screen::Import;
    let Some(open) = &model.open else {
        model.importing.waiting.extend(sources);
        return;
    };
    let robot = open.session().robot.clone();
    let known = importing::last_recipe(open.session()).or(model.importing.last_recipe.clone());
    match &mut model.importing.open {
        Some(import) if !import.is_taken => import.add(sources, &robot),
        _ => model.importing.open = Some(OpenImport::new(sources, known, &robot)),
    }
    cut(model);
}

/// Opens the import of the session's poses again; asks for its sources, which a session file does not contain.
fn correct(model: &mut Model) {
    let can_correct = |open: &OpenSession| importing::can_import_again(open.session());
    if !model.open.as_ref().is_some_and(can_correct) {
        return;
    }
    (model.importing.replaces, model.importing.corrects) = (true, true);
    if let Some(import) = &mut model.importing.open {
        import.is_taken = false;
    }
    model.screen = Screen::Import;
    correct_channels(model);
}

/// Corrects the recipe from the check of its poses, which belongs to the present recipe.
fn correct_channels(model: &mut Model) {
    let open = model.importing.open.as_ref();
    if model.importing.corrects && open.is_some_and(OpenImport::is_current) {
        model.importing.corrects = false;
        apply(model, |_, suggestion| suggestion.mistake.is_of_channel());
    }
}

/// Continues with files that waited for a robot after a session was opened; the recipe of another robot is not used.
pub(super) fn opened(model: &mut Model) {
    model.importing.open = None;
    (model.importing.replaces, model.importing.corrects) = (false, false);
    let waiting = std::mem::take(&mut model.importing.waiting);
    if !waiting.is_empty() {
        take(model, waiting);
    }
}

/// Begins an import with a recipe, or applies it to the present import.
pub(super) fn use_recipe(model: &mut Model, name: &str, recipe: Recipe) {
    if model.importing.open.is_some() {
        let what = format!("use {name}");
        change(model, |open| open.draft.change(what, recipe, false));
        model.screen = Screen::Import;
    } else {
        model.importing.last_recipe = Some(recipe);
        let text = format!("{name}: is used for the next file that is imported.");
        model.messages.info(text);
    }
}

fn robot(model: &Model) -> Option<Robot> {
    model.open.as_ref().map(|open| open.session().robot.clone())
}

/// Changes the draft and cuts its poses again.
fn change(model: &mut Model, change: impl FnOnce(&mut OpenImport) -> bool) {
    let Some(robot) = robot(model) else {
        return;
    };
    if let Some(open) = &mut model.importing.open
        && change(open)
    {
        model.messages.resolve(Cause::Entry);
        open.follow(&robot);
        cut(model);
    }
}

fn remove(model: &mut Model, source: usize) {
    let Some(robot) = robot(model) else {
        return;
    };
    let Some(open) = &mut model.importing.open else {
        return;
    };
    if open.draft.sources().len() < 2 {
        return perform(model, RecordingCommand::Discard);
    }
    open.remove(source, &robot);
    cut(model);
}

/// Applies the wanted suggestions, selected by index, as one change.
fn apply(model: &mut Model, is_wanted: impl Fn(usize, &Suggestion) -> bool) {
    change(model, |open| {
        let all = open.suggestions().into_iter().enumerate();
        let wanted = all.filter(|(number, suggestion)| is_wanted(*number, suggestion));
        let mut recipe = open.draft.recipe().clone();
        let mut columns = Vec::new();
        for (_, suggestion) in wanted {
            suggestion.apply(&mut recipe);
            columns.extend(suggestion.columns);
        }
        let what = format!("correct {}", columns.join(", "));
        open.draft.change(what, recipe, false)
    });
}

/// Cuts poses in a task; if one is running, repeats it afterwards.
fn cut(model: &mut Model) {
    let Some(robot) = robot(model) else {
        return;
    };
    let Some(open) = &model.importing.open else {
        return;
    };
    if open.is_current() || model.tasks.runs(CUTTING) {
        return;
    }
    let revision = open.draft.revision();
    let sources = Arc::clone(open.draft.sources());
    let recipe = open.draft.recipe().clone();
    model.tasks.start(CUTTING, move |_| {
        let result = importing::cut(&sources, &recipe, &robot);
        let times = clock_times(&sources, &recipe, &robot);
        let checks = result.as_ref().map_or_else(
            |_| Vec::new(),
            |imported| {
                let measurements = imported.measurements.clone();
                check_readings(
                    &Dataset {
                        robot,
                        measurements,
                    },
                    None,
                )
            },
        );
        RecordingOutcome::Cut(Box::new(Cut {
            revision,
            result,
            checks,
            times,
        }))
        .into()
    });
}

fn align(model: &mut Model) {
    let (Some(open), Some(robot)) = (&model.importing.open, robot(model)) else {
        return;
    };
    let revision = open.draft.revision();
    let sources = Arc::clone(open.draft.sources());
    let mut recipe = open.draft.recipe().clone();
    model.tasks.start(ALIGNING, move |_| {
        let found = align_clocks(&sources, &mut recipe, &robot);
        let found = found.map_err(|error| error.to_string());
        let result = found.map(|clocks| (Box::new(recipe), clocks));
        RecordingOutcome::Aligned(revision, result).into()
    });
}

fn aligned(model: &mut Model, revision: u64, recipe: Recipe, clocks: &[AlignedClock]) {
    let open = model.importing.open.as_ref();
    if open.is_none_or(|open| open.draft.revision() != revision) {
        let text = "The recipe was changed while the clocks were aligned: align them again.";
        return model.messages.warning(text);
    }
    for clock in clocks {
        let text = sentence(&format!("{}.", clock.sentence));
        model.messages.info(text);
    }
    change(model, |open| {
        open.draft.change("align the clocks", recipe, false)
    });
}

fn save(model: &mut Model, path: PathBuf) {
    let Some(open) = &model.importing.open else {
        return;
    };
    let recipe = open.draft.recipe().clone();
    write(model, "Saving the recipe", path, move |path| {
        write_versioned(path, &recipe)
    });
}

fn finish(model: &mut Model) {
    let (Some(import), Some(open)) = (&mut model.importing.open, &mut model.open) else {
        return;
    };
    let cut = import.cut.clone().filter(|_| import.is_current());
    let Some(Ok(imported)) = cut.as_ref().map(|cut| &cut.result) else {
        return;
    };
    import.is_taken = true;
    let recipe = import.draft.recipe().clone();
    let sources = import.draft.sources().iter();
    let files: Vec<String> = sources
        .map(|source| file_label(Path::new(&source.file)))
        .collect();
    let name = files.join(", ");
    model.importing.last_recipe = Some(recipe.clone());
    let replaces = std::mem::take(&mut model.importing.replaces)
        && importing::can_import_again(open.session());
    if open.session().measurements.is_empty() || replaces {
        let poses = Arc::new(imported.measurements.clone());
        let count = poses.len();
        let done = format!("Imported {count} poses from {name}");
        changed(model, None, None, |open| {
            let again = if replaces { " again" } else { "" };
            let what = format!("import {name}{again}");
            open.edit(Edit::Import(poses, what.clone())).then_some(what)
        });
        if let Some(open) = &mut model.open {
            keep(open, &recipe, &done);
        }
        model.messages.info(format!("{done}."));
        model.screen = Screen::Phase(Phase::Identification);
        identification::reopened(model);
    } else {
        let robot = open.session().robot.clone();
        let mut session = importing::session_of(&name, robot, imported, clock::now());
        note(&mut session, &recipe, imported, &name);
        begin(model, session, None);
    }
}

fn keep(open: &mut OpenSession, recipe: &Recipe, done: &str) {
    open.log(LogPhase::Poses, format!("{done}."));
    let record = importing::recipe_record(open.session(), recipe, clock::now());
    open.add_result(record);
}

/// Stores the recipe and the source in a session that begins with an import.
fn note(session: &mut Session, recipe: &Recipe, imported: &Imported, name: &str) {
    let count = imported.measurements.len();
    session.record(tautline_session::LogEntry {
        time: clock::now(),
        phase: LogPhase::Poses,
        text: format!("Imported {count} poses from {name}."),
    });
    let record = importing::recipe_record(session, recipe, clock::now());
    session.add_result(record);
}

/// Whether undo, or redo if `again`, applies to the recipe.
pub(super) fn undoes(model: &Model, again: bool) -> bool {
    let open = model.importing.open.as_ref();
    let draft = open.filter(|_| model.screen == Screen::Import);
    draft.is_some_and(|open| match again {
        true => open.draft.next_redo().is_some(),
        false => open.draft.next_undo().is_some(),
    })
}

pub(super) fn undo(model: &mut Model) {
    change(model, |open| open.draft.undo().is_some());
}

pub(super) fn redo(model: &mut Model) {
    change(model, |open| open.draft.redo().is_some());
}

pub(super) fn receive(model: &mut Model, outcome: RecordingOutcome) {
    match outcome {
        RecordingOutcome::Read(Ok(Some(Loaded { value, notices }))) => {
            model.messages.warnings(notices);
            take(model, value);
        }
        RecordingOutcome::Read(Ok(None)) => model.messages.info("Reading was stopped."),
        RecordingOutcome::Read(Err(error)) | RecordingOutcome::Recipe(_, Err(error)) => {
            model.messages.failure(Cause::Opening, sentence(&error));
        }
        RecordingOutcome::Recipe(path, Ok(loaded)) => {
            let Loaded { value, notices } = *loaded;
            model.messages.warnings(notices);
            use_recipe(model, &file_label(&path), value);
        }
        RecordingOutcome::Aligned(revision, Ok((recipe, clocks))) => {
            aligned(model, revision, *recipe, &clocks);
        }
        RecordingOutcome::Aligned(_, Err(error)) => {
            model.messages.failure(Cause::Entry, sentence(&error));
        }
        RecordingOutcome::Cut(done) => {
            if let Some(open) = &mut model.importing.open {
                open.cut = Some(Arc::from(done));
            }
            correct_channels(model);
            cut(model);
        }
    }
}
