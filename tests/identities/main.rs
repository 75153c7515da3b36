//! What holds for any state, any parameters and any input: balances, kinematics, symmetries, the
//! bristle's law. Random states; the expected side of each equation is written out here.
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod bristle;
#[path = "../common/mod.rs"]
mod common;
mod light_load;
mod passage;

use common::rolling::Point;
use common::{assert_close, example, flat_track, get, set};
use latsch::model::Slave;
use latsch::road::Road;
use latsch::tire::Vertical;
use latsch::tire::ring_brush::{
    Bristles, Contact, Friction, Lag, Limits, Loads, Parameters, Prepared, PressureState, State, Tops,
    advance, coupling, patch_on_belt, stationary, stationary_coupling,
};
use latsch::tire::{Flat, Motion};
use nalgebra::{Matrix3, Vector3};
use proptest::prelude::*;
use std::f64::consts::PI;

fn vector(size: f64) -> impl Strategy<Value = Vector3<f64>> {
    [-size..size, -size..size, -size..size].prop_map(Vector3::from)
}

prop_compose! {
    fn motion(tilt: f64)(
        position in vector(1.0),
        velocity in vector(20.0),
        camber in -tilt..tilt,
        spin in -50.0..50.0f64,
        yaw in -PI..PI,
        rates in vector(3.0),
        spin_rate in -100.0..100.0f64,
    ) -> Motion<f64> {
        let rates = Vector3::new(rates.x, spin_rate, rates.z);
        Motion { position, velocity, angles: Vector3::new(camber, spin, yaw), rates }
    }
}

/// Every continuous parameter of the example within a third of its value, any grid of bristles.
fn parameters() -> impl Strategy<Value = Parameters> {
    let factors = proptest::collection::vec(0.7..1.3f64, 31);
    (factors, 1..10i32, 10..80i32, any::<bool>(), any::<bool>(), any::<bool>()).prop_map(
        |(factors, stripes, bristles, even, antisymmetric, whole)| {
            let mut p = example();
            let mut factor = factors.into_iter();
            let mut vary = |value: &mut f64| *value *= factor.next().unwrap_or(1.0);
            for value in [
                &mut p.radius,
                &mut p.width,
                &mut p.cross_section_radius,
                &mut p.belt_mass,
                &mut p.belt_inertia_diametral,
                &mut p.belt_inertia_polar,
                &mut p.vertical_stiffness,
                &mut p.vertical_stiffness_quadratic,
                &mut p.vertical_damping,
                &mut p.sidewall_radial_stiffness,
                &mut p.sidewall_lateral_stiffness,
                &mut p.sidewall_tilt_stiffness,
                &mut p.sidewall_windup_stiffness,
                &mut p.sidewall_radial_damping,
                &mut p.sidewall_lateral_damping,
                &mut p.sidewall_tilt_damping,
                &mut p.sidewall_windup_damping,
                &mut p.stripe_length_factor,
                &mut p.patch_compliance_x,
                &mut p.patch_compliance_y,
                &mut p.patch_compliance_twist,
                &mut p.rolling_resistance_lever,
                &mut p.bristle_stiffness,
                &mut p.bristle_damping,
                &mut p.friction_pressure,
                &mut p.patch_lag_x,
                &mut p.patch_lag_y,
                &mut p.patch_lag_twist,
            ] {
                vary(value);
            }
            p.rolling_radius = 0.97 * p.radius;
            p.stripes = stripes;
            // a ring that is longer than any patch of these states
            p.bristles_per_stripe = bristles;
            p.bristle_length = 0.6 / f64::from(bristles);
            p.even_stripes = even;
            p.antisymmetric_coupling = antisymmetric;
            p.whole_step_entry = whole;
            p
        },
    )
}

prop_compose! {
    /// A tire on the road in the middle of anything.
    fn situation()(
        p in parameters(),
        mut belt in motion(0.14),
        penetration in 1e-3..0.035f64,
        lagged in vector(1.0),
        lag_rates in vector(1.0),
    ) -> (Prepared, Motion<f64>, [Loads<f64>; 2]) {
        let tire = Prepared::new(&p, &Road::default()).unwrap();
        belt.position.z = 0.0;
        belt.position.z = Contact::new(&p, &belt).depth - penetration;
        let loads = |v: Vector3<f64>, size: f64| Loads {
            force_x: 4000.0 * size * v.x,
            force_y: 4000.0 * size * v.y,
            moment_z: 100.0 * size * v.z,
        };
        (tire, belt, [loads(lagged, 1.0), loads(lag_rates, 20.0)])
    }
}

