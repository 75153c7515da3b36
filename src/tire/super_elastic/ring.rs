//! All elements: what they do in a step, and what they put on the rim.

use super::coupling::{Coupled, Coupling, Place, Places};
use super::element::{Friction, GAMMA, Pressed, Radial, Ray, Reached, Track, Wanted, press, reach};
use super::parameters::{Parameters, Prepared};
use crate::clone_in_place;
use serde::{Deserialize, Serialize};

/// The rim in the wheel's plane.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RimInPlane {
    /// Height of its centre over the road's datum \[m\].
    pub height: f64,
    /// Velocity forward and up \[m/s\].
    pub velocity: [f64; 2],
    /// Acceleration forward and up \[m/s²\].
    pub acceleration: [f64; 2],
    /// Spin angle and speed \[rad, rad/s\].
    pub angle: f64,
    /// Spin speed \[rad/s\].
    pub spin: f64,
    /// Spin acceleration \[rad/s²\].
    pub spin_acceleration: f64,
}

/// Distances of the elements from the rim's centre, their speeds, and what their rubber remembers.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Ring {
    /// Distance of the middle of each element \[m\].
    pub distance: Vec<f64>,
    /// Its speed \[m/s\].
    pub speed: Vec<f64>,
    /// Force of the part that relaxes \[N\].
    pub relaxing: Vec<f64>,
    /// Friction \[N\].
    pub friction: Vec<f64>,
    /// Force of the road on each element, forward and up \[N\].
    pub contact: Vec<[f64; 2]>,
    /// Where coupled elements are within a step.
    pub places: Places,
}

clone_in_place!(Ring { distance, speed, relaxing, friction, contact, places });

/// Stiffness and damping of an element that hold now.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Coefficients {
    /// \[N/m\]
    pub stiffness: f64,
    /// \[N.s/m\]
    pub damping: f64,
}

/// What all elements put on the rim, and what the road puts on them; forces forward and up \[N\].
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Sums {
    /// Of radial springs and dampers.
    pub radial: [f64; 2],
    /// All on the rim.
    pub exact: [f64; 2],
    /// Moment of that about the rim's centre, about y, beyond what the spinning of a rigid ring takes \[N.m\].
    pub moment: f64,
    /// Of the road.
    pub contact: [f64; 2],
    /// Elements that the road touches.
    pub touching: u32,
    /// Largest penetration \[m\].
    pub penetration: f64,
    /// Power that rubber and contact take \[W\].
    pub loss: f64,
    /// Coupled elements have not found their balance.
    pub unsettled: bool,
}

/// Parameters with what follows from them, and the coefficients that hold now.
#[derive(Clone, Copy)]
pub(super) struct Rubber<'a> {
    pub parameters: &'a Parameters,
    pub prepared: &'a Prepared,
    pub coefficients: Coefficients,
}

/// What is known of an element at the end of a step.
struct End {
    force: f64,
    loss: f64,
}

