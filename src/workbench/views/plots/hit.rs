//! Point under the pointer, and its tooltip.

use egui::Pos2;

use tautline_workflow::plot::figure::{Axis, Figure};
use tautline_workflow::plot::limits;
use tautline_workflow::plot::scale::{Scale, readable};

use super::sources::POSE;
use crate::model::Selection;

/// Largest distance at which a point is hit (points of the screen).
const REACH: f32 = 9.0;

/// Point of a series.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Hit {
    /// Index of the series.
    pub(crate) series: usize,
    /// Index of the point in the series.
    pub(crate) point: usize,
}

/// Point nearest to a position, even if covered by others; among equally near points, that of the selected cable.
/// Points are sorted by x, so that only those within reach are examined.
pub(crate) fn nearest(
    figure: &Figure,
    scale: &Scale,
    place: Pos2,
    selection: Selection,
) -> Option<Hit> {
    let mut best: Option<(f32, Hit)> = None;
    let [from, to] =
        [place.x - REACH, place.x + REACH].map(|x| scale.values(Pos2::new(x, place.y))[0]);
    let [from, to] = [from.max(scale.view[0][0]), to.min(scale.view[0][1])];
    for (s, series) in figure.series.iter().enumerate() {
        let is_selected = series.cable.is_some() && series.cable == selection.cable;
        let points = series.points();
        let first = points.partition_point(|point| point.x < from);
        let near = points.iter().enumerate().skip(first);
        for (index, point) in near.take_while(|(_, point)| point.x <= to) {
            let away = scale.place(point.x, point.y).distance(place);
            let rank = if is_selected { away - 2.0 } else { away };
            if away <= REACH && best.is_none_or(|(least, _)| rank < least) {
                let hit = Hit {
                    series: s,
                    point: index,
                };
                best = Some((rank, hit));
            }
        }
    }
    best.map(|(_, hit)| hit)
}

/// Cable and pose of a point.
pub(crate) fn selects(figure: &Figure, hit: Hit) -> Selection {
    let series = &figure.series[hit.series];
    Selection {
        cable: series.cable,
        pose: series.points()[hit.point].pose,
    }
}

/// Tooltip of a point.
pub(crate) fn words(figure: &Figure, hit: Hit, scale: &Scale) -> String {
    let series = &figure.series[hit.series];
    let point = series.points()[hit.point];
    let mut lines = vec![series.name.clone()];
    if let Some(pose) = point.pose {
        let excluded = if point.excluded { ", excluded" } else { "" };
        lines.push(format!("Pose {pose}{excluded}"));
    }
    let is_pose = figure.x.label == POSE && point.pose.is_some();
    lines.push(line(&figure.y, point.y, point.sd[1], scale.view[1]));
    if !is_pose {
        lines.push(line(&figure.x, point.x, point.sd[0], scale.view[0]));
    }
    lines.retain(|line| !line.is_empty());
    lines.join("\n")
}

fn line(axis: &Axis, value: f64, sd: f64, view: [f64; 2]) -> String {
    let sd = if sd > 0.0 {
        format!(" \u{b1} {}", readable(sd, view))
    } else {
        String::new()
    };
    let number = match axis.is_whole {
        true => format!("{value:.0}"),
        false => readable(axis.number(value), view),
    };
    let text = format!("{}: {number}{sd} {}", axis.label, axis.unit);
    text.trim_end().to_owned()
}

/// Tooltip of a cell of a heat map.
pub(crate) fn cell_words(figure: &Figure, [x, y]: [f64; 2]) -> Option<String> {
    let heat = figure.heat.as_ref()?;
    let (column, row, value) = heat.cell(x, y)?;
    let limits = limits(heat.shades);
    let shown = line(&heat.axis, value, 0.0, limits);
    let [columns, rows] = &heat.names;
    Some(match (columns.get(column), rows.get(row)) {
        (Some(a), Some(b)) => format!("{b}\n{a}\n{shown}"),
        _ => {
            let [wide, high] = [&heat.x, &heat.y].map(|e| [e[0], e[e.len() - 1]]);
            let (x, y) = (line(&figure.x, x, 0.0, wide), line(&figure.y, y, 0.0, high));
            format!("{shown}\n{x}\n{y}")
        }
    })
}

#[cfg(test)]
mod tests {
    use egui::Rect;

    use super::*;
    use tautline_workflow::plot::figure::{Point, Series};
    use tautline_workflow::plot::thin::thin;

    #[test]
    fn a_point_that_is_not_drawn_is_found_all_the_same() {
        let rect = Rect::from_min_max(Pos2::ZERO, Pos2::new(200.0, 100.0));
        let view = [[0.0, 1e5], [-5.0, 5.0]];
        let scale = Scale { view, rect };
        // 500 points per column of pixels, one of them apart from the minimum and maximum.
        let point = |k: i32| Point {
            pose: Some(i64::from(k)),
            ..Point::new(f64::from(k), if k % 2 == 0 { 4.0 } else { -4.0 })
        };
        let mut points: Vec<Point> = (0..100_000).map(point).collect();
        points[43_210].y = 0.1;
        let figure = Figure {
            series: vec![Series::of_cable(0, "cable-1", points)],
            ..Figure::default()
        };
        let selection = Selection::default();
        let seen = thin(&figure.series[0], &scale, 1.0);
        assert!(!seen.points.contains(&43_210), "it is covered");
        let place = scale.place(43_210.0, 0.1);
        let hit = nearest(&figure, &scale, place, selection).expect("a point");
        assert_eq!(selects(&figure, hit).pose, Some(43_210));
        let aside = Pos2::new(place.x, place.y + 2.0 * REACH);
        assert_eq!(nearest(&figure, &scale, aside, selection), None);
    }
}