fn evaluate(tire: &Prepared, belt: &Motion<f64>, lagged: &Loads<f64>) -> State {
    let mut state = State {
        belt: *belt,
        lag: Lag::at_rest(lagged),
        bristles: Bristles::new(tire.parameters()),
        ..State::default()
    };
    tire.step(&mut state, belt, belt, &Flat { friction: 1.0 }, 0.0).unwrap();
    state
}

fn small<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    values.into_iter().fold(0.0, |a: f64, b| a.max(b.abs()))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 128, failure_persistence: None, ..ProptestConfig::default() })]

    /// (4.23): the bristles, each counted as a whole, carry the normal force and balance the moment about the lateral
    /// axis; where the system has no solution they carry the normal force at least.
    #[test]
    fn pressure_carries_normal_force_and_moment((tire, belt, [lagged, _]) in situation(), limit in any::<bool>()) {
        let mut p = tire.parameters().clone();
        p.limit_pressure_tilt = limit;
        p.whole_step_entry = true;
        let tire = Prepared::new(&p, &Road::default()).unwrap();
        let state = evaluate(&tire, &belt, &lagged);
        let (b, normal) = (&state.bristles, state.patch.force.z);
        let contact = Contact::new(&p, &belt);
        prop_assert_eq!(normal, contact.normal_force);
        let shift = p.patch_compliance_x * lagged.force_x;
        let (mut sum, mut tilting, mut lowest, mut gross, mut negative) = (0.0, 0.0, 0.0_f64, 0.0, 0.0);
        for (k, pressure) in b.pressure.iter().enumerate() {
            let force = p.cell_area() * pressure * b.share[k];
            sum += force;
            gross += force.abs();
            tilting += (b.place(&p, k % b.stride()) + shift) * force;
            lowest = lowest.min(*pressure);
            negative -= force.min(0.0);
        }
        // (4.22)
        let drag = (p.rolling_radius * belt.rates.y).clamp(-1.0, 1.0);
        let moment = -p.rolling_resistance_lever * normal * drag
            - lagged.force_x * (p.rolling_radius - contact.distance);
        prop_assert!((state.patch.moment.y - moment).abs() <= 1e-12 * normal);
        let tolerance = 1e-10 * gross;
        match state.patch.pressure_state {
            PressureState::Air => prop_assert!(normal == 0.0 && sum == 0.0),
            PressureState::BetweenBristles => prop_assert!(sum == 0.0),
            PressureState::Singular => prop_assert!((sum - normal).abs() <= tolerance),
            PressureState::Limited => {
                prop_assert!(limit && lowest >= 0.0 && (sum - normal).abs() <= tolerance);
            }
            PressureState::Regular | PressureState::Negative => {
                prop_assert!((sum - normal).abs() <= tolerance, "{} for {}", sum, normal);
                prop_assert!((tilting + moment).abs() <= tolerance, "{} for {}", tilting, -moment);
                let regular = state.patch.pressure_state == PressureState::Regular;
                prop_assert_eq!(regular, lowest >= 0.0);
                prop_assert!(regular || !limit);
            }
        }
        if normal > 0.0 {
            prop_assert!((state.patch.negative_share - negative / normal).abs() < 1e-12);
        }
    }

    #[test]
    fn rotations_and_their_rates(m in motion(1.2)) {
        let (a, step) = (m.rotation(), 1e-6);
        let identity = Matrix3::identity();
        prop_assert!(small(&(a * a.transpose() - identity)) < 1e-14);
        prop_assert!((a.determinant() - 1.0).abs() < 1e-14);
        prop_assert!(small(&(m.rate_map() * m.rate_map_inverse() - identity)) < 1e-13);
        let at = |t: f64| Motion { angles: m.angles + m.rates * t, ..m };
        let differences = (at(step).rotation() - at(-step).rotation()) / (2.0 * step);
        // rates up to 100 rad/s: truncation 1e-12 * 100^3 / 6, rounding 1e-16 / 1e-6
        prop_assert!(small(&(m.rotation_derivative() - differences)) < 1e-6);
        let differences = (at(step).rate_map() - at(-step).rate_map()) / (2.0 * step);
        prop_assert!(small(&(m.rate_map_derivative() - differences)) < 1e-8);
    }

    /// (4.13) is continuous, with its slope, where the deepest point reaches the shell's edge.
    #[test]
    fn depth_of_the_shell_is_smooth(p in parameters()) {
        let edge = (p.width / (2.0 * p.cross_section_radius)).asin();
        let depth = |camber: f64| {
            let angles = Vector3::new(camber, 0.0, 0.0);
            Contact::new(&p, &Motion { angles, ..Motion::default() }).depth
        };
        let d = 1e-7;
        for side in [-1.0, 1.0] {
            let (inner, middle, outer) =
                (depth(side * (edge - d)), depth(side * edge), depth(side * (edge + d)));
            // curvature times d^2
            prop_assert!((inner - 2.0 * middle + outer).abs() < 10.0 * d * d);
        }
    }

    /// Stripes are mirror images; a camber of the other sign swaps their lengths.
    #[test]
    fn stripes_are_symmetric((tire, mut belt, _) in situation()) {
        let (p, y, r) = (tire.parameters().clone(), tire.stripe_places(), tire.stripe_radii());
        let n = y.len();
        let lengths = |belt: &Motion<f64>| {
            let c = Contact::new(&p, belt);
            (0..n).map(|i| c.stripe_length(&p, y[i], r[i])).collect::<Vec<_>>()
        };
        let one = lengths(&belt);
        belt.angles.x *= -1.0;
        let other = lengths(&belt);
        for i in 0..n {
            let m = n - 1 - i;
            prop_assert!((y[i] + y[m]).abs() < 1e-15 && (r[i] - r[m]).abs() < 1e-15);
            prop_assert!((one[i].powi(2) - other[m].powi(2)).abs() < 1e-14, "{:?} {:?}", one, other);
        }
        let pitch = if n > 1 { y[0] - y[1] } else { p.stripe_width() };
        prop_assert!((pitch - p.stripe_width()).abs() < 1e-15);
    }

    /// (4.30): the velocity of a bristle's top is the derivative of its place, which is built here
    /// from (4.12), (4.28) and (4.29).
    #[test]
    fn velocity_of_the_tops((tire, belt, [lagged, rates]) in situation(), x in -0.1..0.1f64, y in -0.1..0.1f64) {
        let p = tire.parameters();
        let place = |t: f64| {
            let centre = belt.position + belt.velocity * t;
            let angles = belt.angles + belt.rates * t;
            let (fx, fy, mz) = (
                lagged.force_x + rates.force_x * t,
                lagged.force_y + rates.force_y * t,
                lagged.moment_z + rates.moment_z * t,
            );
            let x = x - p.rolling_radius * belt.rates.y * t;
            let (camber, yaw) = (angles.x, angles.z);
            let x_def = x + p.patch_compliance_x * fx;
            let bend = p.patch_compliance_y / p.radius.powi(2) * fy;
            let y_def = y + p.patch_compliance_y * fy + p.patch_compliance_twist * mz * x - bend * x * x;
            let h = centre.z / camber.cos();
            let y_phi = y_def
                + camber.sin() * (p.rolling_radius - h - x * x / (2.0 * p.rolling_radius));
            let (along, across) =
                (Vector3::new(yaw.cos(), yaw.sin(), 0.0), Vector3::new(-yaw.sin(), yaw.cos(), 0.0));
            let foot = centre + across * (centre.z * camber.tan()) - Vector3::z() * centre.z;
            foot + along * x_def + across * y_phi
        };
        let step = 1e-5;
        let differences = (place(step) - place(-step)) / (2.0 * step);
        let yaw = belt.angles.z;
        let expected = [
            differences.x * yaw.cos() + differences.y * yaw.sin(),
            -differences.x * yaw.sin() + differences.y * yaw.cos(),
        ];
        let tops = Tops::new(p, &Contact::new(p, &belt), belt.rates.y, &lagged, &rates);
        let velocity = tops.velocity(x, y);
        for k in 0..2 {
            // speeds of up to 50 m/s: truncation 1e-10 * 3^2 * 50, rounding 1e-16 / 1e-5 * 1 m
            prop_assert!((velocity[k] - expected[k]).abs() < 1e-6, "{:?} {:?}", velocity, expected);
        }
    }

    /// (4.2)-(4.9): force and moment between rim and belt cancel; and (4.39), (4.42) are what (4.6)
    /// to (4.8) give, at any instant, for a tire that rolls steadily.
    #[test]
    fn side_wall_balance_and_stationary_form(
        p in parameters(),
        camber in -0.3..0.3f64, yaw in -PI..PI, tilt in vector(0.03),
        apart in vector(3e-3), spin_rate in -100.0..100.0f64, angle in -10.0..10.0f64, velocity in vector(20.0),
    ) {
        let rim = Motion {
            position: Vector3::new(0.3, -0.4, 0.3),
            velocity,
            angles: Vector3::new(camber, angle, yaw),
            rates: Vector3::new(0.0, spin_rate, 0.0),
        };
        let belt = Motion { position: rim.position - apart, angles: rim.angles - tilt, ..rim };
        for antisymmetric in [false, true] {
            let p = Parameters { antisymmetric_coupling: antisymmetric, ..p.clone() };
            let c = coupling(&p, &rim, &belt);
            prop_assert_eq!(c.on_rim.force, -c.on_belt.force);
            let moment = c.on_rim.moment + c.on_belt.moment
                + (belt.position - rim.position).cross(&c.on_belt.force);
            prop_assert!(small(&moment) < 1e-9);

            let (stationary, _) = stationary_coupling(
                &p, &-apart, (camber, yaw), (belt.angles.x, belt.angles.z), tilt.y, spin_rate,
            );
            let force = stationary.force - c.on_belt.force;
            // forces of up to 2e4 N from differences of positions of 1 m
            prop_assert!(small(&force) < 1e-8, "{:?}", force);
            let moment = small(&(stationary.moment - c.on_belt.moment));
            if antisymmetric {
                prop_assert!(moment < 1e-8, "{}", moment);
            } else {
                // of second order in the tilt: 0.03^2 * stiffness (and damping by the spin)
                let stiffness = p.sidewall_windup_stiffness.max(p.sidewall_tilt_stiffness)
                    + (p.sidewall_windup_damping + p.sidewall_tilt_damping) * spin_rate.abs();
                let size = tilt.norm_squared() * stiffness;
                prop_assert!(moment <= 2.0 * size, "{} {}", moment, size);
            }
        }
    }

    /// (4.10), (4.11) and (4.35): change of momentum about the road's origin is the sum of what acts
    /// there, for any state. The spin of the body is differentiated here.
    #[test]
    fn belt_obeys_newton_and_euler((tire, belt, _) in situation(), load in vector(5000.0), torque in vector(500.0)) {
        let p = tire.parameters();
        let contact = Contact::new(p, &belt);
        let wrench = patch_on_belt(&contact, &load, &torque);
        let rotation = contact.rotation();
        let foot = belt.position - rotation * contact.centre;
        prop_assert!(foot.z.abs() < 1e-15);
        let about_centre = rotation * torque + (foot - belt.position).cross(&(rotation * load));
        prop_assert!(small(&(wrench.moment - about_centre)) < 1e-9);

        let (linear, angular) = p.belt().acceleration(&belt, &wrench, p.gravity);
        let weight = Vector3::new(0.0, 0.0, -p.belt_mass * p.gravity);
        prop_assert!(small(&(linear * p.belt_mass - rotation * load - weight)) < 1e-9);
        let momentum = |t: f64| {
            let m = Motion {
                angles: belt.angles + belt.rates * t + angular * (0.5 * t * t),
                rates: belt.rates + angular * t,
                ..belt
            };
            let body = Matrix3::from_diagonal(&Vector3::new(
                p.belt_inertia_diametral, p.belt_inertia_polar, p.belt_inertia_diametral,
            ));
            m.rotation() * body * m.rotation().transpose() * m.angular_velocity()
        };
        let step = 1e-6;
        let change = (momentum(step) - momentum(-step)) / (2.0 * step);
        // accelerations of up to 1e4 rad/s^2 at 100 rad/s
        prop_assert!(small(&(change - about_centre)) < 1e-5 * (1.0 + about_centre.norm() + 1e2), "{:?} {:?}", change, about_centre);
    }

    /// As printed the radial return solves the backward Euler step of (4.30)-(4.33) exactly: stick without
    /// motion of the bottom below the static limit, or slide against the force with the kinetic one. A bottom
    /// that turns within the step slides against the force, too. So friction never gives energy.
    #[test]
    fn bristle_step_is_exact(
        deflection in [-5e-3..5e-3f64, -5e-3..5e-3f64], velocity in [-3.0..3.0f64, -3.0..3.0f64],
        stick in any::<bool>(), normal in 0.0..200.0f64, pressure in 0.0..6e5f64, exponent in -8.0..1.0f64,
        still in 0..4, printed in any::<bool>(),
    ) {
        let p = Parameters { whole_step_entry: printed, ..example() };
        let dt = 10f64.powf(exponent);
        let velocity = if still == 0 { velocity.map(|v| v * 1e-6) } else { velocity };
        let normal = if normal < 10.0 { 0.0 } else { normal };
        let limits = Friction::new(&p).limits(pressure, normal);
        let share = pressure / p.friction_pressure;
        prop_assert!((limits.sticking - (1.5 - 0.1 * share) * normal).abs() <= 1e-12 * normal);
        prop_assert!((limits.sliding - (1.1 - 0.1 * share) * normal).abs() <= 1e-12 * normal);

        let step = advance(&p, deflection, velocity, stick, &limits, dt);
        let (c, d) = (p.bristle_stiffness, p.bristle_damping);
        let rate: [f64; 2] = std::array::from_fn(|k| (step.deflection[k] - deflection[k]) / dt);
        let bottom: [f64; 2] = std::array::from_fn(|k| rate[k] + velocity[k]);
        let size = step.force[0].hypot(step.force[1]);
        // what cancels in the rate: deflections of 5e-3 and what is traversed in dt
        let noise = 1e-14 * (5e-3 / dt + 5.0);
        for (k, rate) in rate.into_iter().enumerate() {
            let law = c * step.deflection[k] + d * rate;
            let gross = c * 5e-3 + (d + c * dt) * 5.0;
            prop_assert!((law - step.force[k]).abs() < 1e-12 * gross, "{} {}", law, step.force[k]);
        }
        let speed = bottom[0].hypot(bottom[1]);
        if printed || step.stick {
            prop_assert!((speed - step.slip_speed).abs() <= noise, "{} {}", speed, step.slip_speed);
        }
        if normal == 0.0 {
            prop_assert!(!step.stick && size <= 1e-12 * (c * 5e-3 + (d + c * dt) * 5.0));
        } else if step.stick {
            prop_assert!(size <= limits.sticking && (stick || size <= limits.sliding));
            prop_assert!(step.slip_speed == 0.0);
        } else {
            prop_assert!((size - limits.sliding).abs() < 1e-12 * limits.sliding);
            let power = -(step.force[0] * bottom[0] + step.force[1] * bottom[1]);
            prop_assert!(power >= -size * noise, "{} W", power);
            prop_assert!(!printed || (power - size * speed).abs() <= size * noise);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    /// Left and right are equal (checks 10 and 11), whatever the tire; headings are equal (check 15);
    /// the normal force is the load and the belt's weight (check 16); forces keep within friction
    /// (check 26).
    #[test]
    fn stationary_states_are_symmetric(
        p in parameters(), load in 1500.0..6000.0f64, speed in 0.5..40.0f64, slip in -0.08..0.08f64,
        alpha in -0.12..0.12f64, camber in -0.08..0.08f64, turn in -PI..PI,
    ) {
        let tire = Prepared::new(&p, &Road::default()).unwrap();
        let point = Point { load, speed, slip, alpha, camber, steer: 0.0 };
        let solve = |point: Point| stationary(&tire, &point.rim(&tire), Vertical::Load(load), 1.0);
        let state = solve(point).unwrap();
        let (f, m) = (state.on_rim.force, state.on_rim.moment);

        let mirrored = solve(Point { alpha: -alpha, camber: -camber, ..point }).unwrap().on_rim;
        let turned = solve(Point { steer: turn, ..point }).unwrap().on_rim;
        let back = rotation_z(-turn);
        let (turned_f, turned_m) = (back * turned.force, back * turned.moment);
        // Newton stops at 1e-6 of the load where a kink holds it up
        let (near_f, near_m) = (3e-6 * load, 3e-6 * load);
        let flip = |v: Vector3<f64>, signs: [f64; 3]| v.component_mul(&Vector3::from(signs));
        let mirror_f = flip(mirrored.force, [1.0, -1.0, 1.0]) - f;
        let mirror_m = flip(mirrored.moment, [-1.0, 1.0, -1.0]) - m;
        prop_assert!(small(&mirror_f) < near_f && small(&mirror_m) < near_m, "{} {}", mirror_f, mirror_m);
        prop_assert!(small(&(turned_f - f)) < near_f && small(&(turned_m - m)) < near_m);

        let weight = p.belt_mass * p.gravity;
        prop_assert!((state.patch.force.z - load - weight).abs() < 1e-5 * load);
        let horizontal = state.patch.force.x.hypot(state.patch.force.y);
        prop_assert!(horizontal <= 1.5 * state.patch.force.z);

        let straight = solve(Point { alpha: 0.0, camber: 0.0, ..point }).unwrap();
        let zero = [straight.on_rim.force.y, straight.on_rim.moment.x, straight.on_rim.moment.z];
        prop_assert!(small(&zero) < 1e-7 * load, "{:?}", zero);
        prop_assert!(straight.belt_camber.abs() < 1e-9 && straight.belt_yaw.abs() < 1e-9);
    }

    /// A wheel that stands (check 8) or hangs and rolls (check 9, C.29).
    #[test]
    fn standing_and_airborne(p in parameters(), deflection in 1e-3..0.03f64, speed in 0.0..60.0f64) {
        let tire = Prepared::new(&p, &Road::default()).unwrap();
        let standing = Motion::default();
        let state = stationary(&tire, &standing, Vertical::Height(p.radius - deflection), 1.0).unwrap();
        let (f, m) = (state.on_rim.force, state.on_rim.moment);
        let weight = p.belt_mass * p.gravity;
        // the springs in series
        let patch = f.z + weight;
        let penetration = deflection - f.z / p.sidewall_radial_stiffness;
        let spring = (p.vertical_stiffness_quadratic * penetration + p.vertical_stiffness) * penetration;
        prop_assert!((patch - spring).abs() < 1e-6 * patch, "{} {}", patch, spring);
        prop_assert!(f.x.abs() < 1e-9 && f.y.abs() < 1e-9 && small(&m) < 1e-9, "{:?} {:?}", f, m);
        prop_assert!(state.belt_camber == 0.0 && state.belt_yaw == 0.0);

        let spin = speed / p.rolling_radius;
        let rolling = Motion {
            velocity: Vector3::new(speed, 0.0, 0.0), rates: Vector3::new(0.0, spin, 0.0), ..Motion::default()
        };
        let state = stationary(&tire, &rolling, Vertical::Height(p.radius + deflection), 1.0).unwrap();
        let (c, d) = (p.sidewall_radial_stiffness, p.sidewall_radial_damping * spin);
        let offset = -state.belt_from_rim;
        let scale = weight * c / (c * c + d * d);
        prop_assert!((offset.z - scale).abs() < 1e-9 * scale, "{} {}", offset.z, scale);
        prop_assert!((offset.x - scale * d / c).abs() < 1e-9 * scale);
        prop_assert!((state.on_rim.force - Vector3::new(0.0, 0.0, -weight)).norm() < 1e-9 * weight);
        prop_assert!(state.patch.force.norm() == 0.0);
        // the belt's weight hangs that far ahead of or behind the rim's centre
        let moment = state.on_rim.moment - Vector3::new(0.0, -offset.x * weight, 0.0);
        prop_assert!(small(&moment) < 1e-9, "{}", moment);
    }
}

fn rotation_z(angle: f64) -> Matrix3<f64> {
    let (s, c) = angle.sin_cos();
    Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0)
}

