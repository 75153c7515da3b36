//! Counts of load cycles: what of a history matters for damage, whatever its timing.
//!
//! A comparison of courses mixes errors of size and of phase; for damage only sizes and counts matter
//! (Mack 2009, L2229, L2252). Definitions are the standard ones; for rainflow the four-point
//! method, which is independent of the order in which cycles are found.

use std::collections::BTreeMap;

/// Smallest and largest of the finite values; `None` without any.
pub fn extremes(values: &[f64]) -> Option<(f64, f64)> {
    values.iter().filter(|v| v.is_finite()).fold(None, |found, v| match found {
        None => Some((*v, *v)),
        Some((low, high)) => Some((v.min(low), v.max(high))),
    })
}

/// How often the values cross each level upwards: y(i) < level <= y(i+1). Values that are not finite are
/// left out.
pub fn level_crossings(values: &[f64], levels: &[f64]) -> Vec<usize> {
    let mut ordered: Vec<(usize, f64)> = levels.iter().copied().enumerate().collect();
    ordered.sort_by(|a, b| a.1.total_cmp(&b.1));
    // starts[k]: crossings from below level k; they end above the last level that is not higher than y(i+1)
    let mut change = vec![0_i64; levels.len() + 1];
    let finite: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    for pair in finite.windows(2) {
        let first = ordered.partition_point(|l| l.1 <= pair[0]);
        let end = ordered.partition_point(|l| l.1 <= pair[1]);
        if first < end {
            change[first] += 1;
            change[end] -= 1;
        }
    }
    let mut counts = vec![0; levels.len()];
    let mut count = 0;
    for ((place, _), change) in ordered.iter().zip(&change) {
        count += change;
        counts[*place] = usize::try_from(count).unwrap_or(0);
    }
    counts
}

/// The first value, the last one, and those between where the values turn. Values that are not finite are
/// left out.
pub fn turning_points(values: &[f64]) -> Vec<f64> {
    let mut points: Vec<f64> = Vec::new();
    for value in values.iter().copied().filter(|v| v.is_finite()) {
        if points.last() == Some(&value) {
            continue;
        }
        if let [.., before, last] = points[..]
            && (last > before) == (value > last)
        {
            points.pop();
        }
        points.push(value);
    }
    points
}

/// The turning points without those between which the values move by less than `gate`: what noise adds to
/// a count. Values that are not finite are left out.
pub fn large_turning_points(values: &[f64], gate: f64) -> Vec<f64> {
    let points = turning_points(values);
    let Some(first) = points.first().copied() else { return points };
    let mut kept: Vec<f64> = Vec::new();
    // before the first large movement: what the values have reached on both sides
    let (mut low, mut high) = (first, first);
    // after it: the extreme since the last kept point
    let mut reached = first;
    for point in points.into_iter().skip(1) {
        match kept.last() {
            None if point - low >= gate => {
                kept.push(low);
                reached = point;
            }
            None if high - point >= gate => {
                kept.push(high);
                reached = point;
            }
            None => (low, high) = (low.min(point), high.max(point)),
            Some(start) if (reached > *start) == (point > reached) => reached = point,
            Some(_) => {
                if (point - reached).abs() >= gate {
                    kept.push(reached);
                    reached = point;
                }
            }
        }
    }
    kept.push(reached);
    kept
}

/// A closed cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cycle {
    /// The turning point that came first.
    pub from: f64,
    /// The other one.
    pub to: f64,
}

impl Cycle {
    /// Its size, from turning point to turning point.
    pub fn range(&self) -> f64 {
        (self.to - self.from).abs()
    }
}

/// What a rainflow count does with the turning points that close no cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Residue {
    /// They do not count.
    Ignored,
    /// Each range between two of them is half a cycle, as in ASTM E1049.
    #[default]
    Half,
    /// They are run through twice, as if the history were repeated; what closes then counts.
    Twice,
}

/// The result of a rainflow count.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Rainflow {
    /// The closed cycles in the order in which they close.
    pub cycles: Vec<Cycle>,
    /// The turning points that are left: ranges that first grow and then shrink.
    pub residue: Vec<f64>,
}

