//! Any tire on any rig: a tire of twenty lines, and the Magic Formula against what its equations say.
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use latsch::Result;
use latsch::model::{Model, Native, Settings, Slave, Table, local, parameter};
use latsch::real;
use latsch::rig::{Bare, Corner, FlatTrack, RingBrushCorner, RingBrushWheel, Wheel};
use latsch::road::{Road, Window};
use latsch::tire::magic_formula::{
    Coefficients, Input, MagicFormula, effective_rolling_radius, steady, vertical_force,
};
use latsch::tire::ring_brush::RingBrush;
use latsch::tire::{Ground, Link, Motion, Plane, Rest, Tire, Vertical, Wrench};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

type Run<M> = common::Run<Native<M>>;

/// A ball on a spring that slides without friction: radius 0.3 m.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
struct Ball {
    stiffness: f64,
    window: Window,
    force: Vector3<f64>,
    /// Height of the road 0.1 m before and 0.2 m to the right of the wheel, and its friction: what a tire with more than
    /// one contact point asks for.
    beside: [f64; 2],
}

impl Tire for Ball {
    const NAME: &'static str = "ball";
    const TITLE: &'static str = "Ball";
    type Inside = ();

    fn rows() -> Table<Self> {
        Table::new([
            parameter("spring", "N/m", real!(stiffness), 2e5, "Stiffness").range(1.0, 1e9),
            local("beside", "m", real!(beside[0]), "Height beside the wheel"),
            local("friction_beside", "1", real!(beside[1]), "Friction beside the wheel"),
        ])
    }
    fn mount(&mut self, road: &Road) -> Result<()> {
        self.window = road.window(0.0)?;
        Ok(())
    }
    fn share_parameters(&mut self, of: &Self) {
        self.stiffness = of.stiffness;
    }
    fn radius(&self) -> f64 {
        0.3
    }
    fn rolling_radius(&self, _: f64) -> f64 {
        0.3
    }
    fn window(&self) -> &Window {
        &self.window
    }
    fn gravity(&self) -> f64 {
        9.81
    }
    fn links(&self) -> [Link; 3] {
        let link = |stiffness| Link { stiffness, damping: ("none", 0.0), mass: ("the road", f64::INFINITY) };
        [link(("spring", self.stiffness)), link(("none", 0.0)), link(("none", 0.0))]
    }
    fn stationary(&self, _: &Motion<f64>, vertical: Vertical, _: f64) -> Result<Rest<()>> {
        let (rim_height, load) = match vertical {
            Vertical::Height(height) => (height, self.stiffness * (0.3 - height).max(0.0)),
            Vertical::Load(load) => (0.3 - load / self.stiffness, load),
        };
        let force = Vector3::new(0.0, 0.0, load);
        Ok(Rest { rim_height, on_rim: Wrench { force, ..Wrench::default() }, inside: () })
    }
    fn begin(&mut self, _: &Rest<()>, rim: &Motion<f64>, _: &Plane, ground: &impl Ground) -> Result<()> {
        self.step(rim, rim, ground, 0.0)
    }
    fn step(&mut self, _: &Motion<f64>, rim: &Motion<f64>, ground: &impl Ground, _: f64) -> Result<()> {
        let plane = ground.plane(rim, &self.window, 1.0);
        let load = self.stiffness * (0.3 - plane.clearance).max(0.0);
        self.force = plane.rotation() * Vector3::new(0.0, 0.0, load);
        let point = ground.point(0.1, -0.2, 1.0);
        self.beside = [point.height, point.friction];
        Ok(())
    }
    fn on_rim(&self) -> Wrench<f64> {
        Wrench { force: self.force, ..Wrench::default() }
    }
    fn energy_loss(&self) -> f64 {
        0.0
    }
}

