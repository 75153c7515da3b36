//! What is done with the wired system of the example: the loop opened, the level of the friction found, the system looked at before it is
//! believed.

use crate::{WHEELS, amplitude};
use latsch::cosimulate::{
    Experiment, FrictionLevel, Plan, Source, System, Tried, cosimulate, friction_inputs, friction_level,
    read_system,
};
use latsch::lint::{Judgement, Measured, Remark, lint};
use latsch::model::Value;
use latsch::recording::Recording;
use std::path::Path;

/// The example's stop on Magic Formula tires, with values that differ from the example's.
pub struct Wired {
    pub plan: Plan,
    values: Vec<(String, f64)>,
}

impl Wired {
    pub fn new(values: &[(&str, f64)]) -> Self {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/car-abs-stop/system.toml");
        let mut plan = read_system(&file).unwrap().plan;
        let car = plan.components.iter_mut().find(|c| c.name == "car").unwrap();
        car.source = Source::Model("magic-formula-vehicle".into(), None);
        Self { plan, values: values.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect() }
    }

    /// All wheels with this factor on the friction.
    fn on(level: f64) -> Self {
        let mut wired = Self::new(&[]);
        wired.values.extend(WHEELS.map(|wheel| (format!("car.{wheel}.friction_factor"), level)));
        wired
    }

    fn system(&self) -> System {
        let mut system = self.plan.load().unwrap();
        for (name, value) in &self.values {
            let (component, variable) = name.split_once('.').unwrap();
            let port = system.port(component, variable).unwrap();
            let value = match system.info(port).is_real() {
                true => Value::Real(*value),
                false => Value::Integer(*value as i32),
            };
            system.set(port, &value).unwrap();
        }
        system
    }

    /// The car alone, braked with the torques of a recording.
    fn opened(&self, recording: &Recording) -> System {
        let mut system = self.system();
        let car = system.component("car").unwrap();
        system.open(car, recording).unwrap();
        system
    }

    fn experiment(&self) -> Experiment {
        self.plan.experiment(&self.system(), None, None, None).unwrap()
    }

    /// With another end \[s\].
    pub fn until(mut self, stop: f64) -> Self {
        self.plan.stop = Some(stop);
        self
    }

    pub fn run(&self) -> Recording {
        cosimulate(&mut self.system(), &self.experiment(), |_| {}).unwrap().recording
    }

    fn level(&self, recording: &Recording) -> FrictionLevel {
        let system = self.opened(recording);
        let car = [system.component("car").unwrap()];
        let inputs = friction_inputs(&system, &car);
        assert_eq!(inputs.len(), 4);
        let fresh = || Ok(self.opened(recording));
        friction_level(fresh, &self.experiment(), recording, &car, &inputs).unwrap()
    }

    fn remarks(&self, measured: &[Measured]) -> Vec<Remark> {
        let experiment = Experiment { stop: 2.5, ..self.experiment() };
        lint(|| Ok(self.system()), &experiment, measured).unwrap()
    }
}

/// Where nothing else differs, the level is that of the recording to the search's 0.1 %, whatever the road was.
#[test]
fn the_level_of_the_friction_is_found_from_torques_and_wheel_speeds() {
    for level in [0.83, 1.12] {
        let recording = Wired::on(level).run();
        let found = Wired::new(&[]).level(&recording);
        assert!((found.level / level - 1.0).abs() < 1e-3, "{level}: {}", found.level);
        let rms: Vec<f64> = found.wheels.iter().map(|wheel| wheel.error).collect();
        assert!(rms.iter().all(|error| *error < 1.0), "{rms:?}");
    }
}

/// Torques that a recorded stop had lock wheels the longer the more slippery the road is (open loop, section 6.3), and not at all on a better one.
#[test]
fn the_lower_the_level_the_longer_wheels_are_locked() {
    let recording = Wired::new(&[]).run();
    let found = Wired::new(&[]).level(&recording);
    let recorded: f64 = found.wheels.iter().map(|wheel| wheel.locked[1]).sum();
    let (low, high): (Vec<Tried>, Vec<Tried>) = found.tried.iter().partition(|tried| tried.level < 0.99);
    assert!(low.len() > 10 && low.windows(2).all(|pair| pair[0].locked > pair[1].locked), "{low:?}");
    assert!(low.iter().all(|tried| tried.locked > recorded + 1.0), "{recorded} s recorded: {low:?}");
    assert!(high.iter().all(|tried| tried.locked <= recorded + 1e-9), "{recorded} s recorded: {high:?}");
    assert_eq!(high[high.len() - 1].locked, 0.0);
}

