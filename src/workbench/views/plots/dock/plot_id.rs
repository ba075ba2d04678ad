//! Which plot is meant: there can be several that show the same.

use super::super::Tab;

/// A plot among all.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct PlotId {
    /// What it shows.
    pub tab: Tab,
    /// Counts plots that show the same.
    pub copy: u8,
}

impl PlotId {
    /// The only one of its kind, or the first.
    #[must_use]
    pub fn first(tab: Tab) -> Self {
        Self { tab, copy: 0 }
    }

    /// What preferences call it.
    #[must_use]
    pub fn name(self) -> String {
        match self.copy {
            0 => self.tab.name().to_owned(),
            copy => format!("{} {}", self.tab.name(), u32::from(copy) + 1),
        }
    }

    /// The plot that preferences call so.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        if let Some(tab) = Tab::named(name) {
            return Some(Self::first(tab));
        }
        let (name, number) = name.rsplit_once(' ')?;
        let copy = number.parse::<u8>().ok()?.checked_sub(1)?;
        Some(Self {
            tab: Tab::named(name)?,
            copy,
        })
    }

    /// Label in the window.
    #[must_use]
    pub fn title(self) -> String {
        match self.copy {
            0 => self.tab.title().to_owned(),
            copy => format!("{} {}", self.tab.title(), u32::from(copy) + 1),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_plots_read_back() {
        for copy in [0, 1, 9] {
            for tab in Tab::ALL {
                let id = PlotId { tab, copy };
                assert_eq!(PlotId::named(&id.name()), Some(id));
            }
        }
        for wrong in ["", "weather", "variable 0", "variable x", "weather 2"] {
            assert_eq!(PlotId::named(wrong), None, "{wrong}");
        }
    }
}
