//! Record of a robot: displacements and drift of its parts over the sessions.

mod chooser;
mod lanes;
mod sessions;

use std::sync::Arc;

use egui::{CentralPanel, Panel, ScrollArea, Slider, Spinner, Ui};
use nalgebra::DVector;
use tautline_core::geometry::Vec3;
use tautline_core::history::{CERTAIN, RobotPart};
use tautline_workflow::health::HealthVerdict;
use tautline_workflow::history::{
    POSITION_TOLERANCE_M, Tolerance, changes as told, next_calibration,
};
use tautline_workflow::plot::Selection;
use tautline_workflow::wording::units::mm;

use crate::model::Model;
use crate::model::command::{Outbox, READING_RECORD, RecordCommand};
use crate::model::part::ScreenPart;
use crate::model::record::{CheckedPair, OpenRecord};
use crate::theme::GRID;
use crate::views::ViewStates;
use crate::views::robot_3d::scene::{Displacement, PulleyPaths, Scene, SceneInputs, SideNames};
use crate::views::robot_3d::show_beside;
use crate::widgets::{
    Entered, Number, UiExt, Verdict, choice, number_checked, one_part, panel_frame,
};

#[derive(Debug, Default)]
pub struct PanelState {
    path: String,
    /// Session whose pulleys are shown in 3D, by its index in order of time.
    shown: usize,
    /// Sessions selected for a comparison, in the order of clicks.
    chosen: Vec<usize>,
    /// Part shown in a small window.
    part: ScreenPart,
    /// Record drawn last.
    drawn: Option<RecordView>,
}

/// Record prepared for drawing.
#[derive(Debug)]
struct RecordView {
    open: Arc<OpenRecord>,
    shown: usize,
    /// Pulleys of the first session and of the shown one.
    scene: Arc<Scene>,
    lanes: lanes::Lanes,
}

impl RecordView {
    fn new(ui: &Ui, open: &Arc<OpenRecord>, shown: usize) -> Self {
        Self {
            scene: Arc::new(scene(open, shown)),
            lanes: lanes::Lanes::new(open, ui.ctx().cumulative_pass_nr()),
            shown,
            open: Arc::clone(open),
        }
    }
}

/// Width of the window (points) below which one part is shown at a time.
const COMPACT: f32 = 900.0;
/// Parts, and their titles in a small window.
const PARTS: [(ScreenPart, &str); 3] = [
    (ScreenPart::Panel, "Changes"),
    (ScreenPart::Robot, "3D view"),
    (ScreenPart::Plots, "Courses"),
];
/// Names of the two sets of pulleys in the 3D view.
const NAMES: SideNames = SideNames {
    first: "first session",
    second: "chosen session",
};

pub fn show(
    ui: &mut Ui,
    model: &Model,
    panel: &mut PanelState,
    views: &mut ViewStates,
    outbox: &mut Outbox,
) {
    Panel::top("record")
        .frame(panel_frame(ui))
        .show(ui, |ui| chooser::show(ui, model, panel, outbox));
    match model.record.result() {
        Some(Ok(open)) => opened(ui, model, open, panel, views, outbox),
        Some(Err(error)) => {
            ui.add_space(6.0 * GRID);
            ui.horizontal(|ui| {
                ui.add_space(3.0 * GRID);
                ui.bad(error);
            });
        }
        None if model.tasks.runs(READING_RECORD) => {
            ui.centered_and_justified(|ui| ui.add(Spinner::new()));
        }
        None => ui.empty("Choose a folder with the sessions of one robot. The record shows what moved between which dates, what drifts, and when \
             to calibrate again."),
    }
}

fn opened(
    ui: &mut Ui,
    model: &Model,
    open: &Arc<OpenRecord>,
    panel: &mut PanelState,
    views: &mut ViewStates,
    outbox: &mut Outbox,
) {
    let last = open.record.sessions.len() - 1;
    let known = panel.drawn.take();
    let is_same = |drawn: &RecordView| drawn.open.folder == open.folder;
    if !known.as_ref().is_some_and(is_same) {
        views.record_3d.look_anew();
        (panel.shown, panel.chosen) = (last, Vec::new());
    }
    panel.shown = panel.shown.min(last);
    let known = known.filter(|drawn| Arc::ptr_eq(&drawn.open, open));
    let mut drawn = known.unwrap_or_else(|| RecordView::new(ui, open, panel.shown));
    if drawn.shown != panel.shown {
        drawn.scene = Arc::new(scene(open, panel.shown));
        drawn.shown = panel.shown;
    }
    let mut part = panel.part;
    let draw = |ui: &mut Ui, part: ScreenPart| match part {
        ScreenPart::Panel => changes(ui, model, &drawn, panel, outbox),
        ScreenPart::Robot => robot(ui, model, &drawn, panel, views, outbox),
        ScreenPart::Plots => lanes::show(ui, model, &drawn.lanes, outbox),
    };
    if ui.available_width() < COMPACT {
        one_part(ui, &mut part, PARTS, draw);
    } else {
        wide(ui, draw);
    }
    panel.part = part;
    panel.drawn = Some(drawn);
}

