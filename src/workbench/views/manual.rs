//! Windows of the manual and of *About*.

use std::collections::HashMap;
use std::sync::{Arc, Mutex};

use egui::load::{ImageLoadResult, ImageLoader, ImagePoll, LoadError, SizeHint};
use egui::{Align, ColorImage, Context, Id, Key, Layout, RichText, ScrollArea, Ui, Window, vec2};
use egui_commonmark::{CommonMarkCache, CommonMarkViewer};

use crate::model::Model;
use crate::model::command::{Outbox, ViewCommand};
use crate::model::manual::{PICTURES, Page};
use crate::theme::{self, GRID};
use crate::widgets::UiExt;

/// Scheme of the picture URLs in the manual.
const SCHEME: &str = "manual://";
/// Largest size of the window (points).
const SIZE: [f32; 2] = [900.0, 640.0];
/// Width of the page list (points).
const PAGES: f32 = 196.0;
/// Comfortable line width (points).
const READABLE: f32 = 660.0;

#[derive(Default)]
pub struct Manual {
    cache: CommonMarkCache,
    /// Page drawn last; another page begins at its top.
    shown: Option<Page>,
}

/// Draws the windows of the manual and of *About* while they are open.
pub fn show(ui: &mut Ui, model: &Model, manual: &mut Manual, outbox: &mut Outbox) {
    if let Some(page) = model.dialogs.manual {
        pages(ui, page, manual, outbox);
    }
    if model.dialogs.about {
        about(ui, outbox);
    }
}

fn pages(ui: &mut Ui, page: Page, manual: &mut Manual, outbox: &mut Outbox) {
    install(ui.ctx());
    let room = ui.ctx().content_rect().size() - vec2(8.0 * GRID, 16.0 * GRID);
    let mut is_open = true;
    // A size chosen in a small window does not apply to a large one.
    let id = Id::unique(("manual", room.x as i32, room.y as i32));
    Window::new("Manual")
        .id(id)
        .open(&mut is_open)
        .collapsible(false)
        .pivot(egui::Align2::CENTER_CENTER)
        .default_pos(ui.ctx().content_rect().center())
        .default_size(vec2(SIZE[0], SIZE[1]).min(room))
        .max_size(room)
        .show(ui.ctx(), |ui| {
            let height = ui.available_height();
            ui.horizontal_top(|ui| {
                ui.allocate_ui_with_layout(
                    vec2(PAGES, height),
                    Layout::top_down_justified(Align::Min),
                    |ui| list(ui, page, outbox),
                );
                ui.separator();
                let is_other = manual.shown.replace(page) != Some(page);
                let mut area = ScrollArea::vertical()
                    .id_salt("page of the manual")
                    .auto_shrink([false, false]);
                if is_other {
                    area = area.vertical_scroll_offset(0.0);
                }
                area.show(ui, |ui| {
                    ui.set_max_width((ui.available_width() - 3.0 * GRID).min(READABLE));
                    text(ui, page, manual, outbox);
                });
            });
        });
    let is_left = ui.input(|input| input.key_pressed(Key::Escape));
    if !is_open || is_left {
        outbox.send(ViewCommand::Manual(None));
    }
}

fn list(ui: &mut Ui, page: Page, outbox: &mut Outbox) {
    for other in Page::ALL {
        let button = egui::Button::selectable(other == page, other.title());
        if ui.add(button).clicked() {
            outbox.send(ViewCommand::Manual(Some(other)));
        }
    }
}

fn text(ui: &mut Ui, page: Page, manual: &mut Manual, outbox: &mut Outbox) {
    // Links to other pages are not URLs.
    for other in Page::ALL {
        manual.cache.add_link_hook(other.name());
    }
    let width = ui.available_width() as usize;
    // Text of the manual can be copied.
    ui.style_mut().interaction.selectable_labels = true;
    CommonMarkViewer::new()
        .max_image_width(Some(width))
        .default_width(Some(width))
        .default_implicit_uri_scheme(SCHEME)
        .show(ui, &mut manual.cache, page.text());
    for other in Page::ALL {
        if manual.cache.get_link_hook(other.name()) == Some(true) {
            outbox.send(ViewCommand::Manual(Some(other)));
        }
    }
}

/// Installs the loader of the manual's pictures.
fn install(context: &Context) {
    if !context.is_loader_installed(Pictures::ID) {
        context.add_image_loader(Arc::new(Pictures::default()));
    }
}

/// Loader of the pictures that are part of the program.
#[derive(Default)]
struct Pictures {
    read: Mutex<HashMap<&'static str, Arc<ColorImage>>>,
}

impl Pictures {
    const ID: &'static str = concat!(module_path!(), "::Pictures");
}

impl ImageLoader for Pictures {
    fn id(&self) -> &str {
        Self::ID
    }

