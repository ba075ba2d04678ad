use super::*;

fn lines(bytes: &[u8]) -> (Vec<String>, Option<&'static str>) {
    let mut lines = Lines::within(MemoryBudget::default(), bytes, bytes, "x.txt");
    let mut all = Vec::new();
    while let Some((number, line)) = lines.next_line().expect("lines") {
        assert_eq!(number, all.len() as u64 + 1);
        all.push(line.to_owned());
    }
    (all, lines.encoding().name())
}

fn utf_16(text: &str, big_endian: bool) -> Vec<u8> {
    let bytes = |unit: u16| match big_endian {
        true => unit.to_be_bytes(),
        false => unit.to_le_bytes(),
    };
    text.encode_utf16().flat_map(bytes).collect()
}

#[test]
fn lines_of_all_encodings() {
    let expected = vec!["Länge;m".to_owned(), "µ 😀".to_owned()];
    let text = "Länge;m\r\nµ 😀\n";
    assert_eq!(lines(text.as_bytes()), (expected.clone(), None));
    let marked = [b"\xef\xbb\xbf", text.as_bytes()].concat();
    assert_eq!(lines(&marked), (expected.clone(), None));
    for (mark, big_endian, name) in [
        ("\u{feff}", false, "UTF-16, little endian"),
        ("\u{feff}", true, "UTF-16, big endian"),
    ] {
        let bytes = utf_16(&format!("{mark}{text}"), big_endian);
        assert_eq!(lines(&bytes), (expected.clone(), Some(name)));
    }
    let bytes = utf_16("plain text without mark\n", false);
    assert_eq!(lines(&bytes).0, ["plain text without mark"]);
    let latin = b"L\xe4nge \x80\n";
    assert_eq!(lines(latin), (vec!["Länge €".into()], Some("Windows-1252")));
}

#[test]
fn a_pair_of_surrogates_across_two_blocks() {
    let text = format!("\u{feff}{}😀 end", "a".repeat(4094));
    let (read, _) = lines(&utf_16(&text, false));
    assert_eq!(read, [text.trim_start_matches('\u{feff}')]);
}

#[test]
fn a_line_without_end_is_refused() {
    let bytes = vec![b'a'; MAX_LINE as usize + 1];
    let mut lines = Lines::within(MemoryBudget::default(), &bytes, &bytes[..], "x.txt");
    let error = lines.next_line().expect_err("too long").to_string();
    assert_eq!(
        error,
        "x.txt, line 1: found more than 4 MB without a line end, expected lines"
    );
}

#[test]
fn lines_that_were_looked_at_are_read() {
    let bytes = b"a\nb\nc";
    let mut lines = Lines::within(MemoryBudget::default(), bytes, &bytes[..], "x");
    assert_eq!(lines.look_ahead(2).expect("lines").len(), 2);
    assert_eq!(lines.look_ahead(9).expect("lines").len(), 3);
    assert_eq!(lines.next_line().expect("a line"), Some((1, "a")));
    assert_eq!(lines.next_line().expect("a line"), Some((2, "b")));
    assert_eq!(lines.next_line().expect("a line"), Some((3, "c")));
    assert_eq!(lines.next_line().expect("the end"), None);
}

#[test]
fn cells_with_quotation_marks() {
    let split = |line, separator| {
        Cells::of(line, separator)
            .iter()
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    assert_eq!(
        split("a; b ;;", Separator::Character(';')),
        ["a", "b", "", ""]
    );
    assert_eq!(
        split(r#""a;""b""",c;"d"#, Separator::Character(';')),
        ["a;\"b\",c", "d"]
    );
    assert_eq!(split("  P1\t 1  2 ", Separator::Blanks), ["P1", "1", "2"]);
    assert_eq!(split("", Separator::Character(',')), [""]);
}

#[test]
fn numbers_and_gaps() {
    assert_eq!(parse_number("-1,5e3"), Some((-1500.0, Decimal::Comma)));
    assert_eq!(parse_number(".5"), Some((0.5, Decimal::Point)));
    assert_eq!(parse_number("7"), Some((7.0, Decimal::None)));
    for bad in [
        "1.234,5",
        "1,234,567",
        "abc",
        "",
        "-",
        "1e999",
        "0x10",
        "inf",
        "e",
    ] {
        assert_eq!(parse_number(bad), None, "{bad}");
    }
    assert!(is_gap("NaN") && is_gap("") && is_gap("#N/A") && !is_gap("0") && !is_gap("abc"));
}

#[test]
fn times_in_seconds() {
    assert_eq!(parse_timestamp("1970-01-02 00:00:01.5"), Some(86_401.5));
    assert_eq!(parse_timestamp("02.01.1970 00:00:01,5"), Some(86_401.5));
    assert_eq!(
        parse_timestamp("2024-02-29T12:00:00Z"),
        Some(1_709_208_000.0)
    );
    assert_eq!(parse_timestamp("10:11:12:345"), Some(36_672.345));
    for bad in [
        "5/6/2024 10:00",
        "25:00:00",
        "10",
        "2024-13-01 00:00",
        "a:b",
        "1:2:3:4:5",
        "",
    ] {
        assert_eq!(parse_timestamp(bad), None, "{bad}");
    }
}
