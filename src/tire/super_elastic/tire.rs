//! The super-elastic tire as rigs see it.

use super::coupling::Coupling;
use super::element::{Along, GAMMA};
use super::parameters::{Parameters, Prepared};
use super::ring::{Coefficients, RimInPlane, Ring, Rubber, Sums, along};
use super::stationary::{Bare, Stationary, at_rest, stationary};
use crate::mechanics::{Link, Motion, Wrench};
use crate::model::Table;
use crate::road::{Road, Window};
use crate::tire::brush::{adhesion, brush_force};
use crate::tire::relaxation::follow;
use crate::tire::{Carried, Cell, Ground, Plane, Rest, Tire, Vertical, check_upright};
use crate::{Error, Result, clone_in_place};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Camber beyond which the wheel has fallen over \[rad\]: the plane in which all of this happens stands upright.
const MAX_CAMBER: f64 = 0.6;
const UNSETTLED: &str = "coupled elements do not find their balance within a step: coupling_stiffness or bending_stiffness is too large for step_size";
/// Below this speed the rolling resistance, which turns with the direction of travel, fades out \[m/s\].
const CREEP: f64 = 0.05;

/// The super-elastic tire: parameters and state.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct SuperElastic {
    /// Name of the tire, for reports.
    pub name: String,
    /// Parameters.
    pub parameters: Parameters,
    prepared: Prepared,
    /// What changes.
    pub state: State,
    window: Window,
}

clone_in_place!(SuperElastic { name, parameters, prepared, state, window });

/// State of the tire, and what the last step found.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct State {
    /// The elements.
    pub ring: Ring,
    /// Coefficients of an element that hold now.
    pub coefficients: Coefficients,
    /// Load behind the lag of the characteristic \[N\].
    pub load: f64,
    /// Longitudinal slip behind its lag.
    pub slip: f64,
    /// Slip of the wheel (2-4).
    pub wheel_slip: f64,
    /// Height of the rim's centre over the road, along the road's normal \[m\].
    pub height: f64,
    /// Force of the brush along the road \[N\].
    pub traction: f64,
    /// Rolling resistance \[N\]; positive where it holds back a wheel that rolls forward.
    pub resistance: f64,
    /// Spin angle of the rim \[rad\].
    pub angle: f64,
    /// Acceleration of its centre forward and up \[m/s²\].
    pub acceleration: [f64; 2],
    /// Acceleration of its spin \[rad/s²\].
    pub spin_acceleration: f64,
    /// Cosine and sine of its heading.
    pub heading: [f64; 2],
    /// Sums over the elements.
    pub sums: Sums,
    /// Force and moment on the rim about its centre, frame 0.
    pub on_rim: Wrench<f64>,
    /// Power that the sliding of the brush takes \[W\].
    pub power_loss: f64,
    /// Energy lost in the contact since the start \[J\].
    pub energy_loss: f64,
}

clone_in_place!(State {
    ring,
    coefficients,
    load,
    slip,
    wheel_slip,
    height,
    traction,
    resistance,
    angle,
    acceleration,
    spin_acceleration,
    heading,
    sums,
    on_rim,
    power_loss,
    energy_loss
});

/// The rim as it moves in the wheel's plane, at an end of a step.
fn in_plane(rim: &Motion<f64>) -> (RimInPlane, [f64; 2]) {
    let (sin, cos) = libm::sincos(rim.angles.z);
    let rim = RimInPlane {
        height: rim.position.z,
        velocity: [rim.velocity.x * cos + rim.velocity.y * sin, rim.velocity.z],
        angle: rim.angles.y,
        spin: rim.rates.y + rim.rates.z * libm::sin(rim.angles.x),
        ..RimInPlane::default()
    };
    (rim, [cos, sin])
}

/// The rim at a share of a step of `dt` seconds: with a constant acceleration from the velocity before to that after, and what the
/// ends are off by that on a straight line. A rim that does not travel stays where it is while the road runs faster or slower.
fn between(before: &RimInPlane, after: &RimInPlane, share: f64, dt: f64, travels: bool) -> RimInPlane {
    let mix = |a: f64, b: f64| a + share * (b - a);
    let moved = |from: f64, to: f64, v0: f64, v1: f64| {
        let by_speed = dt * share * (v0 + 0.5 * share * (v1 - v0));
        from + by_speed + share * (to - from - 0.5 * dt * (v0 + v1))
    };
    let per = 1.0 / dt;
    let forward = if travels { (after.velocity[0] - before.velocity[0]) * per } else { 0.0 };
    RimInPlane {
        height: moved(before.height, after.height, before.velocity[1], after.velocity[1]),
        velocity: [0, 1].map(|i| mix(before.velocity[i], after.velocity[i])),
        acceleration: [forward, (after.velocity[1] - before.velocity[1]) * per],
        angle: moved(before.angle, after.angle, before.spin, after.spin),
        spin: mix(before.spin, after.spin),
        spin_acceleration: (after.spin - before.spin) * per,
    }
}

