//! The car: a body and four carriers that move in six directions each, wheels that spin, a rack.
//!
//! Newton's and Euler's equations; (6.1) to (6.6) for a carrier with its wheel. Steps are explicit, of Kutta's classical rule. What
//! sticks and slips, brakes and the rack's friction, does one of both in a step.

use super::axle::{ANTI_ROLL, Corner, Guide};
use super::parameters::{AIR, CARRIER_MASS, DRAG, GRAVITY, LIFT, Parameters};
use super::road::Road;
use super::start::Rolling;
use super::tire::{Footing, Told};
use super::vector::{Attitude, Axes, UP, Vector, v};

/// A body: place, attitude, velocity and angular velocity in space.
const BODY: usize = 13;
/// A wheel: its carrier, the spin, the deflections of its tire along and across.
const WHEEL: usize = BODY + 3;
const SPIN: usize = 13;
const DEFLECTION: usize = 14;
/// The rack's way to the left, and its velocity.
const RACK: usize = BODY + 4 * WHEEL;
/// What brakes, dampers, tires and air have taken.
const TAKEN: usize = RACK + 2;
const ALL: usize = TAKEN + 4;

/// Stiffness of the rack before its friction slips \[N/m\], and its mass \[kg\].
const RACK_LINING: f64 = 1e6;
const RACK_MASS: f64 = 4.0;
/// Radius that turns spins into speeds where nothing else does.
const STANDS: f64 = 1e-9;

/// The body without wheels and carriers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rigid {
    pub(crate) mass: f64,
    /// About its own axes.
    pub(crate) inertia: [f64; 3],
    /// Its centre of mass where the car stands.
    pub(crate) centre: Vector,
    /// Where drag and lift act, from there.
    pub(crate) air: Vector,
    pub(crate) lift: [Vector; 2],
}

/// A wheel's mass \[kg\], its inertia about its axle and a diameter, and that of its carrier about any axis \[kg.m²\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Hub {
    pub(crate) wheel_mass: f64,
    pub(crate) spin: f64,
    pub(crate) across: f64,
    pub(crate) carrier: f64,
}

/// All that moves.
pub(crate) type State = [f64; ALL];

/// What a wheel tells.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct WheelTold {
    /// Of the wheel on its carrier, H axes.
    pub(crate) carrier_force: Vector,
    pub(crate) carrier_moment: Vector,
    /// Force of the tire on the rim, H axes.
    pub(crate) tire_force: Vector,
    pub(crate) links: [f64; 5],
    pub(crate) strut: f64,
    pub(crate) brake: f64,
}

/// What the car tells.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct CarTold {
    pub(crate) speed: f64,
    pub(crate) acceleration: f64,
    pub(crate) yaw_rate: f64,
    pub(crate) column: f64,
    pub(crate) wheels: [WheelTold; 4],
}

/// A car that moves.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Vehicle {
    pub(crate) p: Parameters,
    body: Rigid,
    corners: [Corner; 4],
    hubs: [Hub; 4],
    pub(crate) state: State,
    /// Way of the rack at which its lining is without force.
    lining: f64,
    /// Sense in which each brake acts in a step: that of the spin, or 0 where it holds the wheel.
    senses: [f64; 4],
}

/// Axes W of a wheel on a plane with this normal: along the wheel, to the left, along the normal.
pub(crate) fn wheel_axes(axle: Vector, normal: Vector) -> [Vector; 3] {
    let ahead = axle.cross(normal).unit();
    [ahead, normal.cross(ahead), normal]
}

/// A body in a state.
#[derive(Clone, Copy)]
struct Pose {
    place: Vector,
    axes: Axes,
    velocity: Vector,
    turning: Vector,
}

impl Pose {
    fn of(y: &[f64]) -> Self {
        let at = |k: usize| v(y[k], y[k + 1], y[k + 2]);
        let axes = Attitude([y[3], y[4], y[5], y[6]]).axes();
        Self { place: at(0), axes, velocity: at(7), turning: at(10) }
    }

    /// A place that is fixed to it, as an arm, and its velocity.
    fn carries(&self, own: Vector) -> (Vector, Vector) {
        let arm = self.axes.out(own);
        (arm, self.velocity + self.turning.cross(arm))
    }
}

