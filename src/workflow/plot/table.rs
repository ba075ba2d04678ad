//! The values of a figure as a table (CSV).

use tautline_session::csv_row;

use super::figure::{Figure, HeatMap, Point};

/// All values in the view, including those that share a pixel: one row per point, point of a curve, bin or cell.
#[must_use]
pub fn csv(figure: &Figure, view: [[f64; 2]; 2]) -> String {
    let is_seen = |x: f64, y: f64| {
        let [wide, high] = view;
        (wide[0]..=wide[1]).contains(&x) && (high[0]..=high[1]).contains(&y)
    };
    if let Some(heat) = &figure.heat {
        return cells(figure, heat, &is_seen);
    }
    let mut table = csv_row(&[
        "name",
        "pose",
        &figure.x.title(),
        &figure.y.title(),
        "standard deviation along x",
        "standard deviation along y",
        "excluded",
    ]);
    for (name, point) in values(figure) {
        if !is_seen(point.x, point.y) {
            continue;
        }
        let pose = point.pose.map_or_else(String::new, |pose| pose.to_string());
        let [sd_x, sd_y] = point.sd.map(|sd| match sd > 0.0 {
            true => sd.to_string(),
            false => String::new(),
        });
        let excluded = if point.excluded { "yes" } else { "" };
        let x = figure.x.number(point.x).to_string();
        let y = figure.y.number(point.y).to_string();
        table += &csv_row(&[name, &pose, &x, &y, &sd_x, &sd_y, excluded]);
    }
    table
}

/// Points, points of named curves, and centres of bins, each with the name of its set.
fn values(figure: &Figure) -> Vec<(&str, Point)> {
    let mut values = Vec::new();
    for series in &figure.series {
        let points = series.points().iter();
        values.extend(points.map(|point| (series.name.as_str(), *point)));
    }
    for curve in figure.curves.iter().filter(|curve| !curve.name.is_empty()) {
        let places = curve.points.iter();
        values.extend(places.map(|[x, y]| (curve.name.as_str(), Point::new(*x, *y))));
    }
    for columns in &figure.columns {
        for (edges, height) in columns.edges.windows(2).zip(&columns.heights) {
            let middle = Point::new(0.5 * (edges[0] + edges[1]), *height);
            values.push((columns.name.as_str(), middle));
        }
    }
    values
}

fn cells(figure: &Figure, heat: &HeatMap, is_seen: &dyn Fn(f64, f64) -> bool) -> String {
    let mut table = csv_row(&[&figure.x.title(), &figure.y.title(), &heat.axis.title()]);
    let columns = heat.x.len().saturating_sub(1).max(1);
    let [names_x, names_y] = &heat.names;
    for (index, value) in heat.values.iter().enumerate() {
        let (r, c) = (index / columns, index % columns);
        let (Some(x), Some(y)) = (heat.x.get(c..c + 2), heat.y.get(r..r + 2)) else {
            continue;
        };
        let (x, y) = (0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1]));
        if is_seen(x, y) {
            let name = |names: &[String], k: usize, at: f64| {
                names.get(k).cloned().unwrap_or_else(|| at.to_string())
            };
            table += &csv_row(&[
                &name(names_x, c, x),
                &name(names_y, r, y),
                &value.to_string(),
            ]);
        }
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::figure::{Axis, Series};

    #[test]
    fn the_table_has_what_is_in_the_view() {
        let points = (0..5).map(|k| Point {
            pose: Some(k),
            excluded: k == 2,
            ..Point::new(k as f64, 0.5)
        });
        let figure = Figure {
            x: Axis::new("Pose", ""),
            y: Axis::new("Residual, length", "mm"),
            series: vec![Series::of_cable(0, "cable-1", points.collect())],
            ..Figure::default()
        };
        let table = csv(&figure, [[0.5, 2.5], [0.0, 1.0]]);
        let lines: Vec<&str> = table.lines().collect();
        assert_eq!(lines.len(), 3);
        assert!(lines[0].contains("\"Residual, length (mm)\""));
        assert_eq!(lines[1], "cable-1,1,1,0.5,,,");
        assert_eq!(lines[2], "cable-1,2,2,0.5,,,yes");
    }
    #[test]
    fn names_are_no_formulas_and_numbers_stay_numbers() {
        let points = vec![Point {
            pose: Some(1),
            ..Point::new(1.0, -1.5)
        }];
        let figure = Figure {
            series: vec![Series::of_cable(0, "=cable", points)],
            ..Figure::default()
        };
        let table = csv(&figure, [[0.0, 2.0], [-2.0, 1.0]]);
        assert_eq!(table.lines().nth(1), Some("'=cable,1,1,-1.5,,,"));
    }
}
