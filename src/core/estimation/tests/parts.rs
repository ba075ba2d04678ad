//! Poses in parts, on threads.

use super::*;
use crate::effect::EffectRequest;

/// Parts of 16 poses, on several threads.
fn on(threads: usize) -> Options {
    Options {
        division: Division {
            poses_per_part: 16,
            threads: Some(threads),
        },
        ..Options::default()
    }
}

#[test]
fn any_number_of_threads_finds_the_same_to_the_last_bit() {
    let run = run_of("mini", 100, 61);
    for loss in [Loss::Square, Loss::Huber(1.5)] {
        let mut problem = Problem::new(&run.dataset).unwrap();
        problem.loss = loss;
        problem
            .free(&[EffectRequest::parse("force_gain:cable-1").unwrap()])
            .unwrap();
        let on_one = solve(&problem, &on(1), &mut quiet).unwrap();
        assert!(on_one.converged());
        let analysed_on_one = Analysis::divided(&problem, &on_one, on(1).division);
        for threads in [2, 5] {
            let on_several = solve(&problem, &on(threads), &mut quiet).unwrap();
            assert_same(&on_one, &on_several);
            let analysed = Analysis::divided(&problem, &on_one, on(threads).division);
            assert_eq!(analysed, analysed_on_one);
        }
    }
}

fn assert_same(first: &Solution, second: &Solution) {
    assert_eq!(first.chi2.to_bits(), second.chi2.to_bits());
    assert_eq!(first.iterations, second.iterations);
    assert_eq!(first.poses, second.poses);
    assert_eq!(first.globals.entry_points, second.globals.entry_points);
    assert_eq!(first.information, second.information);
    assert_eq!(first.covariance, second.covariance);
}

#[test]
fn parts_find_what_the_whole_does() {
    let run = run_of("mini", 100, 62);
    let problem = Problem::new(&run.dataset).unwrap();
    let whole = solve(&problem, &Options::default(), &mut quiet).unwrap();
    let parts = solve(&problem, &on(2), &mut quiet).unwrap();
    assert_eq!(whole.iterations, parts.iterations);
    assert!((whole.chi2 - parts.chi2).abs() < 1e-9 * whole.chi2);
    assert!(difference_in_sd(&whole, &parts) < 1e-6);
    let of_whole = Analysis::new(&problem, &whole);
    let of_parts = Analysis::divided(&problem, &whole, on(2).division);
    assert_eq!(of_whole.observations.len(), of_parts.observations.len());
    for (one, other) in of_whole.observations.iter().zip(&of_parts.observations) {
        assert_eq!((one.row, one.kind), (other.row, other.kind));
        assert!((one.standardised - other.standardised).abs() < 1e-9);
        let redundancies = (one.redundancy.unwrap(), other.redundancy.unwrap());
        assert!((redundancies.0 - redundancies.1).abs() < 1e-9);
    }
}
