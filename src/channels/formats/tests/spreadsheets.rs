//! Workbooks written by other libraries, `odfpy`, `openpyxl` and `xlwt`; and repeated cells of OpenDocument, which are written
//! once.

use super::binary::archive;
use super::*;

/// 1 March 2024, noon.
const NOON: f64 = 1_709_294_400.0;

/// A spreadsheet with the rows of one sheet.
pub(super) fn open_document(rows: &str) -> Vec<u8> {
    let content = format!(
        "<office:document-content><office:body><office:spreadsheet><table:table table:name=\"Log\">{rows}</table:table></office:spreadsheet></office:body></office:document-content>"
    );
    archive(&[("content.xml", content.into_bytes())], true)
}

fn text(value: &str) -> String {
    format!(
        "<table:table-cell office:value-type=\"string\"><text:p>{value}</text:p></table:table-cell>"
    )
}

fn number(value: &str) -> String {
    format!(
        "<table:table-cell office:value-type=\"float\" office:value=\"{value}\"><text:p>as shown</text:p></table:table-cell>"
    )
}

fn row(cells: &[String]) -> String {
    format!("<table:table-row>{}</table:table-row>", cells.concat())
}

#[test]
fn ods_of_odfpy_has_repeated_cells_and_rows_dates_and_no_comments() {
    let source = read("log.ods", seed("odfpy.ods"));
    assert_eq!(source.format, Format::OpenDocument);
    let [log] = &source.series[..] else {
        panic!("{:?}", source.series);
    };
    assert_eq!(log.name, "log Log & more");
    let when = [0.0, 1.0, 2.0, 9.0, 9.0].map(|second| NOON + second);
    let nan = f64::NAN;
    assert_eq!(
        content(log),
        [
            channel("when", Some("s"), &when),
            channel("Winch 1", Some("rev"), &[0.0, 0.5, 1.0, 3.0, 3.0]),
            channel("Force 1", Some("N"), &[10.0, nan, 12.0, 4.0, 4.0]),
            channel("Force 2", Some("N"), &[10.0, 8.25, 12.0, 5.0, 5.0]),
        ]
    );
    assert!(
        source.notices[0].starts_with("log.ods, sheet \"Notes\": found no row of numbers"),
        "{:?}",
        source.notices
    );
}

#[test]
fn xlsx_of_openpyxl_is_read_beside_its_chart() {
    let source = read("log.xlsx", seed("openpyxl.xlsx"));
    let [log] = &source.series[..] else {
        panic!("{:?}", source.series);
    };
    assert_eq!(
        content(log),
        [
            channel("when", Some("s"), &[0.0, 1.0, 2.0].map(|s| NOON + s)),
            channel("Winch 1", Some("rev"), &[0.0, 0.5, 1.0]),
            channel("Force 1", Some("N"), &[10.0, f64::NAN, 12.0]),
        ]
    );
}

#[test]
fn formats_that_are_not_read_are_refused_with_what_to_save_as() {
    let told = refusal("log.xls", seed("xlwt.xls"));
    assert!(
        told.contains("(.xls)") && told.contains("expected .xlsx"),
        "{told}"
    );
    let binary = archive(&[("xl/workbook.bin", vec![1, 2])], false);
    assert!(refusal("log.xlsb", binary).contains("(.xlsb), expected .xlsx: save it"));
    let words = "<office:document-content><office:body><office:text/></office:body></office:document-content>";
    let words = archive(&[("content.xml", words.into())], true);
    assert!(refusal("log.odt", words).contains("is a document without a spreadsheet"));
    let secret = archive(
        &[
            (
                "META-INF/manifest.xml",
                b"<manifest:encryption-data/>".to_vec(),
            ),
            ("content.xml", vec![0xff, 0x07]),
        ],
        false,
    );
    assert!(refusal("log.ods", secret).contains("expected a workbook without a password"));
}

#[test]
fn cells_of_open_document_are_what_they_mean_not_what_they_show() {
    let void = "<table:covered-table-cell office:value=\"7\"/>".to_owned();
    let error = "<table:table-cell office:value-type=\"string\" calcext:value-type=\"error\"><text:p>#DIV/0!</text:p></table:table-cell>";
    let time = "<table:table-cell office:value-type=\"time\" office:time-value=\"PT00H01M02.5S\"/>";
    let truth = "<table:table-cell office:value-type=\"boolean\" office:boolean-value=\"true\"/>";
    let nested = format!(
        "<table:shapes>{}</table:shapes><table:table-cell><table:table>{}</table:table></table:table-cell>",
        row(&[number("99")]),
        row(&[number("99")])
    );
    let rows = [
        row(&["t [s]", "F 1<text:s text:c=\"3\"/>[N]", "ok", "v"].map(text)),
        row(&[
            number("1"),
            error.to_owned(),
            truth.to_owned(),
            time.to_owned(),
        ]),
        row(&[number("2"), void, number("0"), time.replace("02.5", "03.5")]),
        row(&[
            number("3"),
            number("4e1"),
            number("1"),
            time.replace("01M02.5", "02M00"),
            nested,
        ]),
    ];
    let source = read("a.ods", open_document(&rows.concat()));
    let content = content(&source.series[0]);
    let nan = f64::NAN;
    assert_eq!(content[0], channel("t", Some("s"), &[1.0, 2.0, 3.0]));
    assert_eq!(content[1], channel("F 1", Some("N"), &[nan, nan, 40.0]));
    assert_eq!(content[2], channel("ok", None, &[1.0, 0.0, 1.0]));
    assert_eq!(content[3], channel("v", Some("s"), &[62.5, 63.5, 120.0]));
}

#[test]
fn what_is_wrong_is_told_with_file_sheet_row_and_column() {
    let gap = "<table:table-row table:number-rows-repeated=\"3\"/>";
    let rows = [
        row(&["t [s]", "F 1 [N]"].map(text)),
        gap.to_owned(),
        row(&[number("1"), number("2")]),
        row(&[number("2"), text("broken")]),
        row(&[number("3"), number("4")]),
    ];
    let source = read("a.ods", open_document(&rows.concat()));
    assert_eq!(
        source.notices,
        ["a.ods, sheet \"Log\", column \"F 1\": line 6 holds \"broken\", treated as missing"]
    );
    let many = number("1").replace(
        "office:value=",
        "table:number-columns-repeated=\"99999\" office:value=",
    );
    assert!(refusal("b.ods", open_document(&row(&[many]))).contains("part content.xml is damaged"));
    assert!(refusal("c.ods", open_document("<table:table-row>")).contains("is damaged"));
    assert!(refusal("d.ods", open_document("")).contains("found empty sheets only"));
}
