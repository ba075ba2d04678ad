//! Row of tabs that never wraps: tabs without room are in a menu at its end.

use egui::{Button, Popup, Role, TextStyle, Ui, WidgetInfo, WidgetText};
use egui_material_icons::icons;

#[derive(Debug, Clone, Copy)]
pub struct TabOf<T> {
    pub value: T,
    pub title: &'static str,
    /// Reason why the tab is not available, if so.
    pub missing: Option<&'static str>,
}

/// Draws the row; `more` is the name of the menu for the remaining tabs.
pub fn tab_row<T: Copy + PartialEq>(ui: &mut Ui, more: &str, tabs: &[TabOf<T>], chosen: &mut T) {
    let widths: Vec<f32> = tabs.iter().map(|tab| width(ui, tab.title)).collect();
    let place = tabs.iter().position(|tab| tab.value == *chosen);
    let room = ui.available_width();
    let spacing = ui.spacing().item_spacing.x;
    let is_shown = fitting(&widths, place, room, spacing, width(ui, more) + 20.0);
    ui.horizontal(|ui| {
        for (tab, _) in tabs.iter().zip(&is_shown).filter(|(_, shown)| **shown) {
            one(ui, tab, chosen);
        }
        if is_shown.iter().all(|shown| *shown) {
            return;
        }
        let content = (more, icons::ICON_EXPAND_MORE.rich_text().size(13.0));
        let button = ui.add(Button::new(content).frame_when_inactive(false));
        button.widget_info(|| WidgetInfo::labeled(Role::Button, true, more));
        Popup::menu(&button).show(|ui| {
            for (tab, _) in tabs.iter().zip(&is_shown).filter(|(_, shown)| !**shown) {
                if one(ui, tab, chosen) {
                    ui.close();
                }
            }
        });
    });
}

/// Draws a tab; returns whether it was chosen.
fn one<T: Copy + PartialEq>(ui: &mut Ui, tab: &TabOf<T>, chosen: &mut T) -> bool {
    let button = Button::selectable(*chosen == tab.value, tab.title);
    let response = ui.add_enabled(tab.missing.is_none(), button);
    let is_clicked = response.clicked();
    if is_clicked {
        *chosen = tab.value;
    }
    if let Some(why) = tab.missing {
        response.on_disabled_hover_text(why);
    }
    is_clicked
}

fn width(ui: &Ui, title: &str) -> f32 {
    let text = WidgetText::from(title);
    let galley = text.into_galley(ui, None, f32::INFINITY, TextStyle::Button);
    galley.size().x + 2.0 * ui.spacing().button_padding.x
}

/// Selects the tabs of these widths that fit into a row, always including the chosen one. `menu` is the width of the
/// menu button.
pub fn fitting(
    widths: &[f32],
    chosen: Option<usize>,
    room: f32,
    spacing: f32,
    menu: f32,
) -> Vec<bool> {
    let whole: f32 = widths.iter().map(|width| width + spacing).sum();
    if whole - spacing <= room {
        return vec![true; widths.len()];
    }
    let of_chosen = chosen.map_or(0.0, |k| widths[k] + spacing);
    let mut left = room - menu - of_chosen;
    let mut is_full = false;
    (0..widths.len())
        .map(|k| {
            if chosen == Some(k) {
                return true;
            }
            left -= widths[k] + spacing;
            is_full |= left < 0.0;
            !is_full
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::fitting;

    #[test]
    fn the_chosen_one_is_always_in_the_row() {
        let widths = [50.0; 4];
        let shown = |room, chosen| fitting(&widths, chosen, room, 10.0, 40.0);
        assert_eq!(shown(230.0, None), [true; 4]);
        assert_eq!(shown(229.0, Some(0)), [true, true, true, false]);
        assert_eq!(shown(170.0, Some(3)), [true, false, false, true]);
        assert_eq!(shown(10.0, Some(2)), [false, false, true, false]);
    }
}
