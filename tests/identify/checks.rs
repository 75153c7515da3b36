//! What the tests of a plan say of the examples.

use crate::examples::*;
use latsch::Result;
use latsch::fmi::Entry;
use latsch::identify::check::{
    Dependence, Finder, Injectivity, Report, Response, Sampled, Sampling, Standing, check, depends,
    influence, injective, responds,
};
use latsch::identify::solve::{Goal, Nesting, Tail, Targets, nested};
use latsch::identify::{Numbers, Plan, Readings, Registry, Stand, ring_brush};
use latsch::model::Settings;
use latsch::shipped::MODELS;
use latsch::stats::SplitMix64;

fn sampled(targets: &dyn Targets) -> Sampled<'_> {
    Sampled::new(targets, Sampling::default()).unwrap()
}

fn all(map: &Example) -> Vec<usize> {
    (0..map.bounds.len()).collect()
}

fn verdict(map: &Example) -> Injectivity {
    injective(&sampled(map), &all(map), &all(map)).unwrap()
}

#[track_caller]
fn margins(map: &Example) -> Vec<f64> {
    match verdict(map) {
        Injectivity::Passed { orthants, .. } => orthants.iter().map(|o| o.margin).collect(),
        other => panic!("{other:?}"),
    }
}

/// (3.43) is sufficient: it holds of the maps of which it is known to, and fails of three that are injective all the same.
#[test]
fn the_half_space_criterion_passes_what_it_can() {
    for map in [chain(), steep_chain(), split(), three_stall(), three_with_tail(), three()] {
        assert!(margins(&map).iter().all(|m| *m > 0.0));
    }
    for map in [stalls(), spiral(), gradient_only()] {
        let Injectivity::Open { orthants, .. } = verdict(&map) else { panic!("{:?}", verdict(&map)) };
        assert!(orthants.iter().any(|o| o.margin <= 0.0));
    }
}

/// In a map of constant derivatives the margin has a closed form: one of the identity in two dimensions is 1 with the
/// normal (1, 1), as large as the box of normals allows.
#[test]
fn margins_of_a_linear_map() {
    let identity = Example {
        bounds: vec![[-1.0, 1.0]; 2],
        values: |p| p.to_vec(),
        slopes: |_| vec![1.0, 0.0, 0.0, 1.0],
    };
    assert_near(&margins(&identity), &[1.0, 1.0], 1e-9);
    // both columns at 45 degrees: normal (1, 0) or (0, 1) for the other orthant, and its neighbours
    let turned = Example {
        values: |p| vec![p[0] + p[1], p[0] - p[1]],
        slopes: |_| vec![1.0, 1.0, 1.0, -1.0],
        ..identity
    };
    assert_near(&margins(&turned), &[0.5f64.sqrt(); 2], 1e-9);
}

#[test]
fn what_is_not_unique_is_refuted_by_two_points() {
    let map = twofold();
    let Injectivity::Refuted { points: [a, b] } = verdict(&map) else { panic!() };
    assert_near(&map.at(&a).unwrap(), &map.at(&b).unwrap(), 1e-7);
    assert!((a[1] + b[1] - 1.0).abs() < 1e-5, "{a:?} {b:?}");
}

/// A target of one parameter that turns is refuted wherever it turns: a few draws would not meet its value twice.
#[test]
fn a_turn_of_a_single_target_is_a_proof() {
    let wave = Example {
        bounds: vec![[0.0, 3.0]],
        values: |p| vec![p[0] + 0.6 * (2.0 * p[0]).sin()],
        slopes: |p| vec![1.0 + 1.2 * (2.0 * p[0]).cos()],
    };
    let few = Sampling { constants: 1, draws: 1, ..Sampling::default() };
    let answer = injective(&Sampled::new(&wave, few).unwrap(), &[0], &[0]).unwrap();
    let Injectivity::Refuted { points: [a, b] } = answer else { panic!("{answer:?}") };
    assert!((a[0] - b[0]).abs() > 0.06);
    assert_near(&wave.at(&a).unwrap(), &wave.at(&b).unwrap(), 1e-8);
    // a jump down gives values twice, one up does not
    let jump = Example {
        values: |p| vec![p[0] - 2.0 * f64::from(u8::from(p[0] > 1.0))],
        slopes: |_| vec![1.0],
        ..wave
    };
    let falls = injective(&Sampled::new(&jump, few).unwrap(), &[0], &[0]).unwrap();
    assert!(matches!(falls, Injectivity::Refuted { .. }), "{falls:?}");
    let step = Example { values: |p| vec![p[0] + 2.0 * f64::from(u8::from(p[0] > 1.0))], ..jump };
    let rises = injective(&Sampled::new(&step, few).unwrap(), &[0], &[0]).unwrap();
    assert!(matches!(rises, Injectivity::Passed { .. }), "{rises:?}");
}

