//! Measuring until goals are reached: the goals, and the assessment after each pose.

use egui::Ui;
use tautline_core::sequential::{Assessment, FIRST_POSES, Goal};
use tautline_session::UntilSettings;
use tautline_workflow::sequential::{SequentialRun, UntilDocument};
use tautline_workflow::wording::{sentence, units};

use crate::model::command::{Command, Outbox};
use crate::model::edit::Edit;
use crate::model::link::RunLog;
use crate::model::{Memo, Model};
use crate::theme::{self, GRID};
use crate::widgets::{Entered, Number, UiExt, Verdict, checkbox, meter, number_checked};

/// State between frames.
#[derive(Debug)]
pub(super) struct UntilState {
    /// Goals as set last, one of each kind, including disabled ones.
    offered: [Goal; 3],
    /// Assessment, by session and revision, and by the end of the run, which does not change the revision.
    known: Memo<(u64, u64, Option<&'static str>), UntilDocument>,
}

impl Default for UntilState {
    fn default() -> Self {
        Self {
            offered: [
                Goal::Cause(0.95),
                Goal::FaultFree(0.95),
                // Usual accuracy of a mounted frame.
                Goal::Accuracy(2e-3),
            ],
            known: Memo::default(),
        }
    }
}

/// Input of one kind of goal.
struct GoalField {
    /// Description of the goal.
    text: &'static str,
    /// Name of the field.
    name: &'static str,
    unit: &'static str,
    /// Displayed units per unit of the goal.
    scale: f64,
}

fn entry(goal: Goal) -> GoalField {
    let percent = |text, name| GoalField {
        text,
        name,
        unit: "%",
        scale: 100.0,
    };
    match goal {
        Goal::Accuracy(_) => GoalField {
            text: "All pulleys are accurate to",
            name: "Accuracy of the pulleys",
            unit: "mm",
            scale: 1e3,
        },
        Goal::Cause(_) => percent("The cause is found, with", "Probability of the cause"),
        Goal::FaultFree(_) => percent(
            "The robot is free of faults, with",
            "Probability of no fault",
        ),
    }
}

fn amount(goal: Goal) -> f64 {
    match goal {
        Goal::Accuracy(amount) | Goal::Cause(amount) | Goal::FaultFree(amount) => amount,
    }
}

fn is_same_kind(one: Goal, other: Goal) -> bool {
    one.name() == other.name()
}

/// Draws the switch and, if it is on, the goals.
pub(super) fn settings(ui: &mut Ui, model: &Model, state: &mut UntilState, outbox: &mut Outbox) {
    let Some(open) = &model.open else {
        return;
    };
    let before = &open.session().settings.until;
    let mut until = before.clone();
    ui.add_enabled_ui(!model.link.is_busy(), |ui| {
        checkbox(ui, &mut until.enabled, "Measure until certain");
        if until.enabled {
            ui.indent("goals", |ui| {
                goals(ui, state, &mut until, outbox);
                limit(ui, &mut until, outbox);
                checkbox(ui, &mut until.only_planned, "Only poses of the plan");
            });
        }
    });
    if until != *before {
        outbox.send(Edit::SetUntil(until));
    }
    if !before.enabled {
        return;
    }
    match model.undecidable() {
        Some(why) => ui.doubtful(why),
        None => {
            ui.muted("Every pose is chosen by what the poses before have told. The run ends when all goals are reached, when no pose \
                 would help, or at the largest number.");
        }
    }
}

/// Row for each kind of goal.
fn goals(ui: &mut Ui, state: &mut UntilState, until: &mut UntilSettings, outbox: &mut Outbox) {
    for offered in &mut state.offered {
        let asked = until
            .goals
            .iter()
            .position(|goal| is_same_kind(*goal, *offered));
        if let Some(place) = asked {
            *offered = until.goals[place];
        }
        let mut is_asked = asked.is_some();
        let GoalField {
            text,
            name,
            unit,
            scale,
        } = entry(*offered);
        ui.horizontal(|ui| {
            checkbox(ui, &mut is_asked, text);
            let decimals = match offered {
                Goal::Accuracy(_) => 2,
                Goal::Cause(_) | Goal::FaultFree(_) => 0,
            };
            let field = Number::of(name, scale * amount(*offered), decimals, unit, 48.0);
            let with = |typed: f64| format!("{}={typed}{unit}", offered.name()).parse::<Goal>();
            let check = |typed: f64| match (with(typed), *offered) {
                (Ok(_), _) => Ok(()),
                (Err(_), Goal::Accuracy(_)) => {
                    Err(format!("found {typed}, expected a positive number"))
                }
                (Err(error), _) => Err(error.to_string()),
            };
            match number_checked(ui, &field, &check) {
                Some(Entered::Value(typed)) => *offered = with(typed).unwrap_or(*offered),
                Some(Entered::Wrong(message)) => outbox.send(Command::Refuse(message)),
                Some(Entered::Nothing) | None => {}
            }
        });
        match (asked, is_asked) {
            (Some(place), true) => until.goals[place] = *offered,
            (None, true) => until.goals.push(*offered),
            (_, false) => until.goals.retain(|goal| !is_same_kind(*goal, *offered)),
        }
    }
}

/// Largest number of poses to enter.
const MOST_POSES: f64 = 500.0;

fn limit(ui: &mut Ui, until: &mut UntilSettings, outbox: &mut Outbox) {
    ui.horizontal(|ui| {
        ui.label("At most");
        let at_most = until.at_most as f64;
        let field = Number::of("Largest number of poses", at_most, 0, "poses", 48.0);
        let check = |typed: f64| match typed.fract() == 0.0 && (1.0..=MOST_POSES).contains(&typed) {
            true => Ok(()),
            false => Err(format!(
                "found {typed}, expected a whole number from 1 to {MOST_POSES}"
            )),
        };
        match number_checked(ui, &field, &check) {
            Some(Entered::Value(typed)) => until.at_most = typed as usize,
            Some(Entered::Wrong(message)) => outbox.send(Command::Refuse(message)),
            Some(Entered::Nothing) | None => {}
        }
    });
}

/// Draws the assessment, and the reason for the next pose or the end of the run.
pub(super) fn known(ui: &mut Ui, model: &Model, state: &mut UntilState) {
    let (Some(open), Some(run)) = (&model.open, &model.link.run) else {
        return;
    };
    let Some(until) = &run.until else {
        return;
    };
    ui.section("Result so far");
    let key = (open.id(), open.revision(), until.end());
    let robot = &open.session().robot;
    let document = state.known.get(key, || until.document(robot));
    why(ui, run, until, document);
    match until.assessment() {
        Some(known) => {
            reached(ui, until, known);
            causes(ui, document);
        }
        None if !run.has_ended() => {
            ui.muted(&format!(
                    "The first {FIRST_POSES} poses determine the geometry; then each is chosen by what is known."
                ));
        }
        None => {}
    }
}

/// Each goal with its present value.
fn reached(ui: &mut Ui, until: &SequentialRun, known: &Assessment) {
    let palette = theme::of(ui);
    for goal in until.goals() {
        let is_reached = known.reaches(*goal);
        let colour = match is_reached {
            true => palette.good,
            false => palette.accent,
        };
        let percent = |probability: f64| format!("{:.0} %", 100.0 * probability);
        let probability = |text: &str, goal: f64, now: f64| {
            let what = format!("{text}, goal {}", percent(goal));
            (what, percent(now), now, Some(goal))
        };
        let (what, now, share, mark) = match *goal {
            Goal::Accuracy(limit_m) => {
                let sd_m = known.largest_sd_m;
                let mm = |length_m: f64| format!("{} mm", units::mm(length_m, 2));
                let what = format!("Accuracy of the pulleys, goal {}", mm(limit_m));
                let now = sd_m.map_or_else(|| "not determined yet".to_owned(), mm);
                let share = sd_m.map_or(0.0, |sd_m| limit_m / sd_m);
                (what, now, share, None)
            }
            Goal::Cause(goal) => probability("The cause is found", goal, known.explained),
            Goal::FaultFree(goal) => {
                probability("The robot is free of faults", goal, known.fault_free())
            }
        };
        row(ui, &what, &now);
        meter(ui, &format!("{what}: {now}"), share, colour, mark);
    }
}

/// Causes that are still possible.
fn causes(ui: &mut Ui, document: &UntilDocument) {
    if document.sets.is_empty() {
        return;
    }
    ui.add_space(GRID);
    ui.muted("Still possible:");
    let palette = theme::of(ui);
    for set in &document.sets {
        let what = sentence(&set.causes);
        let now = format!("{:.0} %", 100.0 * set.probability);
        row(ui, &what, &now);
        let name = format!("Probability of {}: {now}", set.causes);
        meter(ui, &name, set.probability, palette.muted, None);
    }
}

/// Row with a name, which may be long, on the left and a number on the right.
fn row(ui: &mut Ui, name: &str, number: &str) {
    ui.add_space(0.5 * GRID);
    ui.horizontal_top(|ui| {
        let width = ui.available_width() - 22.0 * GRID;
        ui.allocate_ui(egui::vec2(width, 0.0), |ui| ui.wrapped(name));
        let right = egui::Layout::right_to_left(egui::Align::Min);
        ui.with_layout(right, |ui| ui.label(number));
    });
}

/// Reason for the present pose; after the end, reason for the end and advice.
fn why(ui: &mut Ui, run: &RunLog, until: &SequentialRun, document: &UntilDocument) {
    if let Some(end) = until.end() {
        let kind = match document.goals.iter().all(|goal| goal.reached) {
            true => Verdict::Good,
            false => Verdict::Doubtful,
        };
        let poses = until.assessment().map_or(0, |known| known.poses);
        let poses = tautline_workflow::wording::count(poses, "pose");
        ui.verdict(kind, &format!("{} after {poses}.", sentence(end)));
        for help in &document.help {
            ui.neutral(help);
        }
        return;
    }
    // While the next pose is being chosen, the last one is still measured.
    if run.has_ended() || until.is_deciding() {
        return;
    }
    if let Some(chosen) = until.poses().last() {
        ui.wrapped(format!("Pose {} {}.", chosen.pose, chosen.reason));
    }
}
