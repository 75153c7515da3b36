//! What the literature says of effects: each test derives its numbers from a definition or from first principles, not
//! from the catalogue's formulas or ranges. Axes and signs are ISO 8855.

use super::tests::run;
use crate::effect::file::Corrections;
use crate::effect::{Attached, Attachment, Chosen, Effect, Signal, find, forms};
use crate::model::{Access, Model, Native, Settings, Slave, Table, input, output, parameter};
use crate::rig::RingBrushFlatTrack;
use crate::{Result, real};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

fn form(id: &str, parameter: &str) -> &'static Effect {
    forms(id).find(|e| e.parameters.iter().any(|p| p.name == parameter)).unwrap()
}

fn now(effect: &Effect, p: &[f64], target: f64, drivers: [f64; 3]) -> f64 {
    run(effect, p, &[(0.0, target, drivers)])[0]
}

/// A tire with linear forces on a rig: slip angle from the velocity of the wheel's centre and its steer angle.
#[derive(Clone, Default, PartialEq, Serialize, Deserialize)]
struct Carriage {
    speed: f64,
    sideways: f64,
    steer: f64,
    slip_angle: f64,
    load: f64,
    cornering_stiffness: f64,
    trail: f64,
}

impl Carriage {
    /// atan2(v_y, |v_x|) in the axes of the wheel, and what the rig adds.
    fn angle(&self) -> f64 {
        let (sin, cos) = libm::sincos(self.steer);
        let (vx, vy) = (self.speed * cos + self.sideways * sin, self.sideways * cos - self.speed * sin);
        libm::atan2(vy, vx.abs()) + self.slip_angle
    }

    /// A positive slip angle makes a negative lateral force and, rolling forward, a positive moment.
    fn side_force(&self) -> f64 {
        -self.cornering_stiffness * self.angle()
    }
}

macro_rules! shown {
    ($m:ident => $value:expr) => {
        Access::computed(|$m: &Self| $value)
    };
}

impl Model for Carriage {
    const NAME: &'static str = "carriage";
    const DESCRIPTION: &'static str = "A linear tire that is pulled along";
    fn variables() -> Table<Self> {
        Table::new([
            parameter(
                "cornering_stiffness",
                "N/rad",
                real!(cornering_stiffness),
                6e4,
                "Force per slip angle",
            ),
            parameter("trail", "m", real!(trail), 0.03, "Pneumatic trail"),
            input("speed", "m/s", real!(speed), 20.0, "Speed along x"),
            input("sideways", "m/s", real!(sideways), 0.0, "Speed along y"),
            input("steer", "rad", real!(steer), 0.0, "Steer angle about z"),
            input("slip_angle", "rad", real!(slip_angle), 0.0, "Slip angle besides"),
            input("load", "N", real!(load), 4000.0, "Load"),
            output("angle", "rad", shown!(m => m.angle()), "Slip angle of the tire"),
            output("force_y", "N", shown!(m => m.side_force()), "Lateral force"),
            output("moment_z", "N.m", shown!(m => -m.trail * m.side_force()), "Aligning moment"),
        ])
    }
    fn step_size(&self) -> f64 {
        1e-3
    }
    fn initialize(&mut self) -> Result<()> {
        Ok(())
    }
    fn step(&mut self, _: f64) -> Result<()> {
        Ok(())
    }
}

/// A model with an effect at a place.
fn attached<M: Model>(
    effect: &'static Effect,
    p: &[f64],
    target: &str,
    drivers: &[&str],
) -> Attached<Native<M>> {
    let slave = Native::<M>::new(&Settings::default()).unwrap();
    let at = |name: &str| slave.find(name).unwrap();
    let chosen =
        |value: &f64| Chosen { value: *value, range: (f64::NEG_INFINITY, f64::INFINITY), unit: None };
    let signal = |name: &&str| Signal::value(at(name));
    let attachment = Attachment {
        effect,
        target: at(target),
        drivers: drivers.iter().map(signal).collect(),
        parameters: p.iter().map(chosen).collect(),
    };
    Attached::new(Box::new(slave), vec![attachment]).unwrap()
}

