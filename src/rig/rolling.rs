//! A tire on its rim over a road: what all rigs with a road of their own share.

use super::OnRoad;
use crate::mechanics::Motion;
use crate::model::{Table, input};
use crate::road::{Road, RoadParameters, Surface};
use crate::tire::{Mounted, Tire};
use crate::{Result, clone_in_place, lens, real};
use serde::{Deserialize, Serialize};

/// A tire on its rim, the road and the friction that the master gives.
#[derive(Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Rolling<T> {
    /// The tire on its rim.
    pub mounted: Mounted<T>,
    /// The road.
    pub road: Road,
    /// Factor on the friction, over the road's own.
    pub friction_factor: f64,
    road_parameters: RoadParameters,
}

clone_in_place!(Rolling<T> { mounted, road, friction_factor, road_parameters });

impl<T: Tire> Rolling<T> {
    /// The friction as an input, what the tire tells, parameters of tire and road.
    pub(super) fn rows() -> Table<Self> {
        let friction = "Factor on the friction between tire and road, over the road's own";
        Table::new([input("friction_factor", "1", real!(friction_factor), 1.0, friction).range(0.0, 10.0)])
            .part("", lens!(mounted), Mounted::rows())
            .part("", lens!(road_parameters), RoadParameters::rows())
    }

    /// Makes road and tire from their parameters: the first thing in a model's `initialize`.
    ///
    /// # Errors
    /// Parameters that contradict each other.
    pub fn mount(&mut self) -> Result<()> {
        self.road = Road::new(&self.road_parameters)?;
        self.mounted.tire.mount(&self.road)
    }

    /// [`mount`](Self::mount) on a road that is wound around a drum of a radius \[m\], or inside of one where it is negative.
    ///
    /// # Errors
    /// Parameters that contradict each other, a road that does not close.
    pub fn mount_on_drum(&mut self, radius: f64) -> Result<()> {
        // what a tire can see of the road before and behind it
        let reach = self.mounted.tire.radius();
        self.road = Road::new(&self.road_parameters)?.wound(radius, reach)?;
        self.mounted.tire.mount(&self.road)
    }

    /// As [`Model::tune`](crate::model::Model::tune).
    ///
    /// # Errors
    /// Parameters that contradict each other.
    pub fn tune(&mut self) -> Result<()> {
        self.mounted.tire.tune()
    }

    /// As [`Model::check`](crate::model::Model::check).
    ///
    /// # Errors
    /// A value that no run leads to.
    pub fn check(&self) -> Result<()> {
        self.road.check()?;
        self.mounted.tire.check(&self.road)
    }

    /// The tire.
    pub fn tire(&self) -> &T {
        &self.mounted.tire
    }

    /// The ground at a place of the rim, x and y \[m\].
    pub fn ground(&self, place: [f64; 2]) -> OnRoad<'_> {
        OnRoad::at(&self.road, place, self.friction_factor)
    }

    /// As [`Mounted::start`], at a place.
    ///
    /// # Errors
    /// As there.
    pub fn start(&mut self, rim: &Motion<f64>, place: [f64; 2]) -> Result<()> {
        self.mounted.start(rim, &OnRoad::at(&self.road, place, self.friction_factor))
    }

    /// As [`Mounted::start_carrying`], at a place.
    ///
    /// # Errors
    /// As there.
    pub fn start_carrying(&mut self, rim: &Motion<f64>, place: [f64; 2], load: f64) -> Result<()> {
        self.mounted.start_carrying(rim, &OnRoad::at(&self.road, place, self.friction_factor), load)
    }

    /// As [`Mounted::start_rolling`], at a place.
    ///
    /// # Errors
    /// As there.
    pub fn start_rolling(&mut self, rim: &Motion<f64>, place: [f64; 2], load: f64) -> Result<()> {
        self.mounted.start_rolling(rim, &OnRoad::at(&self.road, place, self.friction_factor), load)
    }

    /// Advances the tire by `dt` seconds while the rim moves to `rim` and travels from one place to another.
    ///
    /// # Errors
    /// A state outside the tire's validity.
    pub fn step(&mut self, rim: &Motion<f64>, from: [f64; 2], to: [f64; 2], dt: f64) -> Result<()> {
        let ground = OnRoad { road: &self.road, from, to, friction: self.friction_factor };
        self.mounted.step(rim, &ground, dt)
    }

    /// The road at a place as the tire bridges it.
    pub fn surface(&self, [x, y]: [f64; 2]) -> Surface {
        self.road.mean(self.tire().window(), x, y)
    }

    /// The rolling radius \[m\] of a wheel whose centre is at a height over the road's datum, at a place.
    pub fn rolling_radius(&self, place: [f64; 2], height: f64) -> f64 {
        self.tire().rolling_radius(self.tire().radius() - (height - self.surface(place).height))
    }
}
