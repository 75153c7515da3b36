//! What is said of a stop in numbers.

use latsch::recording::Recording;
use latsch::{Error, Result};

/// Below this speed the vehicle stands \[m/s\].
const STANDSTILL: f64 = 0.1;
/// Locking counts above this speed \[m/s\]: below it an anti-lock system may let the wheel stand.
const LOCK_SPEED: f64 = 2.0;
/// Beyond this slip a wheel counts as locked: it turns at less than a fifth of the free speed.
const LOCK_SLIP: f64 = -0.8;

/// From the driver's first pressure to standstill.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Way {
    /// When the driver begins to brake \[s\]: the last sample without pressure.
    pub start: f64,
    /// When the vehicle stands \[s\]: the first sample below 0.1 m/s.
    pub end: f64,
    /// Speed at the start \[m/s\].
    pub speed: f64,
    /// From start to end \[m\].
    pub distance: f64,
    /// Speed squared over twice the distance \[m/s²\].
    pub deceleration: f64,
    /// The samples at start and end.
    pub samples: [usize; 2],
}

impl Way {
    /// The way of a stop: channels of the driver's pressure, the vehicle's speed and its place.
    ///
    /// # Errors
    /// Channels that are not there, no braking, or no standstill.
    pub fn of(recording: &Recording, [driver, speed, place]: [&str; 3]) -> Result<Self> {
        let time = &recording.time;
        let driver = recording.channel_in(driver, "Pa")?;
        let speed = recording.channel_in(speed, "m/s")?;
        let place = recording.channel_in(place, "m")?;
        let fail = |what: &str| Error::numeric(format!("{}: {what}", recording.source));
        let start = driver
            .iter()
            .position(|p| *p > 0.0)
            .and_then(|first| first.checked_sub(1))
            .ok_or_else(|| fail("the driver does not begin to brake"))?;
        let end = (start..time.len()).find(|k| speed[*k] < STANDSTILL).ok_or_else(|| {
            fail(&format!("the vehicle does not stand at the end, {} s", time[time.len() - 1]))
        })?;
        let distance = place[end] - place[start];
        Ok(Self {
            start: time[start],
            end: time[end],
            speed: speed[start],
            distance,
            deceleration: 0.5 * speed[start] * speed[start] / distance,
            samples: [start, end],
        })
    }

    /// From start to standstill \[s\].
    pub fn duration(&self) -> f64 {
        self.end - self.start
    }
}

/// A stop in numbers, from the channels of a corner (`corner.`) and its brake (`brake.`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StopFigures {
    /// Where and when.
    pub way: Way,
    /// Longest time with a slip beyond -80 % while the vehicle is faster than 2 m/s \[s\].
    pub locked: f64,
    /// Share of the samples above 2 m/s in which every bristle in contact slides.
    pub all_slide: f64,
    /// Heat of the brake \[J\].
    pub brake_heat: f64,
    /// Heat of the contact patch \[J\].
    pub tire_heat: f64,
}

impl StopFigures {
    /// The numbers of a run.
    ///
    /// # Errors
    /// Those of [`Way::of`].
    pub fn of(recording: &Recording) -> Result<Self> {
        let channel = |name: &str, unit: &str| recording.channel_in(name, unit);
        let way =
            Way::of(recording, ["brake.driver_pressure", "corner.vehicle_speed", "corner.vehicle_distance"])?;
        let time = &recording.time;
        let speed = channel("corner.vehicle_speed", "m/s")?;
        let slip = channel("corner.slip", "1")?;
        let sliding = channel("corner.sliding_share", "1")?;
        let (brake_heat, tire_heat) =
            (channel("corner.brake_energy", "J")?, channel("corner.friction_energy", "J")?);
        let [start, end] = way.samples;
        let (mut locked, mut longest, mut fast, mut all) = (0.0_f64, 0.0_f64, 0_u32, 0_u32);
        for k in start + 1..=end {
            if speed[k] <= LOCK_SPEED {
                break;
            }
            locked = if slip[k] < LOCK_SLIP { locked + time[k] - time[k - 1] } else { 0.0 };
            longest = longest.max(locked);
            fast += 1;
            all += u32::from(sliding[k] > 1.0 - 1e-9);
        }
        Ok(Self {
            way,
            locked: longest,
            all_slide: f64::from(all) / f64::from(fast.max(1)),
            brake_heat: brake_heat[end] - brake_heat[start],
            tire_heat: tire_heat[end] - tire_heat[start],
        })
    }

    /// Share of the heat that is made in the contact patch.
    pub fn tire_share(&self) -> f64 {
        self.tire_heat / (self.tire_heat + self.brake_heat)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use latsch::recording::Channel;

    /// 20 m/s for 0.5 s, then 10 m/s²; locked from 1 s to 1.5 s.
    pub fn stop() -> Recording {
        let time: Vec<f64> = (0..300).map(|k| f64::from(k) * 0.01).collect();
        let braking = |t: f64| (t - 0.5).clamp(0.0, 2.0);
        let channel = |name: &str, unit: &str, f: &dyn Fn(f64) -> f64| Channel {
            name: name.into(),
            unit: unit.into(),
            values: time.iter().map(|t| f(*t)).collect(),
        };
        let channels = vec![
            channel("brake.driver_pressure", "bar", &|t| 100.0 * braking(t)),
            channel("corner.vehicle_speed", "km/h", &|t| 3.6 * (20.0 - 10.0 * braking(t))),
            channel("corner.vehicle_distance", "m", &|t| 20.0 * t - 5.0 * braking(t) * braking(t)),
            channel("corner.slip", "1", &|t| if (0.995..1.495).contains(&t) { -1.0 } else { -0.1 }),
            channel("corner.sliding_share", "1", &|t| if t < 1.395 { 1.0 } else { 0.4 }),
            channel("corner.brake_energy", "J", &|t| 3.0 * braking(t)),
            channel("corner.friction_energy", "J", &|t| braking(t)),
        ];
        Recording { time, channels, source: "stop".into() }
    }

    #[test]
    fn a_constant_deceleration_in_closed_form() {
        let f = StopFigures::of(&stop()).unwrap();
        let way = f.way;
        assert_eq!((way.start, way.speed), (0.5, 20.0));
        // it stands when below 0.1 m/s, 10 ms before it would
        assert!((way.end - 2.5).abs() < 0.011 && (way.distance - 20.0).abs() < 0.01, "{f:?}");
        assert!((way.deceleration - 10.0).abs() < 0.01);
        assert!((f.locked - 0.5).abs() < 1e-9, "{}", f.locked);
        // of the 1.8 s above 2 m/s, 0.9 s
        assert!((f.all_slide - 0.5).abs() < 0.01, "{}", f.all_slide);
        assert!((f.tire_share() - 0.25).abs() < 1e-12);
    }

    #[test]
    fn a_run_without_a_stop_is_an_error() {
        let mut going = stop();
        going.channels[1].values.fill(10.0);
        let message = StopFigures::of(&going).unwrap_err().to_string();
        assert!(message.contains("does not stand") && message.contains("2.99 s"), "{message}");
        let mut rolling = stop();
        rolling.channels[0].values.fill(0.0);
        assert!(StopFigures::of(&rolling).unwrap_err().to_string().contains("does not begin"));
    }
}
