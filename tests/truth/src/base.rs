//! The machines: equations written from the physics, states, channels and the parameters that a base model has.

use crate::flat_track;
use crate::hidden::Influence;

/// A machine of which a base model exists.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Base {
    /// A mass on spring and damper.
    Oscillator,
    /// Two masses over a road.
    QuarterCar,
    /// A tire without transients.
    SteadyTire,
    /// A tire with relaxation on a wheel that spins.
    MagicWheel,
    /// A quarter of a vehicle that brakes with a recorded pressure.
    BrakeCorner,
    /// The same with an anti-lock controller.
    AbsBrake,
    /// The ring-and-brush tire that latsch ships, on a flat-track rig: equations in [`crate::flat_track`], not here.
    FlatTrack,
}

/// A channel or parameter: name, unit, and its usual size (for a parameter, what the base model starts from).
pub type Row = (&'static str, &'static str, f64);

/// What effects see of a machine at one instant.
#[derive(Debug, Clone, Copy, Default)]
pub struct Ports {
    /// Time since the start of the run \[s\].
    pub time: f64,
    /// Deflection \[m\] and its rate \[m/s\] of the spring in which forces hide.
    pub deflection: f64,
    /// Its rate.
    pub rate: f64,
    /// Stiffness of that spring \[N/m\].
    pub stiffness: f64,
    /// Travel speed \[m/s\].
    pub speed: f64,
    /// Wheel load \[N\].
    pub load: f64,
    /// Angle of the wheel \[rad\] and its rate.
    pub angle: f64,
    /// Rate of that angle \[rad/s\].
    pub spin: f64,
    /// Sliding speed in the contact \[m/s\].
    pub sliding: f64,
    /// Power lost in the contact \[W\].
    pub slide_power: f64,
    /// Slip, slip angle, camber.
    pub slip: f64,
    /// Slip angle \[rad\].
    pub slip_angle: f64,
    /// Camber \[rad\].
    pub camber: f64,
    /// Pressure at the pads \[Pa\].
    pub pressure: f64,
    /// Power of the brake \[W\].
    pub brake_power: f64,
    /// Distance travelled \[m\].
    pub distance: f64,
}

const GRAVITY: f64 = 9.81;
/// Below this speed of rotation a brake holds instead of turning the wheel \[rad/s\].
const STANDSTILL: f64 = 2.0;

impl Base {
    /// All machines.
    pub const ALL: [Self; 7] = [
        Self::Oscillator,
        Self::QuarterCar,
        Self::SteadyTire,
        Self::MagicWheel,
        Self::BrakeCorner,
        Self::AbsBrake,
        Self::FlatTrack,
    ];

