//! Four bristles at once, on every processor, against one after the other.

use super::*;
use latsch::solver::lanes::levels;
use latsch::tire::ring_brush::{Deformation, Passage, Pressure, Shape, Step};

/// A tire that has rolled on for some steps with a given contact, and what drives the next one.
fn roll(
    tire: &Prepared,
    belt: &Motion<f64>,
    [lagged, rates]: &[Loads<f64>; 2],
    steps: usize,
) -> (Bristles, f64) {
    let p = tire.parameters();
    let mut bristles = Bristles::new(p);
    let (mut spin, turn) = (belt.angles.y, belt.rates.y * 1e-4);
    for _ in 0..steps {
        spin += turn;
        pass(tire, belt, [lagged, rates], spin, turn, &mut bristles, levels()[0].1);
    }
    (bristles, spin)
}

fn pass(
    tire: &Prepared,
    belt: &Motion<f64>,
    [lagged, rates]: [&Loads<f64>; 2],
    spin: f64,
    turn: f64,
    bristles: &mut Bristles,
    level: fearless_simd::Level,
) -> (latsch::tire::ring_brush::Sums, Pressure<f64>) {
    let p = tire.parameters();
    let contact = Contact::new(p, belt);
    let passage = Passage {
        contact: &contact,
        tops: &Tops::new(p, &contact, belt.rates.y, lagged, rates),
        deformation: &Deformation::new(p, lagged),
        moment: 0.0,
        spin,
        shift: p.rolling_radius * turn,
        friction: 0.9,
        dt: 1e-4,
    };
    tire.pass(level, bristles, &passage).unwrap()
}

fn bits(bristles: &Bristles) -> Vec<u64> {
    let Bristles { deflection_x, deflection_y, force_x, force_y, pressure, stick, share, stored, .. } =
        bristles;
    let rows = [deflection_x, deflection_y, force_x, force_y, pressure, stick, share];
    rows.into_iter().flatten().chain([stored]).map(|x| x.to_bits()).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_processor_has_the_same_bits((tire, belt, loads) in situation(), falloff in any::<bool>()) {
        let mut p = tire.parameters().clone();
        p.friction_speed_falloff = if falloff { 0.02 } else { 0.0 };
        let tire = Prepared::new(&p, &Road::default()).unwrap();
        let (before, spin) = roll(&tire, &belt, &loads, 40);
        let turn = belt.rates.y * 1e-4;
        let found: Vec<_> = levels()
            .into_iter()
            .map(|(name, level)| {
                let mut bristles = before.clone();
                let (sums, _) = pass(&tire, &belt, [&loads[0], &loads[1]], spin + turn, turn, &mut bristles, level);
                (name, bits(&bristles), format!("{sums:?}"))
            })
            .collect();
        for (name, bristles, sums) in &found[1..] {
            prop_assert_eq!(bristles, &found[0].1, "{}", name);
            prop_assert_eq!(sums, &found[0].2, "{}", name);
        }
    }

    /// Every bristle that was in contact before obeys the law of one.
    #[test]
    fn four_bristles_do_what_each_does((tire, belt, loads) in situation()) {
        let p = tire.parameters();
        let (before, spin) = roll(&tire, &belt, &loads, 40);
        // a step in which the ring is where it was: the same bristles in the same places
        let mut after = before.clone();
        let (sums, _) = pass(&tire, &belt, [&loads[0], &loads[1]], spin, 0.0, &mut after, levels()[0].1);
        let contact = Contact::new(p, &belt);
        let tops = Tops::new(p, &contact, belt.rates.y, &loads[0], &loads[1]);
        let (mut touching, mut sliding) = (0.0, 0.0);
        for (i, y) in tire.stripe_places().iter().enumerate() {
            for j in 0..after.per_stripe {
                let k = i * after.stride() + j;
                let (share, pressure) = (after.share[k], after.pressure[k]);
                if share == 0.0 {
                    prop_assert_eq!(pressure, 0.0);
                    continue;
                }
                let limits = Friction::new(p).limits(pressure, 0.9 * pressure * p.cell_area());
                let velocity = tops.velocity(after.place(p, j), *y);
                let old = [before.deflection_x[k], before.deflection_y[k]];
                let Step { deflection, stick, force, .. } =
                    advance(p, old, velocity, before.stick[k] > 0.0, &limits, 1e-4);
                let scale = limits.sticking + p.bristle_stiffness * 1e-3;
                let close = |a: f64, b: f64, size: f64| (a - b).abs() <= 1e-9 * size;
                prop_assert!(close(after.force_x[k], force[0], scale) && close(after.force_y[k], force[1], scale));
                let reach = scale / p.bristle_stiffness;
                prop_assert!(close(after.deflection_x[k], deflection[0], reach));
                prop_assert!(close(after.deflection_y[k], deflection[1], reach));
                prop_assert_eq!(after.stick[k] > 0.0, stick);
                touching += share;
                sliding += if stick { 0.0 } else { share };
            }
        }
        if p.whole_step_entry {
            prop_assert!((sums.touching - touching).abs() < 1e-9 && (sums.sliding - sliding).abs() < 1e-9);
        }
    }

    /// The integral of the pressure is the normal force, that of its moment what was asked for, and the sums have the
    /// moment of that pressure about the length.
    #[test]
    fn pressures_are_in_balance((tire, belt, loads) in situation(), limit in any::<bool>()) {
        let mut p = tire.parameters().clone();
        (p.whole_step_entry, p.limit_pressure_tilt) = (false, limit);
        let tire = Prepared::new(&p, &Road::default()).unwrap();
        let mut bristles = Bristles::new(&p);
        let (sums, pressure) =
            pass(&tire, &belt, [&loads[0], &loads[1]], 0.3, 0.0, &mut bristles, levels()[0].1);
        let contact = Contact::new(&p, &belt);
        let lengths = bristles.lengths();
        // a shorter stripe has one bristle or none, which its normal force follows
        prop_assume!(lengths.iter().all(|l| *l == 0.0 || *l >= 2.0 * p.bristle_length));
        prop_assume!(contact.normal_force > 0.0 && pressure.state != PressureState::BetweenBristles);
        let shape = Shape::new(&p, contact.penetration);
        let deformation = Deformation::new(&p, &loads[0]);
        let (mut normal, mut tilting, mut roll) = (0.0, 0.0, 0.0);
        for (y, length) in tire.stripe_places().iter().zip(lengths).filter(|(_, length)| **length > 0.0) {
            let per_length = p.cell_area() / p.bristle_length * shape.stripe(*y, *length);
            // the midpoint rule in s with x = half (1 - s³), dense where the pressure falls steeply
            let (count, half) = (20_000, 0.5 * length);
            for k in 0..2 * count {
                let s = (f64::from(k % count) + 0.5) / f64::from(count);
                let x = half * (1.0 - s * s * s) * if k < count { 1.0 } else { -1.0 };
                let width = half * 3.0 * s * s / f64::from(count);
                let force = per_length * width * (pressure.level + pressure.tilt * x) * shape.along(x, *length);
                let [place_x, place_y] = deformation.place(x, *y);
                normal += force;
                tilting -= place_x * force;
                roll += place_y * force;
            }
        }
        let close = |a: f64, b: f64, size: f64| (a - b).abs() <= 1e-6 * size * contact.normal_force;
        prop_assert!(close(normal, contact.normal_force, 1.0), "{} for {}", normal, contact.normal_force);
        if matches!(pressure.state, PressureState::Regular | PressureState::Negative) {
            prop_assert!(close(tilting, 0.0, p.ring_length()), "{}", tilting);
        }
        // the bristles' own sum has a few of them; what it lacks is put at the middle of its stripe
        let few = (p.bristle_length * deformation.bend).abs() * p.ring_length() + deformation.twist.abs() * p.bristle_length;
        prop_assert!((sums.moment[0] - roll).abs() <= (1e-6 * p.width + few) * contact.normal_force, "{} for {}", sums.moment[0], roll);
    }
}

