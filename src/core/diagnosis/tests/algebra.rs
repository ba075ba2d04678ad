//! Projections, moments by pose and angles against dense algebra.

use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::super::moments::Moments;
use super::super::scores::{Block, scan};
use super::super::space::{Space, cosine};
use super::{Fit, based, run_with};

fn random(rows: usize, columns: usize, seed: u64) -> DMatrix<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    DMatrix::from_fn(rows, columns, |_, _| rng.random_range(-1.0..1.0))
}

fn near(one: &DMatrix<f64>, other: &DMatrix<f64>, tolerance: f64) {
    let off = (one - other).amax();
    assert!(off <= tolerance * (1.0 + other.amax()), "{off:e}");
}

/// The projection away from the columns, by their singular value decomposition.
fn dense_projection(design: &DMatrix<f64>) -> DMatrix<f64> {
    let left = design.clone().svd(true, false);
    let largest = left.singular_values.max();
    let kept: Vec<usize> = (0..left.singular_values.len())
        .filter(|k| left.singular_values[*k] > 1e-9 * largest)
        .collect();
    let basis = left.u.unwrap().select_columns(&kept);
    DMatrix::identity(design.nrows(), design.nrows()) - &basis * basis.transpose()
}

/// Columns of very different size, one of them twice and one zero: as parameters with units are, and as where the
/// data leave one open.
fn design() -> DMatrix<f64> {
    let mut design = random(30, 6, 1);
    for (k, scale) in [1.0, 1e4, 1e-4, 1.0, 1.0, 0.0].into_iter().enumerate() {
        design.column_mut(k).scale_mut(scale);
    }
    let twice = design.column(1) * 1e-2;
    design.set_column(4, &twice);
    design
}

#[test]
fn the_space_is_what_the_columns_leave() {
    let design = design();
    let residual = DVector::from_column_slice(random(30, 1, 2).as_slice());
    let space = Space::new(&design, &residual);
    assert_eq!(space.taken(), 4);
    let identity = DMatrix::identity(4, 4);
    near(&space.basis().tr_mul(space.basis()), &identity, 1e-9);
    near(&(&design * space.map()), space.basis(), 1e-12);
    let dense = dense_projection(&design);
    let columns = random(30, 3, 3);
    near(&space.project(&columns), &(&dense * &columns), 1e-8);
    let left = &dense * &residual;
    assert!((&space.residual - left).amax() < 1e-8);
}

#[test]
fn cosines_are_those_of_principal_angles() {
    let one = random(30, 3, 4);
    // The same span in other columns, at another scale.
    let mixed = &one * random(3, 3, 5) * 1e3;
    assert!((cosine(&one, &mixed) - 1.0).abs() < 1e-9);
    let orthogonal = dense_projection(&one) * random(30, 2, 6);
    assert!(cosine(&one, &orthogonal) < 1e-9);
    let angle = 0.3_f64;
    let first = one.columns(0, 1).normalize();
    let across = orthogonal.columns(0, 1).normalize();
    let turned = &first * angle.cos() + across * angle.sin();
    assert!((cosine(&first, &turned) - angle.cos()).abs() < 1e-9);
    assert_eq!(cosine(&one, &DMatrix::zeros(30, 2)), 0.0);
    assert_eq!(cosine(&one, &DMatrix::zeros(30, 0)), 0.0);
}

#[test]
fn a_block_is_the_score_test_of_its_columns() {
    let (columns, prior) = (random(30, 2, 7), [2.0, 0.5]);
    let residual = DVector::from_column_slice(random(30, 1, 8).as_slice());
    let (score, information) = (columns.tr_mul(&residual), columns.tr_mul(&columns));
    let block = Block::new(&score, &information, &prior).unwrap();
    let inverse = DMatrix::from_fn(2, 2, |i, k| if i == k { prior[i].powi(-2) } else { 0.0 });
    let solved = (&information + &inverse).try_inverse().unwrap() * &score;
    assert!((block.gain - score.dot(&solved)).abs() < 1e-12);
    for k in 0..2 {
        assert!((block.estimate[k] + solved[k]).abs() < 1e-12);
    }
    let prior = DMatrix::from_fn(2, 2, |i, k| if i == k { prior[i].powi(2) } else { 0.0 });
    let determinant = (DMatrix::identity(2, 2) + prior * information).determinant();
    assert!((block.freedom - determinant.ln()).abs() < 1e-12);
    let unknown = DMatrix::from_element(2, 2, f64::NAN);
    assert!(Block::new(&score, &unknown, &[1.0, 1.0]).is_none());
}

/// Columns that act at some poses only, summed from the moments of these poses, against the columns themselves.
#[test]
fn moments_add_up_to_dense_columns() {
    let run = run_with("mini", 8, 41, &[]);
    let scan = scan(&Fit::new(&based(&run.dataset), &[]).unwrap());
    let columns = random(scan.linear.rows.len(), 2, 9);
    let moments = Moments::new(&columns, &scan);
    let prior = [1.0, 3.0];
    for from in 0..moments.poses.len() {
        let mut sum = moments.poses[from].clone();
        for pose in &moments.poses[from + 1..] {
            sum.add(pose);
        }
        let mut acting = DMatrix::zeros(columns.nrows(), 2);
        for pose in &scan.linear.poses[from..] {
            let (first, count) = (pose.rows.start, pose.rows.len());
            acting
                .rows_mut(first, count)
                .copy_from(&columns.rows(first, count));
        }
        let projected = scan.space.project(&acting);
        let score = projected.tr_mul(&scan.space.residual);
        let dense = Block::new(&score, &projected.tr_mul(&projected), &prior).unwrap();
        let block = sum.block(&prior).unwrap();
        assert!((block.gain - dense.gain).abs() < 1e-9 * (1.0 + dense.gain));
        assert!((block.freedom - dense.freedom).abs() < 1e-9);
    }
}

#[test]
fn weighted_moments_are_those_of_weighted_columns() {
    let run = run_with("mini", 8, 42, &[]);
    let scan = scan(&Fit::new(&based(&run.dataset), &[]).unwrap());
    let column = random(scan.linear.rows.len(), 1, 10);
    let moments = Moments::new(&column, &scan);
    let weights = random(moments.poses.len(), 3, 11);
    let mut acting = DMatrix::zeros(column.nrows(), 3);
    for (j, pose) in scan.linear.poses.iter().enumerate() {
        for row in pose.rows.clone() {
            acting.set_row(row, &(weights.row(j) * column[row]));
        }
    }
    let projected = scan.space.project(&acting);
    let (score, information) = moments.weighted(&weights);
    near(&information, &projected.tr_mul(&projected), 1e-9);
    let dense = projected.tr_mul(&scan.space.residual);
    assert!((score - dense).amax() < 1e-9);
}
