//! A picture of residuals: the readings of one kind over a variable.

use std::collections::BTreeMap;

use tautline_core::diagnosis::{Quantity, Variables};
use tautline_core::effect::{BoundEffect, Effect};
use tautline_core::estimation::Linearisation;
use tautline_core::measurement::Variable;

use crate::diagnosis::dependences::display_unit;
use crate::identification::{Identification, RESIDUAL, all_readings, group_of};
use crate::plot::figure::{Axis, Band, Figure, Ink, Marker, Point, Series};
use crate::wording::{readings, sentence};

/// Most pictures of one effect.
pub(super) const MOST_IMAGES: usize = 3;
/// Residual, in standard deviations, below which nothing is visible in a picture.
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

/// The residuals of all readings with redundancy.
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

/// Index of a kind of reading in the order of all kinds.
pub(super) fn order(quantity: Quantity) -> usize {
    let mut all = Quantity::ALL.into_iter();
    all.position(|other| other == quantity).unwrap_or_default()
}

/// Abscissa of the readings: the variable on which an effect depends, or the poses.
pub(super) struct Abscissa<'a> {
    fit: &'a Identification,
    variable: Option<Variable>,
    values: BTreeMap<(usize, Option<usize>), Vec<f64>>,
}

impl<'a> Abscissa<'a> {
    /// The abscissa of an effect for the readings of some groups: its own variable if all of them have it.
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

/// The residuals of one kind of reading. The cables of the effect have their colours, or the one on which it shows most if it
/// is on all of them; the others, to which an identification spreads it, have one colour.
pub(super) fn image_of(
    fit: &Identification,
    bound: &BoundEffect,
    (quantity, residuals): (Quantity, &[Residual]),
) -> Image {
    let own: Vec<Residual> = (residuals.iter().copied())
        .filter(|one| one.quantity == quantity)
        .collect();
    let cables = strengths(&own, |one| one.cable);
    let groups: Vec<Group> = (cables.iter())
        .map(|(cable, ..)| (quantity, *cable))
        .collect();
    let abscissa = Abscissa::of(fit, bound.effect, &groups);
    let strongest = cables.first().and_then(|(cable, ..)| *cable);
    let mut coloured: Vec<usize> = match bound.targeted {
        true => bound.cables.clone(),
        false => strongest.into_iter().collect(),
    };
    coloured.sort_unstable();
    let points = |is_own: &dyn Fn(Option<usize>) -> bool| -> Vec<Point> {
        let own = own.iter().filter(|one| is_own(one.cable));
        own.filter_map(|one| abscissa.point(one)).collect()
    };
    let is_other = |cable: Option<usize>| cable.is_some_and(|index| !coloured.contains(&index));
    let mut series = vec![
        Series::new(
            "other cables",
            Ink::Muted,
            Marker::Circle,
            points(&is_other),
        ),
        Series::new(
            quantity.name(),
            Ink::Accent,
            Marker::Circle,
            points(&|cable| cable.is_none()),
        ),
    ];
    for index in &coloured {
        let name = fit.dataset.robot.cables[*index].name.as_str();
        let own = points(&|cable| cable == Some(*index));
        series.push(Series::of_cable(*index, name, own));
    }
    series.retain(|one| !one.points().is_empty());
    Image {
        name: named(quantity, None),
        figure: Figure {
            y: Axis::new("Standard deviations", ""),
            ..abscissa.figure(series)
        },
    }
}

/// The readings in words: `Length readings of cable-3`.
pub(super) fn named(quantity: Quantity, cable: Option<&str>) -> String {
    let name = readings(quantity, cable);
    sentence(name.strip_prefix("the ").unwrap_or(&name))
}
