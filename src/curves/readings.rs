//! Numbers that are read from curves.

use super::programme::{Curve, Kind, Programme, Quantity};
use super::{Condition, Point, Rig};

/// Half of the difference over which a stiffness is read: of a slip angle or camber \[rad\] a tenth of a degree,
const ANGLE: f64 = 0.1 * std::f64::consts::PI / 180.0;
/// of a slip, and of a load as a share.
const SLIP: f64 = 1e-3;
const LOAD: f64 = 1e-2;
/// A free wheel is found by the secant until its moment over load times this is below [`FREE`] \[m\].
const ARM: f64 = 0.3;
const FREE: f64 = 1e-6;
const MAX_TRIALS: usize = 12;
/// What of a load is no force: the lateral force of a tire without any.
const NOTHING: f64 = 1e-6;

/// What is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// Slope of the lateral force over the slip angle at none, positive where the force holds against it.
    CorneringStiffness,
    /// At positive slip angles, which make a negative lateral force.
    LateralPeak,
    /// Not a number where the force still rises at the largest slip angle.
    LateralPeakAngle,
    /// At the largest slip angle of the programme.
    LateralAtLargest,
    /// Conicity and ply steer.
    ResidualLateral,
    /// Slope of the aligning moment about the contact, positive where it turns the wheel back.
    AligningStiffness,
    /// Of the two slopes.
    PneumaticTrail,
    /// At positive slip angles.
    AligningPeak,
    /// As that of the lateral force.
    AligningPeakAngle,
    /// Slope of the lateral force over camber, positive where the force is to the side to which the top leans.
    CamberStiffness,
    /// Slope of the longitudinal force over slip.
    SlipStiffness,
    /// Between rolling and locked.
    BrakingPeak,
    /// Positive; not a number where a locked wheel brakes most.
    BrakingPeakSlip,
    /// At slip -1.
    Locked,
    /// Up to the largest slip of the programme.
    DrivingPeak,
    /// Of a wheel that no torque turns.
    RollingResistance,
    /// At the load.
    Deflection,
    /// Slope of the vertical force over the deflection.
    VerticalStiffness,
    /// See [`Rig::relaxation_length`].
    RelaxationLength,
}

impl Measure {
    /// All, in the order of tables.
    pub const ALL: [Self; 19] = [
        Self::CorneringStiffness,
        Self::LateralPeak,
        Self::LateralPeakAngle,
        Self::LateralAtLargest,
        Self::ResidualLateral,
        Self::AligningStiffness,
        Self::PneumaticTrail,
        Self::AligningPeak,
        Self::AligningPeakAngle,
        Self::CamberStiffness,
        Self::SlipStiffness,
        Self::BrakingPeak,
        Self::BrakingPeakSlip,
        Self::Locked,
        Self::DrivingPeak,
        Self::RollingResistance,
        Self::Deflection,
        Self::VerticalStiffness,
        Self::RelaxationLength,
    ];

    /// Its name for programs, its name for people, and its unit.
    pub fn words(self) -> [&'static str; 3] {
        match self {
            Self::CorneringStiffness => ["cornering_stiffness", "cornering stiffness", "N/deg"],
            Self::LateralPeak => ["lateral_peak", "greatest lateral force over load", "1"],
            Self::LateralPeakAngle => ["lateral_peak_angle", "slip angle there", "deg"],
            Self::LateralAtLargest => {
                ["lateral_at_largest", "lateral force over load at the largest slip angle", "1"]
            }
            Self::ResidualLateral => ["residual_lateral", "lateral force without slip angle and camber", "N"],
            Self::AligningStiffness => ["aligning_stiffness", "aligning stiffness", "N.m/deg"],
            Self::PneumaticTrail => ["pneumatic_trail", "pneumatic trail at small slip angles", "mm"],
            Self::AligningPeak => ["aligning_peak", "greatest aligning moment", "N.m"],
            Self::AligningPeakAngle => ["aligning_peak_angle", "slip angle there", "deg"],
            Self::CamberStiffness => ["camber_stiffness", "camber stiffness", "N/deg"],
            Self::SlipStiffness => ["slip_stiffness", "slip stiffness", "N/%"],
            Self::BrakingPeak => ["braking_peak", "greatest braking force over load", "1"],
            Self::BrakingPeakSlip => ["braking_peak_slip", "slip there", "%"],
            Self::Locked => ["locked", "braking force of a locked wheel over load", "1"],
            Self::DrivingPeak => ["driving_peak", "greatest driving force over load", "1"],
            Self::RollingResistance => ["rolling_resistance", "resistance of the free wheel over load", "1"],
            Self::Deflection => ["deflection", "deflection", "mm"],
            Self::VerticalStiffness => ["vertical_stiffness", "vertical stiffness", "N/mm"],
            Self::RelaxationLength => ["relaxation_length", "relaxation length", "m"],
        }
    }
}

