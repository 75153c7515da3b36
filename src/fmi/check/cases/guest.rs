//! Cases: several instances, threads, memory, unloading.

use super::*;

pub(super) fn two_instances(lab: &Lab<'_>) {
    let Some(mut first) = lab.ready() else { return };
    let Some(alone) = lab.advance(&mut first, 0, STEPS, true) else { return lab.unable() };
    first.free();
    let (Some(mut a), Some(mut b)) = (lab.unit(), lab.unit()) else {
        return lab.reporter.found(Found {
            rule: "S8".into(),
            level: Level::Error,
            what: "a second instance cannot be made, but canBeInstantiatedOnlyOncePerProcess is not true"
                .into(),
            variable: None,
            attribute: Some("canBeInstantiatedOnlyOncePerProcess".into()),
        });
    };
    if !lab.initialize(&mut a) || !lab.initialize(&mut b) {
        return lab.reporter.error("S8", "two instances cannot be initialized at the same time");
    }
    let mut bits = Vec::new();
    for k in 0..STEPS {
        // The other one goes its own way.
        let other = lab.advance(&mut b, k, k + 1, false);
        let (Some(values), Some(_)) = (lab.advance(&mut a, k, k + 1, true), other) else {
            return lab.reporter.error("S8", "two instances cannot be stepped in turn");
        };
        bits.extend(values);
    }
    let same = || lab.ready().and_then(|mut unit| lab.advance(&mut unit, 0, STEPS, true));
    if bits != alone && lab.repeatable(&alone, same) {
        lab.reporter.error(
            "S8",
            format!("an instance runs otherwise beside another one: {}", differ(lab, &alone, &bits)),
        );
    }
}

pub(super) fn two_threads(lab: &Lab<'_>) {
    let run = || lab.ready().and_then(|mut unit| lab.advance(&mut unit, 0, 5 * STEPS, true));
    let Some(alone) = run() else { return lab.unable() };
    let results = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..2).map(|_| scope.spawn(run)).collect();
        threads.into_iter().map(|t| t.join().ok().flatten()).collect::<Vec<_>>()
    });
    for bits in results {
        match bits {
            None => lab.reporter.error("S8", "two instances cannot run in two threads at the same time"),
            Some(bits) if bits != alone && lab.repeatable(&alone, run) => {
                let what = format!(
                    "two instances in two threads disturb each other: {}",
                    differ(lab, &alone, &bits)
                );
                return lab.reporter.error("S8", what);
            }
            Some(_) => {}
        }
    }
}

pub(super) fn only_one(lab: &Lab<'_>) {
    let Some(_first) = lab.unit() else { return };
    if lab.unit().is_some() {
        lab.reporter.found(Found {
            rule: "S8".into(),
            level: Level::Warning,
            what: "canBeInstantiatedOnlyOncePerProcess is true, but a second instance was made".into(),
            variable: None,
            attribute: Some("canBeInstantiatedOnlyOncePerProcess".into()),
        });
    }
}

/// Memory that this process uses by itself \[bytes\]: what is resident less what maps a file, which the system
/// brings in and takes away as it likes.
pub(super) fn memory() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/self/statm").ok()?;
    let mut fields = text.split(' ').skip(1).map(str::parse::<u64>);
    let (resident, of_files) = (fields.next()?.ok()?, fields.next()?.ok()?);
    let pages = resident.saturating_sub(of_files);
    // Pages of 4 KiB are the smallest; larger ones only make leaks look smaller.
    Some(4096 * pages)
}

pub(super) fn leak(lab: &Lab<'_>) {
    let cycle = || -> Option<()> {
        let mut unit = lab.ready()?;
        for k in 0..3 {
            if unit.step(lab.t(k), lab.h()) > 1 {
                return None;
            }
        }
        if saves(lab.description) {
            let mut state = ptr::null_mut();
            if unit.save(&mut state) <= 1 {
                unit.free_state(&mut state);
            }
        }
        unit.terminate();
        Some(())
    };
    // After the first cycles the allocator has all that it keeps.
    for _ in 0..30 {
        if cycle().is_none() || lab.late(0.1) {
            break;
        }
    }
    // What a leak takes it takes for ever; a heap that settles touches new pages for some hundred cycles.
    let mut before = memory();
    let (mut cycles, mut grown) = (0, 0);
    for part in 1..=PARTS {
        let share = 0.1 + 0.6 * part as f64 / PARTS as f64;
        for _ in 0..300 {
            if cycle().is_none() || lab.late(share) {
                break;
            }
            cycles += 1;
        }
        let (Some(a), Some(b)) = (before, memory()) else { return };
        if b <= a + LEAK {
            return;
        }
        grown += b - a;
        before = Some(b);
    }
    // What came from the master's functions and was not given back is found by `memory`.
    let (_, _, living) = memory::account();
    if living == 0 {
        let per_cycle = grown / cycles.max(1);
        lab.reporter.error(
            "S10",
            format!("memory grows by about {per_cycle} bytes with each instance that is made and freed ({cycles} in all)"),
        );
    }
}

pub(super) fn unload(lab: &Lab<'_>) {
    let Some(mut unit) = lab.ready() else { return };
    unit.step(lab.t(0), lab.h());
    unit.terminate();
}