/// Counts the cycles of a history by the four-point method: of four turning points in a row the inner two
/// are a cycle if their range is not larger than those on both sides; they are taken out.
pub fn rainflow(values: &[f64]) -> Rainflow {
    let mut counted = Rainflow::default();
    for point in turning_points(values) {
        counted.push(point);
    }
    counted
}

impl Rainflow {
    /// One more turning point.
    fn push(&mut self, point: f64) {
        self.residue.push(point);
        while let [.., a, b, c, d] = self.residue[..] {
            let inner = (c - b).abs();
            if inner > (b - a).abs() || inner > (d - c).abs() {
                break;
            }
            self.cycles.push(Cycle { from: b, to: c });
            self.residue.truncate(self.residue.len() - 3);
            self.residue.push(d);
        }
    }

    /// All cycles as (from, to, count).
    pub fn counted(&self, residue: Residue) -> Vec<(Cycle, f64)> {
        let mut all: Vec<(Cycle, f64)> = self.cycles.iter().map(|c| (*c, 1.0)).collect();
        match residue {
            Residue::Ignored => {}
            Residue::Half => {
                all.extend(self.residue.windows(2).map(|w| (Cycle { from: w[0], to: w[1] }, 0.5)));
            }
            Residue::Twice => {
                let twice = [self.residue.as_slice(), self.residue.as_slice()].concat();
                all.extend(rainflow(&twice).cycles.into_iter().map(|c| (c, 1.0)));
            }
        }
        all
    }

    /// The range \[unit of the values\] of cycles that all alike, in the number that was counted, would do
    /// the same damage on an S-N line of this slope: the mean of range^slope to the power 1/slope. 0
    /// without cycles.
    pub fn equivalent_range(&self, residue: Residue, slope: f64) -> f64 {
        let counted = self.counted(residue);
        let total: f64 = counted.iter().map(|(_, n)| n).sum();
        let largest = counted.iter().map(|(c, _)| c.range()).fold(0.0, f64::max);
        if total <= 0.0 || largest <= 0.0 {
            return 0.0;
        }
        // relative to the largest: no overflow
        let mean: f64 =
            counted.iter().map(|(c, n)| n * (c.range() / largest).powf(slope)).sum::<f64>() / total;
        largest * mean.powf(1.0 / slope)
    }
}

/// Range pairs: the number of cycles in each class of range, class k from k to k+1 widths (the upper
/// end excluded), by rainflow. The last class takes all larger ones.
pub fn range_pairs(counted: &Rainflow, residue: Residue, width: f64, classes: usize) -> Vec<f64> {
    let mut counts = vec![0.0; classes];
    for (cycle, count) in counted.counted(residue) {
        // the cast saturates, NaN becomes 0
        let class = ((cycle.range() / width) as usize).min(classes.saturating_sub(1));
        if let Some(sum) = counts.get_mut(class) {
            *sum += count;
        }
    }
    counts
}

/// Range pairs summed up from the largest: for each class from the largest that has any on, the number of cycles of its range and larger, and
/// that range.
pub fn summed_up(pairs: &[f64], width: f64) -> (Vec<f64>, Vec<f64>) {
    let mut sum = 0.0;
    let classes = pairs.iter().enumerate().rev().skip_while(|(_, n)| **n == 0.0);
    classes
        .map(|(class, n)| {
            sum += n;
            (sum, class as f64 * width)
        })
        .unzip()
}

/// Classes of equal width over a span, which go on beyond it with the same width: a simulation may reach farther than recordings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Classes {
    /// The span.
    pub span: [f64; 2],
    /// Classes within the span.
    pub number: usize,
    /// Width of a class \[unit of the values\].
    pub width: f64,
}

impl Classes {
    /// So many classes over a span.
    pub fn new([low, high]: [f64; 2], number: usize) -> Self {
        Self { span: [low, high], number, width: (high - low) / number as f64 }
    }

    /// The class of a value, from 0 at the span's low end; negative below it. The lower end of a class belongs to it, and the span's high end to
    /// the last class.
    pub fn of(&self, value: f64) -> i64 {
        let last = self.number as i64 - 1;
        // the cast stops at its ends
        let class = ((value - self.span[0]) / self.width).floor() as i64;
        if class == last + 1 && value <= self.span[1] { last } else { class }
    }

