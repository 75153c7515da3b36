//! Rates: how often faults are found, and how often physics that the model lacks is taken for one.
//!
//! A rig with two outputs that move (a lightly damped mass, the force in its spring and damper) and a
//! third that saturates smoothly, driven by two inputs; 5 to 8 runs of different amplitude, level and
//! kind. The measured side has wrong parameters, one or two pieces of physics that the simulated side
//! lacks, coloured noise of 0.5 to 3 %, quantisation, and stamps that scatter by 5 to 10 %.

use super::*;
use crate::recording::{Channel, Recording};
use crate::stats::{self, SplitMix64};

/// Every seed is another case.
struct Random(SplitMix64);

impl Random {
    fn new(seed: u64) -> Self {
        Self(SplitMix64::new(seed))
    }
    fn next(&mut self) -> f64 {
        self.0.uniform()
    }
    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }
    fn below(&mut self, n: usize) -> usize {
        (self.next() * n as f64) as usize
    }
    fn normal(&mut self) -> f64 {
        self.0.normal()
    }
}

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

/// Measured runs, their simulations, and the names of the outputs.
struct Case {
    measured: Vec<Recording>,
    simulated: Vec<Recording>,
    channels: Vec<String>,
}

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

fn values<'a>(recording: &'a mut Recording, name: &str) -> &'a mut Vec<f64> {
    &mut recording.channels.iter_mut().find(|c| c.name == name).unwrap().values
}

