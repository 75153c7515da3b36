//! Where the car rolls straight on at the start, all in balance.

use super::axle::{Corner, Guide, front, rear};
use super::parameters::{
    AIR, BODY_INERTIA, CARRIER_MASS, DRAG, GRAVITY, LIFT, Parameters, REAR_CARRIER_INERTIA, WHEELBASE,
};
use super::tire::{Footing, RADIUS, Tire};
use super::vector::{UP, Vector, v};
use super::vehicle::{Hub, Rigid, Vehicle, wheel_axes};

/// How often loads and slips are made to agree.
const ROUNDS: usize = 60;

/// A wheel that rolls on at the start: force and moment of its tire in space, spin and deflections.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Rolling {
    pub(crate) force: Vector,
    pub(crate) moment: Vector,
    pub(crate) spin: f64,
    pub(crate) deflections: [f64; 2],
}

/// A wheel with this axle that rolls along x without torque, its centre as high as told.
fn rolling(tire: &Tire, axle: Vector, height: f64, speed: f64, friction: f64) -> Rolling {
    let [ahead, aside, up] = wheel_axes(axle, UP);
    let camber = libm::asin(axle.dot(UP));
    let velocity = [speed * ahead.x(), speed * aside.x()];
    let mut footing = Footing { height, camber, sinking: 0.0, velocity, spin: 0.0, friction };
    let load = super::tire::VERTICAL.0 * (RADIUS - height / libm::cos(camber));
    let lengths = Tire::relaxation(load, camber);
    let radius = Tire::rolling(load);
    let mut slip = 0.0;
    let mut rolling = Rolling::default();
    for _ in 0..ROUNDS {
        footing.spin = (1.0 + slip) * velocity[0] / radius;
        let deflections = [slip * lengths[0], velocity[1] / velocity[0].abs() * lengths[1]];
        let told = tire.force(&footing, deflections);
        let out = |of: Vector| ahead * of.x() + aside * of.y() + up * of.z();
        let (force, moment) = (out(told.force), out(told.moment));
        rolling = Rolling { force, moment, spin: footing.spin, deflections };
        // 25 times the load is the stiffness over slip
        slip += moment.dot(axle) / (25.0 * load * height);
    }
    rolling
}

impl Vehicle {
    /// A car that rolls straight on with a speed on level road, with the forces that hold it.
    pub(crate) fn rolls(p: &Parameters, speed: f64, friction: [f64; 2]) -> Option<Self> {
        let wheel_mass = [p.front_wheel_mass, 20.0];
        let weight = p.vehicle_mass * GRAVITY;
        let pressure = 0.5 * AIR * speed * speed;
        let drag = pressure * DRAG;
        let centre = v(-p.centre_of_mass_x, 0.0, p.centre_of_mass_z);
        // loads of a wheel in front and behind
        let behind = p.centre_of_mass_x / WHEELBASE;
        let mut loads = [0.5 * weight * (1.0 - behind), 0.5 * weight * behind];
        let mut wheels = [Rolling::default(); 4];
        let mut heights = [0.0; 2];
        let mut brakes = 0.0;
        for _ in 0..ROUNDS {
            heights = loads.map(|load| Tire::height(load, super::parameters::CAMBER));
            let left = [front(p, heights[0])?, rear(p, heights[1])];
            let mut force = v(-drag, 0.0, pressure * (LIFT[0] + LIFT[1]) - weight);
            let mut pitch =
                -pressure * (LIFT[0] * p.centre_of_mass_x + LIFT[1] * (p.centre_of_mass_x - WHEELBASE));
            for (k, wheel) in wheels.iter_mut().enumerate() {
                let corner = if k % 2 == 0 { left[k / 2].clone() } else { left[k / 2].mirrored() };
                let grip = p.road_friction * friction[k % 2];
                *wheel = rolling(&p.tire, corner.axle, heights[k / 2], speed, grip);
                force += wheel.force;
                pitch += ((corner.centre - centre).cross(wheel.force) + wheel.moment).y();
            }
            brakes = force.x() / p.vehicle_mass;
            // what is missing upward, and of the moment that presses the nose down
            loads[0] += 0.5 * (-force.z() * (1.0 - behind) + pitch / WHEELBASE);
            loads[1] += 0.5 * (-force.z() * behind - pitch / WHEELBASE);
        }
        let mut corners = Vec::new();
        let left = [front(p, heights[0])?, rear(p, heights[1])];
        for (k, wheel) in wheels.iter().enumerate() {
            let mut corner = if k % 2 == 0 { left[k / 2].clone() } else { left[k / 2].mirrored() };
            let mass = wheel_mass[k / 2] + CARRIER_MASS;
            let along = corner.axle * corner.axle.dot(wheel.moment);
            corner.hold(wheel.force - v(brakes, 0.0, GRAVITY) * mass, wheel.moment - along)?;
            corners.push(corner);
        }
        Some(Self::assembled(p, &corners, wheels, speed))
    }

    fn assembled(p: &Parameters, corners: &[Corner], wheels: [Rolling; 4], speed: f64) -> Self {
        let hub = |k: usize| {
            if k < 2 {
                Hub {
                    wheel_mass: p.front_wheel_mass,
                    spin: p.front_wheel_inertia,
                    across: p.front_wheel_transverse_inertia,
                    carrier: p.front_carrier_inertia,
                }
            } else {
                Hub { wheel_mass: 20.0, spin: 0.9, across: 0.5, carrier: REAR_CARRIER_INERTIA }
            }
        };
        let mut mass = p.vehicle_mass;
        let mut moment = v(-p.centre_of_mass_x, 0.0, p.centre_of_mass_z) * mass;
        for (k, corner) in corners.iter().enumerate() {
            let own = hub(k).wheel_mass + CARRIER_MASS;
            mass -= own;
            moment -= corner.centre * own;
        }
        let centre = moment * (1.0 / mass);
        let onto = |corner: &Corner| {
            let mut joined = corner.clone();
            for link in &mut joined.links {
                link.ends = [link.ends[0] - centre, link.ends[1] - corner.centre];
            }
            let ends = corner.strut.ends;
            joined.strut.ends = [ends[0] - centre, ends[1] - corner.centre];
            if let Guide::Ends { length } = &mut joined.strut.guide {
                *length = (ends[0] - ends[1]).length();
            }
            joined
        };
        let air = v(-p.centre_of_mass_x, 0.0, p.centre_of_mass_z) - centre;
        let lift = [v(0.0, 0.0, 0.0) - centre, v(-WHEELBASE, 0.0, 0.0) - centre];
        Self::new(
            p.clone(),
            Rigid { mass, inertia: BODY_INERTIA, centre, air, lift },
            std::array::from_fn(|k| onto(&corners[k])),
            std::array::from_fn(hub),
            (wheels, speed),
        )
    }
}
