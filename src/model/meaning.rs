//! What a variable means: said by the author of a model, so that nobody has to guess it from a name.

use serde::{Deserialize, Serialize};

/// What a variable is to its machine.
///
/// The quantity is taken for granted and need not be said: a variable in N is a [`Force`](Role::Force), one in m a
/// [`Position`](Role::Position), one in m/s a [`Velocity`](Role::Velocity), and so on. A tire's forces stay forces,
/// a steer angle stays a position; every other role that is said stands in place of that of the quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Role {
    /// Displacement \[m\] or angle \[rad\] of a part that is not the spinning wheel.
    Position,
    /// Its rate \[m/s\] or \[rad/s\].
    Velocity,
    /// The rate of that \[m/s2\] or \[rad/s2\].
    Acceleration,
    /// Force \[N\] or moment \[N.m\].
    Force,
    /// Longitudinal force \[N\] of a tire, or the moment about its axis \[N.m\].
    LongitudinalForce,
    /// Moment about the vertical axis of a tire \[N.m\], positive to the left.
    AligningMoment,
    /// Lateral force \[N\] of a tire.
    LateralForce,
    /// Speed along the road or belt \[m/s\].
    TravelSpeed,
    /// Distance along the road or belt \[m\].
    TravelDistance,
    /// Spin of a wheel, drum or shaft \[rad/s\].
    WheelSpeed,
    /// Angle of a wheel, drum or shaft that turns on and on \[rad\].
    WheelAngle,
    /// Vertical load of a tire \[N\].
    Load,
    /// Longitudinal slip \[1\].
    Slip,
    /// Slip angle \[rad\].
    SlipAngle,
    /// Steer angle of a wheel \[rad\], positive to the left.
    SteerAngle,
    /// Camber angle \[rad\].
    Camber,
    /// Pressure \[Pa\].
    Pressure,
    /// Temperature \[K\].
    Temperature,
    /// Power that a contact loses, or that friction turns into heat \[W\].
    FrictionPower,
    /// A parameter: coefficient of friction or grip \[1\].
    Friction,
    /// A parameter: stiffness of a tire, spring or bushing.
    Stiffness,
    /// A parameter: how much a brake does with its pressure or force.
    BrakeGain,
    /// A parameter: the step of the model's own time grid \[s\].
    Step,
    /// A parameter: the time between two calls of a task \[s\]; at 0 it is called at every communication point.
    SampleTime,
    /// A share of another variable that stands for the whole, as the power of sliding is of the power that a
    /// contact loses: it drives nothing.
    Share,
    /// Anything else.
    Other,
    // at the end, so that GUIDs of interfaces without it stay
    /// What an actuator is told or fed, or the force that it gives if it is no brake: a voltage, a current, a flow, a valve's opening,
    /// a motor's moment.
    Command,
    /// Force \[N\] or moment \[N.m\] of a brake.
    BrakeForce,
}

impl Role {
    /// True if a signal with this role can be what an effect needs as a driver: [`Role::Other`] takes any
    /// signal, [`Role::Slip`] a slip angle too, [`Role::Velocity`] the spin of a wheel or shaft too.
    pub fn serves(self, needed: Self) -> bool {
        self == needed
            || matches!(
                (needed, self),
                (Self::Other, _) | (Self::Slip, Self::SlipAngle) | (Self::Velocity, Self::WheelSpeed)
            )
    }
}

/// What a parameter is there for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Purpose {
    /// A property of the machine, which recordings may tell.
    #[default]
    Physics,
    /// A property of the machine that a data sheet or a file gives and a few recordings do not tell, as one of the many
    /// coefficients of an empirical curve: fitted only where the user asks for it.
    Data,
    /// How the model computes: steps, tolerances, seeds.
    Numerics,
    /// The state at the start of a run, which runs do not share.
    Start,
    /// A constant of nature.
    Constant,
    /// What the machine stands on or is driven through: a road.
    Surroundings,
}

/// What the author of a model says of a variable.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Meaning {
    /// Its role, beyond what its unit says.
    pub role: Option<Role>,
    /// What it is there for; of parameters only.
    pub purpose: Purpose,
}
