//! What the window shows, as a text file, for programs that drive it from the outside.

use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;

use egui::accesskit::{Node, NodeId, Toggled};
use egui::{Context, FullOutput, Plugin};

/// Writes after every frame what the window shows: in the first line the number of frames; then for each element its
/// role, its name, its place in pixels from the upper left corner of the window (x, y, width, height), and whether it
/// is selected, separated by tabs.
struct Observer {
    path: PathBuf,
    frames: u64,
}

/// From now on the window is described in the file `path`.
pub fn observe(context: &Context, path: PathBuf) {
    context.enable_accesskit();
    context.add_plugin(Observer { path, frames: 0 });
}

impl Plugin for Observer {
    fn debug_name(&self) -> &'static str {
        "observer"
    }

    fn output_hook(&mut self, context: &Context, output: &mut FullOutput) {
        self.frames += 1;
        let Some(update) = &output.platform_output.accesskit_update else {
            return;
        };
        let mut text = format!("{}\n", self.frames);
        let scale = f64::from(context.pixels_per_point());
        for (_, node) in &update.nodes {
            text.push_str(&line(node, &update.nodes, scale).unwrap_or_default());
        }
        // Renamed when it is whole, so that nobody reads half of it; who cannot read it sees that the file is old.
        let whole = self.path.with_extension("part");
        let _ = fs::write(&whole, text).and_then(|()| fs::rename(&whole, &self.path));
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
        // Writing to a string does not fail.
        let _ = write!(text, "\t{:.0}", number * scale);
    }
    text.push_str(if selected { "\tselected\n" } else { "\t\n" });
    Some(text)
}
