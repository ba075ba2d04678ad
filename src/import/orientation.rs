//! Orientation of matrices: one column per channel, or one row.

use std::collections::BTreeSet;

use tautline_channels::{Channel, Format, Series, Source, Values, owner_of};

use crate::actuators::spread_actuators;

/// Gives each cable its own channels if a file has them in rows: matrices, and logs with one row per actuator. Notices of
/// the files name the transposed ones.
pub fn arrange_per_cable(sources: &mut [Source], cables: usize) {
    transpose_matrices(sources, cables);
    spread_actuators(sources, cables);
}

/// A matrix in a series, of which each column is a channel.
struct Matrix {
    series: usize,
    /// Its name.
    path: String,
    rows: usize,
    /// Index of each column among the channels.
    columns: Vec<usize>,
}

/// Transposes the matrices that have one row per channel: as many rows as the robot has cables and more columns than rows,
/// or as many columns as other arrays of the file have samples. A notice of the file names each.
pub(crate) fn transpose_matrices(sources: &mut [Source], cables: usize) {
    for source in sources {
        let matrices = matrices(source);
        let turned = turned(source, &matrices, cables);
        for (matrix, _) in matrices.iter().zip(&turned).filter(|(_, turns)| **turns) {
            let [first, last] = [1, matrix.rows].map(|row| name_of_row(source.format, matrix, row));
            source.notices.push(format!(
                "{}: {} of {} x {} has one row per channel and is transposed: its rows are {first} to {last}",
                source.file,
                matrix.path,
                matrix.rows,
                matrix.columns.len()
            ));
        }
        let turned = matrices.into_iter().zip(turned);
        let turned: Vec<Matrix> = turned.filter(|(_, turns)| *turns).map(|(m, _)| m).collect();
        apply(source, &turned);
    }
}

/// The matrices of a file with columns that are numbered in brackets.
fn matrices(source: &Source) -> Vec<Matrix> {
    let mut matrices: Vec<Matrix> = Vec::new();
    for (k, series) in source.series.iter().enumerate() {
        for (index, channel) in series.channels.iter().enumerate() {
            let Some(path) = path_of_column(source.format, &channel.name) else {
                continue;
            };
            let known = matrices
                .iter_mut()
                .rfind(|known| known.series == k && known.path == path);
            match known {
                Some(matrix) => matrix.columns.push(index),
                None => matrices.push(Matrix {
                    series: k,
                    path: path.to_owned(),
                    rows: series.rows,
                    columns: vec![index],
                }),
            }
        }
    }
    matrices
}

/// `pos` of `pos(:,3)` in MATLAB, of `pos[2]` elsewhere.
fn path_of_column(format: Format, name: &str) -> Option<&str> {
    let (path, number) = match format {
        Format::Matlab => name.strip_suffix(')')?.rsplit_once("(:,")?,
        Format::Hdf5 | Format::NumPy => name.strip_suffix(']')?.rsplit_once('[')?,
        _ => return None,
    };
    number.parse::<usize>().is_ok().then_some(path)
}

/// The name of a row, counted from 1.
fn name_of_row(format: Format, matrix: &Matrix, row: usize) -> String {
    match format {
        Format::Matlab => format!("{}({row},:)", matrix.path),
        _ => format!("{}[{},:]", matrix.path, row - 1),
    }
}

/// For each matrix, whether its rows are the channels.
fn turned(source: &Source, matrices: &[Matrix], cables: usize) -> Vec<bool> {
    let is_column = |series: &Series| {
        let is_vector = |channel: &Channel| path_of_column(source.format, &channel.name).is_none();
        series.channels.iter().any(is_vector) || !series.texts.is_empty()
    };
    let vectors = source.series.iter().filter(|series| is_column(series));
    let vectors: BTreeSet<usize> = vectors.map(|series| series.rows).collect();
    let is_wide = |matrix: &Matrix| matrix.columns.len() > matrix.rows;
    let contradicts = |matrix: &Matrix| vectors.contains(&matrix.rows);
    let is_sampled = |matrix: &Matrix| vectors.contains(&matrix.columns.len());
    let per_cable = |matrix: &&Matrix| {
        matrix.rows == cables && is_wide(matrix) && (is_sampled(matrix) || !contradicts(matrix))
    };
    // Columns of one matrix are rows of another one that has a column per cable.
    let is_tall = |matrix: &&Matrix| matrix.columns.len() == cables && matrix.rows > cables;
    let samples: BTreeSet<usize> = matrices
        .iter()
        .filter(per_cable)
        .map(|matrix| matrix.columns.len())
        .chain(matrices.iter().filter(is_tall).map(|matrix| matrix.rows))
        .chain(vectors.iter().copied())
        .collect();
    let is_turned = |matrix: &Matrix| {
        per_cable(&matrix)
            || is_wide(matrix) && samples.contains(&matrix.columns.len()) && !contradicts(matrix)
    };
    matrices.iter().map(is_turned).collect()
}