    fn load(&self, _: &Context, uri: &str, _: SizeHint) -> ImageLoadResult {
        let name = uri
            .strip_prefix(SCHEME)
            .and_then(|path| path.rsplit('/').next());
        let known = |name: &str| PICTURES.iter().find(|(known, _)| *known == name);
        let Some((name, png)) = name.and_then(known) else {
            return Err(LoadError::NotSupported);
        };
        let failed = |error: &dyn std::fmt::Display| LoadError::Loading(error.to_string());
        let mut read = self.read.lock().map_err(|error| failed(&error))?;
        if let Some(image) = read.get(name) {
            return Ok(ImagePoll::Ready {
                image: Arc::clone(image),
            });
        }
        let decoded = image::load_from_memory_with_format(png, image::ImageFormat::Png);
        let decoded = decoded.map_err(|error| failed(&error))?.into_rgba8();
        let size = [decoded.width() as usize, decoded.height() as usize];
        let image = Arc::new(ColorImage::from_rgba_unmultiplied(size, &decoded));
        read.insert(name, Arc::clone(&image));
        Ok(ImagePoll::Ready { image })
    }

    fn forget(&self, _: &str) {}

    fn forget_all(&self) {
        if let Ok(mut read) = self.read.lock() {
            read.clear();
        }
    }

    fn byte_size(&self) -> usize {
        let read = self.read.lock();
        read.map_or(0, |read| {
            read.values().map(|image| 4 * image.pixels.len()).sum()
        })
    }
}

/// Crates of the program with their versions, from the lock file of the build.
fn parts() -> Vec<(&'static str, &'static str)> {
    let value = |line: &'static str, key: &str| {
        let quoted = line.strip_prefix(key)?.strip_prefix(" = \"")?;
        quoted.strip_suffix('"')
    };
    let packages = include_str!("../../../Cargo.lock").split("[[package]]");
    packages
        .filter_map(|package| {
            // A package without a source is one of our own.
            package.lines().find_map(|line| value(line, "source"))?;
            let name = package.lines().find_map(|line| value(line, "name"))?;
            let version = package.lines().find_map(|line| value(line, "version"))?;
            Some((name, version))
        })
        .collect()
}

fn about(ui: &mut Ui, outbox: &mut Outbox) {
    let mut is_open = true;
    let room = ui.ctx().content_rect().size() - vec2(8.0 * GRID, 16.0 * GRID);
    Window::new("About Tautline")
        .open(&mut is_open)
        .collapsible(false)
        .resizable(false)
        .anchor(egui::Align2::CENTER_CENTER, egui::Vec2::ZERO)
        .default_size(vec2(460.0, 420.0).min(room))
        .max_size(room)
        .show(ui.ctx(), |ui| {
            ui.heading(concat!("Tautline ", env!("CARGO_PKG_VERSION")));
            ui.label("Calibration of cable-driven parallel robots.");
            ui.muted("Licence: MIT or Apache-2.0, as you choose. Without any warranty.");
            ui.section("Method");
            ui.label("After X. Jin, J. Jung, S. Y. Ko, E. Choi, J.-O. Park and C.-S. Kim, Sensors 18 (2018) 2392, solved jointly.");
            ui.section("Fonts");
            ui.label("Inter, SIL Open Font License 1.1. Material Symbols, Apache-2.0.");
            ui.section("Libraries");
            ui.muted("Free software under MIT, Apache-2.0, BSD, ISC, Zlib, BSL-1.0, MPL-2.0, Unicode or public-domain licences. Locked versions, tools of the tests included:");
            ScrollArea::vertical()
                .max_height(160.0)
                .auto_shrink([false, true])
                .show(ui, |ui| {
                    for (name, version) in parts() {
                        ui.horizontal(|ui| {
                            ui.label(name);
                            ui.label(RichText::new(version).color(theme::of(ui).muted));
                        });
                    }
                });
        });
    let is_left = ui.input(|input| input.key_pressed(Key::Escape));
    if !is_open || is_left {
        outbox.send(ViewCommand::About(false));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_read_by_their_names() {
        let pictures = Pictures::default();
        let context = Context::default();
        for (name, _) in PICTURES {
            let uri = format!("{SCHEME}../../screenshots/{name}");
            let read = pictures.load(&context, &uri, SizeHint::default());
            let Ok(ImagePoll::Ready { image }) = read else {
                panic!("{name} is not read");
            };
            assert!(image.size[0] > 600, "{name}");
        }
        let other = pictures.load(&context, "file://start.png", SizeHint::default());
        assert!(matches!(other, Err(LoadError::NotSupported)));
    }

    #[test]
    fn the_parts_of_the_program_have_versions() {
        let parts = parts();
        assert!(parts.len() > 100);
        assert!(parts.iter().any(|(name, _)| *name == "egui"));
        assert!(parts.iter().all(|(name, _)| !name.starts_with("tautline")));
    }
}
