//! How fast the bristles pass through the patch: `cargo bench --bench kernel`. The loop over single bristles that the
//! time steps had before is kept here as what the present one is measured against, in the same run. Every figure is the
//! median of several runs, in turn; ratios are what to compare between machines.
#![allow(clippy::unwrap_used)]

use latsch::model::{Model, Native, Settings, Slave};
use latsch::rig::RingBrushFlatTrack;
use latsch::solver::lanes::levels;
use latsch::tire::ring_brush::{
    Bristles, Contact, Deformation, Friction, Loads, Moments, Passage, Prepared, Pressure, Shape, Sums, Tops,
    advance,
};
use std::hint::black_box;
use std::time::Instant;

const ROUNDS: usize = 15;
const STEPS: usize = 2000;
const STEP: f64 = 1e-4;
const SPEED: f64 = 10.0;

/// The bristles as the former loop kept them: bristle j of stripe i has the index i n + j.
#[derive(Default)]
struct OneByOne {
    x: Vec<f64>,
    laps: Vec<f64>,
    lengths: Vec<f64>,
    deflection_x: Vec<f64>,
    deflection_y: Vec<f64>,
    pressure: Vec<f64>,
    stick: Vec<bool>,
}

impl OneByOne {
    fn new(stripes: usize, n: usize) -> Self {
        Self {
            x: vec![0.0; n],
            laps: vec![0.0; n],
            lengths: vec![0.0; stripes],
            deflection_x: vec![0.0; stripes * n],
            deflection_y: vec![0.0; stripes * n],
            pressure: vec![0.0; stripes * n],
            stick: vec![false; stripes * n],
        }
    }

    fn wind(&mut self, tire: &Prepared, spin: f64) {
        let p = tire.parameters();
        let (cell, ring) = (p.bristle_length, p.ring_length());
        let n = self.x.len();
        for j in 0..n {
            let unwound = -(j as f64 + 1.0) * cell - p.rolling_radius * spin;
            let lap = (unwound / ring).floor();
            self.x[j] = unwound - lap * ring - 0.5 * ring;
            if std::mem::replace(&mut self.laps[j], lap) != lap {
                for k in (j..self.stick.len()).step_by(n) {
                    self.deflection_x[k] = 0.0;
                    self.deflection_y[k] = 0.0;
                    self.stick[k] = false;
                }
            }
        }
    }

    fn pass(&mut self, tire: &Prepared, passage: &Passage<'_>) -> Sums {
        let p = tire.parameters();
        let Passage { contact, tops, deformation, moment, spin, shift, friction, dt } = *passage;
        self.wind(tire, spin);
        let shape = Shape::new(p, contact.penetration);
        let (n, area) = (self.x.len(), p.cell_area());
        let stripes = || tire.stripe_places().iter().zip(tire.stripe_radii()).enumerate();
        let mut moments = Moments { s0: 0.0, s1: 0.0, s2: 0.0 };
        let mut longest: f64 = 0.0;
        for (i, (y, radius)) in stripes() {
            let length = contact.stripe_length(p, *y, *radius);
            longest = longest.max(length);
            let cells = &mut self.pressure[i * n..][..n];
            let factor = shape.stripe(*y, length);
            for (cell, x) in cells.iter_mut().zip(&self.x) {
                *cell = if x.abs() <= 0.5 * length { shape.along(*x, length) * factor } else { 0.0 };
                moments.s0 += *cell;
                moments.s1 += x * *cell;
                moments.s2 += x * x * *cell;
            }
        }
        let tilting = moment + deformation.shift_x * contact.normal_force;
        let pressure = Pressure::new(p, &moments, contact.normal_force, tilting, longest);

        let law = Friction::new(p);
        let mut sums = Sums::default();
        let mut stored = 0.0;
        let square = |[x, y]: [f64; 2]| x * x + y * y;
        for (i, (y, radius)) in stripes() {
            let length = contact.stripe_length(p, *y, *radius);
            let old_length = std::mem::replace(&mut self.lengths[i], length);
            for (j, &x) in self.x.iter().enumerate() {
                let k = i * n + j;
                let cell_pressure = pressure.at(x, self.pressure[k]);
                self.pressure[k] = cell_pressure;
                let old = [self.deflection_x[k], self.deflection_y[k]];
                stored -= square(old);
                if cell_pressure == 0.0 {
                    let decay = p.bristle_damping / (p.bristle_damping + p.bristle_stiffness * dt);
                    let new = old.map(|x| x * decay);
                    stored += square(new);
                    [self.deflection_x[k], self.deflection_y[k]] = new;
                    self.stick[k] = false;
                    continue;
                }
                let normal = area * cell_pressure;
                let limits = law.limits(cell_pressure, friction * normal);
                let inside = 0.5 * length - x.abs();
                let inside_before = 0.5 * old_length - (x + shift).abs();
                let enters = inside > 0.0 && inside_before < 0.0 && !p.whole_step_entry;
                let loaded = if enters { inside / (inside - inside_before) } else { 1.0 };
                let middle = x + 0.5 * shift * loaded;
                let velocity = tops.velocity(middle, *y);
                let step = advance(p, old, velocity, self.stick[k], &limits, dt * loaded);
                [self.deflection_x[k], self.deflection_y[k]] = step.deflection;
                self.stick[k] = step.stick;
                stored += square(step.deflection);
                sums.work += loaded * tops.power(middle, *y, step.force);
                let [place_x, place_y] = deformation.place(x, *y);
                let [force_x, force_y] = step.force;
                sums.force[0] += force_x;
                sums.force[1] += force_y;
                sums.moment[0] += place_y * normal;
                sums.moment[1] += place_x * force_y - place_y * force_x;
                sums.touching += 1.0;
                sums.highest = sums.highest.max(cell_pressure);
                sums.negative += (-normal).max(0.0);
                if !step.stick {
                    sums.sliding += 1.0;
                    sums.power += libm::hypot(force_x, force_y) * step.slip_speed;
                    sums.slip += normal.max(0.0) * step.slip_speed;
                }
            }
        }
        sums.work -= 0.5 * p.bristle_stiffness * stored;
        sums
    }
}