/// A hub of mass m on a spring k, kicked down by v, swings with k / m; on a grade s it runs down with g s; the rigs are
/// called by the tire.
#[test]
fn a_tire_of_twenty_lines_fits_every_rig() {
    let names = [Bare::<Ball>::NAME, FlatTrack::<Ball>::NAME, Wheel::<Ball>::NAME, Corner::<Ball>::NAME];
    assert_eq!(names, ["ball-tire", "ball-flat-track", "ball-wheel", "ball-corner"]);

    let mut bare = Run::<Bare<Ball>>::new(&[
        ("rim_z", 0.29),
        ("road_slope_x", 0.1),
        ("road_slope_y", 0.0),
        ("friction_factor", 0.7),
    ]);
    // the plane through the origin, at a point of it
    assert!((bare.get("beside") - 0.01).abs() < 1e-15 && bare.get("friction_beside") == 0.7);
    // the plane is 0.29 m below measured vertically, so 0.29 cos below measured along its normal
    let cos = 1.0 / 1.01_f64.sqrt();
    let load = 2e5 * (0.3 - 0.29 * cos);
    assert!((bare.get("force_z") - load * cos).abs() < 1e-9);
    assert!((bare.get("force_x") + load * 0.1 * cos).abs() < 1e-9);

    // a cleat on the right track, friction of its own on the road; the wheel is 0.8 m to the right of the middle
    let mut rig = Run::<FlatTrack<Ball>>::new(&[
        ("deflection", 0.012),
        ("friction_factor", 0.5),
        ("road_kind", 4.0),
        ("road_start", 0.05),
        ("road_length", 0.1),
        ("road_height", 0.02),
        ("road_tracks", 3.0),
        ("road_lateral_position", -0.8),
    ]);
    assert_eq!((rig.get("beside"), rig.get("friction_beside")), (0.02, 0.5));
    assert!((rig.get("force_z") - 2400.0).abs() < 1e-9);

    let mut wheel = Run::<Wheel<Ball>>::new(&[("initial_load", 4094.3), ("axle_force_z", -3800.0)]);
    assert!((wheel.get("position_z") - (0.3 - 4094.3 / 2e5)).abs() < 1e-12);
    wheel.set("axle_force_z", -3900.0);
    let (omega, time) = ((2e5_f64 / 30.0).sqrt(), 0.01);
    let before = wheel.get("position_z");
    wheel.step(time);
    // a held force acts from the end of the first step on, as that of a whole step does from its middle
    let expected = -100.0 / 2e5 * (1.0 - (omega * (time - 0.5e-4)).cos());
    assert!((wheel.get("position_z") - before - expected).abs() < 1e-3 * expected.abs());

    let mut corner = Run::<Corner<Ball>>::new(&[
        ("road_kind", 3.0),
        ("road_start", -1.0),
        ("road_length", 1000.0),
        ("road_height", 1.0),
    ]);
    // the momentum of the vehicle with its wheel, of which each part swings in the guidance
    let momentum =
        |run: &mut Run<Corner<Ball>>| 380.0 * run.get("vehicle_speed") + 40.0 * run.get("wheel_velocity_x");
    let before = momentum(&mut corner);
    corner.step(1.0);
    let lost = before - momentum(&mut corner);
    // all of the vehicle is on the grade of 1 in 1000, which carries it and lifts it to its own slope
    let expected = 420.0 * (9.81 + 1e-3 * 27.8) * 1e-3;
    assert!((lost - expected).abs() < 1e-3 * lost, "{lost} {expected}");
}

fn formula(rig: &Native<FlatTrack<MagicFormula>>) -> Coefficients {
    rig.model().tire().law.coefficients.clone()
}

