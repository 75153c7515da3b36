//! The sidewall: springs and dampers between rim and belt (8.2 of the specification, equations 4.2 to 4.9).

use super::frames::Motion;
use super::frames::{Frame, Vector, add, cross, dot, minus, times};
use super::parameters::Parameters;

/// What the sidewall does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sidewall {
    /// On the belt, in its frame (4.6, 4.7) \[N, N.m\].
    pub(crate) own: (Vector, Vector),
    /// On the belt, in inertial axes (4.8).
    pub(crate) belt: (Vector, Vector),
    /// On the rim, in inertial axes (4.9).
    pub(crate) rim: (Vector, Vector),
}

impl Sidewall {
    pub(crate) fn new(p: &Parameters, (rim, f): (&Motion, &Frame), (belt, g): (&Motion, &Frame)) -> Self {
        let apart = minus(rim.place, belt.place);
        let way = g.into(apart);
        let speed = g.into(minus(minus(rim.velocity, belt.velocity), cross(g.omega, apart)));
        // single entries of A_FG and of its derivative (4.4, 4.5), as printed: the antisymmetric part is another model
        let turning = minus(f.omega, g.omega);
        let pairs = [(2, 1), (0, 2), (1, 0)];
        let angle = pairs.map(|(m, n): (usize, usize)| dot(g.axes[m], f.axes[n]));
        let rate = pairs.map(|(m, n)| dot(g.axes[m], cross(turning, f.axes[n])));
        let [radial, lateral, tilt, windup] = [
            (p.sidewall_radial_stiffness, p.sidewall_radial_damping),
            (p.sidewall_lateral_stiffness, p.sidewall_lateral_damping),
            (p.sidewall_tilt_stiffness, p.sidewall_tilt_damping),
            (p.sidewall_windup_stiffness, p.sidewall_windup_damping),
        ];
        let law = |(c, d): (f64, f64), x: f64, v: f64| c * x + d * v;
        let force =
            [law(radial, way[0], speed[0]), law(lateral, way[1], speed[1]), law(radial, way[2], speed[2])];
        let moment =
            [law(tilt, angle[0], rate[0]), law(windup, angle[1], rate[1]), law(tilt, angle[2], rate[2])];
        let belt = (g.out(force), g.out(moment));
        let rim = (times(belt.0, -1.0), add(times(belt.1, -1.0), cross(apart, belt.0)));
        Self { own: (force, moment), belt, rim }
    }
}