/// A tire that rolls at combined slip under some 4 kN: the patch that it has all the time, and its spin angle and rate.
struct Rolling {
    tire: Prepared,
    contact: Contact<f64>,
    tops: Tops<f64>,
    deformation: Deformation<f64>,
    moment: f64,
    spin: f64,
    spin_rate: f64,
}

impl Rolling {
    fn new(stripes: f64, bristles: f64) -> Self {
        let mut rig = Native::<RingBrushFlatTrack>::new(&Settings::default()).unwrap();
        let (finer, narrower) = (30.0 / bristles, 6.0 / stripes);
        let values = [
            ("path_speed", SPEED),
            ("slip", 0.03),
            ("slip_angle", 0.03),
            ("stripes", stripes),
            ("bristles_per_stripe", bristles),
            ("bristle_length", 0.014 * finer),
            ("bristle_stiffness", 4e4 * finer * narrower),
            ("bristle_damping", 0.65 * finer * narrower),
        ];
        for (name, value) in values {
            let index = rig.find(name).unwrap();
            rig.set(index, value).unwrap();
        }
        rig.start(0.0, None).unwrap();
        rig.finish_start().unwrap();
        let tire = rig.model().tire();
        let (p, state) = (tire.prepared.parameters().clone(), &tire.state);
        let contact = Contact::new(&p, &state.belt);
        let spin_rate = state.belt.rates.y;
        let rest = Loads::default();
        Self {
            contact,
            tops: Tops::new(&p, &contact, spin_rate, &state.lag.lagged, &rest),
            deformation: Deformation::new(&p, &state.lag.lagged),
            moment: state.patch.moment.y,
            spin: state.belt.angles.y,
            spin_rate,
            tire: Prepared::new(&p, &latsch::road::Road::default()).unwrap(),
        }
    }

    /// Nanoseconds that a step takes, and the mean force.
    fn run(&self, mut pass: impl FnMut(&Passage<'_>) -> Sums) -> (f64, [f64; 2]) {
        let turn = self.spin_rate * STEP;
        let mut force = [0.0; 2];
        let start = Instant::now();
        for k in 1..=STEPS {
            let sums = pass(&Passage {
                contact: &self.contact,
                tops: &self.tops,
                deformation: &self.deformation,
                moment: self.moment,
                spin: self.spin + turn * k as f64,
                shift: self.tire.parameters().rolling_radius * turn,
                friction: 1.0,
                dt: STEP,
            });
            let sums = black_box(sums);
            force = [force[0] + sums.force[0], force[1] + sums.force[1]];
        }
        (start.elapsed().as_secs_f64() * 1e9 / STEPS as f64, force.map(|f| f / STEPS as f64))
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn main() {
    // cargo test runs benchmarks with --test to see that they work
    let rounds = if std::env::args().any(|a| a == "--test") { 1 } else { ROUNDS };
    println!(
        "{} on the flat track: bristles in a step, beside belt, side wall and road\n",
        RingBrushFlatTrack::NAME
    );
    println!(
        "  bristles   in contact   instructions        ns a step   ns a bristle in contact   times the former loop"
    );
    for (stripes, bristles) in [(5, 48), (6, 30), (20, 48)] {
        let rolling = Rolling::new(f64::from(stripes), f64::from(bristles));
        let p = rolling.tire.parameters();
        let levels = levels();
        let mut former = OneByOne::new(stripes as usize, bristles as usize);
        let mut present: Vec<Bristles> = levels.iter().map(|_| Bristles::new(p)).collect();
        let (mut times, mut ratios) = (vec![Vec::new(); levels.len()], vec![Vec::new(); levels.len()]);
        let (mut old_times, mut touching) = (Vec::new(), 0.0);
        for _ in 0..rounds {
            let (old, old_force) = rolling.run(|passage| former.pass(&rolling.tire, passage));
            old_times.push(old);
            for (k, (_, level)) in levels.iter().enumerate() {
                let (new, force) = rolling.run(|passage| {
                    let (sums, _) = rolling.tire.pass(*level, &mut present[k], passage).unwrap();
                    touching = sums.touching;
                    sums
                });
                for c in 0..2 {
                    let apart = (force[c] - old_force[c]).abs();
                    assert!(apart < 0.02 * old_force[c].abs(), "{force:?} for {old_force:?}");
                }
                times[k].push(new);
                ratios[k].push(old / new);
            }
        }
        let line = |name: &str, time: f64, ratio: f64| {
            println!(
                "  {:<8}   {touching:10.0}   {name:<16}   {time:10.0}   {:23.1}   {ratio:21.1}",
                format!("{stripes}x{bristles}"),
                time / touching
            );
        };
        line("former loop", median(old_times), 1.0);
        for (k, (name, _)) in levels.iter().enumerate() {
            line(name, median(times[k].clone()), median(ratios[k].clone()));
        }
    }
}
