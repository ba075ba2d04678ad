//! Text file that describes the content of the window, for programs that operate it from outside.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use egui::accesskit::{Node, NodeId, Toggled, TreeUpdate};
use egui::{Context, FullOutput, Plugin};

/// Interval between two descriptions, so that they do not influence measured frame times.
const PAUSE: Duration = Duration::from_millis(30);

/// Observer of the frames. The file has the number of frames in the first line; then for each element, separated by
/// tabs, its role, its name, its rectangle in pixels from the upper left corner of the window (x, y, width, height),
/// and whether it is selected. Of frames in quick succession only the last is written.
struct Observer {
    frames: u64,
    describe: mpsc::Sender<ObservedFrame>,
}

/// Accessibility tree of a frame.
struct ObservedFrame {
    frame: u64,
    update: TreeUpdate,
    pixels_per_point: f64,
}

/// Begins to describe the window in the file `path`, on a separate thread so that the time of the window's thread is
/// not affected.
pub fn observe(context: &Context, path: PathBuf) {
    let (describe, seen) = mpsc::channel::<ObservedFrame>();
    let write = move || {
        while let Ok(first) = seen.recv() {
            // Only the last of the waiting frames is written.
            let last = seen.try_iter().last().unwrap_or(first);
            last.write(&path);
            thread::sleep(PAUSE);
        }
    };
    // Without the thread there is no description; the reader of the file reports that.
    let _ = thread::Builder::new().name("observer".into()).spawn(write);
    context.enable_accesskit();
    context.add_plugin(Observer {
        frames: 0,
        describe,
    });
}

impl Plugin for Observer {
    fn debug_name(&self) -> &'static str {
        "observer"
    }

    fn output_hook(&mut self, context: &Context, output: &mut FullOutput) {
        self.frames += 1;
        // Moved, not copied: a program that observes the window needs no screen reader.
        let Some(update) = output.platform_output.accesskit_update.take() else {
            return;
        };
        let seen = ObservedFrame {
            frame: self.frames,
            update,
            pixels_per_point: f64::from(context.pixels_per_point()),
        };
        // The thread ends only with the program.
        let _ = self.describe.send(seen);
    }
}

impl ObservedFrame {
    fn write(&self, path: &Path) {
        let mut text = format!("{}\n", self.frame);
        let nodes = &self.update.nodes;
        for (_, node) in nodes {
            text.push_str(&line(node, nodes, self.pixels_per_point).unwrap_or_default());
        }
        // Renamed when complete, so that no reader sees half of it; a write error shows as an old file.
        let whole = path.with_extension("part");
        let _ = fs::write(&whole, text).and_then(|()| fs::rename(&whole, path));
    }
}

fn line(node: &Node, nodes: &[(NodeId, Node)], scale: f64) -> Option<String> {
    let place = node.bounds()?;
    let of_label = || {
        let label = node.labelled_by().first()?;
        let (_, label) = nodes.iter().find(|(id, _)| id == label)?;
        label.label().or(label.value())
    };
    let name = node.label().or_else(of_label).or(node.value())?;
    let selected = node.is_selected() == Some(true) || node.toggled() == Some(Toggled::True);
    let mut text = format!("{:?}\t{}", node.role(), name.replace(['\n', '\t'], " "));
    for number in [place.x0, place.y0, place.x1 - place.x0, place.y1 - place.y0] {
        // Writing to a string cannot fail.
        let _ = write!(text, "\t{:.0}", number * scale);
    }
    text.push_str(if selected { "\tselected\n" } else { "\t\n" });
    Some(text)
}
