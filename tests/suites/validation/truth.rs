//! A small version of the truth study; the whole is `validation truth`.

use tautline_validation::tables::study::{Records, outcomes};
use tautline_validation::tables::truth::{Figures, Truth, by_robot};

/// Seeds of the data sets of each robot.
const SEEDS: std::ops::Range<u64> = 500..560;

/// With other seeds the chi-square bound (4 standard errors) would fail by chance with probability 6e-5
/// per robot. The errors within one data set hang together, so that the standardised rms scatters by about
/// 0.04 and the coverage by about 1 % over 60 data sets: their bounds are four times that.
#[test]
fn errors_agree_with_the_stated_uncertainties() {
    let found = outcomes(&Truth(SEEDS), &Records::default()).unwrap();
    let robots = by_robot(&found);
    assert_eq!(robots.len(), 4);
    for (_, all) in robots {
        let row = Figures::of(&all);
        assert_eq!(row.failures, 0, "{row:?}");
        assert!(row.chi2_off.abs() < 4.0, "{row:?}");
        assert!((row.standardised_rms - 1.0).abs() < 0.16, "{row:?}");
        assert!((row.coverage - 0.95).abs() < 0.04, "{row:?}");
        assert!((row.over_bound - 1.0).abs() < 0.16, "{row:?}");
    }
}
