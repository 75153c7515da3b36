//! What can differ: the physics of a braked vehicle, each with the parameters that stand for it.

use crate::model::Value;
use crate::{Error, Result};

/// A hypothesis: parameters that belong together, of all parts that have them.
#[derive(Debug, Clone)]
pub struct Cause {
    /// Its name for programs.
    pub id: &'static str,
    /// Its name for people.
    pub title: &'static str,
    /// The unknowns.
    pub(super) unknowns: Vec<Unknown>,
    /// Changes of the unknowns that are tried first. They are made smaller where they change much more than there is to explain.
    pub(super) probes: Vec<Vec<f64>>,
    /// Decisions of a controller depend on it: it is tried value after value, because what is explained jumps. What is no more than this is none.
    pub(super) scanned: Option<f64>,
    /// It tunes what swings within the frequencies that are recorded: it is looked for all over its range.
    pub(super) swings: bool,
    /// It may be otherwise on one road only.
    pub(super) of_roads: bool,
    /// What manoeuvre shows it where others do not.
    pub shown_by: &'static str,
}

/// One number of a cause.
#[derive(Debug, Clone)]
pub(super) struct Unknown {
    /// Parameters that it moves together; all of a component have to be there.
    pub(super) names: Vec<&'static str>,
    pub(super) how: How,
    /// How far it may go.
    pub(super) range: [f64; 2],
}

/// How a number moves a parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum How {
    /// Times 1 + x.
    Times,
    /// Over 1 + x: the compliance grows in proportion.
    Over,
    /// Plus x.
    Plus,
    /// The values of a curve times 1 + x.
    Curve,
    /// The factor on the friction of all wheels, plus x: an input.
    Friction,
    /// The recorded input times 1 + x.
    Input,
}

/// A stiffness or an inertia that swings is looked for in steps of this factor: what swings answers in a peak that is as narrow
/// as its damping lets it be (a damping ratio of 0.1 is 20 % of the frequency, 40 % of the stiffness), and beside it nothing tells where that peak is.
const FACTOR: f64 = 1.12;

impl Cause {
    /// Twice the change does not do twice as much.
    pub(super) fn is_bent(&self) -> bool {
        self.swings || self.probes.len() > self.unknowns.len()
    }

    /// Of what swings, changes among which one is close to what there is, if there is one: in even steps of the logarithm of what a parameter is multiplied or divided by.
    pub(super) fn starts(&self) -> Vec<Vec<f64>> {
        let [Unknown { how: How::Over | How::Times, range: [low, high], .. }] = self.unknowns[..] else {
            return Vec::new();
        };
        if !self.swings {
            return Vec::new();
        }
        let steps = ((1.0 + high) / (1.0 + low)).ln() / FACTOR.ln();
        (0..=steps as i32).map(|k| vec![(1.0 + low) * FACTOR.powi(k) - 1.0]).collect()
    }
}

impl How {
    /// A parameter's value after the change.
    pub(super) fn changed(self, name: &str, before: &Value, x: f64) -> Result<Value> {
        let curve = |text: &str| -> Option<String> {
            let points: Option<Vec<String>> = text
                .split(';')
                .map(|point| {
                    let (at, value) = point.trim().split_once(char::is_whitespace)?;
                    Some(format!("{at} {}", value.trim().parse::<f64>().ok()? * (1.0 + x)))
                })
                .collect();
            Some(points?.join("; "))
        };
        let changed = match (self, before) {
            (Self::Times, Value::Real(v)) => Some(Value::Real(v * (1.0 + x))),
            (Self::Over, Value::Real(v)) => Some(Value::Real(v / (1.0 + x))),
            (Self::Plus, Value::Real(v)) => Some(Value::Real(v + x)),
            (Self::Curve, Value::Text(text)) => curve(text).map(Value::Text),
            (Self::Friction | Self::Input, value) => Some(value.clone()),
            _ => None,
        };
        changed.ok_or_else(|| Error::variable(format!("{name} cannot be changed in proportion")))
    }
}

