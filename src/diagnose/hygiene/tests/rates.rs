//! Rates: how often faults are found, and how often physics that the model lacks is taken for one.
//!
//! A rig with two outputs that move (a lightly damped mass, the force in its spring and damper) and a
//! third that saturates smoothly, driven by two inputs; 5 to 8 runs of different amplitude, level and
//! kind. The measured side has wrong parameters, one or two pieces of physics that the simulated side
//! lacks, coloured noise of 0.5 to 3 %, quantisation, and stamps that scatter by 5 to 10 %.

use super::*;
use crate::stats;

/// What is driven through the rig: forces \[N\] and speeds \[m/s\].
#[derive(Clone)]
struct Programme {
    kind: usize,
    amplitude: f64,
    level: f64,
    speed: f64,
    ramp: f64,
    phases: [f64; 6],
}

impl Programme {
    fn new(random: &mut Random) -> Self {
        Self {
            kind: random.below(4),
            amplitude: random.within(0.5, 2.0),
            level: random.within(-1.0, 1.0),
            speed: random.within(5.0, 30.0),
            ramp: random.within(-0.3, 0.3),
            phases: std::array::from_fn(|_| random.within(0.0, std::f64::consts::TAU)),
        }
    }
    /// Force and speed at `t` of a run of `length`.
    fn at(&self, t: f64, length: f64) -> (f64, f64) {
        let share = t / length;
        let p = &self.phases;
        let wave = match self.kind {
            // a multisine
            0 => (0..6).map(|k| (2.0 * (1.0 + 1.7 * k as f64) * t + p[k]).sin()).sum::<f64>() / 2.0,
            // a sweep
            1 => (2.0 * t + 6.0 * t * share + p[0]).sin() * 1.4,
            // steps that are not quite sharp
            2 => 1.2 * (4.0 * (1.3 * t + p[0]).sin()).tanh(),
            // one sine
            _ => 1.4 * ((2.0 + p[1]) * t + p[0]).sin(),
        };
        let speed = self.speed * (1.0 + self.ramp * share);
        (100.0 * (self.amplitude * wave + self.level), speed)
    }
}

/// The rig: its parameters, and the physics that may be left out.
#[derive(Clone, Default)]
struct Rig {
    stiffness: f64,
    damping: f64,
    mass: f64,
    peak: f64,
    friction: f64,
    cubic: f64,
    stop: f64,
    relaxation: f64,
    lag: f64,
    delay: f64,
    bias: f64,
    gain: f64,
    drift: f64,
    order: f64,
    fade: f64,
    speed_effect: f64,
    hysteresis: f64,
}

impl Rig {
    fn new() -> Self {
        Self { stiffness: 4000.0, damping: 60.0, mass: 10.0, peak: 1.0, gain: 1.0, ..Self::default() }
    }

