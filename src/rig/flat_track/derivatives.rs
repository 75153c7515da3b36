//! Exact derivatives of the flat track's outputs, with dual numbers through rig, tire and side wall.

use super::RingBrushFlatTrack;
use crate::rig::OnRoad;
use crate::rig::mounted::to_heading;
use crate::solver::Dual;
use crate::tire::ring_brush::{Contact, coupling};
use crate::tire::{Ground, Motion};
use crate::{Error, Result};
use nalgebra::Vector3;

/// Derivatives of the outputs along a change of the rim's motion.
pub(super) struct Changes {
    force: Vector3<f64>,
    moment: Vector3<f64>,
    /// Of what is inside the tire; between steps it does not change.
    inside: Option<Inside>,
    /// The friction changes between steps: bristles that slide follow it at once, by how much only the next
    /// step tells.
    sliding_changes: bool,
}

struct Inside {
    penetration: f64,
    /// Lengths of the contact stripes: left, center, right.
    lengths: [f64; 3],
    patch_force: Vector3<f64>,
    power_loss: f64,
}

impl Changes {
    /// Between steps: the belt stays, and the side wall answers at once.
    pub(super) fn side_wall(rig: &RingBrushFlatTrack, rim: &Motion<Dual<1>>, friction: Dual<1>) -> Self {
        let changes = Self::measured(rig, rim, &rig.tire.state.belt.constant(), None);
        Self { sliding_changes: friction.gradient[0] != 0.0, ..changes }
    }

    /// Before the first step: the whole stationary state moves along.
    pub(super) fn stationary(
        rig: &RingBrushFlatTrack,
        rim: &Motion<Dual<1>>,
        friction: Dual<1>,
    ) -> Result<Self> {
        let ground = OnRoad::at(&rig.road, rig.place, rig.friction_factor);
        let plane = ground.under(&rig.tire.rim, 0.0);
        if plane.slope != [0.0; 2] {
            return Err(Error::call("the start is on a slope: there are derivatives on level road only"));
        }
        // the tire sees its height over the road
        let mut rim = *rim;
        rim.position.z -= Dual::from(rig.tire.rim.position.z - plane.clearance);
        // the road has its own factor besides the one that the master gives
        let friction = friction * rig.road.at(rig.place[0], rig.place[1]).friction;
        let stationary = rig.tire.stationary(&ground)?;
        let moved = stationary.along(&rig.tire.tire, &rim, friction).ok_or_else(|| {
            Error::numeric("the stationary state has no derivative: its equations are singular here")
        })?;
        let mut belt = moved.belt;
        belt.angles.y = rim.angles.y - moved.windup;
        let contact = Contact::new(&rig.tire.parameters, &belt);
        let lengths = [0.0, 0.5, 1.0].map(|share| {
            let i = rig.tire.stripe(share);
            let (y, radius) = (rig.tire.tire.stripe_places()[i], rig.tire.tire.stripe_radii()[i]);
            contact.stripe_length(&rig.tire.parameters, y, radius).gradient[0]
        });
        let inside = Inside {
            penetration: contact.penetration.gradient[0],
            lengths,
            patch_force: moved.patch.force.map(|f| f.gradient[0]),
            power_loss: moved.power_loss.gradient[0],
        };
        Ok(Self::measured(rig, &rim, &belt, Some(inside)))
    }

    fn measured(
        rig: &RingBrushFlatTrack,
        rim: &Motion<Dual<1>>,
        belt: &Motion<Dual<1>>,
        inside: Option<Inside>,
    ) -> Self {
        let on_rim = coupling(&rig.tire.parameters, rim, belt).on_rim;
        let change = |v| to_heading(rim.angles.z, v).map(|x| x.gradient[0]);
        Self { force: change(&on_rim.force), moment: change(&on_rim.moment), inside, sliding_changes: false }
    }

    /// The derivative of the output called `name`, if there is a formula for it.
    ///
    /// # Errors
    /// It has none.
    pub(super) fn of(&self, name: &str) -> Result<Option<f64>> {
        let from_inside = |f: fn(&Inside) -> f64| self.inside.as_ref().map_or(0.0, f);
        Ok(Some(match name {
            "patch_force_x" | "patch_force_y" | "sliding_share" | "friction_power"
                if self.sliding_changes =>
            {
                return Err(Error::call(format!(
                    "{name} has no derivative by friction_factor between steps: bristles that slide follow the friction at once, and how much that is only the next step tells"
                )));
            }
            "force_x" => self.force.x,
            "force_y" => self.force.y,
            "force_z" => self.force.z,
            "moment_x" => self.moment.x,
            "moment_y" => self.moment.y,
            "moment_z" => self.moment.z,
            "belt_deflection" => from_inside(|i| i.penetration),
            "contact_length_left" => from_inside(|i| i.lengths[0]),
            "contact_length_center" => from_inside(|i| i.lengths[1]),
            "contact_length_right" => from_inside(|i| i.lengths[2]),
            "patch_force_x" => from_inside(|i| i.patch_force.x),
            "patch_force_y" => from_inside(|i| i.patch_force.y),
            "patch_force_z" => from_inside(|i| i.patch_force.z),
            "contact_power_loss" => from_inside(|i| i.power_loss),
            // they count from the start
            "sliding_distance" | "contact_energy_loss" | "wheel_angle" => 0.0,
            _ if self.inside.is_none() => 0.0,
            // a sum over single bristles, which stick or slide
            _ => return Ok(None),
        }))
    }
}