/// An output after some time with these inputs.
fn after<S: Slave>(mut slave: S, time: f64, inputs: &[(&str, f64)], shown: &str) -> f64 {
    for (name, value) in inputs {
        let variable = slave.find(name).unwrap();
        slave.set(variable, *value).unwrap();
    }
    slave.start(0.0, None).unwrap();
    slave.finish_start().unwrap();
    let steps = (time / 1e-3).round() as usize;
    for k in 0..steps {
        slave.step(k as f64 * 1e-3, 1e-3).unwrap();
    }
    let variable = slave.find(shown).unwrap();
    slave.get(variable).unwrap()
}

// ------------------------------------------------------------------ drum

/// Load and force of a brush on an elastic foundation under a tire of radius 0.3 m on a road of curvature `bend`
/// \[1/m\], pressed in by `sunk` \[m\], at a slip: summed up along the contact. Where the tire meets the road without load
/// the gap is x^2 (1 / r + bend) / 2, the pressure what the foundation is pressed in by; a bristle is bent by slip times
/// its way from the front edge and carries no more than friction times pressure.
fn brush(bend: f64, sunk: f64, slip: f64) -> (f64, f64) {
    let (foundation, bristle, friction, n) = (4e6, 6e6, 1.0, 20_000);
    let half = (2.0 * sunk / (1.0 / 0.3 + bend)).sqrt();
    let dx = 2.0 * half / f64::from(n);
    (0..n).fold((0.0, 0.0), |(load, force), i| {
        let way = (f64::from(i) + 0.5) * dx;
        let pressure = foundation * (sunk - 0.5 * (half - way).powi(2) * (1.0 / 0.3 + bend));
        (load + pressure * dx, force + (bristle * slip * way).min(friction * pressure) * dx)
    })
}

/// The deflection at which a load is carried: halving.
fn sunk_by(load: f64, bend: f64) -> f64 {
    let (mut low, mut high) = (0.0, 0.1);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if brush(bend, middle, 0.0).0 < load { low = middle } else { high = middle }
    }
    low
}

#[test]
fn on_a_drum_load_and_side_force_are_lower_and_rolling_resistance_is_higher() {
    // a drum of 1.7 m: R = 0.85 m
    let (drum, ratio, sunk) = (1.0 / 0.85, 0.3 / 0.85, 0.02);
    let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 2e-3, "{a} is not {b}");
    let load = brush(0.0, sunk, 0.0).0;
    let pressed = now(find("drum-curvature").unwrap(), &[ratio], load, [0.0; 3]);
    near(pressed, brush(drum, sunk, 0.0).0);
    assert!(pressed < 0.9 * load);
    for slip in [1e-4, 0.02, 0.05, 0.1, 0.3] {
        // at the same deflection; friction is 1
        let force = brush(0.0, sunk, slip).1;
        let lower = now(form("drum-curvature", "friction"), &[ratio, 1.0], force, [load, 0.0, 0.0]);
        if slip < 0.24 {
            near(lower, brush(drum, sunk, slip).1);
        } else {
            // all slides: the pressure rises by 4e6 sqrt(2 d / r) per metre from either end, and 6e6 slip is more. How
            // much more no force tells, so the slip is taken where all begins to slide. There a contact that is shorter
            // by q = 0.86 lacks (1 - q)^3 = 0.27 % of sliding as a whole
            let lacks = (1.0 - (1.0 / (1.0 + ratio)).sqrt()).powi(3);
            near(lower, brush(drum, sunk, slip).1 * (1.0 - lacks));
        }
        assert!(lower < 0.9 * force);
        // at the same load
        let less = now(form("drum-curvature", "radius_ratio_at_load"), &[ratio], slip, [0.0; 3]);
        near(brush(0.0, sunk, less).1, brush(drum, sunk_by(load, drum), slip).1);
        // a model of the drum, and a recording of the road
        let back = now(
            form("drum-curvature", "friction"),
            &[1.0 / (1.0 + ratio) - 1.0, 1.0],
            lower,
            [pressed, 0.0, 0.0],
        );
        assert!(slip > 0.05 || (back / force - 1.0).abs() < 2e-3, "{back} {force}");
    }
    // ISO 28580 turns a measurement on a drum of R1 into one on R2 by sqrt((R1 / R2) (R2 + r) / (R1 + r)); R1 to infinity
    let iso = |from: f64, to: f64| ((from / to) * (to + 0.3) / (from + 0.3)).sqrt();
    let rolling = form("drum-curvature", "resistance");
    let higher = now(rolling, &[ratio, 0.02], -40.0, [4000.0, 0.0, 0.0]);
    near(higher, -40.0 * iso(1e9, 0.85));
    assert!(higher < -40.0);
    // a brake force is not what rolling costs: no more than 2 % of the load are
    near(now(rolling, &[ratio, 0.02], -2000.0, [4000.0, 0.0, 0.0]), -2000.0 - 80.0 * (iso(1e9, 0.85) - 1.0));
}

