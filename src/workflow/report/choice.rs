//! What of a report is wanted, and what stands at its head.

use std::collections::BTreeSet;

use clap::ValueEnum;
use tautline_session::Preferences;

/// A part of a report.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, ValueEnum)]
pub enum Part {
    /// What came out, in words.
    Result,
    /// The robot with its picture.
    Robot,
    /// What was measured.
    Data,
    /// How it was identified.
    Method,
    /// The identified values.
    Geometry,
    /// How well the model fits.
    Fit,
    /// What the model gets wrong.
    Causes,
    /// Accuracy before and after.
    Accuracy,
    /// What was written to the controller.
    Adjustments,
    /// What the report cannot say.
    Limits,
    /// What made the report.
    About,
    /// The log of the session.
    Log,
}

impl Part {
    /// All, in their order.
    #[must_use]
    pub fn all() -> &'static [Self] {
        Self::value_variants()
    }

    /// Its name in commands and preferences.
    #[must_use]
    pub fn name(self) -> String {
        let value = self.to_possible_value();
        value.map_or_else(String::new, |value| value.get_name().to_owned())
    }

    /// What the operator reads.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Result => "Result",
            Self::Robot => "Robot",
            Self::Data => "Measured data",
            Self::Method => "Method",
            Self::Geometry => "Identified values",
            Self::Fit => "How well the model fits",
            Self::Causes => "What the model gets wrong",
            Self::Accuracy => "Accuracy",
            Self::Adjustments => "Adjustments",
            Self::Limits => "Limits of this report",
            Self::About => "About this report",
            Self::Log => "Log of the session",
        }
    }
}

/// What of a report is wanted, and what stands at its head; by default everything, with a title made of the session.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ReportChoice {
    /// Parts that are left out.
    pub without: BTreeSet<Part>,
    /// Title; that of the session if it is empty.
    pub title: String,
    /// A line above the title.
    pub header: String,
    /// Who made the measurements.
    pub operator: String,
    /// For whom.
    pub company: String,
}

impl ReportChoice {
    /// As the user has chosen before.
    #[must_use]
    pub fn of(preferences: &Preferences) -> Self {
        let left_out = &preferences.report.without;
        let parts = Part::all().iter().copied();
        Self {
            without: parts
                .filter(|part| left_out.contains(&part.name()))
                .collect(),
            title: String::new(),
            header: preferences.report.header.clone(),
            operator: preferences.operator.clone(),
            company: preferences.report.company.clone(),
        }
    }

    /// Puts it where the next report finds it; the title is that of one report alone.
    pub fn keep(&self, preferences: &mut Preferences) {
        preferences.operator.clone_from(&self.operator);
        preferences.report.company.clone_from(&self.company);
        preferences.report.header.clone_from(&self.header);
        preferences.report.without = self.without.iter().map(|part| part.name()).collect();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_choice_is_kept_but_for_its_title() {
        let choice = ReportChoice {
            without: [Part::Log, Part::About].into(),
            title: "This one".into(),
            header: "Form 7".into(),
            operator: "B. Smith".into(),
            company: "Cables Ltd".into(),
        };
        let mut preferences = Preferences::default();
        choice.keep(&mut preferences);
        assert_eq!(preferences.report.without, ["about", "log"]);
        let expected = ReportChoice {
            title: String::new(),
            ..choice
        };
        assert_eq!(ReportChoice::of(&preferences), expected);
    }
}
