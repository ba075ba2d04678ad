//! Products and divisions of large dense matrices in the form that is fast: as general products of blocks.

use nalgebra::DMatrix;

/// `A^T B`. For large matrices, transposing first is several times as fast as the dot products of all pairs of columns.
pub(super) fn transposed_times(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    a.transpose() * b
}

/// `b := L^-1 b` for a triangular `L` and many columns, as products of blocks that fit into the cache.
pub(super) fn divide_by_lower(l: &DMatrix<f64>, b: &mut DMatrix<f64>) {
    const ROWS: usize = 96;
    const COLUMNS: usize = 128;
    let ranges = |size: usize, step: usize| {
        let starts = (0..size).step_by(step);
        starts.map(move |start| (start, step.min(size - start)))
    };
    let inverses: Vec<DMatrix<f64>> = ranges(l.nrows(), ROWS)
        .map(|(start, count)| {
            let mut inverse = DMatrix::identity(count, count);
            let block = l.view((start, start), (count, count));
            block.solve_lower_triangular_mut(&mut inverse);
            inverse
        })
        .collect();
    for (first, columns) in ranges(b.ncols(), COLUMNS) {
        let mut panel = b.columns_mut(first, columns);
        for ((start, count), inverse) in ranges(l.nrows(), ROWS).zip(&inverses) {
            let mut block = panel.rows(start, count).into_owned();
            let solved = panel.rows(0, start);
            block.gemm(-1.0, &l.view((start, 0), (count, start)), &solved, 1.0);
            let mut to = panel.rows_mut(start, count);
            to.gemm(1.0, inverse, &block, 0.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn division_in_blocks_is_that_of_the_whole_factor() {
        let lower = DMatrix::from_fn(250, 250, |i, k| match i.cmp(&k) {
            std::cmp::Ordering::Less => 0.0,
            std::cmp::Ordering::Equal => 2.0 + (i % 7) as f64,
            std::cmp::Ordering::Greater => ((3 * i + 5 * k) % 11) as f64 / 110.0,
        });
        let right = DMatrix::from_fn(250, 300, |i, k| ((i * k + i) % 13) as f64 - 6.0);
        let mut found = right.clone();
        divide_by_lower(&lower, &mut found);
        assert!((lower * found - right).amax() < 1e-10);
    }
}