/// Force and moment about a body's centre.
#[derive(Clone, Copy, Default)]
struct Load {
    force: Vector,
    moment: Vector,
}

impl Load {
    fn add(&mut self, arm: Vector, force: Vector) {
        self.force += force;
        self.moment += arm.cross(force);
    }
}

/// A strut's way and speed of shortening, with the direction in which it pushes the body.
#[derive(Clone, Copy)]
struct Stroke {
    way: f64,
    speed: f64,
    direction: Vector,
}

/// Places, forces and rates of an instant.
struct Now {
    rates: State,
    told: CarTold,
    tires: [Told; 4],
    /// Torques that would change the spin without a brake.
    turning: [f64; 4],
}

impl Vehicle {
    pub(crate) fn new(
        p: Parameters,
        body: Rigid,
        corners: [Corner; 4],
        hubs: [Hub; 4],
        (wheels, speed): ([Rolling; 4], f64),
    ) -> Self {
        let mut state = [0.0; ALL];
        let mut stand = |from: usize, place: Vector| {
            state[from..from + 3].copy_from_slice(&place.0);
            state[from + 3..from + 7].copy_from_slice(&Attitude::LEVEL.0);
            state[from + 7] = speed;
        };
        stand(0, body.centre);
        for (k, corner) in corners.iter().enumerate() {
            stand(BODY + k * WHEEL, corner.centre);
        }
        for (k, wheel) in wheels.iter().enumerate() {
            let from = BODY + k * WHEEL;
            state[from + SPIN] = wheel.spin;
            state[from + DEFLECTION..from + DEFLECTION + 2].copy_from_slice(&wheel.deflections);
        }
        Self { p, body, corners, hubs, state, lining: 0.0, senses: [1.0; 4] }
    }

    /// Spins of the wheels \[rad/s\].
    pub(crate) fn spins(&self) -> [f64; 4] {
        std::array::from_fn(|k| self.state[BODY + k * WHEEL + SPIN])
    }

    /// Gives the rack a velocity to the left \[m/s\].
    #[cfg(test)]
    pub(crate) fn nudge_rack(&mut self, velocity: f64) {
        self.state[RACK + 1] += velocity;
    }

    /// Its centre of mass, and how far the wheels' centres of both axles are before it and over the road.
    #[cfg(test)]
    pub(crate) fn stance(&self) -> (Vector, [Vector; 2]) {
        let at = |from: usize| v(self.state[from], self.state[from + 1], self.state[from + 2]);
        let wheels: [Vector; 4] = std::array::from_fn(|k| at(BODY + k * WHEEL));
        let mut sum = at(0) * self.body.mass;
        for (wheel, hub) in wheels.iter().zip(&self.hubs) {
            sum += *wheel * (hub.wheel_mass + CARRIER_MASS);
        }
        let centre = sum * (1.0 / self.p.vehicle_mass);
        (centre, [wheels[0] - centre, wheels[2] - centre].map(|w| v(w.x(), 0.0, w.z() + centre.z())))
    }

    /// What it tells under these brake torques.
    pub(crate) fn told(&self, road: &Road, brakes: [f64; 4]) -> CarTold {
        self.now(&self.state, road, brakes, self.senses(road, brakes)).told
    }

    /// Senses in which the brakes act: a wheel that stands is held as long as the brake can.
    fn senses(&self, road: &Road, brakes: [f64; 4]) -> [f64; 4] {
        let spins = self.spins();
        if spins.iter().all(|s| s.abs() > STANDS) {
            return spins.map(f64::signum);
        }
        let turning = self.now(&self.state, road, [0.0; 4], [1.0; 4]).turning;
        std::array::from_fn(|k| {
            if spins[k].abs() > STANDS {
                spins[k].signum()
            } else if turning[k].abs() <= brakes[k] {
                0.0
            } else {
                turning[k].signum()
            }
        })
    }

