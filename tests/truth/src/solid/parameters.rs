//! Parameters of tire and rigs, as `parameters.toml` of a case names them, and what a case believes of them.

use crate::random::Random;

/// Where a case is recorded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Rig {
    /// A standing wheel under a cylinder that controls its force.
    Force,
    /// The same, which controls its position.
    Position,
    /// In a swing arm on a drum.
    Drum,
}

impl Rig {
    /// Name of the model.
    pub(crate) fn model(self) -> &'static str {
        if self == Self::Drum { "super-elastic-drum" } else { "super-elastic-hydropulse" }
    }
}

/// Which rig a parameter belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Of {
    Tire,
    Drum,
}

macro_rules! parameters {
    ($($name:ident = $nominal:literal, $of:ident, $off:literal;)*) => {
        /// Parameters; names are those of the models.
        #[derive(Debug, Clone, PartialEq)]
        #[allow(missing_docs)]
        pub(crate) struct Parameters { $(pub(crate) $name: f64,)* }

        impl Default for Parameters {
            /// The property file of the source; of the drum what the model takes for it.
            fn default() -> Self {
                Self { $($name: $nominal,)* }
            }
        }

        /// Name, where it belongs, and by which share it may differ from the nominal one.
        const ALL: &[(&str, Of, f64)] = &[$((stringify!($name), Of::$of, $off),)*];

        impl Parameters {
            fn values(&self) -> Vec<f64> {
                vec![$(self.$name,)*]
            }

            fn places(&mut self) -> Vec<&mut f64> {
                vec![$(&mut self.$name,)*]
            }
        }
    };
}

parameters! {
    element_radial_stiffness = 122e3, Tire, 0.1;
    element_radial_damping = 280.0, Tire, 0.2;
    tire_radius = 0.2265, Tire, 0.02;
    element_thickness = 0.005, Tire, 0.0;
    rubber_mass = 19.8, Tire, 0.08;
    contact_stiffness = 35e3, Tire, 0.1;
    contact_exponent = 1.9, Tire, 0.0;
    contact_damping = 700.0, Tire, 0.1;
    contact_full_damping = 1e-4, Tire, 0.0;
    slip_stiffness = 5000.0, Tire, 0.1;
    friction_max = 0.94, Tire, 0.0;
    friction_min = 0.85, Tire, 0.0;
    relaxation_length = 0.01, Tire, 0.0;
    rolling_resistance = 0.015, Tire, 0.2;
    gravity = 9.81, Tire, 0.0;
    wheel_mass = 30.0, Tire, 0.2;
    drum_diameter = 2.0, Drum, 0.2;
    wheel_inertia = 0.15, Drum, 0.2;
    arm_length = 1.0, Drum, 0.15;
    arm_mass = 60.0, Drum, 0.2;
    arm_centre = 0.5, Drum, 0.1;
    arm_inertia = 20.0, Drum, 0.2;
    weight_mass = 600.0, Drum, 0.2;
    weight_distance = 1.2, Drum, 0.1;
    sensor_4_distance = 1.0, Drum, 0.15;
    road_start = 2.5, Drum, 0.3;
}

/// Text of a number with six digits, as a file has it.
fn text(value: f64) -> String {
    let plain = rounded(value);
    let text = format!("{plain:?}");
    if text.contains('.') || text.contains('e') { text } else { text + ".0" }
}

fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

impl Parameters {
    /// A tire on a rig.
    pub(crate) fn draw(random: &mut Random, rig: Rig) -> Self {
        let mut all = Self::default();
        if rig == Rig::Drum {
            all.wheel_mass = 12.0;
        }
        for (place, (.., off)) in all.places().into_iter().zip(ALL) {
            *place = rounded(*place * (1.0 + random.within(-off, *off)));
        }
        all
    }

    /// What is believed of this tire beforehand: rig, masses and radius can be weighed and measured, what the rubber is
    /// like comes from another tire.
    pub(crate) fn believed(&self, random: &mut Random, right: bool) -> Self {
        let mut belief = self.clone();
        for (name, _) in self.free() {
            let doubt = match name {
                "element_radial_stiffness" => 0.05,
                _ => 0.15,
            };
            let off = random.within(0.3 * doubt, doubt) * random.sign();
            if !right {
                belief = belief.moved(name, off);
            }
        }
        belief
    }

    /// The same with one of them larger by this share.
    pub(crate) fn moved(&self, name: &str, share: f64) -> Self {
        let mut other = self.clone();
        for (place, (own, ..)) in other.places().into_iter().zip(ALL) {
            if *own == name {
                *place = rounded(*place * (1.0 + share));
            }
        }
        other
    }

    /// Names and values of those that may be fitted: what the rubber is like.
    pub(crate) fn free(&self) -> impl Iterator<Item = (&'static str, f64)> {
        ALL.iter().map(|(name, ..)| *name).zip(self.values()).take(2)
    }

    /// `parameters.toml` of a case; `profile` is the cleat.
    pub(crate) fn toml(&self, rig: Rig, profile: &str) -> String {
        let mut all = "[parameters]\nelements = 45\ncontact_points = 3\n".to_owned();
        for ((name, of, _), value) in ALL.iter().zip(self.values()) {
            if *of == Of::Tire || rig == Rig::Drum {
                all += &format!("{name} = {}\n", text(value));
            }
        }
        all += match rig {
            Rig::Force => "control = \"force\"\n",
            Rig::Position => "control = \"position\"\n",
            Rig::Drum => "road_kind = \"profile\"\n",
        };
        if rig == Rig::Drum {
            all += &format!("road_profile = \"{profile}\"\n");
        }
        all += &format!("step_size = {}\n\n[fit]\n", text(step(rig)));
        for (name, _) in self.free() {
            all += &format!("{name} = true\n");
        }
        all
    }
}

/// Step that the user of the model takes \[s\]: cleats ask for a shorter one, as its page says.
fn step(rig: Rig) -> f64 {
    if rig == Rig::Drum { 5e-4 } else { 1e-3 }
}
