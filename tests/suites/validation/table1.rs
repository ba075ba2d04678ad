//! The study of Table 1 as `validation table1` prints it.

use tautline_validation::tables::table1::{markdown, study};

#[test]
fn the_joint_method_needs_nothing_given() {
    let rows = study(10).unwrap();
    let [drawing, given, alone, simple, joint] = rows.as_slice() else {
        panic!("five methods: {rows:?}");
    };
    // The drawing's own error is that of Table 1, whatever the seed.
    assert!(
        (drawing.entry_error_m - 8.383e-3).abs() < 1e-6,
        "{}",
        drawing.entry_error_m
    );
    // Given 8 coordinates exactly the published method helps; with all 24 unknown it does harm.
    assert!(given.entry_error_m < drawing.entry_error_m);
    assert!(alone.entry_error_m > drawing.entry_error_m);
    for row in [simple, joint] {
        assert!(row.entry_error_m < given.entry_error_m, "{row:?}");
        assert!(
            row.position_error_m < 0.5 * drawing.position_error_m,
            "{row:?}"
        );
    }
    assert_eq!(markdown(&rows).lines().count(), 7);
}