/// Four targets of four parameters, of which each may know those before it.
struct Chain;

impl Targets for Chain {
    fn bounds(&self) -> &[[f64; 2]] {
        &[[-1.0, 1.0]; 4]
    }

    fn at(&self, p: &[f64]) -> Result<Vec<f64>> {
        Ok(vec![
            p[0].powi(3) + p[0],
            p[1] + 0.3 * p[2].sin() + p[0],
            2.0 * p[2] + 0.3 * p[1].sin(),
            p[3].exp() + p[1] * p[2] - p[0],
        ])
    }
}

#[test]
fn the_next_group_is_found_from_what_is_known() {
    let sampled = sampled(&Chain);
    let finder = Finder::new(&sampled);
    let group = |rows: &[usize], known: &[usize]| {
        let next = finder.next_group(rows, known).unwrap()?;
        assert_eq!(next.injectivity.standing(), Standing::Passed);
        Some(next.parameters)
    };
    assert_eq!(group(&[0], &[]), Some(vec![0]));
    assert_eq!(group(&[1, 2], &[]), None);
    assert_eq!(group(&[1, 2], &[0]), Some(vec![1, 2]));
    assert_eq!(group(&[3], &[0]), None);
    assert_eq!(group(&[3], &[0, 1, 2]), Some(vec![3]));
    assert_eq!(group(&[0], &[0]), None);
    let influence = influence(&sampled);
    let pattern = [[1, 0, 0, 0], [1, 1, 1, 0], [0, 1, 1, 0], [1, 1, 1, 1]];
    for (i, row) in pattern.iter().enumerate() {
        for (k, depends) in row.iter().enumerate() {
            assert_eq!(influence[(i, k)] > 0.0, *depends == 1, "{i} {k}");
        }
    }
    // one alone, over its range of 2 in 4 + 0.6 sin(1)
    assert!(influence[(1, 1)] > 0.3 && influence[(1, 1)] <= 2.0 / 4.0, "{}", influence[(1, 1)]);
    let dependence = depends(&sampled, &[1, 2], &[0, 3]).dependence.unwrap();
    let [a, b] = dependence.points.map(|p| Chain.at(&p).unwrap()[dependence.target]);
    assert!(dependence.target == 1 && a != b);
    let none = depends(&sampled, &[1, 2], &[3]);
    assert!(none.dependence.is_none() && none.compared == 100, "{none:?}");
}

/// Step, targets, parameters, and whether the choice goes on with them.
type Taken = (usize, Vec<usize>, Vec<usize>, bool);

/// What a choice has in its steps, and what it leaves.
fn steps(finder: &Finder<'_>, groups: &[Vec<usize>]) -> (Vec<Taken>, Vec<usize>) {
    let choice = finder.choose(groups).unwrap();
    let each =
        choice.steps.into_iter().enumerate().flat_map(|(k, step)| {
            step.next.into_iter().map(move |n| (k, n.targets, n.parameters, n.is_chosen))
        });
    (each.collect(), choice.left)
}

#[test]
fn the_order_of_a_plan_is_found_without_the_plan() {
    let sampled = sampled(&Chain);
    let (found, left) = steps(&Finder::new(&sampled), &[]);
    let step = |k, rows: &[usize]| (k, rows.to_vec(), rows.to_vec(), true);
    assert_eq!(found, [step(0, &[0]), step(1, &[1, 2]), step(2, &[3])]);
    assert_eq!(left, [0; 0]);
    let choice = Finder::new(&sampled).choose(&[]).unwrap();
    assert_eq!(choice.steps[2].next[0].given, [0, 1, 2]);
}

