//! The nine groups of the ring-and-brush tire, each by what the source says of it: closed forms and their inverses, what is
//! admissible, limits that count, and shortcuts that do not work. Numbers are those of the published example (4.2.10), and what
//! a program of its own computed for it from the source's equations.

use crate::benchmark::with_plan;
use crate::examples::assert_near;
use latsch::Result;
use latsch::fmi::Entry;
use latsch::identify::solve::{Goal, Part, Solution, Targets, Unsolved, intervals};
use latsch::identify::{Numbers, Plan, Readings, Stand, ring_brush};
use latsch::model::Settings;
use latsch::shipped::MODELS;
use latsch::stats::SplitMix64;

fn numbers(values: &[(&str, f64)]) -> Numbers {
    values.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect()
}

/// Vertical, quadratic and radial stiffness from two forces and the slope at touch (group 1).
fn springs(targets: [f64; 3], deflections: [f64; 2]) -> std::result::Result<Vec<f64>, Unsolved> {
    let inversion = ring_brush::REGISTRY.inversions.iter().find(|i| i.name == "springs in series").unwrap();
    let held: Vec<Numbers> =
        [deflections[0], deflections[1], 0.0].map(|d| numbers(&[("deflection", d)])).to_vec();
    (inversion.invert)(&targets, &held, &Numbers::new())
}

/// The force in the contact over the deflection since touch (4.52).
fn spring_force([linear, quadratic, rim]: [f64; 3], deflection: f64) -> f64 {
    // c_quad x² + (c_lin + c_rim) x = c_rim deflection
    let sum = linear + rim;
    let squeeze = 2.0 * rim * deflection / (sum + (sum * sum + 4.0 * quadratic * rim * deflection).sqrt());
    squeeze * (linear + quadratic * squeeze)
}

const EXAMPLE_SPRINGS: [f64; 3] = [1.54e5, 2.47e6, 4.67e6];

#[test]
fn two_forces_and_the_slope_at_touch_give_the_springs_back() {
    let mut random = SplitMix64::new(31);
    let deflections = [0.015, 0.035];
    for _ in 0..1000 {
        let mut between = |a: f64, b: f64| a * (b / a).powf(random.uniform());
        let truth = [between(5e4, 1e6), between(1e5, 5e7), between(5e5, 2e7)];
        let slope = 1.0 / (1.0 / truth[0] + 1.0 / truth[2]);
        let [a, b] = deflections.map(|d| spring_force(truth, d));
        // progressive: the force is above the tangent at touch
        assert!(a / slope > deflections[0] && b / slope > deflections[1]);
        let found = springs([a, b, slope], deflections).unwrap();
        // rounding of the forces, in what the curve is above its tangent, squared where it is least
        let above = (a / slope - deflections[0]) / deflections[0];
        let conditioning = (truth[2] / truth[0]).max(1.0) / above;
        for (found, truth) in found.iter().zip(truth) {
            let error = (found / truth - 1.0).abs();
            assert!(error < 1e-9f64.max(100.0 * f64::EPSILON * conditioning), "{truth:e}: {error:e}");
        }
    }
    assert_near(&[spring_force(EXAMPLE_SPRINGS, 0.015)], &[2733.101], 1e-3);
    assert_near(&[spring_force(EXAMPLE_SPRINGS, 0.035)], &[7871.746], 1e-3);
}

/// The printed targets give the printed stiffnesses. The printed slope is a secant over 0.1 mm, which explains most of what is
/// printed to be off in the radial stiffness.
#[test]
fn printed_spring_targets_give_the_printed_stiffnesses() {
    let found = springs([2736.0, 7877.0, 1.493e5], [0.015, 0.035]).unwrap();
    for (found, printed) in found.iter().zip([1.54281e5, 2.47139e6, 4.6246e6]) {
        assert!((found / printed - 1.0).abs() < 1e-5, "{found} instead of {printed}");
    }
    let secant = spring_force(EXAMPLE_SPRINGS, 1e-4) / 1e-4;
    assert!((secant / 1.49308e5 - 1.0).abs() < 1e-5, "{secant}");
    let tangent = spring_force(EXAMPLE_SPRINGS, 1e-9) / 1e-9;
    assert!((tangent / 149_083.75 - 1.0).abs() < 1e-6, "{tangent}");
    // the slope at touch does not know the quadratic stiffness
    let steeper = [EXAMPLE_SPRINGS[0], 1e7, EXAMPLE_SPRINGS[2]];
    assert!((spring_force(steeper, 1e-9) / 1e-9 / tangent - 1.0).abs() < 1e-6);
}