impl Rubber<'_> {
    /// The share that is left of the force that relaxes after a time, and that of a change within it.
    #[inline]
    fn relaxation(&self, time: f64) -> (f64, f64) {
        let p = self.parameters;
        if p.relaxing_stiffness == 0.0 {
            return (0.0, 0.0);
        }
        let way = time / p.relaxing_time;
        (libm::exp(-way), if way > 0.0 { -libm::expm1(-way) / way } else { 1.0 })
    }

    /// What acts on an element within a step, `time` after its beginning, at a sine and a spin speed.
    #[inline]
    fn radial(&self, ring: &Ring, n: usize, rim: &RimInPlane, along: [f64; 2], time: f64) -> Radial {
        let (p, prepared) = (self.parameters, self.prepared);
        let m = prepared.mass;
        let (kept, new) = self.relaxation(time);
        let relaxing = p.relaxing_stiffness * new;
        let Coefficients { stiffness, damping } = self.coefficients;
        let pulled = rim.acceleration[0] * along[0] + (rim.acceleration[1] + p.gravity) * along[1];
        Radial {
            mass: m,
            stiffness: stiffness + relaxing - m * rim.spin * rim.spin,
            damping,
            base: -stiffness * prepared.free + kept * ring.relaxing[n] - relaxing * ring.distance[n]
                + m * pulled,
            friction: Friction {
                stiffness: p.friction_stiffness,
                limit: p.friction_force,
                force: ring.friction[n],
                distance: ring.distance[n],
            },
        }
    }

    /// What acts on an element that nothing moves, and that has had time to relax.
    pub(super) fn at_rest(&self, rim: &RimInPlane, along: [f64; 2]) -> Radial {
        let (p, prepared) = (self.parameters, self.prepared);
        let (m, stiffness) = (prepared.mass, self.coefficients.stiffness);
        Radial {
            mass: m,
            stiffness: stiffness - m * rim.spin * rim.spin,
            damping: 0.0,
            base: m * p.gravity * along[1] - stiffness * prepared.free,
            friction: Friction {
                stiffness: p.friction_stiffness,
                limit: p.friction_force,
                force: 0.0,
                distance: prepared.free,
            },
        }
    }

    /// True if what it does depends on nothing but how it is pressed now.
    fn forgets(&self) -> bool {
        self.parameters.relaxing_stiffness == 0.0 && self.parameters.friction_force == 0.0
    }

    /// What spring and damper pull an element with, and the power that the damper takes.
    #[inline]
    fn spring(&self, at: &Reached) -> End {
        let Coefficients { stiffness, damping } = self.coefficients;
        End {
            force: stiffness * (at.distance - self.prepared.free) + damping * at.speed,
            loss: damping * at.speed * at.speed,
        }
    }

    /// Takes what the rubber of an element remembers to the end of a step of `time` seconds, at the distance there; returns what
    /// the rubber pulls it with, and the power that it takes.
    #[inline]
    fn remember(&self, ring: &mut Ring, n: usize, radial: &Radial, reached: &Reached, time: f64) -> End {
        let p = self.parameters;
        let End { mut force, mut loss } = self.spring(reached);
        if p.relaxing_stiffness > 0.0 {
            let (kept, new) = self.relaxation(time);
            let way = reached.distance - ring.distance[n];
            ring.relaxing[n] = kept * ring.relaxing[n] + p.relaxing_stiffness * new * way;
            force += ring.relaxing[n];
            loss += ring.relaxing[n] * ring.relaxing[n] / (p.relaxing_stiffness * p.relaxing_time);
        }
        if p.friction_force > 0.0 {
            let (friction, slope) = radial.friction.at(reached.distance);
            ring.friction[n] = friction;
            force += friction;
            loss += if slope == 0.0 { (friction * reached.speed).max(0.0) } else { 0.0 };
        }
        End { force, loss }
    }
}

/// Unit vector along ray `n` at a spin angle with this sine and cosine.
#[inline]
pub(super) fn along(prepared: &Prepared, n: usize, (sin, cos): (f64, f64)) -> [f64; 2] {
    let [x, z] = prepared.rays[n];
    [x * cos + z * sin, z * cos - x * sin]
}

#[inline]
fn ray<'a>(rubber: &Rubber<'a>, rim: &RimInPlane, along: [f64; 2]) -> Ray<'a> {
    Ray {
        along,
        rim_height: rim.height,
        rim_velocity: rim.velocity,
        spin: rim.spin,
        turning: rim.velocity[0] * rubber.prepared.curvature,
        to_tread: 0.5 * rubber.parameters.element_thickness,
        offsets: &rubber.prepared.offsets,
    }
}

/// Where an element goes if nothing changes.
#[inline]
fn ahead(from: &Place, h: f64) -> f64 {
    from.distance + h * (from.speed + h * from.acceleration)
}