/// Friction that scatters on each track by itself excites the wheels' steering against a soft column, and not against a stiff one; on a road that is the same
/// on both sides the column does not matter (section 6.4).
#[test]
fn a_soft_column_shows_only_where_the_sides_differ() {
    let lateral = |stiffness: f64, seeds: [f64; 2]| {
        let deviation = if seeds[0] == 0.0 { 0.0 } else { 0.05 };
        let run = Wired::new(&[
            ("car.column_stiffness", stiffness),
            ("car.road_friction_deviation", deviation),
            ("car.road_friction_seed", seeds[0]),
            ("car.road_friction_seed_right", seeds[1]),
        ])
        .run();
        let force = &run.channel("car.front_left.tie_rod_force").unwrap().values;
        (amplitude(&force[300..2000], 1e-3, [8.0, 13.0]), force.clone())
    };
    for seed in 1..=5 {
        let seeds = [f64::from(seed), f64::from(seed) + 100.0];
        let [soft, stiff] = [0.6e6, 12e6].map(|stiffness| lateral(stiffness, seeds).0);
        assert!(soft > 2.0 * stiff, "seed {seed}: {soft} N soft, {stiff} N stiff");
    }
    let [(_, soft), (_, stiff)] = [0.6e6, 12e6].map(|stiffness| lateral(stiffness, [0.0, 0.0]));
    let most = soft.iter().zip(&stiff).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(most < 1e-3, "{most} N of {} N", soft.iter().fold(0.0, |m: f64, v| m.max(v.abs())));
}

fn doubts(remarks: &[Remark], topic: &str) -> Vec<String> {
    let of = |remark: &&Remark| remark.judgement == Judgement::Doubtful && remark.topic == topic;
    remarks.iter().filter(of).map(|remark| remark.text.clone()).collect()
}

#[test]
fn what_is_odd_about_a_system_is_said() {
    let topics = ["inputs", "radius in the controller", "pads", "measured values", "communication step"];
    let load = |value: &str, within: Option<&str>| Measured {
        variable: "car.front_left.normal_force".parse().unwrap(),
        value: value.into(),
        within: within.map(str::to_owned),
        place: "scales.toml".into(),
    };
    // the front axle carries 0.91 / 2.35 of 1650 kg
    let standing = 0.5 * 1650.0 * 9.81 * 0.91 / 2.35;
    let right = Wired::new(&[]);
    let remarks = right.remarks(&[load(&format!("{} kN", standing / 1e3), None)]);
    for topic in topics {
        assert_eq!(doubts(&remarks, topic), Vec::<String>::new());
    }

    let wrong = Wired::new(&[("abs.rolling_radius_3", 0.345), ("brake_fr.onset_time", 0.0)]);
    let remarks = wrong.remarks(&[load("3.4 kN", None), load("3.1 kN", Some("5 %"))]);
    let [inputs, radius, pads, measured, _] = topics.map(|topic| doubts(&remarks, topic));
    assert_eq!(inputs, Vec::<String>::new());
    assert!(matches!(&radius[..], [one] if one.contains("abs.rolling_radius_3")), "{radius:?}");
    assert!(matches!(&pads[..], [one] if one.contains("brake_fr")), "{pads:?}");
    assert!(matches!(&measured[..], [one] if one.contains("measured 3400")), "{measured:?}");

    let mut forgotten = Wired::new(&[]);
    forgotten.plan.connections.retain(|c| c.to.variable != "rear_right.brake_torque");
    let inputs = doubts(&forgotten.remarks(&[]), "inputs");
    assert!(matches!(&inputs[..], [one] if one.contains("car.rear_right.brake_torque")), "{inputs:?}");
}
