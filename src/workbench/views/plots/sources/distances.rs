//! Residuals of distances over poses: of the laser, and between two poses.

use tautline_core::estimation::ObservationKind;
use tautline_workflow::plot::figure::{Ink, Marker};

use super::residuals::{choose_unit, of_kinds};
use crate::views::plots::kind::{Content, PlotKind};

pub(crate) static PLOT: PlotKind = PlotKind {
    id: "laser",
    title: "Distances",
    missing: |open| {
        let has_any = open.fit().is_some_and(|fit| {
            let data = &fit.dataset.measurements;
            let has_laser = fit.dataset.robot.laser.is_some() && !data.laser_m.is_empty();
            has_laser || !data.distances.is_empty()
        });
        (!has_any).then_some(
            "Residuals of distances appear here after an identification with a laser, or with distances between poses.",
        )
    },
    options: choose_unit,
    content: Content::Figure(|source| {
        let data = &source.fit()?.dataset.measurements;
        let mut series = Vec::new();
        if !data.laser_m.is_empty() {
            series.push(("laser", Ink::Accent, Marker::Circle, ObservationKind::Laser));
        }
        let between = (0..data.distances.len()).map(ObservationKind::Distance);
        series.extend(between.map(|kind| ("between poses", Ink::Good, Marker::Square, kind)));
        let mut figure = of_kinds(source, &series)?;
        // The legend names distances between poses once.
        let between = figure.series.iter_mut().filter(|one| one.ink == Ink::Good);
        between.skip(1).for_each(|one| one.short.clear());
        Ok(figure)
    }),
};
