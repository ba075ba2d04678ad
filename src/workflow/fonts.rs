//! The fonts of screens and reports.

/// Inter, regular.
pub const REGULAR: &[u8] = include_bytes!("../../assets/fonts/Inter-Regular-tabular.otf");
/// Inter, semi-bold.
pub const STRONG: &[u8] = include_bytes!("../../assets/fonts/Inter-SemiBold-tabular.otf");
