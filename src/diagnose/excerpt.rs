//! Runs made of a run: its beginning, its end, or the same with longer or shorter communication steps.

use crate::fit::{Drive, Run};
use std::sync::Arc;

/// The first seconds of a run.
pub(super) fn beginning(run: &Run, seconds: f64) -> Run {
    let drive = &run.drive;
    let points = drive.points.min((seconds / drive.step).ceil() as usize + 1);
    let end = drive.time(points - 1);
    let samples = run.time.partition_point(|t| *t <= end);
    let first = |values: &Vec<f64>, n: usize| values[..n.min(values.len())].to_vec();
    let drive = Drive {
        start: drive.start,
        step: drive.step,
        inputs: drive.inputs.iter().map(|(v, values)| (*v, first(values, points))).collect(),
        begins: drive.begins.clone(),
        earlier: Arc::clone(&drive.earlier),
        points,
        coarser: None,
    };
    Run {
        name: run.name.clone(),
        drive: Arc::new(drive),
        time: first(&run.time, samples),
        channels: run.channels.iter().map(|c| c.samples(0..samples)).collect(),
    }
}

/// The samples of a run after a time \[s\]. It is driven from its start, so that what has a history has it.
pub(super) fn end(run: &Run, after: f64) -> Run {
    let first = run.time.partition_point(|t| *t <= after);
    Run {
        name: run.name.clone(),
        drive: Arc::clone(&run.drive),
        time: run.time[first..].to_vec(),
        channels: run.channels.iter().map(|c| c.samples(first..run.time.len())).collect(),
    }
}

/// The same run with one communication step for each sample, if it has more: enough to rank effects.
pub(super) fn coarser(run: &Run) -> Run {
    let drive = &run.drive;
    let parts = drive.points.saturating_sub(1) / run.time.len().saturating_sub(1).max(1);
    if parts < 2 || !(drive.points - 1).is_multiple_of(parts) {
        return run.clone();
    }
    let thin = |values: &Vec<f64>| values.iter().step_by(parts).copied().collect();
    let drive = Drive {
        start: drive.start,
        step: drive.step * parts as f64,
        inputs: drive.inputs.iter().map(|(v, values)| (*v, thin(values))).collect(),
        begins: drive.begins.clone(),
        earlier: Arc::clone(&drive.earlier),
        points: (drive.points - 1) / parts + 1,
        coarser: None,
    };
    Run { drive: Arc::new(drive), ..run.clone() }
}

/// The same run with a quarter of the communication step; the longer ones are kept for what they are enough for.
pub(super) fn finer(run: &Run) -> Run {
    const PARTS: usize = 4;
    let drive = &run.drive;
    let points = (drive.points - 1) * PARTS + 1;
    let refine = |values: &Vec<f64>| {
        (0..points)
            .map(|k| {
                let (i, part) = (k / PARTS, k % PARTS);
                let next = values[(i + 1).min(values.len() - 1)];
                if part == 0 {
                    values[i]
                } else {
                    values[i] + (next - values[i]) * part as f64 / PARTS as f64
                }
            })
            .collect()
    };
    let drive = Drive {
        start: drive.start,
        step: drive.step / PARTS as f64,
        inputs: drive.inputs.iter().map(|(v, values)| (*v, refine(values))).collect(),
        begins: drive.begins.clone(),
        earlier: Arc::clone(&drive.earlier),
        points,
        coarser: drive.coarser.clone().or_else(|| Some(Arc::clone(drive))),
    };
    Run { drive: Arc::new(drive), ..run.clone() }
}

/// The same run of which its own communication steps tell all.
pub(super) fn without_coarser(run: &Run) -> Run {
    Run { drive: Arc::new(Drive { coarser: None, ..Drive::clone(&run.drive) }), ..run.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::Channel;

    #[test]
    fn the_beginning_of_a_run_is_that_of_its_drive_and_samples() {
        let course = |n: usize| (0..n).map(|k| k as f64).collect::<Vec<f64>>();
        // 10 s of it, two communication steps for a sample
        let drive = Drive::new(1.0, 0.05, 201, vec![(0, course(201))]);
        let time: Vec<f64> = (0..101).map(|k| 1.0 + 0.1 * f64::from(k)).collect();
        let channels =
            vec![Channel { variable: 1, values: course(101), counts: true, unresolved: course(101) }];
        let run = Run { name: "a.csv".into(), drive: Arc::new(drive), time, channels };
        let piece = beginning(&run, 3.0);
        assert_eq!((piece.drive.points, piece.time.len()), (61, 31));
        assert_eq!(piece.drive.inputs, [(0, course(61))]);
        assert_eq!(
            piece.channels,
            [Channel { variable: 1, values: course(31), counts: true, unresolved: course(31) }]
        );
        // a shorter run is left as it is
        let whole = beginning(&piece, 3.0);
        assert_eq!((whole.drive, whole.time), (piece.drive.clone(), piece.time.clone()));
        // and finer and coarser undo each other
        let back = coarser(&coarser(&finer(&piece)));
        assert_eq!(back.drive.inputs, [(0, course(61).into_iter().step_by(2).collect())]);
    }
}
