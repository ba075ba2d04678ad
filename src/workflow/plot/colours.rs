//! Colours of plots, on screen and on paper.

use ecolor::Color32;

/// The colours that a figure is drawn in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Colours {
    /// Behind the data.
    pub ground: Color32,
    /// Axes and grid.
    pub line: Color32,
    /// Titles.
    pub text: Color32,
    /// Numbers at the axes; what is less important.
    pub muted: Color32,
    /// What is selected, and data that belong to no cable.
    pub accent: Color32,
    /// Limits and what is within them.
    pub good: Color32,
    /// Doubtful.
    pub warning: Color32,
    /// Ends of the scale of heat maps with both signs: below and above zero, which is the ground.
    pub diverging: [Color32; 2],
    /// Colours of the cables.
    pub cables: [Color32; 8],
}

impl Colours {
    /// Colour of a cable by its index; from the ninth on colours repeat, numbers do not.
    #[must_use]
    pub fn cable(&self, index: usize) -> Color32 {
        self.cables[index % self.cables.len()]
    }
}