/// All faults more than notes, of both looks, as the diagnosis would ask for them.
fn faults(case: &Case) -> Vec<Fault> {
    let raw: Vec<RawRecording> =
        case.measured.iter().map(|r| RawRecording::new(r.clone()).unwrap()).collect();
    let mut faults = faults_of_runs(&raw.iter().collect::<Vec<_>>());
    let at = |simulated: &Recording, times: &[f64]| Recording {
        time: times.to_vec(),
        channels: simulated
            .channels
            .iter()
            .map(|c| Channel {
                values: times
                    .iter()
                    .map(|t| {
                        let last = simulated.time[simulated.time.len() - 1];
                        crate::recording::interpolate(
                            &simulated.time,
                            &c.values,
                            t.clamp(simulated.time[0], last),
                        )
                    })
                    .collect(),
                ..c.clone()
            })
            .collect(),
        source: simulated.source.clone(),
    };
    let measured: Vec<Recording> = raw.into_iter().map(|r| r.recording).collect();
    let simulated: Vec<Recording> =
        case.simulated.iter().zip(&measured).map(|(s, m)| at(s, &m.time)).collect();
    faults.extend(faults_against(&measured, &simulated, &case.channels));
    faults.retain(Fault::counts);
    faults
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
fn what_swings_out_and_back_is_no_spike_and_what_jumps_is() {
    let mut random = Random::new(4);
    let rest: Vec<f64> = (0..400).map(|k| (0.05 * k as f64).sin() + 0.02 * random.normal()).collect();
    // a motor that is switched on: an acceleration of seven samples that comes and goes as its voltage rises
    let pulse = [1.0, 3.5, 6.4, 7.9, 6.7, 3.5, 0.8];
    let glitch = [0.0, 0.0, 0.0, 7.9, 0.0, 0.0, 0.0];
    let spikes = |with: [f64; 7]| {
        let mut values = rest.clone();
        values[200..207].iter_mut().zip(with).for_each(|(v, more)| *v += more);
        let channel = Channel { name: "acceleration".into(), unit: "m/s2".into(), values };
        let time = (0..400).map(|k| 0.01 * k as f64).collect();
        let raw =
            RawRecording::new(Recording { source: "run".into(), time, channels: vec![channel] }).unwrap();
        raw.faults.iter().filter(|f| f.kind == FaultKind::Spikes).count()
    };
    assert_eq!((spikes(pulse), spikes(glitch)), (0, 1));
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

/// Runs of one channel: what a simulation has, and what was measured.
fn channel_of(runs: &[(Vec<f64>, Vec<f64>)]) -> [Vec<Recording>; 2] {
    let side = |which: usize| {
        let recording = |(i, run): (usize, &(Vec<f64>, Vec<f64>))| {
            let values = if which == 0 { run.0.clone() } else { run.1.clone() };
            Recording {
                time: (0..values.len()).map(|k| 0.01 * k as f64).collect(),
                channels: vec![Channel { name: "wheel_speed".into(), unit: "rad/s".into(), values }],
                source: format!("run-{i}.csv"),
            }
        };
        runs.iter().enumerate().map(recording).collect()
    };
    [side(0), side(1)]
}

/// An encoder of a joint that friction holds for a while at each turn, in counts, averaged over twenty samples. Each turn is at
/// another place, the lowest of them twice.
#[test]
fn a_joint_that_rests_where_it_turns_has_no_rail() {
    let ends = [0.394, 0.397, 0.393, 0.401, 0.393, 0.399];
    let course = |t: f64| {
        let (cycle, phase) = ((t / 3.0) as usize, 2.0 * (t / 3.0).fract());
        // down, held, up again
        let way = if phase < 0.8 {
            phase / 0.8
        } else if phase < 1.2 {
            1.0
        } else {
            (2.0 - phase) / 0.8
        };
        let smooth = way * way * (3.0 - 2.0 * way);
        1.3 - (1.3 - ends[cycle.min(5)]) * smooth
    };
    let rails = |least: f64| {
        let mut random = Random::new(8);
        let count = std::f64::consts::TAU / 4000.0;
        let values: Vec<f64> = (0..900)
            .map(|k| {
                let sample = |j: usize| {
                    let exact = course(1e-3 * (20 * k + j) as f64) + 1e-4 * random.normal();
                    (exact / count).round().max(least) * count
                };
                (0..20).map(sample).sum::<f64>() / 20.0
            })
            .collect();
        let time = (0..900).map(|k| 0.02 * k as f64).collect();
        let channel = Channel { name: "angle".into(), unit: "rad".into(), values };
        let raw =
            RawRecording::new(Recording { source: "run".into(), time, channels: vec![channel] }).unwrap();
        raw.faults.iter().filter(|f| f.kind == FaultKind::Saturated).count()
    };
    // one whose sensor ends before it turns has one
    assert_eq!((rails(0.0), rails(290.0)), (0, 1));
}

/// What is measured of a machine whose model drifts away: any gain, and a part that no gain explains. Among eight of them are factors of
/// ten and eighteen, which would be units if all else were right.
#[test]
fn of_a_model_that_drifts_away_no_gain_is_a_unit() {
    let with = |gains: [f64; 8], unlike: f64| {
        let runs: Vec<(Vec<f64>, Vec<f64>)> = (0..8)
            .map(|i| {
                let rate = 0.008 + 0.001 * i as f64;
                let simulated: Vec<f64> = (0..800).map(|k| (rate * f64::from(k)).sin()).collect();
                let other = |k: usize| unlike * (2.7 * rate * k as f64).sin();
                let measured = simulated.iter().enumerate().map(|(k, v)| gains[i] * (v + other(k))).collect();
                (simulated, measured)
            })
            .collect();
        let [simulated, measured] = channel_of(&runs);
        faults_against(&measured, &simulated, &["wheel_speed".into()])
            .into_iter()
            .filter(|f| f.kind == FaultKind::WrongUnit)
            .map(|f| f.runs)
            .collect::<Vec<_>>()
    };
    assert_eq!(with([1.1, 0.45, 0.7, 2.2, 0.3, 1.5, 0.1, 0.055], 0.6), Vec::<Vec<String>>::new());
    // the same factor of ten in one run of a model that is right
    assert_eq!(with([1.02, 0.99, 1.0, 1.01, 0.98, 1.0, 0.1, 1.03], 0.1), [["run-6.csv"]]);
}

/// A force in mN under N, in the runs in which there is one and in all of them; in one that does not move it is noise.
#[test]
fn a_unit_may_be_that_of_all_runs() {
    let mut random = Random::new(3);
    let run = |moves: f64, factor: f64, random: &mut Random| {
        let simulated: Vec<f64> = (0..800).map(|k| moves * (0.02 * f64::from(k)).sin()).collect();
        let measured = simulated.iter().map(|v| factor * (1.1 * v + 0.01 * random.normal())).collect();
        (simulated, measured)
    };
    for factor in [1e3, 1e-3, 3.6] {
        let mut runs: Vec<_> = (0..6).map(|_| run(1.0, factor, &mut random)).collect();
        runs.push(run(0.0, factor, &mut random));
        let [simulated, measured] = channel_of(&runs);
        let found = faults_against(&measured, &simulated, &["wheel_speed".into()]);
        assert_eq!(found.iter().map(|f| f.kind).collect::<Vec<_>>(), [FaultKind::WrongUnit], "{found:?}");
        // of a speed of rotation 3.6 is no ratio of units, but no parameter makes it
        let said = if factor == 3.6 { 3.6 * 1.1 } else { factor };
        assert!((found[0].value / said - 1.0).abs() < 0.01 && found[0].runs.len() == 6, "{found:?}");
    }
}

/// A speed with noise of its last digit that is frozen until the end, and a joint that friction brings to rest until then.
#[test]
fn what_stays_until_the_end_is_stuck_if_it_did_not_slow_down() {
    let stuck = |course: &dyn Fn(f64) -> f64| {
        let mut random = Random::new(4);
        let mut frozen = None;
        let mut values = Vec::new();
        let time: Vec<f64> = (0..1000).map(|k| 0.005 * f64::from(k)).collect();
        for t in &time {
            let value = (1e3 * (course(*t) + 1e-3 * random.normal())).round() / 1e3;
            // friction holds what is at rest
            values.push(if *t > 3.5 { *frozen.get_or_insert(value) } else { value });
        }
        let other = time.iter().map(|t| (5.0 * t).sin() + 1e-4 * random.normal()).collect();
        let channels = vec![
            Channel { name: "speed".into(), unit: "m/s".into(), values },
            Channel { name: "force".into(), unit: "N".into(), values: other },
        ];
        let raw = RawRecording::new(Recording { source: "run".into(), time, channels }).unwrap();
        raw.faults.iter().filter(|f| f.kind == FaultKind::Stuck).count()
    };
    assert_eq!(stuck(&|t| 0.3 * (7.0 * t).sin()), 1);
    // the same until it slows down evenly, 40 ms before it stays
    let slow = |t: f64| {
        let (last, speed) = (0.3 * (7.0 * 3.46_f64).sin(), 2.1 * (7.0 * 3.46_f64).cos());
        let left = (3.5 - t).clamp(0.0, 0.04);
        if t < 3.46 { 0.3 * (7.0 * t).sin() } else { last + speed * (0.02 - left * left / 0.08) }
    };
    assert_eq!(stuck(&slow), 0);
}

#[test]
fn noise_about_a_level_has_no_gain() {
    for seed in 0..40 {
        let mut random = Random::new(seed);
        let mut runs = Vec::new();
        for _ in 0..8 {
            // the wheel hardly changes its speed; what is measured is noise
            let level = random.within(20.0, 100.0);
            let simulated = (0..800).map(|k| level + 0.05 * (0.02 * f64::from(k)).sin()).collect();
            let measured = (0..800).map(|_| level + 0.5 * random.normal()).collect();
            runs.push((simulated, measured));
        }
        let [simulated, measured] = channel_of(&runs);
        assert_eq!(faults_against(&measured, &simulated, &["wheel_speed".into()]), [], "{seed}");
    }
}

#[test]
fn a_gain_that_no_parameter_makes_is_a_calibration() {
    let with = |gain: f64| {
        let mut random = Random::new(5);
        let mut runs = Vec::new();
        for i in 0..5 {
            let rate = 0.03 + 0.01 * f64::from(i);
            let simulated: Vec<f64> = (0..800)
                .map(|k| 10.0 + 3.0 * (rate * f64::from(k)).sin() + (0.27 * rate * f64::from(k)).sin())
                .collect();
            let measured = simulated.iter().map(|v| gain * v + 0.1 * random.normal()).collect();
            runs.push((simulated, measured));
        }
        let [simulated, measured] = channel_of(&runs);
        faults_against(&measured, &simulated, &["wheel_speed".into()])
    };
    // no ratio of units is near
    let found = with(2.7);
    assert_eq!(found.iter().map(|f| f.kind).collect::<Vec<_>>(), [FaultKind::WrongUnit], "{found:?}");
    assert!((found[0].value - 2.7).abs() < 0.01 && found[0].runs.len() == 5, "{found:?}");
    // what a sensor or parameters make is left to effects
    assert_eq!(with(1.4), []);
}

/// Runs with an input, and two outputs of it with noise: one moves by a hundred times its noise, the other by one and a half.
fn strong_and_weak() -> Case {
    let mut random = Random::new(9);
    let mut case =
        Case { measured: Vec::new(), simulated: Vec::new(), channels: vec!["strong".into(), "weak".into()] };
    for run in 0..6 {
        let time: Vec<f64> = (0..600).map(|k| 0.02 * f64::from(k)).collect();
        let drive: Vec<f64> =
            time.iter().map(|t| (t * (1.0 + 0.3 * f64::from(run))).sin() + (2.7 * t).sin()).collect();
        let slow: Vec<f64> = time.iter().map(|t| 1.5 * (0.8 * t + f64::from(run)).cos()).collect();
        let recording = |outputs: [Vec<f64>; 2]| Recording {
            time: time.clone(),
            channels: [("drive", drive.clone())]
                .into_iter()
                .chain(["strong", "weak"].into_iter().zip(outputs))
                .map(|(name, values)| Channel { name: name.into(), unit: "N.m".into(), values })
                .collect(),
            source: format!("rig/run{run}.csv"),
        };
        let strong: Vec<f64> = drive.iter().map(|d| 100.0 * d).collect();
        case.simulated.push(recording([strong.clone(), slow.clone()]));
        let mut noisy = |values: &[f64]| values.iter().map(|v| v + random.normal()).collect::<Vec<f64>>();
        case.measured.push(recording([noisy(&strong), noisy(&slow)]));
    }
    case
}

#[test]
fn channels_are_exchanged_in_one_run_though_one_of_them_hardly_moves() {
    let mut case = strong_and_weak();
    assert!(faults(&case).is_empty());
    let taken = std::mem::take(values(&mut case.measured[4], "strong"));
    let given = std::mem::replace(values(&mut case.measured[4], "weak"), taken);
    *values(&mut case.measured[4], "strong") = given;
    let [fault] = &faults(&case)[..] else { panic!("{:?}", faults(&case)) };
    assert_eq!((fault.kind, &fault.runs[..]), (FaultKind::SwappedChannels, &["run4.csv".to_owned()][..]));
}

#[test]
fn a_reversed_input_is_not_as_many_reversed_sensors() {
    for runs in [0..6, 2..3] {
        let mut case = strong_and_weak();
        // two outputs that tell signs
        for recording in &mut case.measured {
            let mut random = Random::new(4);
            let strong = values(recording, "strong").clone();
            *values(recording, "weak") = strong.iter().map(|v| 0.1 * v + random.normal()).collect();
        }
        for recording in &mut case.simulated {
            let strong = values(recording, "strong").clone();
            *values(recording, "weak") = strong.iter().map(|v| 0.1 * v).collect();
        }
        for recording in &mut case.measured[runs.clone()] {
            for name in ["strong", "weak"] {
                values(recording, name).iter_mut().for_each(|v| *v = -*v);
            }
        }
        let [fault] = &faults(&case)[..] else { panic!("{:?}", faults(&case)) };
        assert_eq!((fault.kind, fault.channel.as_deref()), (FaultKind::WrongSign, Some("drive")));
        assert_eq!(fault.runs.len(), runs.len());
    }
}

#[test]
fn an_exchanged_channel_may_rest_altogether() {
    let mut case = strong_and_weak();
    let mut random = Random::new(11);
    values(&mut case.simulated[4], "weak").fill(0.0);
    values(&mut case.measured[4], "weak").iter_mut().for_each(|v| *v = random.normal());
    assert!(faults(&case).is_empty());
    let taken = std::mem::take(values(&mut case.measured[4], "strong"));
    let given = std::mem::replace(values(&mut case.measured[4], "weak"), taken);
    *values(&mut case.measured[4], "strong") = given;
    let [fault] = &faults(&case)[..] else { panic!("{:?}", faults(&case)) };
    assert_eq!((fault.kind, &fault.runs[..]), (FaultKind::SwappedChannels, &["run4.csv".to_owned()][..]));
}

/// Six runs of three sines, one of a single sine, and six of a wheel at rest, `still` its simulated motion, with noise; some come late
/// by samples, some are off.
fn moving_and_at_rest(still: f64, late: &[(usize, i32)], off: &[(usize, f64)]) -> Vec<Fault> {
    let mut random = Random::new(21);
    let runs: Vec<(Vec<f64>, Vec<f64>)> = (0..13)
        .map(|i| {
            let rate = 0.02 + 0.003 * f64::from(i);
            let course = |k: i32| {
                let phase = rate * f64::from(k);
                match i {
                    0..6 => 3.0 * phase.sin() + 2.0 * (2.7 * phase).sin() + (6.1 * phase).sin(),
                    6 => 3.0 * phase.sin(),
                    _ => still * (0.7 * phase).sin(),
                }
            };
            let number = |list: &[(usize, i32)]| list.iter().find(|l| l.0 == i as usize).map_or(0, |l| l.1);
            let by = off.iter().find(|o| o.0 == i as usize).map_or(0.0, |o| o.1);
            let measured = (0..900).map(|k| course(k - number(late)) + by + 0.1 * random.normal()).collect();
            ((0..900).map(course).collect(), measured)
        })
        .collect();
    let [simulated, measured] = channel_of(&runs);
    faults_against(&measured, &simulated, &["wheel_speed".into()])
}

#[test]
fn runs_at_rest_tell_an_offset_and_no_delay() {
    for still in [0.0, 1e-9] {
        assert_eq!(moving_and_at_rest(still, &[], &[]), []);
        let [offset] = &moving_and_at_rest(still, &[], &[(2, -1.5), (8, -1.5), (11, -1.5)])[..] else {
            panic!("{still}")
        };
        assert_eq!(offset.kind, FaultKind::OffsetInSomeRuns);
        assert_eq!(offset.runs, ["run-2.csv", "run-8.csv", "run-11.csv"]);
        assert!((offset.value + 1.5).abs() < 0.02, "{}", offset.value);
        let [delay] = &moving_and_at_rest(still, &[(1, 6), (4, 6)], &[])[..] else { panic!("{still}") };
        assert_eq!(delay.kind, FaultKind::DelayInSomeRuns);
        assert_eq!(delay.runs, ["run-1.csv", "run-4.csv"]);
        assert!((delay.value - 0.06).abs() < 0.003, "{}", delay.value);
    }
}

#[test]
fn a_single_sine_has_a_delay_only_with_others() {
    // by itself it is a phase, which a wrong parameter makes as well
    assert_eq!(moving_and_at_rest(0.0, &[(6, 6)], &[]), []);
    for other in [1, 5] {
        let [delay] = &moving_and_at_rest(0.0, &[(other, 6), (6, 6)], &[])[..] else { panic!("{other}") };
        assert_eq!(delay.runs, [format!("run-{other}.csv"), "run-6.csv".into()]);
    }
}