    /// The name of its base model.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Oscillator => "oscillator",
            Self::QuarterCar => "quarter-car",
            Self::SteadyTire => "steady-tire",
            Self::MagicWheel => "magic-wheel",
            Self::BrakeCorner => "brake-corner",
            Self::AbsBrake => "abs-brake",
            Self::FlatTrack => flat_track::NAME,
        }
    }

    /// Inputs; the size is what they are at when nothing happens.
    #[must_use]
    pub fn inputs(self) -> &'static [Row] {
        match self {
            Self::Oscillator => &[("force", "N", 0.0)],
            Self::QuarterCar => &[("road_height", "m", 0.0), ("body_force", "N", 0.0)],
            Self::SteadyTire => &[
                ("slip", "1", 0.0),
                ("slip_angle", "rad", 0.0),
                ("camber", "rad", 0.0),
                ("load", "N", 4000.0),
                ("speed", "m/s", 20.0),
            ],
            Self::MagicWheel => &[
                ("brake_torque", "N.m", 0.0),
                ("slip_angle", "rad", 0.0),
                ("camber", "rad", 0.0),
                ("load", "N", 4000.0),
                ("speed", "m/s", 20.0),
            ],
            Self::BrakeCorner => {
                &[("line_pressure", "Pa", 0.0), ("load", "N", 4000.0), ("start_speed", "m/s", 30.0)]
            }
            Self::AbsBrake => {
                &[("driver_pressure", "Pa", 0.0), ("load", "N", 4000.0), ("start_speed", "m/s", 30.0)]
            }
            Self::FlatTrack => &flat_track::INPUTS,
        }
    }

    /// Measured channels; the size is the usual deviation from the mean.
    #[must_use]
    pub fn outputs(self) -> &'static [Row] {
        match self {
            Self::Oscillator => {
                &[("position", "m", 0.015), ("velocity", "m/s", 0.2), ("acceleration", "m/s2", 5.0)]
            }
            Self::QuarterCar => &[
                ("body_acceleration", "m/s2", 1.5),
                ("wheel_acceleration", "m/s2", 12.0),
                ("suspension_deflection", "m", 0.015),
                ("suspension_velocity", "m/s", 0.25),
                ("wheel_load", "N", 900.0),
            ],
            Self::SteadyTire | Self::MagicWheel => &[
                ("force_x", "N", 1000.0),
                ("force_y", "N", 1500.0),
                ("moment_z", "N.m", 25.0),
                ("wheel_speed", "rad/s", 20.0),
                ("wheel_angle", "rad", 1.0),
            ],
            Self::BrakeCorner | Self::AbsBrake => &[
                ("vehicle_speed", "m/s", 5.0),
                ("wheel_speed", "rad/s", 20.0),
                ("pressure", "Pa", 1e6),
                ("brake_torque", "N.m", 300.0),
                ("slip", "1", 0.03),
            ],
            Self::FlatTrack => &flat_track::OUTPUTS,
        }
    }

    /// Parameters with the start values of the base model.
    #[must_use]
    pub fn parameters(self) -> &'static [Row] {
        match self {
            Self::Oscillator => {
                &[("mass", "kg", 10.0), ("stiffness", "N/m", 4000.0), ("damping", "N.s/m", 80.0)]
            }
            Self::QuarterCar => &[
                ("body_mass", "kg", 350.0),
                ("wheel_mass", "kg", 45.0),
                ("suspension_stiffness", "N/m", 25e3),
                ("suspension_damping", "N.s/m", 1800.0),
                ("tire_stiffness", "N/m", 2e5),
            ],
            Self::SteadyTire => &[
                ("friction", "1", 1.0),
                ("slip_stiffness", "1", 20.0),
                ("cornering_stiffness", "1/rad", 15.0),
                ("shape", "1", 1.4),
                ("trail", "m", 0.03),
                ("camber_moment", "m/rad", 0.01),
                ("rolling_radius", "m", 0.32),
            ],
            Self::MagicWheel => &[
                ("friction", "1", 1.0),
                ("slip_stiffness", "1", 20.0),
                ("cornering_stiffness", "1/rad", 15.0),
                ("shape", "1", 1.4),
                ("trail", "m", 0.03),
                ("camber_moment", "m/rad", 0.01),
                ("radius", "m", 0.32),
                ("spin_inertia", "kg.m2", 1.2),
                ("slip_relaxation_length", "m", 0.2),
                ("relaxation_length", "m", 0.5),
            ],
            Self::BrakeCorner => &BRAKE,
            Self::AbsBrake => &ABS,
            Self::FlatTrack => &flat_track::PARAMETERS,
        }
    }

    /// The start values of the parameters.
    #[must_use]
    pub fn defaults(self) -> Vec<f64> {
        self.parameters().iter().map(|row| row.2).collect()
    }

    /// Where a parameter stands.
    #[must_use]
    pub fn parameter(self, name: &str) -> usize {
        self.parameters().iter().position(|row| row.0 == name).unwrap_or(0)
    }

    /// Where a measured channel stands.
    #[must_use]
    pub fn output(self, name: &str) -> usize {
        self.outputs().iter().position(|row| row.0 == name).unwrap_or(0)
    }

    /// The state at the start, for inputs `u`.
    #[must_use]
    pub fn start(self, p: &[f64], u: &[f64]) -> Vec<f64> {
        match self {
            Self::Oscillator => vec![u[0] / p[1], 0.0],
            Self::QuarterCar => {
                let wheel = u[0] + u[1] / p[4];
                vec![wheel + u[1] / p[2], wheel, 0.0, 0.0]
            }
            Self::SteadyTire => vec![0.0],
            Self::MagicWheel => vec![u[4] / p[6], 0.0, u[1], 0.0],
            Self::BrakeCorner => vec![u[2], u[2] / p[5], 0.0, 0.0, 0.0],
            Self::AbsBrake => vec![u[2], u[2] / p[5], 0.0, u[0].max(0.0), 0.0],
            Self::FlatTrack => Vec::new(),
        }
    }

    /// What effects see. `time` and `distance` are the caller's.
    #[must_use]
    pub fn ports(self, p: &[f64], u: &[f64], x: &[f64]) -> Ports {
        let none = Ports::default();
        match self {
            Self::Oscillator => Ports { deflection: x[0], rate: x[1], stiffness: p[1], ..none },
            Self::QuarterCar => Ports {
                deflection: x[0] - x[1],
                rate: x[2] - x[3],
                stiffness: p[2],
                load: (p[0] + p[1]) * GRAVITY + p[4] * (u[0] - x[1]),
                ..none
            },
            Self::SteadyTire => {
                let sliding = u[4] * libm::hypot(u[0], libm::tan(u[1]));
                let [fx, fy, _] = tire(p, u[0], u[1], u[2], u[3], &Influence::default());
                Ports {
                    speed: u[4],
                    load: u[3].max(0.0),
                    angle: x[0],
                    spin: u[4] * (1.0 + u[0]) / p[6],
                    sliding,
                    slide_power: sliding * libm::hypot(fx, fy),
                    slip: u[0],
                    slip_angle: u[1],
                    camber: u[2],
                    ..none
                }
            }
            Self::MagicWheel => {
                let sliding = u[4] * libm::hypot(x[1], libm::tan(x[2]));
                let [fx, fy, _] = tire(p, x[1], x[2], u[2], u[3], &Influence::default());
                Ports {
                    speed: u[4],
                    load: u[3].max(0.0),
                    angle: x[3],
                    spin: x[0],
                    sliding,
                    slide_power: sliding * libm::hypot(fx, fy),
                    slip: x[1],
                    slip_angle: x[2],
                    camber: u[2],
                    pressure: u[0],
                    brake_power: u[0] * x[0],
                    ..none
                }
            }
            Self::BrakeCorner | Self::AbsBrake => {
                let pressure = if self == Self::AbsBrake { x[3] } else { u[0] }.max(0.0);
                let sliding = (x[0] * x[2]).abs();
                Ports {
                    speed: x[0],
                    load: u[1].max(0.0),
                    angle: x[4],
                    spin: x[1],
                    sliding,
                    slide_power: sliding * u[1] * 0.7,
                    slip: x[2],
                    pressure,
                    brake_power: p[1] * pressure * x[1],
                    ..none
                }
            }
            Self::FlatTrack => none,
        }
    }

    /// The rates of the states.
    pub fn slope(self, p: &[f64], u: &[f64], x: &[f64], by: &Influence, dx: &mut [f64]) {
        match self {
            Self::Oscillator => {
                dx[0] = x[1];
                dx[1] = (u[0] + by.push - p[1] * x[0] - p[2] * x[1] - by.force) / (p[0] * by.mass);
            }
            Self::QuarterCar => {
                let [body, wheel] = quarter_car(p, u, x, by);
                dx.copy_from_slice(&[x[2], x[3], body, wheel]);
            }
            Self::SteadyTire => dx[0] = u[4] * (1.0 + u[0]) / p[6],
            Self::MagicWheel => {
                let [fx, ..] = tire(p, x[1], x[2] + by.slip_angle, u[2], u[3], by);
                let brake = by.brake * u[0] * libm::tanh(x[0] / STANDSTILL) + by.axle_torque;
                dx[0] = (-p[6] * fx - brake) / p[7];
                dx[1] = (p[6] * x[0] - u[4] - u[4].abs() * x[1]) / p[8];
                dx[2] = u[4].abs() * (u[1] - x[2]) / p[9];
                dx[3] = x[0];
            }
            Self::BrakeCorner | Self::AbsBrake => {
                let fx = brake_force(p, u, x, by);
                let pressure = if self == Self::AbsBrake { x[3] } else { u[0] };
                let torque = brake_torque(p, pressure, x, by);
                dx[0] = fx / p[0];
                dx[1] = (-p[5] * fx - torque - by.axle_torque) / p[6];
                dx[2] = (p[5] * x[1] - x[0] - x[0].abs() * x[2]) / p[7];
                dx[3] = if self == Self::AbsBrake { anti_lock(p, u, x) } else { 0.0 };
                dx[4] = x[1];
            }
            Self::FlatTrack => {}
        }
    }

    /// The measured channels, as an ideal sensor would have them.
    #[must_use]
    pub fn measure(self, p: &[f64], u: &[f64], x: &[f64], by: &Influence) -> Vec<f64> {
        match self {
            Self::Oscillator => {
                let mut dx = [0.0; 2];
                self.slope(p, u, x, by, &mut dx);
                vec![x[0], x[1], dx[1]]
            }
            Self::QuarterCar => {
                let [body, wheel] = quarter_car(p, u, x, by);
                let load = tire_load(p, u, x, by) + (p[0] + p[1]) * GRAVITY;
                vec![body, wheel, x[0] - x[1], x[2] - x[3], load]
            }
            Self::SteadyTire => {
                let [fx, fy, mz] = tire(p, u[0], u[1] + by.slip_angle, u[2], u[3], by);
                vec![fx, fy, mz, u[4] * (1.0 + u[0]) / p[6], x[0]]
            }
            Self::MagicWheel => {
                let [fx, fy, mz] = tire(p, x[1], x[2] + by.slip_angle, u[2], u[3], by);
                vec![fx, fy, mz, x[0], x[3]]
            }
            Self::BrakeCorner | Self::AbsBrake => {
                let pressure = if self == Self::AbsBrake { x[3] } else { u[0] }.max(0.0);
                let slip = 1.0 - x[1] * p[5] / x[0].max(1.0);
                vec![x[0], x[1], pressure, brake_torque(p, pressure, x, by), slip]
            }
            Self::FlatTrack => Vec::new(),
        }
    }
}

