//! Identity of a plot: several can be of the same kind.

use super::super::{PlotKind, find};

/// Identity of a plot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct PlotId {
    pub(crate) kind: &'static PlotKind,
    /// Number among plots of the same kind, from 0.
    pub(crate) copy: u8,
}

impl PlotId {
    /// First plot of a kind.
    pub(crate) fn first(kind: &'static PlotKind) -> Self {
        Self { kind, copy: 0 }
    }

    /// Name in the preferences.
    pub(crate) fn name(self) -> String {
        match self.copy {
            0 => self.kind.id.to_owned(),
            copy => format!("{} {}", self.kind.id, u32::from(copy) + 1),
        }
    }

    /// Plot with this name in the preferences.
    pub(crate) fn named(name: &str) -> Option<Self> {
        if let Some(kind) = find(name) {
            return Some(Self::first(kind));
        }
        let (name, number) = name.rsplit_once(' ')?;
        let copy = number.parse::<u8>().ok()?.checked_sub(1)?;
        Some(Self {
            kind: find(name)?,
            copy,
        })
    }

    /// Label in the window.
    pub(crate) fn title(self) -> String {
        match self.copy {
            0 => self.kind.title.to_owned(),
            copy => format!("{} {}", self.kind.title, u32::from(copy) + 1),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::views::plots::PLOTS;

    #[test]
    fn names_of_plots_read_back() {
        for copy in [0, 1, 9] {
            for kind in PLOTS {
                let id = PlotId { kind, copy };
                assert_eq!(PlotId::named(&id.name()), Some(id));
            }
        }
        for wrong in ["", "weather", "variable 0", "variable x", "weather 2"] {
            assert_eq!(PlotId::named(wrong), None, "{wrong}");
        }
    }
}
