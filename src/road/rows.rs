//! The parameters of a road as models have them.

use super::{KINDS, RoadParameters, TRACKS};
use crate::model::{Purpose, Table, integer_parameter, parameter, text_parameter};
use crate::{integer, real, text};
use std::f64::consts::TAU;

impl RoadParameters {
    /// Name, unit, default, range and meaning of each: here and nowhere else.
    #[rustfmt::skip] // a row is a line
    pub fn rows() -> Table<Self> {
        Table::new([
            integer_parameter("road_kind", integer!(kind), 1, "What the tire rolls on").items(KINDS).purpose(Purpose::Surroundings),
            parameter("road_start", "m", real!(start), 5.0, "The road is level up to this place, counted along it from where the wheel starts").range(-1e6, 1e6).purpose(Purpose::Surroundings),
            parameter("road_height", "m", real!(height), 0.01, "Height of an obstacle over the level road before it; negative: depth. For a sine from valley to peak").range(-1.0, 1.0).purpose(Purpose::Surroundings),
            parameter("road_length", "m", real!(length), 0.1, "Length along the road: of a ramp, of a cleat at its foot, of a slab, of a wave").range(1e-3, 1e4).purpose(Purpose::Surroundings),
            parameter("road_bevel", "m", real!(bevel), 0.0, "Width and height of a cleat's bevels of 45 degrees").range(0.0, 1.0).purpose(Purpose::Surroundings),
            parameter("road_spacing", "m", real!(spacing), 0.0, "Distance from the beginning of an obstacle to that of the next; 0: only one, but slabs join").range(0.0, 1e4).purpose(Purpose::Surroundings),
            parameter("road_roughness", "m3", real!(roughness), 64e-6, "Displacement PSD of ISO 8608 at 0.1 cycles/m; geometric means of its classes in 1e-6 m3: A 16, B 64, C 256, D 1024, E 4096, F 16384").range(0.0, 1.0).purpose(Purpose::Surroundings),
            integer_parameter("road_seed", integer!(seed), 1, "Number of the realisation of an ISO 8608 road").purpose(Purpose::Surroundings),
            parameter("road_coherence_length", "m", real!(coherence_length), 0.0, "rho of an ISO 8608 road: the coherence of its tracks is exp(-rho n) at n cycles/m; 0: both are the same").range(0.0, 1e3).purpose(Purpose::Surroundings),
            parameter("road_direction", "rad", real!(direction), 0.0, "Angle about z from x to the direction along which the road changes; an oblique cleat for a wheel that travels along x").range(-TAU, TAU).purpose(Purpose::Surroundings),
            integer_parameter("road_tracks", integer!(tracks), 1, "Where the kind lies; the other track is level, at height 0").items(TRACKS).purpose(Purpose::Surroundings),
            parameter("road_track_width", "m", real!(track_width), 1.5, "Distance of the tracks: the left one at y = half of it (with a road_direction of 0), the right one at minus half of it; between them heights lie on a straight line. Not used where both are the same").range(0.1, 10.0).purpose(Purpose::Surroundings),
            parameter("road_lateral_position", "m", real!(lateral_position), 0.0, "How far to the left of the road's middle the wheel starts: half of road_track_width puts a single wheel on the left track, minus that on the right one").range(-100.0, 100.0).purpose(Purpose::Surroundings),
            text_parameter("road_profile", text!(profile), "", "Points 'x z; x z; ...' in m of the profile, x counted from road_start; two points with the same x are a vertical edge").purpose(Purpose::Surroundings),
            text_parameter("road_profile_right", text!(profile_right), "", "Another profile for the right track, as road_profile; empty: the same").purpose(Purpose::Surroundings),
            text_parameter("road_friction", text!(friction), "", "Friction patches 's factor; s factor; ...': from the place s (m from the start) on, the factor on the friction; 1 before the first").purpose(Purpose::Surroundings),
            text_parameter("road_friction_right", text!(friction_right), "", "Other friction patches for the right side (y < 0 with a road_direction of 0), as road_friction; empty: the same, '0 1': none").purpose(Purpose::Surroundings),
            parameter("road_friction_deviation", "1", real!(friction_deviation), 0.0, "Standard deviation of a random factor of mean 1 on the friction; 0: there is none").range(0.0, 0.47).purpose(Purpose::Surroundings),
            parameter("road_friction_correlation_length", "m", real!(friction_correlation_length), 1.0, "Correlation length of that factor: the integral of its correlation over all positive lags").range(0.01, 1e3).purpose(Purpose::Surroundings),
            integer_parameter("road_friction_seed", integer!(friction_seed), 1, "Number of the realisation of that factor").purpose(Purpose::Numerics),
            integer_parameter("road_friction_seed_right", integer!(friction_seed_right), 0, "Number of another realisation of that factor for the right side (y < 0 with a road_direction of 0); 0: the same as on the left").purpose(Purpose::Numerics),
        ])
    }
}