/// What has two answers is shown and not gone on with; a second way to a parameter is shown, too.
#[test]
fn what_has_two_answers_is_not_chosen() {
    let map = twofold();
    let sampled_twofold = sampled(&map);
    let (found, left) = steps(&Finder::new(&sampled_twofold), &[]);
    assert_eq!(found, [(0, vec![0, 1], vec![0, 1], false)]);
    assert_eq!(left, [0, 1]);
    // with another that is found, it is not shown again
    let beside = Example {
        bounds: [twofold().bounds, vec![[-1.0, 1.0]]].concat(),
        values: |p| [(twofold().values)(&p[..2]), vec![p[2]]].concat(),
        slopes: |p| {
            let own = (twofold().slopes)(&p[..2]);
            vec![own[0], own[1], 0.0, own[2], own[3], 0.0, 0.0, 0.0, 1.0]
        },
    };
    let sampled_beside = sampled(&beside);
    let (found, left) = steps(&Finder::new(&sampled_beside), &[]);
    assert_eq!(found, [(0, vec![2], vec![2], true), (0, vec![0, 1], vec![0, 1], false)]);
    assert_eq!(left, [0, 1]);
    let twice = Example {
        bounds: vec![[-1.0, 1.0]; 2],
        values: |p| vec![p[0], 2.0 * p[0]],
        slopes: |_| vec![1.0, 0.0, 2.0, 0.0],
    };
    let sampled = sampled(&twice);
    let (found, left) = steps(&Finder::new(&sampled), &[]);
    assert_eq!(found, [(0, vec![0], vec![0], true), (0, vec![1], vec![0], false)]);
    assert_eq!(left, [1]);
}

/// A group of five that no smaller set of targets opens is tried because the plan has it.
#[test]
fn a_large_group_is_tried_where_the_plan_has_it() {
    let sums = Example {
        bounds: vec![[-1.0, 1.0]; 5],
        values: |p| p.iter().map(|x| x + 0.1 * p.iter().sum::<f64>()).collect(),
        slopes: |_| (0..25).map(|k| 0.1 + f64::from(u8::from(k % 6 == 0))).collect(),
    };
    let sampled = Sampled::new(&sums, Sampling { constants: 2, draws: 3, ..Sampling::default() }).unwrap();
    let finder = Finder::new(&sampled);
    let whole: Vec<usize> = (0..5).collect();
    assert_eq!(steps(&finder, &[]), (Vec::new(), whole.clone()));
    assert_eq!(
        steps(&finder, std::slice::from_ref(&whole)),
        (vec![(0, whole.clone(), whole, true)], Vec::new())
    );
}

/// A target that reacts in one part in a hundred only: few draws miss it, many do not.
#[test]
fn a_narrow_dependence_needs_many_draws() {
    let narrow = Example {
        bounds: vec![[-1.0, 1.0]; 2],
        values: |p| vec![p[0] + (1e-4 - (p[1] - 0.3).powi(2)).max(0.0).powi(2) * 1e7],
        slopes: |_| Vec::new(),
    };
    let found = |draws| -> Option<Dependence> {
        let sampling = Sampling { draws, ..Sampling::default() };
        depends(&Sampled::new(&narrow, sampling).unwrap(), &[0], &[1]).dependence
    };
    assert_eq!(found(2), None);
    let found = found(2000).unwrap();
    assert!(found.points.iter().any(|p| (p[1] - 0.3).abs() < 0.01));
}

/// Orders and signs: what the source says of its examples.
#[test]
fn orders_and_signs_of_the_examples() {
    let of = |map: &Example| responds(&sampled(map), &all(map), &all(map)).unwrap();
    // these two cannot be nested as they are printed (text at 3.35, B.8)
    for map in [stalls(), split()] {
        let Response { nesting, tail } = of(&map).unwrap();
        assert!(nesting.parameters != [0, 1] || nesting.targets != [0, 1], "{nesting:?}");
        assert_eq!(tail, None);
    }
    // what a check finds, a search can use
    let mut random = SplitMix64::new(4);
    for map in [stalls(), split(), three(), three_with_tail(), gradient_only()] {
        let Response { nesting, tail } = of(&map).unwrap();
        for _ in 0..10 {
            let p: Vec<f64> = map.bounds.iter().map(|[a, b]| a + (b - a) * random.uniform()).collect();
            assert_found(nested(&map, &goal(&map, &p), &nesting, tail.as_ref()), &p, 1e-6);
        }
    }
    assert_eq!(of(&three()).unwrap(), Response { nesting: Nesting::plain(3), tail: None });
    assert_eq!(of(&three_with_tail()).unwrap().tail, Some(Tail { sign: 1.0 }));
    // no order of it has signs
    assert_eq!(of(&spiral()), None);
    assert_eq!(of(&twofold()), None);
}

