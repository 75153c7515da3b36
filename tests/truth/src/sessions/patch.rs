//! The contact patch: stripes, pressure and bristles (8.3 to 8.10 of the specification).

use super::frames::{Motion, Vector, cross};
use super::parameters::Parameters;

/// Stripes across the tire.
pub(crate) const STRIPES: usize = 6;
/// Bristles of a stripe.
pub(crate) const BRISTLES: usize = 30;

/// What of the patch is other than the model has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Oddness {
    /// Factor on all friction.
    pub(crate) friction: f64,
    /// Share of the sliding friction that is lost at high sliding speed, and the speed at which two thirds of it are
    /// \[m/s\].
    pub(crate) fall: (f64, f64),
    /// Share by which sliding friction is larger where the tread slides forward, and smaller backward.
    pub(crate) nap: f64,
    /// Factor on the vertical spring of the belt.
    pub(crate) stiffness: f64,
    /// Angle by which the tread runs askew on the belt, in the sense of its rotation \[rad\].
    pub(crate) ply: f64,
    /// Angle of the cone that the tread is \[rad\].
    pub(crate) cone: f64,
}

impl Default for Oddness {
    fn default() -> Self {
        Self { friction: 1.0, fall: (0.0, 1.0), nap: 0.0, stiffness: 1.0, ply: 0.0, cone: 0.0 }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Bristle {
    /// Deflection: bottom minus top, contact frame \[m\].
    way: [f64; 2],
    sticks: bool,
    touches: bool,
}

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

/// Where the belt is over a flat road: 8.3 and 8.4.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Footing {
    /// Camber and yaw of the belt and their rates \[rad, rad/s\].
    tilt: [f64; 2],
    tilting: [f64; 2],
    sine: f64,
    cosine: f64,
    /// From belt centre to contact point \[m\], and its rate.
    pub(crate) height: f64,
    rising: f64,
    /// Velocity of the contact point in the contact frame \[m/s\].
    pub(crate) velocity: [f64; 2],
    /// Penetration (4.14) \[m\] and normal force (4.15) \[N\].
    pub(crate) penetration: f64,
    pub(crate) force: f64,
    /// Belt centre over the contact point, contact frame \[m\].
    pub(crate) arm: Vector,
}

impl Footing {
    pub(crate) fn new(p: &Parameters, belt: &Motion, odd: &Oddness) -> Self {
        let ([eps, _, yaw], [d_eps, _, d_yaw]) = (belt.angles, belt.rates);
        let ((s, c), (sz, cz)) = (libm::sincos(eps), libm::sincos(yaw));
        let (z, dz) = (belt.place[2], belt.velocity[2]);
        let half = 0.5 * p.tire_width;
        let round = p.cross_section_radius;
        // (4.13), continuous at the limit with (B/2)² under the root
        let inner = p.tire_radius - round;
        let (lowest, falling) = if s.abs() <= half / round {
            (inner * c + round, -inner * s * d_eps)
        } else {
            let edge = inner + (round * round - half * half).max(0.0).sqrt();
            (edge * c + half * s.abs(), (-edge * s + half * s.signum() * c) * d_eps)
        };
        let penetration = (lowest - z).max(0.0);
        let rate = if penetration > 0.0 { falling - dz } else { 0.0 };
        let spring =
            p.vertical_stiffness * penetration + p.vertical_stiffness_quadratic * penetration * penetration;
        let (vx, vy) = (belt.velocity[0], belt.velocity[1]);
        Self {
            tilt: [eps, yaw],
            tilting: [d_eps, d_yaw],
            sine: s,
            cosine: c,
            height: z / c,
            rising: dz / c + z * s / (c * c) * d_eps,
            velocity: [
                cz * vx + sz * vy - d_yaw * z * s / c,
                -sz * vx + cz * vy + dz * s / c + z * d_eps / (c * c),
            ],
            penetration,
            force: (odd.stiffness * spring + p.vertical_damping * rate).max(0.0),
            arm: [0.0, -z * s / c, z],
        }
    }

    /// From the contact frame to inertial axes: it only yaws.
    pub(crate) fn out(&self, v: Vector) -> Vector {
        let (s, c) = libm::sincos(self.tilt[1]);
        [c * v[0] - s * v[1], s * v[0] + c * v[1], v[2]]
    }

    /// Moment of a load of the patch about the belt centre (4.35), contact frame.
    pub(crate) fn moment(&self, load: &Load) -> Vector {
        let lever = cross(self.arm, load.force);
        [load.moment[0] - lever[0], load.moment[1] - lever[1], load.moment[2] - lever[2]]
    }
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
        let (spring, damper) = (p.bristle_stiffness, p.bristle_damping);
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
                    let kept = damper / (damper + spring * dt);
                    bristle.way = [bristle.way[0] * kept, bristle.way[1] * kept];
                    (bristle.sticks, bristle.touches) = (false, false);
                    continue;
                }
                // one that came in during the step moves with the road only from its entry on (10.4)
                let mut span = dt;
                if !bristle.touches && run != 0.0 {
                    let inside = if run < 0.0 { half - x } else { half + x };
                    span = (inside / run.abs()).clamp(1e-3 * dt, dt);
                }
                bristle.touches = true;
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
                // backward Euler with radial return (10.2)
                let trial = [0, 1].map(|k| spring * (bristle.way[k] - span * v[k]) - damper * v[k]);
                let size = (trial[0] * trial[0] + trial[1] * trial[1]).sqrt();
                let held = friction(p.friction_static_zero, p.friction_static_reference, value) * normal;
                let mut slid =
                    friction(p.friction_sliding_zero, p.friction_sliding_reference, value) * normal;
                if odd.fall.0 != 0.0 {
                    // what slides for more than a moment slides as fast as its top moves over the road
                    let speed = (v[0] * v[0] + v[1] * v[1]).sqrt();
                    slid *= 1.0 + odd.fall.0 * libm::expm1(-speed / odd.fall.1);
                }
                if odd.nap != 0.0 && size > 0.0 {
                    slid *= 1.0 - odd.nap * trial[0] / size;
                }
                bristle.sticks = normal > 0.0 && size <= if bristle.sticks { held } else { slid };
                let soft = damper + spring * span;
                let mut force = trial;
                if !bristle.sticks {
                    let share = if size > 0.0 { slid / size } else { 0.0 };
                    force = trial.map(|w| w * share);
                    load.heat += slid * (size - slid).max(0.0) / soft;
                }
                bristle.way = std::array::from_fn(|k| (force[k] * span + damper * bristle.way[k]) / soft);
                load.force[0] += force[0];
                load.force[1] += force[1];
                load.moment[0] += y_def * weight;
                load.moment[2] += x_def * force[1] - y_def * force[0];
            }
        }
        load
    }
}
