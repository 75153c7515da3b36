//! The car's front axle in a rig: `axle`. Forces and moments of the wheels on their carriers come in, as measuring rims record them
//! on the road; forces in links, struts and tie rods go out, which nobody could measure.

use super::axle::Axle;
use super::front::{FrontAxle, FrontParameters};
use super::told::{Bearing, Front};
use super::{Actuation, Actuator, Command, SIDES, modes};
use crate::mechanics::{Body, Motion, Pose, Response, RigidBody, Wrench, rotation_z};
use crate::model::{Access, Lens, Model, Purpose, Role, Table, input, output, parameter};
use crate::{Error, Result, clone_in_place, lens, rated, real};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

const PREFIXES: [&str; 2] = ["left.", "right."];

/// The model.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct AxleRig {
    steering: Command,
    /// Force and moment of the wheels on their carriers, H axes.
    forces: [Vector3<f64>; 2],
    moments: [Vector3<f64>; 2],
    /// Acceleration of the body \[m/s²\], in its axes.
    carried: Vector3<f64>,
    gravity: f64,
    actuation: Actuation,
    steered: Actuator,
    parameters: FrontParameters,
    /// Height of the wheels' centres \[m\].
    height: f64,
    front: FrontAxle,
    carriers: [Body; 2],
    places: [Vector3<f64>; 2],
    told: [Front; 2],
    step_size: f64,
}

clone_in_place!(AxleRig {
    steering,
    forces,
    moments,
    carried,
    gravity,
    actuation,
    steered,
    parameters,
    height,
    front,
    carriers,
    places,
    told,
    step_size,
});

