//! The plots that there are.

use crate::model::OpenSession;

/// A plot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum Tab {
    /// Residuals of every cable over poses.
    #[default]
    Residuals,
    /// Residuals along a variable.
    Variable,
    /// Residuals of the laser.
    Laser,
    /// Tensions, as measured and their residuals.
    Tensions,
    /// Residuals of positions by an external instrument.
    External,
    /// Chi-square of each step.
    Convergence,
    /// Correlations of the parameters.
    Correlation,
    /// The measured elongation of the cables.
    Elongation,
    /// Residuals before and after what a diagnosis found.
    BeforeAfter,
    /// Readings over time.
    Course,
    /// A table of all readings and of all identified values.
    Statistics,
    /// What the controller reads, as it comes.
    Scope,
}

impl Tab {
    /// All, from the left.
    pub const ALL: [Self; 12] = [
        Self::Residuals,
        Self::Variable,
        Self::Laser,
        Self::Tensions,
        Self::External,
        Self::Convergence,
        Self::Correlation,
        Self::Elongation,
        Self::BeforeAfter,
        Self::Course,
        Self::Statistics,
        Self::Scope,
    ];

    /// What preferences call it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Residuals => "residuals",
            Self::Variable => "variable",
            Self::Laser => "laser",
            Self::Tensions => "tensions",
            Self::External => "external",
            Self::Course => "course",
            Self::Convergence => "convergence",
            Self::Correlation => "correlation",
            Self::Elongation => "elongation",
            Self::BeforeAfter => "before-after",
            Self::Statistics => "statistics",
            Self::Scope => "scope",
        }
    }

    /// The plot that preferences call so.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|tab| tab.name() == name)
    }

    /// Label in the window.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Residuals => "Residuals",
            Self::Variable => "By variable",
            Self::Laser => "Laser",
            Self::Tensions => "Tensions",
            Self::External => "Tracker",
            Self::Course => "Over time",
            Self::Convergence => "Convergence",
            Self::Correlation => "Correlation",
            Self::Elongation => "Elongation",
            Self::BeforeAfter => "Before and after",
            Self::Statistics => "Statistics",
            Self::Scope => "Live scope",
        }
    }

    /// Why this plot has no data, if it has none.
    #[must_use]
    pub fn missing(self, open: &OpenSession) -> Option<&'static str> {
        let fit = open.fit();
        let has_fit = fit.is_some();
        let (present, why) = match self {
            Self::Residuals => (
                has_fit,
                "Residuals of all cables appear here after identification.",
            ),
            Self::Variable => (
                has_fit || open.diagnosis().is_some(),
                "Residuals against length, tension, time and other variables appear here after identification.",
            ),
            Self::Laser => (
                fit.is_some_and(|fit| {
                    fit.dataset.robot.laser.is_some()
                        && !fit.dataset.measurements.laser_m.is_empty()
                }),
                "Residuals of the laser appear here after an identification with laser distances.",
            ),
            Self::Tensions => (
                fit.is_some_and(|fit| !fit.dataset.measurements.force_n.is_empty()),
                "Tensions appear here after an identification with force readings.",
            ),
            Self::External => (
                fit.is_some_and(|fit| !fit.dataset.measurements.tracked_position_m.is_empty()),
                "Residuals of a tracker or camera appear here after an identification with its positions.",
            ),
            Self::Course => (
                super::sources::course::has_times(open.session()),
                "Readings over time appear here once a recording in motion is imported.",
            ),
            Self::Convergence => (
                fit.is_some_and(|fit| !fit.steps.is_empty()),
                "The convergence of the identification appears here.",
            ),
            Self::Correlation => (
                fit.is_some_and(|fit| fit.solution.covariance.is_some()),
                if has_fit {
                    "The readings do not determine all parameters, so there are no correlations."
                } else {
                    "Correlations of the parameters appear here after identification."
                },
            ),
            Self::Elongation => (
                super::sources::elongation::has_any(open.session()),
                "The elongation of the cables appears here once it is fitted in phase 2.",
            ),
            Self::BeforeAfter => (
                open.diagnosis().is_some(),
                "Residuals before and after appear here after a diagnosis.",
            ),
            Self::Statistics => (
                has_fit,
                "Redundancies, smallest detectable errors and intervals appear here after identification.",
            ),
            // It says itself what it waits for.
            Self::Scope => (true, ""),
        };
        (!present).then_some(why)
    }
}