/// At rest behind its relaxation the flat track measures what the equations say at the slips that the rig imposes: there
/// is no other force.
#[test]
fn the_flat_track_measures_the_formula_at_the_commanded_slips() {
    for (deflection, slip, angle, camber, speed, friction) in [
        (0.02, 0.0, 0.0, 0.0, 10.0, 1.0),
        (0.01, 0.03, 0.0, 0.0, 20.0, 1.0),
        (0.02, 0.0, 0.05, 0.0, 20.0, 0.7),
        (0.025, -0.1, -0.08, 0.0, 5.0, 1.0),
        (0.02, -0.02, 0.03, 0.05, 15.0, 1.0),
        (0.02, 0.02, -0.03, -0.04, -12.0, 0.5),
    ] {
        let mut rig = Run::<FlatTrack<MagicFormula>>::new(&[
            ("deflection", deflection),
            ("slip", slip),
            ("slip_angle", angle),
            ("camber", camber),
            ("path_speed", speed),
            ("friction_factor", friction),
        ]);
        rig.step(0.5);
        let c = formula(&rig.slave);
        let loaded = (c.unloaded_radius - deflection) / camber.cos();
        let fz = vertical_force(&c, c.unloaded_radius - loaded, 0.0);
        // what the wheel spins with and how its contact point slides
        let (along, aside) = (speed * angle.cos(), speed.abs() * angle.sin());
        let level = vertical_force(&c, deflection, 0.0);
        let spin = (along + slip * along.abs()) / effective_rolling_radius(&c, level);
        let kappa = (effective_rolling_radius(&c, fz) * spin - along) / along.abs();
        let alpha = (aside / along.abs()).atan();
        let input = Input { fz, kappa, alpha, gamma: camber, vx: along, friction };
        let f = steady(&c, &input);
        // from the contact point to the wheel's centre, by hand: r = (0, R sin, -R cos)
        let (y, z) = (loaded * camber.sin(), -loaded * camber.cos());
        let moment = [f.mx + y * fz - z * f.fy, f.my + z * f.fx, f.mz - y * f.fx];
        let names = ["force_x", "force_y", "force_z", "moment_x", "moment_y", "moment_z"];
        for (name, expected) in names.iter().zip([f.fx, f.fy, fz].into_iter().chain(moment)) {
            let got = rig.get(name);
            assert!(
                (got - expected).abs() < 1e-8 * fz,
                "{name}: {got} {expected} at {slip} {angle} {camber}"
            );
        }
        assert_eq!(rig.get("outside_range"), 0.0);
    }
}

/// A step of a small slip angle reaches 1 - exp(-s / sigma) of its force after the way s.
#[test]
fn the_lateral_force_follows_over_the_relaxation_length() {
    for speed in [5.0, 20.0] {
        let mut rig =
            Run::<FlatTrack<MagicFormula>>::new(&[("path_speed", speed), ("command_actuators", 0.0)]);
        rig.step(0.1);
        let sigma = rig.get("relaxation_length_y");
        rig.set("slip_angle", 1e-4);
        rig.step(0.5 * sigma / speed);
        let early = rig.get("force_y");
        rig.step(20.0 * sigma / speed);
        let share = early / rig.get("force_y");
        assert!((share - (1.0 - (-0.5_f64).exp())).abs() < 2e-3, "{share}");
    }
}

/// A wheel that starts free of torque keeps its spin, and a corner that locks it stops with the friction of a locked wheel.
#[test]
fn a_free_wheel_stays_free_and_a_locked_one_slides() {
    let mut wheel = Run::<Wheel<MagicFormula>>::new(&[("axle_force_z", -3805.7)]);
    assert_eq!(wheel.get("stationary_start"), 1.0);
    assert!(wheel.get("force_x") < 0.0, "rolling resistance brakes");
    wheel.step(0.2);
    // the axle does not pull: force_x slows the hub, and, once the relaxation is over, the spin with it
    let (speed, pull) = (wheel.get("wheel_speed"), wheel.get("force_x"));
    wheel.step(0.02);
    let change =
        (wheel.get("wheel_speed") - speed) / 0.02 * wheel.get("velocity_x") / wheel.get("wheel_speed");
    assert!((change - pull / 30.0).abs() < 0.01 * (pull / 30.0).abs(), "{change} {pull}");

    let mut corner = Run::<Corner<MagicFormula>>::new(&[("brake_torque", 9000.0)]);
    corner.step(1.0);
    assert_eq!(corner.get("wheel_speed"), 0.0);
    let c = corner.slave.model().mounted().tire.law.coefficients.clone();
    let fz = corner.get("force_z");
    let input =
        Input { fz, kappa: -1.0, alpha: 0.0, gamma: 0.0, vx: corner.get("vehicle_speed"), friction: 1.0 };
    let locked = steady(&c, &input).fx;
    let braked = corner.get("vehicle_acceleration") * 420.0;
    assert!((braked - locked).abs() < 0.01 * locked.abs(), "{braked} {locked}");
    // it stops, swings on the spring of its tire, and stays
    corner.step(20.0);
    assert!(corner.get("vehicle_speed").abs() < 1e-3, "{}", corner.get("vehicle_speed"));
    let distance = corner.get("vehicle_distance");
    corner.step(5.0);
    assert!((corner.get("vehicle_distance") - distance).abs() < 1e-4);
}

