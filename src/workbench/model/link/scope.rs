//! Latest readings of the controller, decimated as they arrive: memory and drawing time do not grow with the run.

use tautline_core::robot::Robot;
use tautline_link::Sample;
use tautline_link::measuring::{MeasuringOptions, Rates, SettlingWindow};

/// Time span (s), by the controller's clock.
pub const SPAN_S: f64 = 30.0;
/// A reading older than the latest by less arrived out of order (s); by more, the clock of the controller was reset.
const OVERTAKEN_S: f64 = 1.0;
/// Number of time intervals, for each of which the minimum and maximum are stored.
const BINS: usize = 300;
const BIN_S: f64 = SPAN_S / BINS as f64;

/// Channel of the scope.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Channel {
    /// Tension of a cable (N).
    Tension(usize),
    /// Revolutions of a winch since home.
    Revolutions(usize),
    /// Laser distance (m).
    Laser,
    /// Rate of change of a quantity, as a multiple of its limit at standstill.
    Speed(Reading),
}

/// Quantity whose rate decides whether the robot stands still.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reading {
    /// Cable lengths.
    Length,
    Tension,
    /// Laser distance.
    Laser,
}

impl Reading {
    pub const ALL: [Self; 3] = [Self::Length, Self::Tension, Self::Laser];

    /// Rate of this quantity (m/s, N/s, m/s).
    #[must_use]
    pub fn of(self, rates: &Rates) -> f64 {
        match self {
            Self::Length => rates.length_m_per_s,
            Self::Tension => rates.tension_n_per_s,
            Self::Laser => rates.laser_m_per_s,
        }
    }
}

/// Minimum and maximum of a channel in a time interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// Middle of the interval (s), relative to the latest reading, hence negative.
    pub time_s: f64,
    /// Minimum and maximum.
    pub values: [f64; 2],
}

/// Extent of an interval without readings.
const NOTHING: [f32; 2] = [f32::INFINITY, f32::NEG_INFINITY];

/// Readings of the last [`SPAN_S`].
#[derive(Debug, Clone)]
pub struct Scope {
    robot: Robot,
    limits: Rates,
    settle_time_s: f64,
    window: SettlingWindow,
    rates: Option<Rates>,
    /// Number of the interval in each slot of the ring buffer.
    numbers: [i64; BINS],
    /// Extents of all channels in each slot of the ring buffer.
    extents: Vec<[f32; 2]>,
    latest_s: Option<f64>,
    readings: u64,
}

impl Scope {
    /// Scope of a robot, without readings.
    #[must_use]
    pub fn new(robot: &Robot) -> Self {
        let options = MeasuringOptions::of(robot);
        Self {
            limits: options.still,
            settle_time_s: options.settle_time_s,
            window: SettlingWindow::default(),
            rates: None,
            numbers: [i64::MIN; BINS],
            extents: vec![NOTHING; BINS * channels(robot)],
            latest_s: None,
            readings: 0,
            robot: robot.clone(),
        }
    }

    #[must_use]
    pub fn cables(&self) -> usize {
        self.robot.cable_count()
    }

    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.robot.cables.iter().map(|cable| cable.name.as_str())
    }

    /// Number of readings.
    #[must_use]
    pub fn readings(&self) -> u64 {
        self.readings
    }

    /// Number of the current time interval, which changes when a new picture is worthwhile; `None` before the first
    /// reading.
    #[must_use]
    pub fn moment(&self) -> Option<i64> {
        self.latest_s
            .map(|latest_s| (latest_s / BIN_S).floor() as i64)
    }

    /// Rates of change and their limits at standstill; `None` before there are enough readings.
    #[must_use]
    pub fn rates(&self) -> Option<(Rates, Rates)> {
        Some((self.rates?, self.limits))
    }

    /// Adds a reading. One out of order is dropped; after a reset of the clock the scope starts again.
    pub fn record(&mut self, sample: &Sample) {
        if !sample.time_s.is_finite() {
            return;
        }
        if let Some(latest_s) = self.latest_s
            && sample.time_s <= latest_s
        {
            if latest_s - sample.time_s < OVERTAKEN_S {
                return;
            }
            self.numbers.fill(i64::MIN);
            self.window.clear();
            self.rates = None;
        }
        self.latest_s = Some(sample.time_s);
        self.readings += 1;
        self.window.push(sample.clone(), self.settle_time_s);
        let number = (sample.time_s / BIN_S).floor() as i64;
        let place = number.rem_euclid(BINS as i64) as usize;
        if self.numbers[place] != number {
            self.numbers[place] = number;
            let of_place = self.range(place);
            self.extents[of_place].fill(NOTHING);
            let settled = self
                .window
                .settled(&self.robot, &self.limits, self.settle_time_s);
            self.rates = settled.map(|settled| settled.rates);
        }
        for index in 0..self.cables() {
            let revolutions = sample.revolutions.get(index).copied();
            self.widen(place, Channel::Revolutions(index), revolutions);
            let sensor = self.robot.cables[index].force_sensor;
            let force = sample.force_n.get(index);
            let tension = sensor.zip(force).map(|(s, force)| s.tension_n(*force));
            self.widen(place, Channel::Tension(index), tension);
        }
        self.widen(place, Channel::Laser, sample.laser_m);
        for reading in Reading::ALL {
            let limit = reading.of(&self.limits);
            let speed = self.rates.map(|rates| reading.of(&rates) / limit);
            self.widen(place, Channel::Speed(reading), speed);
        }
    }

    /// Extents of a channel, oldest first.
    pub fn extents(&self, channel: Channel) -> impl Iterator<Item = Extent> + '_ {
        let column = self.column(channel);
        let latest_s = self.latest_s.unwrap_or(0.0);
        let last = (latest_s / BIN_S).floor() as i64;
        let numbers = last + 1 - BINS as i64..=last;
        numbers.filter_map(move |number| {
            let place = number.rem_euclid(BINS as i64) as usize;
            let [least, greatest] = *self.extents.get(self.range(place).start + column)?;
            let is_read = self.numbers[place] == number && least <= greatest;
            is_read.then(|| Extent {
                time_s: ((number as f64 + 0.5) * BIN_S - latest_s).min(0.0),
                values: [f64::from(least), f64::from(greatest)],
            })
        })
    }

    fn widen(&mut self, place: usize, channel: Channel, value: Option<f64>) {
        let Some(value) = value.filter(|value| value.is_finite()) else {
            return;
        };
        let at = self.range(place).start + self.column(channel);
        let [least, greatest] = &mut self.extents[at];
        *least = least.min(value as f32);
        *greatest = greatest.max(value as f32);
    }

    /// Range of a slot of the ring buffer in `extents`.
    fn range(&self, place: usize) -> std::ops::Range<usize> {
        let count = channels(&self.robot);
        place * count..(place + 1) * count
    }

    fn column(&self, channel: Channel) -> usize {
        let cables = self.cables();
        match channel {
            Channel::Tension(index) => index.min(cables),
            Channel::Revolutions(index) => cables + index.min(cables),
            Channel::Laser => 2 * cables,
            Channel::Speed(reading) => 2 * cables + 1 + reading as usize,
        }
    }
}

