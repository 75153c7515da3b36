//! The Magic Formula tire as rigs see it: one contact point, steady forces at slips that lag by relaxation lengths.

use super::{
    Coefficients, Input, Output, RelaxationLengths, effective_rolling_radius, gyroscopic_couple,
    relaxation_lengths, static_deflection, steady, vertical_force,
};
use crate::mechanics::{Link, Motion, Wrench, cross, rotation_z};
use crate::model::Table;
use crate::road::{Road, Window};
use crate::tire::relaxation::follow;
use crate::tire::{Ground, Plane, Rest, Tire, Vertical, check_upright};
use crate::{Error, Result, clone_in_place};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// The shortest relaxation length \[m\]: files whose coefficients make none still get slips that follow within a
/// centimetre, a tenth of a contact's length, and not at once, which no step would be short enough for.
const SHORTEST_RELAXATION: f64 = 0.01;

/// The Magic Formula tire: coefficients and state. It has no mass.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct MagicFormula {
    /// Name of the tire, for reports.
    pub name: String,
    /// The coefficients.
    pub coefficients: Coefficients,
    /// The coefficients are those of a tire for the other side of the vehicle.
    pub mirrored: bool,
    /// Damping of the deflection at standstill \[N.s/m\].
    pub low_speed_damping: f64,
    /// Gravity \[m/s²\], for rigs: the tire has no mass.
    pub gravity: f64,
    /// What changes.
    pub state: State,
    /// The length over which it bridges a road: it feels one point.
    window: Window,
}

clone_in_place!(MagicFormula { name, coefficients, mirrored, low_speed_damping, gravity, state, window });

/// State of the tire, and what the last step found.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct State {
    /// Deflections of the contact point on the tire, along and across \[m\].
    pub deflection: [f64; 2],
    /// Longitudinal slip and slip angle behind the relaxation \[1, rad\].
    pub slip: [f64; 2],
    /// Those of the wheel: what the relaxed ones go to.
    pub wheel_slip: [f64; 2],
    /// How far the tire is pressed in \[m\]; negative in the air.
    pub penetration: f64,
    /// Force and moment on the tire at the contact point, W axes.
    pub contact: Wrench<f64>,
    /// Relaxation lengths, along and across \[m\].
    pub relaxation: [f64; 2],
    /// Pneumatic trail \[m\].
    pub trail: f64,
    /// An input of the formula was outside the range that the coefficients hold for, and was kept at its end.
    pub outside: bool,
    /// Force and moment on the rim about its centre, frame 0.
    pub on_rim: Wrench<f64>,
    /// Power lost in the contact \[W\].
    pub power_loss: f64,
    /// Energy lost in the contact since the start \[J\].
    pub energy_loss: f64,
}

/// The wheel against the plane that its contact point is on, W axes: x along the wheel, z normal to the plane.
struct Contact {
    /// From the wheel's centre to the contact point \[m\].
    arm: Vector3<f64>,
    penetration: f64,
    penetration_rate: f64,
    camber: f64,
    yaw: f64,
    /// Velocity of the contact point along and across \[m/s\], and of the tread against the road along the wheel.
    travel: [f64; 2],
    sliding_x: f64,
    /// Effective rolling radius times spin speed \[m/s\].
    rolling: f64,
}

/// Slip from a sliding and a travelling speed: −Vsx / |Vx|, or tan α = Vsy / |Vx|; 0 where nothing travels.
fn slip_of(sliding: f64, speed: f64) -> f64 {
    if speed == 0.0 { 0.0 } else { sliding / speed.abs() }
}