/// A form of an effect is known by its drivers and the names of its parameters; what a file of an older version says
/// of effects whose sign or meaning has changed is refused, not taken for something else.
#[test]
fn a_file_names_the_form_and_no_old_sign_is_read() {
    let interface = Native::<Carriage>::new(&Settings::default()).unwrap().interface().clone();
    let read = |id: &str, target: &str, drivers: &str, parameters: &str| {
        let text = format!(
            "model = \"carriage\"\n[[effect]]\nid = \"{id}\"\ntarget = \"{target}\"\ndrivers = [{drivers}]\n\n[effect.parameters]\n{parameters}\n"
        );
        let all = Corrections::parse(&text, "c.toml").unwrap().attachments(&interface);
        all.map(|all| all[0].effect.parameters[0].name).map_err(|e| e.to_string())
    };
    let mode = "frequency = 10.0\ndamping = 0.1";
    for (name, target, driver) in [
        ("compliance", "slip_angle", "moment_z"),
        ("side_compliance", "slip_angle", "force_y"),
        ("steer_compliance", "steer", "moment_z"),
        ("steer_side_compliance", "steer", "force_y"),
    ] {
        let text = format!("{name} = 1e-5\n{mode}");
        assert_eq!(read("steering-compliance", target, &format!("\"{driver}\""), &text).unwrap(), name);
    }
    for name in ["friction", "resistance"] {
        let text = format!("radius_ratio = 0.3\n{name} = 1.0");
        assert!(read("drum-curvature", "force_y", "\"load\"", &text).is_ok(), "{name}");
    }
    for (id, target, drivers, parameters) in [
        ("drum-curvature", "force_y", "", "ratio = 0.3"),
        ("camber-thrust", "force_y", "\"steer\"", "stiffness = 4e4"),
        ("plysteer", "slip_angle", "", "angle = 0.01"),
    ] {
        let refused = read(id, target, drivers, parameters).unwrap_err();
        assert!(refused.contains(id), "{refused}");
    }
}

// ------------------------------------------------------------------ steering

/// A spring holds the wheel against its own aligning moment: whatever the sign of the slip angle, it gets smaller.
/// In balance alpha = alpha_0 - c Mz and Mz = C t alpha, so alpha = alpha_0 / (1 + c C t); by the lateral force
/// Fy = -C alpha behind the steering axis alpha_0 / (1 + c C).
#[test]
fn a_wheel_that_a_spring_holds_gives_way_towards_less_slip_angle() {
    let (stiffness, trail) = (6e4, 0.03);
    for (parameter, driver, compliance, gain) in
        [("compliance", "moment_z", 2e-4, stiffness * trail), ("side_compliance", "force_y", 5e-6, stiffness)]
    {
        let effect = form("steering-compliance", parameter);
        let (least, most) = effect.parameters[0].plausible;
        assert!(most > 0.0, "{parameter} has a positive range");
        // a compliance by its own moment is positive; what a force does elsewhere may have either sign
        assert_eq!(least < 0.0, parameter == "side_compliance");
        for angle in [-0.05, -0.01, 0.01, 0.05] {
            let p = [compliance, 10.0, 0.6];
            let slave = attached::<Carriage>(effect, &p, "slip_angle", &[driver]);
            let left = after(slave, 2.0, &[("slip_angle", angle)], "angle");
            let balance = angle / (1.0 + compliance * gain);
            assert!(
                (left - balance).abs() < 1e-4 * angle.abs(),
                "{parameter}: {angle} becomes {left}, not {balance}"
            );
            assert!(left.abs() < 0.9 * angle.abs());
        }
    }
    // the same with the steer angle of a wheel that is pulled at an angle
    for (parameter, driver, compliance, gain) in [
        ("steer_compliance", "moment_z", 2e-4, stiffness * trail),
        ("steer_side_compliance", "force_y", 5e-6, stiffness),
    ] {
        for drift in [-1.0, 0.2, 1.0] {
            let effect = form("steering-compliance", parameter);
            let slave = attached::<Carriage>(effect, &[compliance, 10.0, 0.6], "steer", &[driver]);
            let left = after(slave, 2.0, &[("sideways", drift)], "angle");
            let balance = libm::atan2(drift, 20.0) / (1.0 + compliance * gain);
            assert!((left - balance).abs() < 1e-4 * balance.abs(), "{parameter}: {left}, not {balance}");
        }
    }
}

