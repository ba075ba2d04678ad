//! From values to points of the screen or the page, and the ticks of an axis.

use emath::{Pos2, Rect, Vec2};

use super::figure::Axis;
use super::round::round_up;

/// What a plot shows and where.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// Least and greatest value along x and y.
    pub view: [[f64; 2]; 2],
    /// Where it is drawn.
    pub rect: Rect,
}

impl Scale {
    /// Place of a value along x.
    #[must_use]
    pub fn x(&self, value: f64) -> f32 {
        let [low, high] = self.view[0];
        self.rect.min.x + (((value - low) / (high - low)) * f64::from(self.rect.width())) as f32
    }

    /// Place of a value along y; upwards is greater.
    #[must_use]
    pub fn y(&self, value: f64) -> f32 {
        let [low, high] = self.view[1];
        self.rect.max.y - (((value - low) / (high - low)) * f64::from(self.rect.height())) as f32
    }

    /// Place of a pair of values.
    #[must_use]
    pub fn place(&self, x: f64, y: f64) -> Pos2 {
        Pos2::new(self.x(x), self.y(y))
    }

    /// A line over the whole width at a height.
    #[must_use]
    pub fn across(&self, y: f32) -> [Pos2; 2] {
        [self.rect.min.x, self.rect.max.x].map(|x| Pos2::new(x, y))
    }

    /// A line over the whole height.
    #[must_use]
    pub fn upright(&self, x: f32) -> [Pos2; 2] {
        [self.rect.min.y, self.rect.max.y].map(|y| Pos2::new(x, y))
    }

    /// Values at a place.
    #[must_use]
    pub fn values(&self, place: Pos2) -> [f64; 2] {
        let [x, y] = self.view;
        let along = |[low, high]: [f64; 2], share: f32| low + (high - low) * f64::from(share);
        [
            along(x, (place.x - self.rect.min.x) / self.rect.width()),
            along(y, (self.rect.max.y - place.y) / self.rect.height()),
        ]
    }

    /// The view zoomed about a place; a factor above 1 shows less.
    #[must_use]
    pub fn zoomed(&self, about: Pos2, factor: [f64; 2]) -> [[f64; 2]; 2] {
        let centre = self.values(about);
        std::array::from_fn(|axis| {
            let [low, high] = self.view[axis];
            let at = centre[axis];
            let zoomed = [low, high].map(|end| at + (end - at) / factor[axis]);
            // Beyond this, neighbouring numbers are the same.
            let smallest = 1e-9 * low.abs().max(high.abs()).max(1e-6);
            if zoomed[1] - zoomed[0] < smallest || !(zoomed[1] - zoomed[0]).is_finite() {
                [low, high]
            } else {
                zoomed
            }
        })
    }

    /// The view moved by a distance on screen.
    #[must_use]
    pub fn moved(&self, by: Vec2) -> [[f64; 2]; 2] {
        let [x, y] = self.view;
        let shift = [
            -f64::from(by.x / self.rect.width()) * (x[1] - x[0]),
            f64::from(by.y / self.rect.height()) * (y[1] - y[0]),
        ];
        [x.map(|end| end + shift[0]), y.map(|end| end + shift[1])]
    }
}

/// A tick: value and text.
pub type Tick = (f64, String);

/// Ticks of an axis at round numbers, about `most` of them.
#[must_use]
pub fn ticks(axis: &Axis, [low, high]: [f64; 2], most: usize) -> Vec<Tick> {
    if !axis.names.is_empty() {
        let seen = axis
            .names
            .iter()
            .filter(|(at, _)| (low..=high).contains(at));
        return seen.cloned().collect();
    }
    let step = step([low, high], most, axis.is_logarithmic || axis.is_whole);
    if !(step.is_finite() && step > 0.0) {
        return Vec::new();
    }
    let first = (low / step).ceil();
    let count = ((high / step).floor() - first).max(-1.0) as usize + 1;
    (0..count.min(1000))
        .map(|k| {
            // Not `-0`.
            let value = (first + k as f64) * step + 0.0;
            let text = match axis.is_whole {
                true => format!("{value:.0}"),
                false => text(value, step, axis.is_logarithmic),
            };
            (value, text)
        })
        .collect()
}