impl MagicFormula {
    fn contact(&self, rim: &Motion<f64>) -> Contact {
        let c = &self.coefficients;
        let (camber, height) = (rim.angles.x, rim.position.z);
        let (sin, cos) = libm::sincos(camber);
        // in the wheel's plane, down to the road
        let loaded = height / cos;
        let loaded_rate = (rim.velocity.z + loaded * sin * rim.rates.x) / cos;
        let arm = Vector3::new(0.0, loaded * sin, -height);
        let penetration = c.unloaded_radius - loaded;
        // turning without the spin carries the contact point along
        let turning = Vector3::new(rim.rates.x, 0.0, rim.rates.z);
        let velocity = rotation_z(-rim.angles.z) * rim.velocity + cross(&turning, &arm);
        let load = vertical_force(c, penetration, 0.0);
        let spin = rim.rates.y + rim.rates.z * sin;
        let rolling = effective_rolling_radius(c, load) * spin;
        Contact {
            arm,
            penetration,
            penetration_rate: -loaded_rate,
            camber,
            yaw: rim.angles.z,
            travel: [velocity.x, velocity.y],
            sliding_x: velocity.x - rolling,
            rolling,
        }
    }

    /// Forces of the formula at a load and slips, seen from the side that the coefficients are of.
    fn forces(&self, input: Input) -> Output {
        match self.mirrored {
            true => steady(&self.coefficients, &input.mirrored()).mirrored(),
            false => steady(&self.coefficients, &input),
        }
    }

    fn relaxation(&self, load: f64, camber: f64) -> [f64; 2] {
        let RelaxationLengths { kappa, alpha } = relaxation_lengths(&self.coefficients, load, camber);
        [kappa.max(SHORTEST_RELAXATION), alpha.max(SHORTEST_RELAXATION)]
    }

    /// How much of the standstill's damping is left at a speed: all at rest, none from `VXLOW` on.
    fn share_at_rest(&self, speed: f64) -> f64 {
        let low = self.coefficients.vxlow;
        if speed.abs() >= low {
            return 0.0;
        }
        0.5 * (1.0 + libm::cos(std::f64::consts::PI * speed / low))
    }

    /// Forces of the state's deflections; W axes, at the contact point.
    fn evaluate(&mut self, at: &Contact, friction: f64) -> Output {
        let load = vertical_force(&self.coefficients, at.penetration, at.penetration_rate);
        let relaxation = self.relaxation(load, at.camber);
        let state = &mut self.state;
        state.penetration = at.penetration;
        state.relaxation = relaxation;
        let tangent_of = |i: usize| state.deflection[i] / relaxation[i];
        state.slip = [tangent_of(0), libm::atan(tangent_of(1))];
        state.wheel_slip =
            [slip_of(-at.sliding_x, at.travel[0]), libm::atan2(at.travel[1], at.travel[0].abs())];
        let input = Input {
            fz: load,
            kappa: state.slip[0],
            alpha: state.slip[1],
            gamma: at.camber,
            vx: at.travel[0],
            friction,
        };
        let output = self.forces(input);
        self.state.contact = Wrench {
            force: Vector3::new(output.fx, output.fy, load),
            moment: Vector3::new(output.mx, output.my, output.mz),
        };
        self.state.trail = output.trail;
        self.state.outside = load > 0.0 && output.outside.any();
        output
    }

    /// Brings force and moment from the contact point to the rim.
    fn pass_on(&mut self, at: &Contact, plane: &Plane) {
        let axes = plane.rotation() * rotation_z(at.yaw);
        let Wrench { force, moment } = self.state.contact;
        self.state.on_rim = Wrench { force: axes * force, moment: axes * (moment + cross(&at.arm, &force)) };
        let [_, aside] = at.travel;
        self.state.power_loss = -(force.x * at.sliding_x + force.y * aside);
    }

    /// The largest deflections \[m\] that standstill can build up: those at which all of the contact slides.
    fn limit(&self, output: &Output, load: f64) -> [f64; 2] {
        let [long, lat] = self.state.relaxation;
        let full = |friction: f64, stiffness: f64, length: f64| match stiffness == 0.0 {
            true => 0.0,
            false => 3.0 * friction * load / stiffness.abs() * length,
        };
        [full(output.mu_x, output.slip_stiffness, long), full(output.mu_y, output.cornering_stiffness, lat)]
    }
}

