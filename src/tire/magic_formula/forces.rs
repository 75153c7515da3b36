//! The equations. The numbers (4.E…) are those of Pacejka's book as its public implementations cite them; "PAC2002" is
//! the Adams/Tire help.

use super::{Coefficients, Input};
use crate::solver::lanes::{atans, sines_and_cosines};
use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};

/// Which of the inputs lay outside the range that the coefficients are good for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Outside {
    /// The wheel load is less than `FZMIN` or more than `FZMAX`.
    pub fz: bool,
    /// Longitudinal slip is less than `KPUMIN` or more than `KPUMAX`.
    pub kappa: bool,
    /// The slip angle is less than `ALPMIN` or more than `ALPMAX`.
    pub alpha: bool,
    /// The inclination angle is less than `CAMMIN` or more than `CAMMAX`.
    pub gamma: bool,
}

impl Outside {
    /// Whether any input lay outside its range.
    pub fn any(self) -> bool {
        self.fz || self.kappa || self.alpha || self.gamma
    }
}

/// Forces and moments that the road puts on the tire in the contact point, in ISO-W axes and SI units.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Output {
    /// Longitudinal force \[N\].
    pub fx: f64,
    /// Lateral force \[N\].
    pub fy: f64,
    /// Overturning moment about x \[N m\].
    pub mx: f64,
    /// Rolling resistance moment about y \[N m\]; negative in forward travel.
    pub my: f64,
    /// Aligning moment about z \[N m\].
    pub mz: f64,
    /// Pneumatic trail \[m\]: the lateral force that slip angle and inclination cause acts at x = −trail. Negative in
    /// reverse.
    pub trail: f64,
    /// The part of the aligning moment that no force causes \[N m\].
    pub residual_torque: f64,
    /// cos(atan(Br·αr,eq)) \[1\]: the decay of the residual torque with slip, a factor of [`gyroscopic_couple`].
    pub residual_decay: f64,
    /// Peak longitudinal friction at this load and inclination \[1\].
    pub mu_x: f64,
    /// Peak lateral friction at this load and inclination \[1\].
    pub mu_y: f64,
    /// Longitudinal slip stiffness ∂Fx/∂κ of the unshifted curve at its middle \[N\].
    pub slip_stiffness: f64,
    /// Cornering stiffness ∂Fy/∂α of the unshifted curve at its middle \[N/rad\]; negative in ISO-W axes.
    pub cornering_stiffness: f64,
    /// The inputs that lay outside their ranges.
    pub outside: Outside,
}

impl Output {
    /// The mirror image of these forces at the xz plane; see [`Input::mirrored`].
    #[must_use]
    pub fn mirrored(self) -> Self {
        Self { fy: -self.fy, mx: -self.mx, mz: -self.mz, residual_torque: -self.residual_torque, ..self }
    }
}

/// What stands for the slip angle and the inclination angle in the equations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Slip {
    /// The angles themselves, as in PAC2002; the equivalent angles in combined slip are arc tangents.
    #[default]
    Angle,
    /// tan α and, for the lateral force and the aligning moment, sin γ, as in the book (4.E3, 4.E4), where this is
    /// optional; it needs coefficients that were fitted so. The equivalent slips in combined slip are root sums of
    /// squares (4.E77, 4.E78).
    Tangent,
}

/// What happens to inputs outside the ranges that the coefficients are good for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Limits {
    /// The equations get the end of the range; a wheel load below `FZMIN` is used as it is.
    #[default]
    Clamp,
    /// The equations get the input as it is.
    Ignore,
}

/// How the equations are evaluated. The default is what PAC2002 does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Options {
    /// What stands for the angles.
    pub slip: Slip,
    /// What happens outside the ranges.
    pub limits: Limits,
}

/// First-order relaxation lengths \[m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelaxationLengths {
    /// Of longitudinal slip, σκ.
    pub kappa: f64,
    /// Of the slip angle, σα.
    pub alpha: f64,
}

/// The steady forces and moments in combined slip, with the default [`Options`]; see [`steady_with`].
pub fn steady(c: &Coefficients, input: &Input) -> Output {
    steady_with(c, input, &Options::default())
}

