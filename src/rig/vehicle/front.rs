//! The front axle: two McPherson sides and the rack between them.

use super::super::Actuator;
use super::axle::Axle;
use super::mcpherson::{McPherson, Side, Strut};
use super::rack::{Rack, RackParameters};
use super::{SIDES, statics, told};
use crate::mechanics::{Pose, Wrench};
use crate::model::Table;
use crate::{Result, clone_in_place, lens};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// What a front axle is made of.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct FrontParameters {
    pub axle: Axle,
    pub mcpherson: McPherson,
    pub rack: RackParameters,
}

clone_in_place!(FrontParameters { axle, mcpherson, rack });

impl FrontParameters {
    pub fn rows() -> Table<Self> {
        Self::rows_with(Axle::rows())
    }

    /// The same with some rows of the axle only.
    pub fn rows_with(axle: Table<Axle>) -> Table<Self> {
        Table::new([])
            .part("front_", lens!(axle), axle)
            .part("front_", lens!(mcpherson), McPherson::rows())
            .part("", lens!(rack), RackParameters::rows())
    }

    /// # Errors
    /// Sizes that contradict each other.
    pub fn prepare(&mut self) -> Result<()> {
        self.axle.springs.prepare("front_damper")?;
        self.mcpherson.check()
    }
}

/// The axle as it moves.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct FrontAxle {
    pub sides: [Side; 2],
    pub rack: Rack,
}

/// What it does.
pub struct FrontActing {
    pub on_body: Wrench<f64>,
    pub on_carriers: [Wrench<f64>; 2],
    /// Power that its dampers take \[W\].
    pub dampers: f64,
    pub told: [told::Front; 2],
}

impl FrontAxle {
    /// Hangs a carrier under the body so that all is in balance under other loads on the carrier.
    ///
    /// # Errors
    /// The joints do not hold it.
    pub fn hang(
        &mut self,
        i: usize,
        p: &FrontParameters,
        bodies: [&Pose; 2],
        loads: &Wrench<f64>,
    ) -> Result<()> {
        let carrier = bodies[1];
        let joints = p.mcpherson.joints(SIDES[i], 0.5 * p.axle.track, carrier.position.z, p.axle.camber);
        let mut side = Side::new(&p.mcpherson, &joints, bodies, &Vector3::zeros());
        let strut = side.strut(bodies);
        let forces = statics::balance("front suspension", &side.columns(bodies), loads)?;
        side.preload(&strut, carrier, &forces);
        self.rack.preload -= side.act(bodies, [0.0; 2], &strut, 0.0).on_rack;
        self.sides[i] = side;
        Ok(())
    }

    /// What it does between bodies that move so, and takes over what that does to the rack.
    pub fn act(
        &mut self,
        p: &FrontParameters,
        steered: Actuator,
        body: &Pose,
        carriers: [&Pose; 2],
        rack_speed: f64,
    ) -> FrontActing {
        let [left, right] = &self.sides;
        let struts = [left.strut([body, carriers[0]]), right.strut([body, carriers[1]])];
        let shortened = struts.each_ref().map(Strut::shortened);
        let rack = [self.rack.way, rack_speed];
        let mut all = FrontActing {
            on_body: Wrench::default(),
            on_carriers: Default::default(),
            dampers: 0.0,
            told: Default::default(),
        };
        let mut on_rack = 0.0;
        let springs = &p.axle.springs;
        for (i, side) in self.sides.iter().enumerate() {
            let [way, rate] = shortened[i];
            let more = springs.push(way, rate, shortened[1 - i][0]);
            let acting = side.act([body, carriers[i]], rack, &struts[i], more);
            all.dampers += acting.power_loss + rate * springs.damper.at(rate);
            all.on_body += acting.on_body;
            all.on_carriers[i] = acting.on_carrier;
            on_rack += acting.on_rack;
            all.told[i] = told::Front::new(&acting, body, shortened[i]);
        }
        all.dampers += self.rack.load(&p.rack, steered, p.mcpherson.steering_arm, rack_speed, on_rack);
        all
    }

    /// Energy of springs and rack beyond that where the vehicle stands \[J\].
    pub fn energy(&self, p: &FrontParameters, steered: Actuator, body: &Pose, carriers: [&Pose; 2]) -> f64 {
        let rack = [self.rack.way, self.rack.speed];
        let links: f64 = (0..2).map(|i| self.sides[i].energy([body, carriers[i]], rack)).sum();
        let shortened = [0, 1].map(|i| self.sides[i].strut([body, carriers[i]]).shortened()[0]);
        links
            + p.axle.springs.energy(shortened)
            + self.rack.energy(&p.rack, steered, p.mcpherson.steering_arm)
    }
}
