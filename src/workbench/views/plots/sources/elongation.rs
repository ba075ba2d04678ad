//! Measured elongation over length and tension: fitted surface with contours, and measured points.

use tautline_core::cable::ElongationSurface;
use tautline_session::Session;

use crate::views::plots::choices::combo;
use crate::views::plots::kind::{Content, PlotKind};
use tautline_workflow::plot::contour::contours;
use tautline_workflow::plot::figure::{
    Axis, ColourScale, Curve, Figure, HeatMap, Ink, Marker, Point, Series,
};
use tautline_workflow::plot::scale::{fixed, ticks};

pub(crate) static PLOT: PlotKind = PlotKind {
    id: "elongation",
    title: "Elongation",
    missing: |open| {
        let is_missing = !has_any(open.session());
        is_missing
            .then_some("The elongation of the cables appears here once it is fitted in phase 2.")
    },
    options: |ui, options, input| {
        let cables = input.open.session().robot.cables.iter().enumerate();
        let with: Vec<(usize, &str)> = cables
            .filter(|(_, cable)| cable.cable.elongation_surface.is_some())
            .map(|(index, cable)| (index, cable.name.as_str()))
            .collect();
        if with.len() > 1 {
            let chosen = options.elongation.unwrap_or(with[0].0);
            let name = with.iter().find(|(k, _)| *k == chosen);
            combo(ui, "Cable", name.map_or("", |(_, name)| name), |ui| {
                for (index, name) in &with {
                    ui.selectable_value(&mut options.elongation, Some(*index), *name);
                }
            });
        }
    },
    content: Content::Figure(|source| Ok(figure(source.open.session(), source.options.elongation))),
};

/// Number of cells along each axis.
const CELLS: usize = 64;

/// Elongation surface of a cable.
fn surface(session: &Session, cable: usize) -> Option<&ElongationSurface> {
    let surface = session
        .robot
        .cables
        .get(cable)?
        .cable
        .elongation_surface
        .as_ref()?;
    surface.check().is_none().then_some(surface)
}

/// Whether there are data or a surface.
fn has_any(session: &Session) -> bool {
    let cables = 0..session.robot.cables.len();
    !session.phases.elongation.is_empty()
        || cables.into_iter().any(|c| surface(session, c).is_some())
}

/// Elongation of a cable; by default of the first one with a surface.
pub(crate) fn figure(session: &Session, cable: Option<usize>) -> Figure {
    let chosen = cable.and_then(|cable| surface(session, cable));
    let surface =
        chosen.or_else(|| (0..session.robot.cables.len()).find_map(|c| surface(session, c)));
    let measured = session.phases.elongation.iter();
    let points: Vec<Point> = measured
        .map(|row| Point::new(row.length_m, row.tension_n))
        .collect();
    let mut figure = Figure {
        x: Axis::new("Cable length", "m"),
        y: Axis::new("Tension", "N"),
        ..Figure::default()
    };
    if !points.is_empty() {
        figure.series = vec![Series::new("measured", Ink::Text, Marker::Cross, points)];
    }
    if let Some(surface) = surface {
        let heat = heat(surface);
        figure.curves = lines(&heat);
        figure.heat = Some(heat);
    }
    figure
}

fn heat(surface: &ElongationSurface) -> HeatMap {
    let edges = |center: f64, scale: f64| -> Vec<f64> {
        (0..=CELLS)
            .map(|k| center + scale * (2.0 * k as f64 / CELLS as f64 - 1.0))
            .collect()
    };
    let x = edges(surface.length_center_m, surface.length_scale_m);
    let y = edges(surface.tension_center_n, surface.tension_scale_n);
    let middle = |pair: &[f64]| 0.5 * (pair[0] + pair[1]);
    let mut values = Vec::with_capacity(CELLS * CELLS);
    for tension in y.windows(2).map(middle) {
        for length in x.windows(2).map(middle) {
            values.push(1e3 * surface.evaluate_unchecked(length, tension).elongation_m);
        }
    }
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    HeatMap {
        x,
        y,
        values,
        shades: ColourScale::Rising(least, greatest.max(least + 1e-9)),
        axis: Axis::new("Elongation", "mm"),
        names: Default::default(),
        cables: Vec::new(),
    }
}

/// Contours at round values.
fn lines(heat: &HeatMap) -> Vec<Curve> {
    let ColourScale::Rising(low, high) = heat.shades else {
        return Vec::new();
    };
    let levels = ticks(&heat.axis, [low, high], 8);
    let step = levels.get(1).map_or(1.0, |next| next.0 - levels[0].0);
    let mut curves: Vec<Curve> = levels
        .iter()
        .map(|(level, _)| Curve::new("", Ink::Muted, contours(heat, *level)))
        .collect();
    if let Some(first) = curves.first_mut() {
        first.name = format!("lines every {} mm", fixed(step, step));
    }
    curves
}