const BRAKE: [Row; 8] = [
    ("mass", "kg", 400.0),
    ("brake_factor", "m3", 2.4e-4),
    ("friction", "1", 1.1),
    ("slip_stiffness", "1", 18.0),
    ("shape", "1", 1.4),
    ("radius", "m", 0.32),
    ("spin_inertia", "kg.m2", 1.3),
    ("slip_relaxation_length", "m", 0.2),
];

const ABS: [Row; 13] = [
    BRAKE[0],
    BRAKE[1],
    BRAKE[2],
    BRAKE[3],
    ("shape", "1", 1.3),
    BRAKE[5],
    BRAKE[6],
    BRAKE[7],
    ("build_rate", "Pa/s", 6e7),
    ("dump_rate", "Pa/s", 9e7),
    ("slip_target", "1", 0.1),
    ("slip_width", "1", 0.05),
    ("controller_radius", "m", 0.32),
];

/// Force between tire and road beyond the static load: pulls without limit, unless contact can be lost.
fn tire_load(p: &[f64], u: &[f64], x: &[f64], by: &Influence) -> f64 {
    let force = p[4] * (u[0] - x[1]);
    if by.lifts { force.max(-(p[0] + p[1]) * GRAVITY) } else { force }
}

/// Accelerations of body and wheel (Newton's law for both).
fn quarter_car(p: &[f64], u: &[f64], x: &[f64], by: &Influence) -> [f64; 2] {
    let strut = p[2] * (x[0] - x[1]) + p[3] * (x[2] - x[3]) + by.force;
    let body = (u[1] + by.push - strut) / (p[0] * by.mass);
    [body, (strut + tire_load(p, u, x, by)) / p[1]]
}

