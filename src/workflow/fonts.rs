//! The fonts of screens and reports.

/// Inter, regular.
pub const REGULAR: &[u8] = include_bytes!("../../assets/fonts/Inter-Regular-tabular.otf");
/// Inter, semi-bold.
pub const STRONG: &[u8] = include_bytes!("../../assets/fonts/Inter-SemiBold-tabular.otf");
/// Icons of Material Symbols at the characters that the window which chooses files draws.
pub const FILE_CHOOSER_ICONS: &[u8] = include_bytes!("../../assets/fonts/file-chooser-icons.ttf");
