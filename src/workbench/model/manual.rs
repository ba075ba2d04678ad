//! The manual: pages of Markdown with pictures, as in the repository.

use super::phase::{Phase, Screen};

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Page {
    /// First steps, and the layout of the window.
    Start,
    /// Files of other programs.
    Import,
    /// Phase 1.
    Precalibration,
    /// Phase 2.
    Modeling,
    /// Phase 3.
    Measuring,
    /// Phase 4.
    Identification,
    /// Phase 5.
    Adjustment,
    /// Plots and the table of statistics.
    Plots,
    /// Comparison of sessions, and reports.
    Report,
    /// Record of a robot, and its health check.
    Record,
    /// Hypotheses of the user, and the gallery of effects.
    Hypotheses,
    /// Meaning of each number.
    Numbers,
}

macro_rules! page {
    ($name:literal) => {
        ($name, include_str!(concat!("../../../docs/manual/", $name)))
    };
}

macro_rules! picture {
    ($name:literal) => {
        (
            $name,
            include_bytes!(concat!("../../../screenshots/", $name)).as_slice(),
        )
    };
}

/// Pictures of the pages: file name and PNG.
pub const PICTURES: [(&str, &[u8]); 12] = [
    picture!("start.png"),
    picture!("phase-1.png"),
    picture!("phase-2.png"),
    picture!("phase-3.png"),
    picture!("until.png"),
    picture!("phase-4.png"),
    picture!("phase-5.png"),
    picture!("doctor.png"),
    picture!("compare.png"),
    picture!("record.png"),
    picture!("hypothesis.png"),
    picture!("gallery.png"),
];

impl Page {
    /// All pages, in reading order.
    pub const ALL: [Self; 12] = [
        Self::Start,
        Self::Import,
        Self::Precalibration,
        Self::Modeling,
        Self::Measuring,
        Self::Identification,
        Self::Adjustment,
        Self::Plots,
        Self::Report,
        Self::Record,
        Self::Hypotheses,
        Self::Numbers,
    ];

    fn file(self) -> (&'static str, &'static str) {
        match self {
            Self::Start => page!("start.md"),
            Self::Import => page!("import.md"),
            Self::Precalibration => page!("phase-1.md"),
            Self::Modeling => page!("phase-2.md"),
            Self::Measuring => page!("phase-3.md"),
            Self::Identification => page!("phase-4.md"),
            Self::Adjustment => page!("phase-5.md"),
            Self::Plots => page!("plots.md"),
            Self::Report => page!("report.md"),
            Self::Record => page!("record.md"),
            Self::Hypotheses => page!("hypotheses.md"),
            Self::Numbers => page!("numbers.md"),
        }
    }

    /// File name without extension, by which other pages link to it.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.file().0
    }

    #[must_use]
    pub fn text(self) -> &'static str {
        self.file().1
    }

    #[must_use]
    pub fn title(self) -> &'static str {
        let first = self.text().lines().next().unwrap_or_default();
        first.trim_start_matches("# ")
    }

    /// Page about a screen.
    #[must_use]
    pub fn of(screen: Screen) -> Self {
        match screen {
            Screen::Start => Self::Start,
            Screen::Import => Self::Import,
            Screen::Compare => Self::Report,
            Screen::Record => Self::Record,
            Screen::Hypothesis | Screen::Gallery => Self::Hypotheses,
            Screen::Simulator => Self::Identification,
            Screen::WhichSensor => Self::Measuring,
            Screen::NewRobot => Self::Modeling,
            Screen::Phase(phase) => match phase {
                Phase::Precalibration => Self::Precalibration,
                Phase::Modeling => Self::Modeling,
                Phase::Measuring => Self::Measuring,
                Phase::Identification => Self::Identification,
                Phase::Adjustment => Self::Adjustment,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Targets of links and pictures: the text in round brackets after square ones.
    fn targets(text: &str) -> Vec<&str> {
        let parts = text.split("](").skip(1);
        parts.filter_map(|part| part.split(')').next()).collect()
    }

    #[test]
    fn links_and_pictures_of_all_pages_are_there() {
        let mut pictures = 0;
        for page in Page::ALL {
            assert!(page.text().starts_with("# "), "{}", page.name());
            for target in targets(page.text()) {
                match target.strip_prefix("../../screenshots/") {
                    Some(name) => {
                        pictures += 1;
                        let known = PICTURES.iter().any(|(known, _)| *known == name);
                        assert!(known, "{}: {target}", page.name());
                    }
                    None => {
                        let known = Page::ALL.iter().any(|other| other.name() == target);
                        assert!(known, "{}: {target}", page.name());
                    }
                }
            }
        }
        assert_eq!(pictures, PICTURES.len(), "every picture is shown once");
    }

    #[test]
    fn every_screen_has_a_page() {
        let phases = Phase::ALL.map(|phase| Page::of(Screen::Phase(phase)));
        assert_eq!(phases, Page::ALL[2..7]);
        for (phase, page) in Phase::ALL.iter().zip(phases) {
            let title = format!("{}. {}", phase.number(), phase.title());
            assert_eq!(page.title(), title);
        }
    }
}
