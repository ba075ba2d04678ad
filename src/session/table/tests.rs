use super::*;

fn rows(text: &[u8]) -> Result<Vec<(u64, Vec<String>)>, String> {
    let mut table = Table::open(text, "t.csv").map_err(|error| error.to_string())?;
    let columns = table.names().len();
    let mut rows = Vec::new();
    loop {
        match table.next_row() {
            Ok(Some(row)) => {
                let cells = (0..columns).map(|k| row.text(k).to_string());
                rows.push((row.line(), cells.collect()));
            }
            Ok(None) => return Ok(rows),
            Err(error) => return Err(error.to_string()),
        }
    }
}

fn number(cell: &str, separator: char) -> Result<f64, String> {
    let text = format!("a{separator}b\n{cell}{separator}1\n");
    let mut table = Table::open(text.as_bytes(), "t.csv").map_err(|error| error.to_string())?;
    let row = table.next_row().map_err(|error| error.to_string())?;
    let row = row.expect("one row");
    row.number(0).map_err(|error| error.to_string())
}

#[test]
fn lines_are_those_of_the_file() {
    let text =
        b"\xef\xbb\xbf# made by hand\r\n\r\na,b\r\n# one\r\n1,2\r\n\r\n3,\"x\"\"\n,y\"\r\n5,6";
    let read = rows(text).expect("a table");
    assert_eq!(read[0], (5, vec!["1".into(), "2".into()]));
    assert_eq!(read[1], (7, vec!["3".into(), "x\"\n,y".into()]));
    assert_eq!(read[2], (9, vec!["5".into(), "6".into()]));
}

#[test]
fn empty_cells_are_cells() {
    let read = rows(b"a,b,c\n,,3\n1,,\n,,\n\"\",2,\n").expect("a table");
    let lengths: Vec<usize> = read.iter().map(|(_, cells)| cells.len()).collect();
    assert_eq!(lengths, [3, 3, 3]);
    assert_eq!(rows(b"a\n\"\"\n").expect("a table").len(), 1);
}

#[test]
fn a_stray_quotation_mark_is_an_error() {
    assert!(rows(b"a,b\n5\" pipe,2\n3,4\n").is_err());
    let error = rows(b"a,b\n5\" pipe,2\n3\",4\n").expect_err("two records in one");
    assert!(error.contains("line 2"), "{error}");
}

#[test]
fn numbers_of_either_country() {
    assert_eq!(number("-1.5e-3", ','), Ok(-1.5e-3));
    assert_eq!(number("-1,5e-3", ';'), Ok(-1.5e-3));
    assert_eq!(number("1.5", ';'), Ok(1.5));
    assert!(number("", ',').expect("not measured").is_nan());
    for bad in [
        "nan",
        "inf",
        "-Infinity",
        "1e999",
        "0x10",
        "1_000",
        "1 000",
        "--1",
        "e",
        ".",
    ] {
        assert!(number(bad, ',').is_err(), "{bad}");
    }
    for bad in ["1.234,5", "1,2,3"] {
        assert!(number(bad, ';').is_err(), "{bad}");
    }
}

#[test]
fn endless_lines_are_refused_in_bounded_memory() {
    let endless = std::io::BufReader::new(std::io::repeat(b'1'));
    let error = Table::open(endless, "t.csv").err().expect("too long");
    assert!(error.to_string().contains("1 MB"), "{error}");
    let comment = std::io::Read::chain(&b"a,b\n#"[..], std::io::repeat(b' '));
    let mut table = Table::open(std::io::BufReader::new(comment), "t.csv").expect("a header");
    assert!(table.next_row().is_err());
}

#[test]
fn the_first_error_is_told() {
    // A missing quotation mark is detected when its line is read, after the rows before it were accepted.
    let error = rows(b"a,b\n1,2\n3\n4,\"5\n").expect_err("a cell is missing");
    assert!(error.contains("line 3"), "{error}");
    let error = rows(b"a,b\n1,2\n4,\"5\n").expect_err("it is not closed");
    assert!(
        error.contains("line 3") && error.contains("never closed"),
        "{error}"
    );
    let error = rows(b"a,b\n").expect_err("no rows");
    assert!(error.contains("header row only"), "{error}");
}