impl Tire for MagicFormula {
    const NAME: &'static str = "magic-formula";
    const TITLE: &'static str = "Magic Formula tire";
    const DOCUMENTATION: &'static str = include_str!("documentation.html");
    const ON_ROAD: &'static str = include_str!("on_road.html");
    type Inside = [f64; 2];

    fn rows() -> Table<Self> {
        Self::table()
    }

    fn mount(&mut self, _road: &Road) -> Result<()> {
        self.coefficients.check()
    }

    fn tune(&mut self) -> Result<()> {
        self.coefficients.check()
    }

    fn radius(&self) -> f64 {
        self.coefficients.unloaded_radius
    }

    fn rolling_radius(&self, deflection: f64) -> f64 {
        effective_rolling_radius(&self.coefficients, vertical_force(&self.coefficients, deflection, 0.0))
    }

    fn window(&self) -> &Window {
        &self.window
    }

    fn gravity(&self) -> f64 {
        self.gravity
    }

    /// The road, through the spring of the tire: vertical, and along and across that of the deflection, which is the
    /// slip stiffness over the relaxation length, at the nominal load.
    fn links(&self) -> [Link; 3] {
        let c = &self.coefficients;
        let road = ("the road", f64::INFINITY);
        let forward = Input { fz: c.fnomin, kappa: 0.0, alpha: 0.0, gamma: 0.0, vx: c.longvl, friction: 1.0 };
        let at_nominal = steady(c, &forward);
        let [long, lat] = self.relaxation(c.fnomin, 0.0);
        let (along, across) = (at_nominal.slip_stiffness / long, at_nominal.cornering_stiffness.abs() / lat);
        let damping = self.low_speed_damping;
        let square = c.unloaded_radius * c.unloaded_radius;
        [
            Link {
                stiffness: ("VERTICAL_STIFFNESS", c.lcz * c.vertical_stiffness),
                damping: ("VERTICAL_DAMPING", c.vertical_damping),
                mass: road,
            },
            Link {
                stiffness: ("stiffness across (PKY1 over PTY1)", across),
                damping: ("low_speed_damping", damping),
                mass: road,
            },
            Link {
                stiffness: ("stiffness along (PKX1 over PTX1) times the radius squared", along * square),
                damping: ("low_speed_damping times the radius squared", damping * square),
                mass: road,
            },
        ]
    }

    fn stationary(&self, rim: &Motion<f64>, vertical: Vertical, friction: f64) -> Result<Rest<[f64; 2]>> {
        let c = &self.coefficients;
        let cos = libm::cos(rim.angles.x);
        let rim_height = match vertical {
            Vertical::Height(height) => height,
            Vertical::Load(load) => (c.unloaded_radius - static_deflection(c, load)) * cos,
        };
        let mut still = *rim;
        still.position.z = rim_height;
        still.velocity.z = 0.0;
        (still.rates.x, still.rates.z) = (0.0, 0.0);
        let at = self.contact(&still);
        let relaxation = self.relaxation(vertical_force(c, at.penetration, 0.0), at.camber);
        let [vx, vy] = at.travel;
        if at.penetration > 0.0 && vx == 0.0 && (vy != 0.0 || at.sliding_x != 0.0) {
            return Err(Error::numeric(
                "the wheel slides without rolling along: its slip is infinite, and the deflection of the tire has no stationary state",
            ));
        }
        let deflection = match at.penetration > 0.0 {
            true => [relaxation[0] * slip_of(-at.sliding_x, vx), relaxation[1] * slip_of(vy, vx)],
            false => [0.0; 2],
        };
        let mut tire = self.clone();
        tire.state = State { deflection, ..State::default() };
        tire.evaluate(&at, friction);
        tire.pass_on(&at, &Plane::level(rim_height, friction));
        let on_rim = tire.state.on_rim;
        if on_rim.force.iter().chain(&on_rim.moment).all(|x| x.is_finite()) {
            Ok(Rest { rim_height, on_rim, inside: deflection })
        } else {
            Err(Error::numeric("the forces of the tire at the start are not finite"))
        }
    }

