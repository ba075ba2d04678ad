//! A plot as data, for screen and files, independent of theme, zoom and selection.

use ecolor::Color32;

use super::colours::Colours;
use crate::wording::cable_label;

/// A colour by its role, which [`Colours`] define.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Ink {
    /// Colour of the cable with this index.
    Cable(usize),
    /// The selection, or the next step.
    Accent,
    /// Text.
    Text,
    /// Secondary elements.
    Muted,
    /// Within limits.
    Good,
    /// Doubtful.
    Warning,
}

impl Ink {
    /// The colour in a theme.
    #[must_use]
    pub fn colour(self, colours: &Colours) -> Color32 {
        match self {
            Self::Cable(index) => colours.cable(index),
            Self::Accent => colours.accent,
            Self::Text => colours.text,
            Self::Muted => colours.muted,
            Self::Good => colours.good,
            Self::Warning => colours.warning,
        }
    }
}

/// Marker of a point, so that colour is not the only distinction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marker {
    /// A disc.
    Circle,
    /// A square.
    Square,
    /// Upright triangle.
    Triangle,
    /// A square standing on its corner.
    Diamond,
    /// Inverted triangle.
    Wedge,
    /// Upright cross.
    Plus,
    /// Diagonal cross.
    Cross,
    /// A regular pentagon.
    Pentagon,
}

impl Marker {
    const ALL: [Self; 8] = [
        Self::Circle,
        Self::Square,
        Self::Triangle,
        Self::Diamond,
        Self::Wedge,
        Self::Plus,
        Self::Cross,
        Self::Pentagon,
    ];

    /// Marker of a cable by its index; markers repeat from the ninth cable on, numbers do not.
    #[must_use]
    pub fn cable(index: usize) -> Self {
        Self::ALL[index % Self::ALL.len()]
    }
}

/// An axis with its unit.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Axis {
    /// Quantity on the axis.
    pub label: String,
    /// Unit; empty if there is none.
    pub unit: &'static str,
    /// Whether values are logarithms to base 10; tick labels show the numbers themselves.
    pub is_logarithmic: bool,
    /// Whether values are integers, such as labels of poses.
    pub is_whole: bool,
    /// Names at positions along the axis, in place of numbers.
    pub names: Vec<(f64, String)>,
}

impl Axis {
    /// An axis with numbers.
    #[must_use]
    pub fn new(label: impl Into<String>, unit: &'static str) -> Self {
        Self {
            label: label.into(),
            unit,
            ..Self::default()
        }
    }

    /// An axis with integers, without unit.
    #[must_use]
    pub fn whole(label: impl Into<String>) -> Self {
        Self {
            is_whole: true,
            ..Self::new(label, "")
        }
    }

    /// An axis with logarithms to base 10.
    #[must_use]
    pub fn logarithmic(label: impl Into<String>, unit: &'static str) -> Self {
        Self {
            is_logarithmic: true,
            ..Self::new(label, unit)
        }
    }

    /// The number that a value on the axis represents.
    #[must_use]
    pub fn number(&self, value: f64) -> f64 {
        if self.is_logarithmic {
            10_f64.powf(value)
        } else {
            value
        }
    }

    /// Label with unit, as displayed.
    #[must_use]
    pub fn title(&self) -> String {
        if self.unit.is_empty() {
            self.label.clone()
        } else {
            format!("{} ({})", self.label, self.unit)
        }
    }
}

/// A measured point.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Point {
    /// Value along x.
    pub x: f64,
    /// Value along y.
    pub y: f64,
    /// Standard deviations along x and y; 0 draws no bar.
    pub sd: [f64; 2],
    /// Label of its pose.
    pub pose: Option<i64>,
    /// Whether the point is shown but not used.
    pub excluded: bool,
}

impl Point {
    /// A point without error bars.
    #[must_use]
    pub fn new(x: f64, y: f64) -> Self {
        Self {
            x,
            y,
            ..Self::default()
        }
    }
}

/// A series of points, ascending in x.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name in legend and files.
    pub name: String,
    /// Short name where space is scarce, such as the number of the cable.
    pub short: String,
    /// Cable of the points.
    pub cable: Option<usize>,
    /// Colour.
    pub ink: Ink,
    /// Marker.
    pub marker: Marker,
    /// Whether markers are hollow, as for the second of two sets.
    pub hollow: bool,
    points: Vec<Point>,
}

impl Series {
    /// A series that belongs to no cable; non-finite points are left out.
    #[must_use]
    pub fn new(name: impl Into<String>, ink: Ink, marker: Marker, mut points: Vec<Point>) -> Self {
        points.retain(|point| point.x.is_finite() && point.y.is_finite());
        points.sort_by(|a, b| a.x.total_cmp(&b.x));
        let name = name.into();
        Self {
            short: name.clone(),
            name,
            cable: None,
            ink,
            marker,
            hollow: false,
            points,
        }
    }

