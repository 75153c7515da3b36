//! One contact point, steady forces at slips that lag by relaxation lengths.

use super::{Input, Law, ON_ROAD, Pressed, Standstill, Steady};
use crate::mechanics::{Link, Motion, Wrench, cross};
use crate::model::{Access, Purpose, Role, Table, local, output, parameter};
use crate::road::{Road, Window};
use crate::tire::mounted::along_heading;
use crate::tire::relaxation::follow;
use crate::tire::{Ground, Plane, Rest, Tire, Vertical, check_upright};
use crate::{Error, Result, clone_in_place, lens, real};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// The shortest relaxation length \[m\]: laws that have none still get slips that follow within a
/// centimetre, a tenth of a contact's length, and not at once, which no step would be short enough for.
const SHORTEST_RELAXATION: f64 = 0.01;

/// A tire with one contact point: its law and its state. It has no mass.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct OnePoint<L> {
    /// The law.
    pub law: L,
    /// Gravity \[m/s²\], for rigs: the tire has no mass.
    pub gravity: f64,
    /// What changes.
    pub state: State,
    /// The length over which it bridges a road: it feels one point.
    window: Window,
}

clone_in_place!(OnePoint<L> { law, gravity, state, window });

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
    pub deflected: f64,
    /// Spin speed of the wheel \[rad/s\].
    pub spin: f64,
    /// Force and moment on the tire at the contact point, W axes.
    pub contact: Wrench<f64>,
    /// Relaxation lengths, along and across \[m\].
    pub relaxation: [f64; 2],
    /// Pneumatic trail \[m\].
    pub trail: f64,
    /// An input of the law was outside the range that it holds for, and was kept at its end.
    pub outside: bool,
    /// Force and moment on the rim about its centre, frame 0.
    pub on_rim: Wrench<f64>,
    /// Power lost in the contact \[W\].
    pub power_loss: f64,
    /// Energy lost in the contact since the start \[J\].
    pub energy_loss: f64,
    /// How the contact point moved at the end of the last step, with the parameters that hold.
    moved: Option<Moving>,
}

/// How the contact point and the tread move over the road.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct Moving {
    /// Velocity of the contact point along and across \[m/s\].
    travel: [f64; 2],
    /// Velocity of the tread against the road along the wheel \[m/s\].
    sliding_x: f64,
}

/// The wheel against the plane that its contact point is on, W axes: x along the wheel, z normal to the plane.
struct Contact {
    /// From the wheel's centre to the contact point \[m\].
    arm: Vector3<f64>,
    deflection: f64,
    deflection_rate: f64,
    spin: f64,
    camber: f64,
    /// Sine and cosine of the wheel's heading on the plane.
    heading: (f64, f64),
    moving: Moving,
    /// Effective rolling radius times spin speed \[m/s\].
    rolling: f64,
}

/// Slip from a sliding and a travelling speed: −Vsx / |Vx|, or tan α = Vsy / |Vx|; 0 where nothing travels.
fn slip_of(sliding: f64, speed: f64) -> f64 {
    if speed == 0.0 { 0.0 } else { sliding / speed.abs() }
}

impl<L: Law> OnePoint<L> {
    fn contact(&self, rim: &Motion<f64>) -> Contact {
        let (camber, height) = (rim.angles.x, rim.position.z);
        let (sin, cos) = libm::sincos(camber);
        // in the wheel's plane, down to the road
        let loaded = height / cos;
        let loaded_rate = (rim.velocity.z + loaded * sin * rim.rates.x) / cos;
        let arm = Vector3::new(0.0, loaded * sin, -height);
        let deflection = self.law.radius() - loaded;
        // turning without the spin carries the contact point along
        let turning = Vector3::new(rim.rates.x, 0.0, rim.rates.z);
        let heading = libm::sincos(rim.angles.z);
        let velocity = along_heading(heading, &rim.velocity) + cross(&turning, &arm);
        let spin = rim.rates.y + rim.rates.z * sin;
        let rolling = self.law.rolling_radius(deflection, spin) * spin;
        Contact {
            arm,
            deflection,
            deflection_rate: -loaded_rate,
            spin,
            camber,
            heading,
            moving: Moving { travel: [velocity.x, velocity.y], sliding_x: velocity.x - rolling },
            rolling,
        }
    }

    /// The load that the last forces along and across leave.
    fn load(&self, at: &Contact) -> f64 {
        let force = self.state.contact.force;
        self.law.normal_force(&Pressed {
            deflection: at.deflection,
            rate: at.deflection_rate,
            spin: at.spin,
            force: [force.x, force.y],
        })
    }