/// The steady forces and moments in combined slip.
///
/// Off the ground (`fz` ≤ 0) all are zero. Every finite input gives finite forces if the coefficients pass
/// [`Coefficients::check`]; what is not a number stays so.
///
/// # Reverse and standstill
/// The wheel that rolls backwards is the wheel that rolls forwards seen from a frame turned by 180° about z: there κ, α,
/// γ, Fx, Fy, Mx and My have the other sign and Mz has the same one. That follows from geometry; that the tire has the
/// same coefficients in both directions is an assumption. (MFeval turns α and the forces but not γ, so that there
/// camber thrust changes its direction when a car backs up. It does not on the road, and not here.)
///
/// Below `VXLOW` everything that would jump at standstill fades with sin²(π/2·Vx/VXLOW): the shifts that inclination does
/// not cause, the differences between driving and braking, trail and residual torque. At standstill the forces are odd in
/// κ and α and finite. Rolling resistance follows the rotation of the wheel, (1 + κ)·Vx: it passes through zero with a
/// sine while that is less than `VXLOW`, so that a locked wheel has none (as MFeval, which jumps to the other sign where
/// the wheel turns backwards fast enough).
///
/// # Choices where the sources differ
/// - The small numbers ε by which the book keeps denominators from zero are left out; the quotients are bounded
///   instead, so that no result depends on ε.
/// - Ky loses (1 − PKY3·|γ|), as the public implementations of 5.2 agree.
/// - `PHY3`·γ stands in SHy by itself, not multiplied by `LHY`.
/// - Dt has R0/FNOMIN, s, Mx and My have Fy/FNOMIN and Fx/FNOMIN: the nominal load as in the file, without `LFZO`.
///   That is PAC2002 and MFeval (which divides Dt by the scaled load, then multiplies the trail by `LFZO`). Others take
///   the scaled one. They differ only if `LFZO` is not 1.
/// - `QSX1` is multiplied by `LVMX` and, as everything in Mx, by `LMX`.
/// - In the aligning moment the lateral force without its κ-induced part is Gyκ·Fy0. MFeval subtracts from Fy a κ-induced
///   part with the friction of γ = 0, another one than it added, so that its Mz differs where `PDY3`·γ² is not 0.
/// - Curvature factors are no more than 1, friction does not change its sign and the weights of combined slip are no less
///   than 0, whatever load, slip and inclination make of them: the sources print this as conditions on E, μ and G.
pub fn steady_with(c: &Coefficients, input: &Input, options: &Options) -> Output {
    if input.fz <= 0.0 {
        return Output { outside: Outside { fz: true, ..Outside::default() }, ..Output::default() };
    }
    let sign = if input.vx < 0.0 { -1.0 } else { 1.0 };
    let turned = Input {
        kappa: sign * input.kappa,
        alpha: sign * input.alpha,
        gamma: sign * input.gamma,
        vx: sign * input.vx,
        ..*input
    };
    let forward = forward(c, &turned, options);
    Output {
        fx: sign * forward.fx,
        fy: sign * forward.fy,
        mx: sign * forward.mx,
        my: sign * forward.my,
        trail: sign * forward.trail,
        ..forward
    }
}

