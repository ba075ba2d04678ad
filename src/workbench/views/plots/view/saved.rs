//! Export of a plot with its present view.

use std::sync::Arc;

use egui::{Pos2, Rect, Theme, Ui};
use tautline_workflow::plot::draw::draw;
use tautline_workflow::plot::table::csv;
use tautline_workflow::plot::{Drawing, Figure, Layout};

use super::PlotView;
use crate::model::Selection;
use crate::model::command::{Format, PlotFile, PlotPicture};
use crate::theme;
use crate::views::plots::print;
use crate::views::plots::screen::{colours, text_width};

impl PlotView {
    /// Plot as a file; `None` before it was drawn.
    pub(crate) fn file(
        &self,
        ui: &Ui,
        name: &str,
        figure: &Figure,
        selection: Selection,
        format: Format,
    ) -> Option<PlotFile> {
        let drawn = self.drawn?;
        let figure = self.visible(figure);
        let view = drawn.scale.view;
        Some(match format {
            Format::Csv => PlotFile::Text(csv(&figure, view)),
            Format::Svg => {
                // Always on white, whatever the theme.
                let palette = theme::palette(Theme::Light);
                let whole = Rect::from_min_size(Pos2::ZERO, drawn.size);
                let layout = Layout::new(&figure, view, whole, &text_width(ui.painter()));
                let outer = whole.expand(8.0);
                let drawing = Drawing::record(name, outer, 1.0, |canvas| {
                    canvas.fill(outer, palette.raised);
                    let resolution = ui.pixels_per_point();
                    let colours = colours(palette);
                    draw(canvas, &figure, &layout, selection, &colours, resolution);
                });
                PlotFile::Text(drawing.svg_file())
            }
            Format::Png => PlotFile::Picture(PlotPicture {
                figure: Arc::new(figure),
                view,
                selection,
                aspect: drawn.size.x / drawn.size.y,
                render: print::png,
            }),
        })
    }
}