#[test]
fn spring_curves_that_contradict_the_model_are_refused() {
    let slope = 1.5e5;
    // below the tangent at touch, on it, and in one of both points only
    for [a, b] in [[0.9, 0.8], [1.0, 1.0], [1.1, 0.9], [0.9, 1.1]] {
        let found = springs([a * slope * 0.015, b * slope * 0.035, slope], [0.015, 0.035]);
        let Err(Unsolved::Failed(why)) = found else { panic!("{found:?}") };
        assert!(why.to_string().contains("progressive"), "{why}");
    }
    // a slope at touch that is too large by 1 % leaves the rim a negative stiffness
    let [a, b] = [0.015, 0.035].map(|d| spring_force(EXAMPLE_SPRINGS, d));
    let slope = 1.0 / (1.0 / EXAMPLE_SPRINGS[0] + 1.0 / EXAMPLE_SPRINGS[2]);
    let found = springs([a, b, 1.01 * slope], [0.015, 0.035]);
    let Err(Unsolved::Failed(why)) = found else { panic!("{found:?}") };
    assert!(why.to_string().contains("not positive"), "{why}");
    // what 0.1 % in a target does to the rim's flexibility
    for (k, change) in [0.28, -0.15, -0.13].into_iter().enumerate() {
        let mut targets = [a, b, slope];
        targets[k] *= 1.001;
        let found = EXAMPLE_SPRINGS[2] / springs(targets, [0.015, 0.035]).unwrap()[2] - 1.0;
        assert!((found - change).abs() < 0.01, "{k}: {found}");
    }
}

/// Group 2: the least load is one at which all stripes are in contact, whatever the cross-section is (4.59), (4.61).
#[test]
fn all_stripes_are_in_contact_at_the_lower_load() {
    // least cross-section radius and width of the belt
    let (radius, width) = (0.46f64, 0.225f64);
    let squeeze = radius - (radius * radius - width * width / 4.0).sqrt();
    assert!((squeeze - 0.0139689).abs() < 1e-7, "{squeeze}");
    let [linear, quadratic, _] = EXAMPLE_SPRINGS;
    let load = |squeeze: f64| linear * squeeze + quadratic * squeeze * squeeze - 8.8 * 9.81;
    assert!((load(squeeze) - 2546.9).abs() < 0.1, "{}", load(squeeze));
    // as printed, with the squeeze rounded
    assert!((load(0.0140) - 2553.8).abs() < 0.1, "{}", load(0.0140));
    with_plan(|plan, stand| {
        let readings = Readings::new(plan, stand, ring_brush::REGISTRY, &Numbers::new()).unwrap();
        let truth = readings.sought_values(&Numbers::new()).unwrap();
        let [least, _] = readings.bounds()[3];
        assert_eq!(least, radius);
        // the condition that asks for contact in all stripes is met on the bound
        let mut moved = truth.clone();
        moved[3] = least;
        readings.some(&moved, &[3, 4]).unwrap();
        // ratios L(F_2) / L(F_1) over the cross-section radius, with what bristles' dampers leave
        for (radius, ratio) in [(0.46, 2.05870), (0.55, 1.97288), (0.675, 1.90382), (1.0, 1.82075)] {
            moved[3] = radius;
            let found = readings.some(&moved, &[3, 4]).unwrap();
            assert!((found[1] / found[0] / ratio - 1.0).abs() < 1e-5, "{radius}: {}", found[1] / found[0]);
        }
    });
}