/// As [`steady_with`], for a tire on the ground that does not roll backwards.
fn forward(c: &Coefficients, input: &Input, options: &Options) -> Output {
    let outside = Outside {
        fz: input.fz < c.fzmin || input.fz > c.fzmax,
        kappa: input.kappa < c.kpumin || input.kappa > c.kpumax,
        alpha: input.alpha < c.alpmin || input.alpha > c.alpmax,
        gamma: input.gamma < c.cammin || input.gamma > c.cammax,
    };
    let (fz, kappa, alpha, gamma) = match options.limits {
        Limits::Clamp => (
            limited(input.fz, 0.0, c.fzmax),
            limited(input.kappa, c.kpumin, c.kpumax),
            limited(input.alpha, c.alpmin, c.alpmax),
            limited(input.gamma, c.cammin, c.cammax),
        ),
        Limits::Ignore => (input.fz, input.kappa, input.alpha, input.gamma),
    };
    let alpha = limited(alpha, -FRAC_PI_2, FRAC_PI_2);
    let fade = fade(input.vx, c.vxlow);
    let (lmux, lmuy) = (c.lmux * input.friction, c.lmuy * input.friction);
    // on a slippery road the contact slides, and one slip takes the force from the other, at less of both
    let sooner = quotient(1.0, input.friction);

    // (4.E3, 4.E4) and what stands for them in PAC2002
    let (slip, lean) = match options.slip {
        Slip::Angle => (alpha, gamma),
        Slip::Tangent => (libm::tan(alpha), libm::sin(gamma)),
    };
    let (lean_x, lean_y, lean_z) = (gamma * c.lgax, lean * c.lgay, lean * c.lgaz);
    // (4.E1, 4.E2)
    let nominal = c.lfzo * c.fnomin;
    let dfz = (fz - nominal) / nominal;
    let r0 = c.unloaded_radius;

    // longitudinal force in pure slip (4.E9 to 4.E18)
    let kappa_x = kappa + fade * (c.phx1 + c.phx2 * dfz) * c.lhx;
    let mu_x = friction(c.pdx1, (c.pdx1 + c.pdx2 * dfz) * (1.0 - c.pdx3 * lean_x * lean_x)) * lmux;
    let d_x = mu_x * fz;
    let c_x = c.pcx1 * c.lcx;
    let k_x = bounded(fz * (c.pkx1 + c.pkx2 * dfz) * libm::exp(c.pkx3 * dfz) * c.lkx);
    let e_x = (c.pex1 + c.pex2 * dfz + c.pex3 * dfz * dfz) * (1.0 - fade * c.pex4 * signum(kappa_x)) * c.lex;
    let sv_x = fade * fz * (c.pvx1 + c.pvx2 * dfz) * c.lvx * lmux;
    let along = Curve { b_x: quotient(k_x, c_x * d_x) * kappa_x, c: c_x, e: e_x };

    // lateral force in pure slip (4.E19 to 4.E30)
    let sh_y = fade * (c.phy1 + c.phy2 * dfz) * c.lhy + c.phy3 * lean_y;
    let alpha_y = slip + sh_y;
    let mu_y = friction(c.pdy1, (c.pdy1 + c.pdy2 * dfz) * (1.0 - c.pdy3 * lean_y * lean_y)) * lmuy;
    let d_y = mu_y * fz;
    let c_y = c.pcy1 * c.lcy;
    let k_y =
        c.pky1 * nominal * sin_twice_atan(fz / (c.pky2 * nominal)) * c.lky * (1.0 - c.pky3 * lean_y.abs());
    let b_y = quotient(k_y, c_y * d_y);
    let e_y = (c.pey1 + c.pey2 * dfz) * (1.0 - (fade * c.pey3 + c.pey4 * lean_y) * signum(alpha_y)) * c.ley;
    let sv_y = fz * (fade * (c.pvy1 + c.pvy2 * dfz) * c.lvy + (c.pvy3 + c.pvy4 * dfz) * lean_y) * lmuy;
    let across = Curve { b_x: b_y * alpha_y, c: c_y, e: e_y };

    // by how much each slip takes from the force of the other (4.E50 to 4.E55, 4.E58 to 4.E64): at the slip, and at its shift alone
    let shift_x = fade * c.rhx1;
    let b = c.rbx1 * cos_atan(c.rbx2 * kappa) * c.lxal * sooner;
    let weight_x = |slip: f64| Curve { b_x: b * slip, c: c.rcx1, e: c.rex1 + c.rex2 * dfz };
    let shift_y = fade * (c.rhy1 + c.rhy2 * dfz);
    let b = c.rby1 * cos_atan(c.rby2 * (slip - fade * c.rby3)) * c.lyka * sooner;
    let weight_y = |slip: f64| Curve { b_x: b * slip, c: c.rcy1, e: c.rey1 + c.rey2 * dfz };
    // lateral force that longitudinal slip induces (4.E65 to 4.E67)
    let d_vyk = d_y * (c.rvy1 + c.rvy2 * dfz + fade * c.rvy3 * lean) * cos_atan(c.rvy4 * slip);
    let induced = Curve { b_x: c.rvy6 * kappa, c: c.rvy5, e: 0.0 };

    // trail and residual torque (4.E31 to 4.E49, combined 4.E71 to 4.E78)
    let stiffness_over_friction = c.lky * quotient(1.0, lmuy);
    let alpha_t = slip + c.qhz1 + c.qhz2 * dfz + (c.qhz3 + c.qhz4 * dfz) * lean_z;
    let alpha_r = slip + sh_y + quotient(sv_y, k_y);
    let ratio = quotient(k_x, k_y) * kappa;
    let (sine, cosine) = sines_and_cosines([alpha_t, alpha_r, alpha, 0.0]);
    let cos_alpha = cosine[2];
    let b_t = (c.qbz1 + c.qbz2 * dfz + c.qbz3 * dfz * dfz)
        * (1.0 + c.qbz4 * lean_z + c.qbz5 * lean_z.abs())
        * stiffness_over_friction;
    let c_t = c.qcz1;
    let combined = |a: f64| (a * a + ratio * ratio).sqrt();
    let [angle_t, angle_r, curving, _] = atans([
        combined(sine[0] / cosine[0]),
        combined(sine[1] / cosine[1]),
        bounded(b_t * c_t * alpha_t),
        0.0,
    ]);
    let [equivalent_t, equivalent_r] = match options.slip {
        Slip::Angle => [angle_t * signum(alpha_t), angle_r * signum(alpha_r)],
        Slip::Tangent => [alpha_t, alpha_r].map(|a| combined(a) * signum(a)),
    };
    let d_t = fz
        * (r0 / c.fnomin)
        * (c.qdz1 + c.qdz2 * dfz)
        * (1.0 + c.qdz3 * lean_z + c.qdz4 * lean_z * lean_z)
        * c.ltr;
    let e_t = (c.qez1 + c.qez2 * dfz + c.qez3 * dfz * dfz)
        * (1.0 + (c.qez4 + c.qez5 * lean_z) * FRAC_2_PI * curving);
    let trailing = Curve { b_x: b_t * equivalent_t, c: c_t, e: e_t };

    let (sine, cosine) = sines_and_cosines(angles([along, across, induced, trailing]));
    let (_, weights) = sines_and_cosines(angles([
        weight_x(slip + shift_x),
        weight_x(shift_x),
        weight_y(kappa + shift_y),
        weight_y(shift_y),
    ]));
    let fx0 = d_x * sine[0] + sv_x;
    let fy0 = d_y * sine[1] + sv_y;
    let fx = fx0 * weight(weights[0], weights[1]);
    let fy_slip = fy0 * weight(weights[2], weights[3]);
    let fy = fy_slip + d_vyk * sine[2] * c.lvyka;
    let trail = fade * d_t * cosine[3] * cos_alpha;
    let b_r = c.qbz9 * stiffness_over_friction + c.qbz10 * b_y * c_y;
    let d_r = fz * r0 * ((c.qdz6 + c.qdz7 * dfz) * c.lres + (c.qdz8 + c.qdz9 * dfz) * lean_z) * lmuy;
    let residual_decay = cos_atan(bounded(b_r * equivalent_r));
    let residual_torque = fade * d_r * residual_decay * cos_alpha;
    let arm = r0 * (fade * c.ssz1 + c.ssz2 * (fy / c.fnomin) + (c.ssz3 + c.ssz4 * dfz) * lean) * c.ls;
    let mz = -trail * fy_slip + residual_torque + arm * fx;

    // overturning and rolling resistance moment (4.E69, 4.E70 in the form of PAC2002)
    let mx = r0 * fz * (fade * c.qsx1 * c.lvmx - c.qsx2 * gamma + c.qsx3 * (fy / c.fnomin)) * c.lmx;
    let v = input.vx / c.longvl;
    let v2 = v * v;
    let my = -r0
        * fz
        * (c.qsy1 + c.qsy2 * (fx / c.fnomin) + c.qsy3 * v.abs() + c.qsy4 * v2 * v2)
        * c.lmy
        * spin((1.0 + input.kappa) * input.vx, c.vxlow);

    Output {
        fx,
        fy,
        mx,
        my,
        mz,
        trail,
        residual_torque,
        residual_decay,
        mu_x: mu_x.abs(),
        mu_y: mu_y.abs(),
        slip_stiffness: k_x,
        cornering_stiffness: k_y,
        outside,
    }
}