    /// A series of a cable, in its colour and marker, with its number.
    #[must_use]
    pub fn of_cable(index: usize, name: impl Into<String>, points: Vec<Point>) -> Self {
        let name = name.into();
        Self {
            short: cable_label(index, &name),
            cable: Some(index),
            ..Self::new(name, Ink::Cable(index), Marker::cable(index), points)
        }
    }

    /// The series with hollow markers, as the second of two sets of the same cable.
    #[must_use]
    pub fn as_rings(self) -> Self {
        Self {
            hollow: true,
            ..self
        }
    }

    /// The points, ascending in x.
    #[must_use]
    pub fn points(&self) -> &[Point] {
        &self.points
    }
}

/// A polyline.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Name in legend and files; empty for lines that need none.
    pub name: String,
    /// Colour.
    pub ink: Ink,
    /// Whether the line is dashed.
    pub dashed: bool,
    /// Points of the line in order; a non-finite point interrupts it.
    pub points: Vec<[f64; 2]>,
}

impl Curve {
    /// A solid line.
    #[must_use]
    pub fn new(name: impl Into<String>, ink: Ink, points: Vec<[f64; 2]>) -> Self {
        Self {
            name: name.into(),
            ink,
            dashed: false,
            points,
        }
    }

    /// Its pieces between interruptions.
    pub fn pieces(&self) -> impl Iterator<Item = &[[f64; 2]]> {
        let is_gap = |[x, y]: &[f64; 2]| !(x.is_finite() && y.is_finite());
        self.points.split(is_gap).filter(|piece| piece.len() > 1)
    }
}

/// A histogram.
#[derive(Debug, Clone, PartialEq)]
pub struct Columns {
    /// Name in legend and files.
    pub name: String,
    /// Colour.
    pub ink: Ink,
    /// Whether only the outline is drawn, as for the second of two histograms.
    pub outline: bool,
    /// Edges of the bins, one more than heights.
    pub edges: Vec<f64>,
    /// Height of each bin.
    pub heights: Vec<f64>,
}

/// Colour scale of a heat map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ColourScale {
    /// Diverging: symmetric about 0, saturated at this value.
    Diverging(f64),
    /// Sequential: from the smallest to the largest value.
    Rising(f64, f64),
}

/// A heat map.
#[derive(Debug, Clone, PartialEq)]
pub struct HeatMap {
    /// Edges along x, one more than columns.
    pub x: Vec<f64>,
    /// Edges along y, one more than rows.
    pub y: Vec<f64>,
    /// Values, row by row from the first edge of y.
    pub values: Vec<f64>,
    /// Colour scale.
    pub shades: ColourScale,
    /// Quantity and unit of the values.
    pub axis: Axis,
    /// Names of columns and rows for the label at the pointer, if they have names.
    pub names: [Vec<String>; 2],
    /// Cables of the rows, if rows belong to cables.
    pub cables: Vec<Option<usize>>,
}

impl HeatMap {
    /// Column, row and value of the cell at a point.
    #[must_use]
    pub fn cell(&self, x: f64, y: f64) -> Option<(usize, usize, f64)> {
        let of = |edges: &[f64], value: f64| {
            let index = edges.partition_point(|edge| *edge <= value);
            (index > 0 && index < edges.len()).then(|| index - 1)
        };
        let (column, row) = (of(&self.x, x)?, of(&self.y, y)?);
        let columns = self.x.len() - 1;
        let value = self.values.get(row * columns + column)?;
        Some((column, row, *value))
    }
}

/// A horizontal band over the whole width.
#[derive(Debug, Clone, PartialEq)]
pub struct Band {
    /// Meaning of the band.
    pub name: String,
    /// Lower and upper edge.
    pub y: [f64; 2],
}

impl Band {
    /// A band between two values.
    #[must_use]
    pub fn new(name: impl Into<String>, y: [f64; 2]) -> Self {
        let name = name.into();
        Self { name, y }
    }
}

/// A marked range of x over the whole height.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// Its ends.
    pub x: [f64; 2],
    /// Colour.
    pub ink: Ink,
}

/// A band that follows a curve, such as its interval.
#[derive(Debug, Clone, PartialEq)]
pub struct Ribbon {
    /// Name of the curve or series whose band it is: both are switched off together.
    pub of: String,
    /// Colour.
    pub ink: Ink,
    /// Places along x with the lower and the upper edge, ascending in x; a non-finite edge interrupts it.
    pub edges: Vec<[f64; 3]>,
}

impl Ribbon {
    /// Its pieces between interruptions.
    pub fn pieces(&self) -> impl Iterator<Item = &[[f64; 3]]> {
        let is_gap = |edge: &[f64; 3]| !edge.iter().all(|value| value.is_finite());
        self.edges.split(is_gap).filter(|piece| piece.len() > 1)
    }
}