/// Where targets cannot be computed, nothing is tested, and no pass is told.
#[test]
fn what_cannot_be_computed_is_no_pass() {
    struct Half([[f64; 2]; 1], f64);

    impl Targets for Half {
        fn bounds(&self) -> &[[f64; 2]] {
            &self.0
        }

        fn at(&self, p: &[f64]) -> Result<Vec<f64>> {
            if p[0] < self.1 { Ok(vec![p[0]]) } else { Err(latsch::Error::numeric("not there")) }
        }
    }

    let nowhere = Sampled::new(&Half([[0.0, 1.0]], -1.0), Sampling::default());
    assert!(nowhere.is_err_and(|e| e.to_string().contains("anywhere in the box: not there")));
    // a quarter of the box: half of the draws that are corners, too
    let half = Half([[0.0, 1.0]], 0.25);
    let sampled = sampled(&half);
    assert!(sampled.computed[0] == 100 && (20..45).contains(&sampled.computed[1]), "{:?}", sampled.computed);
    let search = depends(&sampled, &[0], &[0]);
    assert!(search.dependence.is_some() && search.compared < 60, "{search:?}");
}

const MAGIC_FORMULA: &str = include_str!("../../examples/plans/magic-formula-flat-track.toml");

fn stand(model: &str) -> Stand {
    Stand::new(Entry::find(MODELS, model).unwrap().slave(&Settings::default()).unwrap(), &[])
}

fn checked(text: &str, sampling: Sampling) -> Report {
    let plan = Plan::read(text).unwrap();
    let stand = stand(&plan.model);
    let readings = Readings::new(&plan, &stand, ring_brush::REGISTRY, &Numbers::new()).unwrap();
    check(&readings, &sampling).unwrap()
}

/// The groups of the plan that each step goes on with.
fn chosen(report: &Report) -> Vec<Vec<Option<usize>>> {
    let group = |n: &latsch::identify::check::Next| report.group_of(&n.targets, &n.parameters).map(|k| k + 1);
    report.choice.steps.iter().map(|s| s.next.iter().filter(|n| n.is_chosen).map(group).collect()).collect()
}

fn standings(report: &Report) -> Vec<Standing> {
    report.groups.iter().map(|g| g.injectivity.standing()).collect()
}

#[test]
fn the_plan_of_a_magic_formula_is_checked() {
    use Standing::{Open, Passed};
    let sampling = Sampling { constants: 3, draws: 8, seed: 1, tolerance: 1e-6 };
    let report = checked(MAGIC_FORMULA, sampling);
    assert!(!report.is_refuted());
    assert_eq!(standings(&report), [Passed, Passed, Passed, Open, Passed]);
    assert_eq!(chosen(&report), [vec![Some(1), Some(2), Some(4)], vec![Some(3), Some(5)]]);
    assert_eq!(report.choice.left, [0; 0]);
    assert_eq!(report.groups[2].states_its_signs, Some(true));
    assert!(report.groups[2].injectivity.margin().unwrap() > 0.0);
    assert_eq!(report.groups[3].injectivity.margin(), Some(0.0));
    let text = report.to_string();
    assert!(
        text.contains("nothing is known >") && text.contains("group 2 -> PKX1: passes (evidence)"),
        "{text}"
    );
    assert!(text.contains("group 4 -> PKY1; PKY2: open"), "{text}");
    // with less slip stiffness the two forces respond with other signs: the plan's are refuted, which is no counter-example to it
    let wide = MAGIC_FORMULA.replace("bounds = [15.0, 50.0]", "bounds = [5.0, 50.0]");
    let report = checked(&wide, sampling);
    assert_eq!(report.groups[2].states_its_signs, Some(false));
    assert_eq!(standings(&report)[2], Open);
    assert!(!report.is_refuted());
}

/// The order of the tests does not need that of the plan.
#[test]
fn the_choice_finds_the_order_that_a_wrong_plan_has_not() {
    let parts: Vec<&str> = MAGIC_FORMULA.split("[[group]]\n").collect();
    let wrong = [parts[0], parts[1], parts[3], parts[2], parts[4], parts[5]].join("[[group]]\n");
    let report = checked(&wrong, Sampling { constants: 2, draws: 4, seed: 1, tolerance: 1e-6 });
    assert!(report.is_refuted());
    assert_eq!(report.independence(&report.groups[1]), Some(Standing::Refuted));
    // the slip stiffness is the third group there, and found before the second
    assert_eq!(chosen(&report), [vec![Some(1), Some(3), Some(4)], vec![Some(2), Some(5)]]);
    assert_eq!(report.choice.steps[1].next[0].given, [3]);
}