    fn begin(
        &mut self,
        rest: &Rest<[f64; 2]>,
        rim: &Motion<f64>,
        _plane: &Plane,
        ground: &impl Ground,
    ) -> Result<()> {
        self.state = State { deflection: rest.inside, ..State::default() };
        self.step(rim, rim, ground, 0.0)
    }

    /// The deflections are stepped exactly for the mean velocity of the step and the relaxation lengths at its end; forces are
    /// those at the end.
    fn step(
        &mut self,
        before: &Motion<f64>,
        after: &Motion<f64>,
        ground: &impl Ground,
        dt: f64,
    ) -> Result<()> {
        let under = |rim: &Motion<f64>, share: f64| {
            let plane = ground.plane(rim, &self.window, share);
            (plane.relative(rim), plane)
        };
        let ((from, _), (to, plane)) = (under(before, 0.0), under(after, 1.0));
        check_upright(to.angles.x, MAX_CAMBER)?;
        let (old, new) = (self.contact(&from), self.contact(&to));
        let mean = |old: f64, new: f64| 0.5 * (old + new);
        let speed = mean(old.travel[0], new.travel[0]);
        let sliding = [-mean(old.sliding_x, new.sliding_x), mean(old.travel[1], new.travel[1])];
        let load = vertical_force(&self.coefficients, new.penetration, new.penetration_rate);
        let relaxation = self.relaxation(load, new.camber);
        let last = self.state.deflection;
        for i in 0..2 {
            self.state.deflection[i] =
                if load > 0.0 { follow(last[i], sliding[i], speed, relaxation[i], dt) } else { 0.0 };
        }
        let mut output = self.evaluate(&new, plane.friction);
        let at_rest = self.share_at_rest(speed);
        if at_rest > 0.0 && load > 0.0 {
            // where nothing rolls the deflection away, it ends where all of the contact slides
            let limit = self.limit(&output, load);
            for (deflection, limit) in self.state.deflection.iter_mut().zip(limit) {
                let excess = deflection.abs() - limit;
                if excess > 0.0 {
                    *deflection -= (at_rest * excess).copysign(*deflection);
                }
            }
            output = self.evaluate(&new, plane.friction);
            // a deflection that changes meets the damping of the tire, which a tire that rolls has in the formula
            let damping = at_rest * self.low_speed_damping;
            let most = [output.mu_x, output.mu_y].map(|mu| mu * load);
            let add = |force: f64, by: f64, most: f64| match most > force.abs() {
                true => (force + by).clamp(-most, most),
                false => force,
            };
            let force = &mut self.state.contact.force;
            force.x = add(force.x, -damping * new.sliding_x, most[0]);
            force.y = add(force.y, -damping * new.travel[1], most[1]);
        }
        if dt > 0.0 {
            let rate = (self.state.deflection[1] - last[1]) / dt;
            let couple = gyroscopic_couple(&self.coefficients, new.rolling, rate, output.residual_decay);
            self.state.contact.moment.z += couple;
        }
        let lost = self.state.power_loss;
        self.pass_on(&new, &plane);
        self.state.energy_loss += 0.5 * dt * (lost + self.state.power_loss);
        let Wrench { force, moment } = self.state.on_rim;
        if force.iter().chain(&moment).all(|x| x.is_finite()) {
            Ok(())
        } else {
            Err(Error::numeric("the tire's forces are no longer finite; a smaller step_size may help"))
        }
    }

    fn on_rim(&self) -> Wrench<f64> {
        self.state.on_rim
    }

    fn energy_loss(&self) -> f64 {
        self.state.energy_loss
    }
}

/// Beyond this camber to the road \[rad\] the contact point runs away from the wheel.
const MAX_CAMBER: f64 = 1.3;