/// A plot as data.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Figure {
    /// x axis.
    pub x: Axis,
    /// y axis.
    pub y: Axis,
    /// Heat map, behind everything.
    pub heat: Option<HeatMap>,
    /// Marked ranges of x, behind everything but a heat map, such as the used parts of a recording.
    pub spans: Vec<Span>,
    /// Horizontal bands, behind the points.
    pub bands: Vec<Band>,
    /// Bands of curves, behind the points.
    pub ribbons: Vec<Ribbon>,
    /// Histograms.
    pub columns: Vec<Columns>,
    /// Points.
    pub series: Vec<Series>,
    /// Curves, over the points.
    pub curves: Vec<Curve>,
    /// Whether a line marks y = 0.
    pub has_zero_line: bool,
}

impl Figure {
    /// The view that shows everything: `[x, y]` with smallest and largest value each, plus a margin.
    #[must_use]
    pub fn whole(&self) -> [[f64; 2]; 2] {
        let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        let mut include = |axis: usize, value: f64| {
            if value.is_finite() {
                range[axis][0] = range[axis][0].min(value);
                range[axis][1] = range[axis][1].max(value);
            }
        };
        for point in self.series.iter().flat_map(Series::points) {
            include(0, point.x - point.sd[0]);
            include(0, point.x + point.sd[0]);
            include(1, point.y - point.sd[1]);
            include(1, point.y + point.sd[1]);
        }
        for [x, y] in self.curves.iter().flat_map(|curve| &curve.points) {
            include(0, *x);
            include(1, *y);
        }
        for columns in &self.columns {
            columns.edges.iter().for_each(|x| include(0, *x));
            columns.heights.iter().for_each(|y| include(1, *y));
            include(1, 0.0);
        }
        for span in &self.spans {
            span.x.iter().for_each(|x| include(0, *x));
        }
        for [x, low, high] in self.ribbons.iter().flat_map(|ribbon| &ribbon.edges) {
            include(0, *x);
            include(1, *low);
            include(1, *high);
        }
        for band in &self.bands {
            band.y.iter().for_each(|y| include(1, *y));
        }
        if self.has_zero_line {
            include(1, 0.0);
        }
        if let Some(heat) = &self.heat {
            heat.x.iter().for_each(|x| include(0, *x));
            heat.y.iter().for_each(|y| include(1, *y));
            return range.map(|range| padded(range, 0.0));
        }
        [padded(range[0], 0.03), padded(range[1], 0.07)]
    }
}

/// A range extended by a fraction of its width at both ends; never empty.
fn padded([low, high]: [f64; 2], share: f64) -> [f64; 2] {
    if !(low.is_finite() && high.is_finite()) {
        return [0.0, 1.0];
    }
    let width = high - low;
    if width <= f64::EPSILON * low.abs().max(high.abs()) {
        let half = (0.05 * high.abs()).max(0.5);
        return [low - half, high + half];
    }
    [low - share * width, high + share * width]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_whole_view_shows_points_bars_and_bands() {
        let mut point = Point::new(1.0, 2.0);
        point.sd = [0.0, 3.0];
        let series = Series::new(
            "a",
            Ink::Text,
            Marker::Circle,
            vec![point, Point::new(5.0, 0.0)],
        );
        let figure = Figure {
            series: vec![series],
            bands: vec![Band::new("", [-9.0, 9.0])],
            ..Figure::default()
        };
        let [x, y] = figure.whole();
        assert!(x[0] < 1.0 && x[1] > 5.0 && x[1] < 5.5);
        assert!(y[0] < -9.0 && y[1] > 9.0 && y[1] < 11.0);
        assert_eq!(Figure::default().whole(), [[0.0, 1.0]; 2]);
    }

    #[test]
    fn points_are_sorted_and_finite() {
        let points = vec![
            Point::new(2.0, 0.0),
            Point::new(f64::NAN, 0.0),
            Point::new(1.0, 0.0),
        ];
        let series = Series::of_cable(8, "cable-9", points);
        let x: Vec<f64> = series.points().iter().map(|p| p.x).collect();
        assert_eq!(x, [1.0, 2.0]);
        assert_eq!(series.short, "9");
        assert_eq!(series.marker, Marker::Circle, "markers repeat after eight");
    }

    #[test]
    fn cells_are_found_by_place() {
        let heat = HeatMap {
            x: vec![0.0, 1.0, 2.0],
            y: vec![0.0, 1.0],
            values: vec![5.0, 7.0],
            shades: ColourScale::Diverging(1.0),
            axis: Axis::default(),
            names: Default::default(),
            cables: Vec::new(),
        };
        assert_eq!(heat.cell(1.5, 0.5), Some((1, 0, 7.0)));
        assert_eq!(heat.cell(2.0, 0.5), None);
        assert_eq!(heat.cell(0.5, -0.1), None);
    }
}
