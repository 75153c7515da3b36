//! What every native model does for its author and for FMI, whatever the model is.
#![allow(missing_docs, clippy::unwrap_used, clippy::panic)]

mod common;

use common::{flat_track, set, started};
use latsch::control::AbsController;
use latsch::model::{
    Causality, Initial, Kind, Model, Native, Settings, Slave, Table, Variability, input, output,
};
use latsch::rig::RingBrushFlatTrack;
use latsch::{Error, Result, real};
use serde::{Deserialize, Serialize};

/// The reciprocal of its input: at 0 it leaves what can be computed, without noticing.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
struct Reciprocal {
    input: f64,
    fine: f64,
    reciprocal: f64,
    logarithm: f64,
}

impl Model for Reciprocal {
    const NAME: &'static str = "reciprocal";
    const DESCRIPTION: &'static str = "1 over its input, and a logarithm";
    fn variables() -> Table<Self> {
        Table::new([
            input("input", "1", real!(input), 1.0, "What is inverted"),
            output("fine", "1", real!(fine), "The input itself"),
            output("reciprocal", "1", real!(reciprocal), "1 over the input"),
            output("logarithm", "1", real!(logarithm), "Logarithm of the input plus 1"),
        ])
    }

    fn step_size(&self) -> f64 {
        1e-3
    }

    fn initialize(&mut self) -> Result<()> {
        self.step(0.0)
    }

    fn step(&mut self, _length: f64) -> Result<()> {
        (self.fine, self.reciprocal) = (self.input, 1.0 / self.input);
        self.logarithm = libm::log(self.input + 1.0);
        Ok(())
    }
}

#[test]
fn an_output_that_is_no_number_is_an_error_that_names_it() {
    for (value, words) in [(0.0, "reciprocal = inf"), (-2.0, "logarithm = NaN")] {
        // on the grid and between
        for length in [1e-3, 5e-3, 2.5e-4] {
            let mut slave = started::<Reciprocal>(&[]);
            slave.step(0.0, 1e-3).unwrap();
            let saved = slave.save().unwrap();
            set(&mut slave, &[("input", value)]);
            let error: Error = slave.step(1e-3, length).unwrap_err();
            assert!(error.to_string().starts_with(words), "{error}");
            assert!(error.to_string().contains(&format!("after the step to {} s", 1e-3 + length)), "{error}");
            // nothing goes on from there, but back it goes
            assert!(slave.step(1e-3, length).is_err());
            slave.restore(&saved).unwrap();
            slave.step(1e-3, length).unwrap();
        }
        let mut slave = Native::<Reciprocal>::new(&Settings::default()).unwrap();
        set(&mut slave, &[("input", value)]);
        slave.start(0.0, None).unwrap();
        let error = slave.finish_start().unwrap_err().to_string();
        assert!(error.starts_with(words) && error.contains("initialization"), "{error}");
    }
}

/// Types are forgotten inside: what belongs to another model has to be told all the same.
#[test]
fn a_snapshot_of_another_model_is_refused() {
    let mut own = started::<Reciprocal>(&[("input", 2.0)]);
    own.step(0.0, 1e-3).unwrap();
    let mut other = Native::<AbsController>::new(&Settings::default()).unwrap();
    let mut foreign = other.save().unwrap();
    let words = "belongs to another model";
    assert!(own.restore(&foreign).unwrap_err().to_string().contains(words));
    assert!(own.serialize(&foreign).unwrap_err().to_string().contains(words));
    assert_eq!(common::get(&mut own, "reciprocal"), 0.5);
    // one of another model has no memory to reuse
    own.save_into(&mut foreign).unwrap();
    assert!(other.restore(&foreign).is_err());
    set(&mut own, &[("input", 4.0)]);
    own.step(1e-3, 1e-3).unwrap();
    own.restore(&foreign).unwrap();
    assert_eq!((own.time(), common::get(&mut own, "reciprocal")), (1e-3, 0.5));
}

/// All at once is as one by one, in whatever order and whatever the kinds.
#[test]
fn values_that_are_read_together_are_those_that_are_read_alone() {
    let mut track = flat_track(&[("slip", 0.05), ("slip_angle", 0.06)]);
    track.step(0.0, 1e-3).unwrap();
    let variables = track.interface().variables.clone();
    let mut all: Vec<usize> = (0..variables.len()).rev().collect();
    all.retain(|i| !matches!(variables[*i].kind, Kind::Text));
    let real: Vec<usize> = all.iter().copied().filter(|i| variables[*i].is_real()).collect();
    assert!(real.len() < all.len());
    for wanted in [all, real] {
        let mut together = vec![0.0; wanted.len()];
        track.get_all(&wanted, &mut together).unwrap();
        for (index, value) in wanted.iter().zip(&together) {
            assert_eq!(*value, track.get(*index).unwrap(), "{}", variables[*index].name);
        }
        // a reading that always gave 0 would be alike, too
        assert!(together.iter().filter(|value| **value != 0.0).count() > wanted.len() / 2);
    }
}

