//! Plots of residuals.

use super::drawing::{Anchor, Drawing, Ink, Shape};

/// Size of the plot of one cable (pt): two stand side by side.
const SIZE: [f64; 2] = [236.0, 104.0];
/// Space around the axes: left, top, right, bottom (pt).
const MARGIN: [f64; 4] = [26.0, 18.0, 6.0, 24.0];
/// Size of the labels (pt).
const LABEL: f64 = 7.0;
/// Standard deviations beyond which a residual is improbable.
const LIMIT: f64 = 3.0;
/// Standard deviations that a plot shows at most: what is farther out stands at the edge.
const FARTHEST: f64 = 12.0;

/// From values to points of the drawing.
struct Axes {
    x: [f64; 2],
    y: [f64; 2],
    size: [f64; 2],
}

impl Axes {
    fn at(&self, x: f64, y: f64) -> [f64; 2] {
        let [left, top, right, bottom] = MARGIN;
        let share = |value: f64, [from, to]: [f64; 2]| {
            if to > from {
                (value - from) / (to - from)
            } else {
                0.5
            }
        };
        [
            left + share(x, self.x) * (self.size[0] - left - right),
            self.size[1] - bottom - share(y, self.y) * (self.size[1] - top - bottom),
        ]
    }

    /// A horizontal line with its value before it.
    fn level(&self, y: f64, ink: Ink, text: String, shapes: &mut Vec<Shape>) {
        let (from, to) = (self.at(self.x[0], y), self.at(self.x[1], y));
        shapes.push(line(from, to, ink));
        shapes.push(label(
            [from[0] - 4.0, from[1] + 2.5],
            Anchor::End,
            Ink::Muted,
            text,
        ));
    }

    /// A value below the axis.
    fn value(&self, x: f64, text: String, shapes: &mut Vec<Shape>) {
        let [px, _] = self.at(x, self.y[0]);
        let y = self.size[1] - MARGIN[3];
        shapes.push(line([px, y], [px, y + 2.5], Ink::Muted));
        shapes.push(label([px, y + 10.0], Anchor::Middle, Ink::Muted, text));
    }
}

fn line(from: [f64; 2], to: [f64; 2], ink: Ink) -> Shape {
    Shape::Line {
        from,
        to,
        ink,
        width: 0.6,
    }
}

fn label(at: [f64; 2], anchor: Anchor, ink: Ink, text: String) -> Shape {
    Shape::Text {
        at,
        size: LABEL,
        anchor,
        ink,
        bold: false,
        text,
    }
}

fn title(text: &str) -> Shape {
    Shape::Text {
        at: [MARGIN[0], 10.0],
        size: 8.0,
        anchor: Anchor::Start,
        ink: Ink::Dark,
        bold: true,
        text: text.to_owned(),
    }
}

/// What the horizontal axis shows, at its right end.
fn axis_name(size: [f64; 2], text: &str) -> Shape {
    let at = [size[0] - MARGIN[2], size[1] - 3.0];
    label(at, Anchor::End, Ink::Muted, text.to_owned())
}

/// A step of 1, 2 or 5 times a power of ten of which about `count` make the span.
pub fn step(span: f64, count: f64) -> f64 {
    let rough = span / count;
    if !(rough.is_finite() && rough > 0.0) {
        return 1.0;
    }
    let power = 10_f64.powf(rough.log10().floor());
    let share = rough / power;
    let factor = [1.0, 2.0, 5.0].into_iter().find(|f| share <= *f * 1.001);
    factor.unwrap_or(10.0) * power
}

/// Residuals over the poses, in standard deviations; the band is where 997 of 1000 lie. Points are the number of the pose
/// and its residual.
pub fn residuals(name: &str, points: &[(i64, f64)], sd_text: &str) -> Drawing {
    let poses = points.iter().map(|(pose, _)| *pose as f64);
    let largest = points.iter().map(|(_, r)| r.abs()).fold(4.0, f64::max);
    let reach = largest.min(FARTHEST);
    let axes = Axes {
        x: [
            poses.clone().fold(f64::INFINITY, f64::min) - 1.0,
            poses.fold(f64::NEG_INFINITY, f64::max) + 1.0,
        ],
        y: [-1.08 * reach, 1.08 * reach],
        size: SIZE,
    };
    let mut shapes = vec![title(name)];
    let heading = [SIZE[0] - MARGIN[2], 10.0];
    shapes.push(label(heading, Anchor::End, Ink::Muted, sd_text.to_owned()));
    let [upper, lower] = [axes.at(axes.x[0], LIMIT), axes.at(axes.x[1], -LIMIT)];
    shapes.push(Shape::Area {
        at: upper,
        size: [lower[0] - upper[0], lower[1] - upper[1]],
        ink: Ink::Band,
    });
    for level in [-LIMIT, LIMIT] {
        let sign = if level < 0.0 { "−" } else { "+" };
        axes.level(level, Ink::Faint, format!("{sign}{LIMIT:.0}"), &mut shapes);
    }
    axes.level(0.0, Ink::Muted, "0".to_owned(), &mut shapes);
    let spacing = step(axes.x[1] - axes.x[0], 6.0).max(1.0);
    let mut pose = (axes.x[0] / spacing).ceil() * spacing;
    while pose <= axes.x[1] {
        axes.value(pose, format!("{pose:.0}").replace('-', "−"), &mut shapes);
        pose += spacing;
    }
    for (pose, residual) in points {
        let shown = residual.clamp(-reach, reach);
        let within = residual.abs() <= LIMIT;
        shapes.push(Shape::Dot {
            at: axes.at(*pose as f64, shown),
            radius: 1.6,
            ink: if within { Ink::Accent } else { Ink::Warning },
        });
    }
    shapes.push(axis_name(SIZE, "pose"));
    Drawing {
        label: format!("Residuals of {name} over the poses"),
        size: SIZE,
        shapes,
    }
}

