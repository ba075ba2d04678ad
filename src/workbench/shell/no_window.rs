//! Error message if the window cannot be opened.

/// Reason why there is no window, and the commands that work without one.
#[must_use]
pub fn no_window(error: &eframe::Error) -> String {
    let reason = match error {
        eframe::Error::NoGlutinConfigs(_, error) => format!("OpenGL: {error}"),
        other => without_place(&other.to_string()).to_owned(),
    };
    let reason = reason.trim_end_matches('.');
    format!(
        "no window can be opened ({reason}); the commands need none: `tautline --help` lists them"
    )
}

/// Message without the source location in a library.
fn without_place(text: &str) -> &str {
    let noticed = text.split_once("os error at ");
    let reason = noticed.and_then(|(_, rest)| Some(rest.split_once(": ")?.1));
    reason.unwrap_or(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_place_in_a_library_is_left_out() {
        let text = "winit EventLoopError: os error at /build/winit/src/mod.rs:765: no DISPLAY";
        assert_eq!(without_place(text), "no DISPLAY");
        assert_eq!(
            without_place("egui_glow: no OpenGL"),
            "egui_glow: no OpenGL"
        );
    }
}