    /// Goes on for `dt` seconds.
    pub(crate) fn step(&mut self, road: &Road, brakes: [f64; 4], dt: f64) {
        let senses = self.senses(road, brakes);
        self.senses = senses;
        let start = self.state;
        let mut sum = [0.0; ALL];
        let mut at = start;
        for (h, weight) in [(0.5 * dt, 1.0), (0.5 * dt, 2.0), (dt, 2.0), (0.0, 1.0)] {
            let rates = self.now(&at, road, brakes, senses).rates;
            for i in 0..ALL {
                sum[i] += weight * rates[i];
                at[i] = start[i] + h * rates[i];
            }
        }
        let y = &mut self.state;
        for i in 0..ALL {
            y[i] = start[i] + dt / 6.0 * sum[i];
        }
        for from in std::iter::once(0).chain((0..4).map(|k| BODY + k * WHEEL)) {
            let length = y[from + 3..from + 7].iter().map(|q| q * q).sum::<f64>().sqrt();
            y[from + 3..from + 7].iter_mut().for_each(|q| *q /= length);
        }
        for (k, sense) in senses.into_iter().enumerate() {
            let spin = &mut y[BODY + k * WHEEL + SPIN];
            // a brake stops a wheel and does not turn it back
            if (brakes[k] > 0.0 && *spin * sense < 0.0) || sense == 0.0 {
                *spin = 0.0;
            }
        }
        self.settle(road, brakes);
        self.lining = self.lining.clamp(
            self.state[RACK] - self.p.rack_friction / RACK_LINING,
            self.state[RACK] + self.p.rack_friction / RACK_LINING,
        );
    }

    /// A tire in the air has no deflections, those of one that stands end where all of the contact slides.
    fn settle(&mut self, road: &Road, brakes: [f64; 4]) {
        let slow = self.state[7].abs() < 3.0;
        let needs = slow || (0..4).any(|k| self.deflection(k, road) <= 0.0);
        if !needs {
            return;
        }
        let tires = self.now(&self.state, road, brakes, self.senses).tires;
        for (k, tire) in tires.iter().enumerate() {
            let from = BODY + k * WHEEL + DEFLECTION;
            for i in 0..2 {
                let u = &mut self.state[from + i];
                if tire.force.z() <= 0.0 {
                    *u = 0.0;
                } else if tire.standing > 0.0 {
                    let beyond = *u - u.clamp(-tire.limits[i], tire.limits[i]);
                    *u -= tire.standing * beyond;
                }
            }
        }
    }

    /// About how far a tire is pressed in; camber and slope make no difference to whether it is.
    fn deflection(&self, k: usize, road: &Road) -> f64 {
        let from = BODY + k * WHEEL;
        let (height, _) = road.surface(self.state[from]);
        super::tire::RADIUS + 1e-3 - (self.state[from + 2] - height)
    }

