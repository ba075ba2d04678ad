//! Range of the measured elongation that cables use.

use super::Evaluator;
use super::cable_rows::{CableInputs, CableState};
use crate::cable::ElongationSurface;

impl Evaluator<'_, f64> {
    /// Elongation surface of a cable and its length from drum to anchor (m) at the first packed pose.
    pub fn span_on_surface(&self, cable: usize) -> Option<(&ElongationSurface, f64)> {
        let pose = self.pose_packet(0);
        let inputs = CableInputs {
            entry: self.entry[cable],
            home_length: 0.0,
            ports: self
                .ports
                .store
                .load_cable(&self.ports.cables[cable].ports, 0),
            swivel: f64::NAN,
            tension_error: 0.0,
        };
        let constants = &self.constants[cable];
        let surface = constants.surface.as_ref()?;
        let state = CableState::new(constants, &inputs, &pose, self.down);
        Some((surface, constants.run + state.path_length()))
    }
}