/// Section C.3 rests on a function that is shown to rise by a plot only: h'(u, c) = acos u / acos²(cu) (acos u + u / sqrt(1 - u²)).
#[test]
fn the_function_of_section_c3_rises() {
    let value = |u: f64, c: f64| {
        let angle = u.acos();
        angle / (c * u).acos().powi(2) * (angle + u / (1.0 - u * u).sqrt())
    };
    let mut least = f64::INFINITY;
    for i in 0..=60 {
        let c = 0.7 + (1.0 / 0.7 - 0.7) * f64::from(i) / 60.0;
        let [low, high] = [0.7f64.max(0.7 / c), 0.98f64.min(0.98 / c)];
        for j in 0..400 {
            // at the ends of c there is no u
            let u = low + (high - low).max(0.0) * f64::from(j) / 399.0;
            let step = 1e-6;
            if low < high {
                least = least.min((value(u + step, c) - value(u - step, c)) / (2.0 * step));
            }
        }
    }
    // the least slope of a grid of 61 x 400
    assert!((least - 2.09).abs() < 0.005, "{least}");
}

/// Groups 3 to 6 at the example's ground state: signs on which the source's proofs rely, and the form of (4.89) as printed.
#[test]
fn slopes_at_the_ground_state_are_those_that_proofs_rely_on() {
    with_plan(|plan, stand| {
        let mut random = SplitMix64::new(33);
        for k in 0..4 {
            let mut around = |x: f64| if k == 0 { x } else { x * (0.8 + 0.4 * random.uniform()) };
            let start = numbers(&[
                ("bristle_stiffness", around(4e4)),
                ("cross_section_radius", around(0.675)),
                ("patch_compliance_twist", around(1e-4)),
                ("patch_compliance_y", around(8e-7)),
            ]);
            let readings = Readings::new(plan, stand, ring_brush::REGISTRY, &start).unwrap();
            let at = readings.sought_values(&start).unwrap();
            let found = readings.some(&at, &[4, 7, 8]).unwrap();
            let tilt = 8e4;
            // the belt yaws against the slip angle, by less than that
            let yaw = -found[1] / tilt;
            assert!(0.0 < yaw && yaw < 1.0, "{yaw}");
            // (C.36): the longitudinal slope is above the lateral one over the patch's own slip angle
            let lateral = -found[2] / (1.0 - yaw);
            assert!(found[0] > lateral && lateral > 0.0, "{found:?}");
            if k == 0 {
                // stripes' lengths cubed and summed at 5000 N, element length
                let (cubes, element) = (0.0333086, 0.014);
                let stiffness = 4e4 * cubes / (12.0 * element);
                let form = |length: f64| -stiffness / (1.0 + stiffness * length * (1e-4 + 1.0 / tilt));
                assert!((found[1] / form(1.0) - 1.0).abs() < 1e-5, "{} {}", found[1], form(1.0));
                // without the element's length in the denominator, as printed
                let printed = form(element);
                assert!((printed + 7833.0).abs() < 1.0 && (found[1] / printed - 1.0).abs() > 0.4);
                // back in closed form, and what can be reached at all
                let compliance = -1.0 / found[1] - 1.0 / stiffness - 1.0 / tilt;
                assert!((compliance / 1e-4 - 1.0).abs() < 1e-4, "{compliance}");
                assert!(found[1] > -1.0 / (1.0 / stiffness + 1.0 / tilt));
            }
        }
    });
}

fn changed(changes: &[(&str, &str)]) -> Plan {
    let text = changes.iter().fold(ring_brush::PLAN.to_owned(), |text, (old, new)| {
        assert!(text.contains(old), "{old}");
        text.replacen(old, new, 1)
    });
    Plan::read(&text).unwrap()
}

fn stand_of(plan: &Plan) -> Stand {
    Stand::new(Entry::find(MODELS, &plan.model).unwrap().slave(&Settings::default()).unwrap(), &[])
}

/// Section C.5: no slip instead of no longitudinal force in the patch is no shortcut to the tilt stiffness: it would be negative.
#[test]
fn without_slip_the_tilt_stiffness_comes_out_negative() {
    let reach = "reach = [\n    { read = \"slip over that of no longitudinal patch force\", value = 0.0, by = \"slip\", between = [0.0, 4e-5], first_of = 8 },\n]\n";
    let plan = changed(&[(reach, "")]);
    let stand = stand_of(&plan);
    let readings = Readings::new(&plan, &stand, ring_brush::REGISTRY, &Numbers::new()).unwrap();
    let truth = readings.sought_values(&Numbers::new()).unwrap();
    let found = readings.some(&truth, &[5, 4, 7, 8]).unwrap();
    let (tilt, along, yaw, across) = (8e4, found[1], -found[2], -found[3]);
    let expected = tilt / (1.0 - along / across * (1.0 - yaw / (2.0 * tilt)));
    assert!((expected + 6.5e4).abs() < 500.0, "{expected}");
    assert!((found[0] / expected - 1.0).abs() < 0.05, "{} instead of {expected}", found[0]);
}

