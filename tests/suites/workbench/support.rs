//! Harness of the workbench.

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use egui::{Key, Modifiers, Role};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use tautline_session::Folders;
pub use tautline_validation::support::harness::settle;
use tautline_workbench::model::Options;
use tautline_workbench::shell::App;

static STARTED: AtomicUsize = AtomicUsize::new(0);

/// Start options of a workbench in tests: a folder of its own, so that the user's preferences are not touched, in the
/// repository with the sample sessions.
pub fn options() -> Options {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    std::env::set_current_dir(repository).expect("the repository is there");
    let number = STARTED.fetch_add(1, Ordering::Relaxed);
    let name = format!("workbench-{}-{number}", std::process::id());
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    Options {
        folders: Some(Folders::below(&folder)),
        demo_seed: Some(3),
        // A diagnosis that ends early has another result, and tests run at the same time.
        diagnosis_limit_s: Some(600.0),
        ..Options::default()
    }
}

/// A workbench without a graphics card, of the size of a small notebook's screen.
pub fn workbench() -> Harness<'static, App> {
    Harness::builder()
        .with_size(egui::vec2(1280.0, 800.0))
        .with_max_steps(60)
        .build_eframe(|creation| App::new(creation, options()))
}

/// Replaces the text of the field of this role and name.
pub fn type_into(harness: &mut Harness<'_, App>, role: Role, name: &str, text: &str) {
    harness.get_by_role_and_label(role, name).focus();
    harness.step();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.step();
    harness.get_by_role_and_label(role, name).type_text(text);
    harness.step();
    harness.step();
}
