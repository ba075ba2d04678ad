//! Several plots beside each other; plots with the same x axis are zoomed and moved together.

use std::path::Path;

use egui::{Align, Button, Layout, Popup, Rect, Ui, UiBuilder, vec2};
use egui_material_icons::icons;
use tautline_core::diagnosis::Quantity;
use tautline_core::measurement::Variable;
use tautline_session::{Arrangement, Plots};

use super::{Choice, PlotState, Tab, bar, pane};
use crate::model::command::{Outbox, ViewCommand};
use crate::model::plot_preparation::Preparation;
use crate::model::{Model, OpenSession, Selection};
use crate::theme::GRID;
use crate::widgets::{empty, icon_only};

/// Places for plots.
const PLACES: usize = 4;
/// Plots of a new window.
const FIRST: [Tab; PLACES] = [Tab::Residuals, Tab::Tensions, Tab::Variable, Tab::Laser];
/// Width (points) below which there is one plot at a time.
const NARROW: f32 = 560.0;
/// Width of the button that divides the area (points).
const BUTTON: f32 = 32.0;

/// State of the plots.
#[derive(Debug)]
pub struct Panes {
    arrangement: Arrangement,
    places: [PlotState; PLACES],
    /// The arrangement that the preferences have.
    known: (Arrangement, [Tab; PLACES]),
}

/// What a plot shows along x, if not everything.
type Along = (Tab, Option<[f64; 2]>);

impl Default for Panes {
    fn default() -> Self {
        Self::of(&Plots::default())
    }
}

impl Panes {
    /// The plots as the preferences have them.
    #[must_use]
    pub fn of(plots: &Plots) -> Self {
        let tabs: [Tab; PLACES] = std::array::from_fn(|place| {
            let name = plots.panes.get(place);
            name.and_then(|name| Tab::named(name))
                .unwrap_or(FIRST[place])
        });
        Self {
            arrangement: plots.arrangement,
            places: tabs.map(|tab| PlotState {
                tab,
                ..PlotState::default()
            }),
            known: (plots.arrangement, tabs),
        }
    }

    /// The arrangement to store in the preferences, if it has changed.
    fn changed(&mut self) -> Option<Plots> {
        // A scope that came by itself goes by itself.
        let tabs: [Tab; PLACES] = std::array::from_fn(|place| {
            let place = &self.places[place];
            let before = place.before_scope.filter(|_| place.tab == Tab::Scope);
            before.unwrap_or(place.tab)
        });
        let now = (self.arrangement, tabs);
        let is_known = self.known == now;
        self.known = now;
        (!is_known).then(|| Plots {
            arrangement: self.arrangement,
            panes: tabs.map(|tab| tab.name().to_owned()).to_vec(),
        })
    }

    /// What the plots show along x.
    fn along(&mut self) -> [Along; PLACES] {
        std::array::from_fn(|place| {
            let place = &mut self.places[place];
            let range = place.along().and_then(|(_, panel)| panel.along());
            (place.tab, range)
        })
    }

    /// Gives all plots what a task has computed.
    pub fn prepared(&mut self, preparation: &Preparation) {
        for place in &mut self.places {
            place.preparation = Some(preparation.clone());
        }
    }

    /// Shows residuals of a kind of reading along a variable: in the plot that shows such already, or in the first.
    pub fn show_along(&mut self, quantity: Quantity, cable: Option<usize>, variable: Variable) {
        let count = count(self.arrangement);
        let shown = self.places[..count].iter();
        let place = shown
            .map(|place| place.tab)
            .position(|tab| tab == Tab::Variable);
        let place = &mut self.places[place.unwrap_or(0)];
        place.tab = Tab::Variable;
        place.choice = Some(Choice {
            quantity,
            cable,
            variable,
        });
    }

    /// Shows the live scope, in the first place unless it is shown already.
    pub fn show_scope(&mut self) {
        let count = count(self.arrangement);
        let mut shown = self.places[..count].iter();
        if shown.all(|place| place.tab != Tab::Scope) {
            let place = &mut self.places[0];
            place.before_scope = Some(place.tab);
            place.tab = Tab::Scope;
        }
    }

    /// Where the scope came by itself, the plot that was there before comes back.
    pub fn leave_scope(&mut self) {
        for place in &mut self.places {
            let before = place.before_scope.take();
            if let Some(tab) = before.filter(|_| place.tab == Tab::Scope) {
                place.tab = tab;
            }
        }
    }