/// Group 7: with two equal loads the matrix of (4.96) is singular; what scatters then leaves friction open, and that is said.
#[test]
fn equal_loads_do_not_fix_sliding_friction() {
    let plan = changed(&[(
        "name = \"dragged sideways at 5000 N\"\nhold = { load_control = 1, load = 5000.0",
        "name = \"dragged sideways at 5000 N\"\nhold = { load_control = 1, load = 3000.0",
    )]);
    let stand = stand_of(&plan);
    let readings = Readings::new(&plan, &stand, ring_brush::REGISTRY, &Numbers::new()).unwrap();
    let truth = readings.sought_values(&Numbers::new()).unwrap();
    let part = Part::new(&readings, vec![9, 10], vec![9, 10], &truth);
    let values = part.at(&truth[9..11]).unwrap();
    assert!((values[0] / values[1] - 1.0).abs() < 1e-9, "{values:?}");
    let solution = Solution { parameters: truth[9..11].to_vec(), residual: 0.0, evaluations: 0 };
    let known_to: Vec<f64> = values.iter().map(|v| 1e-3 * v).collect();
    let found = intervals(&part, &solution, &known_to);
    assert!(matches!(found, Err(Unsolved::IllConditioned { .. })), "{found:?}");
    // with the plan's loads it is fixed
    with_plan(|plan, stand| {
        let readings = Readings::new(plan, stand, ring_brush::REGISTRY, &Numbers::new()).unwrap();
        let part = Part::new(&readings, vec![9, 10], vec![9, 10], &truth);
        intervals(&part, &solution, &known_to).unwrap();
    });
    // two targets that are not the same for the same state are out of reach of any friction
    let mut goal = Goal::new(&values);
    goal.values[1] *= 1.01;
    let found =
        latsch::identify::solve::local(&part, &goal, latsch::identify::solve::Method::Newton, &truth[9..11]);
    assert!(found.is_err(), "{found:?}");
}

/// Group 7: friction as what makes a force of two trial vectors (4.97). The force is linear in friction for a given force only,
/// so that scales have to be looked for.
#[test]
fn sliding_friction_from_two_trial_vectors() {
    // shares of trial vectors in the answer: c1 / s1k + c2 / s2k = 1 for both loads
    let solve = |scales: [[f64; 2]; 2], trials: [[f64; 2]; 2]| {
        let [[a, b], [c, d]] = scales.map(|s| s.map(f64::recip));
        let determinant = a * d - b * c;
        let (first, second) = ((d - c) / determinant, (a - b) / determinant);
        [0, 1].map(|k| first * trials[0][k] + second * trials[1][k])
    };
    // rows of the scales: trial vectors; columns: loads. The last of them is known better: of friction that does not depend on
    // the pressure the force is friction times the load in the contact
    let weight = 8.8 * 9.81;
    let flat = [3090.0 / (3000.0 + weight), 4970.0 / (5000.0 + weight)];
    assert_near(&flat, &[1.0012, 0.9771], 1e-4);
    let printed = solve([[1.247, 1.295], [1.001, 0.9772]], [[1.0, 0.8], [1.0, 1.0]]);
    assert_near(&printed, &[1.0985, 0.9996], 5e-4);
    with_plan(|plan, stand| {
        let readings = Readings::new(plan, stand, ring_brush::REGISTRY, &Numbers::new()).unwrap();
        let truth = readings.sought_values(&Numbers::new()).unwrap();
        let model = readings.model_values(&truth).unwrap();
        let at = |zero: f64, reference: f64| {
            let with = numbers(&[("friction_sliding_zero", zero), ("friction_sliding_reference", reference)]);
            let sought = readings.sought_values(&with).unwrap();
            readings.some(&[&truth[..9], &sought[9..11], &truth[11..]].concat(), &[9, 10])
        };
        let measured = at(model["friction_sliding_zero"], model["friction_sliding_reference"]).unwrap();
        let trials = [[1.2, 0.9], [1.0, 0.85]];
        let scale = |trial: [f64; 2], k: usize| -> Result<f64> {
            let (mut low, mut high) = (0.5, 2.0);
            for _ in 0..34 {
                let middle = 0.5 * (low + high);
                let force = at(middle * trial[0], middle * trial[1])?[k];
                if force < measured[k] { low = middle } else { high = middle }
            }
            Ok(0.5 * (low + high))
        };
        let scales = trials.map(|trial| [0, 1].map(|k| scale(trial, k).unwrap()));
        let found = solve(scales, trials);
        let expected = ["friction_sliding_zero", "friction_sliding_reference"].map(|name| model[name]);
        assert_near(&found, &expected, 1e-6);
    });
}