    /// Where a class begins and ends.
    pub fn ends(&self, class: i64) -> [f64; 2] {
        [class, class.saturating_add(1)].map(|edge| self.span[0] + edge as f64 * self.width)
    }
}

/// The cells of the from-to matrix that have cycles: class of the turning point that came first, class of the other one, and the number of cycles
/// between them. Rows of the matrix one after the other.
pub fn from_to(counted: &[(Cycle, f64)], classes: &Classes) -> Vec<([i64; 2], f64)> {
    let mut cells = BTreeMap::new();
    for (cycle, count) in counted {
        *cells.entry([classes.of(cycle.from), classes.of(cycle.to)]).or_insert(0.0) += count;
    }
    cells.into_iter().collect()
}

/// The rainflow matrix: the number of cycles from each class of values to each class, rows `from`,
/// `classes` of equal width between `low` and `high`; what lies outside counts in the outermost.
pub fn rainflow_matrix(
    counted: &Rainflow,
    residue: Residue,
    (low, high): (f64, f64),
    classes: usize,
) -> Vec<Vec<f64>> {
    let mut counts = vec![vec![0.0; classes]; classes];
    let class = |value: f64| {
        let share = (value - low) / (high - low);
        ((share * classes as f64) as usize).min(classes.saturating_sub(1))
    };
    for (cycle, count) in counted.counted(residue) {
        if let Some(sum) = counts.get_mut(class(cycle.from)).and_then(|row| row.get_mut(class(cycle.to))) {
            *sum += count;
        }
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The history of ASTM E1049, figure 6.
    const ASTM: [f64; 9] = [-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0];

    /// Sizes of cycles and their sums, smallest first.
    fn ranges(counted: &Rainflow, residue: Residue) -> Vec<(f64, f64)> {
        let mut sums: Vec<(f64, f64)> = Vec::new();
        let mut all: Vec<(f64, f64)> =
            counted.counted(residue).iter().map(|(c, n)| (c.range(), *n)).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (range, n) in all {
            match sums.last_mut() {
                Some(last) if last.0 == range => last.1 += n,
                _ => sums.push((range, n)),
            }
        }
        sums
    }

    #[test]
    fn the_example_of_astm_by_hand() {
        // -2 1 -3 5 -1 3 -4 4 -2: of (5, -1, 3, -4) the inner range 4 is neither larger than 6 nor than 7,
        // so -1 to 3 closes. Of what is left, -2 1 -3 5 -4 4 -2 with the ranges 3 4 8 9 8 6, no inner
        // range is the smallest of three.
        let counted = rainflow(&ASTM);
        assert_eq!(counted.cycles, [Cycle { from: -1.0, to: 3.0 }]);
        assert_eq!(counted.residue, [-2.0, 1.0, -3.0, 5.0, -4.0, 4.0, -2.0]);
        assert_eq!(ranges(&counted, Residue::Ignored), [(4.0, 1.0)]);
        // half cycles for 3 4 8 9 8 6
        assert_eq!(
            ranges(&counted, Residue::Half),
            [(3.0, 0.5), (4.0, 1.5), (6.0, 0.5), (8.0, 1.0), (9.0, 0.5)]
        );
        // a second time through -2 1 -3 5 -4 4 -2 (1 -3 5 -4 4 -2): at the seam (4, -2, 1, -3) closes 3,
        // then (-4, 4, -3, 5) closes 7, then (5, -4, 5, -4) closes 9
        assert_eq!(ranges(&counted, Residue::Twice), [(3.0, 1.0), (4.0, 1.0), (7.0, 1.0), (9.0, 1.0)]);
    }

    #[test]
    fn range_pairs_and_the_matrix_of_the_example() {
        let counted = rainflow(&ASTM);
        // classes 0-2, 2-4, 4-6, 6-8, 8 and more: 3 | 4 1.5 times | 6 | 8 twice half, 9
        assert_eq!(range_pairs(&counted, Residue::Half, 2.0, 5), [0.0, 0.5, 1.5, 0.5, 1.5]);
        assert_eq!(range_pairs(&counted, Residue::Half, 2.0, 0), Vec::<f64>::new());
        // nothing in the largest class is left out, nothing below it
        let summed = summed_up(&[0.0, 0.5, 0.0, 1.5, 0.0], 2.0);
        assert_eq!(summed, (vec![1.5, 1.5, 2.0, 2.0], vec![6.0, 4.0, 2.0, 0.0]));
        // five classes of width 2 from -5 to 5: -1 lies in the third, 3 in the fifth
        let matrix = rainflow_matrix(&counted, Residue::Ignored, (-5.0, 5.0), 5);
        assert_eq!(matrix[2][4], 1.0);
        assert_eq!(matrix.iter().flatten().sum::<f64>(), 1.0);
    }

    #[test]
    fn the_from_to_matrix_of_the_example_goes_on_beyond_its_span() {
        // four classes of width 2 from -4 to 4: 5 is in the first one beyond, 4 in the last one, -4 in the first
        let classes = Classes::new([-4.0, 4.0], 4);
        assert_eq!(
            [-4.1, -4.0, -2.1, 0.0, 3.9, 4.0, 4.1, 5.0].map(|v| classes.of(v)),
            [-1, 0, 0, 2, 3, 3, 4, 4]
        );
        assert_eq!([classes.ends(-1), classes.ends(4)], [[-6.0, -4.0], [4.0, 6.0]]);
        // -2 1 -3 5 -4 4 -2 as halves, and -1 to 3
        let cells = from_to(&rainflow(&ASTM).counted(Residue::Half), &classes);
        let expected = [
            ([0, 3], 0.5),
            ([0, 4], 0.5),
            ([1, 2], 0.5),
            ([1, 3], 1.0),
            ([2, 0], 0.5),
            ([3, 1], 0.5),
            ([4, 0], 0.5),
        ];
        assert_eq!(cells, expected);
    }

    #[test]
    fn level_crossings_of_the_example_by_hand() {
        // upwards: -2 to 1, -3 to 5, -1 to 3, -4 to 4
        let levels = [-3.0, -2.0, -1.0, 0.0, 1.0, 1.5, 4.0, 5.0, 6.0];
        // a start on the level does not count, an end on it does
        assert_eq!(level_crossings(&ASTM, &levels), [1, 2, 3, 4, 4, 3, 2, 1, 0]);
        // in any order
        assert_eq!(level_crossings(&ASTM, &[5.0, 0.0, -3.0]), [1, 4, 1]);
        assert_eq!(level_crossings(&[], &[0.0]), [0]);
    }

    #[test]
    fn extremes_and_turning_points() {
        assert_eq!(extremes(&[f64::NAN, 2.0, -1.0, f64::INFINITY]), Some((-1.0, 2.0)));
        assert_eq!(extremes(&[f64::NAN]), None);
        assert_eq!(turning_points(&[1.0, 1.0, 2.0, 3.0, 3.0, f64::NAN, 2.0, 2.0, 2.5]), [1.0, 3.0, 2.0, 2.5]);
        assert_eq!(turning_points(&[4.0, 4.0]), [4.0]);
        assert_eq!(rainflow(&[]), Rainflow::default());
    }

    #[test]
    fn small_turns_are_left_out_and_extremes_kept() {
        let noisy = [0.0, 0.2, 0.1, 3.0, 2.9, 5.0, 4.8, 5.1, 1.0, 1.3, -2.0, -1.9, 4.0];
        assert_eq!(large_turning_points(&noisy, 1.0), [0.0, 5.1, -2.0, 4.0]);
        assert_eq!(large_turning_points(&noisy, 0.0), turning_points(&noisy));
        assert_eq!(large_turning_points(&noisy, 100.0), [0.0]);
        assert_eq!(large_turning_points(&[], 1.0), Vec::<f64>::new());
        // the example's without the 3 and 4 at its start and the 4 inside
        assert_eq!(large_turning_points(&ASTM, 4.5), [-3.0, 5.0, -4.0, 4.0, -2.0]);
        // a start in the middle hides nothing
        assert_eq!(large_turning_points(&[0.0, 3.0, -3.0, 3.0, 0.0], 5.0), [3.0, -3.0, 3.0]);
    }

    #[test]
    fn the_equivalent_range_of_equal_cycles_is_theirs() {
        let wave: Vec<f64> = (0..21).map(|i| if i % 2 == 0 { -1.5 } else { 1.5 }).collect();
        let counted = rainflow(&wave);
        assert!((counted.equivalent_range(Residue::Half, 5.0) - 3.0).abs() < 1e-12);
        // half of the cycles at 1, half at 2: ((1 + 32) / 2)^(1/5)
        let two = Rainflow {
            cycles: vec![Cycle { from: 0.0, to: 1.0 }, Cycle { from: 0.0, to: 2.0 }],
            residue: vec![],
        };
        assert!((two.equivalent_range(Residue::Ignored, 5.0) - 16.5_f64.powf(0.2)).abs() < 1e-12);
        assert_eq!(Rainflow::default().equivalent_range(Residue::Half, 5.0), 0.0);
    }

    proptest! {
        // whole numbers: sums of ranges are exact and ties are frequent
        #[test]
        fn every_range_is_in_one_cycle_or_in_the_residue(values in history()) {
            let counted = rainflow(&values);
            let points = turning_points(&values);
            prop_assert_eq!(2 * counted.cycles.len() + counted.residue.len(), points.len());
            let length = |p: &[f64]| p.windows(2).map(|w| (w[1] - w[0]).abs()).sum::<f64>();
            let closed: f64 = counted.cycles.iter().map(|c| 2.0 * c.range()).sum();
            prop_assert_eq!(length(&points), closed + length(&counted.residue));
        }

        #[test]
        fn the_sign_does_not_matter(values in history(), level in -9_i32..9) {
            let mirrored: Vec<f64> = values.iter().map(|v| -v).collect();
            for residue in [Residue::Ignored, Residue::Half, Residue::Twice] {
                prop_assert_eq!(ranges(&rainflow(&values), residue), ranges(&rainflow(&mirrored), residue));
            }
            // between the values: as many ways up as down, but for one
            let level = f64::from(level) + 0.5;
            let [up, down] = [level_crossings(&values, &[level])[0], level_crossings(&mirrored, &[-level])[0]];
            prop_assert!(up.abs_diff(down) <= 1);
            let ends = [values[0], values[values.len() - 1]];
            prop_assert_eq!(up == down, (ends[0] < level) == (ends[1] < level));
        }

        #[test]
        fn points_between_do_not_matter(values in history(), parts in 1_usize..5) {
            let mut finer = vec![values[0]];
            for w in values.windows(2) {
                finer.extend((1..=parts).map(|i| {
                    let share = i as f64 / parts as f64;
                    w[0] + share * (w[1] - w[0])
                }));
            }
            prop_assert_eq!(rainflow(&finer), rainflow(&values));
            let levels: Vec<f64> = (-20..20).map(|i| f64::from(i) / 2.0 + 0.1).collect();
            prop_assert_eq!(level_crossings(&finer, &levels), level_crossings(&values, &levels));
        }

        #[test]
        fn histories_may_be_counted_one_after_the_other(a in history(), b in history()) {
            let whole = rainflow(&[a.as_slice(), b.as_slice()].concat());
            let (first, second) = (rainflow(&a), rainflow(&b));
            let seam = rainflow(&[first.residue.as_slice(), second.residue.as_slice()].concat());
            prop_assert_eq!(&whole.residue, &seam.residue);
            let mut parts = [first.cycles, second.cycles, seam.cycles].concat();
            let mut all = whole.cycles;
            for list in [&mut parts, &mut all] {
                list.sort_by(|x, y| x.range().total_cmp(&y.range()));
            }
            let sizes = |list: &[Cycle]| list.iter().map(Cycle::range).collect::<Vec<_>>();
            prop_assert_eq!(sizes(&all), sizes(&parts));
        }
    }

    fn history() -> impl Strategy<Value = Vec<f64>> {
        prop::collection::vec((-10_i32..=10).prop_map(f64::from), 1..60)
    }
}
