//! The study of isolability as `validation isolability` prints it, smaller.

use tautline_validation::tables::isolability::{agreeing, markdown, study};

/// Each of 12 predictions is in its 95 % interval with a probability of 0.95 or more: 9 or fewer are with a probability
/// of 2 % if all are right, and the seed is fixed.
#[test]
fn faults_are_seen_and_confused_as_often_as_predicted() {
    let pairs = study((6, 20, 5)).unwrap();
    let [seen, confused] = agreeing(&pairs);
    assert_eq!(seen.whole + confused.whole, 12);
    assert!(seen.part + confused.part >= 10, "{}", markdown(&pairs));
}
