//! Nothing is clipped and nothing overlaps: every screen, in windows from 1024 x 640 to 2560 x 1440 pixels, dark and light,
//! at 100 and 200 %, with robots of 4, 8 and 16 cables. Sizes, themes, scales and numbers of cables meet in pairs: every
//! level of each with every level of each other, not all four at a time.

use egui::{Rect, Role, ThemePreference, Vec2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use tautline_workbench::model::command::Answer;
use tautline_workbench::model::command::Setup;
use tautline_workbench::model::command::{
    CompareCommand, FileCommand, IdentificationCommand, RecordingCommand, ReportCommand,
    RobotCommand, ViewCommand,
};
use tautline_workbench::model::edit::Edit;
use tautline_workbench::model::manual::Page;
use tautline_workbench::model::part::Part;
use tautline_workbench::model::phase::{Phase, Screen};
use tautline_workbench::shell::App;
use tautline_workflow::report::ReportFormat;
use tautline_workflow::templates::Template;

use crate::measured::{Measured, give};
use crate::support::settle;

/// Sizes of the window in pixels.
const SIZES: [Vec2; 4] = [
    vec2(1024.0, 640.0),
    vec2(1280.0, 800.0),
    vec2(1920.0, 1080.0),
    vec2(2560.0, 1440.0),
];
const SCALES: [f32; 2] = [1.0, 2.0];
const THEMES: [ThemePreference; 2] = [ThemePreference::Dark, ThemePreference::Light];

/// A window: theme, size in pixels, pixels per point.
type Appearance = (ThemePreference, Vec2, f32);

/// Every size at both scales, each of which has both themes.
fn in_pairs() -> Vec<Appearance> {
    let sizes = SIZES.into_iter().enumerate();
    let all = sizes.flat_map(|(k, size)| {
        let scales = SCALES.into_iter().enumerate();
        scales.map(move |(j, scale)| (THEMES[(k + j) % 2], size, scale))
    });
    all.collect()
}

/// Every size once, so that each scale and theme occur twice: enough for one of several robots.
fn once() -> Vec<Appearance> {
    let sizes = SIZES.into_iter().enumerate();
    let all = sizes.map(|(k, size)| (THEMES[k % 2], size, SCALES[usize::from(k == 1 || k == 2)]));
    all.collect()
}

/// Edges may touch and lines of text may reach into each other's spacing by this much (points).
const TOUCH: f32 = 2.5;

/// Something that is seen, with its name.
struct Seen {
    role: Role,
    name: String,
    rect: Rect,
    /// With what of it cannot be seen.
    whole: Rect,
}

/// What is on the screen: of what a scroll area has moved away, the part that can be seen.
fn seen(harness: &Harness<'_, App>) -> Vec<Seen> {
    let visible = visible(harness);
    let nodes = harness.root().children_recursive();
    let nodes = nodes.filter(|node| is_part(node.accesskit_node().role()));
    nodes
        .filter_map(|node| {
            let inner = node.accesskit_node();
            let name = inner.label().or(inner.value()).unwrap_or_default();
            let whole = node.rect();
            let same = |(rect, _): &&(Rect, Rect)| {
                (rect.min - whole.min).length() + (rect.max - whole.max).length() < 0.1
            };
            let rect = visible
                .iter()
                .find(same)
                .map_or(whole, |(_, clipped)| *clipped);
            rect.is_positive().then_some(Seen {
                role: inner.role(),
                name,
                rect,
                whole,
            })
        })
        .collect()
}

/// Whole and visible rectangles of all widgets.
fn visible(harness: &Harness<'_, App>) -> Vec<(Rect, Rect)> {
    harness.ctx.viewport(|viewport| {
        let layers = viewport.prev_pass.widgets.layers();
        let widgets = layers.flat_map(|(_, widgets)| widgets.iter());
        widgets
            .map(|widget| (widget.rect, widget.interact_rect))
            .collect()
    })
}

fn is_part(role: Role) -> bool {
    use Role::{Button, CheckBox, ComboBox, Label, RadioButton, Slider, Tab, TextInput};
    matches!(
        role,
        Button | CheckBox | ComboBox | Label | RadioButton | Slider | Tab | TextInput
    )
}

/// What is wrong with what is seen between the bars at the top and at the bottom.
fn faults(harness: &Harness<'_, App>) -> Vec<String> {
    faults_of(harness.ctx.content_rect(), &seen(harness))
}

fn faults_of(window: Rect, all: &[Seen]) -> Vec<String> {
    let mut faults = Vec::new();
    for part in all {
        if part.rect.width() < part.whole.width() - 1.5 {
            faults.push(format!(
                "{:?} \"{}\" is cut at the side: {:?} of {:?}",
                part.role, part.name, part.rect, part.whole
            ));
        }
        if part.rect.min.x < window.min.x - 0.5 || part.rect.max.x > window.max.x + 0.5 {
            faults.push(format!(
                "{:?} \"{}\" leaves the window: {:?}",
                part.role, part.name, part.rect
            ));
        }
    }
    // What a panel has scrolled away lies behind the bars; it is not seen.
    let between = window
        .with_min_y(window.min.y + 36.0)
        .with_max_y(window.max.y - 40.0);
    let inside: Vec<&Seen> = all
        .iter()
        .filter(|part| between.contains_rect(part.rect))
        .collect();
    for (k, a) in inside.iter().enumerate() {
        for b in &inside[k + 1..] {
            let common = a.rect.intersect(b.rect);
            let overlap = common.width() > TOUCH && common.height() > TOUCH;
            let nested = a.rect.expand(TOUCH).contains_rect(b.rect)
                || b.rect.expand(TOUCH).contains_rect(a.rect);
            if overlap && !nested {
                faults.push(format!(
                    "\"{}\" {:?} overlaps \"{}\" {:?}",
                    a.name, a.rect, b.name, b.rect
                ));
            }
        }
    }
    faults
}

/// Looks at the present screen in both themes, all sizes and scales.
fn check(harness: &mut Harness<'_, App>, what: &str) {
    check_in(harness, what, &in_pairs());
}

fn check_in(harness: &mut Harness<'_, App>, what: &str, appearances: &[Appearance]) {
    check_with(harness, what, appearances, &mut |harness| {
        harness.run_ok();
        faults(harness)
    });
}

/// Something that is done to the window.
type Act<'a> = &'a mut dyn FnMut(&mut Harness<'_, App>);

/// What is wrong with a window that is opened over the screen and closed again: it is looked at alone, and all of it
/// has to be in the window of the program.
fn check_dialog(harness: &mut Harness<'_, App>, what: &str, [open, close]: [Act<'_>; 2]) {
    check_with(harness, what, &in_pairs(), &mut |harness| {
        harness.run_ok();
        let behind = seen(harness);
        open(harness);
        settle(harness);
        let mut parts = seen(harness);
        let same = |a: &Seen, b: &Seen| {
            a.name == b.name && (a.rect.min - b.rect.min).length() < 1.0 && a.role == b.role
        };
        parts.retain(|part| !behind.iter().any(|other| same(part, other)));
        // Text that flows around what is bold has no rectangles line by line.
        parts.retain(|part| what != "manual" || part.role == Role::Button);
        // What is scrolled away below, but for its upper edge, is not seen.
        parts.retain(|part| part.rect.height() > TOUCH);
        let window = harness.ctx.content_rect();
        let mut found = faults_of(window, &parts);
        if parts.is_empty() {
            found.push("nothing is opened".to_owned());
        }
        let outside = parts.iter().filter(|part| {
            part.rect.min.y < window.min.y - 0.5 || part.rect.max.y > window.max.y + 0.5
        });
        found.extend(
            outside.map(|part| format!("\"{}\" leaves the window: {:?}", part.name, part.rect)),
        );
        close(harness);
        settle(harness);
        found
    });
}

/// Finds faults in windows that look so.
fn check_with(
    harness: &mut Harness<'_, App>,
    what: &str,
    appearances: &[Appearance],
    find: &mut dyn FnMut(&mut Harness<'_, App>) -> Vec<String>,
) {
    let mut faults_of_all = Vec::new();
    for (theme, size, scale) in appearances.iter().copied() {
        harness.ctx.set_theme(theme);
        harness.set_pixels_per_point(scale);
        // The scale changes with the next frame, and the size with it.
        harness.step();
        harness.set_size(size / scale);
        harness.run_ok();
        let now = harness.ctx.content_rect().size() * scale;
        assert!((now - size).length() < 1.0, "{now:?} instead of {size:?}");
        let found = find(harness).into_iter();
        faults_of_all
            .extend(found.map(|fault| format!("{what}, {theme:?}, {size:?} at {scale}: {fault}")));
    }
    assert!(faults_of_all.is_empty(), "{}", faults_of_all.join("\n"));
}

#[test]
fn the_start_screen_fits() {
    let mut harness = crate::support::workbench();
    settle(&mut harness);
    check(&mut harness, "start");
}

#[test]
fn every_phase_fits() {
    let measured = Measured::mini(30, &[("winch_scale", "cable-3", &[("scale", 0.02)])]);
    let mut harness = measured.opened();
    for command in [
        IdentificationCommand::Identify,
        IdentificationCommand::Diagnose,
    ] {
        harness.state_mut().state.outbox.send(command);
        settle(&mut harness);
    }
    for step in Phase::ALL {
        harness
            .state_mut()
            .state
            .outbox
            .send(ViewCommand::Go(Screen::Phase(step)));
        settle(&mut harness);
        check(&mut harness, step.title());
    }
    harness.state_mut().state.outbox.send(CompareCommand::Show);
    settle(&mut harness);
    check(&mut harness, "compare");
}

#[test]
fn every_phase_fits_with_few_and_many_cables() {
    for cables in [4, 16] {
        let mut harness = Measured::with_cables(cables, 12).opened();
        give(&mut harness, IdentificationCommand::Identify);
        for step in Phase::ALL {
            give(&mut harness, ViewCommand::Go(Screen::Phase(step)));
            let what = format!("{} with {cables} cables", step.title());
            check_in(&mut harness, &what, &once());
        }
        give(&mut harness, ViewCommand::Inspect(Some(cables - 1)));
        let what = format!("inspector with {cables} cables");
        check_in(&mut harness, &what, &once());
    }
}

#[test]
fn the_inspector_and_the_statistics_fit() {
    let mut harness = Measured::mini(12, &[]).opened();
    give(&mut harness, IdentificationCommand::Identify);
    let go = ViewCommand::Go(Screen::Phase(Phase::Identification));
    give(&mut harness, go);
    give(&mut harness, ViewCommand::Inspect(Some(2)));
    check(&mut harness, "inspector");
    give(&mut harness, ViewCommand::Inspect(None));
    for part in Part::ALL {
        give(&mut harness, ViewCommand::Maximise(Some(part)));
        if part == Part::Plots {
            harness.set_pixels_per_point(1.0);
            harness.set_size(SIZES[2]);
            harness.run_ok();
            crate::measured::press(&mut harness, "Statistics");
        }
        // The table of statistics is scrolled to the side where it has no room.
        let all = in_pairs().into_iter();
        let wide: Vec<_> = all
            .filter(|(.., scale)| part != Part::Plots || *scale < 2.0)
            .collect();
        check_in(&mut harness, &format!("{part:?} maximised"), &wide);
    }
}

#[test]
fn a_comparison_fits() {
    let folder = tempfile::tempdir().expect("a folder");
    let [a, b] = ["before.json", "after.json"].map(|name| folder.path().join(name));
    crate::compare::write(&a, "mini", 0.0, 1);
    crate::compare::write(&b, "mini", -0.01, 3);
    let mut harness = crate::support::workbench();
    give(&mut harness, CompareCommand::Show);
    crate::compare::take(&mut harness, "A", &a);
    crate::compare::take(&mut harness, "B", &b);
    harness.get_by_label_contains("1 pulley has moved");
    check(&mut harness, "comparison");
}

#[test]
fn the_import_fits() {
    let mut harness = Measured::mini(6, &[]).opened();
    harness
        .state_mut()
        .state
        .outbox
        .send(RecordingCommand::Show);
    settle(&mut harness);
    check(&mut harness, "import without a file");
    let folder = tautline_validation::your_data::page().with_file_name("your-data");
    for name in ["mistakes.csv", "points.txt"] {
        let path = folder.join(name);
        give(&mut harness, RecordingCommand::Read(path));
    }
    check(&mut harness, "import");
}

#[test]
fn the_description_of_a_new_robot_fits() {
    let mut harness = crate::support::workbench();
    give(&mut harness, FileCommand::New(Template::Facade));
    check(&mut harness, "description");
}

/// A command that opens a window, and one that closes it.
fn by_commands(
    harness: &mut Harness<'_, App>,
    what: &str,
    [open, close]: [tautline_workbench::model::command::Command; 2],
) {
    let send = |command: &tautline_workbench::model::command::Command| {
        let command = command.clone();
        move |harness: &mut Harness<'_, App>| {
            harness.state_mut().state.outbox.send(command.clone());
            harness.step();
        }
    };
    let (mut open, mut close) = (send(&open), send(&close));
    check_dialog(harness, what, [&mut open, &mut close]);
}

#[test]
fn long_menus_fit() {
    let mut harness = Measured::mini(6, &[]).opened();
    for name in ["File", "View"] {
        let mut open = |harness: &mut Harness<'_, App>| {
            harness.get_by_role_and_label(Role::Button, name).click();
            harness.run_ok();
        };
        let mut close = |harness: &mut Harness<'_, App>| {
            harness.key_press(egui::Key::Escape);
            harness.run_ok();
        };
        check_dialog(&mut harness, name, [&mut open, &mut close]);
    }
}

