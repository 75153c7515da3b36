//! A tire by the Magic Formula of version 5.2, at one point of contact, with relaxation of both slips.
//!
//! Coefficients are those of a passenger car's tire of 225 mm in round numbers, placeholders all; those that are 0 there are left
//! out, and with them the terms that they multiply. Axes are ISO-W: x along the wheel's plane, y to the left, z along the road's
//! normal. Names in capitals are those of tire property files.

use super::vector::{Vector, v};
use std::f64::consts::PI;

/// Radius without load \[m\].
pub(crate) const RADIUS: f64 = 0.338;
/// Nominal load \[N\].
const NOMINAL: f64 = 4500.0;
/// Vertical stiffness \[N/m\] and damping \[N.s/m\].
pub(crate) const VERTICAL: (f64, f64) = (220e3, 200.0);
/// BREFF, DREFF and FREFF.
const ROLLING: [f64; 3] = [8.0, 0.25, 0.05];
/// Speed below which a wheel begins to stand \[m/s\], and the damping of a standing one \[N.s/m\].
const SLOW: f64 = 1.0;
const STANDING: f64 = 770.0;
/// Speed to which the rolling resistance refers \[m/s\].
const MEASURED: f64 = 16.0;
/// Relaxation lengths are at least as long \[m\].
const SHORTEST: f64 = 0.01;
/// QTZ1 times MBELT.
const BELT: f64 = 0.2 * 5.0;

/// What differs between tires of this study.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Tire {
    /// PCX1: the larger it is, the more the force falls behind its peak.
    pub(crate) shape: f64,
    /// LMUX and LMUY.
    pub(crate) friction: [f64; 2],
}

/// How a wheel stands on the road and moves over it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Footing {
    /// Distance of the wheel's centre from the road \[m\], along its normal.
    pub(crate) height: f64,
    /// Camber against the road, positive with the top to the right.
    pub(crate) camber: f64,
    /// Rate of the deflection \[m/s\].
    pub(crate) sinking: f64,
    /// Velocity of the point of contact, along and across \[m/s\].
    pub(crate) velocity: [f64; 2],
    /// Spin about the axle \[rad/s\].
    pub(crate) spin: f64,
    /// Factor on the friction.
    pub(crate) friction: f64,
}

/// What a tire does.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Told {
    /// Force on the rim in W axes \[N\].
    pub(crate) force: Vector,
    /// Moment about the wheel's centre in W axes \[N.m\].
    pub(crate) moment: Vector,
    /// Rates of the deflections along and across \[m/s\].
    pub(crate) rates: [f64; 2],
    /// Deflections beyond these roll off at standstill \[m\].
    pub(crate) limits: [f64; 2],
    /// Share of what belongs to standing.
    pub(crate) standing: f64,
    /// Power that the sliding of the contact takes \[W\].
    pub(crate) power: f64,
}

impl Tire {
    /// Distance of the wheel's centre from the road under a load, at a camber.
    pub(crate) fn height(load: f64, camber: f64) -> f64 {
        (RADIUS - load / VERTICAL.0) * libm::cos(camber)
    }

    /// Radius at which the wheel rolls freely, with a force of the vertical spring.
    pub(crate) fn rolling(spring: f64) -> f64 {
        let [b, d, f] = ROLLING;
        let load = spring / NOMINAL;
        RADIUS - NOMINAL / VERTICAL.0 * (d * libm::atan(b * load) + f * load)
    }

    /// Relaxation lengths along and across \[m\].
    pub(crate) fn relaxation(load: f64, camber: f64) -> [f64; 2] {
        let load = load.min(10e3);
        let df = (load - NOMINAL) / NOMINAL;
        let along = load * libm::exp(0.2 * df) * RADIUS / NOMINAL;
        let camber = camber.clamp(-0.25, 0.25).abs();
        let across =
            2.0 * libm::sin(2.0 * libm::atan(load / (2.0 * NOMINAL))) * (1.0 - 0.3 * camber) * RADIUS;
        [along.max(SHORTEST), across.max(SHORTEST)]
    }

    /// Forces with the deflections along and across, and how these go on.
    pub(crate) fn force(&self, on: &Footing, deflections: [f64; 2]) -> Told {
        let (sin, cos) = (libm::sin(on.camber), libm::cos(on.camber));
        let deflection = RADIUS - on.height / cos;
        if deflection <= 0.0 {
            return Told::default();
        }
        let spring = VERTICAL.0 * deflection;
        let load = (spring + VERTICAL.1 * on.sinking).max(0.0);
        let rolling = Self::rolling(spring);
        let [along, across] = on.velocity;
        let sliding = [along - rolling * on.spin, across];
        let lengths = Self::relaxation(load, on.camber);
        let travel = along.abs();
        let rates = [
            -sliding[0] - travel / lengths[0] * deflections[0],
            sliding[1] - travel / lengths[1] * deflections[1],
        ];
        // a wheel in reverse is one in forward travel, turned about the vertical
        let turned = if along < 0.0 { -1.0 } else { 1.0 };
        let slips = Slips {
            slip: turned * deflections[0] / lengths[0],
            angle: turned * libm::atan(deflections[1] / lengths[1]),
            camber: turned * on.camber,
            load,
            friction: on.friction,
            fading: if travel < SLOW { libm::pow(libm::sin(0.5 * PI * travel / SLOW), 2.0) } else { 1.0 },
            travel,
        };
        let steady = self.steady(&slips);
        let standing = if travel < SLOW { 0.5 * (1.0 + libm::cos(PI * along / SLOW)) } else { 0.0 };
        let mut force = v(turned * steady.force[0], turned * steady.force[1], load);
        if standing > 0.0 {
            for (k, peak) in steady.peaks.into_iter().enumerate() {
                let damped = force.0[k] - standing * STANDING * sliding[k];
                force.0[k] = damped.clamp(-peak * load, peak * load);
            }
        }
        let belt = BELT * rolling * on.spin * rates[1] * steady.residual;
        let moment = v(turned * steady.moments[0], turned * steady.moments[1], steady.moments[2] + belt);
        let arm = v(0.0, on.height * sin / cos, -on.height);
        let limit = |k: usize| {
            let stiffness = steady.stiffness[k].abs().max(1e-9);
            3.0 * steady.peaks[k] * load / stiffness * lengths[k]
        };
        Told {
            force,
            moment: moment + arm.cross(force),
            rates,
            limits: [limit(0), limit(1)],
            standing,
            power: -(force.x() * sliding[0] + force.y() * sliding[1]),
        }
    }