/// Replaces the columns of these matrices by their rows.
fn apply(source: &mut Source, matrices: &[Matrix]) {
    let format = source.format;
    let mut made: Vec<(usize, Vec<Channel>)> = Vec::new();
    for matrix in matrices {
        let channels = &source.series[matrix.series].channels;
        let rows = (0..matrix.rows).map(|row| Channel {
            name: name_of_row(format, matrix, row + 1),
            unit: channels[matrix.columns[0]].unit.clone(),
            values: matrix
                .columns
                .iter()
                .map(|column| channels[*column].values.at(row))
                .collect::<Values>(),
        });
        made.push((matrix.series, rows.collect()));
    }
    let is_in = |series: usize, path: &str| {
        matrices
            .iter()
            .any(|matrix| matrix.series == series && matrix.path == path)
    };
    for (k, series) in source.series.iter_mut().enumerate() {
        series.channels.retain(|channel| {
            path_of_column(format, &channel.name).is_none_or(|path| !is_in(k, path))
        });
    }
    for (from, channels) in made {
        let rows = channels.first().map_or(0, |channel| channel.values.len());
        let of = owner(&channels).to_owned();
        let fits = |series: &Series| {
            series.rows == rows && !series.channels.is_empty() && owner(&series.channels) == of
        };
        match source.series.iter_mut().find(|series| fits(series)) {
            Some(series) => series.channels.extend(channels),
            None => source.series.push(Series {
                name: format!("{} transposed", source.series[from].name),
                rows,
                channels,
                ..Series::default()
            }),
        }
    }
    source.series.retain(|series| !series.channels.is_empty());
}

/// The variable that the channels of a series belong to.
fn owner(channels: &[Channel]) -> &str {
    let path = channels.first().map_or("", |channel| channel.name.as_str());
    let last = path
        .rsplit_once(['(', '['])
        .filter(|(_, last)| last.contains([',', ':']));
    owner_of(last.map_or(path, |(path, _)| path))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matrix(path: &str, rows: usize, columns: usize) -> Vec<Channel> {
        let column = |k: usize| Channel {
            name: format!("{path}(:,{})", k + 1),
            unit: Some("rad".into()),
            values: (0..rows).map(|row| (100 * row + k) as f64).collect(),
        };
        (0..columns).map(column).collect()
    }

    fn vector(name: &str, rows: usize) -> Vec<Channel> {
        vec![Channel {
            name: name.into(),
            values: (0..rows).map(|row| row as f64).collect(),
            ..Channel::default()
        }]
    }

    /// A file of these arrays, arrays of as many rows in one series as the readers have them.
    fn source(arrays: Vec<Vec<Channel>>) -> Source {
        let mut series: Vec<Series> = Vec::new();
        for channels in arrays {
            let rows = channels[0].values.len();
            match series.iter_mut().find(|known| known.rows == rows) {
                Some(known) => known.channels.extend(channels),
                None => series.push(Series {
                    name: format!("log ({rows})"),
                    rows,
                    channels,
                    ..Series::default()
                }),
            }
        }
        Source {
            file: "log.mat".into(),
            format: Format::Matlab,
            series,
            notices: Vec::new(),
        }
    }

    fn names(source: &Source) -> Vec<(usize, Vec<&str>)> {
        let of = |k: usize| {
            let channels = source.series[k].channels.iter();
            channels.map(|channel| channel.name.as_str()).collect()
        };
        let series = source.series.iter().enumerate();
        series.map(|(k, series)| (series.rows, of(k))).collect()
    }

    #[test]
    fn matrices_with_a_row_for_each_cable_are_transposed() {
        let mut log = [source(vec![vector("t", 9), matrix("theta", 4, 9)])];
        transpose_matrices(&mut log, 4);
        assert_eq!(
            log[0].notices,
            [
                "log.mat: theta of 4 x 9 has one row per channel and is transposed: its rows are theta(1,:) to theta(4,:)"
            ]
        );
        let expected = ["t", "theta(1,:)", "theta(2,:)", "theta(3,:)", "theta(4,:)"];
        assert_eq!(names(&log[0]), [(9, expected.to_vec())]);
        let third = log[0].series[0].channel("theta(3,:)").expect("a row");
        let values: Vec<f64> = third.values.iter().collect();
        assert_eq!(
            values,
            [
                200.0, 201.0, 202.0, 203.0, 204.0, 205.0, 206.0, 207.0, 208.0
            ]
        );
        assert_eq!(third.unit.as_deref(), Some("rad"));
        let once = log.clone();
        transpose_matrices(&mut log, 4);
        assert_eq!(log, once);
    }

    #[test]
    fn commanded_poses_are_transposed_with_the_readings() {
        let mut log = [source(vec![matrix("theta", 8, 31), matrix("x_des", 7, 31)])];
        transpose_matrices(&mut log, 8);
        assert_eq!(log[0].notices.len(), 2);
        assert_eq!(log[0].series.len(), 1);
        assert_eq!(
            (log[0].series[0].rows, log[0].series[0].channels.len()),
            (31, 15)
        );
    }

    #[test]
    fn a_matrix_with_a_column_for_each_cable_stays() {
        for arrays in [
            // A pose in each row, as the laser has.
            vec![matrix("theta", 31, 8), vector("laser", 31)],
            // Eight poses of a robot with eight cables: the rows of the laser decide.
            vec![
                matrix("theta", 8, 8),
                matrix("data", 8, 15),
                vector("laser", 8),
            ],
            // Without evidence that the rows are those of cables.
            vec![matrix("image", 5, 12)],
        ] {
            let before = source(arrays);
            let mut log = [before.clone()];
            transpose_matrices(&mut log, 8);
            assert_eq!(log[0], before);
        }
    }
}