/// Magic Formula of the normalised slip vector, with E = 0, alike in both directions.
fn tire(p: &[f64], slip: f64, slip_angle: f64, camber: f64, load: f64, by: &Influence) -> [f64; 3] {
    let (mu, fz) = (p[0] * by.friction, load.max(0.0));
    let normalised = [p[1] * slip / mu, -p[2] * by.cornering * libm::tan(slip_angle) / mu];
    let rho = libm::hypot(normalised[0], normalised[1]);
    let size = mu * fz * libm::sin(p[3] * libm::atan(rho / p[3]));
    let share = if rho > 0.0 { size / rho } else { 0.0 };
    let (fx, fy) = (share * normalised[0], share * normalised[1]);
    [fx, fy, p[5] * fz * camber - p[4] * fy / (1.0 + rho * rho)]
}

/// Longitudinal force of the braked tire.
fn brake_force(p: &[f64], u: &[f64], x: &[f64], by: &Influence) -> f64 {
    let mu = p[2] * by.friction;
    let rho = p[3] * x[2] / mu;
    mu * u[1].max(0.0) * libm::sin(p[4] * libm::atan(rho / p[4]))
}

fn brake_torque(p: &[f64], pressure: f64, x: &[f64], by: &Influence) -> f64 {
    by.brake * p[1] * pressure.max(0.0) * libm::tanh(x[1] / STANDSTILL)
}

/// Rate of the pressure under the anti-lock controller.
fn anti_lock(p: &[f64], u: &[f64], x: &[f64]) -> f64 {
    let (build, dump, target, width, radius) = (p[8], p[9], p[10], p[11], p[12]);
    let slip = 1.0 - x[1] * radius / x[0].max(1.0);
    let valve = ((target - slip) / width).clamp(-1.0, 1.0);
    let rate = valve * if valve > 0.0 { build } else { dump };
    let (to_driver, to_nothing) = ((u[0].max(0.0) - x[3]) / 0.01, -x[3] / 0.01);
    rate.max(to_nothing).min(to_driver)
}