    fn relaxation(&self, load: f64, camber: f64) -> [f64; 2] {
        self.law.relaxation(load, camber).map(|length| length.max(SHORTEST_RELAXATION))
    }

    /// How much of the standstill's damping is left at a speed: all at rest, none from the law's low speed on.
    fn share_at_rest(&self, speed: f64) -> f64 {
        let low = self.law.standstill().speed;
        if speed.abs() >= low {
            return 0.0;
        }
        0.5 * (1.0 + libm::cos(std::f64::consts::PI * speed / low))
    }

    /// Forces of the state's deflections, with its relaxation lengths, at a load; W axes, at the contact point.
    fn evaluate(&mut self, at: &Contact, load: f64, friction: f64) -> Steady {
        let state = &mut self.state;
        (state.deflected, state.spin) = (at.deflection, at.spin);
        let tangent_of = |i: usize| state.deflection[i] / state.relaxation[i];
        state.slip = [tangent_of(0), libm::atan(tangent_of(1))];
        let Moving { travel: [ahead, aside], sliding_x } = at.moving;
        state.wheel_slip = [slip_of(-sliding_x, ahead), libm::atan2(aside, ahead.abs())];
        let [kappa, alpha] = state.slip;
        let input = Input { fz: load, kappa, alpha, gamma: at.camber, vx: ahead, friction };
        let steady = if load > 0.0 { self.law.steady(&input) } else { Steady::default() };
        let [x, y] = steady.force;
        self.state.contact = Wrench { force: Vector3::new(x, y, load), moment: Vector3::from(steady.moment) };
        self.state.trail = steady.trail;
        self.state.outside = steady.outside;
        steady
    }

    /// Brings force and moment from the contact point to the rim.
    fn pass_on(&mut self, at: &Contact, plane: &Plane) {
        let Wrench { force, moment } = self.state.contact;
        let (sin, cos) = at.heading;
        let back = |v: &Vector3<f64>| plane.to_frame_0(&along_heading((-sin, cos), v));
        self.state.on_rim = Wrench { force: back(&force), moment: back(&(moment + cross(&at.arm, &force))) };
        let Moving { travel: [_, aside], sliding_x } = at.moving;
        self.state.power_loss = -(force.x * sliding_x + force.y * aside);
    }

    /// The largest deflections \[m\] that standstill can build up: those at which all of the contact slides.
    fn limit(&self, steady: &Steady, load: f64) -> [f64; 2] {
        [0, 1].map(|i| match steady.stiffness[i] == 0.0 {
            true => 0.0,
            false => 3.0 * steady.friction[i] * load / steady.stiffness[i].abs() * self.state.relaxation[i],
        })
    }

    /// What standstill adds to the forces of the state's deflections at a speed; nothing above the law's low speed.
    fn stand(
        &mut self,
        steady: &Steady,
        at: &Contact,
        load: f64,
        friction: f64,
        speed: f64,
    ) -> Option<Steady> {
        let at_rest = self.share_at_rest(speed);
        if at_rest == 0.0 || load <= 0.0 {
            return None;
        }
        // where nothing rolls the deflection away, it ends where all of the contact slides
        let limit = self.limit(steady, load);
        for (deflection, limit) in self.state.deflection.iter_mut().zip(limit) {
            let excess = deflection.abs() - limit;
            if excess > 0.0 {
                *deflection -= (at_rest * excess).copysign(*deflection);
            }
        }
        let steady = self.evaluate(at, load, friction);
        // a deflection that changes meets the damping of the tire, which a tire that rolls has in the law
        let damping = at_rest * self.law.standstill().damping;
        let most = steady.friction.map(|mu| mu * load);
        let add = |force: f64, by: f64, most: f64| match most > force.abs() {
            true => (force + by).clamp(-most, most),
            false => force,
        };
        let force = &mut self.state.contact.force;
        force.x = add(force.x, -damping * at.moving.sliding_x, most[0]);
        force.y = add(force.y, -damping * at.moving.travel[1], most[1]);
        Some(steady)
    }

