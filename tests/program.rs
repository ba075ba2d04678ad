//! The built program, for suites that start it.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use std::time::SystemTime;

/// The program next to this test or program, built if it is missing or older than its sources.
///
/// # Panics
/// If it cannot be built.
#[must_use]
pub fn program() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    PROGRAM.get_or_init(|| {
        if let Ok(path) = std::env::var("CARGO_BIN_EXE_tautline") {
            return path.into();
        }
        let own = std::env::current_exe().expect("a path");
        // Tests lie in the folder deps, programs beside it.
        let mut folders = own.ancestors().skip(1).skip_while(|f| f.ends_with("deps"));
        let folder = folders.next().expect("the folder of the profile");
        let program = folder.join(format!("tautline{}", std::env::consts::EXE_SUFFIX));
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let sources = newest(&root.join("src"));
        if modified(&program).is_none_or(|built| sources.is_some_and(|changed| changed > built)) {
            build(&root, folder);
        }
        program
    })
}

fn build(root: &Path, folder: &Path) {
    let profile = match folder.file_name().and_then(|name| name.to_str()) {
        None | Some("debug") => "dev",
        Some(name) => name,
    };
    let target = folder.parent().expect("the target folder");
    let status = Command::new(env!("CARGO"))
        .args(["build", "--quiet", "--profile", profile, "--workspace"])
        // With a test beside it, so that libraries have the features that the tests have, and are not built twice.
        .args(["--bin", "tautline", "--test", "workbench_window"])
        .arg("--target-dir")
        .arg(target)
        .current_dir(root)
        .status();
    assert!(status.expect("cargo starts").success());
}

fn modified(path: &Path) -> Option<SystemTime> {
    std::fs::metadata(path).ok()?.modified().ok()
}

/// When the newest file below a folder was changed.
fn newest(folder: &Path) -> Option<SystemTime> {
    let entries = std::fs::read_dir(folder).ok()?.flatten();
    let times = entries.filter_map(|entry| match entry.file_type().ok()?.is_dir() {
        true => newest(&entry.path()),
        false => modified(&entry.path()),
    });
    times.max()
}