#[track_caller]
fn is_refused(text: &str, registry: Registry, words: &[&str]) {
    let said = match Plan::read(text) {
        Err(error) => error.to_string(),
        Ok(plan) => {
            let stand = stand(&plan.model);
            match Readings::new(&plan, &stand, registry, &Numbers::new()) {
                Err(error) => error.to_string(),
                Ok(_) => panic!("it is not refused: {words:?}"),
            }
        }
    };
    for word in words {
        assert!(said.contains(word), "{word}: {said}");
    }
}

/// A plan that is like a shipped one differs from it where it says so, and nowhere else.
#[test]
fn a_plan_like_another_differs_where_it_says() {
    let whole = Plan::read(ring_brush::PLAN).unwrap();
    let plan = Plan::read(include_str!("../../examples/plans/ring-brush-passenger-car.toml")).unwrap();
    assert_eq!((&plan.recordings, &plan.set), (&whole.recordings, &whole.set));
    let sizes = |plan: &Plan| plan.groups.iter().map(|group| group.parameters.len()).collect::<Vec<_>>();
    assert_eq!(
        (sizes(&plan), sizes(&whole)),
        (vec![2, 2, 1, 1, 1, 1, 2, 4, 1], vec![3, 2, 1, 1, 1, 1, 2, 3, 1])
    );
    assert_eq!((&plan.groups[2..7], &plan.groups[8]), (&whole.groups[2..7], &whole.groups[8]));
    let new = plan.conditions.iter().filter(|own| !whole.conditions.contains(own));
    let own: Vec<&str> = new.map(|c| c.name.as_str()).collect();
    assert_eq!(
        own,
        [
            "dragged sideways at 3000 N",
            "dragged sideways at 5000 N",
            "driven at 6000 N",
            "braked at 4000 N",
            "driven at 2000 N",
            "locked at 4000 N"
        ]
    );
    assert_eq!(plan.condition("braked at 4000 N").unwrap().hold["slip"], -0.05);
    let runs = |plan: &Plan| plan.programme.as_ref().unwrap().runs.clone();
    let names = |plan: &Plan| runs(plan).iter().map(|run| run.name.clone()).collect::<Vec<_>>();
    let (driven, mut expected) = (6, names(&whole));
    assert_eq!(expected[driven], "driven-and-braked");
    expected.insert(driven + 1, "locked".to_owned());
    assert_eq!(names(&plan), expected);
    let own: Vec<String> =
        runs(&plan).iter().filter(|run| !runs(&whole).contains(run)).map(|run| run.name.clone()).collect();
    assert_eq!(own, ["driven-and-braked", "locked"]);
}

#[test]
fn a_plan_like_another_says_what_is_wrong() {
    let like = |text: &str, words: &[&str]| {
        is_refused(&format!("like = \"ring-brush-flat-track\"\n{text}"), ring_brush::REGISTRY, words);
    };
    like(
        "[[condition]]\nname = \"driven at 6001 N\"",
        &["driven at 6001 N", "no target", "driven at 6000 N"],
    );
    like("[[condition]]\nname = \"driven at 6000 N\"\nholds = {}", &["unknown field `holds`"]);
    like(
        "[[group]]\nname = \"more\"\nafter = \"sliding fricton\"",
        &["group", "more", "after", "\"sliding fricton\"", "did you mean \"sliding friction\""],
    );
    like("[[group]]\nname = \"sliding friction\"\nafter = 3", &["sliding friction", "cannot have `after`"]);
    is_refused(
        "like = \"ring-brush\"",
        ring_brush::REGISTRY,
        &["no shipped plan \"ring-brush\"", "ring-brush-flat-track"],
    );
    is_refused("like = 3", ring_brush::REGISTRY, &["in quotes"]);
}

/// The plan of the ring-and-brush tire with one thing changed is refused.
#[track_caller]
fn of_ring_brush(old: &str, new: &str, words: &[&str]) {
    let text = ring_brush::PLAN.replacen(old, new, 1);
    assert_ne!(text, ring_brush::PLAN, "{old}");
    is_refused(&text, ring_brush::REGISTRY, words);
}

