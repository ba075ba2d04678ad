//! State of the application: the model, and the state of screens and views.

use crate::model::command::Outbox;
use crate::model::{Model, Options};
use crate::screens::PanelStates;
use crate::views::ViewStates;
use crate::views::plots::Panes;
use crate::views::report_picture::report_picture;

pub struct AppState {
    pub model: Model,
    /// Commands given in this frame.
    pub outbox: Outbox,
    pub panels: PanelStates,
    pub views: ViewStates,
}

impl AppState {
    /// State at the start of the program.
    #[must_use]
    pub fn new(context: &egui::Context, options: Options) -> Self {
        let model = Model::new(context, options, report_picture);
        Self {
            views: ViewStates::of(Panes::of(&model.preferences.plots)),
            panels: PanelStates::default(),
            outbox: Outbox::default(),
            model,
        }
    }
}
