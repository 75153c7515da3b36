//! Which effects can be concealed where in a machine, and which names are right for them there.

use super::conceal::{Law, Place};
use super::draw::Drive;
use super::mechanism::{Element, Machine, Sensor};

/// An effect at a place.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Offer {
    /// As answers call it: a name of the catalogue, or `outside-...`.
    pub(crate) id: &'static str,
    pub(crate) law: Law,
    pub(crate) place: Place,
    /// Names that are right: the same physics on such recordings.
    pub(crate) accept: Vec<&'static str>,
    /// Variables on which it depends, as recorded.
    pub(crate) depends_on: Vec<String>,
    /// The other channel of cross-talk.
    pub(crate) other: usize,
}

/// Forces of the catalogue, and the names that the same force has.
const FORCES: [(&str, Law, &[&str]); 10] = [
    ("coulomb-friction", Law::Coulomb, &["stribeck-friction"]),
    ("stribeck-friction", Law::Stribeck, &["coulomb-friction"]),
    ("progressive-spring", Law::Cubic, &[]),
    ("asymmetric-spring", Law::SquareSpring, &[]),
    ("quadratic-damper", Law::QuadraticDamper, &[]),
    ("damper-asymmetry", Law::DamperAsymmetry, &[]),
    ("bump-stop", Law::Stop, &[]),
    ("bouc-wen", Law::Hysteresis, &["bushing-hysteresis"]),
    ("maxwell-element", Law::Maxwell, &["viscoelastic-stiffening"]),
    ("clearance", Law::Clearance, &["play", "backlash"]),
];

const SENSORS: [(&str, Law, &[&str]); 8] = [
    ("sensor-delay", Law::Delay, &["sensor-lag"]),
    ("sensor-lag", Law::Lag, &["sensor-delay"]),
    ("sensor-bias", Law::Bias, &[]),
    ("sensor-drift", Law::Drift, &[]),
    ("sensor-gain", Law::Gain, &[]),
    ("sensor-nonlinearity", Law::Curved, &[]),
    ("frame-resonance", Law::Resonance, &[]),
    ("saturation", Law::Saturation, &[]),
];

/// Copies of one channel in another, by what a machine would make of the same copy.
const COPIES: &[&str] = &["fixture-inertia", "guide-drag", "added-inertia"];

const INPUTS: [(&str, Law, &[&str]); 3] = [
    ("actuator-lag", Law::InputLag, &["hydraulic-lag", "driveline-compliance", "actuator-resonance"]),
    ("actuator-rate-limit", Law::InputRate, &["valve-rate-limit"]),
    ("actuator-dead-band", Law::InputDeadBand, &["hydraulic-hold-off"]),
];