    /// What it tells besides force and moment on the rim, and gravity.
    #[rustfmt::skip] // a row is a line
    fn own_rows() -> Table<Self> {
        Table::new([
            output("belt_deflection", "m", real!(state.deflected), "How far the tire is pressed in, along the wheel's plane; negative in the air"),
            output("normal_force", "N", real!(state.contact.force.z), "Force of the road on the tire along the road's normal").nominal(1000.0).role(Role::Load),
            output("relaxed_slip", "1", real!(state.slip[0]), "Longitudinal slip behind the relaxation, which the forces follow").role(Role::Slip),
            output("relaxed_slip_angle", "rad", real!(state.slip[1]), "Slip angle behind the relaxation, which the forces follow").role(Role::SlipAngle),
            output("contact_power_loss", "W", real!(state.power_loss), "Power of the forces at the contact point that its sliding takes").nominal(1000.0).role(Role::FrictionPower),
            output("contact_energy_loss", "J", real!(state.energy_loss), "Energy of that since the start").nominal(1e4),
            local("wheel_slip", "1", real!(state.wheel_slip[0]), "Longitudinal slip of the wheel, -Vsx / |Vx| at the contact point; 0 at rest"),
            local("wheel_slip_angle", "rad", real!(state.wheel_slip[1]), "Slip angle of the wheel, atan2(Vsy, |Vx|) at the contact point"),
            local("relaxation_length_x", "m", real!(state.relaxation[0]), "Relaxation length of longitudinal slip"),
            local("relaxation_length_y", "m", real!(state.relaxation[1]), "Relaxation length of the slip angle"),
            local("pneumatic_trail", "m", real!(state.trail), "Pneumatic trail"),
            local("outside_range", "", Access::computed_boolean(|m: &Self| m.state.outside), "Load, slip or an angle is outside the range that the law holds for; it gets the end of the range"),
            parameter("gravity", "m/s2", real!(gravity), 9.81, "Gravity of the rig; the tire has no mass").range(0.0, 100.0).purpose(Purpose::Constant),
        ])
    }
}

impl<L: Law> Tire for OnePoint<L> {
    const NAME: &'static str = L::NAME;
    const TITLE: &'static str = L::TITLE;
    const DOCUMENTATION: &'static str = L::DOCUMENTATION;
    const ON_ROAD: &'static str = ON_ROAD;
    type Inside = Inside;

    fn rows() -> Table<Self> {
        Self::own_rows().part("", lens!(law), L::rows())
    }

    fn mount(&mut self, _road: &Road) -> Result<()> {
        self.law.mount()
    }

    fn tune(&mut self) -> Result<()> {
        self.state.moved = None;
        self.law.mount()
    }

    fn share_parameters(&mut self, of: &Self) {
        self.law.clone_from(&of.law);
        self.gravity = of.gravity;
    }

    fn mirror(&mut self) {
        self.law.mirror();
    }

    fn radius(&self) -> f64 {
        self.law.radius()
    }

    fn rolling_radius(&self, deflection: f64) -> f64 {
        self.law.rolling_radius(deflection, self.state.spin)
    }

    fn window(&self) -> &Window {
        &self.window
    }

    fn gravity(&self) -> f64 {
        self.gravity
    }

    /// The road, through the spring of the tire: vertical, and along and across that of the deflection, which is the
    /// slip stiffness over the relaxation length.
    fn links(&self) -> [Link; 3] {
        let road = ("the road", f64::INFINITY);
        let (load, [along_from, across_from]) = self.law.usual_load();
        // fast enough for what is no standstill
        let forward = Input { fz: load, kappa: 0.0, alpha: 0.0, gamma: 0.0, vx: 10.0, friction: 1.0 };
        let steady = self.law.steady(&forward);
        let relaxation = self.relaxation(load, 0.0);
        let [along, across] = [0, 1].map(|i| steady.stiffness[i].abs() / relaxation[i]);
        let Standstill { damping, .. } = self.law.standstill();
        let square = self.law.radius() * self.law.radius();
        [
            self.law.vertical_link(),
            Link { stiffness: (across_from, across), damping: ("low_speed_damping", damping), mass: road },
            Link {
                stiffness: (along_from, along * square),
                damping: ("low_speed_damping times the radius squared", damping * square),
                mass: road,
            },
        ]
    }

