//! Readings over time, as they were recorded.

use std::collections::BTreeSet;

use tautline_core::measurement::Measurements;
use tautline_core::robot::Cable;
use tautline_session::Session;
use tautline_workflow::plot::figure::{Axis, Figure, Ink, Marker, Point, Series};

use super::TIME;
use crate::views::plots::choices::{CourseReading, choose};
use crate::views::plots::kind::{Content, PlotKind};

pub(crate) static PLOT: PlotKind = PlotKind {
    id: "course",
    title: "Over time",
    missing: |open| {
        let is_missing = !has_times(open.session());
        is_missing
            .then_some("Readings over time appear here once a recording in motion is imported.")
    },
    options: |ui, options, input| {
        let known = CourseReading::of(input.open.session());
        let chosen = &mut options.course;
        choose(ui, "Readings", input.is_narrow, &known, chosen);
    },
    content: Content::Figure(|source| Ok(figure(source.open.session(), source.options.course))),
};

impl CourseReading {
    const ALL: [(Self, &'static str); 4] = [
        (Self::Lengths, "Lengths"),
        (Self::Tensions, "Tensions"),
        (Self::Laser, "Laser"),
        (Self::Position, "External position"),
    ];

    /// Readings of a session, with their names.
    pub(crate) fn of(session: &Session) -> Vec<(Self, &'static str)> {
        let data = &session.measurements;
        let is_there = |(reading, _): &(Self, &str)| match reading {
            Self::Lengths => !(data.revolutions.is_empty() && data.length_m.is_empty()),
            Self::Tensions => {
                let sensors = session.robot.cables.iter();
                !data.force_n.is_empty()
                    && sensors.clone().any(|cable| cable.force_sensor.is_some())
            }
            Self::Laser => !data.laser_m.is_empty(),
            Self::Position => !data.tracked_position_m.is_empty(),
        };
        Self::ALL.into_iter().filter(is_there).collect()
    }
}

/// Interval (s) above which samples are separate poses instead of a recording.
const APART_S: f64 = 1.0;

/// Whether most samples are less than [`APART_S`] apart, and there are readings to plot.
fn has_times(session: &Session) -> bool {
    let times = &session.measurements.time_s;
    let close = times.windows(2).filter(|pair| pair[1] - pair[0] < APART_S);
    2 * close.count() > times.len() && !CourseReading::of(session).is_empty()
}

/// Readings over time; another kind if the session does not have the wanted one.
pub(crate) fn figure(session: &Session, wanted: CourseReading) -> Figure {
    let (robot, data) = (&session.robot, &session.measurements);
    let known = CourseReading::of(session);
    let is_known = known.iter().any(|(reading, _)| *reading == wanted);
    let reading = match known.first() {
        Some((first, _)) if !is_known => *first,
        _ => wanted,
    };
    let course = Course {
        data,
        excluded: session.excluded(),
    };
    let of_cables = |value: &dyn Fn(&Cable, usize, usize) -> f64| {
        let named = robot.cables.iter().enumerate();
        let series = named.map(|(index, cable)| {
            let points = course.points(|row| value(cable, index, row));
            Series::of_cable(index, &cable.name, points)
        });
        series.collect::<Vec<_>>()
    };
    let (y, series) = match reading {
        CourseReading::Lengths => {
            let change = |cable: &Cable, index: usize, row: usize| {
                length_m(data, cable, index, row) - length_m(data, cable, index, 0)
            };
            (
                Axis::new("Length since the first pose", "m"),
                of_cables(&change),
            )
        }
        CourseReading::Tensions => {
            let tension = |cable: &Cable, index: usize, row: usize| match cable.force_sensor {
                Some(sensor) => sensor.tension_n(data.force_n.get(row, index)),
                None => f64::NAN,
            };
            (Axis::new("Tension", "N"), of_cables(&tension))
        }
        CourseReading::Laser => {
            let points = course.points(|row| data.laser_m[row]);
            let series = Series::new("Laser", Ink::Accent, Marker::Circle, points);
            (Axis::new("Laser distance", "m"), vec![series])
        }
        CourseReading::Position => {
            let axes = [
                ("x", Ink::Accent, Marker::Circle),
                ("y", Ink::Good, Marker::Square),
                ("z", Ink::Warning, Marker::Triangle),
            ];
            let series = axes
                .into_iter()
                .enumerate()
                .map(|(axis, (name, ink, marker))| {
                    let points = course.points(|row| data.tracked_position_m[row][axis]);
                    Series::new(name, ink, marker, points)
                });
            (Axis::new("External position", "m"), series.collect())
        }
    };
    Figure {
        x: Axis::new(TIME, "s"),
        y,
        series,
        ..Figure::default()
    }
}

struct Course<'a> {
    data: &'a Measurements,
    excluded: &'a BTreeSet<i64>,
}

impl Course<'_> {
    /// Point for each pose, at the time since the first.
    fn points(&self, value: impl Fn(usize) -> f64) -> Vec<Point> {
        let start_s = self.data.time_s.first().copied().unwrap_or_default();
        let rows = self.data.labels.iter().zip(&self.data.time_s).enumerate();
        rows.map(|(row, (label, time_s))| Point {
            pose: Some(*label),
            excluded: self.excluded.contains(label),
            ..Point::new(time_s - start_s, value(row))
        })
        .collect()
    }
}

/// Measured length of a cable (m).
fn length_m(data: &Measurements, cable: &Cable, index: usize, row: usize) -> f64 {
    match data.revolutions.is_empty() {
        true => data.length_m.get(row, index),
        false => data.revolutions.get(row, index) * cable.winch.cable_per_revolution_m(),
    }
}
