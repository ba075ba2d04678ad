use super::binary::{archive, compressed, doubles, matlab, npy, workbook};
use super::spreadsheets::open_document;
use super::*;

const LIMIT: u64 = 16 << 20;

/// Asserts that a file is refused within the limit, in one sentence that names the limit, and read with the default limit.
fn needs_more(name: &str, bytes: &[u8]) {
    assert!(bytes.len() < LIMIT as usize / 8, "{name} is no small file");
    let bench = Bench::new();
    let budget = MemoryBudget::new(LIMIT);
    let told = bench.read_within(&budget, name, bytes);
    let told = told.expect_err("more than the limit");
    let expected = "needs more than 16.0 MiB of memory when it is decoded, expected fewer values, or the command `import` with a larger --memory-limit";
    assert!(told.starts_with(name) && told.contains(expected), "{told}");
    budget.take(LIMIT).expect("nothing is held after a refusal");
    bench
        .read(name, bytes)
        .expect("readable with the default limit");
}

#[test]
fn small_files_that_hold_much_are_refused() {
    const ROWS: usize = 2_000_000;
    let array = npy("'<f8'", false, &format!("({ROWS},)"), &vec![0; 8 * ROWS]);
    needs_more("a.npz", &archive(&[("a.npy", array)], true));
    // The values are many times as large as the bytes that they are stored in.
    let bytes = npy("'|u1'", false, &format!("({ROWS}, 2)"), &vec![3; 2 * ROWS]);
    needs_more("b.npz", &archive(&[("b.npy", bytes)], true));
    let row = "<row><c><v>1</v></c><c><v>2</v></c></row>";
    let sheet = |rows: String| {
        workbook(&format!(
            "<worksheet><sheetData>{rows}</sheetData></worksheet>"
        ))
    };
    needs_more("c.xlsx", &sheet(row.repeat(150_000)));
    // One cell far to the right makes many empty ones.
    let wide = "<row><c><v>1</v></c><c r=\"XFD1\"><v>2</v></c></row>";
    needs_more("d.xlsx", &sheet(wide.repeat(60)));
    // Equal cells and rows are written once.
    let cell = "<table:table-cell office:value=\"1\" table:number-columns-repeated=\"1000\"/>";
    needs_more(
        "f.ods",
        &open_document(&format!(
            "<table:table-row table:number-rows-repeated=\"3000\">{cell}</table:table-row>"
        )),
    );
    let values = vec![1.0; ROWS];
    let variable = compressed(&doubles("v", [ROWS as u32, 1], &values, false));
    needs_more("e.mat", &matlab(&[variable], false));
}

#[test]
fn short_rows_count_with_all_columns_of_their_header() {
    let names = "Frame,Time".to_owned() + &",X".repeat(20_000);
    let rows = "1,0.5,\n".repeat(200);
    let text = format!("Format Version,1.23,Length Units,Meters\n{names}\n{rows}");
    needs_more("h.csv", text.as_bytes());
}

#[test]
fn short_cells_count_with_the_blocks_that_they_take() {
    let cell = "<table:table-cell office:value=\"1\" table:number-columns-repeated=\"1000\"/>";
    let rows =
        format!("<table:table-row table:number-rows-repeated=\"200\">{cell}</table:table-row>");
    let budget = MemoryBudget::new(12 << 20);
    let told = Bench::new().read_within(&budget, "g.ods", &open_document(&rows));
    let told = told.expect_err("72 bytes for each of 200,000 cells");
    assert!(told.contains("needs more than 12.0 MiB"), "{told}");
}

#[test]
fn windows_and_pages_are_asked_for() {
    for name in ["h5py.h5", "newer.h5", "pandas.parquet"] {
        let told = Bench::new().read_within(&MemoryBudget::new(8), name, &seed(name));
        let told = told.expect_err("more than eight bytes");
        assert!(told.contains("needs more than 0.0 MiB"), "{told}");
    }
}
