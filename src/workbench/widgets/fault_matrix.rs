//! Matrix of faults that the poses detect and that could be confused.

use egui::{
    Align2, Color32, FontId, Pos2, Rect, Response, Role, ScrollArea, Sense, Ui, WidgetInfo, Window,
    vec2,
};
use tautline_workflow::isolability::{IsolabilityTable, SEEN, percent};

use crate::theme::{self, GRID, Palette};
use crate::widgets::UiExt;

/// Size of a cell (points).
const CELL: [f32; 2] = [22.0, 17.0];
/// Width of the names and of the probability of detection (points).
const NAME: f32 = 268.0;
const SHOWN: f32 = 40.0;
/// Height of a title bar (points).
const TITLE: f32 = 36.0;
/// Smallest distance of the window from the edges of the program's window (points).
const AROUND: f32 = 48.0;
/// Probability of confusion below which a cell has no number.
const NUMBERED: f64 = 0.01;

/// Button that shows or hides the matrix.
pub fn fault_button(ui: &mut Ui, is_shown: &mut bool) -> Response {
    let button = ui.button(match is_shown {
        true => "Hide faults",
        false => "Show faults",
    });
    if button.clicked() {
        *is_shown = !*is_shown;
    }
    button
}

pub fn fault_window(ui: &Ui, table: &IsolabilityTable, is_shown: &mut bool) {
    let whole = vec2(
        NAME + SHOWN + (table.kinds.len() + 1) as f32 * CELL[0],
        (table.kinds.len() + 8) as f32 * CELL[1],
    );
    let room = ui.ctx().content_rect().shrink(AROUND);
    Window::new("Faults that these poses show")
        .open(is_shown)
        .default_rect(Rect::from_center_size(
            room.center(),
            whole.min(room.size() - vec2(0.0, TITLE)),
        ))
        .show(ui.ctx(), |ui| fault_matrix(ui, table));
}

/// Draws the matrix: a row for each possible fault, with its probability of detection, and a column for each fault with
/// which it could be confused.
fn fault_matrix(ui: &mut Ui, table: &IsolabilityTable) {
    ui.wrapped(table.summary());
    ui.muted("Rows: the fault that is present, and the probability (%) that it is seen, of the least visible cable. Columns: the \
         probability (%) that another fault could be meant. Point at a cell for more.");
    ui.add_space(GRID);
    let count = table.kinds.len();
    let size = vec2(
        NAME + SHOWN + count as f32 * CELL[0],
        (count + 1) as f32 * CELL[1],
    );
    ScrollArea::both()
        .auto_shrink([false, true])
        .show(ui, |ui| {
            let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
            let places = Places { rect };
            let palette = theme::of(ui);
            head(ui, table, &places, palette);
            for (row, kind) in table.kinds.iter().enumerate() {
                let name = ui.interact(
                    places.name(row),
                    ui.scope_id().with(("fault", row)),
                    Sense::hover(),
                );
                let words = format!("{}. {}", kind.title, kind.sentence);
                name.widget_info(|| WidgetInfo::labeled(Role::Label, true, &words));
                body(ui, table, &places, row, palette);
            }
            if let Some(words) = response
                .hover_pos()
                .and_then(|at| words(table, &places, at))
            {
                response.on_hover_text_at_pointer(words);
            }
        });
}

/// Layout of the matrix.
struct Places {
    rect: Rect,
}

impl Places {
    fn top(&self, row: usize) -> f32 {
        self.rect.top() + (row + 1) as f32 * CELL[1]
    }

    fn name(&self, row: usize) -> Rect {
        Rect::from_min_size(
            Pos2::new(self.rect.left(), self.top(row)),
            vec2(NAME, CELL[1]),
        )
    }

    fn shown(&self, row: usize) -> Rect {
        let left = self.rect.left() + NAME;
        Rect::from_min_size(Pos2::new(left, self.top(row)), vec2(SHOWN, CELL[1]))
            .shrink2(vec2(2.0, 0.5))
    }

    fn cell(&self, row: usize, column: usize) -> Rect {
        let left = self.rect.left() + NAME + SHOWN + column as f32 * CELL[0];
        Rect::from_min_size(Pos2::new(left, self.top(row)), CELL.into()).shrink(0.5)
    }

    /// Row and column at a position; no row in the header, no column on a name.
    fn at(&self, place: Pos2) -> [Option<usize>; 2] {
        let index = |offset: f32, size: f32| (offset >= 0.0).then(|| (offset / size) as usize);
        [
            index(place.y - self.top(0), CELL[1]),
            index(place.x - self.rect.left() - NAME - SHOWN, CELL[0]),
        ]
    }
}

