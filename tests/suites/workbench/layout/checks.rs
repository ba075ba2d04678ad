//! Visible elements of a window, and faults of its layout.

use egui::{Rect, Role, ThemePreference, Vec2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::NodeT;
use tautline_workbench::shell::App;

use crate::support::settle;

/// Sizes of the window in pixels.
pub const SIZES: [Vec2; 4] = [
    vec2(1024.0, 640.0),
    vec2(1280.0, 800.0),
    vec2(1920.0, 1080.0),
    vec2(2560.0, 1440.0),
];
const SCALES: [f32; 2] = [1.0, 2.0];
const THEMES: [ThemePreference; 2] = [ThemePreference::Dark, ThemePreference::Light];

/// A window: theme, size in pixels, pixels per point.
pub type Appearance = (ThemePreference, Vec2, f32);

/// Every size at both scales, each of which has both themes.
pub fn in_pairs() -> Vec<Appearance> {
    let sizes = SIZES.into_iter().enumerate();
    let all = sizes.flat_map(|(k, size)| {
        let scales = SCALES.into_iter().enumerate();
        scales.map(move |(j, scale)| (THEMES[(k + j) % 2], size, scale))
    });
    all.collect()
}

/// Every size once, so that each scale and theme occur twice: enough for one of several robots.
pub fn once() -> Vec<Appearance> {
    let sizes = SIZES.into_iter().enumerate();
    let all = sizes.map(|(k, size)| (THEMES[k % 2], size, SCALES[usize::from(k == 1 || k == 2)]));
    all.collect()
}

/// Edges may touch and lines of text may reach into each other's spacing by this much (points).
const TOUCH: f32 = 2.5;

/// Margins of a field beside its text (points).
const FIELD_MARGINS: f32 = 8.0;

/// Height of the bar at the bottom, at most (points).
const BAR: f32 = 40.0;

/// A visible element with its name.
#[derive(Debug)]
pub struct Seen {
    role: Role,
    name: String,
    /// Text of a field.
    value: String,
    rect: Rect,
    /// Rectangle including the part that cannot be seen.
    whole: Rect,
}

impl Seen {
    pub fn is_named(&self, name: &str) -> bool {
        self.name == name
    }

    pub fn is_number_of_a_cable(&self) -> bool {
        self.role == Role::TextInput && self.name.contains(" of cable-")
    }

    /// Whether the text is wider than the field without its margins.
    pub fn is_too_narrow(&self, harness: &Harness<'_, App>) -> bool {
        let font = egui::TextStyle::Body.resolve(&harness.ctx.global_style());
        let text = self.value.clone();
        let galley = harness
            .ctx
            .fonts_mut(|fonts| fonts.layout_no_wrap(text, font, egui::Color32::WHITE));
        self.whole.width() < galley.size().x + FIELD_MARGINS
    }

    pub fn is_cut_at_the_side(&self) -> bool {
        self.rect.width() < self.whole.width() - 1.5
    }
}

/// Elements on the screen; of those in a scroll area, the visible part.
pub fn seen(harness: &Harness<'_, App>) -> Vec<Seen> {
    let visible = visible(harness);
    let nodes = harness.root().children_recursive();
    let nodes = nodes.filter(|node| is_part(node.accesskit_node().role()));
    nodes
        .flat_map(|node| {
            let inner = node.accesskit_node();
            let name = inner.label().or(inner.value()).unwrap_or_default();
            let whole = node.rect();
            let own = visible.iter().find(|(rect, _)| is_near(rect, &whole));
            let own = own.copied();
            let parts: Vec<(Rect, Rect)> = match own {
                Some(own) => vec![own],
                // Text that flows around bold words has a widget for each line; text that is scrolled away has none.
                None if inner.role() == Role::Label => {
                    let lines = node.children().map(|line| line.rect());
                    let seen = lines.map(|line| {
                        let is_it = |(rect, _): &&(Rect, Rect)| is_near(rect, &line);
                        visible.iter().find(is_it).copied().unwrap_or((line, line))
                    });
                    seen.collect()
                }
                None => vec![(whole, whole)],
            };
            let role = inner.role();
            let value = inner.value().unwrap_or_default();
            parts.into_iter().map(move |(whole, rect)| Seen {
                role,
                name: name.clone(),
                value: value.clone(),
                rect,
                whole,
            })
        })
        .filter(|seen| seen.rect.is_positive())
        .collect()
}

fn is_near(a: &Rect, b: &Rect) -> bool {
    (a.min - b.min).length() + (a.max - b.max).length() < 0.1
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

/// Layout faults between the bars at the top and at the bottom.
pub fn faults(harness: &Harness<'_, App>) -> Vec<String> {
    faults_of(harness.ctx.content_rect(), &seen(harness))
}

fn faults_of(window: Rect, all: &[Seen]) -> Vec<String> {
    let mut faults = Vec::new();
    for part in all {
        // A sentence over two lines of the source must not bring their indentation along.
        if part.name.trim().contains("  ") {
            faults.push(format!("{:?} \"{}\" has gaps", part.role, part.name));
        }
        if part.is_cut_at_the_side() {
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
    // Elements that a panel has scrolled away lie behind the bars and are invisible.
    let between = window
        .with_min_y(window.min.y + 36.0)
        .with_max_y(window.max.y - BAR);
    faults.extend(overlaps(all, between));
    faults
}

/// Layout faults of the bar at the bottom, in which nothing is scrolled.
pub fn faults_at_the_bottom(harness: &Harness<'_, App>) -> Vec<String> {
    let window = harness.ctx.content_rect();
    let bar = window.with_min_y(window.max.y - BAR);
    let all = seen(harness);
    let outside = all
        .iter()
        .filter(|part| part.rect.center().y > bar.min.y && !window.contains_rect(part.rect))
        .map(|part| format!("\"{}\" leaves the window: {:?}", part.name, part.rect));
    outside.chain(overlaps(&all, bar)).collect()
}

/// Parts within an area of which one covers another.
fn overlaps(all: &[Seen], area: Rect) -> Vec<String> {
    let mut faults = Vec::new();
    let inside: Vec<&Seen> = all
        .iter()
        .filter(|part| area.contains_rect(part.rect))
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

/// Checks the present screen in both themes, all sizes and scales.
pub fn check(harness: &mut Harness<'_, App>, what: &str) {
    check_in(harness, what, &in_pairs());
}

pub fn check_in(harness: &mut Harness<'_, App>, what: &str, appearances: &[Appearance]) {
    check_with(harness, what, appearances, &mut |harness| {
        harness.run_ok();
        faults(harness)
    });
}

/// An action on the window.
type Act<'a> = &'a mut dyn FnMut(&mut Harness<'_, App>);

/// Checks the layout of a dialog, which is opened above the screen and closed again: it is checked alone, and has to be
/// completely inside the window of the program.
pub fn check_dialog(harness: &mut Harness<'_, App>, what: &str, [open, close]: [Act<'_>; 2]) {
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

/// Finds layout faults in windows of these appearances.
pub fn check_with(
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