/// Where the last stage of a step begins, a time after its start, from what was reached at the first one.
fn between(start: &Place, first: &Place, time: f64) -> Place {
    let Place { speed, acceleration, .. } = *first;
    Place { distance: start.distance + time * speed, speed: start.speed + time * acceleration, acceleration }
}

impl Reached {
    fn place(&self) -> Place {
        Place { distance: self.distance, speed: self.speed, acceleration: self.acceleration }
    }
}

/// A stage of a step: how the rim and the road are there, `time` after the step's beginning, and the share of the step that is implicit.
struct Stage<'a, T> {
    rubber: &'a Rubber<'a>,
    rim: &'a RimInPlane,
    turned: (f64, f64),
    track: &'a T,
    time: f64,
    h: f64,
}

/// Sweeps over coupled elements until all are in balance: each leaves a share of what the one before left, the coupling's over that of
/// an element with its mass.
const MOST_SWEEPS: usize = 400;
/// A balance is found when no element moves by more in a sweep \[m\]: at a stiffness of 1e6 N/m the last sweep changes a force by a
/// thousandth of a newton. What is left is as much as that over the share by which sweeps shrink.
const SETTLED: f64 = 1e-9;

impl<T: Track> Stage<'_, T> {
    fn along(&self, n: usize) -> [f64; 2] {
        along(self.rubber.prepared, n, self.turned)
    }

    /// A place of an element with the acceleration that the road's last force on it makes.
    fn accelerated(&self, ring: &Ring, n: usize, place: Place) -> Place {
        let along = self.along(n);
        let radial = self.rubber.radial(ring, n, self.rim, along, 0.0);
        let [x, z] = ring.contact[n];
        let pulls = radial.base + radial.stiffness * place.distance + radial.damping * place.speed;
        Place { acceleration: (x * along[0] + z * along[1] - pulls) / radial.mass, ..place }
    }

    /// Where an element gets, with what acts on it besides the road.
    #[inline]
    fn reach(
        &self,
        ring: &Ring,
        n: usize,
        from: &Place,
        felt: &Coupled,
        guess: f64,
        wanted: Wanted,
    ) -> (Radial, Reached) {
        let along = self.along(n);
        let radial = self.rubber.radial(ring, n, self.rim, along, self.time);
        let coupled = felt.with(&radial);
        let ray = ray(self.rubber, self.rim, along);
        let contact = &self.rubber.prepared.contact;
        let reached =
            reach(&coupled, &ray, self.track, contact, (from.distance, from.speed, self.h), guess, wanted);
        (radial, reached)
    }

    /// All elements in balance with their neighbours: each in turn, with what the others have found so far (Gauss and Seidel), which
    /// leads to the least of a convex energy. False if it has not.
    fn settle(&self, ring: &Ring, coupling: &Coupling, places: &mut Places) -> bool {
        for (to, from) in places.to.iter_mut().zip(&places.from) {
            let speed = from.speed + self.h * from.acceleration;
            *to = Place { distance: ahead(from, self.h), speed, ..*from };
        }
        for _ in 0..MOST_SWEEPS {
            let mut moved = 0.0_f64;
            for n in 0..places.to.len() {
                let felt = coupling.on(&places.to, n).about(&places.to[n]);
                let guess = places.to[n].distance;
                let (_, reached) = self.reach(ring, n, &places.from[n], &felt, guess, Wanted::Force);
                moved = moved.max((reached.distance - places.to[n].distance).abs());
                places.to[n] = reached.place();
            }
            if moved <= SETTLED {
                return true;
            }
        }
        false
    }
}

/// A stage for elements that the road is far below, of rubber that forgets: the equation is a straight line, the same for all of them
/// but for what pulls on them.
struct Aloft {
    /// One over the time that is implicit \[1/s\].
    per: f64,
    /// One over the slope of the force with the distance \[m/N\].
    compliance: f64,
    /// Force for the speed before, and for the way since then.
    by_speed: f64,
    by_way: f64,
    /// Force of the spring without its mass, and what the rim's acceleration and gravity add along the ray \[N\].
    sprung: f64,
    pulled: [f64; 2],
    /// Height that the middle of an element stays over by the thickness of its outer half, and half of its length \[m\].
    clear: f64,
    half_length: f64,
}

