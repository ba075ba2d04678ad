//! `--volume`: a box in the base frame.

use anyhow::Result;
use tautline_core::planning::Volume;

use crate::BadInput;

/// The box that the text of `--volume` describes.
pub fn parse(text: &str) -> Result<Volume> {
    let bad = || {
        BadInput::new(format!(
            "--volume: found \"{text}\", expected X0,X1,Y0,Y1,Z0,Z1 in metres, each first number at most the second"
        ))
    };
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    let numbers = numbers.map_err(|_| bad())?;
    let [x0, x1, y0, y1, z0, z1] = numbers[..] else {
        return Err(bad());
    };
    let volume = Volume {
        low_m: [x0, y0, z0],
        high_m: [x1, y1, z1],
    };
    let is_box = (0..3)
        .all(|k| volume.low_m[k] <= volume.high_m[k] && volume.high_m[k] - volume.low_m[k] < 1e4);
    if is_box && numbers.iter().all(|n| n.is_finite()) {
        Ok(volume)
    } else {
        Err(bad())
    }
}