/// The road under the rim's centre in the wheel's plane.
struct Under {
    /// Distance of the rim's centre along the road's normal \[m\].
    height: f64,
    /// Unit vector along the road.
    along: [f64; 2],
    friction: f64,
}

fn under(rim: &RimInPlane, heading: [f64; 2], ground: &impl Ground, share: f64) -> Under {
    let point = ground.point(0.0, 0.0, share);
    let slope = point.slope[0] * heading[0] + point.slope[1] * heading[1];
    let cos = 1.0 / libm::sqrt(1.0 + slope * slope);
    Under { height: (rim.height - point.height) * cos, along: [cos, slope * cos], friction: point.friction }
}

impl SuperElastic {
    /// Takes over a stationary state for a rim that moves so.
    fn settle(&mut self, inside: &Stationary, rim: &RimInPlane) {
        let rolling = rim.spin * self.parameters.dynamic_radius(inside.height);
        let speed = rim.velocity[0];
        let faster = speed.abs().max(rolling.abs());
        self.state = State {
            ring: inside.ring.clone(),
            coefficients: inside.coefficients,
            sums: inside.sums,
            load: inside.load,
            slip: if faster > 0.0 { (rolling - speed) / faster } else { 0.0 },
            ..State::default()
        };
    }

    /// Takes the slip to the end of a step, and makes force and moment on the rim.
    fn pass_on(&mut self, rim: &RimInPlane, heading: [f64; 2], under: &Under, dt: f64) {
        let p = &self.parameters;
        let radius = p.dynamic_radius(under.height);
        let speed = rim.velocity[0] * under.along[0] + rim.velocity[1] * under.along[1];
        let rolling = rim.spin * radius;
        let [force_x, force_z] = p.on_rim(&self.state.sums);
        // what friction works on: the wheel load as printed, or what the road carries
        let [pressing_x, pressing_z] =
            if p.rim_force == 2 { self.state.sums.contact } else { [force_x, force_z] };
        let load = (pressing_z * under.along[0] - pressing_x * under.along[1]).max(0.0);
        let state = &mut self.state;
        state.height = under.height;
        (state.angle, state.heading) = (rim.angle, heading);
        (state.acceleration, state.spin_acceleration) = (rim.acceleration, rim.spin_acceleration);
        let faster = speed.abs().max(rolling.abs());
        state.wheel_slip = if faster > 0.0 { (rolling - speed) / faster } else { 0.0 };
        if load > 0.0 {
            let (sliding, rate) = match p.relaxation_rate {
                2 => (speed.abs() * state.wheel_slip, speed.abs()),
                _ => (rolling - speed, faster),
            };
            let length = p.relaxation_length;
            state.slip = follow(state.slip * length, sliding, rate, length, dt) / length;
        } else {
            state.slip = 0.0;
        }
        let most = p.friction(state.slip) * under.friction * load;
        let mut adhering = adhesion(p.slip_stiffness, state.slip, most);
        if p.adhesion == 2 {
            let touching = f64::from(state.sums.touching);
            let whole = f64::from(touching_at_rest(p, &self.prepared, under.height)).max(1.0);
            adhering = adhering.min(touching / whole);
        }
        state.traction = brush_force(p.slip_stiffness, state.slip, most, adhering);
        let direction = libm::tanh(speed / CREEP);
        let resisted = p.rolling_resistance * load * direction;
        state.resistance = resisted;
        // the lever is the radius of the slip: with another one rolling would make energy or take it
        let (mut along, mut moment) = (state.traction, -radius * state.traction);
        match p.resistance_as {
            2 => moment -= radius * resisted,
            _ => along -= resisted,
        }
        let free = self.prepared.free;
        moment -= p.rubber_mass * free * free * rim.spin_acceleration;
        if p.rim_force == 2 {
            moment += state.sums.moment;
        }
        let (x, z) = (force_x + along * under.along[0], force_z + along * under.along[1]);
        let [cos, sin] = heading;
        state.on_rim = Wrench {
            force: Vector3::new(x * cos, x * sin, z),
            moment: Vector3::new(-moment * sin, moment * cos, 0.0),
        };
        state.power_loss = state.traction * (rolling - speed);
    }
}

