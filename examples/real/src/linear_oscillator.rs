//! A mass on a spring and a damper, all linear.

use latsch::model::{Model, Table, input, output, parameter};
use latsch::{Result, real};
use serde::{Deserialize, Serialize};

/// m x'' + d x' + k x = F + F_0, exact for a force that is linear over a step.
#[derive(Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct LinearOscillator {
    mass: f64,
    damping: f64,
    stiffness: f64,
    offset: f64,
    gain: f64,
    force: f64,
    position: f64,
    velocity: f64,
    /// The force at the end of the last step \[N\].
    force_before: f64,
    /// The step of a whole `step_size`.
    whole: Step,
}

/// The rows of position and velocity of exp(Z h), where z = (x, v, a, b), x' = v, m v' = -k x - d v + a, a' = b, b' = 0:
/// the state after h seconds by the state before, the force then and its rate.
type Step = [[f64; 4]; 2];

type Matrix = [[f64; 4]; 4];

const IDENTITY: Matrix =
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..4).map(|k| a[i][k] * b[k][j]).sum()))
}

impl LinearOscillator {
    /// The exact step of `h` seconds, by the series of the exponential function for h / 2^n and n squarings.
    fn step_of(&self, h: f64) -> Step {
        // so many halvings that an exponent is below 1/4, and few for anything that a run can resolve
        let fastest = (self.damping / self.mass).max((self.stiffness / self.mass).sqrt());
        let (mut halvings, mut parts) = (0, 1.0);
        while halvings < 60 && parts < 4.0 * fastest * h {
            (halvings, parts) = (halvings + 1, 2.0 * parts);
        }
        let part = h / parts;
        // scaled to the time unit `part`, so that all entries are of one size
        let (k, d) = (self.stiffness / self.mass * part * part, self.damping / self.mass * part);
        let z: Matrix =
            [[0.0, 1.0, 0.0, 0.0], [-k, -d, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.0, 0.0]];
        let (mut sum, mut term) = (IDENTITY, IDENTITY);
        for order in 1..=14 {
            term = product(&term, &z);
            for (row, terms) in sum.iter_mut().zip(&mut term) {
                for (value, term) in row.iter_mut().zip(terms) {
                    *term /= f64::from(order);
                    *value += *term;
                }
            }
        }
        for _ in 0..halvings {
            sum = product(&sum, &sum);
        }
        // back to seconds: z was (x, v part, a part^2 / m, b part^3 / m)
        let scale = [1.0, part, part * part / self.mass, part * part * part / self.mass];
        std::array::from_fn(|i| std::array::from_fn(|j| sum[i][j] * scale[j] / scale[i]))
    }

    fn total_force(&self) -> f64 {
        self.gain * self.force + self.offset
    }
}

impl Model for LinearOscillator {
    const NAME: &'static str = "linear-oscillator";
    const DESCRIPTION: &'static str = "A mass on a linear spring and a linear damper under a force";
    fn variables() -> Table<Self> {
        Table::new([
            parameter("mass", "kg", real!(mass), 1.0, "Mass").range(1e-9, 1e9),
            parameter("damping", "N.s/m", real!(damping), 1.0, "Damping, force by velocity").range(0.0, 1e9),
            parameter("stiffness", "N/m", real!(stiffness), 100.0, "Stiffness, force by position")
                .range(1e-9, 1e12),
            parameter("offset", "N", real!(offset), 0.0, "Constant force besides the input").range(-1e6, 1e6),
            parameter("gain", "1", real!(gain), 1.0, "Force on the mass by the input").range(-1e6, 1e6),
            input("force", "N", real!(force), 0.0, "Force on the mass"),
            output("position", "m", real!(position), "Position of the mass, from where the spring is free"),
            output("velocity", "m/s", real!(velocity), "Velocity of the mass"),
        ])
    }
    const COMMUNICATION_STEP: f64 = 4.096e-4;
    const STOP_TIME: f64 = 10.0;

    // exact at any step; this one is for forces that are added to the input and follow the motion
    fn step_size(&self) -> f64 {
        2.048e-4
    }