/// The smallest of 1, 2, 5 times a power of ten that gives at most `most` ticks; a whole number where asked.
fn step([low, high]: [f64; 2], most: usize, is_whole: bool) -> f64 {
    let step = round_up((high - low) / most.max(1) as f64);
    if is_whole {
        step.max(1.0).round()
    } else {
        step
    }
}

fn text(value: f64, step: f64, is_logarithmic: bool) -> String {
    if is_logarithmic {
        let number = 10_f64.powf(value);
        return if (-3.0..=6.0).contains(&value) {
            format!("{number}")
        } else {
            format!("{number:.0e}")
        };
    }
    fixed(value, step)
}

/// A number with the decimals that a step needs, without exponent where it can be avoided.
#[must_use]
pub fn fixed(value: f64, step: f64) -> String {
    let decimals = (-step.log10() + 1e-9).ceil().max(0.0);
    if decimals > 6.0 || value.abs() >= 1e7 {
        return format!("{value:.2e}");
    }
    let text = format!("{value:.*}", decimals as usize);
    // The typographic minus has the width of a digit.
    text.replace('-', "\u{2212}")
}

/// A number with the decimals that a screen of `view` can tell apart.
#[must_use]
pub fn readable(value: f64, [low, high]: [f64; 2]) -> String {
    fixed(value, (high - low) / 500.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scale() -> Scale {
        Scale {
            view: [[0.0, 10.0], [-1.0, 1.0]],
            rect: Rect::from_min_max(Pos2::new(100.0, 50.0), Pos2::new(300.0, 150.0)),
        }
    }

    #[test]
    fn places_and_values_are_inverse() {
        let place = scale().place(2.5, 0.5);
        assert_eq!(place, Pos2::new(150.0, 75.0));
        let [x, y] = scale().values(place);
        assert!((x - 2.5).abs() < 1e-6 && (y - 0.5).abs() < 1e-6);
    }

    #[test]
    fn zoom_keeps_the_value_under_the_pointer_and_moving_follows_it() {
        let about = Pos2::new(150.0, 75.0);
        let zoomed = Scale {
            view: scale().zoomed(about, [2.0, 4.0]),
            ..scale()
        };
        assert!((zoomed.values(about)[0] - 2.5).abs() < 1e-6);
        assert!((zoomed.view[0][1] - zoomed.view[0][0] - 5.0).abs() < 1e-9);
        let by = emath::vec2(20.0, -10.0);
        let moved = Scale {
            view: scale().moved(by),
            ..scale()
        };
        let [x, y] = moved.values(about + by);
        assert!((x - 2.5).abs() < 1e-6 && (y - 0.5).abs() < 1e-6);
    }

    #[test]
    fn ticks_are_round_numbers() {
        let texts = |axis: &Axis, range, most| -> Vec<String> {
            ticks(axis, range, most)
                .into_iter()
                .map(|(_, text)| text)
                .collect()
        };
        let plain = Axis::default();
        assert_eq!(
            texts(&plain, [-0.21, 0.3], 5),
            ["\u{2212}0.2", "0.0", "0.2"]
        );
        assert_eq!(texts(&plain, [0.0, 41.0], 5), ["0", "10", "20", "30", "40"]);
        let logarithmic = Axis {
            is_logarithmic: true,
            ..Axis::default()
        };
        assert_eq!(texts(&logarithmic, [0.5, 3.2], 6), ["10", "100", "1000"]);
        let names = Axis {
            names: vec![(1.0, "one".into()), (9.0, "nine".into())],
            ..plain
        };
        assert_eq!(texts(&names, [0.0, 5.0], 5), ["one"]);
    }
}