/// Group 8: the unit square is what is admissible (4.103) to (4.105), and back.
#[test]
fn static_friction_of_the_unit_square_is_admissible() {
    let transform = |name: &str| *ring_brush::REGISTRY.transforms.iter().find(|t| t.name == name).unwrap();
    let square = transform("static friction in the unit square");
    let example = numbers(&[
        ("friction_pressure", 2e5),
        ("friction_pressure_scale", 1.0),
        ("friction_sliding_zero", 1.1),
        ("friction_sliding_reference", 1.0),
    ]);
    // largest pressure that is meant, as a multiple of the reference pressure
    let highest = 5.23 / 2.0;
    let at_highest = |zero: f64, reference: f64| zero + (reference - zero) * highest;
    assert!((at_highest(1.1, 1.0) - 0.8385).abs() < 1e-12);
    let model = |known: &Numbers, sought: &[f64]| {
        let changed = (square.to_model)(sought, known);
        let value = |name: &str| changed.iter().find(|c| c.0 == name).unwrap().1;
        assert_eq!(value("patch_compliance_x"), sought[0]);
        [value("friction_static_zero"), value("friction_static_reference")]
    };
    // the published answer, one unit of the last digit beside what is printed, and the truth
    let [zero, reference] = model(&example, &[3e-6, 0.47, 0.631]);
    assert_near(&[zero, at_highest(zero, reference), reference], &[1.523, 1.207, 1.402], 1e-3);
    let mut true_ones = example.clone();
    true_ones.extend(numbers(&[
        ("patch_compliance_x", 3e-6),
        ("friction_static_zero", 1.5),
        ("friction_static_reference", 1.4),
    ]));
    assert_near(&(square.from_model)(&true_ones), &[3e-6, 0.4444, 0.7124], 1e-4);
    let mut random = SplitMix64::new(38);
    let sliding = transform("sliding friction");
    for k in 0..200 {
        // sliding friction of its own square, and corners first
        let mut known = example.clone();
        if k >= 4 {
            let at_zero = 0.3 + 1.5 * random.uniform();
            let changed = (sliding.to_model)(&[at_zero, random.uniform()], &known);
            known.extend(changed.into_iter().map(|(name, value)| (name.to_owned(), value)));
        }
        let [at_zero, at] = ["friction_sliding_zero", "friction_sliding_reference"].map(|n| known[n]);
        let slides = [at_zero, at_highest(at_zero, at)];
        // it falls by 0.1 at least, and its force rises with the pressure up to the highest
        assert!(slides[0] - slides[1] >= 0.1 - 1e-9 && slides[1] >= 0.5 * slides[0] - 1e-9, "{slides:?}");
        let shares =
            if k < 4 { [f64::from(k % 2), f64::from(k / 2)] } else { [random.uniform(), random.uniform()] };
        let sought = [3e-6, shares[0], shares[1]];
        let [zero, reference] = model(&known, &sought);
        let sticks = [zero, at_highest(zero, reference)];
        let least = 1e-12;
        assert!(sticks[0] >= slides[0] - least && sticks[1] >= slides[1] - least, "{sticks:?} {slides:?}");
        assert!(sticks[0] <= 2.0 + least && sticks[1] <= 2.0 + least, "{sticks:?}");
        // where the two bounds of (4.105) leave room: falls by 0.1, and rises as a force by 0.1
        let leaves_room = sticks[0] - 0.1 >= slides[1].max(0.5 * (sticks[0] + 0.1));
        if leaves_room {
            assert!(sticks[0] - sticks[1] >= 0.1 - 1e-9, "{sticks:?}");
            assert!(sticks[1] >= 0.5 * (sticks[0] + 0.1) - 1e-9, "{sticks:?}");
        }
        known.extend(numbers(&[
            ("patch_compliance_x", 3e-6),
            ("friction_static_zero", zero),
            ("friction_static_reference", reference),
        ]));
        assert_near(&(square.from_model)(&known), &sought, 1e-9);
    }
}

