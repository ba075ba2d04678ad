//! Pictures of a study.

use ecolor::Color32;
use tautline_workflow::plot::draw::drawing;
use tautline_workflow::plot::figure::{Axis, Curve, Figure, Ink, Marker, Point, Series};
use tautline_workflow::plot::{Colours, Drawing};
use tautline_workflow::report::PLOT;

use super::group::{Group, laser_name};
use crate::result::CellResult;

/// Size of a plot (pt): two stand side by side.
const SIZE: [f64; 2] = [236.0, 170.0];
/// Scale that makes the labels of a plot 7 pt high.
const SCALE: f64 = 0.61;
/// Horizontal offset between the simulated points of neighbouring curves, as a fraction of the axis.
const APART: f64 = 0.012;
/// Maximum number of curves in a plot.
const CURVES: usize = 8;

/// Colours that are distinguishable with colour blindness (Okabe and Ito, Color Universal Design, 2008).
const COLOURS: Colours = Colours {
    cables: [
        Color32::from_rgb(0x00, 0x72, 0xb2),
        Color32::from_rgb(0xd5, 0x5e, 0x00),
        Color32::from_rgb(0x00, 0x9e, 0x73),
        Color32::from_rgb(0xcc, 0x79, 0xa7),
        Color32::from_rgb(0xe6, 0x9f, 0x00),
        Color32::from_rgb(0x56, 0xb4, 0xe9),
        Color32::from_rgb(0x5b, 0x64, 0x70),
        Color32::from_rgb(0x1f, 0x24, 0x2b),
    ],
    ..PLOT
};

const ERROR: &str = "Position error";

fn logarithmic(label: &str, unit: &'static str) -> Axis {
    Axis {
        is_logarithmic: true,
        ..Axis::new(label, unit)
    }
}

fn draw(label: String, figure: &Figure) -> Option<Drawing> {
    let has_lines = figure.curves.iter().any(|curve| curve.points.len() > 1);
    (has_lines || figure.series.len() > 1).then(|| drawing(label, figure, SIZE, SCALE, &COLOURS))
}

/// One theoretical curve per name, with points and ranges from simulation.
fn figure<'a>(
    x: Axis,
    lines: impl Iterator<Item = (String, Vec<&'a CellResult>)>,
    at: impl Fn(&CellResult) -> Option<f64>,
) -> Figure {
    let mut figure = Figure {
        x,
        y: logarithmic(ERROR, "mm"),
        ..Figure::default()
    };
    let log_mm = |metres: f64| (1e3 * metres).log10();
    let lines: Vec<_> = lines.take(CURVES).collect();
    let places = lines
        .iter()
        .flat_map(|(_, cells)| cells)
        .filter_map(|cell| at(cell));
    let ends = places.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
        [low.min(x), high.max(x)]
    });
    let middle = 0.5 * (lines.len() as f64 - 1.0);
    for (index, (name, cells)) in lines.into_iter().enumerate() {
        // Ranges of several curves at one abscissa are drawn side by side.
        let aside = APART * (ends[1] - ends[0]).max(0.0) * (index as f64 - middle);
        let ink = Ink::Cable(index);
        let place =
            |cell: &CellResult| Some([at(cell)?, log_mm(cell.planned.expected.position_m?)]);
        let line: Vec<[f64; 2]> = cells.iter().filter_map(|cell| place(cell)).collect();
        figure.curves.push(Curve {
            name,
            ink,
            dashed: false,
            points: line,
        });
        let mut points = Vec::new();
        for cell in &cells {
            let Some((x, position)) =
                at(cell).zip(cell.simulated.as_ref().and_then(|found| found.position))
            else {
                continue;
            };
            let x = x + aside;
            points.push(Point::new(x, log_mm(position.rms_m)));
            let [low, _, high] = position.quantiles_m.map(log_mm);
            let range = Curve {
                name: String::new(),
                ink,
                dashed: true,
                points: vec![[x, low], [x, high]],
            };
            figure.curves.push(range);
        }
        if !points.is_empty() {
            figure
                .series
                .push(Series::new("", ink, Marker::cable(index), points));
        }
    }
    figure
}