/// A braked wheel at rest that is pulled with less than its friction stands on the spring of its tire.
#[test]
fn a_braked_wheel_holds_against_a_pull() {
    let mut wheel = Run::<Wheel<MagicFormula>>::new(&[
        ("initial_speed", 0.0),
        ("brake_torque", 5000.0),
        ("axle_force_z", -3805.7),
    ]);
    for (axis, force, sign) in [("x", 1500.0, 1.0), ("y", 1500.0, 1.0)] {
        wheel.set(&format!("axle_force_{axis}"), force);
        wheel.step(3.0);
        let held = wheel.get(&format!("force_{axis}"));
        assert!((held + sign * force).abs() < 1.0, "{axis}: {held}");
        let place = wheel.get(&format!("position_{axis}"));
        assert!(place > 1e-4 && place < 0.02, "{axis}: {place}");
        wheel.step(10.0);
        assert!((wheel.get(&format!("position_{axis}")) - place).abs() < 1e-6, "{axis} creeps");
        wheel.set(&format!("axle_force_{axis}"), 0.0);
        wheel.step(3.0);
    }
    wheel.set("axle_force_x", 9000.0);
    wheel.step(1.0);
    assert!(wheel.get("velocity_x") > 10.0, "more than its friction moves it");
}

/// What goes to the left and what goes to the right are mirror images, for a tire without plysteer and conicity.
#[test]
fn left_and_right_are_mirror_images() {
    let mut runs = [1.0, -1.0].map(|side| {
        let mut wheel = Run::<Wheel<MagicFormula>>::new(&[("axle_force_z", -3805.7)]);
        wheel.set("steer", side * 0.03);
        wheel.set("camber", side * 0.02);
        wheel.set("axle_force_y", side * 200.0);
        wheel
    });
    for _ in 0..20 {
        let [left, right] = runs.each_mut().map(|run| {
            run.step(0.02);
            ["force_x", "force_y", "force_z", "moment_x", "moment_y", "moment_z", "position_y"]
                .map(|n| run.get(n))
        });
        for (i, odd) in [false, true, false, true, false, true, true].into_iter().enumerate() {
            let mirrored = if odd { -right[i] } else { right[i] };
            assert!(
                (left[i] - mirrored).abs() <= 1e-9 * (1.0 + left[i].abs()),
                "{i}: {} {}",
                left[i],
                right[i]
            );
        }
    }
}

/// A start without a stationary state is told, or refused where the user wants none but stationary starts: a wheel that
/// spins where it stands deflects its tire without end.
#[test]
fn a_start_that_is_not_stationary_is_told_or_refused() {
    let start = |strict: f64| {
        let mut slave = Native::<Bare<MagicFormula>>::new(&Settings::default()).unwrap();
        common::set(&mut slave, &[("rim_velocity_x", 0.0), ("rim_spin_rate", 30.0)]);
        common::set(&mut slave, &[("only_stationary_start", strict)]);
        slave.start(0.0, None).unwrap();
        (slave.finish_start(), slave)
    };
    let (result, mut slave) = start(0.0);
    result.unwrap();
    assert_eq!(common::get(&mut slave, "stationary_start"), 0.0);
    assert!(slave.warning().unwrap().contains("rolling straight and free"));
    let message = start(1.0).0.unwrap_err().to_string();
    assert!(message.contains("slip is infinite") && message.contains("only_stationary_start"), "{message}");
}

