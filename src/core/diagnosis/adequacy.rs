//! Chi-square tests of whether a model explains the data: of all residuals together and of each kind of reading.
//!
//! With model and noise right, the residuals `r_g` of a group of readings have the covariance `M_gg`
//! ([`ResidualSpace`]), so `r_g^T r_g` has the mean `tr M_gg` and the variance `2 tr M_gg^2`. It is compared with
//! the scaled chi-square distribution of that mean and variance (Satterthwaite 1946), exact where all
//! eigenvalues of `M_gg` are equal.

use std::collections::BTreeMap;

use super::reading_id::ReadingId;
use super::residual_space::ResidualSpace;
use super::{Adequacy, GlobalTest, GroupTest, Quantity};
use crate::estimation::Solution;
use crate::statistics::{chi_square_survival, chi_square_two_sided};

/// Tests the residuals of a solution. Only the global test decides `adequate`: with many group tests, some would reject
/// by chance.
pub(crate) fn adequacy(space: &ResidualSpace, solution: &Solution, alpha: f64) -> Adequacy {
    let (chi2, degrees_of_freedom) = (solution.chi2, solution.degrees_of_freedom);
    let global = GlobalTest {
        chi2,
        degrees_of_freedom,
        // Without degrees of freedom nothing can be rejected.
        p_value: chi_square_survival(chi2, degrees_of_freedom).unwrap_or(1.0),
    };
    let mut groups = group_tests(space, |id| (id.quantity, None));
    let by_cable = group_tests(space, |id| (id.quantity, id.cable));
    groups.extend(by_cable.into_iter().filter(|test| test.cable.is_some()));
    Adequacy {
        adequate: global.p_value >= alpha,
        global,
        groups,
    }
}

/// Groups the rows that belong to a reading by a key. Returns the sorted keys and, for each row, the index of its key.
pub(super) fn classes<K: Ord + Copy>(
    space: &ResidualSpace,
    key_of: impl Fn(&ReadingId) -> K,
) -> (Vec<K>, Vec<Option<usize>>) {
    let keys = space.readings.iter().flatten().map(&key_of);
    let mut index: BTreeMap<K, usize> = keys.map(|key| (key, 0)).collect();
    for (place, index) in index.values_mut().enumerate() {
        *index = place;
    }
    let class = |id: &Option<ReadingId>| id.as_ref().map(|id| index[&key_of(id)]);
    let class_of = space.readings.iter().map(class).collect();
    (index.into_keys().collect(), class_of)
}

fn group_tests(
    space: &ResidualSpace,
    key_of: impl Fn(&ReadingId) -> (Quantity, Option<usize>),
) -> Vec<GroupTest> {
    let (keys, class_of) = classes(space, key_of);
    let sums = space.class_sums(&class_of, keys.len());
    let test = |(class, (quantity, cable)): (usize, &(Quantity, Option<usize>))| {
        let (factor, freedom) = sums.scaled_chi_square(class)?;
        Some(GroupTest {
            quantity: *quantity,
            cable: *cable,
            readings: sums.counts[class],
            rms_over_sd: (sums.squares[class] / sums.traces[class]).sqrt(),
            p_value: chi_square_two_sided(sums.squares[class] / factor, freedom)?,
        })
    };
    keys.iter().enumerate().filter_map(test).collect()
}
