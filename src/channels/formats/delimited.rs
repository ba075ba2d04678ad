//! Tables as text, with any separator, in any encoding.

use tautline_files::ReadError;

use super::{encoding_notice, stem};
use crate::input::Input;
use crate::source::{Format, Source};
use crate::table::{Columns, Layout, SAMPLE, no_numbers};
use crate::text::{Cells, Lines};

pub(super) fn read(head: &[u8], input: Input<'_>, file: &str) -> Result<Source, ReadError> {
    let mut lines = Lines::new(head, input, file);
    let sample: Vec<(u64, String)> = lines.look_ahead(SAMPLE)?.iter().cloned().collect();
    let texts: Vec<(u64, &str)> = sample
        .iter()
        .map(|(line, text)| (*line, text.as_str()))
        .collect();
    let separator = Layout::separator(&texts);
    let split: Vec<(u64, Cells)> = texts
        .iter()
        .map(|(line, text)| (*line, Cells::of(text, separator)))
        .collect();
    let split: Vec<(u64, &Cells)> = split.iter().map(|(line, cells)| (*line, cells)).collect();
    let layout = Layout::of(&split).ok_or_else(|| no_numbers(file))?;
    layout.check(file)?;
    let mut columns = Columns::new(file, &layout, &split);
    let mut cells = Cells::default();
    while let Some((line, text)) = lines.next_line()? {
        if line >= layout.first_data_line {
            cells.split(text, separator);
            columns.push(line, &cells)?;
        }
    }
    let mut notices = layout.notices(file);
    notices.extend(encoding_notice(file, lines.encoding()));
    if !layout.has_header && !layout.is_point_list() {
        notices.push(format!("{file}: no header row; columns are numbered"));
    }
    let series = columns.finish(&stem(file), &mut notices)?;
    let format = if layout.is_point_list() {
        Format::PointList
    } else {
        Format::Table
    };
    Ok(Source {
        file: file.into(),
        format,
        series: vec![series],
        notices,
    })
}
