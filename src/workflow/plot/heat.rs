//! Heat maps: cells, colours, and the colour scale beside them.

use ecolor::Color32;
use emath::{Align2, Pos2, Rect, lerp, vec2};

use super::canvas::Canvas;
use super::colours::Colours;
use super::draw::{GRID, TEXT};
use super::figure::{ColourScale, HeatMap};
use super::scale::{Scale, fixed};

/// Width of the colour scale of a heat map.
pub const SCALE_WIDTH: f32 = 12.0;

/// Draws the cells.
pub fn cells(canvas: &mut dyn Canvas, heat: &HeatMap, scale: &Scale, colours: &Colours) {
    let columns = heat.x.len().saturating_sub(1).max(1);
    for (index, value) in heat.values.iter().enumerate() {
        let (row, column) = (index / columns, index % columns);
        let (Some(x), Some(y)) = (heat.x.get(column..column + 2), heat.y.get(row..row + 2)) else {
            continue;
        };
        let rect = Rect::from_two_pos(scale.place(x[0], y[0]), scale.place(x[1], y[1]));
        canvas.fill(rect, shade(heat.shades, *value, colours));
    }
}

/// Colour of a value of a heat map.
fn shade(shades: ColourScale, value: f64, colours: &Colours) -> Color32 {
    match shades {
        // Zero has the background colour, so that large values stand out.
        ColourScale::Diverging(most) => {
            let t = (value / most).clamp(-1.0, 1.0) as f32;
            let end = colours.diverging[usize::from(t >= 0.0)];
            colours.ground.lerp_to_gamma(end, t.abs())
        }
        ColourScale::Rising(low, high) => {
            let t = ((value - low) / (high - low)).clamp(0.0, 1.0) as f32;
            colours.ground.lerp_to_gamma(colours.accent, 0.08 + 0.8 * t)
        }
    }
}

/// Values at the ends of the colour scale.
#[must_use]
pub fn limits(shades: ColourScale) -> [f64; 2] {
    match shades {
        ColourScale::Diverging(most) => [-most, most],
        ColourScale::Rising(low, high) => [low, high],
    }
}

/// Draws the colour scale with its values beside the data.
pub fn colour_scale(canvas: &mut dyn Canvas, heat: &HeatMap, plot: Rect, colours: &Colours) {
    const STEPS: usize = 64;
    let bar = Rect::from_min_max(
        Pos2::new(plot.max.x + 3.0 * GRID, plot.min.y + TEXT + 2.0 * GRID),
        Pos2::new(plot.max.x + 3.0 * GRID + SCALE_WIDTH, plot.max.y),
    );
    let [low, high] = limits(heat.shades);
    let height = bar.height() / STEPS as f32;
    for k in 0..STEPS {
        let share = (k as f64 + 0.5) / STEPS as f64;
        let rect = Rect::from_min_size(
            Pos2::new(bar.min.x, bar.max.y - (k + 1) as f32 * height),
            vec2(SCALE_WIDTH, height),
        );
        canvas.fill(
            rect,
            shade(heat.shades, low + share * (high - low), colours),
        );
    }
    for share in [0.0, 0.5, 1.0] {
        let text = fixed(low + share * (high - low), (high - low) / 100.0);
        let y = lerp(bar.max.y..=bar.min.y, share as f32);
        let at = Pos2::new(bar.max.x + GRID, y);
        canvas.text(at, Align2::LEFT_CENTER, &text, TEXT, colours.muted);
    }
    let at = plot.right_top() + vec2(3.0 * GRID, 0.0);
    canvas.text(at, Align2::LEFT_TOP, heat.axis.unit, TEXT, colours.muted);
}