    #[allow(clippy::too_many_lines)] // one balance of forces, whose parts need each other
    fn now(&self, y: &State, road: &Road, brakes: [f64; 4], senses: [f64; 4]) -> Now {
        let body = Pose::of(&y[..BODY]);
        let poses: [Pose; 4] = std::array::from_fn(|k| Pose::of(&y[BODY + k * WHEEL..]));
        let (rack, racking) = (y[RACK], y[RACK + 1]);
        let left = body.axes.0[1];
        let mut on_body = Load::default();
        let mut on_carrier = [Load::default(); 4];
        let mut on_rack = 0.0;
        let mut damped = 0.0;
        let mut told = CarTold::default();

        for k in 0..4 {
            for (i, link) in self.corners[k].links.iter().enumerate() {
                let (mut arm, mut velocity) = body.carries(link.ends[0]);
                if link.on_rack {
                    arm += left * rack;
                    velocity += body.turning.cross(left * rack) + left * racking;
                }
                let (carrier_arm, carrier_velocity) = poses[k].carries(link.ends[1]);
                let between = body.place + arm - poses[k].place - carrier_arm;
                let length = between.length();
                let toward_body = between * (1.0 / length);
                let speed = (velocity - carrier_velocity).dot(toward_body);
                let pull = link.standing + link.stiffness * (length - link.length) + link.damping * speed;
                damped += link.damping * speed * speed;
                on_carrier[k].add(carrier_arm, toward_body * pull);
                on_body.add(arm, toward_body * -pull);
                if link.on_rack {
                    on_rack -= pull * toward_body.dot(left);
                }
                told.wheels[k].links[i] = pull;
            }
        }

        let strokes: [Stroke; 4] = std::array::from_fn(|k| {
            let strut = &self.corners[k].strut;
            let (arm, velocity) = body.carries(strut.ends[0]);
            let top = body.place + arm;
            match strut.guide {
                Guide::Axis { axis, mount, standing } => {
                    // the mount's place on the carrier
                    let carrier_arm = top - poses[k].place;
                    let moves = velocity - poses[k].velocity - poses[k].turning.cross(carrier_arm);
                    let (off, moves) =
                        (poses[k].axes.back(carrier_arm) - strut.ends[1], poses[k].axes.back(moves));
                    let (along, speed) = (off.dot(axis), moves.dot(axis));
                    let (off, moves) = (off - axis * along, moves - axis * speed);
                    let force = poses[k].axes.out(standing - off * mount.0 - moves * mount.1);
                    damped += mount.1 * moves.dot(moves);
                    on_body.add(arm, force);
                    on_carrier[k].add(carrier_arm, -force);
                    Stroke { way: -along, speed: -speed, direction: poses[k].axes.out(axis) }
                }
                Guide::Ends { length } => {
                    let (carrier_arm, carrier_velocity) = poses[k].carries(strut.ends[1]);
                    let between = top - poses[k].place - carrier_arm;
                    let now = between.length();
                    let direction = between * (1.0 / now);
                    let speed = -(velocity - carrier_velocity).dot(direction);
                    Stroke { way: length - now, speed, direction }
                }
            }
        });
        for (k, stroke) in strokes.iter().enumerate() {
            let strut = &self.corners[k].strut;
            let roll = ANTI_ROLL * (stroke.way - strokes[k ^ 1].way);
            let push = strut.spring(stroke.way) + strut.damping * stroke.speed + roll;
            damped += strut.damping * stroke.speed * stroke.speed;
            let (arm, _) = body.carries(strut.ends[0]);
            let carrier_arm = match strut.guide {
                Guide::Axis { .. } => body.place + arm - poses[k].place,
                Guide::Ends { .. } => poses[k].carries(strut.ends[1]).0,
            };
            on_body.add(arm, stroke.direction * push);
            on_carrier[k].add(carrier_arm, stroke.direction * -push);
            told.wheels[k].strut = push;
        }

        let speed = body.velocity.length();
        let pressure = 0.5 * AIR * speed * speed;
        let drag = body.velocity * (-0.5 * AIR * DRAG * speed);
        let (air, air_velocity) = body.carries(self.body.air);
        on_body.add(air, drag);
        let mut airy = -drag.dot(air_velocity);
        for (place, area) in self.body.lift.iter().zip(LIFT) {
            let (arm, velocity) = body.carries(*place);
            let lift = UP * (area * pressure);
            on_body.add(arm, lift);
            airy -= lift.dot(velocity);
        }

        let mut rates = [0.0; ALL];
        let spins: [f64; 4] = std::array::from_fn(|k| y[BODY + k * WHEEL + SPIN]);
        // the viscous coupling drives the slower axle
        let drive = self.p.coupling_damping * 0.5 * (spins[2] + spins[3] - spins[0] - spins[1]);
        let drives = [0.5 * drive, 0.5 * drive, -0.5 * drive, -0.5 * drive];
        let (mut braked, mut rubbed) = (0.0, 0.0);
        damped -= (0..4).map(|k| drives[k] * spins[k]).sum::<f64>();
        let mut tires = [Told::default(); 4];
        let mut turning = [0.0; 4];
        for k in 0..4 {
            let (pose, hub, from) = (&poses[k], &self.hubs[k], BODY + k * WHEEL);
            let axle = pose.axes.out(self.corners[k].axle);
            let grip = self.p.road_friction * road.friction[k % 2].at(pose.place.x());
            let deflections = [y[from + DEFLECTION], y[from + DEFLECTION + 1]];
            let stands = Stands { pose, axle, spin: spins[k] };
            let ([ahead, aside, normal], tire) = self.stands_on(road, &stands, grip, deflections);
            let out = |of: Vector| ahead * of.x() + aside * of.y() + normal * of.z();
            let (force, moment) = (out(tire.force), out(tire.moment));
            turning[k] = moment.dot(axle) + drives[k];
            let brake = if senses[k] == 0.0 { turning[k] } else { brakes[k] * senses[k] };
            let spinning = if senses[k] == 0.0 { 0.0 } else { (turning[k] - brake) / hub.spin };

            let load = &mut on_carrier[k];
            load.force += force;
            // the moment about the axle spins the wheel and not the carrier
            load.moment += moment - axle * moment.dot(axle) + axle * brake;
            let mass = hub.wheel_mass + CARRIER_MASS;
            let acceleration = load.force * (1.0 / mass) - UP * GRAVITY;
            let sways = pose.turning.cross(axle);
            let own = axle.dot(pose.turning);
            let gyroscopic = sways * (hub.spin * spins[k]);
            let rest = load.moment - gyroscopic + sways * (hub.across * own);
            let about = axle * rest.dot(axle);
            let turn = about * (1.0 / hub.carrier) + (rest - about) * (1.0 / (hub.carrier + hub.across));
            moves(&mut rates[from..from + BODY], &y[from..from + BODY], pose, (acceleration, turn));
            rates[from + SPIN] = spinning;
            rates[from + DEFLECTION] = tire.rates[0];
            rates[from + DEFLECTION + 1] = tire.rates[1];

            let wheel_turn = turn - axle * turn.dot(axle) - sways * own;
            let on_hub = moment - axle * moment.dot(axle) + axle * (brake - drives[k])
                - gyroscopic
                - wheel_turn * hub.across;
            let carried = force - (acceleration + UP * GRAVITY) * hub.wheel_mass;
            let heading = wheel_axes(axle, UP);
            let level = |of: Vector| v(of.dot(heading[0]), of.dot(heading[1]), of.dot(heading[2]));
            told.wheels[k].carrier_force = level(carried);
            told.wheels[k].carrier_moment = level(on_hub);
            told.wheels[k].tire_force = level(force);
            told.wheels[k].brake = brake;
            braked += brake * (spins[k] - own);
            let rim = pose.turning - axle * own + axle * spins[k];
            rubbed -= force.dot(pose.velocity) + moment.dot(rim);
            tires[k] = tire;
        }

        let friction = if self.p.rack_friction > 0.0 {
            let most = self.p.rack_friction;
            (RACK_LINING * (rack - self.lining)).clamp(-most, most)
        } else {
            0.0
        };
        told.column = -self.p.column_stiffness * rack - self.p.column_damping * racking;
        damped += self.p.column_damping * racking * racking;
        rates[RACK] = racking;
        rates[RACK + 1] = (on_rack + told.column - friction) / RACK_MASS;

        let acceleration = on_body.force * (1.0 / self.body.mass) - UP * GRAVITY;
        let [a, b, c] = self.body.inertia;
        let own = body.axes.back(body.turning);
        let moment = body.axes.back(on_body.moment);
        let spun = own.cross(v(a * own.x(), b * own.y(), c * own.z()));
        let turn = moment - spun;
        let turn = body.axes.out(v(turn.x() / a, turn.y() / b, turn.z() / c));
        moves(&mut rates[..BODY], &y[..BODY], &body, (acceleration, turn));
        rates[TAKEN..].copy_from_slice(&[braked, damped, rubbed, airy]);

        // heading and yaw are those of the body's axis to the left, as a wheel's are those of its axle
        let heading = wheel_axes(left, UP)[0];
        let level = v(left.x(), left.y(), 0.0);
        told.speed = body.velocity.dot(heading);
        told.acceleration = acceleration.dot(heading);
        told.yaw_rate = UP.dot(level.cross(body.turning.cross(left))) / level.dot(level);
        Now { rates, told, tires, turning }
    }

