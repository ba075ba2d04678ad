//! A small version of the truth study; the whole is `validation truth`.

use tautline_validation::tables::truth::study;

/// Data sets per robot.
const DATA_SETS: usize = 60;

/// With other seeds the chi-square bound (4 standard errors) would fail by chance with probability 6e-5
/// per robot. The errors within one data set hang together, so that the standardised rms scatters by about
/// 0.04 and the coverage by about 1 % over 60 data sets: their bounds are four times that.
#[test]
fn errors_agree_with_the_stated_uncertainties() {
    for name in ["mini", "hall", "suspended", "planar"] {
        let row = study(name, DATA_SETS, 500).unwrap();
        assert_eq!(row.failures, 0, "{name}");
        let off = (row.chi2_mean - row.dof) / row.chi2_standard_error;
        assert!(
            off.abs() < 4.0,
            "{name}: chi-square {off:.1} standard errors off"
        );
        assert!((row.standardised_rms - 1.0).abs() < 0.16, "{row:?}");
        assert!((row.coverage - 0.95).abs() < 0.04, "{row:?}");
        assert!((row.over_bound - 1.0).abs() < 0.16, "{row:?}");
    }
}
