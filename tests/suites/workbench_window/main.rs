//! The real window, from the start screen to the end: keys, pointer, OpenGL, files.

use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, ensure};
use image::RgbaImage;
use tautline_core::effect::EffectSetting;
use tautline_core::robot::presets;
use tautline_core::simulation::simulate;
use tautline_session::{PhaseData, Session, read_session, write_dataset};
use tautline_validation::support::program::program;
use tautline_validation::support::window::{Display, Window, keys};
use tautline_validation::tables::simulated::preset_options;

const SIZE: [u32; 2] = [1440, 900];
/// Measured poses, the home pose among them.
const POSES: usize = 27;

/// A dataset folder of MINI, with one winch whose scale is wrong.
fn dataset(folder: &Path) -> Result<()> {
    let preset = presets::find("mini").context("a preset")?;
    let mut options = preset_options(&preset, POSES - 1, 5);
    options.effects = vec![EffectSetting {
        effect: "winch_scale".into(),
        targets: vec!["cable-3".into()],
        parameters: [("scale".to_owned(), 0.02)].into(),
    }];
    let simulated = simulate(&preset.robot, &options)?;
    write_dataset(folder, &simulated.dataset, &PhaseData::default())?;
    Ok(())
}

/// Number of different colours.
fn colours(picture: &RgbaImage) -> usize {
    let colours: std::collections::BTreeSet<_> = picture.pixels().map(|pixel| pixel.0).collect();
    colours.len()
}

/// Number of pixels that differ.
fn differences(a: &RgbaImage, b: &RgbaImage) -> usize {
    a.pixels().zip(b.pixels()).filter(|(a, b)| a != b).count()
}

fn demo(window: &mut Window) -> Result<()> {
    let demo = window.named("Button", "Try the demo robot")?;
    window.click(&demo)?;
    window.text("1. ")?;
    for digit in '1'..='5' {
        window.command(digit)?;
        window.element(&format!("phase {digit}"), |element| {
            element.role == "Button"
                && element.selected
                && element.name.starts_with(&format!("Phase {digit}: "))
        })?;
    }
    window.command('w')?;
    let discard = window.named("Button", "Do not save")?;
    window.click(&discard)
}

fn open(window: &mut Window, path: &str) -> Result<()> {
    window.enter("Path", path)?;
    window.display.strike(&[], keys::RETURN)?;
    window.text("4. ")?;
    Ok(())
}

/// Turns the robot by the pointer; the picture has to change.
fn turn(window: &mut Window) -> Result<()> {
    let view = window.named("Canvas", "3D view")?;
    window.rest()?;
    let [left, top, width, height] = view.place;
    let place = (left as i16, top as i16, width as u16, height as u16);
    let before = window.display.picture(place)?;
    ensure!(colours(&before) > 50, "the robot is not drawn");
    let (x, y) = view.middle();
    window.display.move_to((x - 150, y - 60))?;
    window.display.button(true)?;
    for step in 0..20 {
        window
            .display
            .move_to((x - 150 + 10 * step, y - 60 + step))?;
        std::thread::sleep(std::time::Duration::from_millis(16));
    }
    window.display.button(false)?;
    window.rest()?;
    let after = window.display.picture(place)?;
    let changed = differences(&before, &after);
    ensure!(changed > 2000, "only {changed} pixels changed by the drag");
    Ok(())
}

fn save(window: &mut Window, path: &str) -> Result<()> {
    window.command('S')?;
    window.enter("Path of the file", path)?;
    window.display.strike(&[], keys::RETURN)?;
    window.text("Saved ")?;
    Ok(())
}

fn formats(session: &Session) -> Vec<&str> {
    let records = session.results().iter();
    records.filter_map(|record| record.format()).collect()
}

#[test]
fn from_the_start_screen_to_a_saved_session() -> Result<()> {
    let folder = tempfile::tempdir()?;
    dataset(&folder.path().join("measured"))?;
    let saved = folder.path().join("saved.json");
    let text = |path: &Path| path.to_str().map(str::to_owned).context("UTF-8");

    let mut window = Window::open(folder.path(), SIZE, &[])?;
    demo(&mut window)?;
    open(&mut window, &text(&folder.path().join("measured"))?)?;
    window.command('i')?;
    window.text("Identified from 27 poses")?;
    window.rest()?;
    let row = window.element("the row of a cable", |element| {
        element.role == "Button" && element.name.starts_with("Cable 3: moved")
    })?;
    window.click(&row)?;
    window.element("the selected row", |element| {
        element.selected && element.name == row.name
    })?;
    turn(&mut window)?;
    window.command('d')?;
    window.text("Diagnosis finished")?;
    save(&mut window, &text(&saved)?)?;
    window.rest()?;
    let picture = window
        .display
        .picture((0, 0, SIZE[0] as u16, SIZE[1] as u16))?;
    if let Some(path) = std::env::var_os("TAUTLINE_PICTURE") {
        picture.save(path)?;
    }
    ensure!(colours(&picture) > 200, "the window is nearly blank");
    window.command('q')?;
    let status = window.end()?;
    let complaints = window.complaints();
    ensure!(status.success(), "{status}\n{complaints}");
    ensure!(!complaints.contains("panicked"), "{complaints}");

    let session = read_session(&saved)?;
    assert!(session.notices.is_empty(), "{:?}", session.notices);
    assert_eq!(session.value.measurements.len(), POSES);
    let formats = formats(&session.value);
    for format in ["tautline-identification", "tautline-diagnosis"] {
        assert!(formats.contains(&format), "{formats:?}");
    }
    let recovery = folder.path().join("home").join("recovery");
    let left = tautline_session::find_unsaved_sessions(&recovery)?;
    assert!(left.is_empty(), "everything is saved: {left:?}");
    Ok(())
}

#[test]
fn without_opengl_there_is_a_sentence_and_the_commands() -> Result<()> {
    let display = Display::without_glx(640, 480)?;
    let answer = Command::new(program())
        .env("DISPLAY", &display.name)
        .env_remove("WAYLAND_DISPLAY")
        // EGL finds no implementation either.
        .env("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent")
        .output()?;
    let told = String::from_utf8(answer.stderr)?;
    assert_eq!(answer.status.code(), Some(1), "{told}");
    let expected = [
        "no window can be opened (OpenGL: ",
        "the commands need none: `tautline --help` lists them",
    ];
    for part in expected {
        assert!(told.contains(part), "{told}");
    }
    assert_eq!(told.lines().count(), 1, "{told}");
    Ok(())
}