/// What would go wrong while a plan is followed is refused before.
#[test]
fn plans_that_cannot_be_followed_are_refused_with_what_is_needed() {
    // one name for two targets of different groups
    of_ring_brush(
        "name = \"aligning moment per camber [N.m/rad]\"",
        "name = \"slip stiffness at 2600 N [N]\"",
        &["slip stiffness at 2600 N", "\"cross-section and shear stiffness\"", "\"length of the contact\""],
    );
    // sizes of what is registered
    of_ring_brush(
        "transform = \"length factor of a known shear stiffness\"",
        "transform = \"sliding friction\"",
        &["length of the contact", "\"sliding friction\" takes 2 values", "1 parameters"],
    );
    of_ring_brush(
        "inversion = \"identity\"",
        "inversion = \"springs in series\"",
        &["tilt of the side wall", "\"springs in series\" takes 3 targets", "there are 1"],
    );
    of_ring_brush(
        "condition = \"pressed down by 15 mm\"",
        "condition = \"off the road\"",
        &["needs deflection held"],
    );
    of_ring_brush(
        "transform = \"length factor of a known shear stiffness\"",
        "transform = \"length factor of a known shear stiffness\"\nfixed = { 4 = 1.0 }",
        &["takes 1 values", "1 fixed"],
    );
    // names of what recordings need
    of_ring_brush(
        "held_within = { deflection",
        "held_within = { deflecton",
        &["held_within", "deflecton", "did you mean \"deflection\""],
    );
    of_ring_brush("offsets = { slip =", "offsets = { force_x =", &["offsets", "force_x", "no input"]);
    of_ring_brush("{ load = \"force_z\" }", "{ load = \"slip\" }", &["measured_by", "slip", "no output"]);
    of_ring_brush(
        "{ load = \"force_z\" }",
        "{ laod = \"force_z\" }",
        &["measured_by", "did you mean \"load\""],
    );
    of_ring_brush("offsets = { slip = 1e-3", "offsets = { slip = -1e-3", &["offsets", "slip", "at least 0"]);
    of_ring_brush(
        "zero = \"off the road\"",
        "zero = \"of the road\"",
        &["zero", "did you mean \"off the road\""],
    );
    of_ring_brush("recorded = { path_speed", "recorded = { path_sped", &["did you mean \"path_speed\""]);
    // what is brought about
    of_ring_brush(", first_of = 8 }", " }", &["no output", "first_of"]);
    of_ring_brush(
        ", first_of = 8 },",
        ", first_of = 8 },\n    { read = \"force_z\", value = 5000.0, by = \"camber\", between = [0.0, 1.0], first_of = 4 },",
        &["slip", "camber", "one of them"],
    );
    // names of what is registered
    of_ring_brush("inversion = \"identity\"", "inversion = \"identiy\"", &["did you mean \"identity\""]);
    of_ring_brush(
        "read = \"contact force\"",
        "read = \"contact forse\"",
        &["did you mean \"contact force\""],
    );
    of_ring_brush("along = \"slip\"", "along = \"slp\"", &["did you mean \"slip\""]);
    of_ring_brush(
        "read = \"aligning moment over yaw\"",
        "read = \"aligning moment over yaw\"\nalong = \"slip\"",
        &["has no slope"],
    );
    // a transform of another model's parameters
    let other = MAGIC_FORMULA.replace(
        "{ name = \"PKX1\", bounds = [15.0, 50.0] }]",
        "{ name = \"PKX1\", bounds = [15.0, 50.0] }]\ntransform = \"length factor of a known shear stiffness\"",
    );
    is_refused(&other, ring_brush::REGISTRY, &["magic-formula-flat-track", "stripe_length_factor"]);
}