/// Energy of hub and vehicle: what comes in through the rim, the drive, the brake and from outside is what they have.
#[test]
fn the_mechanics_of_wheel_and_corner_balance_with_every_tire() {
    fn corner<T: Tire>(step: f64) -> (f64, f64) {
        let mut run = Run::<Corner<T>>::new(&[
            ("step_size", step),
            ("initial_speed", 15.0),
            ("bump_stop_gap", 0.005),
            ("bump_stop_stiffness", 4e7),
            ("road_kind", 5.0),
            ("road_start", 0.2),
            ("road_length", 1.3),
            ("road_height", 0.01),
        ]);
        let energy = |run: &Run<Corner<T>>| run.slave.model().energy();
        let power = |run: &mut Run<Corner<T>>, t: f64| {
            let wheel = run.get("wheel_speed");
            let rim = run.get("force_x") * run.get("wheel_velocity_x")
                + run.get("force_z") * run.get("wheel_velocity_z")
                + run.get("moment_y") * wheel;
            let [x, z, drive] = outside(t);
            rim + drive * wheel + x * run.get("vehicle_speed") + z * run.get("body_velocity_z")
        };
        let (start, mut work, mut most) = (energy(&run), 0.0, 0.0_f64);
        let mut before = power(&mut run, 0.0);
        let steps = (0.4 / step).round() as usize;
        for k in 1..=steps {
            let t = k as f64 * step;
            let [x, z, drive] = outside(t);
            run.set("body_force_x", x);
            run.set("body_force_z", z);
            run.set("drive_torque", drive);
            run.set("brake_torque", 800.0 * t);
            run.step(step);
            let now = power(&mut run, t);
            work += 0.5 * step * (before + now);
            before = now;
            most = most.max((energy(&run) - start).abs());
        }
        let heat = run.get("brake_energy") + run.get("damper_energy");
        (energy(&run) - start - work + heat, most)
    }
    fn outside(t: f64) -> [f64; 3] {
        [300.0 * (9.0 * t).sin(), 1500.0 * (20.0 * t).sin(), 100.0 * (7.0 * t).sin()]
    }
    fn wheel<T: Tire>(step: f64) -> (f64, f64) {
        let mut run = Run::<Wheel<T>>::new(&[("step_size", step), ("initial_speed", 15.0)]);
        let energy = |run: &Run<Wheel<T>>| run.slave.model().energy();
        let power = |run: &mut Run<Wheel<T>>, t: f64| {
            let [x, z, drive] = outside(t);
            let axle = [x, 0.2 * x, z - 3800.0];
            let mut sum = (run.get("moment_y") + drive) * run.get("wheel_speed");
            for (axis, axle) in ["x", "y", "z"].iter().zip(axle) {
                sum += (run.get(&format!("force_{axis}")) + axle) * run.get(&format!("velocity_{axis}"));
            }
            sum
        };
        let (start, mut work, mut most) = (energy(&run), 0.0, 0.0_f64);
        let mut before = power(&mut run, 0.0);
        for k in 1..=(0.4 / step).round() as usize {
            let t = k as f64 * step;
            let [x, z, drive] = outside(t);
            let inputs = [
                ("axle_force_x", x),
                ("axle_force_y", 0.2 * x),
                ("axle_force_z", z - 3800.0),
                ("drive_torque", drive),
                ("brake_torque", 800.0 * t),
            ];
            common::set(&mut *run.slave, &inputs);
            run.step(step);
            let now = power(&mut run, t);
            work += 0.5 * step * (before + now);
            before = now;
            most = most.max((energy(&run) - start).abs());
        }
        (energy(&run) - start - work + run.get("brake_energy"), most)
    }
    for run in [corner::<MagicFormula>, corner::<RingBrush>, wheel::<MagicFormula>, wheel::<RingBrush>] {
        let ((coarse, most), (fine, _)) = (run(2e-4), run(1e-4));
        assert!(most > 500.0, "{most}");
        assert!(fine.abs() < 2e-4 * most && fine.abs() < coarse.abs(), "{coarse} {fine} of {most} J");
    }
}

/// Both tires on both vehicles start where the load says.
#[test]
fn rigs_carry_their_load() {
    let mut force = Vec::new();
    let mut run = Run::<RingBrushCorner>::new(&[]);
    force.push(run.get("force_z"));
    let mut run = Run::<Corner<MagicFormula>>::new(&[]);
    force.push(run.get("force_z"));
    for f in force {
        // the search for the spin leaves the load to its tolerance
        assert!((f - 420.0 * 9.81).abs() < 2e-5 * f, "{f}");
    }
    let mut run = Run::<RingBrushWheel>::new(&[("initial_load", 3000.0)]);
    assert!((run.get("force_z") - 3000.0).abs() < 2e-5 * 3000.0);
}