/// Group 8 at the truth: signs (4.125), pivots of the pressure (4.112), and where the first force goes if the others stay (4.130).
#[test]
fn forces_of_group_8_respond_with_the_signs_that_its_search_needs() {
    with_plan(|plan, stand| {
        let readings = Readings::new(plan, stand, ring_brush::REGISTRY, &Numbers::new()).unwrap();
        let truth = readings.sought_values(&Numbers::new()).unwrap();
        let part = Part::new(&readings, vec![11, 12, 13], vec![11, 12, 13], &truth);
        for (k, share) in [[0.0, 0.0], [-0.1, -0.1], [0.1, 0.1]].iter().enumerate() {
            let at = [truth[11], truth[12] + share[0], truth[13] + share[1]];
            let jacobian = part.jacobian(&at).unwrap();
            for (i, signs) in [[1.0, 1.0, 1.0], [-1.0, 1.0, 1.0], [1.0, 1.0, 1.0]].iter().enumerate() {
                for (j, sign) in signs.iter().enumerate() {
                    assert_eq!(jacobian[(i, j)].signum(), *sign, "{k} {i} {j}: {jacobian}");
                }
            }
            // a determinant of two points has the sign of the order of their pivots, whichever two numbers stand for friction
            let of = |a: usize, b: usize| {
                jacobian[(a, 1)] * jacobian[(b, 2)] - jacobian[(a, 2)] * jacobian[(b, 1)]
            };
            assert!(of(1, 0) > 0.0 && of(2, 1) > 0.0 && of(2, 0) > 0.0, "{jacobian}");
            let pivot = |a: usize| jacobian[(a, 2)] / jacobian[(a, 1)];
            assert!(pivot(0) > pivot(1) && pivot(1) > pivot(2));
            // with the second and third force as they are
            let (inner, with_compliance) = (jacobian.view((1, 1), (2, 2)), jacobian.view((1, 0), (2, 1)));
            let moved = -inner.into_owned().try_inverse().unwrap() * with_compliance;
            assert!(moved[0] < 0.0 && moved[1] > 0.0, "{moved}");
            let rise = jacobian[(0, 0)] + jacobian[(0, 1)] * moved[0] + jacobian[(0, 2)] * moved[1];
            assert!(rise > 0.0, "{rise}");
            if k == 0 {
                // 4948.6 and 5031.9 N at 2.95e-6 and 3.05e-6
                assert!((rise * 1e-7 / 83.3 - 1.0).abs() < 0.05, "{rise}");
            }
        }
    });
}

/// Group 9: the rim goes down while the wheel's own speed stays that of straight rolling, and the force rises with the stiffness.
#[test]
fn the_side_force_rises_with_the_lateral_stiffness() {
    with_plan(|plan, stand| {
        let hold = &plan.condition("pressed down at a slip angle").unwrap().hold;
        let speed = hold["path_speed"] * hold["slip_angle"].cos();
        assert!((speed - 10.0).abs() < 1e-9, "{speed}");
        let readings = Readings::new(plan, stand, ring_brush::REGISTRY, &Numbers::new()).unwrap();
        let mut at = readings.sought_values(&Numbers::new()).unwrap();
        let mut last = 0.0;
        for (stiffness, force) in [(2e4, 201.0), (6e4, 375.0), (8.5e4, 424.0), (1.5e5, 486.0)] {
            at[14] = stiffness;
            let found = readings.some(&at, &[14]).unwrap()[0];
            assert!((found / force - 1.0).abs() < 0.2 && found > last, "{stiffness}: {found}");
            last = found;
        }
    });
}
