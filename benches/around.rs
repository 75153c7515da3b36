//! How much is added around the models: `cargo bench --bench around`. The FMI interface, loading, recording, results
//! as CSV and co-simulation, and the small models beside the tires. Every figure is the least of several runs in one
//! process: what else the machine does only adds.
#![allow(clippy::unwrap_used)]

use latsch::control::{AbsController, BrakeHydraulics};
use latsch::cosimulate::{Coupling, Experiment as Joint, System, Transfer, cosimulate};
use latsch::fmi::archive::ModelLibrary;
use latsch::fmi::import::{Archive, Description, ImportedFmu, MAX_LENGTH};
use latsch::model::{Model, Native, Settings, Slave, Table, input, output};
use latsch::real;
use latsch::recording::{Channel, Recording, read_csv, write_csv};
use latsch::rig::RingBrushFlatTrack;
use latsch::shipped::MODELS;
use latsch::simulate::{Experiment, simulate};
use serde::{Deserialize, Serialize};
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Many short runs: one of them is not interrupted.
const ROUNDS: usize = 100;
const COMMUNICATION_STEP: f64 = 1e-3;

/// Seconds that `work` takes.
fn time(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

fn least(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::INFINITY, f64::min)
}

/// The least of several measurements.
fn often(rounds: usize, mut measure: impl FnMut() -> f64) -> f64 {
    (0..rounds).map(|_| measure()).fold(f64::INFINITY, f64::min)
}

/// A model that does next to nothing: what remains is what is around it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
struct Nothing {
    input: f64,
    output: f64,
}

impl Model for Nothing {
    const NAME: &'static str = "nothing";
    const DESCRIPTION: &'static str = "Passes its input on";
    fn variables() -> Table<Self> {
        Table::new([
            input("input", "1", real!(input), 0.0, "What comes in"),
            output("output", "1", real!(output), "What goes out"),
        ])
    }

    fn step_size(&self) -> f64 {
        COMMUNICATION_STEP
    }

    fn step(&mut self, _length: f64) -> latsch::Result<()> {
        self.output = self.input;
        Ok(())
    }
}

/// A model's FMU in a folder.
struct Files {
    library: ModelLibrary,
    folder: tempfile::TempDir,
}

impl Files {
    fn fmu(&self, model: &str) -> PathBuf {
        let path = self.folder.path().join(format!("{model}.fmu"));
        if !path.exists() {
            std::fs::write(&path, self.library.fmu(model, &Settings::default(), &[]).unwrap()).unwrap();
        }
        path
    }
}

fn start(slave: &mut (impl Slave + ?Sized), values: &[(&str, f64)]) {
    for (name, value) in values {
        let index = slave.find(name).unwrap();
        slave.set(index, *value).unwrap();
    }
    slave.start(0.0, None).unwrap();
    slave.finish_start().unwrap();
}

/// Steps from 0 s on.
fn run(slave: &mut (impl Slave + ?Sized), steps: usize) {
    for k in 0..steps {
        slave.step(k as f64 * COMMUNICATION_STEP, COMMUNICATION_STEP).unwrap();
    }
}

/// Steps with an input that changes each time and an output that is read.
fn drive(
    slave: &mut (impl Slave + ?Sized),
    input: &str,
    output: &str,
    value: impl Fn(usize) -> f64,
    steps: usize,
) {
    let (input, output) = (slave.find(input).unwrap(), slave.find(output).unwrap());
    for k in 0..steps {
        slave.set(input, value(k)).unwrap();
        slave.step(k as f64 * COMMUNICATION_STEP, COMMUNICATION_STEP).unwrap();
        black_box(slave.get(output).unwrap());
    }
}