/// The vertical force \[N\] of a tire deflected by `deflection` \[m\] that deflects further at `rate` \[m/s\]:
/// spring and damper, never pulling. Zero without deflection.
///
/// Fz = λCz·Cz·ρ + Kz·dρ/dt (PAC2002, linear stiffness).
pub fn vertical_force(c: &Coefficients, deflection: f64, rate: f64) -> f64 {
    if deflection <= 0.0 {
        return 0.0;
    }
    at_least_zero(c.lcz * c.vertical_stiffness * deflection + c.vertical_damping * rate)
}

/// The deflection \[m\] at which the tire at rest carries `fz` \[N\]; zero off the ground.
pub fn static_deflection(c: &Coefficients, fz: f64) -> f64 {
    at_least_zero(fz) / (c.lcz * c.vertical_stiffness)
}

/// The effective rolling radius \[m\] at the wheel load `fz` \[N\]: speed of travel over rotational speed of the freely
/// rolling wheel.
///
/// Re = R0 − ρFz0·(DREFF·atan(BREFF·ρd) + FREFF·ρd) with ρFz0 = Fz0/Cz and ρd = ρ/ρFz0 (PAC2002). With a linear
/// stiffness ρd = Fz/Fz0.
pub fn effective_rolling_radius(c: &Coefficients, fz: f64) -> f64 {
    let ratio = at_least_zero(fz) / c.fnomin;
    c.unloaded_radius
        - static_deflection(c, c.fnomin) * (c.dreff * libm::atan(c.breff * ratio) + c.freff * ratio)
}