impl Aloft {
    fn new(stage: &Stage<'_, impl Track>) -> Self {
        let Stage { rubber, rim, .. } = stage;
        let (m, per) = (rubber.prepared.mass, 1.0 / stage.h);
        let Coefficients { stiffness, damping } = rubber.coefficients;
        let by_speed = m * per;
        let by_way = (by_speed + damping) * per;
        Self {
            per,
            compliance: 1.0 / (by_way + stiffness - m * rim.spin * rim.spin),
            by_speed,
            by_way,
            sprung: stiffness * rubber.prepared.free,
            pulled: [m * rim.acceleration[0], m * (rim.acceleration[1] + rubber.parameters.gravity)],
            clear: stage.track.highest() - rim.height,
            half_length: rubber.prepared.offsets.last().map_or(0.0, |offset| offset.abs()),
        }
    }

    /// Where an element gets; none if the road might touch it there.
    #[inline]
    fn reach(&self, stage: &Stage<'_, impl Track>, n: usize, from: &Place) -> Option<Reached> {
        let [cos, sin] = stage.along(n);
        let pulled = self.pulled[0] * cos + self.pulled[1] * sin;
        let force = self.by_way * from.distance + self.by_speed * from.speed + self.sprung - pulled;
        let distance = force * self.compliance;
        let out = distance + 0.5 * stage.rubber.parameters.element_thickness;
        if sin < 0.0 && out * sin - self.half_length * cos.abs() <= self.clear {
            return None;
        }
        let speed = (distance - from.distance) * self.per;
        let acceleration = (speed - from.speed) * self.per;
        Some(Reached { distance, speed, acceleration, pressed: Pressed::default() })
    }
}

impl Ring {
    /// Elements without load.
    pub(super) fn free(parameters: &Parameters, prepared: &Prepared) -> Self {
        let n = prepared.rays.len();
        Self {
            distance: vec![prepared.free; n],
            speed: vec![0.0; n],
            relaxing: vec![0.0; n],
            friction: vec![0.0; n],
            contact: vec![[0.0; 2]; n],
            places: Places::new(parameters, n),
        }
    }

    /// Whether it fits parameters that say how many elements there are.
    pub(super) fn fits(&self, parameters: &Parameters, prepared: &Prepared) -> bool {
        let n = prepared.rays.len();
        let Places { from, to } = Places::new(parameters, n);
        [&self.distance, &self.speed, &self.relaxing, &self.friction].iter().all(|v| v.len() == n)
            && self.contact.len() == n
            && self.places.from.len() == from.len()
            && self.places.to.len() == to.len()
    }

    /// Moves all elements by `dt` > 0 seconds, in which the rim moves so that `rim` has it at both stages; `tracks` has the road
    /// at both.
    pub(super) fn step(
        &mut self,
        rubber: &Rubber<'_>,
        rim: &[RimInPlane; 2],
        tracks: &[impl Track; 2],
        dt: f64,
    ) -> Sums {
        if let Some(coupling) = Coupling::new(rubber.parameters, rubber.prepared) {
            return self.step_coupled(&coupling, rubber, rim, tracks, dt);
        }
        let (h, alone) = (GAMMA * dt, Coupled::default());
        let stages = [(0, h), (1, dt)].map(|(i, time)| Stage {
            rubber,
            rim: &rim[i],
            turned: libm::sincos(rim[i].angle),
            track: &tracks[i],
            time,
            h,
        });
        let aloft = rubber.forgets().then(|| [Aloft::new(&stages[0]), Aloft::new(&stages[1])]);
        let mut sums = Sums::default();
        for n in 0..self.distance.len() {
            let start = self.place(n);
            if let Some([first, second]) = &aloft
                && let Some(at) = first.reach(&stages[0], n, &start)
                && let Some(last) = second.reach(&stages[1], n, &between(&start, &at.place(), dt - h))
            {
                let end = rubber.spring(&last);
                (self.distance[n], self.speed[n], self.contact[n]) = (last.distance, last.speed, [0.0; 2]);
                sums.add(rubber, stages[1].rim, stages[1].along(n), &last, &end);
                continue;
            }
            let guess = ahead(&stages[0].accelerated(self, n, start), h);
            let (_, first) = stages[0].reach(self, n, &start, &alone, guess, Wanted::Place);
            let from = between(&start, &first.place(), dt - h);
            let (radial, last) = stages[1].reach(self, n, &from, &alone, ahead(&from, h), Wanted::Force);
            self.arrive(&mut sums, &stages[1], n, &radial, &last);
        }
        sums
    }