/// What FMI adds to a step.
fn fmi(files: &Files, rounds: usize) {
    println!("\na step through FMI, at 1 kHz");
    let track = [("path_speed", 10.0), ("slip", 0.03), ("slip_angle", 0.03)];
    let mut native = Native::<RingBrushFlatTrack>::new(&Settings::default()).unwrap();
    let mut fmu = ImportedFmu::load(&files.fmu(RingBrushFlatTrack::NAME)).unwrap();
    let steps = 20;
    let (mut alone, mut through) = (Vec::new(), Vec::new());
    for _ in 0..rounds {
        native.reset().unwrap();
        start(&mut native, &track);
        fmu.reset().unwrap();
        start(&mut fmu, &track);
        alone.push(time(|| run(&mut native, steps)) / steps as f64);
        through.push(time(|| run(&mut fmu, steps)) / steps as f64);
    }
    let (alone, through) = (least(&alone), least(&through));
    println!("  ring-brush-flat-track, native               {:8.1} us", alone * 1e6);
    println!("  the same through FMI, over native           {:8.3}", through / alone);

    // a controller that decides every 0.1 s does next to nothing in the steps between
    let idle = [("sample_time", 0.1)];
    let mut native = Native::<AbsController>::new(&Settings::default()).unwrap();
    let mut fmu = ImportedFmu::load(&files.fmu(AbsController::NAME)).unwrap();
    let steps = 2000;
    let mut seconds = [const { Vec::new() }; 3];
    for _ in 0..rounds {
        native.reset().unwrap();
        start(&mut native, &idle);
        seconds[0].push(time(|| run(&mut native, steps)));
        fmu.reset().unwrap();
        start(&mut fmu, &idle);
        seconds[1].push(time(|| fmu.bare_steps(0.0, COMMUNICATION_STEP, steps).unwrap()));
        fmu.reset().unwrap();
        start(&mut fmu, &idle);
        seconds[2].push(time(|| run(&mut fmu, steps)));
    }
    let [native, bare, imported] = seconds.map(|s| least(&s) / steps as f64 * 1e9);
    println!("  idle controller, native                     {native:8.1} ns");
    println!("  its fmi2DoStep                              {bare:8.1} ns, {:+.1} ns", bare - native);
    println!("  the same through the importer               {imported:8.1} ns, {:+.1} ns", imported - native);
}

/// Models beside the tires: one input set, a step of 1 ms, one output read.
fn small(files: &Files, rounds: usize) {
    println!("\nsmall models, 1 ms with an input and an output        native      FMI");
    let steps = 1000;
    let brake = |k: usize| 5e6 + 4e6 * ((k % 400) as f64 / 200.0 - 1.0);
    let wheel = |k: usize| 60.0 - (k % 400) as f64 / 100.0;
    let braking = [("driver_pressure", 9e6)];
    type Case<'a> = (&'a str, &'a str, &'a str, &'a str, &'a dyn Fn(usize) -> f64, &'a [(&'a str, f64)]);
    let cases: [Case<'_>; 5] = [
        (BrakeHydraulics::NAME, "at rest", "driver_pressure", "brake_torque", &|_| 5e6, &[]),
        (BrakeHydraulics::NAME, "pressure moves", "driver_pressure", "brake_torque", &brake, &[]),
        (
            BrakeHydraulics::NAME,
            "step of 1 ms",
            "driver_pressure",
            "brake_torque",
            &brake,
            &[("step_size", 1e-3)],
        ),
        (AbsController::NAME, "every 5 ms", "wheel_speed_1", "inlet_valve_1", &wheel, &braking),
        (
            AbsController::NAME,
            "every 1 ms",
            "wheel_speed_1",
            "inlet_valve_1",
            &wheel,
            &[("driver_pressure", 9e6), ("sample_time", 1e-3)],
        ),
    ];
    for (model, what, input, output, value, values) in cases {
        let mut native =
            MODELS.iter().find(|m| m.name == model).unwrap().slave(&Settings::default()).unwrap();
        let mut fmu = ImportedFmu::load(&files.fmu(model)).unwrap();
        let mut seconds = [const { Vec::new() }; 2];
        for _ in 0..rounds {
            native.reset().unwrap();
            start(&mut *native, values);
            seconds[0].push(time(|| drive(&mut *native, input, output, value, steps)));
            fmu.reset().unwrap();
            start(&mut fmu, values);
            seconds[1].push(time(|| drive(&mut fmu, input, output, value, steps)));
        }
        let [native, fmu] = seconds.map(|s| least(&s) / steps as f64 * 1e9);
        println!("  {model:<18} {what:<24} {native:10.0} ns {fmu:5.0} ns");
    }
}

