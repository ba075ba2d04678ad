//! The selected parts of a report, and its heading.

use std::collections::BTreeSet;

use tautline_session::Preferences;

/// A part of a report.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Part {
    /// The result in words.
    Result,
    /// The robot with its picture.
    Robot,
    /// The identified values.
    Geometry,
    /// Budget of uncertainty and expanded uncertainty.
    Budget,
    /// Conformity with the tolerance of the pulleys.
    Conformity,
    /// Accuracy before and after.
    Accuracy,
    /// Values written to the controller.
    Adjustments,
    /// The instruments with their uncertainties and calibrations, and the conditions.
    Instruments,
    /// The measured data.
    Data,
    /// The method of identification.
    Method,
    /// Goodness of fit.
    Fit,
    /// The diagnosis of the model.
    Causes,
    /// Limits and assumptions.
    Limits,
    /// Lines to sign on.
    Signatures,
    /// Provenance of the report.
    About,
    /// Deviations of parts that lie within their tolerances.
    Deviations,
    /// The log of the session.
    Log,
}

impl Part {
    /// All parts, in order.
    pub const ALL: [Self; 17] = [
        Self::Result,
        Self::Robot,
        Self::Geometry,
        Self::Budget,
        Self::Conformity,
        Self::Accuracy,
        Self::Adjustments,
        Self::Instruments,
        Self::Data,
        Self::Method,
        Self::Fit,
        Self::Causes,
        Self::Limits,
        Self::Signatures,
        Self::About,
        Self::Deviations,
        Self::Log,
    ];

    /// Name in commands and preferences.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Result => "result",
            Self::Robot => "robot",
            Self::Geometry => "geometry",
            Self::Budget => "budget",
            Self::Conformity => "conformity",
            Self::Accuracy => "accuracy",
            Self::Adjustments => "adjustments",
            Self::Instruments => "instruments",
            Self::Data => "data",
            Self::Method => "method",
            Self::Fit => "fit",
            Self::Causes => "causes",
            Self::Limits => "limits",
            Self::Signatures => "signatures",
            Self::About => "about",
            Self::Deviations => "deviations",
            Self::Log => "log",
        }
    }

    /// The part with this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|part| part.name() == name)
    }

    /// Title in reports and on screen.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Result => "Result",
            Self::Robot => "Robot",
            Self::Geometry => "Identified values",
            Self::Budget => "Uncertainty",
            Self::Conformity => "Conformity",
            Self::Accuracy => "Accuracy",
            Self::Adjustments => "Adjustments",
            Self::Instruments => "Instruments",
            Self::Data => "Measured data",
            Self::Method => "Method",
            Self::Fit => "Goodness of fit",
            Self::Causes => "Model diagnosis",
            Self::Limits => "Limits of this report",
            Self::Signatures => "Signatures",
            Self::About => "About this report",
            Self::Deviations => "Deviations",
            Self::Log => "Log of the session",
        }
    }
}

/// The selected parts of a report, and its heading; by default everything, with a title from the session.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReportChoice {
    /// Parts to leave out.
    pub without: BTreeSet<Part>,
    /// Title; that of the session if empty.
    pub title: String,
    /// A line above the title.
    pub header: String,
    /// Who made the measurements.
    pub operator: String,
    /// Company for which the report is made.
    pub company: String,
    /// Largest acceptable deviation of a pulley from the drawing (m); `None`: nothing is judged.
    pub tolerance_m: Option<f64>,
}

impl ReportChoice {
    /// Whether a part is in the report.
    #[must_use]
    pub fn has(&self, part: Part) -> bool {
        !self.without.contains(&part)
    }

    /// Whether a part shows the identification.
    #[must_use]
    pub fn shows_fit(&self) -> bool {
        let parts = [
            Part::Method,
            Part::Geometry,
            Part::Budget,
            Part::Conformity,
            Part::Deviations,
        ];
        self.shows_diagnosis() || parts.into_iter().any(|part| self.has(part))
    }

    /// Whether a part shows the diagnosis.
    #[must_use]
    pub fn shows_diagnosis(&self) -> bool {
        let parts = [Part::Result, Part::Fit, Part::Causes, Part::Limits];
        parts.into_iter().any(|part| self.has(part))
    }

    /// The choice stored in the preferences; the tolerance is that of a session.
    #[must_use]
    pub fn of(preferences: &Preferences) -> Self {
        let left_out = preferences.report.without.iter();
        Self {
            without: left_out.filter_map(|name| Part::named(name)).collect(),
            title: String::new(),
            header: preferences.report.header.clone(),
            operator: preferences.operator.clone(),
            company: preferences.report.company.clone(),
            tolerance_m: None,
        }
    }

    /// Saves the choice for the next report, except the title and the tolerance.
    pub fn save(&self, preferences: &mut Preferences) {
        preferences.operator.clone_from(&self.operator);
        preferences.report.company.clone_from(&self.company);
        preferences.report.header.clone_from(&self.header);
        let without = self.without.iter();
        preferences.report.without = without.map(|part| part.name().to_owned()).collect();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_choice_is_saved_except_for_its_title_and_tolerance() {
        let choice = ReportChoice {
            without: [Part::Log, Part::About].into(),
            title: "This one".into(),
            header: "Form 7".into(),
            operator: "B. Smith".into(),
            company: "Cables Ltd".into(),
            tolerance_m: Some(0.002),
        };
        let mut preferences = Preferences::default();
        choice.save(&mut preferences);
        assert_eq!(preferences.report.without, ["about", "log"]);
        let expected = ReportChoice {
            title: String::new(),
            tolerance_m: None,
            ..choice
        };
        assert_eq!(ReportChoice::of(&preferences), expected);
    }
}