    /// The same where elements depend on their neighbours: at both stages all of them find their balance together.
    fn step_coupled(
        &mut self,
        coupling: &Coupling,
        rubber: &Rubber<'_>,
        rim: &[RimInPlane; 2],
        tracks: &[impl Track; 2],
        dt: f64,
    ) -> Sums {
        let h = GAMMA * dt;
        let turned = [0, 1].map(|i| libm::sincos(rim[i].angle));
        let mut places = std::mem::take(&mut self.places);
        for n in 0..self.distance.len() {
            places.from[n] = self.place(n);
        }
        let stage = Stage { rubber, rim: &rim[0], turned: turned[0], track: &tracks[0], time: h, h };
        let mut settled = stage.settle(self, coupling, &mut places);
        for (from, first) in places.from.iter_mut().zip(&places.to) {
            *from = between(from, first, dt - h);
        }
        let stage = Stage { rubber, rim: &rim[1], turned: turned[1], track: &tracks[1], time: dt, h };
        settled &= stage.settle(self, coupling, &mut places);
        let mut sums = Sums { unsettled: !settled, ..Sums::default() };
        for n in 0..self.distance.len() {
            let felt = coupling.on(&places.to, n).about(&places.to[n]);
            let guess = places.to[n].distance;
            let (radial, last) = stage.reach(self, n, &places.from[n], &felt, guess, Wanted::Force);
            self.arrive(&mut sums, &stage, n, &radial, &last);
        }
        sums.loss += coupling.energy(&places.to).1;
        self.places = places;
        sums
    }

    fn place(&self, n: usize) -> Place {
        Place { distance: self.distance[n], speed: self.speed[n], acceleration: 0.0 }
    }

    /// Takes an element to the end of a step.
    fn arrive(
        &mut self,
        sums: &mut Sums,
        at: &Stage<'_, impl Track>,
        n: usize,
        radial: &Radial,
        last: &Reached,
    ) {
        let end = at.rubber.remember(self, n, radial, last, at.time);
        (self.distance[n], self.speed[n]) = (last.distance, last.speed);
        self.contact[n] = last.pressed.force;
        sums.add(at.rubber, at.rim, at.along(n), last, &end);
    }

    /// The sums where the elements are, which have this acceleration along their rays at rest: none.
    pub(super) fn evaluate(&mut self, rubber: &Rubber<'_>, rim: &RimInPlane, track: &impl Track) -> Sums {
        let turned = libm::sincos(rim.angle);
        let coupling = Coupling::new(rubber.parameters, rubber.prepared);
        let mut places = std::mem::take(&mut self.places);
        for (n, place) in places.to.iter_mut().enumerate() {
            *place = self.place(n);
        }
        let mut sums = Sums::default();
        for n in 0..self.distance.len() {
            let along = along(rubber.prepared, n, turned);
            let (distance, speed) = (self.distance[n], self.speed[n]);
            let pressed = match along[1] < 0.0 {
                true => {
                    press(&ray(rubber, rim, along), track, &rubber.prepared.contact, (distance, speed), 0.0)
                }
                false => Pressed::default(),
            };
            let radial = rubber.radial(self, n, rim, along, 0.0);
            let reached = Reached { distance, speed, acceleration: 0.0, pressed };
            let end = rubber.remember(self, n, &radial, &reached, 0.0);
            let force = radial.base
                + radial.stiffness * distance
                + radial.damping * speed
                + radial.friction.at(distance).0
                + coupling.map_or(0.0, |coupling| coupling.on(&places.to, n).force);
            let acceleration = (pressed.along - force) / rubber.prepared.mass;
            self.contact[n] = pressed.force;
            sums.add(rubber, rim, along, &Reached { acceleration, ..reached }, &end);
        }
        sums.loss += coupling.map_or(0.0, |coupling| coupling.energy(&places.to).1);
        self.places = places;
        sums
    }