/// Column numbers.
fn head(ui: &Ui, table: &IsolabilityTable, places: &Places, palette: &Palette) {
    let middle = places.rect.top() + 0.5 * CELL[1];
    let at = |cell: Rect| Pos2::new(cell.center().x, middle);
    small(ui, at(places.shown(0)), "seen", palette.muted);
    for column in 0..table.kinds.len() {
        let number = (column + 1).to_string();
        small(ui, at(places.cell(0, column)), &number, palette.muted);
    }
}

fn body(ui: &Ui, table: &IsolabilityTable, places: &Places, row: usize, palette: &Palette) {
    let kind = &table.kinds[row];
    let font = FontId::proportional(12.0);
    let name = format!("{}  {}", row + 1, kind.title);
    let (at, align) = (places.name(row).left_center(), Align2::LEFT_CENTER);
    ui.painter().text(at, align, name, font, palette.text);
    let seen = kind.detection[0];
    let colour = if seen >= SEEN {
        palette.good
    } else {
        palette.bad
    };
    let strength = if seen >= SEEN { seen } else { 1.0 - seen };
    filled(ui, places.shown(row), colour, strength, palette);
    number(ui, places.shown(row), seen, palette);
    for (column, cell) in table.cells[row].iter().enumerate() {
        let place = places.cell(row, column);
        filled(ui, place, palette.warning, cell.confusion, palette);
        if cell.confusion >= NUMBERED {
            number(ui, place, cell.confusion, palette);
        }
    }
}

/// Cell with a colour and strength.
fn filled(ui: &Ui, rect: Rect, colour: Color32, strength: f64, palette: &Palette) {
    let share = 0.6 * strength.clamp(0.0, 1.0) as f32;
    let painter = ui.painter();
    painter.rect_filled(rect, 2.0, palette.ground.lerp_to_gamma(colour, share));
}

/// Probability in percent.
fn number(ui: &Ui, rect: Rect, value: f64, palette: &Palette) {
    let text = format!("{:.0}", 100.0 * value);
    small(ui, rect.center(), &text, palette.text);
}

fn small(ui: &Ui, at: Pos2, text: &str, colour: Color32) {
    let (align, font) = (Align2::CENTER_CENTER, FontId::proportional(10.0));
    ui.painter().text(at, align, text, font, colour);
}

/// Tooltip of a cell.
fn words(table: &IsolabilityTable, places: &Places, place: Pos2) -> Option<String> {
    let [row, column] = places.at(place);
    match (row, column) {
        (None, Some(column)) => {
            let kind = table.kinds.get(column)?;
            Some(format!("{}: {}", column + 1, kind.title))
        }
        (Some(row), None) => table.kinds.get(row).map(|kind| kind.sentence.clone()),
        (Some(row), Some(column)) => {
            let cell = table.cells.get(row)?.get(column)?;
            if cell.sentence.is_empty() {
                let title = &table.kinds[row].title;
                return Some(format!("{title} stands on one target only."));
            }
            Some(format!("{} {}", percent(cell.confusion), cell.sentence))
        }
        (None, None) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tautline_workflow::isolability::{Cell, FaultKind};

    #[test]
    fn places_are_found_again() {
        let places = Places {
            rect: Rect::from_min_size(Pos2::new(10.0, 20.0), vec2(600.0, 400.0)),
        };
        for (row, column) in [(0, 0), (3, 7), (11, 2)] {
            let found = places.at(places.cell(row, column).center());
            assert_eq!(found, [Some(row), Some(column)]);
        }
        assert_eq!(places.at(places.name(2).center()), [Some(2), None]);
        assert_eq!(places.at(Pos2::new(400.0, 22.0))[0], None);
    }

    #[test]
    fn a_cell_has_a_sentence() {
        let cell = Cell {
            confusion: 0.4,
            sentence: "Alike.".into(),
        };
        let kind = FaultKind {
            title: "Winch scale".into(),
            detection: [0.9, 1.0],
            sentence: "Seen.".into(),
        };
        let table = IsolabilityTable {
            kinds: vec![kind],
            cells: vec![vec![cell]],
        };
        let places = Places {
            rect: Rect::from_min_size(Pos2::ZERO, vec2(600.0, 400.0)),
        };
        let at = |rect: Rect| words(&table, &places, rect.center());
        assert_eq!(at(places.cell(0, 0)).as_deref(), Some("40 % Alike."));
        assert_eq!(at(places.name(0)).as_deref(), Some("Seen."));
        assert_eq!(at(places.cell(5, 0)), None);
    }
}
