//! The course of one part of a robot over the sessions of its record.

use tautline_core::history::{CERTAIN, RobotPart};

use super::{RobotHistory, RobotRecord, Tolerance, days_between, part_name, unit_of};
use crate::identification::entry_point_covariance;
use crate::plot::figure::{Axis, Band, Curve, Figure, Ink, Marker, Point, Ribbon, Series, Span};
use crate::wording::sentence;
use crate::wording::units::{display_unit, quantity};

/// Half the width of a 95 % interval in standard deviations.
const INTERVAL: f64 = 1.959_964;
/// Colours and markers of the coordinates.
const LOOKS: [(Ink, Marker); 3] = [
    (Ink::Accent, Marker::Circle),
    (Ink::Warning, Marker::Square),
    (Ink::Text, Marker::Triangle),
];

/// The coordinates of a part over time from all sessions together, less those of the last session, with 95 % bands; for effects
/// the parameter itself. Points are the results of each session alone for a pulley, with one standard deviation.
///
/// Ranges in which a jump happened are marked: strongly where it is certain. Lines are interrupted there. Dashed lines are
/// events, such as values that were written to the controller. For pulleys, the tolerance is shown as well.
#[must_use]
pub fn lane(record: &RobotRecord, found: &RobotHistory, part: usize) -> Figure {
    let history = &found.history;
    let (of, states) = (&history.parts[part], &history.states[part]);
    let is_pulley = matches!(of, RobotPart::Pulley(_));
    let (factor, unit) = display_unit(unit_of(of));
    let axes = &history.axes[part];
    let jumps: Vec<_> = history
        .jumps
        .iter()
        .filter(|jump| jump.part == part)
        .collect();
    let mut figure = Figure {
        x: dates(record, found),
        y: Axis {
            label: match unit {
                "" => sentence(&part_name(of, record.robot())),
                unit => format!("{} ({unit})", sentence(&part_name(of, record.robot()))),
            },
            ..Axis::default()
        },
        has_zero_line: true,
        ..Figure::default()
    };
    let count = states.first().map_or(0, |state| state.value.len());
    for k in 0..count {
        let (ink, marker) = LOOKS[axes.get(k).copied().unwrap_or_default()];
        let name = axes.get(k).map_or("", |axis| ["dx", "dy", "dz"][*axis]);
        let last = match (of, states.last()) {
            (RobotPart::Effect { .. }, _) | (_, None) => 0.0,
            (_, Some(last)) => last.value[k],
        };
        let (mut edges, mut line, mut points) = (Vec::new(), Vec::new(), Vec::new());
        for (index, (day, state)) in history.days.iter().zip(states).enumerate() {
            let value = factor * (state.value[k] - last);
            let half = INTERVAL * factor * state.covariance[(k, k)].max(0.0).sqrt();
            if jumps.iter().any(|jump| is_across(jump.between, index)) {
                edges.push([f64::NAN; 3]);
                line.push([f64::NAN; 2]);
            }
            edges.push([*day, value - half, value + half]);
            line.push([*day, value]);
            points.push(match (of, axes.get(k)) {
                (RobotPart::Pulley(cable), Some(axis)) => {
                    let fit = &record.sessions[index].identification.solution;
                    let own = fit.globals.entry_points[*cable][*axis];
                    let covariance = entry_point_covariance(fit, *cable);
                    let sd = covariance.map_or(0.0, |c| c[(*axis, *axis)].max(0.0).sqrt());
                    Point {
                        sd: [0.0, factor * sd],
                        ..Point::new(*day, factor * (own - last))
                    }
                }
                _ => Point::new(*day, value),
            });
        }
        figure.ribbons.push(Ribbon {
            of: name.to_owned(),
            ink,
            edges,
        });
        figure.curves.push(Curve {
            name: String::new(),
            ink,
            dashed: false,
            points: line,
        });
        figure.series.push(Series::new(name, ink, marker, points));
    }
    for jump in &jumps {
        figure.spans.push(Span {
            x: jump.between.map(|session| history.days[session]),
            ink: match jump.probability >= CERTAIN {
                true => Ink::Warning,
                false => Ink::Muted,
            },
        });
    }
    if let (true, Tolerance::Pulley(limit_m)) = (is_pulley, found.tolerance) {
        let edge = 1e3 * limit_m;
        let name = format!("within {}", quantity(limit_m, "m"));
        figure.bands.push(Band::new(name, [-edge, edge]));
    }
    let [_, height] = figure.whole();
    for (day, text) in events(record, found) {
        figure.curves.push(Curve {
            name: text,
            ink: Ink::Muted,
            dashed: true,
            points: height.map(|y| [day, y]).into(),
        });
    }
    figure
}

/// Days and texts of events: what the record says, and adjustments of the controller.
fn events(record: &RobotRecord, found: &RobotHistory) -> Vec<(f64, String)> {
    let first = record.sessions.first().and_then(|session| session.time);
    let told = record.events.iter().filter(|_| found.is_dated);
    let told =
        told.filter_map(|event| Some((days_between(first?, event.time), event.text.clone())));
    let sessions = record.sessions.iter().zip(&found.history.days);
    let adjusted = sessions.filter(|(session, _)| session.adjusted);
    let adjusted = adjusted.map(|(_, day)| (*day, "adjusted".to_owned()));
    told.chain(adjusted).collect()
}

/// Whether a jump may have happened just before the session with this index.
fn is_across([before, after]: [usize; 2], index: usize) -> bool {
    before < index && index <= after
}

/// The axis of time with the dates of the sessions, or their names where dates are unknown.
fn dates(record: &RobotRecord, found: &RobotHistory) -> Axis {
    let sessions = record.sessions.iter().zip(&found.history.days);
    let names = sessions.map(|(session, day)| (*day, session.date_or_name()));
    Axis {
        names: names.collect(),
        ..Axis::new("Date", "")
    }
}
