//! The report, saved from the menu.

use egui::Role;
use egui_kittest::kittest::Queryable;

use crate::measured::{Measured, press};
use crate::support::type_into;

#[test]
fn both_entries_of_the_menu_save_at_a_typed_path() {
    let measured = Measured::mini(12, &[]);
    let mut harness = measured.opened();
    press(&mut harness, "Identify");
    for (format, start) in [("HTML", "<!DOCTYPE html>"), ("PDF", "%PDF-")] {
        press(&mut harness, "File");
        press(&mut harness, &format!("Save report as {format}…"));
        let path = measured.beside(&format!("own.{}", format.to_lowercase()));
        // The end of the name follows from the format.
        let typed = path.with_extension("").display().to_string();
        type_into(&mut harness, Role::TextInput, "Path of the file", &typed);
        press(&mut harness, "Save report");
        let bytes = std::fs::read(&path).expect("the report");
        let shown = String::from_utf8_lossy(&bytes[..start.len()]).to_lowercase();
        assert_eq!(shown, start.to_lowercase());
        assert!(harness.query_by_label("Save report").is_none(), "closed");
    }
}
