//! The manual inside the program: the page of what is on the screen, all pages, links between them; what the program is
//! made of; sessions that are opened again.

use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use tautline_workbench::model::command::{FileCommand, ViewCommand};
use tautline_workbench::model::manual::Page;
use tautline_workbench::model::phase::{Phase, Screen};
use tautline_workflow::wording::recent_facts;

use crate::measured::{Measured, give, press};
use crate::support::{settle, workbench};

#[test]
fn f1_opens_the_page_of_what_is_on_the_screen() {
    let measured = Measured::mini(6, &[]);
    let mut harness = measured.opened();
    let screens = Phase::ALL.map(Screen::Phase);
    for screen in screens
        .into_iter()
        .chain([Screen::Compare, Screen::WhichSensor])
    {
        give(&mut harness, ViewCommand::Go(screen));
        harness.key_press(Key::F1);
        settle(&mut harness);
        let open = harness.state().state.model.dialogs.manual;
        assert_eq!(open, Some(Page::of(screen)));
        harness.key_press(Key::Escape);
        settle(&mut harness);
        assert_eq!(harness.state().state.model.dialogs.manual, None);
    }
}

#[test]
fn every_page_is_drawn_and_chosen_from_the_list() {
    let mut harness = workbench();
    press(&mut harness, "Help");
    press(&mut harness, "Manual");
    for page in Page::ALL {
        harness
            .get_all_by_label(page.title())
            .next()
            .expect("in the list")
            .click();
        settle(&mut harness);
        let open = harness.state().state.model.dialogs.manual;
        assert_eq!(open, Some(page), "{}", page.title());
    }
}

#[test]
fn the_menu_says_what_the_program_is_made_of() {
    let mut harness = workbench();
    press(&mut harness, "Help");
    press(&mut harness, "About Tautline");
    harness.get_by_label(concat!("Tautline ", env!("CARGO_PKG_VERSION")));
    harness.get_by_label_contains("MIT or Apache-2.0");
    harness.key_combination_modifiers(Modifiers::NONE, &[Key::Escape]);
    settle(&mut harness);
    assert!(!harness.state().state.model.dialogs.about);
}

#[test]
fn a_session_is_opened_again_from_the_menu() {
    let measured = Measured::mini(6, &[]);
    let mut harness = measured.opened();
    let path = measured.beside("kept.json");
    give(&mut harness, FileCommand::SaveAs(path.clone()));
    give(&mut harness, FileCommand::Close);
    assert!(harness.state().state.model.open.is_none());
    press(&mut harness, "File");
    press(&mut harness, "Open recent");
    let recent = &harness.state().state.model.preferences.recent()[0];
    let title = format!("mini ({})", recent_facts(recent));
    assert!(title.ends_with(", mini, kept.json)"), "{title}");
    press(&mut harness, &title);
    let open = harness.state().state.model.open.as_ref();
    assert_eq!(open.and_then(|open| open.path()), Some(path.as_path()));
}
