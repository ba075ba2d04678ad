//! Line wrapping.

use super::faces::Faces;

/// Whether a line may break at a character: any space but a non-breaking one.
fn is_gap(letter: char) -> bool {
    letter.is_whitespace() && letter != '\u{a0}'
}

/// Wraps text at spaces; a word wider than the line is broken where necessary.
pub fn wrap(faces: &Faces, text: &str, size: f64, bold: bool, width: f64) -> Vec<String> {
    let fits = |text: &str| faces.width(text, size, bold) <= width;
    let mut lines = Vec::new();
    let mut line = String::new();
    for word in text.split(is_gap).filter(|word| !word.is_empty()) {
        let longer = if line.is_empty() {
            word.to_owned()
        } else {
            format!("{line} {word}")
        };
        if fits(&longer) {
            line = longer;
            continue;
        }
        if !line.is_empty() {
            lines.push(std::mem::take(&mut line));
        }
        let mut pieces = broken(word, &fits);
        line = pieces.pop().unwrap_or_default();
        lines.extend(pieces);
    }
    if !line.is_empty() || lines.is_empty() {
        lines.push(line);
    }
    lines
}

/// Pieces of a word that fit.
fn broken(word: &str, fits: &dyn Fn(&str) -> bool) -> Vec<String> {
    if fits(word) {
        return vec![word.to_owned()];
    }
    let mut pieces = vec![String::new()];
    for letter in word.chars() {
        if let Some(last) = pieces.last_mut() {
            last.push(letter);
            if fits(last) || last.chars().count() == 1 {
                continue;
            }
            last.pop();
            pieces.push(letter.to_string());
        }
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_fit_and_keep_the_words() {
        let faces = Faces::new().expect("fonts");
        let text = "The readings are missed by 1.60 times their noise, pulley/with-a-very-long-name_that_goes_on.";
        for width in [30.0, 80.0, 200.0, 1000.0] {
            let lines = wrap(&faces, text, 9.0, false, width);
            assert!(lines.iter().all(|l| faces.width(l, 9.0, false) <= width));
            let letters = |t: &str| t.replace(' ', "");
            assert_eq!(letters(&lines.concat()), letters(text));
        }
        assert_eq!(wrap(&faces, "", 9.0, false, 50.0), [""]);
        let kept = "12.3\u{a0}mm";
        assert_eq!(
            wrap(&faces, &format!("up to {kept}"), 9.0, false, 40.0),
            ["up to", kept]
        );
    }

    #[test]
    fn glyphs_cover_the_text_in_its_order() {
        let faces = Faces::new().expect("fonts");
        for text in ["Tautline ± 0.3 mm", "Größe Δx → 漢字", "ﬁ e\u{301}"] {
            let glyphs = faces.get(false).glyphs(text);
            let mut end = 0;
            for glyph in &glyphs {
                assert!(
                    glyph.text_range.start <= end && glyph.text_range.end > glyph.text_range.start
                );
                end = end.max(glyph.text_range.end);
            }
            assert_eq!(end, text.len(), "{text}");
        }
    }
}