/// A number at a load, straight ahead at the first speed and friction, in the unit of [`Measure::words`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// What it is.
    pub measure: Measure,
    /// \[N\].
    pub load: f64,
    /// Not a number where the curve has none: a peak that it does not reach.
    pub value: f64,
}

/// Everything that a rig and its curves tell, load after load.
pub(super) fn readings(
    rig: &mut Rig,
    programme: &Programme,
    curves: &[Curve],
    notes: &mut Vec<String>,
) -> Vec<Reading> {
    let mut all = Vec::new();
    for load in &programme.loads {
        let straight = programme.straight(*load);
        let mut say = |measure, value: Option<f64>| {
            all.extend(value.map(|value| Reading { measure, load: *load, value }));
        };
        let curve = |kind| curves.iter().find(|c| c.kind == kind && c.held == straight);
        let steers = curve(Kind::Cornering).filter(|curve| {
            courses(curve, &|point| point.force[1]).iter().any(|(_, force)| force.abs() > NOTHING * load)
        });
        if let Some(curve) = steers {
            let beside = Beside::of(rig, &straight, Quantity::SlipAngle, ANGLE);
            cornering(curve, beside, *load, &mut say);
            match rig.relaxation_length(&straight) {
                Ok(length) => say(Measure::RelaxationLength, Some(length)),
                Err(error) => notes.push(format!("no relaxation length: {error}")),
            }
        }
        if curve(Kind::Camber).is_some()
            && let Some(beside) = Beside::of(rig, &straight, Quantity::Camber, ANGLE)
        {
            let slope = -beside.slope(|point| point.force[1]).to_radians();
            say(Measure::CamberStiffness, Some(slope).filter(|s| s.abs() > NOTHING * load));
        }
        if let Some(curve) = curve(Kind::Braking) {
            let beside = Beside::of(rig, &straight, Quantity::Slip, SLIP);
            braking(curve, beside, *load, &mut say);
            let resistance = free(rig, &straight).map(|free| -free.force[0] / free.force[2]);
            say(Measure::RollingResistance, resistance);
        }
        if let Some(beside) = Beside::of(rig, &straight, Quantity::Load, LOAD * load)
            && let Some(deflection) = rig.point(&straight).ok().and_then(|point| point.deflection)
        {
            say(Measure::Deflection, Some(1e3 * deflection));
            let compliance = beside.slope(|point| point.deflection.unwrap_or(f64::NAN));
            say(Measure::VerticalStiffness, Some(1e-3 / compliance));
        }
    }
    all
}

/// States beside another, for slopes.
struct Beside {
    /// At the half difference below and above, at half of that, and at a quarter.
    pairs: [[Point; 2]; 3],
    half: f64,
}

impl Beside {
    fn of(rig: &mut Rig, about: &Condition, over: Quantity, half: f64) -> Option<Self> {
        let mut pair = |half: f64| {
            let mut at = |value: f64| rig.point(&about.with(over, about.of(over) + value)).ok();
            Some([at(-half)?, at(half)?])
        };
        Some(Self { pairs: [pair(half)?, pair(0.5 * half)?, pair(0.25 * half)?], half })
    }

    /// From three differences, as their width goes to nothing: a curve may bend at once on both sides, as that of a brush does with the
    /// square of the slip, and a difference is then too low in proportion to its width; one that is smooth makes errors of the second order.
    fn slope(&self, of: impl Fn(&Point) -> f64) -> f64 {
        let mut half = 2.0 * self.half;
        let [wide, middle, narrow] = self.pairs.each_ref().map(|[below, above]| {
            half *= 0.5;
            (of(above) - of(below)) / (2.0 * half)
        });
        (8.0 * narrow - 6.0 * middle + wide) / 3.0
    }
}

/// The wheel that no torque turns: the secant over slip.
fn free(rig: &mut Rig, straight: &Condition) -> Option<Point> {
    let mut at = [0.0, -SLIP];
    let mut points = [rig.point(&straight.with(Quantity::Slip, at[0])).ok()?; 2];
    points[1] = rig.point(&straight.with(Quantity::Slip, at[1])).ok()?;
    for _ in 0..MAX_TRIALS {
        let [before, now] = points.map(|point| point.moment[1]);
        if now.abs() <= FREE * straight.load * ARM {
            return Some(points[1]);
        }
        let next = at[1] - now * (at[1] - at[0]) / (now - before);
        at = [at[1], next];
        points = [points[1], rig.point(&straight.with(Quantity::Slip, next)).ok()?];
    }
    None
}