/// Bins of a histogram per standard deviation.
const BINS: f64 = 2.0;
/// Standard deviations that a histogram shows on either side; what is farther out is in the last bin.
const SPAN: f64 = 5.0;

/// How often residuals of a size occur, and how often they would with the noise as given.
pub fn histogram(name: &str, residuals: &[f64]) -> Drawing {
    let size = [2.0 * SIZE[0] + 12.0, 128.0];
    let count = (2.0 * SPAN * BINS) as usize;
    let mut bins = vec![0_usize; count];
    for residual in residuals {
        let bin = ((residual + SPAN) * BINS)
            .floor()
            .clamp(0.0, count as f64 - 1.0);
        bins[bin as usize] += 1;
    }
    let expected = |x: f64| {
        let density = (-0.5 * x * x).exp() / (2.0 * std::f64::consts::PI).sqrt();
        density * residuals.len() as f64 / BINS
    };
    let most = bins.iter().map(|n| *n as f64).fold(expected(0.0), f64::max);
    let axes = Axes {
        x: [-SPAN, SPAN],
        y: [0.0, 1.05 * most.max(1.0)],
        size,
    };
    let mut shapes = vec![title(name)];
    let spacing = step(axes.y[1], 4.0).max(1.0);
    let mut level = spacing;
    while level <= axes.y[1] {
        axes.level(level, Ink::Faint, format!("{level:.0}"), &mut shapes);
        level += spacing;
    }
    for (bin, number) in bins.iter().enumerate() {
        let from = -SPAN + bin as f64 / BINS;
        let [upper, lower] = [
            axes.at(from, *number as f64),
            axes.at(from + 1.0 / BINS, 0.0),
        ];
        shapes.push(Shape::Area {
            at: [upper[0] + 0.5, upper[1]],
            size: [lower[0] - upper[0] - 1.0, lower[1] - upper[1]],
            ink: if from + 0.25 < -LIMIT || from + 0.25 > LIMIT {
                Ink::Warning
            } else {
                Ink::Accent
            },
        });
    }
    axes.level(0.0, Ink::Muted, "0".to_owned(), &mut shapes);
    let steps = 100;
    let x = |k: usize| -SPAN + 2.0 * SPAN * k as f64 / steps as f64;
    shapes.extend((0..steps).map(|k| Shape::Line {
        from: axes.at(x(k), expected(x(k))),
        to: axes.at(x(k + 1), expected(x(k + 1))),
        ink: Ink::Dark,
        width: 1.0,
    }));
    for k in -4_i32..=4 {
        let text = if k < 0 {
            format!("−{}", -k)
        } else {
            k.to_string()
        };
        axes.value(f64::from(k), text, &mut shapes);
    }
    shapes.push(axis_name(size, "standard deviations"));
    Drawing {
        label: format!("{name}: how often residuals of a size occur"),
        size,
        shapes,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round() {
        for (span, count, expected) in [(40.0, 6.0, 10.0), (12.0, 6.0, 2.0), (0.9, 4.0, 0.5)] {
            assert!((step(span, count) - expected).abs() < 1e-12, "{span}");
        }
        assert_eq!(step(0.0, 5.0), 1.0);
    }

    fn dots(drawing: &Drawing) -> Vec<([f64; 2], Ink)> {
        let shapes = drawing.shapes.iter();
        shapes
            .filter_map(|shape| match shape {
                Shape::Dot { at, ink, .. } => Some((*at, *ink)),
                _ => None,
            })
            .collect()
    }

    #[test]
    fn residuals_stay_in_the_plot_and_those_outside_the_band_are_marked() {
        let points = [(1, 0.5), (2, -2.9), (3, 3.5), (4, -400.0)];
        let drawing = residuals("cable-1", &points, "");
        let dots = dots(&drawing);
        assert_eq!(
            dots.iter().map(|(_, ink)| *ink).collect::<Vec<_>>(),
            [Ink::Accent, Ink::Accent, Ink::Warning, Ink::Warning]
        );
        for ([x, y], _) in dots {
            assert!((0.0..SIZE[0]).contains(&x) && (0.0..SIZE[1]).contains(&y));
        }
    }

    #[test]
    fn one_pose_makes_a_plot() {
        let drawing = residuals("cable-1", &[(1, 0.0)], "");
        assert!(!drawing.svg().contains("NaN"));
        assert!(!histogram("Lengths", &[]).svg().contains("NaN"));
    }

    #[test]
    fn names_are_no_markup() {
        let svg = residuals("<script>\"&", &[(1, 0.0)], "").svg();
        assert!(!svg.contains("<script"), "{svg}");
        assert!(svg.contains("&lt;script&gt;&quot;&amp;"), "{svg}");
    }
}