/// Elements that a rim at a height over a level road would have in contact, if they did not move.
fn touching_at_rest(p: &Parameters, prepared: &Prepared, height: f64) -> u32 {
    let half = libm::acos((height / p.radius).clamp(-1.0, 1.0));
    2 * (half / prepared.pitch) as u32 + 1
}

impl Tire for SuperElastic {
    const NAME: &'static str = "super-elastic";
    const TITLE: &'static str = "Super-elastic tire";
    const DOCUMENTATION: &'static str = include_str!("documentation.html");
    const ON_ROAD: &'static str = include_str!("on_road.html");
    const RIPPLES: bool = true;
    const STEP: f64 = 1e-3;
    type Inside = Stationary;

    fn rows() -> Table<Self> {
        Self::table()
    }

    fn mount(&mut self, road: &Road) -> Result<()> {
        self.prepared = self.parameters.prepare(road.drum_curvature())?;
        Ok(())
    }

    fn tune(&mut self) -> Result<()> {
        self.prepared = self.parameters.prepare(self.prepared.curvature)?;
        Ok(())
    }

    fn share_parameters(&mut self, of: &Self) {
        self.name.clone_from(&of.name);
        self.parameters.clone_from(&of.parameters);
    }

    fn check(&self, _road: &Road) -> Result<()> {
        let n = self.prepared.rays.len();
        let whole = n >= 4
            && self.state.ring.fits(&self.parameters, &self.prepared)
            && self.prepared.stiffness.is_whole()
            && self.prepared.damping.is_whole()
            && self.prepared.curvature.is_finite();
        if whole { Ok(()) } else { Err(Error::numeric("the saved super-elastic tire is damaged")) }
    }

    fn radius(&self) -> f64 {
        self.parameters.radius
    }

    fn rolling_radius(&self, deflection: f64) -> f64 {
        self.parameters.dynamic_radius(self.parameters.radius - deflection)
    }

    fn window(&self) -> &Window {
        &self.window
    }

    fn gravity(&self) -> f64 {
        self.parameters.gravity
    }

    /// The road, through the elements that are in contact when the tire is pressed in by a tenth of its radius, and through the
    /// brush at standstill.
    fn links(&self) -> [Link; 3] {
        let p = &self.parameters;
        let road = ("the road", f64::INFINITY);
        let touching = f64::from(touching_at_rest(p, &self.prepared, 0.9 * p.radius));
        let relaxing = p.relaxing_stiffness + p.friction_stiffness;
        // what holds at loads up to twice the reference
        let held = |loads: f64| {
            p.coefficients(&self.prepared, loads * p.reference_load, p.reference_speed).stiffness
        };
        let stiffest = self.state.coefficients.stiffness.max(held(1.0)).max(held(2.0));
        let neighbours = Coupling::new(p, &self.prepared).map_or(0.0, |coupling| coupling.of_a_round_wheel());
        let radial = touching * (stiffest + relaxing + neighbours);
        let along = p.slip_stiffness / p.relaxation_length;
        let square = p.radius * p.radius;
        [
            Link {
                stiffness: ("stiffness of the elements in contact", radial),
                damping: ("damping of the elements in contact", touching * p.damping),
                mass: road,
            },
            Link { stiffness: ("stiffness across", 0.0), damping: ("damping across", 0.0), mass: road },
            Link {
                stiffness: (
                    "slip_stiffness over relaxation_length, times the radius squared",
                    along * square,
                ),
                damping: ("none", 0.0),
                mass: road,
            },
        ]
    }

    fn stationary(&self, rim: &Motion<f64>, vertical: Vertical, friction: f64) -> Result<Rest<Stationary>> {
        let (mut plane, heading) = in_plane(rim);
        plane.velocity[1] = 0.0;
        let load = match vertical {
            Vertical::Height(height) => {
                plane.height = height;
                None
            }
            Vertical::Load(load) => Some(load),
        };
        let inside = stationary(&self.parameters, &self.prepared, &plane, load)?;
        plane.height = inside.height;
        let mut tire = self.clone();
        tire.settle(&inside, &plane);
        let level = Under { height: inside.height, along: [1.0, 0.0], friction };
        tire.pass_on(&plane, heading, &level, 0.0);
        Ok(Rest { rim_height: inside.height, on_rim: tire.state.on_rim, inside })
    }

