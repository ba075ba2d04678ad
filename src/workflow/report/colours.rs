//! Colours of reports, for white paper.

use ecolor::Color32;

use crate::plot::Colours;

/// Text and strong lines.
pub const DARK: Color32 = Color32::from_rgb(0x1f, 0x24, 0x2b);
/// Secondary text and lines.
pub const MUTED: Color32 = Color32::from_rgb(0x5b, 0x64, 0x70);
/// Thin lines.
pub const FAINT: Color32 = Color32::from_rgb(0xd9, 0xdd, 0xe2);
/// Data.
pub const ACCENT: Color32 = Color32::from_rgb(0x1f, 0x5f, 0xa8);
/// Data outside the expected range.
pub const WARNING: Color32 = Color32::from_rgb(0xc2, 0x41, 0x0c);

/// Colours of the plots; cables are named in words, not by colour.
pub const PLOT: Colours = Colours {
    ground: Color32::WHITE,
    line: FAINT,
    text: DARK,
    muted: MUTED,
    accent: ACCENT,
    good: ACCENT,
    warning: WARNING,
    diverging: [ACCENT, WARNING],
    cables: [ACCENT; 8],
};
