//! The contact patch: stripes, pressure and bristles (8.5 to 8.10 of the specification).

use super::bristle::Bristle;
use super::footing::Footing;
use super::frames::{Motion, Vector};
use super::odd::Oddness;
use super::parameters::Parameters;

/// Stripes across the tire.
pub(crate) const STRIPES: usize = 6;
/// Bristles of a stripe.
pub(crate) const BRISTLES: usize = 30;

/// Force and moment of the patch on the belt, at the contact point and in the contact frame \[N, N.m\], and what
/// sliding turns into heat \[W\].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Load {
    pub(crate) force: Vector,
    pub(crate) moment: Vector,
    pub(crate) heat: f64,
}

/// Lagged force, moment and their rates (4.27): x, y, twist.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Lagged {
    pub(crate) value: Vector,
    pub(crate) rate: Vector,
}

/// The stripe grid (8.5) and its bristles.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Patch {
    bristles: [[Bristle; BRISTLES]; STRIPES],
    turns: [f64; BRISTLES],
    across: [f64; STRIPES],
    width: f64,
}

/// How pressure is spread (8.6, 8.7).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Pressure {
    /// Places of the bristles along the patch (4.17) \[m\].
    pub(crate) along: [f64; BRISTLES],
    /// Lengths of the stripes (4.20) \[m\].
    pub(crate) length: [f64; STRIPES],
    /// Pressure (4.24) \[Pa\].
    pub(crate) value: [[f64; BRISTLES]; STRIPES],
    /// Moment about the lateral axis (4.22) \[N.m\].
    pub(crate) moment: f64,
}

impl Patch {
    pub(crate) fn new(p: &Parameters) -> Self {
        let stripes = STRIPES as f64;
        let width = 3.0 * p.tire_width / (3.0 * stripes - 1.0);
        let across = std::array::from_fn(|i| width * (0.5 * (stripes + 1.0) - (i + 1) as f64));
        let bristles = [[Bristle::default(); BRISTLES]; STRIPES];
        Self { bristles, turns: [f64::NAN; BRISTLES], across, width }
    }

    /// Places of the bristles; those that came round start anew.
    fn places(&mut self, p: &Parameters, spin: f64) -> [f64; BRISTLES] {
        let all = BRISTLES as f64 * p.bristle_length;
        std::array::from_fn(|j| {
            let run = -((j + 1) as f64) * p.bristle_length - p.rolling_radius * spin;
            let turn = (run / all).floor();
            if turn != self.turns[j] {
                self.turns[j] = turn;
                for stripe in &mut self.bristles {
                    stripe[j] = Bristle::default();
                }
            }
            run - turn * all - 0.5 * all
        })
    }

    pub(crate) fn pressure(&mut self, p: &Parameters, belt: &Motion, foot: &Footing, drive: f64) -> Pressure {
        let along = self.places(p, belt.angles[1]);
        let round = p.cross_section_radius;
        let f = foot.penetration;
        let (power_x, power_y) =
            ((3.8 + 90.5 * f + 1450.0 * f * f).max(1.0), (6.0 + 129.0 * f + 2070.0 * f * f).max(1.0));
        let slope = foot.sine / foot.cosine;
        let length = self.across.map(|y| {
            let radius = p.tire_radius + (round * round - y * y).max(0.0).sqrt() - round;
            let s = foot.height + y * slope;
            let arc = if s < radius { 2.0 * radius * libm::acos((s / radius).max(-1.0)) } else { 0.0 };
            p.stripe_length_factor * arc
        });
        let logs = along.map(|x| libm::log((2.0 * x).abs().max(f64::MIN_POSITIVE)));
        let mut value = [[0.0; BRISTLES]; STRIPES];
        let (mut s0, mut s1, mut s2) = (0.0, 0.0, 0.0);
        for ((row, &y), &l) in value.iter_mut().zip(&self.across).zip(&length) {
            if l <= 0.0 {
                continue;
            }
            let outer = 1.0 - libm::pow((2.0 * y / p.tire_width).abs(), power_y);
            let own = libm::log(l);
            for ((shape, &x), log) in row.iter_mut().zip(&along).zip(&logs) {
                if x.abs() <= 0.5 * l {
                    *shape = (1.0 - libm::exp(power_x * (log - own))) * outer * l;
                    s0 += *shape;
                    s1 += x * *shape;
                    s2 += x * x * *shape;
                }
            }
        }
        let rolling = (p.rolling_radius * belt.rates[1]).clamp(-1.0, 1.0);
        let moment =
            -p.rolling_resistance_lever * foot.force * rolling - drive * (p.rolling_radius - foot.height);
        let turning = moment + p.patch_compliance_x * drive * foot.force;
        let cell = p.bristle_length * self.width;
        let regular = s0 * s2 - s1 * s1;
        // (4.24); a patch with all bristles at one place carries the force alone, one without any nothing
        let (a, b) = if regular > 1e-12 * s0 * s2 && regular > 0.0 {
            (
                (turning * s1 + foot.force * s2) / regular / cell,
                -(turning * s0 + foot.force * s1) / regular / cell,
            )
        } else if s0 > 0.0 {
            (foot.force / (s0 * cell), 0.0)
        } else {
            (0.0, 0.0)
        };
        for row in &mut value {
            row.iter_mut().zip(&along).for_each(|(v, x)| *v *= a + b * x);
        }
        Pressure { along, length, value, moment }
    }

