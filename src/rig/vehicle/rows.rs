//! The variables of the vehicle.

use super::lever_arms::LeverArms;
use super::told::{Bearing, Front, Rear};
use super::{Actuation, Car, SIDES, Vehicle, WHEELS};
use crate::model::{Access, Lens, Purpose, Role, Table, input, local, output, parameter};
use crate::rig::hub::{self, SLIP_FLOOR, turning_rows};
use crate::road::RoadParameters;
use crate::tire::{Mounted, Tire, to_heading};
use crate::{lens, rated, real};
use nalgebra::Vector3;

const PREFIXES: [&str; WHEELS] = ["front_left.", "front_right.", "rear_left.", "rear_right."];

/// Slabs of 15 m with a drop.
const SLAB: f64 = 15.0;

impl<T: Tire> Vehicle<T> {
    #[rustfmt::skip] // a row is a line
    pub(super) fn table() -> Table<Self> {
        let whole = || Lens::new(|m: &Self| m, |m: &mut Self| m);
        let mut table = Table::new([
            input("steering_wheel_angle", "rad", rated!(steering), 0.0, "Angle of the steering wheel, positive to the left").range(-50.0, 50.0).role(Role::SteerAngle),
        ]);
        for (i, prefix) in PREFIXES.into_iter().enumerate() {
            table = table.part(prefix, whole(), Self::wheel_inputs(i));
        }
        table = table.and([
            input("front_drive_torque", "N.m", real!(drives[0]), 0.0, "Torque of the drive on both front wheels together").range(-1e5, 1e5).nominal(100.0),
            input("rear_drive_torque", "N.m", real!(drives[1]), 0.0, "Torque of the drive on both rear wheels together").range(-1e5, 1e5).nominal(100.0),
            output("vehicle_speed", "m/s", Access::computed(|m: &Self| m.speed()[0]), "Speed of the body's centre of mass in its heading").role(Role::TravelSpeed),
            output("vehicle_speed_left", "m/s", Access::computed(|m: &Self| m.speed()[1]), "Its speed to the left").role(Role::Velocity),
            output("vehicle_distance", "m", Access::computed(|m: &Self| m.body.motion.position.x - m.start_x()), "Way along x since the start").role(Role::TravelDistance),
            output("vehicle_aside", "m", real!(body.motion.position.y), "How far the body's centre of mass is to the left of the line of the start").role(Role::Position),
            output("longitudinal_acceleration", "m/s2", Access::computed(|m: &Self| m.acceleration().x), "Acceleration of the body's centre of mass, horizontal, in its heading").role(Role::Acceleration),
            output("lateral_acceleration", "m/s2", Access::computed(|m: &Self| m.acceleration().y), "The same to its left").role(Role::Acceleration),
            output("vertical_acceleration", "m/s2", Access::computed(|m: &Self| m.acceleration().z), "The same upward").role(Role::Acceleration),
            output("body_height", "m", Access::computed(|m: &Self| m.body.motion.position.z - m.standing), "Height of the body's centre of mass over that where the vehicle stands").role(Role::Position),
            output("roll", "rad", real!(body.motion.angles.x), "Roll of the body, positive to the right").role(Role::Position),
            output("pitch", "rad", real!(body.motion.angles.y), "Pitch of the body, positive nose down").role(Role::Position),
            output("yaw", "rad", real!(body.motion.angles.z), "Yaw angle of the body, positive to the left").role(Role::Position),
            output("yaw_rate", "rad/s", real!(body.motion.rates.z), "Its rate").role(Role::Velocity),
            output("rack_displacement", "m", real!(front.rack.way), "Way of the rack to the left").role(Role::Position),
            output("column_force", "N", real!(front.rack.column), "Force of column and driver on the rack, to the left").nominal(1000.0).role(Role::Force),
        ]);
        let [fl, fr, rl, rr] = PREFIXES;
        for (i, prefix) in PREFIXES.into_iter().enumerate() {
            table = table
                .part(prefix, lens!(wheels[i]), Mounted::rows().without_parameters())
                .part(prefix, lens!(spins[i]), turning_rows())
                .part(prefix, whole(), Self::wheel_outputs(i))
                .part(prefix, lens!(told.wheels[i]), Bearing::rows());
        }
        table
            .part(fl, lens!(told.front[0]), Front::rows())
            .part(fr, lens!(told.front[1]), Front::rows())
            .part(rl, lens!(told.rear[0]), Rear::rows())
            .part(rr, lens!(told.rear[1]), Rear::rows())
            .and([
                output("brake_energy", "J", Access::computed(|m: &Self| m.brake_energy()), "Energy that the brakes turned into heat since the start").nominal(1e4),
                output("friction_energy", "J", Access::computed(|m: &Self| m.friction_energy()), "Energy lost in the contacts since the start").nominal(1e4),
                output("tire_energy", "J", real!(taken.tires), "Energy that the tires took from the rims since the start: friction, rolling resistance, and what they hold").nominal(1e4),
                output("damper_energy", "J", real!(taken.dampers), "Energy that dampers, bushings, coupling and rack turned into heat since the start").nominal(100.0),
                output("air_energy", "J", real!(taken.air), "Energy that the air took since the start").nominal(1e3),
            ])
            .and([
                local("front_trail", "m", Access::computed(|m: &Self| m.lever_arms().trail), "The steering axis meets the road so far before a front wheel's centre, where the vehicle stands: n_k (6.17)"),
                local("front_lever_arm_lateral", "m", Access::computed(|m: &Self| m.lever_arms().lateral), "Lever arm of the lateral force about the steering axis, without the tire's own trail: r_SK (6.18)"),
                local("front_lever_arm_brake", "m", Access::computed(|m: &Self| m.lever_arms().longitudinal), "Lever arm of the braking force about the steering axis: r_B (6.21)"),
                local("front_lever_arm_load", "m", Access::computed(|m: &Self| m.lever_arms().vertical), "Lever arm of the wheel load about the steering axis: r_RL (6.26), with cos where the source prints cos²"),
            ])
            .part("", lens!(car), Car::rows())
            .and([
                parameter("initial_speed", "m/s", real!(initial_speed), 80.0 / 3.6, "Speed at the start; the wheels roll freely").range(-100.0, 100.0).purpose(Purpose::Start),
                parameter("step_size", "s", real!(step_size), if T::STEP > 5e-4 { 5e-4 } else { T::STEP }, "Step of the model's own time grid").range(1e-7, 1e-3).purpose(Purpose::Numerics).role(Role::Step),
            ])
            .part("", lens!(actuation), Actuation::rows())
            .part("front_tire.", lens!(tires[0]), T::rows().only_parameters())
            .part("rear_tire.", lens!(tires[1]), T::rows().only_parameters())
            .part("", lens!(road_parameters), RoadParameters::rows()
                .with("road_track_width", |row| row.start(1.49))
                .with("road_length", |row| row.start(SLAB)))
            .without_derivatives_if(T::RIPPLES)
    }