/// Everything that can be concealed in this machine; those of the catalogue first, then the others.
pub(crate) fn offers(machine: &Machine, drives: &[Drive]) -> (Vec<Offer>, Vec<Offer>) {
    let (mut named, mut outside) = (Vec::new(), Vec::new());
    let offer = |id, law, place, accept: &[&'static str], depends_on: Vec<String>| Offer {
        id,
        law,
        place,
        accept: std::iter::once(id).chain(accept.iter().copied()).collect(),
        depends_on,
        other: 0,
    };
    for body in 0..machine.bodies.len() {
        let shown = |state: usize, rate: bool| -> Vec<String> {
            let wanted = if rate { Sensor::Rate(state) } else { Sensor::State(state) };
            machine.outputs.iter().filter(|(_, s)| *s == wanted).map(|(v, _)| v.name.clone()).collect()
        };
        let (x, v) = (shown(body, false), shown(machine.velocity(body), false));
        let pushed =
            machine.elements.iter().any(|e| matches!(e, Element::Push { body: b, .. } if *b == body));
        let held = machine.elements.iter().any(|e| {
            matches!(e, Element::Spring { from, to: None, .. } if *from == body)
                || matches!(e, Element::Shaken { body: b, .. } if *b == body)
        });
        let has = |cubic: bool| {
            machine.elements.iter().any(|e| match e {
                Element::Cubic { from, .. } => cubic && *from == body,
                Element::Orifice { from, .. } => !cubic && *from == body,
                _ => false,
            })
        };
        for (id, law, accept) in FORCES {
            let spring = matches!(
                law,
                Law::Cubic | Law::SquareSpring | Law::Stop | Law::Hysteresis | Law::Maxwell | Law::Clearance
            );
            // what nothing holds has no middle; what the model has already is a parameter
            if (spring && !held)
                || (law == Law::Cubic && has(true))
                || (law == Law::QuadraticDamper && has(false))
            {
                continue;
            }
            let by = if spring { x.clone() } else { v.iter().chain(&x).cloned().collect() };
            if pushed && !(x.is_empty() && v.is_empty()) {
                named.push(offer(id, law, Place::Body(body), accept, by));
            }
        }
        let both: Vec<String> = x.iter().chain(&v).cloned().collect();
        if held {
            outside.push(offer("outside-product", Law::Product, Place::Body(body), &[], both.clone()));
            outside.push(offer("outside-cogging", Law::Cogging, Place::Body(body), &[], x.clone()));
        }
        outside.push(offer("outside-unrecorded", Law::Unrecorded, Place::Body(body), &[], Vec::new()));
    }
    for store in 0..machine.stores.len() {
        let state = machine.store(store);
        let shown: Vec<String> = machine
            .outputs
            .iter()
            .filter(|(_, s)| *s == Sensor::State(state))
            .map(|(v, _)| v.name.clone())
            .collect();
        outside.push(offer("outside-leak", Law::LeakSquared, Place::Store(store), &[], shown.clone()));
        outside.push(offer("outside-overflow", Law::LeakAbove, Place::Store(store), &[], shown));
        outside.push(offer("outside-unrecorded", Law::Unrecorded, Place::Store(store), &[], Vec::new()));
    }
    for (input, (variable, drive)) in machine.inputs.iter().zip(drives).enumerate() {
        for (id, law, accept) in INPUTS {
            // where no command crosses zero, a dead band is an offset
            if law == Law::InputDeadBand && drive.middle != 0.0 {
                continue;
            }
            named.push(offer(id, law, Place::Input(input), accept, vec![variable.name.clone()]));
        }
        if matches!(variable.unit, "m" | "rad") {
            let by = vec![variable.name.clone()];
            named.push(offer("play", Law::InputPlay, Place::Input(input), &["clearance", "backlash"], by));
        }
    }
    for output in 0..machine.outputs.len() {
        for (id, law, accept) in SENSORS {
            let by = if matches!(law, Law::Delay | Law::Lag | Law::Drift) {
                vec!["time".to_owned()]
            } else {
                vec![]
            };
            named.push(offer(id, law, Place::Output(output), accept, by));
        }
        for other in (0..machine.outputs.len()).filter(|o| *o != output) {
            let by = vec![machine.outputs[other].0.name.clone()];
            let one = offer("cross-talk", Law::CrossTalk, Place::Output(output), COPIES, by);
            named.push(Offer { other, ..one });
        }
    }
    for parameter in 0..machine.parameters.len() {
        for (id, law) in
            [("outside-by-time", Law::ByTime), ("outside-crack", Law::Crack), ("outside-wander", Law::Wander)]
        {
            let by = if law == Law::Wander { vec![] } else { vec!["time".to_owned()] };
            outside.push(offer(id, law, Place::Parameter(parameter), &[], by));
        }
    }
    if machine.outputs.len() == 1 {
        // what is late or rings at the one sensor does so at the actuator, too
        for offer in &mut named {
            match offer.law {
                Law::Lag | Law::Delay => offer.accept.extend(["actuator-lag", "hydraulic-lag"]),
                Law::InputLag => offer.accept.extend(["sensor-lag", "sensor-delay"]),
                Law::Resonance => offer.accept.extend(["actuator-resonance", "driveline-compliance"]),
                _ => {}
            }
        }
    }
    (named, outside)
}
