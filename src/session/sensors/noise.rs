//! The standard deviation that represents all errors of a sensor.

use super::Sensor;

/// Change of temperature between the readings of a run (K), as in a hall over a morning.
const TEMPERATURE_CHANGE_K: f64 = 2.0;

impl Sensor {
    /// Random part of a reading at a distance (m).
    #[must_use]
    pub fn random_sd_at(&self, distance_m: f64) -> f64 {
        let mut sd = self.random_sd_m;
        let mut pieces = self.growth.clone();
        pieces.sort_by(|a, b| a.from_m.total_cmp(&b.from_m));
        for (index, piece) in pieces.iter().enumerate() {
            let end = pieces
                .get(index + 1)
                .map_or(f64::INFINITY, |next| next.from_m);
            sd += piece.sd_per_m * (distance_m.min(end) - piece.from_m).max(0.0);
        }
        sd
    }

    /// The standard deviation of one reading (m) in a run that measures distances between these two, as used by studies and
    /// robot files: random part at the larger distance, rounding, temperature drift, and the part of the nonlinearity that
    /// the estimated offset of the target plane does not absorb.
    ///
    /// With the prior `k(d, d') = s^2 exp(-(d - d')^2 / 2 l^2)` of the nonlinearity, an offset absorbs the mean of `k` over
    /// pairs of distances; the rest counts as independent from pose to pose, although it is smooth.
    #[must_use]
    pub fn reading_sd_m(&self, distances_m: [f64; 2]) -> f64 {
        let [near, far] = distances_m;
        let random = self.random_sd_at(far.max(near));
        let rounding = self.quantisation_m / 12.0_f64.sqrt();
        let drift = self.temperature_sd_m_per_k * TEMPERATURE_CHANGE_K;
        let bent = self.linearity_sd_m * self.share_beyond_offset((far - near).abs()).sqrt();
        [random, rounding, drift, bent]
            .map(|sd| sd * sd)
            .iter()
            .sum::<f64>()
            .sqrt()
    }

    /// Fraction of the variance of the nonlinearity that an offset does not absorb over a span of distances (m).
    fn share_beyond_offset(&self, span_m: f64) -> f64 {
        // The distance x = t span of two uniformly distributed points has the density 2 (1 - t).
        const STEPS: usize = 200;
        let mean = (0..STEPS).map(|step| {
            let t = (step as f64 + 0.5) / STEPS as f64;
            let at = t * span_m / self.linearity_length_m;
            2.0 * (1.0 - t) * (-0.5 * at * at).exp() / STEPS as f64
        });
        (1.0 - mean.sum::<f64>()).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use crate::json::parse_versioned_toml;

    use super::*;

    fn sensor(rest: &str) -> Sensor {
        let text = format!("format = \"tautline-sensor\"\nversion = 1\nname = \"s\"\n{rest}");
        let read = parse_versioned_toml(text.as_bytes(), "s.toml");
        read.expect("a sensor").value
    }

    #[test]
    fn the_random_part_grows_piece_by_piece() {
        let leica = sensor(
            "random_sd_m = 5e-4\ngrowth = [{from_m = 10, sd_per_m = 12.5e-6}, {from_m = 30, sd_per_m = 50e-6}]",
        );
        for (distance, sd) in [(1.0, 5e-4), (10.0, 5e-4), (30.0, 7.5e-4), (50.0, 1.75e-3)] {
            assert!(
                (leica.random_sd_at(distance) - sd).abs() < 1e-12,
                "{distance}"
            );
        }
    }

    #[test]
    fn an_offset_takes_a_slow_deviation_and_leaves_a_fast_one() {
        let bent = |length: f64| {
            let rest =
                format!("random_sd_m = 1e-9\nlinearity_sd_m = 1e-3\nlinearity_length_m = {length}");
            sensor(&rest).reading_sd_m([0.5, 1.5])
        };
        assert!(bent(100.0) < 1e-5);
        assert!((bent(0.001) - 1e-3).abs() < 1e-5);
        let [slow, fast] = [1.0, 0.3].map(bent);
        assert!(slow < fast && fast < 1e-3);
    }
}
