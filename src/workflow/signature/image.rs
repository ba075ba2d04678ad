//! A picture of residuals: the readings of one kind over a variable.

use std::collections::BTreeMap;

use tautline_core::diagnosis::{Quantity, Variables};
use tautline_core::effect::Effect;
use tautline_core::estimation::Linearisation;
use tautline_core::measurement::Variable;

use crate::diagnosis::dependences::display_unit;
use crate::identification::{Identification, RESIDUAL, all_readings, group_of};
use crate::plot::figure::{Axis, Band, Figure, Ink, Marker, Point, Series};
use crate::wording::{readings, sentence};

/// Most pictures of one effect.
pub(super) const MOST_IMAGES: usize = 3;
/// Largest residual, in standard deviations, below which nobody sees anything in a picture.
pub(super) const LEAST_SEEN: f64 = 1.0;

/// Residuals of readings.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    /// The readings: `Length readings of cable-3`.
    pub name: String,
    /// Their residuals in standard deviations.
    pub figure: Figure,
}

/// A residual (standard deviations).
#[derive(Debug, Clone, Copy)]
pub(super) struct Residual {
    pub quantity: Quantity,
    pub cable: Option<usize>,
    pub row: usize,
    pub value: f64,
}

/// The residuals of all readings that another reading checks.
pub(super) fn residuals(fit: &Identification) -> Vec<Residual> {
    let of = |reading: &tautline_core::estimation::Observation| {
        let (quantity, cable) = group_of(reading.kind)?;
        Some(Residual {
            quantity,
            cable,
            row: reading.row,
            value: reading.normalised()?,
        })
    };
    all_readings(&fit.analysis).filter_map(of).collect()
}

/// Readings of one kind, of one cable if they belong to cables.
pub(super) type Group = (Quantity, Option<usize>);

/// Sum of squares and largest magnitude of some residuals in each group, by the key of the group.
pub(super) fn strengths<K: Ord>(
    residuals: &[Residual],
    key: impl Fn(&Residual) -> K,
) -> Vec<(K, f64, f64)> {
    let mut groups: BTreeMap<K, (f64, f64)> = BTreeMap::new();
    for one in residuals {
        let (sum, largest) = groups.entry(key(one)).or_default();
        *sum += one.value * one.value;
        *largest = largest.max(one.value.abs());
    }
    let groups = groups.into_iter();
    let mut groups: Vec<_> = groups
        .map(|(key, (sum, largest))| (key, sum, largest))
        .collect();
    groups.sort_by(|a, b| b.1.total_cmp(&a.1));
    groups
}

/// Place of a kind of reading among all, to sort by.
pub(super) fn order(quantity: Quantity) -> usize {
    let mut all = Quantity::ALL.into_iter();
    all.position(|other| other == quantity).unwrap_or_default()
}

/// Over what readings are drawn: the variable on which an effect depends, or the poses.
pub(super) struct Abscissa<'a> {
    fit: &'a Identification,
    variable: Option<Variable>,
    values: BTreeMap<(usize, Option<usize>), Vec<f64>>,
}

impl<'a> Abscissa<'a> {
    /// That of an effect for the readings of some groups: its own variable if all of them have it.
    pub fn of(fit: &'a Identification, effect: &Effect, groups: &[Group]) -> Self {
        let mut abscissa = Self {
            fit,
            variable: None,
            values: BTreeMap::new(),
        };
        let Some((variable, problem)) = effect.variable().zip(fit.problem().ok()) else {
            return abscissa;
        };
        let linear = Linearisation::new(&problem, &fit.solution);
        let variables = Variables::new(&problem, &fit.solution, &linear);
        for (quantity, cable) in groups {
            let Some(values) = variables.values(*quantity, *cable, variable) else {
                return abscissa;
            };
            let group = (order(*quantity), *cable);
            abscissa.values.insert(group, values);
        }
        abscissa.variable = Some(variable);
        abscissa
    }

    fn axis(&self) -> Axis {
        match self.variable {
            Some(variable) => Axis::new(sentence(variable.name()), display_unit(variable).1),
            None => Axis::whole("Pose"),
        }
    }

    /// The point of a residual; `None` where the variable is not known.
    pub fn point(&self, one: &Residual) -> Option<Point> {
        let label = *self.fit.dataset.measurements.labels.get(one.row)?;
        let x = match self.variable {
            Some(variable) => {
                let values = self.values.get(&(order(one.quantity), one.cable))?;
                display_unit(variable).0 * values.get(one.row)?
            }
            None => label as f64,
        };
        Some(Point {
            pose: Some(label),
            ..Point::new(x, one.value)
        })
    }

    /// A figure of residuals with the band of the noise.
    pub fn figure(&self, series: Vec<Series>) -> Figure {
        Figure {
            x: self.axis(),
            y: Axis::new(RESIDUAL, "standard deviations"),
            bands: vec![Band::new("within 3 standard deviations", [-3.0, 3.0])],
            series,
            has_zero_line: true,
            ..Figure::default()
        }
    }
}

/// The residuals of one kind of reading. Cables on which something is seen have their colours, all others one.
pub(super) fn image_of(
    fit: &Identification,
    effect: &Effect,
    (quantity, residuals): (Quantity, &[Residual]),
) -> Image {
    let own: Vec<Residual> = (residuals.iter().copied())
        .filter(|one| one.quantity == quantity)
        .collect();
    let cables = strengths(&own, |one| one.cable);
    let groups: Vec<Group> = cables
        .iter()
        .map(|(cable, ..)| (quantity, *cable))
        .collect();
    let abscissa = Abscissa::of(fit, effect, &groups);
    let is_seen = |cable: Option<usize>| {
        let mut known = cables.iter();
        known.any(|(other, _, largest)| *other == cable && *largest >= LEAST_SEEN)
    };
    let points = |is_own: &dyn Fn(&Residual) -> bool| -> Vec<Point> {
        let own = own.iter().filter(|one| is_own(one));
        own.filter_map(|one| abscissa.point(one)).collect()
    };
    let mut series = Vec::new();
    let rest = points(&|one| one.cable.is_some() && !is_seen(one.cable));
    if !rest.is_empty() {
        series.push(Series::new(
            "other cables",
            Ink::Muted,
            Marker::Circle,
            rest,
        ));
    }
    let mut shown: Vec<Option<usize>> = cables.iter().map(|(cable, ..)| *cable).collect();
    shown.sort_unstable();
    for cable in shown {
        match cable {
            Some(index) if is_seen(cable) => {
                let name = fit.dataset.robot.cables[index].name.as_str();
                series.push(Series::of_cable(
                    index,
                    name,
                    points(&|one| one.cable == cable),
                ));
            }
            Some(_) => {}
            None => series.push(Series::new(
                quantity.name(),
                Ink::Accent,
                Marker::Circle,
                points(&|one| one.cable.is_none()),
            )),
        }
    }
    Image {
        name: named(quantity, None),
        figure: abscissa.figure(series),
    }
}

/// The readings in words: `Length readings of cable-3`.
pub(super) fn named(quantity: Quantity, cable: Option<&str>) -> String {
    let name = readings(quantity, cable);
    sentence(name.strip_prefix("the ").unwrap_or(&name))
}
