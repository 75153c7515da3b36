//! Parameters of the tire, as `parameters.toml` of a case names them, and what a case believes of them.

use crate::random::Random;

macro_rules! parameters {
    ($($name:ident = $nominal:literal, $unit:literal, $off:literal;)*) => {
        /// Parameters of the tire (7 of the specification); names are those of the model.
        #[derive(Debug, Clone, PartialEq)]
        #[allow(missing_docs)]
        pub struct Parameters { $(#[doc = concat!("\\[", $unit, "\\]")] pub $name: f64,)* }

        impl Default for Parameters {
            /// The example of 4.2.10 of the thesis.
            fn default() -> Self {
                Self { $($name: $nominal,)* }
            }
        }

        /// Name and by which share a tire may differ from the nominal one.
        const ALL: &[(&str, f64)] = &[$((stringify!($name), $off),)*];

        impl Parameters {
            /// Values in the order of `ALL`.
            fn values(&self) -> Vec<f64> {
                vec![$(self.$name,)*]
            }

            fn places(&mut self) -> Vec<&mut f64> {
                vec![$(&mut self.$name,)*]
            }
        }
    };
}

// nominal values of 4.2.10; geometry and what nobody can weigh or time is the same on every tire
parameters! {
    vertical_stiffness = 1.54e5, "N/m", 0.12;
    vertical_stiffness_quadratic = 2.47e6, "N/m2", 0.1;
    sidewall_radial_stiffness = 4.67e6, "N/m", 0.1;
    cross_section_radius = 0.675, "m", 0.08;
    bristle_stiffness = 4e4, "N/m", 0.15;
    sidewall_tilt_stiffness = 8e4, "N.m/rad", 0.12;
    stripe_length_factor = 0.75, "1", 0.06;
    patch_compliance_twist = 1e-4, "rad/(N.m)", 0.12;
    patch_compliance_y = 8e-7, "m/N", 0.12;
    friction_sliding_zero = 1.1, "1", 0.1;
    friction_sliding_reference = 1.0, "1", 0.06;
    patch_compliance_x = 3e-6, "m/N", 0.1;
    friction_static_zero = 1.5, "1", 0.06;
    friction_static_reference = 1.4, "1", 0.06;
    sidewall_lateral_stiffness = 8.5e4, "N/m", 0.12;
    rolling_resistance_lever = 0.01, "m", 0.15;
    sidewall_windup_stiffness = 4.51e5, "N.m/rad", 0.0;
    sidewall_radial_damping = 449.0, "N.s/m", 0.06;
    sidewall_lateral_damping = 41.5, "N.s/m", 0.06;
    sidewall_windup_damping = 53.1, "N.m.s/rad", 0.0;
    sidewall_tilt_damping = 9.61, "N.m.s/rad", 0.06;
    vertical_damping = 83.0, "N.s/m", 0.0;
    bristle_damping = 0.65, "N.s/m", 0.0;
    belt_mass = 8.8, "kg", 0.04;
    belt_inertia_diametral = 0.5, "kg.m2", 0.0;
    belt_inertia_polar = 0.928, "kg.m2", 0.0;
    tire_radius = 0.338, "m", 0.0;
    tire_width = 0.225, "m", 0.0;
    rolling_radius = 0.328, "m", 0.0;
    bristle_length = 0.014, "m", 0.0;
    patch_lag_x = 0.0184, "s", 0.06;
    patch_lag_y = 0.0758, "s", 0.06;
    patch_lag_twist = 0.00824, "s", 0.06;
    friction_pressure = 2e5, "Pa", 0.0;
}

/// So many of them, the first ones, may be fitted: the order is that of 4.1.8, in which they are identified.
pub const FREE: usize = 16;

/// Share by which a belief about a free parameter is off at most; less for what a pressure print or a static curve
/// tells well.
fn doubt(name: &str) -> f64 {
    match name {
        "vertical_stiffness" | "vertical_stiffness_quadratic" => 0.06,
        "cross_section_radius" | "stripe_length_factor" => 0.08,
        _ => 0.14,
    }
}

/// Text of a number with six digits, as a file has it.
fn text(value: f64) -> String {
    let digits = format!("{value:.5e}");
    let plain = digits.parse::<f64>().unwrap_or(value);
    let text = format!("{plain:?}");
    if text.contains('.') || text.contains('e') { text } else { text + ".0" }
}

fn rounded(value: f64) -> f64 {
    text(value).parse().unwrap_or(value)
}

impl Parameters {
    /// A tire: near the nominal one, with friction that is larger at rest than in sliding, falls with pressure, and
    /// whose force rises with it up to the largest pressures of some 5 bar.
    #[must_use]
    pub fn draw(random: &mut Random) -> Self {
        loop {
            let mut tire = Self::default();
            for (place, (_, off)) in tire.places().into_iter().zip(ALL) {
                *place = rounded(*place * (1.0 + random.within(-off, *off)));
            }
            if tire.is_plausible() {
                return tire;
            }
        }
    }

    fn is_plausible(&self) -> bool {
        let pairs = [
            (self.friction_static_zero, self.friction_static_reference),
            (self.friction_sliding_zero, self.friction_sliding_reference),
        ];
        // p mu(p) rises while p < mu_0 dp / (2 (mu_0 - mu_ref)); dp is 2 bar
        let falls = |(zero, reference): (f64, f64)| reference < zero && zero > 5.0 * (zero - reference);
        pairs.into_iter().all(falls)
            && self.friction_static_zero > 1.1 * self.friction_sliding_zero
            && self.friction_static_reference > 1.1 * self.friction_sliding_reference
    }

    /// What is believed of this tire beforehand: the free parameters off, or right.
    #[must_use]
    pub fn believed(&self, random: &mut Random, right: bool) -> Self {
        let mut belief = self.clone();
        for (place, (name, _)) in belief.places().into_iter().zip(ALL).take(FREE) {
            let off = doubt(name);
            let off = random.within(-off, off);
            if !right {
                *place = rounded(*place / (1.0 + off));
            }
        }
        belief
    }

    /// The same with a free parameter larger by this share.
    #[must_use]
    pub fn moved(&self, free: usize, share: f64) -> Self {
        let mut other = self.clone();
        if let Some(place) = other.places().into_iter().nth(free) {
            *place *= 1.0 + share;
        }
        other
    }

    /// Names and values of the free ones.
    pub fn free(&self) -> impl Iterator<Item = (&'static str, f64)> {
        ALL.iter().map(|(name, _)| *name).zip(self.values()).take(FREE)
    }

    /// Sets one by its name; says whether there is one.
    #[cfg(test)]
    pub(crate) fn set(&mut self, name: &str, value: f64) -> bool {
        let found = ALL.iter().position(|(own, _)| *own == name);
        let place = found.and_then(|k| self.places().into_iter().nth(k));
        place.map(|place| *place = value).is_some()
    }

    /// `parameters.toml` of a case.
    #[must_use]
    pub fn toml(&self) -> String {
        let mut all = "[parameters]\nstripes = 6\nbristles_per_stripe = 30\ngravity = 9.81\n".to_owned();
        for ((name, _), value) in ALL.iter().zip(self.values()) {
            all += &format!("{name} = {}\n", text(value));
        }
        for switch in ["even_stripes", "antisymmetric_coupling", "limit_pressure_tilt", "whole_step_entry"] {
            all += &format!("{switch} = false\n");
        }
        all += "\n[fit]\n";
        for (name, _) in self.free() {
            all += &format!("{name} = true\n");
        }
        all
    }
}