/// Each way that a plan can name finds what made the targets; one beside a closed form is refused.
#[test]
fn a_plan_says_how_a_group_is_solved() {
    let stiffness = "{ name = \"PKX1\", bounds = [15.0, 50.0] }]";
    let peak = "nesting = { rises = [1, -1], falls = [[0, -1], [0, 0]] }";
    for (of_stiffness, of_peak) in [("newton", "gradient"), ("nested-bisection", "nested-bisection")] {
        let text = MAGIC_FORMULA
            .replace(stiffness, &format!("{stiffness}\nsolver = \"{of_stiffness}\""))
            .replace(peak, &format!("{peak}\nsolver = \"{of_peak}\""));
        let plan = Plan::read(&text).unwrap();
        assert!(plan.groups[1].solver.is_some() && plan.groups[2].solver.is_some());
        let stand = stand(&plan.model);
        let readings =
            |numbers: &Numbers| Readings::new(&plan, &stand, ring_brush::REGISTRY, numbers).unwrap();
        let truth = [21.0, 1.3, 1.6];
        let true_values: Numbers =
            ["PKX1", "PDX1", "PCX1"].into_iter().map(str::to_owned).zip(truth).collect();
        let made = readings(&true_values);
        let goal = Goal::new(&made.at(&made.sought_values(&Numbers::new()).unwrap()).unwrap());
        let found = readings(&Numbers::new()).identify(&goal).unwrap();
        assert!(found.unsolved.is_empty(), "{:?}", found.unsolved);
        for (value, truth) in found.parameters[1..4].iter().zip(truth) {
            assert!((value / truth - 1.0).abs() < 1e-6, "{of_stiffness}: {value} instead of {truth}");
        }
    }
    of_ring_brush(
        "inversion = \"identity\"",
        "inversion = \"identity\"\nsolver = \"newton\"",
        &["tilt of the side wall", "solver", "\"identity\" solves this group"],
    );
    of_ring_brush("tail = -1 }", "tail = -1 }\nsolver = \"secant\"", &["secant", "nested-bisection"]);
}

/// Few draws, as each takes seconds.
#[test]
fn the_plan_of_the_ring_and_brush_tire_is_checked() {
    use Standing::{Open, Passed};
    let report = checked(ring_brush::PLAN, Sampling { constants: 2, draws: 2, seed: 1, tolerance: 1e-6 });
    for group in &report.groups {
        assert!(group.dependence.is_none(), "{group:?}");
        let has_form = ["vertical springs", "tilt of the side wall"].contains(&group.name.as_str());
        match &group.closed_form {
            Some(form) => assert!(has_form && form.deviation < 1e-4 && form.points > 3, "{form:?}"),
            None => assert!(!has_form),
        }
    }
    let standings = standings(&report);
    let expected = [Open, Passed, Passed, Passed, Passed, Passed, Passed, Open, Passed];
    assert_eq!(standings, expected, "{report}");
    // group by group as in the plan, but for the tilt of the side wall, which needs nothing
    let chosen: Vec<Option<usize>> = chosen(&report).concat();
    assert_eq!(chosen[..8], [1, 3, 2, 4, 5, 6, 7, 8].map(Some), "{report}");
}

#[test]
fn what_a_stand_was_asked_it_remembers_and_says_as_a_new_one() {
    let model = "magic-formula-flat-track";
    let old = stand(model);
    let find = |name: &str| old.interface().find(name).unwrap();
    let (angle, outputs) = (find("slip_angle"), ["force_y", "moment_z"].map(find));
    let values = |at: f64| [(find("deflection"), 0.02), (find("path_speed"), 15.0), (find("slip_angle"), at)];
    let asked = |stand: &Stand, at: f64| {
        let still = stand.stationary(&values(at), &outputs).unwrap();
        let (same, slopes) = stand.state(&values(at), &outputs, &[angle]).unwrap();
        assert_eq!(still, same);
        (still, slopes, stand.along(&values(at), &[(angle, 0.1)], 0.1, 5, &outputs).unwrap())
    };
    let (small, large) = (asked(&old, 0.01), asked(&old, 0.03));
    assert!(small.0 != large.0 && small.1 != large.1 && small.2 != large.2);
    assert_ne!(small.2[0], small.2[5]);
    let starts = old.starts();
    assert!(asked(&old, 0.03) == large && asked(&old, 0.01) == small);
    let force = old.stationary(&values(0.01), &[find("force_z")]).unwrap();
    assert_eq!(old.starts(), starts);
    let new = stand(model);
    assert_eq!(new.stationary(&values(0.01), &[find("force_z")]).unwrap(), force);
    assert!(asked(&new, 0.03) == large && asked(&new, 0.01) == small);
    // what is no output, and what is refused
    assert_eq!(old.stationary(&values(0.01), &[angle, outputs[0]]).unwrap(), [0.01, small.0[0]]);
    let refused = || old.stationary(&values(f64::NAN), &outputs).unwrap_err().to_string();
    assert_eq!(refused(), refused());
}