/// All parts side by side.
fn wide(ui: &mut Ui, mut draw: impl FnMut(&mut Ui, ScreenPart)) {
    let side = panel_frame(ui);
    Panel::right("what changed")
        .frame(side)
        .default_size(560.0)
        .size_range(420.0..=760.0)
        .show(ui, |ui| draw(ui, ScreenPart::Panel));
    let height = 0.5 * ui.available_height();
    Panel::bottom("courses")
        .frame(side)
        .default_size(height)
        .size_range(160.0..=1.6 * height)
        .show(ui, |ui| draw(ui, ScreenPart::Plots));
    CentralPanel::no_frame().show(ui, |ui| draw(ui, ScreenPart::Robot));
}

/// Pulleys in 3D at a date, and the slider for it.
fn robot(
    ui: &mut Ui,
    model: &Model,
    drawn: &RecordView,
    panel: &mut PanelState,
    views: &mut ViewStates,
    outbox: &mut Outbox,
) {
    let sessions = &drawn.open.record.sessions;
    Panel::bottom("date")
        .frame(panel_frame(ui))
        .resizable(false)
        .show(ui, |ui| {
            ui.horizontal(|ui| {
                let label = ui.label("Session");
                ui.spacing_mut().slider_width = (ui.available_width() - 160.0).max(80.0);
                let slider = Slider::new(&mut panel.shown, 0..=sessions.len() - 1);
                let name = |value: f64, _: std::ops::RangeInclusive<usize>| {
                    let session = sessions.get(value as usize);
                    session.map_or_else(String::new, |session| session.date_or_name())
                };
                ui.add(slider.custom_formatter(name)).labelled_by(label.id);
            });
            ui.muted(&path_in_words(drawn, model.selection));
        });
    let (view, hovered) = (&mut views.record_3d, &mut views.hovered);
    show_beside(ui, &drawn.scene, model.selection, view, hovered, outbox);
}

/// Text on the path of the selected pulley.
fn path_in_words(drawn: &RecordView, selection: Selection) -> String {
    let moved = |index: usize| drawn.scene.cables.get(index)?.moved;
    let selected = selection.cable;
    let Some((index, moved)) = selected.and_then(|index| Some((index, moved(index)?))) else {
        return "Select a pulley to see its path over the sessions.".to_owned();
    };
    format!(
        "Path of {}: {} mm from its place in the first session; the ring is the chosen one.",
        drawn.open.record.robot().cables[index].name,
        mm(moved.by.norm(), 1)
    )
}

/// Panel on the right: changes, date of the next calibration, sessions.
fn changes(
    ui: &mut Ui,
    model: &Model,
    drawn: &RecordView,
    panel: &mut PanelState,
    outbox: &mut Outbox,
) {
    let open = &drawn.open;
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        let kind = match open.found.is_certain() {
            true => Verdict::Doubtful,
            false => Verdict::Good,
        };
        for sentence in told(&open.record, &open.found) {
            ui.verdict(kind, &sentence);
        }
        if let Some(sentence) = next_calibration(&open.record, &open.found) {
            ui.neutral(&sentence);
        }
        for notice in &open.record.notices {
            ui.muted(notice);
        }
        ui.add_space(GRID);
        tolerance(ui, model.record.tolerance, outbox);
        ui.section("Sessions");
        sessions::show(ui, open, panel, outbox);
        if let Some(checked) = &model.record.checked {
            health(ui, open, checked);
        }
        ui.add_space(4.0 * GRID);
    });
}

