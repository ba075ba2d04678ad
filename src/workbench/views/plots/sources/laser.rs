//! Residuals of the laser over poses.

use tautline_core::estimation::ObservationKind;
use tautline_workflow::plot::figure::{Ink, Marker};

use super::residuals::{choose_unit, of_kinds};
use crate::views::plots::kind::{Content, PlotKind};

pub(crate) static PLOT: PlotKind = PlotKind {
    id: "laser",
    title: "Laser",
    missing: |open| {
        let has_laser = open.fit().is_some_and(|fit| {
            let data = &fit.dataset;
            data.robot.laser.is_some() && !data.measurements.laser_m.is_empty()
        });
        (!has_laser).then_some(
            "Residuals of the laser appear here after an identification with laser distances.",
        )
    },
    options: choose_unit,
    content: Content::Figure(|source| {
        let series = [("laser", Ink::Accent, Marker::Circle, ObservationKind::Laser)];
        of_kinds(source, &series)
    }),
};