#[test]
fn every_window_above_the_screen_fits() {
    let measured = Measured::mini(8, &[]);
    let mut harness = measured.opened();
    give(&mut harness, IdentificationCommand::Identify);
    give(&mut harness, Edit::Rename("Another name".into()));
    for (what, open, close) in [
        (
            "command palette",
            ViewCommand::Palette(true).into(),
            ViewCommand::Palette(false).into(),
        ),
        (
            "log",
            ViewCommand::Log(true).into(),
            ViewCommand::Log(false).into(),
        ),
        (
            "manual",
            ViewCommand::Manual(Some(Page::Numbers)).into(),
            ViewCommand::Manual(None).into(),
        ),
        (
            "about",
            ViewCommand::About(true).into(),
            ViewCommand::About(false).into(),
        ),
        (
            "report",
            ReportCommand::AskSave(ReportFormat::Pdf).into(),
            ReportCommand::Cancel.into(),
        ),
        (
            "unsaved changes",
            FileCommand::Close.into(),
            FileCommand::Answer(Answer::Cancel).into(),
        ),
    ] {
        by_commands(&mut harness, what, [open, close]);
    }
    let parts: [(&str, &[&str]); 4] = [
        ("recording", &["Recording"]),
        ("controller", &["Beckhoff controller (ADS)"]),
        (
            "symbols",
            &["Beckhoff controller (ADS)", "Symbols", "Custom names"],
        ),
        ("laser", &["Laser source", "From a device at a serial port"]),
    ];
    for (what, presses) in parts {
        let mut open = |harness: &mut Harness<'_, App>| {
            let state = &mut harness.state_mut().state;
            state.outbox.send(RobotCommand::Setup(Setup::Open));
            // A window takes its size before it is seen.
            for _ in 0..4 {
                harness.step();
            }
            for name in presses {
                harness.get_by_label(name).click_accesskit();
                harness.step();
                harness.step();
            }
        };
        let mut close = |harness: &mut Harness<'_, App>| {
            let state = &mut harness.state_mut().state;
            state.outbox.send(RobotCommand::Setup(Setup::Close));
            harness.step();
        };
        check_dialog(&mut harness, what, [&mut open, &mut close]);
    }
    let mut open = |harness: &mut Harness<'_, App>| {
        harness
            .state_mut()
            .state
            .outbox
            .send(FileCommand::AskSaveAs);
        harness.step();
    };
    let mut close = |harness: &mut Harness<'_, App>| {
        harness.state_mut().state.model.dialogs.save_as = None;
        harness.step();
    };
    check_dialog(&mut harness, "save as", [&mut open, &mut close]);
}

#[test]
fn plots_beside_each_other_fit() {
    let measured = Measured::mini(12, &[]);
    let mut harness = measured.opened();
    give(&mut harness, IdentificationCommand::Identify);
    let go = ViewCommand::Go(Screen::Phase(Phase::Identification));
    give(&mut harness, go);
    for arrangement in ["Two plots", "Four plots"] {
        harness.set_pixels_per_point(1.0);
        harness.set_size(SIZES[1]);
        harness.run_ok();
        crate::measured::press(&mut harness, "Plot layout");
        crate::measured::press(&mut harness, arrangement);
        check(&mut harness, arrangement);
    }
}