    /// How a wheel stands on the road: axes W and what its tire does.
    fn stands_on(
        &self,
        road: &Road,
        wheel: &Stands<'_>,
        friction: f64,
        deflections: [f64; 2],
    ) -> ([Vector; 3], Told) {
        let Stands { pose, axle, spin } = wheel;
        let (height, slope) = road.surface(pose.place.x());
        let normal = v(-slope, 0.0, 1.0).unit();
        let axes = wheel_axes(*axle, normal);
        let sin = axle.dot(normal);
        let cos = (1.0 - sin * sin).sqrt();
        let distance = (pose.place.z() - height) * normal.z();
        let sways = pose.turning.cross(*axle);
        let cambering = sways.dot(normal) / cos;
        let flat = *axle - normal * sin;
        let yawing = normal.dot(flat.cross(sways)) / flat.dot(flat);
        let rising = pose.velocity.dot(normal);
        let footing = Footing {
            height: distance,
            camber: libm::asin(sin),
            sinking: -rising / cos - distance * cambering * sin / (cos * cos),
            velocity: [
                pose.velocity.dot(axes[0]) - yawing * distance * sin / cos,
                pose.velocity.dot(axes[1]) + cambering * distance,
            ],
            spin: *spin,
            friction,
        };
        (axes, self.p.tire.force(&footing, deflections))
    }

