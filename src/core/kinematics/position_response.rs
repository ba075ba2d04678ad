//! Motion of the platform by changes of the commanded cable lengths.

use nalgebra::DMatrix;

use crate::geometry::Freedom;

/// Singular values below this fraction of the largest belong to directions that the cables do not constrain; they are left
/// out.
const CUTOFF: f64 = 1e-9;

/// Position rows (3 x parameters) of `J^+ B`, where `J` (`by_pose`) is the derivative of the lengths with respect to the free
/// coordinates of the pose and `B` (`by_parameter`) that with respect to the parameters; lengths that contradict each
/// other are met in the least-squares sense. `None` if the singular values do not converge.
pub(crate) fn position_response(
    by_pose: DMatrix<f64>,
    by_parameter: &DMatrix<f64>,
    freedom: Freedom,
) -> Option<DMatrix<f64>> {
    let svd = by_pose.svd(true, true);
    let cutoff = CUTOFF * svd.singular_values.max();
    let moved = svd.solve(by_parameter, cutoff).ok()?;
    let mut position = DMatrix::zeros(3, by_parameter.ncols());
    for (k, coordinate) in freedom.coordinates().iter().enumerate() {
        if coordinate.index() < 3 {
            position
                .row_mut(coordinate.index())
                .copy_from(&moved.row(k));
        }
    }
    Some(position)
}