impl Model for AxleRig {
    const NAME: &'static str = "axle";
    const DESCRIPTION: &'static str = "McPherson front axle in a rig: forces and moments of the wheels on their carriers in; forces of links, struts and tie rods out (ISO 8855 signs)";
    const STOP_TIME: f64 = 10.0;
    const DOCUMENTATION: &'static [&'static str] = &[include_str!("axle_rig.html")];

    #[rustfmt::skip] // a row is a line
    fn variables() -> Table<Self> {
        let whole = || Lens::new(|m: &Self| m, |m: &mut Self| m);
        let mut table = Table::new([
            input("steering_wheel_angle", "rad", rated!(steering), 0.0, "Angle of the steering wheel, positive to the left").range(-50.0, 50.0).role(Role::SteerAngle),
        ]);
        for (i, prefix) in PREFIXES.into_iter().enumerate() {
            table = table.part(prefix, whole(), Self::given(i));
        }
        table = table.and([
            input("body_acceleration_x", "m/s2", real!(carried.x), 0.0, "Acceleration of the body, forward: carriers have it too").range(-1e4, 1e4).role(Role::Acceleration),
            input("body_acceleration_y", "m/s2", real!(carried.y), 0.0, "The same to the left").range(-1e4, 1e4).role(Role::Acceleration),
            input("body_acceleration_z", "m/s2", real!(carried.z), 0.0, "The same upward, without gravity").range(-1e4, 1e4).role(Role::Acceleration),
            output("rack_displacement", "m", real!(front.rack.way), "Way of the rack to the left").role(Role::Position),
            output("column_force", "N", real!(front.rack.column), "Force of column and driver on the rack, to the left").nominal(1000.0).role(Role::Force),
        ]);
        for (i, prefix) in PREFIXES.into_iter().enumerate() {
            table = table.part(prefix, lens!(told[i]), Front::rows()).part(prefix, whole(), Self::motions(i));
        }
        // the wheels are not here, what they do comes in
        let axle = Axle::rows().without("wheel_mass").without("wheel_inertia").without("wheel_transverse_inertia");
        table
            .part("", lens!(parameters), FrontParameters::rows_with(axle))
            .and([
                parameter("wheel_centre_height", "m", real!(height), 0.323, "Height of the wheels' centres over the road where the vehicle stands").range(0.05, 2.0).purpose(Purpose::Data),
                parameter("gravity", "m/s2", real!(gravity), 9.81, "Gravity").range(0.0, 100.0),
                parameter("step_size", "s", real!(step_size), 2e-4, "Step of the model's own time grid").range(1e-7, 1e-3).purpose(Purpose::Numerics).role(Role::Step),
            ])
            .part("", lens!(actuation), Actuation::rows())
    }

    fn step_size(&self) -> f64 {
        self.step_size
    }

    fn initialize(&mut self) -> Result<()> {
        self.parameters.prepare()?;
        self.front = FrontAxle::default();
        self.steered = Actuator::at_rest(&self.steering);
        let body = Pose::from(&Motion::default());
        for (i, side) in SIDES.into_iter().enumerate().take(2) {
            let axle = &self.parameters.axle;
            let motion = Motion {
                position: Vector3::new(0.0, 0.5 * side * axle.track, self.height),
                angles: Vector3::new(-side * axle.camber, 0.0, -side * axle.toe),
                ..Motion::default()
            };
            self.carriers[i] = Body::moving(motion);
            self.places[i] = motion.position;
            let loads = self.loads(i, &motion, Wrench::default());
            self.front.hang(i, &self.parameters, [&body, &Pose::from(&motion)], &loads)?;
        }
        let carriers = self.carriers.each_ref().map(|carrier| carrier.motion);
        self.accelerate(&carriers, 0.0);
        self.check_steps()
    }

    fn tune(&mut self) -> Result<()> {
        self.parameters.prepare()?;
        self.front.sides.iter_mut().for_each(|side| side.tune(&self.parameters.mcpherson));
        self.check_steps()
    }

    fn check(&self) -> Result<()> {
        match self.parameters.axle.springs.damper.is_whole() {
            true => Ok(()),
            false => Err(Error::numeric("the saved axle is damaged")),
        }
    }

    fn step(&mut self, length: f64) -> Result<()> {
        self.steered.follow(&self.steering, self.actuation.corner(), length);
        let carriers = self.carriers.each_mut().map(|carrier| carrier.drift(length));
        let rack_speed = self.front.rack.drift(length);
        self.accelerate(&carriers, rack_speed);
        self.carriers.iter_mut().for_each(|carrier| carrier.kick(length));
        self.front.rack.kick(length);
        if self.carriers.iter().all(Body::is_finite) {
            Ok(())
        } else {
            Err(Error::numeric("the axle's motion is no longer finite; a smaller step_size may help"))
        }
    }
}

impl AxleRig {
    #[rustfmt::skip] // a row is a line
    fn given(i: usize) -> Table<Self> {
        let force = |name, axis: usize, text| {
            let access = Access::real_with(move |m: &Self| m.forces[i][axis], move |m, value| m.forces[i][axis] = value);
            // what the car's wheel puts on its carrier where it stands
            let start = if axis == 2 { 2935.0 } else { 0.0 };
            input(name, "N", access, start, text).range(-1e6, 1e6).nominal(1000.0)
        };
        let moment = |name, axis: usize, text| {
            let access = Access::real_with(move |m: &Self| m.moments[i][axis], move |m, value| m.moments[i][axis] = value);
            input(name, "N.m", access, 0.0, text).range(-1e6, 1e6).nominal(100.0)
        };
        Table::new([
            force("carrier_force_x", 0, "Force of the wheel on its carrier at the wheel's centre, forward, H axes (6.11)").role(Role::LongitudinalForce),
            force("carrier_force_y", 1, "The same to the left (6.12)").role(Role::LateralForce),
            force("carrier_force_z", 2, "The same upward (6.13); at the start the vehicle stands under it").role(Role::Load),
            moment("carrier_moment_x", 0, "Moment of the wheel on its carrier about the wheel's centre, forward, H axes (6.14)").role(Role::Force),
            moment("carrier_moment_y", 1, "The same to the left (6.15)").role(Role::LongitudinalForce),
            moment("carrier_moment_z", 2, "The same upward (6.16)").role(Role::AligningMoment),
        ])
    }