    /// Energy of motion, height, springs, and what has been taken since the start.
    #[cfg(test)]
    pub(crate) fn energy(&self) -> f64 {
        let y = &self.state;
        let body = Pose::of(&y[..BODY]);
        let own = body.axes.back(body.turning);
        let mut energy = 0.5 * self.body.mass * body.velocity.dot(body.velocity)
            + self.body.mass * GRAVITY * body.place.z()
            + (0..3).map(|i| 0.5 * self.body.inertia[i] * own.0[i] * own.0[i]).sum::<f64>()
            + y[TAKEN..].iter().sum::<f64>();
        let left = body.axes.0[1];
        let mut ways = [0.0; 4];
        for (k, way) in ways.iter_mut().enumerate() {
            let (hub, corner, from) = (&self.hubs[k], &self.corners[k], BODY + k * WHEEL);
            let pose = Pose::of(&y[from..]);
            let axle = pose.axes.out(corner.axle);
            let mass = hub.wheel_mass + CARRIER_MASS;
            let along = axle.dot(pose.turning);
            let all = pose.turning.dot(pose.turning);
            energy += 0.5 * mass * pose.velocity.dot(pose.velocity)
                + mass * GRAVITY * pose.place.z()
                + 0.5 * hub.carrier * all
                + 0.5 * hub.across * (all - along * along)
                + 0.5 * hub.spin * y[from + SPIN] * y[from + SPIN];
            for link in &corner.links {
                let rack = if link.on_rack { left * y[RACK] } else { Vector::default() };
                let between = body.place + body.axes.out(link.ends[0]) + rack
                    - pose.place
                    - pose.axes.out(link.ends[1]);
                let longer = between.length() - link.length;
                energy += longer * (link.standing + 0.5 * link.stiffness * longer);
            }
            let top = body.place + body.axes.out(corner.strut.ends[0]) - pose.place;
            *way = match corner.strut.guide {
                Guide::Axis { axis, mount, standing } => {
                    let off = pose.axes.back(top) - corner.strut.ends[1];
                    let along = off.dot(axis);
                    let off = off - axis * along;
                    energy += 0.5 * mount.0 * off.dot(off) - standing.dot(off);
                    -along
                }
                Guide::Ends { length } => length - (top - pose.axes.out(corner.strut.ends[1])).length(),
            };
            energy += corner.strut.energy(*way);
        }
        for axle in [0, 2] {
            let roll = ways[axle] - ways[axle + 1];
            energy += 0.5 * ANTI_ROLL * roll * roll;
        }
        energy
            + 0.5 * self.p.column_stiffness * y[RACK] * y[RACK]
            + 0.5 * RACK_MASS * y[RACK + 1] * y[RACK + 1]
    }
}

/// A wheel over the road.
struct Stands<'a> {
    pose: &'a Pose,
    axle: Vector,
    spin: f64,
}

/// Rates of a body with its accelerations.
fn moves(rates: &mut [f64], y: &[f64], pose: &Pose, (acceleration, turn): (Vector, Vector)) {
    rates[..3].copy_from_slice(&pose.velocity.0);
    rates[3..7].copy_from_slice(&Attitude([y[3], y[4], y[5], y[6]]).rate(pose.turning));
    rates[7..10].copy_from_slice(&acceleration.0);
    rates[10..13].copy_from_slice(&turn.0);
}
