//! Dialogs above the screen.

use std::path::{Path, PathBuf};

use tautline_session::SymbolMapping;

use super::command::file_choice::FileChooser;
use super::command::{
    Command, Export, FileCommand, HypothesisCommand, Opening, PendingAction, PlotCommand, PlotFile,
    RecordingCommand, ReportDraft, RobotCommand, Setup, WriteDraft,
};
use super::manual;
use super::save_form::SaveForm;

#[derive(Debug, Default)]
pub struct Dialogs {
    /// Question about unsaved changes or an armed robot.
    pub(crate) pending: Option<PendingActionDraft>,
    /// Session that is open in another window, with the time since when.
    pub elsewhere: Option<(Box<Opening>, String)>,
    /// Save dialog.
    pub(crate) save: Option<SaveDraft>,
    /// The program's own file chooser.
    pub(crate) chooser: Option<FileChooser>,
    /// Text of the command palette, while it is open.
    pub palette: Option<String>,
    /// Values that wait for confirmation before they are written.
    pub writing: Option<WriteDraft>,
    /// Report dialog.
    pub report: Option<ReportDraft>,
    pub log: bool,
    /// Open page of the manual.
    pub manual: Option<manual::Page>,
    /// Whether the *About* window is open.
    pub about: bool,
}

impl Dialogs {
    pub fn set_palette(&mut self, open: bool) {
        self.palette = open.then(|| self.palette.take().unwrap_or_default());
    }

    /// Closes the dialog that waits for this file to be written.
    pub(crate) fn close(&mut self, path: &Path) {
        self.save.take_if(|draft| draft.form.waits_for(path));
        self.report.take_if(|draft| draft.form.waits_for(path));
    }

    /// Error field of the dialog that waits for this file to be written, or of the question that was answered with
    /// *Save*.
    pub(crate) fn failure(&mut self, path: &Path) -> Option<&mut Option<String>> {
        let save = self.save.as_mut().map(|draft| &mut draft.form);
        let report = self.report.as_mut().map(|draft| &mut draft.form);
        let mut forms = save.into_iter().chain(report);
        if let Some(form) = forms.find(|form| form.waits_for(path)) {
            form.writing = None;
            return Some(&mut form.failure);
        }
        self.pending.as_mut().map(|draft| &mut draft.failure)
    }
}

/// Action that closes the session or its connection, until it is confirmed.
#[derive(Debug)]
pub(crate) struct PendingActionDraft {
    pub(crate) action: PendingAction,
    pub(crate) failure: Option<String>,
    /// Whether the operator agrees to disconnect an armed controller.
    pub(crate) may_disarm: bool,
}

impl From<PendingAction> for PendingActionDraft {
    fn from(action: PendingAction) -> Self {
        Self {
            action,
            failure: None,
            may_disarm: false,
        }
    }
}

/// File to be saved.
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

    /// Command that writes the file.
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