    #[rustfmt::skip] // a row is a line
    fn wheel_inputs(i: usize) -> Table<Self> {
        let brake = Access::real_with(move |m: &Self| m.brakes[i], move |m, torque| m.brakes[i] = torque);
        let friction = Access::real_with(move |m: &Self| m.friction[i], move |m, factor| m.friction[i] = factor);
        Table::new([
            input("brake_torque", "N.m", brake, 0.0, "Torque with which the brake can resist the spin, in either direction; a wheel that stands is held").range(0.0, 1e5).nominal(100.0),
            input("friction_factor", "1", friction, 1.0, "Factor on the friction between tire and road, over the road's own").range(0.0, 10.0),
        ])
    }

    #[rustfmt::skip] // a row is a line
    fn wheel_outputs(i: usize) -> Table<Self> {
        Table::new([
            output("slip", "1", Access::computed_with(move |m: &Self| m.slip(i)), "Longitudinal slip, (rolling radius times spin speed - v) / |v| with the speed v of the wheel's centre in its heading (below 0.1 m/s, over 0.1 m/s); a locked wheel is -1 forward, +1 in reverse").role(Role::Slip),
            output("slip_angle", "rad", Access::computed_with(move |m: &Self| m.slip_angle(i)), "Angle from the wheel's heading to its centre's velocity, positive where it travels to its left").role(Role::SlipAngle),
            output("steer_angle", "rad", Access::computed_with(move |m: &Self| m.carriers[i].motion.angles.z - m.body.motion.angles.z), "Angle from the body's heading to that of the wheel, positive to the left").role(Role::SteerAngle),
            output("camber", "rad", Access::computed_with(move |m: &Self| -SIDES[i] * m.carriers[i].motion.angles.x), "Camber to the horizontal plane, positive outward at the top").role(Role::Camber),
            output("brake_torque_actual", "N.m", Access::computed_with(move |m: &Self| m.spins[i].brake_torque), "Torque with which the brake resisted the forward spin in the last step; on a wheel that stands, what it takes to hold it").nominal(100.0),
            output("wheel_travel", "m", Access::computed_with(move |m: &Self| m.travel(i).z), "Way of the wheel's centre up in the body from where the vehicle stands").role(Role::Position),
            output("wheel_fore_aft", "m", Access::computed_with(move |m: &Self| m.travel(i).x), "The same forward").role(Role::Position),
        ])
    }

    /// Way of a wheel's centre in the body from where the vehicle stands, in the body's axes \[m\].
    fn travel(&self, i: usize) -> Vector3<f64> {
        let body = &self.body.motion;
        let from_body = self.carriers[i].motion.position - body.position;
        body.rotation().transpose() * from_body - self.places[i]
    }

    /// Speed of the body's centre of mass in its heading and to the left \[m/s\].
    fn speed(&self) -> [f64; 2] {
        let body = &self.body.motion;
        let speed = to_heading(body.angles.z, &body.velocity);
        [speed.x, speed.y]
    }

    fn acceleration(&self) -> Vector3<f64> {
        to_heading(self.body.motion.angles.z, &self.body.acceleration)
    }

    /// x of the body's centre of mass at the start: the front axle is at 0.
    fn start_x(&self) -> f64 {
        -self.places[0].x
    }

    /// Lever arms of a front wheel where the vehicle stands, with forces that attack below the wheel's centre.
    fn lever_arms(&self) -> LeverArms {
        self.car.front.mcpherson.axis().lever_arms(self.standing + self.places[0].z, 0.0, 0.0)
    }

    fn slip(&self, i: usize) -> f64 {
        let (wheel, motion) = (&self.wheels[i], &self.carriers[i].motion);
        let over = motion.position.z
            - self.road.mean(wheel.tire.window(), motion.position.x, motion.position.y).height;
        let rolling = wheel.tire.rolling_radius(wheel.tire.radius() - over);
        hub::slip(rolling * self.spins[i].speed, to_heading(motion.angles.z, &motion.velocity).x, SLIP_FLOOR)
    }

    fn slip_angle(&self, i: usize) -> f64 {
        let motion = &self.carriers[i].motion;
        let speed = to_heading(motion.angles.z, &motion.velocity);
        hub::slip_angle(speed.x, speed.y, SLIP_FLOOR)
    }
}