    /// Moves the bristles on by `dt` to where the belt is now, and sums what they do (8.8 to 8.10).
    pub(crate) fn roll(
        &mut self,
        p: &Parameters,
        belt: &Motion,
        foot: &Footing,
        lagged: &Lagged,
        odd: &Oddness,
        dt: f64,
    ) -> Load {
        let ([fx, fy, mz], [dx, dy, dt_z]) = (lagged.value, lagged.rate);
        let pressure = self.pressure(p, belt, foot, fx);
        let bending = p.patch_compliance_y / (p.tire_radius * p.tire_radius);
        let (shift_x, shift_y) = (p.patch_compliance_x * fx, p.patch_compliance_y * fy);
        let (twist, bend) = (p.patch_compliance_twist * mz, bending * fy);
        let run = -p.rolling_radius * belt.rates[1];
        let [d_eps, d_yaw] = foot.tilting;
        let (s, c) = (foot.sine + odd.cone, foot.cosine);
        let rest = p.rolling_radius - foot.height;
        let cell = p.bristle_length * self.width;
        let rubber = (p.bristle_stiffness, p.bristle_damping);
        let friction = |zero: f64, reference: f64, pressure: f64| {
            odd.friction * (zero + (reference - zero) * pressure / p.friction_pressure)
        };
        let mut load = Load { force: [0.0, 0.0, foot.force], moment: [0.0, pressure.moment, 0.0], heat: 0.0 };
        for i in 0..STRIPES {
            let half = 0.5 * pressure.length[i];
            for (j, &x) in pressure.along.iter().enumerate() {
                let bristle = &mut self.bristles[i][j];
                let touches = x.abs() <= half && half > 0.0;
                if !touches {
                    bristle.release(rubber, dt);
                    continue;
                }
                // one that came in during the step moves with the road only from its entry on (10.4)
                let inside = if run < 0.0 { half - x } else { half + x };
                let came = !bristle.touches && run != 0.0;
                let span = if came { (inside / run.abs()).clamp(1e-3 * dt, dt) } else { dt };
                let value = pressure.value[i][j];
                let weight = value * cell;
                let normal = weight.max(0.0);
                let y_def = self.across[i] + shift_y + twist * x - bend * x * x;
                let x_def = x + shift_x;
                // v_0K of (4.30) where the bristle is halfway through the step: it changes along the patch by camber and
                // bending, and at the end of the step alone it would be wrong by half a step of the bristle
                let m = x - 0.5 * run * span;
                let dome = rest - m * m / (2.0 * p.rolling_radius);
                let y_phi = self.across[i] + shift_y + twist * m - bend * m * m + s * dome;
                let y_rate = p.patch_compliance_y * dy + p.patch_compliance_twist * (dt_z * m + mz * run)
                    - bending * (dy * m * m + 2.0 * fy * m * run)
                    + c * d_eps * dome
                    + s * (-foot.rising - m * run / p.rolling_radius)
                    + odd.ply * run;
                let v = [
                    run + p.patch_compliance_x * dx - d_yaw * y_phi + foot.velocity[0],
                    y_rate + d_yaw * (m + shift_x) + foot.velocity[1],
                ];
                let held = friction(p.friction_static_zero, p.friction_static_reference, value) * normal;
                let slid = friction(p.friction_sliding_zero, p.friction_sliding_reference, value) * normal;
                let pull = bristle.drag(rubber, v, span, held, |way| slid * odd.sliding(v, way));
                let force = pull.force;
                load.heat += pull.heat;
                load.force[0] += force[0];
                load.force[1] += force[1];
                load.moment[0] += y_def * weight;
                load.moment[2] += x_def * force[1] - y_def * force[0];
            }
        }
        load
    }
}