    /// Forces and moments that belong to slips which stay as they are, in forward travel.
    fn steady(&self, s: &Slips) -> Steady {
        let slip = s.slip.clamp(-1.5, 1.5);
        let angle = s.angle.clamp(-1.5, 1.5);
        let camber = s.camber.clamp(-0.25, 0.25);
        let load = s.load.min(10e3);
        let df = (load - NOMINAL) / NOMINAL;
        let grip = s.friction;
        let lateral_grip = self.friction[1] * grip;

        // (4.E9) to (4.E18)
        let peak_x = ((1.1 - 0.1 * df) * self.friction[0] * grip).max(0.0);
        let stiffness_x = 25.0 * load * libm::exp(0.2 * df);
        let pure_x = peak_x * load * wave(slip, stiffness_x, (self.shape, peak_x * load, 0.2));

        // (4.E19) to (4.E30)
        let peak_y = ((1.0 - 0.15 * df) * (1.0 - camber * camber) * lateral_grip).max(0.0);
        let stiffness_y = -20.0
            * NOMINAL
            * libm::sin(2.0 * libm::atan(load / (2.0 * NOMINAL)))
            * (1.0 - 0.3 * camber.abs());
        let shift_h = 0.02 * camber;
        let shift_v = load * (-0.5 - 0.2 * df) * camber * lateral_grip;
        let pure_y = peak_y * load * wave(angle + shift_h, stiffness_y, (1.4, peak_y * load, -0.5)) + shift_v;

        // (4.E50) to (4.E67)
        let weight = |x: f64| libm::cos(libm::atan(x)).max(0.0);
        let less_x = weight(12.0 / grip * libm::cos(libm::atan(-10.0 * slip)) * angle);
        let less_y = weight(10.0 / grip * libm::cos(libm::atan(8.0 * angle)) * slip);
        let induced = peak_y
            * load
            * (-0.2 * s.fading * camber)
            * libm::cos(libm::atan(10.0 * angle))
            * libm::sin(1.9 * libm::atan(10.0 * slip));
        let along = less_x * pure_x;
        let across = less_y * pure_y + induced;

        // (4.E31) to (4.E49), (4.E71) to (4.E78)
        let ratio = if stiffness_y == 0.0 { 0.0 } else { stiffness_x / stiffness_y * slip };
        let equivalent = |a: f64| libm::copysign(libm::atan(libm::hypot(libm::tan(a), ratio)), a);
        let bend_t = (10.0 - df) / lateral_grip * equivalent(angle);
        let bend_t = 1.1 * libm::atan(bend_t + (bend_t - libm::atan(bend_t)));
        let trail = s.fading * load * RADIUS / NOMINAL * 0.1 * libm::cos(bend_t) * libm::cos(angle);
        let shifted = if stiffness_y == 0.0 { shift_h } else { shift_h + shift_v / stiffness_y };
        let residual = weight(15.0 / lateral_grip * equivalent(angle + shifted));
        let residual_moment =
            s.fading * load * RADIUS * (-0.1 * camber) * lateral_grip * residual * libm::cos(angle);
        let lever = RADIUS * 0.03 * across / NOMINAL;
        let aligning = -trail * less_y * pure_y + residual_moment + lever * along;

        // (4.E69), (4.E70)
        let overturning = RADIUS * load * (-0.6 * camber + 0.03 * across / NOMINAL);
        let circling = (1.0 + s.slip) * s.travel;
        let rolls =
            if circling.abs() < SLOW { libm::sin(0.5 * PI * circling / SLOW) } else { circling.signum() };
        let speed = s.travel / MEASURED;
        let resistance = -RADIUS * load * (0.01 + 0.001 * speed + 1e-4 * libm::pow(speed, 4.0)) * rolls;
        Steady {
            force: [along, across],
            moments: [overturning, resistance, aligning],
            residual,
            peaks: [peak_x, peak_y],
            stiffness: [stiffness_x, stiffness_y],
        }
    }
}

/// sin(C atan(B x - E (B x - atan(B x)))) of a slip x, with the stiffness in the middle, and (shape, peak, curvature).
fn wave(x: f64, stiffness: f64, (shape, peak, curvature): (f64, f64, f64)) -> f64 {
    if peak <= 0.0 {
        return 0.0;
    }
    let bent = stiffness / (shape * peak) * x;
    libm::sin(shape * libm::atan(bent - curvature * (bent - libm::atan(bent))))
}

/// What goes into the formula.
struct Slips {
    slip: f64,
    angle: f64,
    camber: f64,
    load: f64,
    friction: f64,
    /// Goes to 0 towards standstill.
    fading: f64,
    travel: f64,
}

/// What comes out.
struct Steady {
    force: [f64; 2],
    moments: [f64; 3],
    /// Course of the residual torque over slip.
    residual: f64,
    peaks: [f64; 2],
    stiffness: [f64; 2],
}
