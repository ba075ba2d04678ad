//! Dialogs above the screen.

use std::path::{Path, PathBuf};

use tautline_session::SymbolMapping;

use super::command::file_choice::FileChooser;
use super::command::{
    Command, Export, FileCommand, HypothesisCommand, Leaving, Opening, PlotCommand, PlotFile,
    RecordingCommand, ReportDraft, RobotCommand, Setup, WriteDraft,
};
use super::manual;
use super::save_form::SaveForm;

#[derive(Debug, Default)]
pub struct Dialogs {
    /// What waits for an answer about unsaved changes or an armed robot.
    pub(crate) leaving: Option<LeavingDraft>,
    /// A session that is open in another window, and since when.
    pub elsewhere: Option<(Box<Opening>, String)>,
    /// The file that is to be saved, while its place is asked for.
    pub(crate) save: Option<SaveDraft>,
    /// The window that asks for a file.
    pub(crate) chooser: Option<FileChooser>,
    /// What was typed into the command palette, while it is open.
    pub palette: Option<String>,
    /// Values that are to be written, while that is to be confirmed.
    pub writing: Option<WriteDraft>,
    /// The report that is to be saved, while that dialog is open.
    pub report: Option<ReportDraft>,
    pub log: bool,
    /// The page of the manual that is open.
    pub manual: Option<manual::Page>,
    /// Whether it is shown what the program is made of.
    pub about: bool,
}

impl Dialogs {
    pub fn set_palette(&mut self, open: bool) {
        self.palette = open.then(|| self.palette.take().unwrap_or_default());
    }

    /// A file was written: the dialog that waited for it is done.
    pub(crate) fn close(&mut self, path: &Path) {
        self.save.take_if(|draft| draft.form.waits_for(path));
        self.report.take_if(|draft| draft.form.waits_for(path));
    }

    /// Where an error of writing is shown: in the dialog that waits for it, or in the question that was answered with
    /// saving.
    pub(crate) fn failure(&mut self, path: &Path) -> Option<&mut Option<String>> {
        let save = self.save.as_mut().map(|draft| &mut draft.form);
        let report = self.report.as_mut().map(|draft| &mut draft.form);
        let mut forms = save.into_iter().chain(report);
        if let Some(form) = forms.find(|form| form.waits_for(path)) {
            form.writing = None;
            return Some(&mut form.failure);
        }
        self.leaving.as_mut().map(|draft| &mut draft.failure)
    }
}

/// What takes session or controller away, while that is to be confirmed.
#[derive(Debug)]
pub(crate) struct LeavingDraft {
    pub(crate) leaving: Leaving,
    pub(crate) failure: Option<String>,
    /// Whether the operator agrees that an armed controller is disconnected.
    pub(crate) may_disarm: bool,
}

impl From<Leaving> for LeavingDraft {
    fn from(leaving: Leaving) -> Self {
        Self {
            leaving,
            failure: None,
            may_disarm: false,
        }
    }
}

/// A file that is to be saved.
#[derive(Debug, Clone)]
pub(crate) struct SaveDraft {
    pub(crate) form: SaveForm,
    pub(crate) content: SaveContent,
}

#[derive(Debug, Clone)]
pub(crate) enum SaveContent {
    Session,
    Recipe,
    Symbols(Box<SymbolMapping>),
    Export(Export),
    Plot(PlotFile),
    Hypothesis,
    Gallery,
}

impl SaveContent {
    pub(crate) fn title(&self) -> &'static str {
        match self {
            Self::Session => "Save the session as",
            Self::Recipe => "Save the recipe as",
            Self::Symbols(_) => "Save the names of symbols as",
            Self::Export(Export::Plan) => "Save the plan as",
            Self::Export(Export::Differences) => "Save the differences as",
            Self::Export(Export::StructuredText) => "Save the parameters as",
            Self::Export(Export::Check) => "Save the verification as",
            Self::Plot(_) => "Save the plot as",
            Self::Hypothesis => "Save the hypothesis as",
            Self::Gallery => "Save the gallery as HTML",
        }
    }

    /// Writes it to a file.
    pub(crate) fn command(&self, path: PathBuf) -> Command {
        match self.clone() {
            Self::Session => FileCommand::SaveAs(path).into(),
            Self::Recipe => RecordingCommand::SaveRecipe(path).into(),
            Self::Symbols(mapping) => RobotCommand::Setup(Setup::Export(path, mapping)).into(),
            Self::Export(export) => RobotCommand::Export(export, path).into(),
            Self::Plot(file) => PlotCommand::Save(path, file).into(),
            Self::Hypothesis => HypothesisCommand::Save(path).into(),
            Self::Gallery => HypothesisCommand::SaveGallery(path).into(),
        }
    }
}
