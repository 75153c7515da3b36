//! What the judge makes of residuals that are made up.

use super::*;
use crate::stats::SplitMix64;

/// Blocks of the fit runs and of the check runs, and channels.
const BLOCKS: usize = 40;
const CHANNELS: usize = 2;
/// Independent samples that a block has of a channel.
const SAMPLES: usize = 25;

/// Noise of these sizes, by block and channel.
struct Runs {
    fit: Vec<Vec<f64>>,
    check: Vec<Vec<f64>>,
}

impl Runs {
    /// Squared errors of noise of the size 1.
    fn noise(random: &mut SplitMix64) -> Self {
        let mut blocks = || -> Vec<Vec<f64>> {
            let mut square = || (0..SAMPLES).map(|_| random.normal().powi(2)).sum();
            (0..BLOCKS).map(|_| (0..CHANNELS).map(|_| square()).collect()).collect()
        };
        Self { fit: blocks(), check: blocks() }
    }

    /// The same, and of the first channel so many times the noise besides, in squares.
    fn with(&self, missing: f64) -> [Rest; 2] {
        let more = |blocks: &[Vec<f64>]| -> Vec<Vec<f64>> {
            let of = |b: &Vec<f64>| vec![b[0] + missing * SAMPLES as f64, b[1]];
            blocks.iter().map(of).collect()
        };
        [rest(more(&self.fit)), rest(more(&self.check))]
    }
}

fn rest(blocks: Vec<Vec<f64>>) -> Rest {
    let total = blocks.iter().flatten().sum();
    Rest { simulated: Vec::new(), blocks, total, cost: total }
}

/// A candidate that leaves this, where the model leaves `before` without it, as the search makes evidence of it.
fn evidence<'a>(what: usize, left: &'a [Rest; 2], before: &[Rest; 2], tried: usize) -> Evidence<'a> {
    let units = left[0].by_channel();
    let p = sign_flip(&differences(&before[1].in_units(&units), &left[1].in_units(&units)));
    let gain = |k: usize| 1.0 - left[k].total / before[k].total;
    Evidence {
        is_named: true,
        what,
        price: 2.0 * ((2 * BLOCKS * SAMPLES * CHANNELS) as f64).ln(),
        fit: &left[0],
        check: &left[1],
        fit_gain: gain(0),
        check_gain: gain(1),
        is_confirmed: is_confirmed(p, None, tried, 1000),
        is_visible: true,
        runs_out: false,
        no_more_than: Vec::new(),
        refuted: None,
    }
}

fn case<'a>(evidence: Vec<Evidence<'a>>, before: &'a [Rest; 2]) -> Case<'a> {
    let independent = (2 * BLOCKS * SAMPLES * CHANNELS) as f64;
    Case { evidence, before: &before[1], base: &before[1], is_first: true, independent }
}