    /// The outputs at `times`, by semi-implicit Euler at 4 ms.
    fn run(&self, programme: &Programme, times: &[f64], length: f64) -> [Vec<f64>; 3] {
        const STEP: f64 = 0.004;
        let (mut x, mut v, mut lagged, mut slow, mut heat, mut z, mut angle) =
            (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        x += programme.at(0.0, length).0 / self.stiffness;
        let count = (length / STEP) as usize + 2;
        let mut grid = [Vec::with_capacity(count), Vec::with_capacity(count), Vec::with_capacity(count)];
        for i in 0..count {
            let (u, speed) = programme.at(i as f64 * STEP, length);
            let stop = self.stop * ((x - 0.05_f64).max(0.0) + (x + 0.05_f64).min(0.0));
            z += STEP * (v - f64::abs(v) * z / 0.01);
            let spring = self.stiffness * x + self.cubic * x * x * x + self.damping * v + stop;
            let rubbed = self.friction * (v / 0.01).tanh() + self.hysteresis * z / 0.01;
            v += STEP * (u - spring - rubbed) / self.mass;
            x += STEP * v;
            angle += STEP * speed / 0.3;
            heat += STEP * (u * u * 1e-4 - heat) / 4.0;
            let grip =
                self.peak * (1.0 - self.fade * heat) * (1.0 - self.speed_effect * (speed - 15.0) / 15.0);
            let side = 3000.0 * grip * (u / 150.0).tanh();
            slow = if self.relaxation > 0.0 {
                slow + STEP * speed / self.relaxation * (side - slow)
            } else {
                side
            };
            let force = spring + self.order * f64::cos(angle);
            lagged = if self.lag > 0.0 { lagged + STEP / self.lag * (force - lagged) } else { force };
            grid[0].push(x);
            grid[1].push(self.gain * lagged + self.bias + self.drift * i as f64 * STEP);
            grid[2].push(slow);
        }
        grid.map(|values| {
            times
                .iter()
                .map(|t| {
                    let at = ((t - self.delay).max(0.0) / STEP).min((count - 2) as f64);
                    let k = at as usize;
                    values[k] + (at - k as f64) * (values[k + 1] - values[k])
                })
                .collect()
        })
    }

    /// Adds something that the model lacks.
    fn leave_out(&mut self, random: &mut Random) {
        match random.below(14) {
            0 => self.friction = random.within(5.0, 30.0),
            1 => self.cubic = random.within(1e5, 1e6),
            2 => self.stop = random.within(1e3, 1e4),
            3 => self.relaxation = random.within(0.2, 1.0),
            4 => self.lag = random.within(0.01, 0.05),
            5 => self.delay = random.within(0.01, 0.05),
            6 => self.bias = random.within(-40.0, 40.0),
            7 => self.gain = random.within(0.85, 1.15),
            8 => self.drift = random.within(-5.0, 5.0),
            9 => self.order = random.within(5.0, 30.0),
            10 => self.fade = random.within(0.05, 0.2),
            11 => self.speed_effect = random.within(0.05, 0.25),
            12 => self.hysteresis = random.within(5.0, 30.0),
            // its resonance is elsewhere
            _ => self.stiffness *= random.within(0.7, 1.4),
        }
    }
}

const OUTPUTS: [(&str, &str); 3] = [("travel", "m"), ("force", "N"), ("side_force", "N")];

/// A case without faults.
fn case(random: &mut Random, lacks: usize) -> Case {
    let model = Rig::new();
    let mut truth = model.clone();
    for parameter in [&mut truth.stiffness, &mut truth.damping, &mut truth.mass, &mut truth.peak] {
        *parameter *= random.within(0.9, 1.1);
    }
    for _ in 0..lacks {
        truth.leave_out(random);
    }
    let runs = 5 + random.below(4);
    let samples = 500;
    let interval = 0.02;
    let length = samples as f64 * interval;
    let jitter = random.within(0.05, 0.1);
    let noise = random.within(0.005, 0.03);
    let colour = random.within(0.0, 0.9);
    let mut case = Case {
        measured: Vec::new(),
        simulated: Vec::new(),
        channels: OUTPUTS.iter().map(|o| o.0.to_owned()).collect(),
    };
    for run in 0..runs {
        let programme = Programme::new(random);
        let times: Vec<f64> = (0..samples)
            .map(|i| interval * (i as f64 + if i > 0 { jitter * random.within(-1.7, 1.7) } else { 0.0 }))
            .collect();
        let recording = |outputs: [Vec<f64>; 3], shown: &[(f64, f64)]| Recording {
            time: times.clone(),
            channels: [("drive", "N"), ("speed", "m/s")]
                .iter()
                .zip([shown.iter().map(|s| s.0).collect(), shown.iter().map(|s| s.1).collect::<Vec<f64>>()])
                .chain(OUTPUTS.iter().zip(outputs))
                .map(|((name, unit), values)| Channel { name: (*name).into(), unit: (*unit).into(), values })
                .collect(),
            source: format!("rig/run{run}.csv"),
        };
        let shown: Vec<(f64, f64)> = times.iter().map(|t| programme.at(*t, length)).collect();
        let simulated = model.run(&programme, &times, length);
        let mut measured = truth.run(&programme, &times, length);
        for values in &mut measured {
            let size = stats::deviation(values);
            let step = 10f64.powf((size * random.within(0.002, 0.01)).log10().round());
            let mut coloured = 0.0;
            for value in values.iter_mut() {
                coloured =
                    colour * coloured + (1.0 - colour * colour).sqrt() * noise * size * random.normal();
                *value = ((*value + coloured) / step).round() * step;
            }
        }
        case.simulated.push(recording(simulated, &shown));
        case.measured.push(recording(measured, &shown));
    }
    case
}

/// How many seeds to try: `usual`, or what the environment says (rates in the comments are of 200 seeds a
/// fault and 1000 clean cases).
fn seeds(usual: u64) -> u64 {
    std::env::var("LATSCH_HYGIENE_SEEDS").map_or(usual, |s| s.parse().unwrap())
}

/// Runs `count` seeds on two threads and counts the true ones.
fn rate(count: u64, try_one: impl Fn(u64) -> bool + Sync) -> u64 {
    std::thread::scope(|scope| {
        let part = |k: u64| {
            let try_one = &try_one;
            scope.spawn(move || (0..count).filter(|s| s % 2 == k && try_one(*s)).count() as u64)
        };
        let (a, b) = (part(0), part(1));
        a.join().unwrap() + b.join().unwrap()
    })
}

#[test]
fn physics_that_is_left_out_is_no_fault() {
    let tally = std::sync::Mutex::new(std::collections::BTreeMap::<FaultKind, Vec<u64>>::new());
    let count = seeds(200);
    let alarms = rate(count, |seed| {
        let mut random = Random::new(seed);
        let lacks = random.below(3);
        let found = faults(&case(&mut random, lacks));
        for fault in &found {
            let mut tally = tally.lock().unwrap();
            tally.entry(fault.kind).or_default().push(seed);
            if std::env::var_os("HYGIENE_PRINT").is_some() {
                println!("{seed} lacks {lacks}: {fault:?}");
            }
        }
        !found.is_empty()
    });
    println!("false alarms: {alarms} of {count}: {:?}", tally.lock().unwrap());
    assert!(alarms * 50 <= count, "{alarms}: {:?}", tally.lock().unwrap());
}

/// Makes `run` faulty, as `kind` says.
fn spoil(case: &mut Case, kind: &str, random: &mut Random) {
    let runs = case.measured.len();
    let name = OUTPUTS[random.below(3)].0;
    let other = OUTPUTS[(OUTPUTS.iter().position(|o| o.0 == name).unwrap() + 1) % 3].0;
    let run = random.below(runs);
    let n = case.measured[run].time.len();
    let some = 1 + random.below((runs - 1) / 2);
    let odd: Vec<usize> = (0..some).map(|i| (run + i) % runs).collect();
    let size = stats::amplitude(values(&mut case.measured[run], name));
    let sign = if random.next() < 0.5 { -1.0 } else { 1.0 };
    match kind {
        "time jumps back" => {
            let (at, by) = (50 + random.below(n - 100), random.within(0.05, 2.0));
            case.measured[run].time[at..].iter_mut().for_each(|t| *t -= by);
        }
        "duplicate stamps" => {
            for _ in 0..5 {
                let at = 1 + random.below(n - 2);
                case.measured[run].time[at] = case.measured[run].time[at - 1];
            }
        }
        "gap" => {
            let (at, length) = (50 + random.below(n - 150), 8 + random.below(60));
            let recording = &mut case.measured[run];
            recording.time.drain(at..at + length);
            recording.channels.iter_mut().for_each(|c| drop(c.values.drain(at..at + length)));
        }
        "jitter" => {
            let t: Vec<f64> = (0..n).map(|i| 0.02 * (i as f64 + random.within(-0.49, 0.49))).collect();
            case.measured[run].time = t;
        }
        "empty cells" => {
            for _ in 0..5 {
                let at = random.below(n);
                values(&mut case.measured[run], name)[at] = f64::NAN;
            }
        }
        "saturated" => {
            // a rail that cuts off the top quarter of one run, and whatever the others have beyond it
            let share = random.within(0.5, 0.8);
            let own = values(&mut case.measured[run], name);
            let (low, high) = (stats::quantile(own, 0.01), stats::quantile(own, 0.99));
            let rail = low + share * (high - low);
            for recording in &mut case.measured {
                values(recording, name).iter_mut().for_each(|v| *v = v.min(rail));
            }
        }
        "stuck" => {
            let (at, length) = (50 + random.below(n / 2), 60 + random.below(120));
            let values = values(&mut case.measured[run], name);
            let value = values[at];
            values[at..at + length].iter_mut().for_each(|v| *v = value);
        }
        "spikes" => {
            let rail = size * random.within(3.0, 6.0) * sign;
            let zero = random.next() < 0.3;
            for k in 0..6 {
                let at = 30 + k * 75 + random.below(40);
                let values = values(&mut case.measured[run], name);
                values[at] = if zero { 0.0 } else { rail };
            }
        }
        "duplicated run" => {
            let to = (run + 1) % runs;
            case.measured[to].channels = case.measured[run].channels.clone();
            case.measured[to].time = case.measured[run].time.clone();
            case.simulated[to].channels = case.simulated[run].channels.clone();
            case.simulated[to].time = case.simulated[run].time.clone();
        }
        "unit of all runs" | "unit of some runs" => {
            // lengths and forces are recorded in other units than each other
            let factors = if name == "travel" {
                [1000.0, 1e-3, 100.0, 0.01, 1.0 / 0.3048, 1.0 / 0.0254]
            } else {
                [1000.0, 1e-3, 9.80665, 1.0 / 9.80665, 4.4482, 1.0 / 4.4482]
            };
            let factor = factors[random.below(factors.len())];
            for (i, recording) in case.measured.iter_mut().enumerate() {
                if kind == "unit of all runs" || odd.contains(&i) {
                    values(recording, name).iter_mut().for_each(|v| *v *= factor);
                }
            }
        }
        "sign of all runs" | "sign of some runs" => {
            for (i, recording) in case.measured.iter_mut().enumerate() {
                if kind == "sign of all runs" || odd.contains(&i) {
                    values(recording, name).iter_mut().for_each(|v| *v = -*v);
                }
            }
        }
        "swapped" => {
            for recording in &mut case.measured {
                let taken = std::mem::take(values(recording, name));
                let given = std::mem::replace(values(recording, other), taken);
                *values(recording, name) = given;
            }
        }
        "offset" => {
            let by = size * random.within(0.2, 0.6) * sign;
            odd.iter().for_each(|i| values(&mut case.measured[*i], name).iter_mut().for_each(|v| *v += by));
        }
        "gain" => {
            let by = 1.0 + sign * random.within(0.2, 0.4);
            values(&mut case.measured[run], name).iter_mut().for_each(|v| *v *= by);
        }
        "delay" => {
            let by = random.within(0.06, 0.2);
            odd.iter().for_each(|i| shift(&mut case.measured[*i], name, |_| by));
        }
        "clock drift" => {
            let rate = sign * random.within(0.008, 0.02);
            case.measured.iter_mut().for_each(|r| shift(r, name, |t| rate * t));
        }
        _ => unreachable!("{kind}"),
    }
}

fn shift(recording: &mut Recording, name: &str, by: impl Fn(f64) -> f64) {
    let time = recording.time.clone();
    let last = time[time.len() - 1];
    let values = values(recording, name);
    *values = time
        .iter()
        .map(|t| crate::recording::interpolate(&time, values, (t - by(*t)).clamp(time[0], last)))
        .collect();
}

#[test]
fn faults_are_found() {
    use FaultKind::*;
    let count = seeds(20);
    let mut weak = Vec::new();
    for (what, kind, least) in [
        ("time jumps back", TimeJumpsBack, 0.99),
        ("duplicate stamps", DuplicateStamps, 0.99),
        ("gap", Gap, 0.99),
        ("jitter", Jitter, 0.99),
        ("empty cells", EmptyCells, 0.99),
        ("saturated", Saturated, 0.9),
        ("stuck", Stuck, 0.85),
        ("spikes", Spikes, 0.75),
        ("duplicated run", DuplicatedRun, 0.99),
        ("unit of all runs", WrongUnit, 0.85),
        ("unit of some runs", WrongUnit, 0.9),
        ("sign of all runs", WrongSign, 0.9),
        ("sign of some runs", WrongSign, 0.9),
        ("swapped", SwappedChannels, 0.9),
        ("offset", OffsetInSomeRuns, 0.6),
        ("gain", GainInSomeRuns, 0.5),
        ("delay", DelayInSomeRuns, 0.6),
        ("clock drift", ClockDrift, 0.6),
    ] {
        let others = std::sync::atomic::AtomicU64::new(0);
        let found = rate(count, |seed| {
            let mut random = Random::new(seed.wrapping_mul(1000) + 77);
            let lacks = random.below(2);
            let mut case = case(&mut random, lacks);
            spoil(&mut case, what, &mut random);
            let found = faults(&case);
            if found.iter().any(|f| f.kind != kind) {
                others.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            }
            let right = found.iter().any(|f| f.kind == kind);
            if !right && std::env::var_os("HYGIENE_PRINT").is_some() {
                println!("{what} {seed} lacks {lacks}: {found:?}");
            }
            right
        });
        println!("{what}: {found} of {count}, something else besides in {}", others.into_inner());
        if (found as f64) < least * count as f64 {
            weak.push((what, found));
        }
    }
    assert!(weak.is_empty(), "{weak:?}");
}