    fn stationary(&self, rim: &Motion<f64>, vertical: Vertical, friction: f64) -> Result<Rest<Inside>> {
        let mut still = *rim;
        still.velocity.z = 0.0;
        (still.rates.x, still.rates.z) = (0.0, 0.0);
        let mut tire = self.clone();
        tire.state = State::default();
        let cos = libm::cos(rim.angles.x);
        let mut wanted = match vertical {
            Vertical::Height(_) => 0.0,
            Vertical::Load(load) => load,
        };
        // Laws in which the forces along and across change the load are evaluated again until nothing changes, the others twice.
        for _ in 0..MOST_ROUNDS {
            let rim_height = match vertical {
                Vertical::Height(height) => height,
                Vertical::Load(_) => (self.law.radius() - self.law.deflection(wanted, still.rates.y)) * cos,
            };
            still.position.z = rim_height;
            let at = tire.contact(&still);
            let load = tire.load(&at);
            let Moving { travel: [vx, vy], sliding_x } = at.moving;
            if load > 0.0 && vx == 0.0 && (vy != 0.0 || sliding_x != 0.0) {
                return Err(Error::numeric(
                    "the wheel slides without rolling along: its slip is infinite, and the deflection of the tire has no stationary state",
                ));
            }
            let relaxation = tire.relaxation(load, at.camber);
            let deflection = match load > 0.0 {
                true => [relaxation[0] * slip_of(-sliding_x, vx), relaxation[1] * slip_of(vy, vx)],
                false => [0.0; 2],
            };
            let before = tire.state.contact.force;
            (tire.state.deflection, tire.state.relaxation) = (deflection, relaxation);
            let steady = tire.evaluate(&at, load, friction);
            tire.stand(&steady, &at, load, friction, vx);
            tire.pass_on(&at, &Plane::level(rim_height, friction));
            let on_rim = tire.state.on_rim;
            if !on_rim.force.iter().chain(&on_rim.moment).all(|x| x.is_finite()) {
                return Err(Error::numeric("the forces of the tire at the start are not finite"));
            }
            let force = tire.state.contact.force;
            let short = match vertical {
                Vertical::Height(_) => 0.0,
                Vertical::Load(load) => {
                    load - self.law.normal_force(&Pressed {
                        deflection: at.deflection,
                        spin: at.spin,
                        force: [force.x, force.y],
                        rate: 0.0,
                    })
                }
            };
            // a few units in the last place
            let enough = 1e-12 * (force.z.abs() + 1.0);
            if (force - before).abs().max() <= enough && short.abs() <= enough {
                let inside = Inside { deflection, force: [force.x, force.y] };
                return Ok(Rest { rim_height, on_rim, inside });
            }
            wanted += short;
        }
        Err(Error::numeric(
            "load and horizontal forces of the tire do not find a balance: each takes too much of the other",
        ))
    }

    fn begin(
        &mut self,
        rest: &Rest<Inside>,
        rim: &Motion<f64>,
        _plane: &Plane,
        ground: &impl Ground,
    ) -> Result<()> {
        let Inside { deflection, force: [x, y] } = rest.inside;
        self.state = State { deflection, ..State::default() };
        self.state.contact.force = Vector3::new(x, y, 0.0);
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
        let plane = ground.plane(after, &self.window, 1.0);
        let to = plane.relative(after);
        check_upright(to.angles.x, MAX_CAMBER)?;
        let new = self.contact(&to);
        let old = self.state.moved.filter(|_| !ground.moves()).unwrap_or_else(|| {
            let plane = ground.plane(before, &self.window, 0.0);
            self.contact(&plane.relative(before)).moving
        });
        self.state.moved = Some(new.moving);
        let mean = |old: f64, new: f64| 0.5 * (old + new);
        let speed = mean(old.travel[0], new.moving.travel[0]);
        let sliding = [-mean(old.sliding_x, new.moving.sliding_x), mean(old.travel[1], new.moving.travel[1])];
        let load = self.load(&new);
        let relaxation = self.relaxation(load, new.camber);
        let last = self.state.deflection;
        for i in 0..2 {
            self.state.deflection[i] =
                if load > 0.0 { follow(last[i], sliding[i], speed, relaxation[i], dt) } else { 0.0 };
        }
        self.state.relaxation = relaxation;
        let mut steady = self.evaluate(&new, load, plane.friction);
        if let Some(standing) = self.stand(&steady, &new, load, plane.friction, speed) {
            steady = standing;
        }
        if dt > 0.0 {
            let rate = (self.state.deflection[1] - last[1]) / dt;
            self.state.contact.moment.z += steady.couple * new.rolling * rate;
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

/// What has to be known of a stationary state.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Inside {
    /// Deflections of the contact point on the tire, along and across \[m\].
    deflection: [f64; 2],
    /// Forces along and across \[N\].
    force: [f64; 2],
}

/// Rounds of the search for a balance of load and horizontal forces: each leaves a few percent of what the one before left.
const MOST_ROUNDS: usize = 60;

/// Beyond this camber to the road \[rad\] the contact point runs away from the wheel.
const MAX_CAMBER: f64 = 1.3;