/// Chooses the monitored quantity and its limit.
fn tolerance(ui: &mut Ui, known: Tolerance, outbox: &mut Outbox) {
    ui.horizontal(|ui| {
        ui.label("Tolerance of");
        let of_pulleys = matches!(known, Tolerance::Pulley(_));
        let mut chosen = of_pulleys;
        choice(ui, &mut chosen, true, "pulleys");
        choice(ui, &mut chosen, false, "platform position").on_hover_text(
            "Root mean square position error over the workspace, of a controller with the values of the last session",
        );
        if chosen != of_pulleys {
            outbox.send(RecordCommand::SetTolerance(match chosen {
                true => Tolerance::default(),
                false => Tolerance::Position {
                    limit_m: POSITION_TOLERANCE_M,
                    volume: None,
                },
            }));
        }
        let field = Number::of("Tolerance", 1e3 * known.limit_m(), 2, "mm", 64.0);
        let check = |typed: f64| match typed > 0.0 {
            true => Ok(()),
            false => Err(format!("found {typed}, expected a positive number")),
        };
        if let Some(Entered::Value(typed)) = number_checked(ui, &field, &check) {
            outbox.send(RecordCommand::SetTolerance(known.with_limit(1e-3 * typed)));
        }
    });
}

/// Result of a health check.
fn health(ui: &mut Ui, open: &OpenRecord, checked: &CheckedPair) {
    let [before, now] = checked
        .sessions
        .map(|k| open.record.sessions[k].name.as_str());
    ui.section(&format!("Health check: {now} against {before}"));
    match &checked.result {
        Ok((found, sentences)) => {
            let kind = match found {
                HealthVerdict::Unchanged => Verdict::Good,
                HealthVerdict::Changed => Verdict::Bad,
                HealthVerdict::Undecided => Verdict::Doubtful,
            };
            let mut sentences = sentences.iter();
            if let Some(first) = sentences.next() {
                ui.verdict(kind, first);
            }
            for sentence in sentences {
                ui.muted(sentence);
            }
        }
        Err(error) => ui.bad(error),
    }
}

/// Pulleys of the first session, and of the shown one.
fn scene(open: &OpenRecord, shown: usize) -> Scene {
    let first = &open.record.sessions[0].identification;
    let subject = SceneInputs {
        fit: Some(first),
        ..SceneInputs::new(&first.dataset.robot, &first.dataset.measurements)
    };
    let cables = 0..open.record.robot().cables.len();
    let paths = PulleyPaths {
        by: cables.clone().map(|cable| path(open, cable)).collect(),
        date: shown,
    };
    let displacements = cables.map(|cable| displacement(open, cable, shown, &paths));
    let mut scene = subject.scene().beside(NAMES, displacements);
    scene.paths = Some(paths);
    scene
}

/// Index of a pulley among the parts of the record.
fn part_of(open: &OpenRecord, cable: usize) -> Option<usize> {
    let mut parts = open.found.history.parts.iter();
    parts.position(|part| *part == RobotPart::Pulley(cable))
}

/// Displacements of a pulley from the first session, in each session.
fn path(open: &OpenRecord, cable: usize) -> Vec<Vec3> {
    let history = &open.found.history;
    let Some(part) = part_of(open, cable) else {
        return Vec::new();
    };
    let states = &history.states[part];
    let by = |value: &DVector<f64>| {
        let mut by = Vec3::zeros();
        for (axis, value) in history.axes[part]
            .iter()
            .zip((value - &states[0].value).iter())
        {
            by[*axis] = *value;
        }
        by
    };
    states.iter().map(|state| by(&state.value)).collect()
}

/// Displacement of a pulley from the first session to the shown one.
fn displacement(
    open: &OpenRecord,
    cable: usize,
    shown: usize,
    paths: &PulleyPaths,
) -> Displacement {
    let history = &open.found.history;
    let mut displacement = Displacement {
        from: Default::default(),
        by: paths.by[cable].get(shown).copied().unwrap_or_default(),
        covariance: None,
        is_explained: true,
        moved: Some(false),
    };
    let Some(part) = part_of(open, cable) else {
        return displacement;
    };
    let mut jumps = history.jumps.iter();
    let has_jumped = jumps
        .any(|jump| jump.part == part && jump.between[1] <= shown && jump.probability >= CERTAIN);
    let mut drifts = history.evident_drifts();
    let drifts = drifts.any(|drift| drift.part == part && drift.probability >= CERTAIN);
    displacement.moved = Some(has_jumped || drifts && shown > 0);
    displacement
}

/// Selection for a part of the robot.
fn selection_of(part: &RobotPart) -> Option<Selection> {
    match part {
        RobotPart::Pulley(cable) => Some(Selection::cable(*cable)),
        RobotPart::TargetPlane | RobotPart::Effect { .. } => None,
    }
}