/// The relaxation lengths \[m\] at the wheel load `fz` \[N\] and the inclination angle `gamma` \[rad\]; zero off the
/// ground, and zero where the coefficients would make them negative.
///
/// σκ = Fz·(PTX1 + PTX2·dfz)·exp(−PTX3·dfz)·(R0/Fz0)·λσκ,
/// σα = PTY1·sin(2·atan(Fz/(PTY2·Fz0·λFz0)))·(1 − PKY3·|γy|)·R0·λFz0·λσα.
///
/// The sign of `PTX3`: MFeval has exp(−PTX3·dfz), citing the MF-Tyre manual, Chrono exp(+PTX3·dfz). Files have `PTX3`
/// of about −`PKX3`. As σκ is slip stiffness over carcass stiffness, it must grow with load as the slip stiffness does,
/// exp(PKX3·dfz): the minus is right.
pub fn relaxation_lengths(c: &Coefficients, fz: f64, gamma: f64) -> RelaxationLengths {
    let fz = limited(fz, 0.0, c.fzmax);
    let gamma = limited(gamma, c.cammin, c.cammax) * c.lgay;
    let nominal = c.lfzo * c.fnomin;
    let dfz = (fz - nominal) / nominal;
    let kappa =
        fz * (c.ptx1 + c.ptx2 * dfz) * libm::exp(-c.ptx3 * dfz) * (c.unloaded_radius / c.fnomin) * c.lsgkp;
    let alpha = c.pty1
        * sin_twice_atan(quotient(fz, c.pty2 * nominal))
        * (1.0 - c.pky3 * gamma.abs())
        * c.unloaded_radius
        * c.lfzo
        * c.lsgal;
    RelaxationLengths { kappa: at_least_zero(bounded(kappa)), alpha: at_least_zero(alpha) }
}

