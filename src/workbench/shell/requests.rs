//! Requests of commands to panels and views.

use super::AppState;
use crate::model::UiRequest;
use crate::model::part::ScreenPart;
use crate::screens::identification::IdentificationTab;
use crate::screens::{connect, modeling, precalibration};
use crate::views::robot_3d::drawing::CableColour;
use tautline_workflow::precalibration::Table;

/// Carries out the requests since the last call.
pub fn apply(state: &mut AppState) {
    for request in state.model.take_requests() {
        let (panels, plots) = (&mut state.panels, &mut state.views.plots);
        match request {
            UiRequest::ShowDependence(quantity, cable, variable) => {
                plots.show_along(quantity, cable, variable);
                state.views.robot_3d.options.colour = CableColour::Residual;
            }
            UiRequest::ShowTable(table) => match table {
                Table::Winch => panels.precalibration.part = precalibration::PanelPart::Winches,
                Table::Force => {
                    panels.precalibration.part = precalibration::PanelPart::ForceSensors;
                }
                Table::Home => panels.precalibration.part = precalibration::PanelPart::Home,
                Table::Elongation => panels.modeling.part = modeling::PanelPart::Elongation,
            },
            UiRequest::ShowRobot => panels.part = ScreenPart::Robot,
            UiRequest::ShowDescription => {
                panels.modeling.part = modeling::PanelPart::Description;
            }
            UiRequest::ShowScope => plots.show_scope(),
            UiRequest::ShowGeometry => {
                plots.leave_scope();
                panels.identification.tab = IdentificationTab::Geometry;
            }
            UiRequest::ShowDoctor => {
                plots.leave_scope();
                panels.identification.tab = IdentificationTab::Doctor;
            }
            UiRequest::TakePreparation(preparation) => plots.prepared(&preparation),
            UiRequest::Connection(request) => {
                connect::apply(&mut panels.connect, request, &state.model);
            }
        }
    }
}
