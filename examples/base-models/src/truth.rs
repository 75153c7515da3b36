//! The base models against the truth generator with nothing hidden: the same physics, written twice.

use crate::brake::{AbsBrake, BrakeCorner};
use crate::magic_wheel::MagicWheel;
use crate::oscillator::Oscillator;
use crate::quarter_car::QuarterCar;
use crate::rk4::tests::{get, rate, set};
use crate::steady_tire::SteadyTire;
use latsch::model::{Model, Native, Settings, Slave};
use latsch_truth::base::Base;
use latsch_truth::programme::{self, EVERYTHING, Sampling};
use latsch_truth::random::Random;
use latsch_truth::simulate::{STEP, World};

/// Largest rms over channels of the difference, over that of the channel, with the parameters `factor` times the usual.
fn difference<M: Model>(base: Base, index: usize, factor: f64) -> f64 {
    assert_eq!(M::NAME, base.name());
    let mut random = Random::new(3, index as u64);
    let sampling = Sampling { rate: 200.0, duration: 3.0, jitter: 0.05 };
    let run = programme::draw(base, &mut random, &sampling, &EVERYTHING, index, 1.0);
    let parameters: Vec<f64> = base.defaults().iter().map(|p| p * factor).collect();
    let world = World { base, parameters: parameters.clone(), hidden: vec![], filter: 1e-9 };
    let ideal = world.run(&run, 0, STEP);

    let mut slave = Native::<M>::new(&Settings::default()).unwrap();
    for (row, value) in base.parameters().iter().zip(&parameters) {
        set(&mut slave, &[(row.0, *value)]);
    }
    let inputs: Vec<&str> = base.inputs().iter().map(|row| row.0).collect();
    for (name, values) in inputs.iter().zip(&run.inputs) {
        set(&mut slave, &[(name, values[0])]);
    }
    slave.start(0.0, None).unwrap();
    slave.finish_start().unwrap();
    let outputs: Vec<&str> = base.outputs().iter().map(|row| row.0).collect();
    let (mut errors, mut squares) = (vec![0.0; outputs.len()], vec![0.0; outputs.len()]);
    for k in 0..run.time.len() {
        for (c, name) in outputs.iter().enumerate() {
            let (truth, model) = (ideal.outputs[c][k], get(&mut slave, name));
            errors[c] += (truth - model) * (truth - model);
            let about = if *name == "wheel_load" { 9.81 * (parameters[0] + parameters[1]) } else { 0.0 };
            squares[c] += (truth - about) * (truth - about);
        }
        if k + 1 == run.time.len() {
            break;
        }
        let span = run.time[k + 1] - run.time[k];
        for (name, values) in inputs.iter().zip(&run.inputs) {
            set(&mut slave, &[(name, values[k])]);
            rate(&mut slave, name, (values[k + 1] - values[k]) / span);
        }
        slave.step(run.time[k], span).unwrap();
    }
    errors
        .iter()
        .zip(&squares)
        .filter(|(_, square)| **square > 0.0)
        .map(|(error, square)| (error / square).sqrt())
        .fold(0.0, f64::max)
}

#[track_caller]
fn agree<M: Model>(base: Base, tolerance: f64) {
    for index in [0, 1, 2, 4] {
        for factor in [1.0, 1.08] {
            let difference = difference::<M>(base, index, factor);
            assert!(difference < tolerance, "{} run {index}: {difference}", base.name());
        }
    }
}

// Samples lie beside the 1 ms grid of the models, whose inputs bend at samples and not at grid points; a tenth of the
// least noise of the study is enough.
#[test]
fn oscillators_agree() {
    agree::<Oscillator>(Base::Oscillator, 5e-4);
}

#[test]
fn quarter_cars_agree() {
    agree::<QuarterCar>(Base::QuarterCar, 1e-3);
}

#[test]
fn steady_tires_agree() {
    agree::<SteadyTire>(Base::SteadyTire, 1e-6);
}

#[test]
fn wheels_agree() {
    agree::<MagicWheel>(Base::MagicWheel, 1e-3);
}

#[test]
fn brakes_agree() {
    agree::<BrakeCorner>(Base::BrakeCorner, 1e-3);
    agree::<AbsBrake>(Base::AbsBrake, 1e-3);
}