/// The gyroscopic couple about z \[N m\] that the belt adds to the aligning moment while its lateral deflection changes.
///
/// Mz,gyr = QTZ1·λgyr·MBELT·Vrl·(dv/dt)·cos(atan(Br·αr,eq)) (PAC2002), with the rolling speed `rolling_speed` Re·ω
/// \[m/s\], the rate of the lateral deflection of the tire `deflection_rate` \[m/s\], and [`Output::residual_decay`].
pub fn gyroscopic_couple(
    c: &Coefficients,
    rolling_speed: f64,
    deflection_rate: f64,
    residual_decay: f64,
) -> f64 {
    c.qtz1 * c.lgyr * c.mbelt * rolling_speed * deflection_rate * residual_decay
}

/// Peak friction, which has the sign of `nominal`, that at nominal load, or is zero. (Some files have a negative one. As
/// the stiffness is given by itself, B is then negative as well and the force is the same.)
fn friction(nominal: f64, value: f64) -> f64 {
    if value * nominal < 0.0 { 0.0 } else { value }
}

/// C·atan(Bx − E·(Bx − atan(Bx))), the angle whose sine or cosine is taken.
#[derive(Clone, Copy)]
struct Curve {
    b_x: f64,
    c: f64,
    e: f64,
}

/// The angles of four curves. E is no more than 1: beyond, the curve would turn back before its peak.
fn angles(curves: [Curve; 4]) -> [f64; 4] {
    let b_x = curves.map(|curve| bounded(curve.b_x));
    let first = atans(b_x);
    let inner = std::array::from_fn(|i| {
        let e = if curves[i].e > 1.0 { 1.0 } else { curves[i].e };
        b_x[i] - e * (b_x[i] - first[i])
    });
    let second = atans(inner);
    std::array::from_fn(|i| curves[i].c * second[i])
}

/// cos(atan(x)), without either: they are most of what the equations cost.
fn cos_atan(x: f64) -> f64 {
    1.0 / (1.0 + x * x).sqrt()
}

/// sin(2·atan(x)), as [`cos_atan`].
fn sin_twice_atan(x: f64) -> f64 {
    let x = bounded(x);
    2.0 * x / (1.0 + x * x)
}

/// The factor by which slip in one direction reduces the force in the other, 1 without that slip, from the cosines at the slip and at its shift alone.
fn weight(cosine: f64, at_shift: f64) -> f64 {
    // without a shift the denominator is 1; with one it is zero only for coefficients that make no sense
    at_least_zero(quotient(cosine, at_shift))
}

/// Dividing without ever getting infinity or, from finite numbers, what is not a number. x/0 is 0: wherever a
/// denominator can be zero the force that the quotient belongs to is zero as well.
fn quotient(numerator: f64, denominator: f64) -> f64 {
    if denominator == 0.0 { 0.0 } else { bounded(numerator / denominator) }
}

/// So large that an arc tangent does not change any more, so small that squares and products stay finite.
const LARGE: f64 = 1e60;

fn bounded(x: f64) -> f64 {
    limited(x, -LARGE, LARGE)
}

/// As `f64::clamp`, but what is not a number stays so, and ends in the wrong order do not panic.
fn limited(x: f64, low: f64, high: f64) -> f64 {
    if x < low {
        low
    } else if x > high {
        high
    } else {
        x
    }
}

/// As `max(0.0)`, but what is not a number stays so.
fn at_least_zero(x: f64) -> f64 {
    if x < 0.0 { 0.0 } else { x }
}

/// 1 or −1, and 1 for zero.
fn signum(x: f64) -> f64 {
    if x < 0.0 { -1.0 } else { 1.0 }
}

/// 1 or −1 as the wheel turns forwards or backwards, smooth while its rolling speed `v` is less than `low`: what resists
/// the rotation of the wheel follows that, not the travel, and a locked wheel has no rolling resistance.
fn spin(v: f64, low: f64) -> f64 {
    if v == 0.0 {
        0.0
    } else if v.abs() >= low {
        signum(v)
    } else {
        libm::sin(FRAC_PI_2 * v / low)
    }
}

/// 0 at standstill, 1 from `low` on, and smooth.
fn fade(v: f64, low: f64) -> f64 {
    if v >= low {
        1.0
    } else {
        let sine = libm::sin(FRAC_PI_2 * v / low);
        sine * sine
    }
}
