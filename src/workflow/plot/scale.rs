//! Mapping of values to points on screen or page, and the ticks of an axis.

use emath::{Pos2, Rect};

use super::figure::Axis;
use super::round::round_up;
use crate::wording::units;

/// The view of a plot and its place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// Smallest and largest value along x and y.
    pub view: [[f64; 2]; 2],
    /// Rectangle of the data.
    pub rect: Rect,
}

impl Scale {
    /// Position of a value along x.
    #[must_use]
    pub fn x(&self, value: f64) -> f32 {
        let [low, high] = self.view[0];
        self.rect.min.x + (((value - low) / (high - low)) * f64::from(self.rect.width())) as f32
    }

    /// Position of a value along y; larger values are higher.
    #[must_use]
    pub fn y(&self, value: f64) -> f32 {
        let [low, high] = self.view[1];
        self.rect.max.y - (((value - low) / (high - low)) * f64::from(self.rect.height())) as f32
    }

    /// Position of a pair of values.
    #[must_use]
    pub fn place(&self, x: f64, y: f64) -> Pos2 {
        Pos2::new(self.x(x), self.y(y))
    }

    /// A horizontal line over the whole width.
    #[must_use]
    pub fn across(&self, y: f32) -> [Pos2; 2] {
        [self.rect.min.x, self.rect.max.x].map(|x| Pos2::new(x, y))
    }

    /// A vertical line over the whole height.
    #[must_use]
    pub fn upright(&self, x: f32) -> [Pos2; 2] {
        [self.rect.min.y, self.rect.max.y].map(|y| Pos2::new(x, y))
    }

    /// Values at a position.
    #[must_use]
    pub fn values(&self, place: Pos2) -> [f64; 2] {
        let [x, y] = self.view;
        let along = |[low, high]: [f64; 2], share: f32| low + (high - low) * f64::from(share);
        [
            along(x, (place.x - self.rect.min.x) / self.rect.width()),
            along(y, (self.rect.max.y - place.y) / self.rect.height()),
        ]
    }
}

/// A tick: value and text.
pub type Tick = (f64, String);

/// Smallest number of ticks from which a scale can be read.
const FEWEST: usize = 3;
/// Multiples of powers of ten at which a logarithmic axis has ticks, the rarest first.
const MULTIPLES: [&[f64]; 3] = [
    &[1.0, 3.0],
    &[1.0, 2.0, 5.0],
    &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0],
];

/// Ticks of an axis at round numbers, about `most` of them, but at least three if numbers between integers
/// are meaningful.
#[must_use]
pub fn scale_ticks(axis: &Axis, view: [f64; 2], most: usize) -> Vec<Tick> {
    let usual = ticks(axis, view, most);
    if usual.len() >= FEWEST || axis.is_whole || !axis.names.is_empty() {
        return usual;
    }
    let more = (most + 1..=4 * FEWEST).map(|most| ticks(axis, view, most));
    let mut enough = more.filter(|ticks| ticks.len() >= FEWEST);
    match enough.next() {
        Some(ticks) => ticks,
        None if axis.is_logarithmic => within_decades(view, most),
        None => usual,
    }
}

/// Ticks of a logarithmic axis that spans less than three powers of ten.
fn within_decades([low, high]: [f64; 2], most: usize) -> Vec<Tick> {
    let decades = (low.floor() as i32)..=(high.floor() as i32);
    let at = |multiples: &[f64]| -> Vec<Tick> {
        let of_decade = |decade: i32| {
            let ticks = multiples.iter().map(move |multiple| {
                let number = multiple * 10_f64.powi(decade);
                (number.log10(), plain(number, decade))
            });
            ticks.collect::<Vec<Tick>>()
        };
        let all = decades.clone().flat_map(of_decade);
        all.filter(|(at, _)| (low..=high).contains(at)).collect()
    };
    let mut by_multiples = MULTIPLES.iter().map(|multiples| at(multiples));
    if let Some(ticks) = by_multiples.find(|ticks| ticks.len() >= FEWEST) {
        return ticks;
    }
    // Such a small part of a decade is nearly linear.
    let numbers = [low, high].map(|end| 10_f64.powf(end));
    let ticks = scale_ticks(&Axis::default(), numbers, most).into_iter();
    ticks
        .filter(|(number, _)| *number > 0.0)
        .map(|(number, text)| (number.log10(), text))
        .collect()
}

/// A multiple of a power of ten in plain notation.
fn plain(number: f64, decade: i32) -> String {
    match decade {
        -3..=6 => format!("{number:.*}", decade.min(0).unsigned_abs() as usize),
        _ => format!("{number:.0e}"),
    }
}

/// Ticks of an axis at round numbers, at most about `most` of them.
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
            // Avoids `-0`.
            let value = (first + k as f64) * step + 0.0;
            let text = match axis.is_whole {
                true => format!("{value:.0}"),
                false => text(value, step, axis.is_logarithmic),
            };
            (value, text)
        })
        .collect()
}

/// The smallest of 1, 2, 5 times a power of ten that gives at most `most` ticks; an integer if `is_whole`.
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

/// A number with the decimals of a step, without exponent if possible.
#[must_use]
pub fn fixed(value: f64, step: f64) -> String {
    let decimals = (-step.log10() + 1e-9).ceil().max(0.0);
    if decimals > 6.0 || value.abs() >= 1e7 {
        return format!("{value:.2e}");
    }
    // The typographic minus has the width of a digit.
    units::fixed(value, decimals as usize).replace('-', "\u{2212}")
}

/// A number with the decimals that can be distinguished in a view.
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
        let logarithmic = Axis::logarithmic("", "");
        assert_eq!(texts(&logarithmic, [0.5, 3.2], 6), ["10", "100", "1000"]);
        let names = Axis {
            names: vec![(1.0, "one".into()), (9.0, "nine".into())],
            ..plain
        };
        assert_eq!(texts(&names, [0.0, 5.0], 5), ["one"]);
    }

    #[test]
    fn what_rounds_to_zero_has_no_sign() {
        assert_eq!(fixed(-0.004, 0.2), "0.0");
        assert_eq!(fixed(-0.4, 2.0), "0");
        assert_eq!(fixed(-0.06, 0.2), "\u{2212}0.1");
    }

    #[test]
    fn a_scale_has_three_ticks_wherever_one_looks() {
        let logarithmic = Axis::logarithmic("", "");
        let texts = |range| -> Vec<String> {
            let ticks = scale_ticks(&logarithmic, range, 4);
            ticks.into_iter().map(|(_, text)| text).collect()
        };
        assert_eq!(texts([-1.2, 0.6]), ["0.1", "0.3", "1", "3"]);
        assert_eq!(texts([1.9, 3.1]), ["100", "300", "1000"]);
        assert_eq!(texts([-0.01, 0.75]), ["1", "2", "5"]);
        for k in 0..2000_u32 {
            let low = f64::from(k % 97) * 0.173 - 8.0;
            let high = low + 10_f64.powf(f64::from(k % 41) * 0.1 - 3.0);
            for axis in [&logarithmic, &Axis::default()] {
                let found = scale_ticks(axis, [low, high], 4);
                assert!((3..=14).contains(&found.len()), "{low} {high}: {found:?}");
                let is_inside = |tick: &Tick| (low - 1e-9..=high + 1e-9).contains(&tick.0);
                assert!(found.iter().all(is_inside), "{low} {high}: {found:?}");
            }
        }
    }
}