/// Every unknown and known that FMI lets a master combine in Initialization Mode (2.0.5, section 2.2.8): Real outputs,
/// and Real inputs and variables that start with an exact value.
#[test]
fn before_the_first_step_every_output_has_a_derivative_by_every_known() {
    // level and rolling at combined slip; on a ramp, where there are no formulas
    for values in [
        &[("slip", 0.05), ("slip_angle", 0.06), ("deflection", 0.021)][..],
        &[
            ("slip", 0.02),
            ("road_kind", 3.0),
            ("road_start", -2.0),
            ("road_length", 50.0),
            ("road_height", 0.5),
        ],
    ] {
        let mut slave = Native::<RingBrushFlatTrack>::new(&Settings::default()).unwrap();
        set(&mut slave, values);
        slave.start(0.0, None).unwrap();
        let variables = slave.interface().variables.clone();
        let of = |fits: &dyn Fn(usize) -> bool| (0..variables.len()).filter(|i| fits(*i)).collect::<Vec<_>>();
        let unknowns = of(&|i| variables[i].causality == Causality::Output && variables[i].is_real());
        let knowns = of(&|i| {
            let v = &variables[i];
            v.is_real() && (v.causality == Causality::Input || v.initial == Some(Initial::Exact))
        });
        assert!(unknowns.len() == 19 && knowns.len() >= 60, "{} {}", unknowns.len(), knowns.len());
        // a ramp does not come again, nor would it at a spacing beside 0: there is no difference to take
        let knowns = knowns.into_iter().filter(|i| values.len() == 3 || variables[*i].name != "road_spacing");
        for known in knowns {
            let derivatives = slave.directional_derivatives(&unknowns, &[known], &[1.0]);
            let derivatives = derivatives.unwrap_or_else(|e| panic!("{}: {e}", variables[known].name));
            assert!(derivatives.iter().all(|d| d.is_finite()), "{}", variables[known].name);
        }
    }
}

/// By a parameter: the differences of fresh starts, another way than the model's own copies.
#[test]
fn derivatives_by_parameters_are_those_of_fresh_starts() {
    const POINT: [(&str, f64); 3] = [("slip", 0.05), ("slip_angle", 0.06), ("deflection", 0.021)];
    let outputs = ["force_x", "force_y", "force_z", "moment_z", "patch_force_x", "contact_length_center"];
    let read = |name: &str, value: f64| -> Vec<f64> {
        let mut slave = flat_track(&[&POINT[..], &[(name, value)]].concat());
        outputs.iter().map(|o| slave.find(o).and_then(|i| slave.get(i)).unwrap()).collect()
    };
    let mut slave = Native::<RingBrushFlatTrack>::new(&Settings::default()).unwrap();
    set(&mut slave, &POINT);
    slave.start(0.0, None).unwrap();
    let find = |slave: &Native<RingBrushFlatTrack>, name: &str| slave.find(name).unwrap();
    let unknowns: Vec<usize> = outputs.iter().map(|o| find(&slave, o)).collect();
    for (name, value) in
        [("vertical_stiffness", 1.54e5), ("sidewall_lateral_stiffness", 8.5e4), ("belt_mass", 8.8)]
    {
        let known = find(&slave, name);
        let got = slave.directional_derivatives(&unknowns, &[known], &[2.0]).unwrap();
        let step = 1e-3 * value;
        let (above, below) = (read(name, value + step), read(name, value - step));
        for (((got, above), below), output) in got.iter().zip(above).zip(below).zip(outputs) {
            let expected = 2.0 * (above - below) / (2.0 * step);
            // bristles come into contact one by one, which a wide difference sees and a narrow one does not
            let tolerance = if output == "patch_force_x" { 0.3 } else { 2e-3 };
            let scale = expected.abs().max(1e-6 * above.abs() / value);
            assert!((got - expected).abs() <= tolerance * scale, "d {output} / d {name}: {got}, {expected}");
        }
    }
    // a direction of inputs and parameters is the sum of its parts
    let (slip, mass) = (find(&slave, "slip"), find(&slave, "belt_mass"));
    let mut along =
        |knowns: &[usize], seed: &[f64]| slave.directional_derivatives(&unknowns, knowns, seed).unwrap();
    let (both, by_slip, by_mass) =
        (along(&[slip, mass], &[0.5, 3.0]), along(&[slip], &[0.5]), along(&[mass], &[3.0]));
    for ((both, a), b) in both.iter().zip(by_slip).zip(by_mass) {
        assert!((both - a - b).abs() <= 1e-9 * both.abs(), "{both} {a} {b}");
    }
}

/// A rate that is given before initialization counts as one that is given in it.
#[test]
fn derivatives_of_inputs_can_be_set_as_soon_as_it_is_made() {
    let run = |early: bool| {
        let mut slave = Native::<RingBrushFlatTrack>::new(&Settings::default()).unwrap();
        let steer = slave.find("slip_angle").unwrap();
        if early {
            slave.set_rate(steer, 0.5).unwrap();
        }
        slave.start(2.0, None).unwrap();
        slave.set(steer, 0.01).unwrap();
        if !early {
            slave.set_rate(steer, 0.5).unwrap();
        }
        slave.finish_start().unwrap();
        slave.step(2.0, 0.01).unwrap();
        let force = slave.find("force_y").unwrap();
        (slave.get(steer).unwrap(), slave.get(force).unwrap())
    };
    let (angle, force) = run(true);
    assert!((angle - 0.015).abs() < 1e-12 && force < 0.0, "{angle} {force}");
    assert_eq!((angle, force), run(false));
}

#[test]
fn outputs_of_a_sampled_controller_are_discrete() {
    let table = Native::<AbsController>::table();
    for index in table.with(Causality::Output) {
        assert_eq!(
            table.variables[index].variability,
            Variability::Discrete,
            "{}",
            table.variables[index].name
        );
    }
    let description = latsch::fmi::description::model_description(&table, "{0}").unwrap();
    assert!(description.contains("maxOutputDerivativeOrder=\"0\""), "it has none to offer");
    let tire =
        latsch::fmi::description::model_description(&Native::<RingBrushFlatTrack>::table(), "{0}").unwrap();
    assert!(tire.contains("maxOutputDerivativeOrder=\"1\""));
}