/// What loading takes.
fn loading(files: &Files, rounds: usize) {
    println!(
        "\nload an exported FMU                           whole    archive   description   unpack   instantiate"
    );
    for model in [RingBrushFlatTrack::NAME, BrakeHydraulics::NAME] {
        let path = files.fmu(model);
        let loaded = ImportedFmu::load(&path).unwrap();
        let whole = often(rounds, || time(|| drop(ImportedFmu::load(&path).unwrap())));
        let archive = often(rounds, || time(|| drop(Archive::open(&path).unwrap())));
        let mut archive_file = Archive::open(&path).unwrap();
        let xml = archive_file.read("modelDescription.xml", MAX_LENGTH).unwrap().unwrap();
        let description = often(rounds, || time(|| drop(Description::parse(&xml).unwrap())));
        let unpack = often(rounds, || {
            let mut archive = Archive::open(&path).unwrap();
            let mut folder = None;
            let taken = time(|| folder = Some(archive.unpack().unwrap()));
            drop(folder);
            taken
        });
        let instantiate = often(rounds, || time(|| loaded.instantiate_again().unwrap()));
        println!(
            "  {model:<40} {:7.2} ms {:7.2} ms {:10.2} ms {:5.2} ms {:10.3} ms",
            whole * 1e3,
            archive * 1e3,
            description * 1e3,
            unpack * 1e3,
            instantiate * 1e3
        );
    }
}

/// Results as CSV.
fn csv(folder: &Path, rounds: usize) {
    println!("\nresults");
    // full double precision, as results have it
    let rows = 1000;
    let channels: Vec<Channel> = (0..20)
        .map(|c| {
            let scale = 10_f64.powi(c % 9 - 4);
            let values = (0..rows).map(|k| scale * libm::sin(1e-3 * f64::from(k * (c + 1)))).collect();
            Channel { name: format!("channel {c}"), unit: "1".into(), values }
        })
        .collect();
    let time_of = |k: i32| f64::from(k) * COMMUNICATION_STEP;
    let recording = Recording { time: (0..rows).map(time_of).collect(), channels, source: "bench".into() };
    let path = folder.join("results.csv");
    let written = often(rounds, || time(|| write_csv(&path, &recording).unwrap()));
    let megabytes = std::fs::metadata(&path).unwrap().len() as f64 / 1e6;
    println!("  CSV written                                 {:8.0} MB/s", megabytes / written);
    let read = often(rounds, || time(|| drop(black_box(read_csv(&path).unwrap()))));
    println!("  CSV read                                    {:8.0} MB/s", megabytes / read);

    let experiment = Experiment { stop: Some(0.5), ..Experiment::default() };
    let mut slave = Native::<BrakeHydraulics>::new(&Settings::default()).unwrap();
    let mut outcome = None;
    let simulated = often(rounds, || {
        slave.reset().unwrap();
        time(|| outcome = Some(simulate(&mut slave, &experiment, |_, _| {}).unwrap()))
    });
    let recording = outcome.unwrap().recording;
    let written = often(rounds, || time(|| write_csv(&path, &recording).unwrap()));
    let rows = recording.time.len() as f64;
    println!(
        "  brake-hydraulics at rest, simulated         {:8.0} ns a row of {} channels",
        simulated / rows * 1e9,
        recording.channels.len()
    );
    println!("  its results written                         {:8.0} ns a row", written / rows * 1e9);
}

/// Seconds for each step of the master at 1 kHz: what a longer run takes more than a shorter one, so that the start is
/// left out. `recorded`: every step or only the last.
fn exchange(rounds: usize, make: &dyn Fn() -> System, recorded: bool) -> f64 {
    const LENGTHS: [usize; 2] = [200, 1200];
    let [short, long] = LENGTHS.map(|steps| {
        let every = if recorded { 1 } else { steps };
        often(rounds, || joint(&mut make(), steps, every))
    });
    (long - short) / (LENGTHS[1] - LENGTHS[0]) as f64
}

/// Seconds that a run of a system takes. `every`: how often it is recorded.
fn joint(system: &mut System, steps: usize, every: usize) -> f64 {
    let experiment = Joint {
        start: 0.0,
        stop: steps as f64 * COMMUNICATION_STEP,
        step: COMMUNICATION_STEP,
        record_every: every,
        all: false,
        log: false,
    };
    time(|| {
        let outcome = cosimulate(system, &experiment, |_| {}).unwrap();
        assert!(outcome.stopped.is_none());
    })
}