/// Sums over bristles are integrals of forces that are linear between bristles and 0 at the ends, wherever these are.
#[test]
fn sums_over_bristles_are_integrals() {
    let p = example();
    let tire = Prepared::new(&p, &Road::default()).unwrap();
    let mut belt = Motion::<f64> { rates: Vector3::new(0.0, 30.0, 0.0), ..Motion::default() };
    belt.position.z = Contact::new(&p, &belt).depth - 0.02;
    let rest = Loads::default();
    let mut seen = Vec::new();
    for k in 0..50 {
        let mut bristles = Bristles::new(&p);
        pass(&tire, &belt, [&rest, &rest], 1e-3 * f64::from(k), 0.0, &mut bristles, levels()[0].1);
        for (i, length) in bristles.lengths().iter().enumerate() {
            // what bristles that stick have in steady rolling, up to the first one behind the middle
            let force = |x: f64| 0.5 * length - x;
            let (mut triangle, mut last) = (0.0, f64::NAN);
            for j in (0..bristles.per_stripe).rev() {
                let (x, share) = (bristles.place(&p, j), bristles.share[i * bristles.stride() + j]);
                if share > 0.0 {
                    triangle += share * force(x) * p.bristle_length;
                    last = x;
                }
                if last < 0.0 {
                    break;
                }
            }
            // the last one counts for its half of the cell behind it, too
            triangle -= 0.5 * force(last) * p.bristle_length;
            let exact = 0.5 * force(last) * force(last);
            seen.push(triangle / exact - 1.0);
        }
    }
    assert!(seen.iter().all(|error| error.abs() < 1e-12), "{seen:?}");
}