    /// Energy of the elements' motion along their rays, of their springs and of the contact \[J\], without the height.
    pub(super) fn energy(&self, rubber: &Rubber<'_>, rim: &RimInPlane, track: &impl Track) -> f64 {
        let turned = libm::sincos(rim.angle);
        let (p, prepared) = (rubber.parameters, rubber.prepared);
        let coupled = Coupling::new(p, prepared).map_or(0.0, |coupling| {
            let places: Vec<Place> = (0..self.distance.len()).map(|n| self.place(n)).collect();
            coupling.energy(&places).0
        });
        let own: f64 = (0..self.distance.len())
            .map(|n| {
                let along = along(prepared, n, turned);
                let (r, v) = (self.distance[n], self.speed[n]);
                let [x, z] = [
                    rim.velocity[0] + v * along[0] + r * rim.spin * along[1],
                    rim.velocity[1] + v * along[1] - r * rim.spin * along[0],
                ];
                let height = rim.height + r * along[1];
                let mut energy = 0.5 * prepared.mass * (x * x + z * z) + prepared.mass * p.gravity * height;
                energy += 0.5 * rubber.coefficients.stiffness * (r - prepared.free) * (r - prepared.free);
                if p.relaxing_stiffness > 0.0 {
                    energy += 0.5 * self.relaxing[n] * self.relaxing[n] / p.relaxing_stiffness;
                }
                if p.friction_stiffness > 0.0 {
                    energy += 0.5 * self.friction[n] * self.friction[n] / p.friction_stiffness;
                }
                if along[1] < 0.0 {
                    energy += ray(rubber, rim, along).stored(track, &prepared.contact, r);
                }
                energy
            })
            .sum();
        own + coupled
    }
}

impl Sums {
    #[inline]
    fn add(&mut self, rubber: &Rubber<'_>, rim: &RimInPlane, along: [f64; 2], at: &Reached, end: &End) {
        let (m, g) = (rubber.prepared.mass, rubber.parameters.gravity);
        let (r, v, spin) = (at.distance, at.speed, rim.spin);
        // the acceleration of the element (4-29), with that of the spin
        let outward = at.acceleration - r * spin * spin;
        let forward = r * rim.spin_acceleration + 2.0 * v * spin;
        let acceleration = [
            rim.acceleration[0] + outward * along[0] + forward * along[1],
            rim.acceleration[1] + outward * along[1] - forward * along[0],
        ];
        let pressed = &at.pressed;
        for i in 0..2 {
            self.radial[i] += end.force * along[i];
            self.contact[i] += pressed.force[i];
            self.exact[i] += pressed.force[i] - m * acceleration[i];
        }
        self.exact[1] -= m * g;
        // about the rim's centre: the road's, less what turning and being carried takes beyond a ring at the free radius
        let carried = r * (along[1] * rim.acceleration[0] - along[0] * (rim.acceleration[1] + g));
        let free = rubber.prepared.free;
        let turning = r * forward - free * free * rim.spin_acceleration;
        self.moment += pressed.moment - m * (turning + carried);
        self.touching += u32::from(pressed.points > 0);
        self.penetration = self.penetration.max(pressed.penetration);
        self.loss += end.loss + pressed.loss;
    }
}
