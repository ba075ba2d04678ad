//! Colours of plots, on screen and on paper.

use ecolor::Color32;

/// Colours of a figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Colours {
    /// Background of the data.
    pub ground: Color32,
    /// Axes and grid.
    pub line: Color32,
    /// Titles.
    pub text: Color32,
    /// Tick labels and secondary text.
    pub muted: Color32,
    /// The selection, and data that do not belong to a cable.
    pub accent: Color32,
    /// Limits and data within them.
    pub good: Color32,
    /// Doubtful data.
    pub warning: Color32,
    /// Ends of the diverging scale of heat maps, below and above zero; zero has the background colour.
    pub diverging: [Color32; 2],
    /// Colours of the cables.
    pub cables: [Color32; 8],
}

impl Colours {
    /// Colour of a cable by its index; colours repeat from the ninth cable on, numbers do not.
    #[must_use]
    pub fn cable(&self, index: usize) -> Color32 {
        self.cables[index % self.cables.len()]
    }
}
