//! Residuals of positions measured by an external instrument, over poses and for each axis.

use tautline_core::estimation::ObservationKind;
use tautline_workflow::plot::figure::{Ink, Marker};

use super::residuals::{choose_unit, of_kinds};
use crate::views::plots::kind::{Content, PlotKind};

pub(crate) static PLOT: PlotKind = PlotKind {
    id: "external",
    title: "Tracker",
    missing: |open| {
        let fit = open.fit();
        let has_any =
            fit.is_some_and(|fit| !fit.dataset.measurements.tracked_position_m.is_empty());
        (!has_any).then_some("Residuals of a tracker or camera appear here after an identification with its positions.")
    },
    options: choose_unit,
    content: Content::Figure(|source| {
        let axis = ObservationKind::TrackerPosition;
        let series = [
            ("x", Ink::Accent, Marker::Circle, axis(0)),
            ("y", Ink::Warning, Marker::Square, axis(1)),
            ("z", Ink::Good, Marker::Triangle, axis(2)),
        ];
        of_kinds(source, &series)
    }),
};