/// Accuracy over the standard deviation of the laser, one curve per number of poses.
pub fn over_laser(group: &Group<'_>) -> Option<Drawing> {
    let lines = group
        .poses()
        .into_iter()
        .map(|poses| (format!("{poses} poses"), group.over_laser(poses)));
    let figure = figure(logarithmic("Laser, 1 sd", "mm"), lines, |cell| {
        cell.planned.laser_sd_m.map(|sd| (1e3 * sd).log10())
    });
    draw(format!("{}: accuracy over the laser", group.title), &figure)
}

/// Accuracy over the number of poses, one curve per laser.
pub fn over_poses(group: &Group<'_>) -> Option<Drawing> {
    let lines = group
        .lasers()
        .into_iter()
        .map(|laser| (laser_name(laser).to_owned(), group.over_poses(laser)));
    let figure = figure(logarithmic("Poses", ""), lines, |cell| {
        Some((cell.planned.combination.poses as f64).log10())
    });
    draw(
        format!("{}: accuracy over the number of poses", group.title),
        &figure,
    )
}

/// Accuracy over the size of the frame for the largest number of poses, one curve per laser.
pub fn over_size<'a>(groups: &[Group<'a>]) -> Option<Drawing> {
    let first = groups.iter().find(|group| group.size_m.is_some())?;
    let poses = *first.poses().last()?;
    let lines = first.lasers().into_iter().map(|laser| {
        let of = |group: &Group<'a>| {
            let mut cells = group.over_poses(laser);
            cells.retain(|cell| cell.planned.combination.poses == poses);
            cells
        };
        let mut cells: Vec<&'a CellResult> = groups.iter().flat_map(of).collect();
        let size = |cell: &&CellResult| cell.planned.combination.size_m.unwrap_or(0.0);
        cells.sort_by(|a, b| size(a).total_cmp(&size(b)));
        (laser_name(laser).to_owned(), cells)
    });
    let figure = figure(logarithmic("Size of the frame", "m"), lines, |cell| {
        cell.planned.combination.size_m.map(f64::log10)
    });
    draw(format!("Accuracy over the size, {poses} poses"), &figure)
}

/// Accuracy over the price of the sensor, one curve per number of poses.
pub fn over_cost(group: &Group<'_>) -> Option<Drawing> {
    let lines = group.poses().into_iter().map(|poses| {
        let mut cells = group.over_laser(poses);
        cells.retain(|cell| cell.planned.cost.is_some());
        cells.sort_by(|a, b| {
            a.planned
                .cost
                .unwrap_or(0.0)
                .total_cmp(&b.planned.cost.unwrap_or(0.0))
        });
        (format!("{poses} poses"), cells)
    });
    let figure = figure(Axis::new("Price of the sensor", ""), lines, |cell| {
        cell.planned.cost
    });
    draw(format!("{}: accuracy over the price", group.title), &figure)
}

/// Fraction of faults that the global test detects over the standard deviation of the laser.
pub fn detection(group: &Group<'_>) -> Option<Drawing> {
    let mut figure = Figure {
        x: logarithmic("Laser, 1 sd", "mm"),
        y: Axis::new("Faults detected", "%"),
        ..Figure::default()
    };
    for (index, poses) in group.poses().into_iter().take(CURVES).enumerate() {
        let place = |cell: &&CellResult| {
            let share = cell.simulated.as_ref()?.with_fault;
            let sd = cell.planned.laser_sd_m?;
            (share.of > 0).then(|| {
                [
                    (1e3 * sd).log10(),
                    100.0 * share.count as f64 / share.of as f64,
                ]
            })
        };
        let points: Vec<[f64; 2]> = group.over_laser(poses).iter().filter_map(place).collect();
        let ink = Ink::Cable(index);
        let marks = points.iter().map(|[x, y]| Point::new(*x, *y)).collect();
        figure
            .series
            .push(Series::new("", ink, Marker::cable(index), marks));
        figure.curves.push(Curve {
            name: format!("{poses} poses"),
            ink,
            dashed: false,
            points,
        });
    }
    draw(format!("{}: faults detected", group.title), &figure)
}
