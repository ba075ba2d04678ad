//! Options above the plots and their widgets.

use egui::{ComboBox, Ui, vec2};
use tautline_core::diagnosis::Quantity;
use tautline_core::measurement::Variable;

use crate::model::open_session::Diagnosed;
use crate::model::plot_preparation::Prepared;
use crate::widgets::name_combo_box;

/// Unit of residuals.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum ResidualUnit {
    /// Standard deviations of the residuals.
    #[default]
    Deviations,
    Millimetres,
}

/// Plotted values of tensions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum TensionsShown {
    /// Measured by the force sensors.
    #[default]
    Measured,
    /// Predicted from all readings, minus measured.
    Residuals,
}

/// Readings plotted over time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum CourseReading {
    /// Change of each cable length since the first pose.
    #[default]
    Lengths,
    /// Tensions from the force sensors.
    Tensions,
    Laser,
    /// Position measured by an external instrument.
    Position,
}

/// Quantity and variable of a plot by variable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct VariableChoice {
    /// Quantity of the readings.
    pub(crate) quantity: Quantity,
    /// Cable, for readings of a cable.
    pub(crate) cable: Option<usize>,
    /// Variable of the horizontal axis.
    pub(crate) variable: Variable,
}

impl VariableChoice {
    /// Strongest dependence found, otherwise the length of the first cable.
    pub(crate) fn first(prepared: &Prepared, diagnosed: Option<&Diagnosed>) -> Option<Self> {
        let found = diagnosed.and_then(|found| found.diagnosis.discrepancies.first());
        let strongest = found.map(|d| Self {
            quantity: d.quantity,
            cable: d.cable,
            variable: d.variable,
        });
        let known = |choice: &Self| choice.values(prepared).is_some();
        strongest.filter(known).or_else(|| {
            let along = prepared.along.first()?;
            Some(Self {
                quantity: along.quantity,
                cable: along.cable,
                variable: along.variables.first()?.0,
            })
        })
    }

    /// Whether a diagnosis found a dependence of this quantity on this variable.
    pub(super) fn is_dependence(self, diagnosed: &Diagnosed) -> bool {
        let mut found = diagnosed.diagnosis.discrepancies.iter();
        found.any(|d| {
            (d.quantity, d.cable, d.variable) == (self.quantity, self.cable, self.variable)
        })
    }

    /// Values of the variable by row, if known.
    pub(crate) fn values(self, prepared: &Prepared) -> Option<&[f64]> {
        let mut along = prepared.along.iter();
        let group = along.find(|a| (a.quantity, a.cable) == (self.quantity, self.cable))?;
        let mut variables = group.variables.iter();
        let (_, values) = variables.find(|(variable, _)| *variable == self.variable)?;
        Some(values)
    }
}

/// Choice from several options, side by side or as a menu in a narrow plot.
pub(super) fn choose<T: Copy + PartialEq>(
    ui: &mut Ui,
    name: &str,
    is_narrow: bool,
    all: &[(T, &str)],
    chosen: &mut T,
) {
    let add = |ui: &mut Ui, chosen: &mut T| {
        for (value, title) in all {
            ui.selectable_value(chosen, *value, *title);
        }
    };
    if !is_narrow {
        add(ui, chosen);
        return;
    }
    let selected = all.iter().find(|(value, _)| value == chosen);
    let selected = selected.map_or("", |(_, title)| title);
    combo(ui, name, selected, |ui| add(ui, chosen));
}

pub(super) fn combo(ui: &mut Ui, name: &str, selected: &str, add: impl FnOnce(&mut Ui)) {
    combo_within(ui, name, None, selected, add);
}

/// Menu of its natural or a given width, clipped to the available space.
pub(super) fn combo_within(
    ui: &mut Ui,
    name: &str,
    width: Option<f32>,
    selected: &str,
    add: impl FnOnce(&mut Ui),
) {
    let shown = ComboBox::from_id_salt(name).selected_text(selected);
    let shown = match width {
        // The text is clipped to the space, whatever the requested width.
        Some(width) => {
            let size = vec2(width, ui.spacing().interact_size.y);
            let shown = shown.width(width).truncate();
            ui.allocate_ui(size, |ui| shown.show_ui(ui, add)).inner
        }
        None => shown.show_ui(ui, add),
    };
    name_combo_box(&shown.response, &format!("{name}: {selected}"));
}
