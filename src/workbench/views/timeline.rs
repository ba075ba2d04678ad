//! Time line of the measured poses; the pose selected on it is shown in all views.

use egui::{
    Align, EventFilter, Key, Layout, Rect, Response, Sense, Stroke, Ui, WidgetInfo, pos2, vec2,
};
use egui_material_icons::icons;

use super::ViewStates;
use super::robot_3d::scene::Scene;
use crate::model::command::{Outbox, PoseStep, ViewCommand};
use crate::model::{Model, OpenSession, Selection};
use crate::theme::{self, GRID, Palette};
use crate::widgets::{UiExt, icon_only};
use tautline_workflow::wording::count;

/// Height of the time line with its margins (points).
pub const HEIGHT: f32 = 40.0;
/// Duration of each pose during playback (s); a recording of a motion is played at its own speed.
const EACH_S: f64 = 0.35;
/// Longest mean interval between the samples of a recording of a motion (s).
const LONGEST_STEP_S: f64 = 0.2;
/// Width of the text at the end (points).
const WORDS: f32 = 120.0;
/// Smallest distance between two marks (points).
const APART: f32 = 3.0;

#[derive(Debug, Default)]
pub struct TimelineState {
    /// Time at which the present pose was reached during playback (s).
    reached_s: Option<f64>,
    /// Start of the playback of a recording: time of the window, and time of the recording (s).
    began_s: Option<(f64, f64)>,
}

pub fn show(ui: &mut Ui, model: &Model, views: &mut ViewStates, outbox: &mut Outbox) {
    let Some(open) = &model.open else {
        return;
    };
    let labels = &open.session().measurements.labels;
    let selected = model.selection.pose;
    let plays = model.playback.plays;
    let times_s = &open.session().measurements.time_s;
    let mut commands = match plays && is_recording(labels, times_s) {
        true => play_recording(ui, &mut views.timeline, labels, times_s, selected),
        false => play(ui, plays, &mut views.timeline, labels, selected),
    };
    ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
        ui.spacing_mut().item_spacing.x = GRID;
        for (icon, name, command) in [
            (
                icons::ICON_SKIP_PREVIOUS,
                "Previous pose",
                ViewCommand::Pose(PoseStep::Previous),
            ),
            match plays {
                true => (icons::ICON_PAUSE, "Pause", ViewCommand::Play(false)),
                false => (
                    icons::ICON_PLAY_ARROW,
                    "Play poses",
                    ViewCommand::Play(true),
                ),
            },
            (
                icons::ICON_SKIP_NEXT,
                "Next pose",
                ViewCommand::Pose(PoseStep::Next),
            ),
        ] {
            if icon_only(ui, icon, name, true).clicked() {
                commands.push(command);
            }
        }
        let is_moving = model.link.is_busy() || model.link.polls_when_idle;
        if model.link.is_connected() && (is_moving || model.link.is_stopped) {
            let follows = model.playback.follows;
            let name = if is_moving { "Live" } else { "Stopped" };
            let live = ui.selectable_label(follows, name);
            if live
                .on_hover_text("Show the current pose of the robot")
                .clicked()
            {
                commands.push(ViewCommand::Follow(!follows));
            }
        }
        let scene = views.robot_3d.scene().map(AsRef::as_ref);
        let selection = model.selection;
        commands.extend(track(ui, open, scene, selection, plays));
        let place = selected.and_then(|pose| labels.iter().position(|label| *label == pose));
        ui.add_space(GRID);
        ui.muted(&words(labels, place));
    });
    for command in commands {
        outbox.send(command);
    }
}

/// Advances the playback to the next pose when its time has come.
fn play(
    ui: &Ui,
    plays: bool,
    view: &mut TimelineState,
    labels: &[i64],
    selected: Option<i64>,
) -> Vec<ViewCommand> {
    view.began_s = None;
    if !plays {
        view.reached_s = None;
        return Vec::new();
    }
    // The first pose is shown at once.
    let since = view.reached_s.unwrap_or(f64::NEG_INFINITY);
    let now = ui.input(|input| input.time);
    ui.ctx()
        .request_repaint_after(std::time::Duration::from_secs_f64(EACH_S));
    if now - since < EACH_S {
        return Vec::new();
    }
    if selected.is_some() && selected == labels.last().copied() && since.is_finite() {
        return vec![ViewCommand::Play(false)];
    }
    view.reached_s = Some(now);
    let is_at_end = selected == labels.last().copied();
    let step = if is_at_end {
        PoseStep::First
    } else {
        PoseStep::Next
    };
    vec![ViewCommand::Pose(step)]
}

/// Whether the poses are samples of a recording of a motion, by their mean interval.
fn is_recording(labels: &[i64], times_s: &[f64]) -> bool {
    match (times_s, labels.len()) {
        ([first, .., last], count) if times_s.len() == count => {
            *last > *first && last - first < LONGEST_STEP_S * count as f64
        }
        _ => false,
    }
}