/// The numbers of check 6 and of the note on (4.42): literal entries ripple, antisymmetric ones do not.
#[test]
fn stationary_side_wall_of_the_specification() {
    let p = example();
    let belt_from_rim = -Vector3::new(1e-3, 2e-3, -5e-4);
    let (on_belt, _) = stationary_coupling(&p, &belt_from_rim, (0.0, 0.0), (0.02, -0.01), 0.0, 30.0);
    let printed = [4585.61493508, 174.25427159, -2505.14450114];
    for (value, printed) in on_belt.force.iter().zip(printed) {
        assert!((value - printed).abs() < 1e-8, "{value} for {printed}");
    }
}

/// Mirrored and turned programmes in time. Sums are taken in another order, so the last bits differ,
/// and a bristle may break away a step earlier: hence the mean over the run.
#[test]
fn mirror_and_heading_in_time() {
    let start = [("deflection", 0.025), ("slip_angle", 0.01), ("camber", 0.01), ("slip", 0.01)];
    let mirror = [("slip_angle", -0.01), ("camber", -0.01)];
    let mut plain = flat_track(&start);
    let mut mirrored = flat_track(&[start.as_slice(), &mirror].concat());
    let mut turned = flat_track(&[start.as_slice(), &[("steer", 1.1)]].concat());
    let names = ["force_x", "force_y", "force_z", "moment_x", "moment_y", "moment_z"];
    let signs = [1.0, -1.0, 1.0, -1.0, 1.0, -1.0];
    let scale = [5e3, 5e3, 5e3, 2e3, 2e3, 2e2];
    let mut errors = [0.0; 2];
    let steps = 300;
    for k in 0..steps {
        let t = f64::from(k) * 1e-3;
        if k == 50 {
            set(&mut plain, &[("slip_angle", -0.06), ("steer", 0.02), ("slip", -0.03)]);
            set(&mut mirrored, &[("slip_angle", 0.06), ("steer", -0.02), ("slip", -0.03)]);
            set(&mut turned, &[("slip_angle", -0.06), ("steer", 1.12), ("slip", -0.03)]);
        }
        for rig in [&mut plain, &mut mirrored, &mut turned] {
            rig.step(t, 1e-3).unwrap();
        }
        for (i, name) in names.into_iter().enumerate() {
            let value = get(&mut plain, name);
            errors[0] += (get(&mut mirrored, name) * signs[i] - value).abs() / scale[i];
            errors[1] += (get(&mut turned, name) - value).abs() / scale[i];
        }
    }
    let means = errors.map(|e| e / f64::from(steps) / 6.0);
    assert!(means.iter().all(|e| *e < 1e-9), "{means:?}");
}
/// Where a stripe just stops sticking at the entry, its force jumps. The states there lie between those before and
/// behind, and lead from one to the other without a gap.
#[test]
fn stationary_states_lead_across_jumps() {
    let tire = Prepared::new(&example(), &Road::default()).unwrap();
    let states: Vec<_> = (0..100)
        .map(|k| {
            let alpha = 0.15768 + 5e-7 * f64::from(k);
            let point = Point { load: 5000.0, speed: 20.0, slip: 0.0, alpha, camber: 0.02, steer: 0.0 };
            stationary(&tire, &point.rim(&tire), Vertical::Load(point.load), 1.0).unwrap()
        })
        .collect();
    let force: Vec<f64> = states.iter().map(|s| s.on_rim.force.y).collect();
    let inside: Vec<usize> = (0..states.len()).filter(|k| states[*k].jumps).collect();
    let (first, last) = (inside[0], inside[inside.len() - 1]);
    assert!(first > 0 && last < 99 && inside.len() == last - first + 1 && inside.len() > 10, "{inside:?}");
    let jump = force[first - 1] - force[last + 1];
    assert!(jump > 1.0, "{jump}");
    for pair in force[first - 1..=last + 1].windows(2) {
        let fall = pair[0] - pair[1];
        assert!(fall > 0.0 && fall < 2.0 * jump / inside.len() as f64, "{fall} of {jump}");
    }
    assert!(states.iter().all(|s| s.convergence.residual <= 1e-6));
}