/// Candidates that leave so much each, judged.
fn judged(missing: f64, left: &[f64], change: impl Fn(&mut [Evidence<'_>])) -> Verdict {
    let noise = Runs::noise(&mut SplitMix64::new(7));
    let before = noise.with(missing);
    let rests: Vec<[Rest; 2]> = left.iter().map(|left| noise.with(*left)).collect();
    let of = |(what, left)| evidence(what, left, &before, rests.len());
    let mut all: Vec<Evidence<'_>> = rests.iter().enumerate().map(of).collect();
    change(&mut all);
    judge(&case(all, &before))
}

fn number(verdict: &Verdict) -> Option<usize> {
    verdict.chosen.as_ref().map(|c| c.number)
}

#[test]
fn chance_names_nothing_more_often_than_the_level_says() {
    let mut random = SplitMix64::new(3);
    let rounds = 400;
    let mut named = 0;
    for _ in 0..rounds {
        let before = Runs::noise(&mut random).with(0.0);
        // ten candidates, each of which makes every block of the check runs larger or smaller by up to a tenth, by chance, and
        // was chosen because it makes those of the fit runs smaller
        let mut moved = |rest: &Rest, least: f64| {
            let mut of = |e: &f64| e * (1.0 + 0.1 * (random.normal().clamp(-1.0, 1.0)).max(least));
            self::rest(rest.blocks.iter().map(|b| b.iter().map(&mut of).collect()).collect())
        };
        let left: Vec<[Rest; 2]> = (0..10)
            .map(|_| {
                let check = moved(&before[1], -1.0);
                let fit =
                    rest(before[0].blocks.iter().map(|b| b.iter().map(|e| 0.95 * e).collect()).collect());
                [fit, check]
            })
            .collect();
        let all = left.iter().enumerate().map(|(i, l)| evidence(i, l, &before, left.len())).collect();
        named += usize::from(judge(&case(all, &before)).chosen.is_some());
    }
    // three standard deviations of a share of the level
    let most = LEVEL + 3.0 * (LEVEL * (1.0 - LEVEL) / f64::from(rounds)).sqrt();
    assert!(named as f64 / f64::from(rounds) < most, "{named} of {rounds}");
}

#[test]
fn the_level_is_shared_by_those_that_are_tried_or_by_all_places() {
    assert!(is_confirmed(LEVEL, None, 1, 1000) && !is_confirmed(LEVEL, None, 2, 1000));
    // runs in turn confirm what the check runs alone leave open, among all places, and only what these do not refute
    assert!(is_confirmed(0.9 * LEVEL, Some(LEVEL / 1000.0), 7, 1000));
    assert!(!is_confirmed(0.9 * LEVEL, Some(1.1 * LEVEL / 1000.0), 7, 1000));
    assert!(!is_confirmed(1.1 * LEVEL, Some(0.0), 7, 1000));
}

#[test]
fn the_candidate_that_explains_more_is_named_and_one_that_explains_as_much_is_its_rival() {
    let verdict = judged(2.0, &[1.0, 0.0, 1.9], |_| ());
    let chosen = verdict.chosen.unwrap();
    assert_eq!((chosen.number, chosen.others), (1, vec![]));
    assert_eq!(chosen.confidence, OFTEN_RIGHT);
    assert_eq!(verdict.reasons[0], "explains less than the one chosen");

    let verdict = judged(2.0, &[0.0, 0.0, 1.0], |all| all[1].price += 1.0);
    let chosen = verdict.chosen.unwrap();
    assert_eq!(chosen.number, 0);
    assert_eq!(chosen.others.iter().map(|o| o.0).collect::<Vec<_>>(), [1]);
    assert!(verdict.reasons[1].contains("do not separate"), "{}", verdict.reasons[1]);
    // the same effect by another signal is no rival
    let verdict = judged(2.0, &[0.0, 0.0], |all| (all[1].what, all[1].price) = (0, all[1].price + 1.0));
    let chosen = verdict.chosen.unwrap();
    assert_eq!((chosen.number, chosen.others, chosen.confidence), (0, vec![], OFTEN_RIGHT));
}

#[test]
fn what_is_no_more_than_a_simpler_one_is_called_that() {
    // the second is the first with one more parameter, and fits a little better
    let more = |all: &mut [Evidence<'_>]| all[1].no_more_than = vec![0];
    assert_eq!(number(&judged(2.0, &[0.005, 0.0], more)), Some(0));
    // it is more where its own parameter says so
    assert_eq!(number(&judged(2.0, &[0.005, 0.0], |all| all[0].price += 30.0)), Some(1));
    // the simpler one explains much less: then it is not as good, whatever the parameter says
    assert_eq!(number(&judged(2.0, &[0.5, 0.0], more)), Some(1));
}

#[test]
fn a_function_without_a_name_wins_only_where_names_miss_much() {
    let unnamed = |all: &mut [Evidence<'_>]| all[1].is_named = false;
    // a tenth of what there is to explain is missed by the name, and three tenths
    assert_eq!(number(&judged(2.0, &[0.2, 0.0], unnamed)), Some(0));
    assert_eq!(number(&judged(2.0, &[0.6, 0.0], unnamed)), Some(1));
    // without a name that may stand it is what is left to say
    let refuted = |all: &mut [Evidence<'_>]| {
        all[1].is_named = false;
        all[0].refuted = Some("not plausible");
    };
    let verdict = judged(2.0, &[0.0, 0.1], refuted);
    assert_eq!(number(&verdict), Some(1));
    assert_eq!(verdict.reasons[0], "not plausible");
}

#[test]
fn both_sets_of_runs_have_to_gain_and_some_channel_has_to_show_it() {
    type Spoil = fn(&mut Evidence<'_>);
    let spoilt: [(Spoil, &str); 4] = [
        (|e| e.fit_gain = 0.9 * MIN_GAIN, "of the fit runs"),
        (|e| e.check_gain = 0.9 * MIN_GAIN, "of the check runs"),
        (|e| e.is_visible = false, "any one channel"),
        (|e| e.is_confirmed = false, "chance"),
    ];
    for (spoil, why) in spoilt {
        let verdict = judged(2.0, &[0.0], |all| spoil(&mut all[0]));
        assert_eq!(verdict.chosen, None);
        assert!(verdict.reasons[0].contains(why), "{}", verdict.reasons[0]);
    }
}

#[test]
fn one_that_keeps_to_its_ranges_is_taken_where_it_is_as_good() {
    let ends = |all: &mut [Evidence<'_>]| all[1].runs_out = true;
    assert_eq!(number(&judged(2.0, &[0.005, 0.0], ends)), Some(0));
    assert_eq!(number(&judged(2.0, &[0.5, 0.0], ends)), Some(1));
}

#[test]
fn a_small_rest_without_a_name_is_left_alone_after_a_first_name() {
    let noise = Runs::noise(&mut SplitMix64::new(7));
    let (base, left) = (noise.with(4.0), noise.with(0.0));
    let chosen = |missing: f64| {
        let before = noise.with(missing);
        let mut function = evidence(0, &left, &before, 1);
        function.is_named = false;
        let case = Case { is_first: false, base: &base[1], ..case(vec![function], &before) };
        judge(&case).chosen.is_some()
    };
    // of four, a tenth and more than a fifth of what the name has explained
    assert!(!chosen(0.4) && chosen(0.8));
}

#[test]
fn units_of_channels_and_the_order_of_candidates_change_nothing() {
    let noise = Runs::noise(&mut SplitMix64::new(9));
    let (before, left) = (noise.with(1.5), [0.3, 0.0, 0.01].map(|left| noise.with(left)));
    let scaled = |rests: &[Rest; 2]| -> [Rest; 2] {
        let of = |rest: &Rest| self::rest(rest.blocks.iter().map(|b| vec![b[0], 4.0 * b[1]]).collect());
        [of(&rests[0]), of(&rests[1])]
    };
    let answer = |left: &[[Rest; 2]], before: &[Rest; 2], order: [usize; 3]| {
        let all = order.iter().map(|i| evidence(*i, &left[*i], before, 3)).collect();
        let chosen = judge(&case(all, before)).chosen.unwrap();
        let others: Vec<usize> = chosen.others.iter().map(|(i, _)| order[*i]).collect();
        (order[chosen.number], others)
    };
    let as_it_is = answer(&left, &before, [0, 1, 2]);
    assert_eq!(as_it_is, (1, vec![2]));
    assert_eq!(answer(&left, &before, [2, 0, 1]), as_it_is);
    let other = left.each_ref().map(scaled);
    assert_eq!(answer(&other, &scaled(&before), [0, 1, 2]), as_it_is);
}