    fn initialize(&mut self) -> Result<()> {
        self.position = self.total_force() / self.stiffness; // at rest
        self.velocity = 0.0;
        self.tune()?;
        self.force_before = self.total_force();
        Ok(())
    }

    fn tune(&mut self) -> Result<()> {
        self.whole = self.step_of(self.step_size());
        Ok(())
    }

    fn step(&mut self, length: f64) -> Result<()> {
        let step = if length == self.step_size() { self.whole } else { self.step_of(length) };
        let force = self.total_force();
        let state = [self.position, self.velocity, self.force_before, (force - self.force_before) / length];
        let [position, velocity] = step.map(|row| row.iter().zip(&state).map(|(a, b)| a * b).sum());
        (self.position, self.velocity, self.force_before) = (position, velocity, force);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use latsch::model::{Native, Settings, Slave};

    type Oscillator = Native<LinearOscillator>;

    fn oscillator(values: &[(&str, f64)]) -> Oscillator {
        let mut slave = Oscillator::new(&Settings::default()).unwrap();
        set(&mut slave, values);
        slave.start(0.0, None).unwrap();
        slave.finish_start().unwrap();
        slave
    }

    fn set(slave: &mut Oscillator, values: &[(&str, f64)]) {
        for (name, value) in values {
            let index = slave.interface().find(name).unwrap();
            slave.set(index, *value).unwrap();
        }
    }

    fn get(slave: &mut Oscillator, name: &str) -> f64 {
        let index = slave.interface().find(name).unwrap();
        slave.get(index).unwrap()
    }

    /// m x'' + d x' + k x = b t from rest at zero, in closed form (underdamped).
    fn under_a_ramp(mass: f64, damping: f64, stiffness: f64, rate: f64, t: f64) -> f64 {
        let (omega2, decay) = (stiffness / mass, 0.5 * damping / mass);
        let omega = (omega2 - decay * decay).sqrt();
        let offset = rate * damping / (stiffness * stiffness);
        let sine = (offset * decay - rate / stiffness) / omega;
        rate / stiffness * t - offset
            + (-decay * t).exp() * (offset * (omega * t).cos() + sine * (omega * t).sin())
    }

    #[test]
    fn a_ramp_is_exact_however_time_is_cut() {
        let (mass, damping, stiffness, rate) = (5.4e-6, 2.2e-4, 0.99, 3.0);
        let parameters = [("mass", mass), ("damping", damping), ("stiffness", stiffness)];
        for steps in [1, 7, 100] {
            let mut slave = oscillator(&parameters);
            let force = slave.interface().find("force").unwrap();
            slave.set_rate(force, rate).unwrap();
            let length = 0.03 / f64::from(steps);
            for k in 0..steps {
                slave.step(f64::from(k) * length, length).unwrap();
            }
            let expected = under_a_ramp(mass, damping, stiffness, rate, 0.03);
            let position = get(&mut slave, "position");
            assert!(
                (position / expected - 1.0).abs() < 1e-9,
                "{steps} steps: {position} instead of {expected}"
            );
        }
    }

    #[test]
    fn it_rests_where_the_spring_holds_the_force() {
        let mut slave = oscillator(&[("stiffness", 50.0), ("force", 4.0), ("gain", 2.0), ("offset", -3.0)]);
        assert_eq!(get(&mut slave, "position"), 0.1);
        slave.step(0.0, 1.0).unwrap();
        assert!((get(&mut slave, "position") - 0.1).abs() < 1e-12);
        assert!(get(&mut slave, "velocity").abs() < 1e-12);
    }

    #[test]
    fn heavy_damping_creeps_and_does_not_overflow() {
        // d / m = 1e12 / s: exp(-k t / d) remains
        let mut slave = oscillator(&[("mass", 1e-9), ("damping", 1e3), ("stiffness", 1e3), ("force", 1e3)]);
        set(&mut slave, &[("force", 0.0)]);
        slave.step(0.0, 1.0).unwrap();
        let position = get(&mut slave, "position");
        // the force falls over one step of the model
        assert!((position - (-1.0f64).exp()).abs() < 1e-3, "{position}");
    }
}