fn cornering(curve: &Curve, beside: Option<Beside>, load: f64, say: &mut dyn FnMut(Measure, Option<f64>)) {
    let lateral = |point: &Point| -point.force[1];
    let aligning = |point: &Point| point.contact_moment(0.0).unwrap_or(point.moment)[2];
    let forces = courses(curve, &lateral);
    if let Some(beside) = beside {
        let [stiffness, moment] = [beside.slope(lateral), beside.slope(aligning)].map(f64::to_radians);
        let straight = forces.iter().find(|(angle, _)| *angle == 0.0);
        // what is left of a symmetric tire is rounding
        let residual = straight.map(|(_, force)| if force.abs() > NOTHING * load { -force } else { 0.0 });
        say(Measure::CorneringStiffness, Some(stiffness));
        say(Measure::ResidualLateral, residual);
        say(Measure::AligningStiffness, Some(moment));
        say(Measure::PneumaticTrail, Some(1e3 * moment / stiffness));
    }
    let positive = |list: &[(f64, f64)]| list.iter().copied().filter(|(x, _)| *x >= 0.0).collect::<Vec<_>>();
    let forces = positive(&forces);
    let (angle, force) = peak(&forces);
    say(Measure::LateralPeak, Some(force / load));
    say(Measure::LateralPeakAngle, Some(angle.to_degrees()));
    say(Measure::LateralAtLargest, forces.last().map(|(_, force)| force / load));
    let (angle, moment) = peak(&positive(&courses(curve, &aligning)));
    say(Measure::AligningPeak, Some(moment));
    say(Measure::AligningPeakAngle, Some(angle.to_degrees()));
}

fn braking(curve: &Curve, beside: Option<Beside>, load: f64, say: &mut dyn FnMut(Measure, Option<f64>)) {
    let along = courses(curve, &|point: &Point| point.force[0]);
    say(Measure::SlipStiffness, beside.map(|beside| 0.01 * beside.slope(|point| point.force[0])));
    let brakes: Vec<(f64, f64)> =
        along.iter().rev().filter(|(slip, _)| *slip <= 0.0).map(|(slip, force)| (-slip, -force)).collect();
    let drives: Vec<(f64, f64)> = along.into_iter().filter(|(slip, _)| *slip >= 0.0).collect();
    let (slip, force) = peak(&brakes);
    say(Measure::BrakingPeak, Some(force / load));
    say(Measure::BrakingPeakSlip, Some(100.0 * slip));
    say(Measure::Locked, brakes.last().filter(|(slip, _)| *slip == 1.0).map(|(_, force)| force / load));
    say(Measure::DrivingPeak, Some(peak(&drives).1 / load));
}

/// What a curve has, over its quantity; states that are none are left out.
fn courses(curve: &Curve, of: &dyn Fn(&Point) -> f64) -> Vec<(f64, f64)> {
    let over = curve.kind.over();
    curve.states.iter().filter_map(|(at, point)| Some((at.of(over), of(point.as_ref()?)))).collect()
}

/// Place and height of the greatest value of a list with rising places: the top of the parabola through the three greatest neighbours. The
/// place is not a number where the list still rises at its end.
fn peak(list: &[(f64, f64)]) -> (f64, f64) {
    let Some(top) = (0..list.len()).max_by(|a, b| list[*a].1.total_cmp(&list[*b].1)) else {
        return (f64::NAN, f64::NAN);
    };
    let (Some(before), Some(after)) = (top.checked_sub(1).and_then(|k| list.get(k)), list.get(top + 1))
    else {
        return (f64::NAN, list[top].1);
    };
    let ((xa, ya), (xb, yb), (xc, yc)) = (*before, list[top], *after);
    let (rise, fall) = ((yb - ya) / (xb - xa), (yc - yb) / (xc - xb));
    let curvature = (fall - rise) / (xc - xa);
    if curvature >= 0.0 {
        return list[top];
    }
    // the parabola's slope at xb, by Newton's divided differences
    let slope = rise + curvature * (xb - xa);
    let along = -slope / (2.0 * curvature);
    (xb + along, yb + 0.5 * slope * along)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_peak_of_a_parabola_is_where_it_is_and_a_rise_has_none() {
        let parabola = |x: f64| 3.0 - 2.0 * (x - 1.37) * (x - 1.37);
        let list: Vec<(f64, f64)> = [0.0, 0.5, 1.1, 1.6, 2.4].into_iter().map(|x| (x, parabola(x))).collect();
        let (x, y) = peak(&list);
        assert!((x - 1.37).abs() < 1e-12 && (y - 3.0).abs() < 1e-12, "{x} {y}");
        let (x, y) = peak(&list[..3]);
        assert!(x.is_nan() && y == parabola(1.1));
        assert!(peak(&[]).1.is_nan());
    }
}