/// A ring of parts, each of which is told what the one before gives.
fn ring(parts: Vec<Box<dyn Slave>>, input: &str, output: &str) -> System {
    let mut system = System::new(Coupling::default());
    let count = parts.len();
    for (i, part) in parts.into_iter().enumerate() {
        system.add(&format!("part{i}"), part).unwrap();
    }
    for i in 0..count {
        let from = system.port(&format!("part{i}"), output).unwrap();
        let to = system.port(&format!("part{}", (i + 1) % count), input).unwrap();
        system.connect(from, to, Transfer { keep_units: true, ..Transfer::default() }).unwrap();
    }
    system
}

/// What the master of a system takes.
fn systems(files: &Files, rounds: usize) {
    println!("\nco-simulation: a step of the master and part, less the step of the part");
    println!("  parts                                           recorded   not recorded   step alone");
    let steps = 1000;
    let report = |name: &str, count: usize, alone: f64, make: &dyn Fn() -> System| {
        let figure = |recorded: bool| exchange(rounds, make, recorded) / count as f64 - alone;
        let (recorded, not) = (figure(true), figure(false));
        println!("  {name:<44} {:8.0} ns {:11.0} ns {:9.0} ns", recorded * 1e9, not * 1e9, alone * 1e9);
    };
    let nothing = || -> Box<dyn Slave> { Box::new(Native::<Nothing>::new(&Settings::default()).unwrap()) };
    let alone = often(rounds, || {
        let mut slave = nothing();
        start(&mut *slave, &[]);
        time(|| run(&mut *slave, steps)) / steps as f64
    });
    for count in [2, 20] {
        let name = format!("{count} native ones that pass on a number");
        report(&name, count, alone, &|| ring((0..count).map(|_| nothing()).collect(), "input", "output"));
    }
    // idle as above: the FMU's own step is nearly nothing, but it has 22 outputs
    let idle = |mut slave: Box<dyn Slave>| {
        let index = slave.find("sample_time").unwrap();
        slave.set(index, 0.1).unwrap();
        slave
    };
    let controller = || idle(Box::new(Native::<AbsController>::new(&Settings::default()).unwrap()));
    let path = files.fmu(AbsController::NAME);
    let fmu = || idle(Box::new(ImportedFmu::load(&path).unwrap()));
    let alone_in = |make: &dyn Fn() -> Box<dyn Slave>| {
        often(rounds, || {
            let mut slave = make();
            start(&mut *slave, &[]);
            time(|| run(&mut *slave, steps)) / steps as f64
        })
    };
    let (input, output) = ("wheel_speed_1", "outlet_valve_1");
    let outputs = controller().interface().with(latsch::model::Causality::Output).count();
    let name = format!("2 native controllers, {outputs} outputs");
    report(&name, 2, alone_in(&controller), &|| ring((0..2).map(|_| controller()).collect(), input, output));
    let name = format!("2 FMUs of it, {outputs} outputs");
    report(&name, 2, alone_in(&fmu), &|| ring((0..2).map(|_| fmu()).collect(), input, output));

    let abs = files.fmu(AbsController::NAME);
    let brake = files.fmu(BrakeHydraulics::NAME);
    let pair = || {
        let mut system = System::new(Coupling::default());
        system.add("abs", Box::new(ImportedFmu::load(&abs).unwrap())).unwrap();
        system.add("brake", Box::new(ImportedFmu::load(&brake).unwrap())).unwrap();
        for (from, to) in [("inlet_valve_1", "inlet_valve"), ("outlet_valve_1", "outlet_valve")] {
            let (from, to) = (system.port("abs", from).unwrap(), system.port("brake", to).unwrap());
            system.connect(from, to, Transfer::default()).unwrap();
        }
        system
    };
    let whole = exchange(rounds, &pair, true);
    println!(
        "  FMUs of controller and brake, wired and recorded: {:.2} us for a step of the master",
        whole * 1e6
    );
}

fn main() {
    // cargo test runs benchmarks with --test to see that they work
    let rounds = if std::env::args().any(|a| a == "--test") { 1 } else { ROUNDS };
    let folder = tempfile::tempdir().unwrap();
    csv(folder.path(), rounds);
    let library = match ModelLibrary::shipped(MODELS) {
        Ok(library) => library,
        Err(error) => {
            println!("\nFMUs are not measured: {error}");
            return;
        }
    };
    let files = Files { library, folder };
    fmi(&files, rounds);
    small(&files, rounds);
    loading(&files, rounds);
    systems(&files, rounds);
}