    #[rustfmt::skip] // a row is a line
    fn motions(i: usize) -> Table<Self> {
        let travel = move |m: &Self, axis: usize| m.carriers[i].motion.position[axis] - m.places[i][axis];
        Table::new([
            output("steer_angle", "rad", Access::computed_with(move |m: &Self| m.carriers[i].motion.angles.z), "Angle from the body's heading to that of the wheel, positive to the left").role(Role::SteerAngle),
            output("camber", "rad", Access::computed_with(move |m: &Self| -SIDES[i] * m.carriers[i].motion.angles.x), "Camber, positive outward at the top").role(Role::Camber),
            output("wheel_travel", "m", Access::computed_with(move |m: &Self| travel(m, 2)), "Way of the wheel's centre up in the body from where the vehicle stands").role(Role::Position),
            output("wheel_fore_aft", "m", Access::computed_with(move |m: &Self| travel(m, 0)), "The same forward").role(Role::Position),
        ])
    }

    /// A carrier without its wheel.
    fn rigid(&self) -> RigidBody {
        let axle = &self.parameters.axle;
        RigidBody { mass: axle.carrier_mass, inertia: [axle.carrier_inertia; 3] }
    }

    /// What the wheel puts on its carrier, frame 0.
    fn on_carrier(&self, i: usize, motion: &Motion<f64>) -> Wrench<f64> {
        let axes = rotation_z(motion.angles.z);
        Wrench { force: axes * self.forces[i], moment: axes * self.moments[i] }
    }

    /// All loads on a carrier: from the joints, the wheel, and what gravity and the body's acceleration do to its mass.
    fn loads(&self, i: usize, motion: &Motion<f64>, joints: Wrench<f64>) -> Wrench<f64> {
        let mut loads = joints;
        loads += self.on_carrier(i, motion);
        loads.force -= (self.carried + Vector3::new(0.0, 0.0, self.gravity)) * self.rigid().mass;
        loads
    }

    fn accelerate(&mut self, carriers: &[Motion<f64>; 2], rack_speed: f64) {
        let body = Pose::from(&Motion::default());
        let poses = carriers.each_ref().map(Pose::from);
        let [left, right] = &poses;
        let front = self.front.act(&self.parameters, self.steered, &body, [left, right], rack_speed);
        self.told = front.told;
        let rigid = self.rigid();
        for (i, motion) in carriers.iter().enumerate() {
            let loads = self.loads(i, motion, front.on_carriers[i]);
            self.carriers[i].load(&rigid, &poses[i], &loads, 0.0);
            let (axis, ball_joint) = self.front.sides[i].steering_axis([&body, &poses[i]]);
            let bearing = Bearing::measured(&poses[i], &self.on_carrier(i, motion));
            self.told[i].about(&axis, &ball_joint, &bearing);
        }
    }

    fn check_steps(&self) -> Result<()> {
        let mut names: Vec<_> =
            ["left", "right"].iter().flat_map(|side| modes::names(&format!("the {side} carrier"))).collect();
        names.push(("the rack".into(), 1.0));
        let mut probe = self.clone();
        let response = Response::new(names.len(), |places, velocities| {
            let carriers = [0, 1]
                .map(|i| modes::moved(&self.carriers[i].motion, &places[6 * i..], &velocities[6 * i..]));
            probe.front.rack = self.front.rack;
            probe.front.rack.way += places[12];
            probe.accelerate(&carriers, self.front.rack.speed + velocities[12]);
            let mut all: Vec<f64> = probe.carriers.iter().flat_map(modes::accelerations).collect();
            all.push(probe.front.rack.acceleration);
            all
        });
        response.check(self.step_size, &names, |_| vec![0.0; names.len()])
    }
}