    /// The elements stand on the road as it is, which may be an obstacle, at the height that was found for a plane one.
    fn begin(
        &mut self,
        rest: &Rest<Stationary>,
        rim: &Motion<f64>,
        _plane: &Plane,
        ground: &impl Ground,
    ) -> Result<()> {
        let (plane, heading) = in_plane(rim);
        self.settle(&rest.inside, &plane);
        let rubber = Rubber {
            parameters: &self.parameters,
            prepared: &self.prepared,
            coefficients: self.state.coefficients,
        };
        self.state.ring = at_rest(&rubber, &plane, &Along { ground, heading, share: 0.0 })?.0;
        self.step(rim, rim, ground, 0.0)
    }

    fn step(
        &mut self,
        before: &Motion<f64>,
        after: &Motion<f64>,
        ground: &impl Ground,
        dt: f64,
    ) -> Result<()> {
        check_upright(after.angles.x, MAX_CAMBER)?;
        let ((from, _), (to, heading)) = (in_plane(before), in_plane(after));
        let track = |share: f64| Along { ground, heading, share };
        let rubber = Rubber {
            parameters: &self.parameters,
            prepared: &self.prepared,
            coefficients: self.state.coefficients,
        };
        let travels = self.prepared.curvature == 0.0;
        self.state.sums = if dt > 0.0 {
            let rims = [GAMMA, 1.0].map(|share| between(&from, &to, share, dt, travels));
            self.state.ring.step(&rubber, &rims, &[track(GAMMA), track(1.0)], dt)
        } else {
            self.state.ring.evaluate(&rubber, &to, &track(1.0))
        };
        if self.state.sums.unsettled {
            return Err(Error::numeric(UNSETTLED));
        }
        let under = under(&to, heading, ground, 1.0);
        let end = if dt > 0.0 { between(&from, &to, 1.0, dt, travels) } else { to };
        self.pass_on(&end, heading, &under, dt);
        let p = &self.parameters;
        let state = &mut self.state;
        let load = p.on_rim(&state.sums)[1];
        if dt > 0.0 {
            state.load += (load - state.load) * -libm::expm1(-dt / p.characteristic_lag);
            state.energy_loss += dt * state.power_loss;
        }
        state.coefficients = p.coefficients(&self.prepared, state.load, to.velocity[0]);
        if state.sums.exact.iter().chain(&state.sums.radial).all(|f| f.is_finite()) {
            Ok(())
        } else {
            Err(Error::numeric(
                "the forces of the elements are no longer finite: the rim moves too fast for this tire",
            ))
        }
    }

    fn on_rim(&self) -> Wrench<f64> {
        self.state.on_rim
    }

    /// Elements are carried across their rays, which is half of their mass in each direction: the sum of t tᵀ over N even rays is
    /// N / 2. As printed, that is not felt; but they spin with the rim.
    fn carried(&self) -> Carried {
        let ([x, z], [cos, sin]) = (self.state.acceleration, self.state.heading);
        Carried {
            mass: if self.parameters.rim_force == 2 { 0.5 * self.parameters.rubber_mass } else { 0.0 },
            inertia: self.parameters.rubber_mass * self.prepared.free * self.prepared.free,
            acceleration: Vector3::new(x * cos, x * sin, z),
            spin_acceleration: self.state.spin_acceleration,
        }
    }

    fn energy_loss(&self) -> f64 {
        self.state.energy_loss
    }

    fn cells(&self) -> Vec<Cell> {
        let (p, prepared) = (&self.parameters, &self.prepared);
        let turned = libm::sincos(self.state.angle);
        let length = 2.0 * p.radius * libm::sin(0.5 * (prepared.pitch - p.gap_angle));
        let cell = |n: usize| {
            let [x, z] = self.state.ring.contact[n];
            let force = libm::hypot(x, z);
            (force > 0.0).then(|| Cell {
                x: (self.state.ring.distance[n] + 0.5 * p.element_thickness) * along(prepared, n, turned)[0],
                length,
                width: p.width,
                pressure: force / (length * p.width),
                ..Cell::default()
            })
        };
        (0..prepared.rays.len()).filter_map(cell).collect()
    }
}

impl SuperElastic {
    /// Energy of the elements' motion, height and springs and of the contact's, on level road \[J\].
    pub fn energy(&self, rim: &Motion<f64>) -> f64 {
        let rubber = Rubber {
            parameters: &self.parameters,
            prepared: &self.prepared,
            coefficients: self.state.coefficients,
        };
        self.state.ring.energy(&rubber, &in_plane(rim).0, &Bare { curvature: self.prepared.curvature })
    }
}