fn one(
    id: &'static str,
    title: &'static str,
    names: &[&'static str],
    (how, probe, range): (How, f64, [f64; 2]),
) -> Cause {
    Cause {
        id,
        title,
        unknowns: vec![Unknown { names: names.to_vec(), how, range }],
        probes: vec![vec![probe]],
        scanned: None,
        swings: false,
        of_roads: false,
        shown_by: "",
    }
}

/// Causes in the vehicle. Ranges are how far away a believed value may be.
pub(super) fn of_vehicles() -> Vec<Cause> {
    use How::{Curve, Friction, Over, Plus, Times};
    let slowly = "a stop with controller, so that wheels slow down and speed up";
    let with = |mut cause: Cause, shown_by: &'static str| {
        cause.shown_by = shown_by;
        cause
    };
    let swinging = |cause: Cause| Cause { swings: true, ..cause };
    let inertia = one(
        "wheel_inertia",
        "inertia of the front wheels",
        &["front_wheel_inertia"],
        (Times, 0.1, [-0.5, 1.0]),
    );
    let heavy = Cause {
        id: "wheel_mass",
        title: "mass and inertia of the front wheels",
        unknowns: ["front_wheel_inertia", "front_wheel_mass"]
            .map(|name| Unknown { names: vec![name], how: Times, range: [-0.5, 1.0] })
            .to_vec(),
        probes: vec![vec![0.1, 0.0], vec![0.0, 0.1]],
        scanned: None,
        swings: false,
        of_roads: false,
        shown_by: slowly,
    };
    let mass = Cause {
        id: "mass_distribution",
        title: "mass and its place between the axles",
        unknowns: vec![
            Unknown { names: vec!["vehicle_mass"], how: Times, range: [-0.3, 0.3] },
            Unknown { names: vec!["centre_of_mass_x"], how: Plus, range: [-0.3, 0.3] },
        ],
        probes: vec![vec![0.02, 0.0], vec![0.0, 0.02]],
        scanned: None,
        swings: false,
        of_roads: false,
        shown_by: "any stop",
    };
    let level = one(
        "friction_level",
        "level of the friction between tires and road",
        &[],
        (Friction, 0.03, [-0.5, 0.5]),
    );
    vec![
        with(Cause { of_roads: true, ..level }, "a stop to the limit"),
        with(
            one(
                "falling_branch",
                "fall of the tires' friction beyond its peak",
                &["front_tire.PCX1", "rear_tire.PCX1"],
                (Times, 0.03, [-0.3, 0.3]),
            ),
            "a stop to the limit",
        ),
        with(
            swinging(one(
                "column_stiffness",
                "compliance of the steering column and the driver",
                &["column_stiffness"],
                (Over, 9.0, [-0.97, 50.0]),
            )),
            "braking with more friction on one side than on the other: what is alike on both sides does not turn the wheels",
        ),
        with(
            swinging(one(
                "hub_inertia",
                "inertia of the front wheels and carriers about the steering axis",
                &["front_carrier_inertia", "front_wheel_transverse_inertia"],
                (Times, 0.3, [-0.8, 3.0]),
            )),
            "a stop with controller with more friction on one side than on the other",
        ),
        with(inertia, slowly),
        heavy,
        with(
            one(
                "centre_of_mass_height",
                "height of the centre of mass",
                &["centre_of_mass_z"],
                (Times, 0.03, [-0.4, 0.4]),
            ),
            "any stop",
        ),
        with(
            one(
                "anti_dive",
                "anti-dive of the front suspension",
                &["front_anti_dive"],
                (Plus, 0.05, [-0.5, 0.5]),
            ),
            "any stop",
        ),
        with(
            one(
                "coupling",
                "coupling between the axles",
                &["coupling_damping"],
                (Plus, 10.0, [-200.0, 500.0]),
            ),
            slowly,
        ),
        with(
            one(
                "scrub_radius",
                "scrub radius of the front suspension",
                &["front_scrub_radius"],
                (Plus, 0.004, [-0.05, 0.05]),
            ),
            "any stop",
        ),
        with(
            one("front_damping", "dampers of the front axle", &["front_damper"], (Curve, 0.1, [-0.8, 1.5])),
            "a stop with a sudden begin",
        ),
        with(
            one(
                "front_stiffness",
                "springs of the front axle",
                &["front_spring_stiffness"],
                (Times, 0.05, [-0.6, 1.0]),
            ),
            "any stop",
        ),
        mass,
    ]
}

/// Causes in the pads.
pub(super) fn of_pads() -> Vec<Cause> {
    vec![
        Cause {
            id: "pad_onset",
            title: "friction of the pads that builds up",
            unknowns: vec![
                Unknown { names: vec!["onset_friction_share"], how: How::Plus, range: [-1.0, 1.0] },
                Unknown { names: vec!["onset_time"], how: How::Plus, range: [-1.0, 1.0] },
            ],
            probes: vec![vec![-0.6, 0.2], vec![-0.3, 0.05], vec![0.3, -0.1]],
            scanned: None,
            swings: false,
            of_roads: false,
            shown_by: "any stop",
        },
        Cause {
            unknowns: vec![Unknown { names: vec!["friction"], how: How::Times, range: [-0.5, 1.0] }],
            ..one("pad_friction", "friction of the pads", &["friction"], (How::Times, 0.05, [-0.5, 1.0]))
        },
    ]
}

/// Causes in the hydraulics.
pub(super) fn of_hydraulics() -> Vec<Cause> {
    vec![
        one(
            "master_pressure",
            "recorded pressure of the master cylinder",
            &[],
            (How::Input, 0.03, [-0.5, 0.5]),
        ),
        one("caliper_lag", "lag of the calipers", &["caliper_lag"], (How::Plus, 0.005, [-0.05, 0.1])),
    ]
}

/// A tire's rolling radius changes by so much anyway: braking presses the front tires in by 3 mm more of 330 mm, and wear takes as much.
const RADIUS: f64 = 0.01;

/// Causes in the controller: of its radii only that of the front wheels over that of the rear ones shows, where it takes its reference from the wheels.
pub(super) fn of_controllers() -> Vec<Cause> {
    vec![Cause {
        scanned: Some(RADIUS),
        shown_by: "a stop with controller",
        ..one(
            "controller_radius",
            "radius of the front wheels in the controller, beside that of the rear ones",
            &["rolling_radius_1", "rolling_radius_2"],
            (How::Times, 0.01, [-0.06, 0.06]),
        )
    }]
}
