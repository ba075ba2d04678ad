use std::sync::Arc;

use ::parquet::data_type::{
    BoolType, ByteArray, ByteArrayType, DoubleType, FloatType, Int32Type, Int64Type,
};
use ::parquet::file::writer::SerializedFileWriter;
use ::parquet::schema::parser::parse_message_type;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;

/// Types of columns in the language of schemas.
const TYPES: [&str; 8] = [
    "double",
    "float",
    "int32",
    "int64",
    "boolean",
    "binary",
    "binary (UTF8)",
    "int64 (TIMESTAMP(MICROS, true))",
];
/// Names, among them those of quantities of a robot.
const NAMES: [&str; 5] = ["rev_1", "time", "x", "force_2_n", "point"];

/// A table with columns of random types.
fn table(random: &mut ChaCha8Rng, types: &[&str]) -> Vec<u8> {
    let rows = [0, 1, 3, 120][random.random_range(0..4)];
    let columns = types.iter().enumerate().map(|(number, kind)| {
        let (kind, suffix) = kind.split_once(' ').unwrap_or((kind, ""));
        let name = NAMES[random.random_range(0..NAMES.len())];
        format!("required {kind} {name}_{number} {suffix};")
    });
    let schema = format!("message table {{ {} }}", columns.collect::<String>());
    let schema = Arc::new(parse_message_type(&schema).expect("a schema"));
    let mut bytes = Vec::new();
    let mut writer =
        SerializedFileWriter::new(&mut bytes, schema, Arc::default()).expect("a writer");
    let mut group = writer.next_row_group().expect("rows");
    for kind in types {
        let mut column = group
            .next_column()
            .expect("a column")
            .expect("one for each");
        let numbers: Vec<i64> = (0..rows).map(|_| random.random_range(-9..9)).collect();
        macro_rules! write {
            ($type:ty, $value:expr) => {{
                let values: Vec<_> = numbers.iter().map($value).collect();
                column.typed::<$type>().write_batch(&values, None, None)
            }};
        }
        let written = match *kind {
            "double" => write!(DoubleType, |n| *n as f64 / 0.7),
            "float" => write!(FloatType, |n| 1.0 / *n as f32),
            "int32" => write!(Int32Type, |n| *n as i32),
            "boolean" => write!(BoolType, |n| *n > 0),
            "binary" => write!(ByteArrayType, |n| ByteArray::from(vec![*n as u8, 0xFF])),
            "binary (UTF8)" => write!(ByteArrayType, |n| ByteArray::from(format!("P{n}").as_str())),
            _ => write!(Int64Type, |n| *n),
        };
        written.expect("written");
        column.close().expect("closed");
    }
    group.close().expect("closed");
    writer.close().expect("closed");
    bytes
}

#[test]
fn a_table_of_any_types_is_imported_or_refused_in_a_sentence() {
    let bench = Bench::new();
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let mut read = 0;
    for run in 0..300 {
        // Of one type each first.
        let types: Vec<&str> = match TYPES.get(run) {
            Some(only) => vec![only; 2],
            None => (0..random.random_range(1..5))
                .map(|_| TYPES[random.random_range(0..TYPES.len())])
                .collect(),
        };
        match bench.read("table.parquet", &table(&mut random, &types)) {
            Ok(source) => {
                read += 1;
                assert!(source.series.iter().any(|series| series.rows > 0));
            }
            Err(told) => {
                assert!(
                    told.starts_with("table.parquet") && !told.contains('\n'),
                    "{told}"
                );
            }
        }
    }
    assert!(read > 100, "only {read} were readable");
}

#[test]
fn a_table_without_numbers_is_refused() {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let texts = loop {
        let bytes = table(&mut random, &["binary (UTF8)"]);
        if bytes.len() > 300 {
            break bytes;
        }
    };
    let told = refusal("names.parquet", texts);
    assert!(told.contains("found a table without numbers"), "{told}");
    let told = refusal("names.csv", "point,state\nA,on\nB,off\n");
    assert!(told.contains("expected"), "{told}");
}