/// Advances the playback to the sample of the present time.
fn play_recording(
    ui: &Ui,
    view: &mut TimelineState,
    labels: &[i64],
    times_s: &[f64],
    selected: Option<i64>,
) -> Vec<ViewCommand> {
    let now = ui.input(|input| input.time);
    ui.ctx().request_repaint();
    let (began, from_s) = *view.began_s.get_or_insert_with(|| {
        let place = selected.and_then(|pose| labels.iter().position(|label| *label == pose));
        let place = place.filter(|place| place + 1 < labels.len()).unwrap_or(0);
        (now, times_s[place])
    });
    let after = times_s.partition_point(|time| *time <= from_s + now - began);
    let label = labels[after.saturating_sub(1)];
    let mut commands = Vec::new();
    if selected != Some(label) {
        commands.push(ViewCommand::Pose(PoseStep::To(label)));
    }
    if after == labels.len() {
        commands.push(ViewCommand::Play(false));
    }
    commands
}

/// Label of the pose and its number, without the home pose.
fn words(labels: &[i64], place: Option<usize>) -> String {
    let poses = |labels: &[i64]| labels.iter().filter(|label| **label != 0).count();
    let all = poses(labels);
    match place {
        None => count(all, "pose"),
        Some(place) if labels[place] == 0 => "Home".to_owned(),
        Some(place) => format!(
            "Pose {}, {} of {all}",
            labels[place],
            poses(&labels[..=place])
        ),
    }
}

/// Line with a mark for each pose, in the colour of its residual.
fn track(
    ui: &mut Ui,
    open: &OpenSession,
    scene: Option<&Scene>,
    selection: Selection,
    plays: bool,
) -> Vec<ViewCommand> {
    let session = open.session();
    let labels = &session.measurements.labels;
    let width = (ui.available_width() - WORDS).max(40.0);
    let (rect, response) = ui.allocate_exact_size(vec2(width, 6.0 * GRID), Sense::click_and_drag());
    let place = selection
        .pose
        .and_then(|pose| labels.iter().position(|label| *label == pose));
    let value = place.map_or(0.0, |place| place as f64 + 1.0);
    response.widget_info(|| WidgetInfo::slider(true, value, "Pose timeline"));
    let line = rect.shrink2(vec2(2.0 * GRID, 0.0));
    let palette = theme::of(ui);
    paint(ui, open, scene, line, palette);
    let last = labels.len().saturating_sub(1).max(1) as f32;
    let x = |place: usize| line.min.x + line.width() * place as f32 / last;
    if let Some(place) = place {
        let ring = if response.has_focus() { 7.0 } else { 5.5 };
        let at = pos2(x(place), line.center().y);
        ui.painter().circle_filled(at, ring, palette.accent);
    }
    let mut commands = keys(ui, &response, plays);
    let under = response.hover_pos().or(response.interact_pointer_pos());
    let found = under.and_then(|at| {
        let share = ((at.x - line.min.x) / line.width()).clamp(0.0, 1.0);
        let place = (share * last).round() as usize;
        Some((place, *labels.get(place)?))
    });
    if let Some((place, label)) = found {
        if (response.clicked() || response.dragged()) && selection.pose != Some(label) {
            commands.push(ViewCommand::Scrub(label));
        }
        let mut text = words(labels, Some(place));
        if session.excluded().contains(&label) {
            text += ", excluded";
        }
        response.on_hover_text_at_pointer(text);
    }
    commands
}

fn paint(ui: &Ui, open: &OpenSession, scene: Option<&Scene>, line: Rect, palette: &Palette) {
    let session = open.session();
    let labels = &session.measurements.labels;
    let middle = line.center().y;
    let painter = ui.painter();
    painter.hline(line.x_range(), middle, Stroke::new(1.0, palette.line));
    let last = labels.len().saturating_sub(1).max(1);
    let most = (line.width() / APART).max(1.0) as usize;
    let step = labels.len().div_ceil(most).max(1);
    for (place, label) in labels.iter().enumerate().step_by(step) {
        let measured = scene.and_then(|scene| scene.measured.of(place, *label));
        let residual = measured.and_then(|pose| pose.residual);
        let colour = residual.map_or(palette.muted, |residual| palette.residual(residual));
        let is_left_out = session.excluded().contains(label);
        let half = if is_left_out { 1.5 } else { 5.0 };
        let x = line.min.x + line.width() * place as f32 / last as f32;
        let ends = middle - half..=middle + half;
        painter.vline(x, ends, Stroke::new(1.5, colour));
    }
}

/// Commands of its keys, while it has the focus or the pointer is over it.
fn keys(ui: &Ui, response: &Response, plays: bool) -> Vec<ViewCommand> {
    if response.clicked() {
        response.request_focus();
    }
    if response.has_focus() {
        let filter = EventFilter {
            horizontal_arrows: true,
            ..Default::default()
        };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
    }
    let elsewhere = ui.egui_wants_keyboard_input() && !response.has_focus();
    if elsewhere || !(response.has_focus() || response.hovered()) {
        return Vec::new();
    }
    let steps = [
        (Key::ArrowLeft, ViewCommand::Pose(PoseStep::Previous)),
        (Key::ArrowRight, ViewCommand::Pose(PoseStep::Next)),
        (Key::Home, ViewCommand::Pose(PoseStep::First)),
        (Key::End, ViewCommand::Pose(PoseStep::Last)),
        (Key::Space, ViewCommand::Play(!plays)),
    ];
    ui.input(|input| {
        let pressed = |key| input.modifiers.is_none() && input.key_pressed(key);
        let asked = steps.into_iter().filter(|(key, _)| pressed(*key));
        asked.map(|(_, command)| command).collect()
    })
}