#[test]
fn the_shipped_tire_gives_way_as_well() {
    let effect = form("steering-compliance", "compliance");
    for angle in [-0.02, 0.02] {
        let slave =
            |c: f64| attached::<RingBrushFlatTrack>(effect, &[c, 10.0, 0.6], "slip_angle", &["moment_z"]);
        let of = |c: f64| after(slave(c), 0.6, &[("slip_angle", angle)], "actual_slip_angle");
        let (stiff, soft) = (of(0.0), of(1e-4));
        assert!((stiff - angle).abs() < 1e-9 && soft * angle > 0.0, "{stiff} {soft}");
        assert!(soft.abs() < 0.97 * stiff.abs(), "{stiff} becomes {soft}");
    }
}

// ------------------------------------------------------------------ ply steer, conicity, camber

/// The lateral force offset is measured in both directions of rotation on a tire that is not turned round. Conicity is
/// half of the sum of both offsets, ply steer half of their difference: a tire with ply steer alone has no conicity,
/// and the other way round.
#[test]
fn ply_steer_turns_with_the_direction_and_conicity_does_not() {
    let both = |force: &dyn Fn(f64) -> f64| {
        let (forward, backward) = (force(15.0), force(-15.0));
        (0.5 * (forward + backward), 0.5 * (forward - backward))
    };
    // as an angle: the slip angle of ISO 8855 has |v_x|, so that the force of the tire knows no direction
    let angle = form("plysteer", "angle");
    let rolling = |v: f64| {
        let slave = attached::<Carriage>(angle, &[0.004], "slip_angle", &["speed"]);
        after(slave, 0.01, &[("speed", v)], "force_y")
    };
    let (conicity, plysteer) = both(&rolling);
    assert!((plysteer + 6e4 * 0.004).abs() < 1e-6 && conicity.abs() < 1e-9, "{conicity} {plysteer}");
    // what the description says of the angle: at minus this the tire makes no side force
    let slave = attached::<Carriage>(angle, &[0.004], "slip_angle", &["speed"]);
    let none = after(slave, 0.01, &[("slip_angle", -0.004)], "force_y");
    assert!(none.abs() < 1e-9 && angle.parameters[0].description.contains("at minus this"), "{none}");
    // and it is a wheel whose heading is off: without the effect, by as much
    let toed = |v: f64| {
        let slave = Native::<Carriage>::new(&Settings::default()).unwrap();
        after(slave, 0.01, &[("speed", v), ("steer", -0.004)], "force_y")
    };
    assert!((toed(15.0) - rolling(15.0)).abs() < 1e-6 && (toed(-15.0) - rolling(-15.0)).abs() < 1e-6);
    // as forces
    for (id, turns) in [("plysteer", true), ("conicity", false)] {
        let effect = form(id, "coefficient");
        let force = |v: f64| {
            let slave = attached::<Carriage>(effect, &[0.01], "force_y", &["load", "speed"]);
            after(slave, 0.01, &[("speed", v)], "force_y")
        };
        let (conicity, plysteer) = both(&force);
        let (there, none) = if turns { (plysteer, conicity) } else { (conicity, plysteer) };
        assert!((there - 40.0).abs() < 0.01 && none.abs() < 1e-9, "{id}: {conicity} {plysteer}");
    }
}