fn channels(robot: &Robot) -> usize {
    2 * robot.cable_count() + 1 + Reading::ALL.len()
}

#[cfg(test)]
mod tests {
    use tautline_core::robot::presets;

    use super::*;

    fn sample(time_s: f64, laser_m: Option<f64>) -> Sample {
        Sample {
            time_s,
            revolutions: vec![time_s; 8],
            force_n: vec![100.0; 8],
            laser_m,
            temperature_c: None,
            swivel_rad: None,
            inclination_rad: None,
            commanded: None,
            started: None,
        }
    }

    fn scope() -> Scope {
        Scope::new(&presets::find("mini").expect("a preset").robot)
    }

    #[test]
    fn extremes_survive_and_memory_does_not_grow() {
        let mut scope = scope();
        let size = scope.extents.capacity();
        for k in 0..20_000 {
            let spike = if k == 19_500 { 2.0 } else { 1.0 };
            scope.record(&sample(f64::from(k) * 0.02, Some(spike)));
        }
        assert_eq!(scope.extents.capacity(), size);
        assert_eq!(scope.readings(), 20_000);
        let laser: Vec<Extent> = scope.extents(Channel::Laser).collect();
        assert_eq!(laser.len(), BINS);
        assert!(laser.windows(2).all(|pair| pair[0].time_s < pair[1].time_s));
        assert!(laser[0].time_s >= -SPAN_S && laser[BINS - 1].time_s <= 0.0);
        let spikes: Vec<&Extent> = laser.iter().filter(|one| one.values[1] > 1.5).collect();
        assert_eq!(spikes.len(), 1, "one reading of 1500 is still seen");
        assert!((spikes[0].time_s + 499.0 * 0.02).abs() < BIN_S);
    }

    #[test]
    fn speed_is_that_by_which_the_robot_counts_as_still() {
        let mut scope = scope();
        // Speed as a multiple of the limit, in revolutions per second.
        let per_revolution = scope.robot.cables[0].winch.cable_per_revolution_m();
        let speed = 4.0 * scope.limits.length_m_per_s / per_revolution;
        for k in 0..200 {
            let mut sample = sample(f64::from(k) * 0.02, None);
            sample.revolutions = vec![speed * sample.time_s; 8];
            scope.record(&sample);
        }
        let last = |channel| scope.extents(channel).last().map(|one| one.values[1]);
        let length = last(Channel::Speed(Reading::Length)).expect("a speed");
        assert!((length - 4.0).abs() < 1e-3, "{length}");
        assert_eq!(last(Channel::Speed(Reading::Tension)), Some(0.0));
        assert_eq!(last(Channel::Laser), None, "nothing was read");
        let tension = last(Channel::Tension(3)).expect("a tension");
        assert!((tension - 50.0).abs() < 1e-3, "{tension}");
    }

    #[test]
    fn a_clock_that_starts_again_begins_anew() {
        let mut scope = scope();
        scope.record(&sample(100.0, Some(1.0)));
        scope.record(&sample(1.0, Some(3.0)));
        let laser: Vec<[f64; 2]> = scope.extents(Channel::Laser).map(|e| e.values).collect();
        assert_eq!(laser, [[3.0, 3.0]]);
    }
}