    /// Sets the file of the plot that is being saved.
    pub fn picked(&mut self, path: &Path) {
        for saving in self.places.iter_mut().filter_map(|p| p.saving.as_mut()) {
            saving.path = path.display().to_string();
        }
    }

    /// The range along x of the plot in a place, with the title of its axis.
    #[must_use]
    pub fn range(&mut self, place: usize) -> Option<(String, [f64; 2])> {
        let (title, panel) = self.places.get_mut(place)?.along()?;
        Some((title, panel.drawn.as_ref()?.scale.view[0]))
    }

    /// What there is room for.
    fn shown(&self, width: f32) -> Arrangement {
        if width < NARROW {
            Arrangement::One
        } else {
            self.arrangement
        }
    }

    /// Lets the others follow the plot whose range along x has just been changed.
    fn link(&mut self, before: &[Along; PLACES]) {
        let count = count(self.arrangement);
        let now = self.along();
        let is_changed =
            |place: &usize| now[*place].0 == before[*place].0 && now[*place].1 != before[*place].1;
        let Some(from) = (0..count).find(is_changed) else {
            return;
        };
        let range = now[from].1;
        let Some((title, _)) = self.places[from].along() else {
            return;
        };
        for place in (0..count).filter(|place| *place != from) {
            if let Some((other, panel)) = self.places[place].along()
                && other == title
            {
                panel.follow(range);
            }
        }
    }
}

fn count(arrangement: Arrangement) -> usize {
    match arrangement {
        Arrangement::One => 1,
        Arrangement::SideBySide => 2,
        Arrangement::Grid => PLACES,
    }
}

/// Draws the plots; `hovered` is what is under the pointer, in all views.
pub fn show(
    ui: &mut Ui,
    model: &Model,
    (panes, hovered): (&mut Panes, &mut Selection),
    outbox: &mut Outbox,
) {
    let Some(open) = &model.open else {
        empty(ui, "Plots appear here once a session is open.");
        return;
    };
    for place in &mut panes.places {
        place.settle(open);
    }
    let before = panes.along();
    let whole = ui.available_rect_before_wrap();
    let arrangement = panes.shown(whole.width());
    for place in 0..count(arrangement) {
        let rect = rect_of(whole, arrangement, place);
        let mut inner = ui.new_child(UiBuilder::new().id_salt(place).max_rect(rect));
        inner.shrink_clip_rect(rect);
        tabs(&mut inner, open, panes, (place, count(arrangement)));
        pane(&mut inner, model, &mut panes.places[place], hovered, outbox);
    }
    ui.advance_cursor_after_rect(whole);
    panes.link(&before);
    if let Some(plots) = panes.changed() {
        outbox.send(ViewCommand::SetPlots(plots));
    }
}

/// Where a plot stands.
fn rect_of(whole: Rect, arrangement: Arrangement, place: usize) -> Rect {
    let (columns, rows) = match arrangement {
        Arrangement::One => (1, 1),
        Arrangement::SideBySide => (2, 1),
        Arrangement::Grid => (2, 2),
    };
    let gap = vec2(3.0 * GRID, 2.0 * GRID);
    let between = vec2((columns - 1) as f32, (rows - 1) as f32) * gap;
    let size = (whole.size() - between) / vec2(columns as f32, rows as f32);
    let at = vec2((place % columns) as f32, (place / columns) as f32);
    Rect::from_min_size(whole.min + at * (size + gap), size)
}

/// The tabs of a plot, and the button that divides the area.
fn tabs(ui: &mut Ui, open: &OpenSession, panes: &mut Panes, (place, count): (usize, usize)) {
    // The button that divides the area stands in its upper right corner.
    let has_button = place == count.min(2) - 1;
    ui.horizontal(|ui| {
        let room = if has_button { BUTTON } else { 0.0 };
        ui.scope(|ui| {
            ui.set_max_width(ui.available_width() - room);
            bar::tabs(ui, open, &mut panes.places[place].tab);
        });
        if has_button {
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                divide(ui, &mut panes.arrangement);
            });
        }
    });
}

/// The button that divides the area.
fn divide(ui: &mut Ui, arrangement: &mut Arrangement) {
    let button = icon_only(ui, icons::ICON_GRID_VIEW, "Plot layout", true);
    Popup::menu(&button).show(|ui| {
        for (value, title) in [
            (Arrangement::One, "One plot"),
            (Arrangement::SideBySide, "Two plots"),
            (Arrangement::Grid, "Four plots"),
        ] {
            if ui
                .add(Button::selectable(*arrangement == value, title))
                .clicked()
            {
                *arrangement = value;
                ui.close();
            }
        }
    });
}