/// A positive camber leans the top of the wheel to its right, and camber thrust goes to the side of the lean: -y. The
/// shipped tire, whose camber thrust comes from its geometry, says so too.
#[test]
fn camber_thrust_goes_to_the_side_of_the_lean() {
    for camber in [-0.05, 0.05] {
        let slave = || Native::<RingBrushFlatTrack>::new(&Settings::default()).unwrap();
        let thrust =
            after(slave(), 1.0, &[("camber", camber)], "force_y") - after(slave(), 1.0, &[], "force_y");
        assert!(thrust * camber < 0.0, "{camber} makes {thrust} N");
        for (parameter, value) in [("camber_stiffness", 4000.0), ("camber_stiffness_per_load", 1.0)] {
            let added = now(form("camber-thrust", parameter), &[value], 0.0, [camber, 4000.0, 0.0]);
            assert!((added + 4000.0 * camber).abs() < 1e-9, "{parameter}: {added}");
        }
    }
}

// ------------------------------------------------------------------ rubber

/// One arm with the time constant T has the storage modulus k (w T)^2 / (1 + (w T)^2): a step from a tenth to nine tenths
/// of k between w T = 1/3 and 3, and nothing beyond. A stiffness that rises with the logarithm of the frequency would rise
/// by as much in each decade.
#[test]
fn one_maxwell_arm_is_one_step_and_no_logarithm() {
    // in phase with the displacement; the arm's force is added to the number itself for the one, taken off for the other
    let storage = |id: &str, reduced: f64| {
        let (time, per) = (0.02, 400);
        let omega = reduced / time;
        let turns = 4 + (20.0 * reduced / TAU) as usize;
        let dt = TAU / omega / per as f64;
        let points: Vec<_> = (0..=turns * per)
            .map(|i| {
                let x = (TAU * i as f64 / per as f64).sin();
                if id == "maxwell-element" { (dt, 0.0, [x, 0.0, 0.0]) } else { (dt, x, [0.0; 3]) }
            })
            .collect();
        let out = run(find(id).unwrap(), &[1.0, time], &points);
        let last = (turns - 1) * per..turns * per;
        let sum: f64 = last.map(|i| out[i] * (TAU * i as f64 / per as f64).sin()).sum();
        let part = 2.0 * sum / per as f64;
        if id == "maxwell-element" { -part } else { part - 1.0 }
    };
    for id in ["maxwell-element", "viscoelastic-stiffening"] {
        for reduced in [0.1, 1.0 / 3.0, 1.0, 3.0, 10.0, 100.0] {
            let theory = reduced * reduced / (1.0 + reduced * reduced);
            let found = storage(id, reduced);
            assert!((found - theory).abs() < 2e-3, "{id} at {reduced}: {found}, not {theory}");
        }
        let (around, above) =
            (storage(id, 3.0) - storage(id, 1.0 / 3.0), storage(id, 100.0) - storage(id, 10.0));
        assert!(around > 0.79 && above < 0.02, "{id}: {around}, {above}");
        let says = find(id).unwrap().signature;
        assert!(!says.contains("logarithm") && says.contains("once"), "{id}: {says}");
    }
}

/// From rest, Bouc and Wen's z = 1 - exp(-x / x_0); after a turn at 1 it first falls straight to 0: only the way from rest
/// builds up 63 %.
#[test]
fn what_a_length_is_said_to_be_is_what_it_is() {
    let way = |points: &[f64]| {
        let points: Vec<_> = points.iter().map(|x| (1.0, 0.0, [*x, 0.0, 0.0])).collect();
        -run(find("bouc-wen").unwrap(), &[1.0, 0.1], &points).last().unwrap()
    };
    assert!((way(&[0.0, 0.1]) - (1.0 - (-1.0_f64).exp())).abs() < 1e-12);
    assert!(way(&[0.0, 10.0, 9.9]).abs() < 1e-12);
    let says = find("bouc-wen").unwrap().parameters[1].description;
    assert!(says.contains("from rest"), "{says}");
}
