//! The reduced stationary problem: unknowns belt camber, yaw, wind-up, F_x, F_y, M_z. Written from the equations; nothing of
//! the product is used.

use std::f64::consts::FRAC_PI_2;

const C_LIN: f64 = 1.54e5;
const C_QUAD: f64 = 2.47e6;
const C_RAD: f64 = 4.67e6;
const C_LAT: f64 = 8.5e4;
const C_TILT: f64 = 8e4;
const C_SPIN: f64 = 4.51e5;
const D_RAD: f64 = 449.0;
const D_TILT: f64 = 9.61;
const R_CROSS: f64 = 0.675;
const R_MAX: f64 = 0.338;
const R_DYN: f64 = 0.328;
const WIDTH: f64 = 0.225;
const C_BRISTLE: f64 = 4e4;
const D_BRISTLE: f64 = 0.65;
const L_BRISTLE: f64 = 0.014;
const STRIPES: usize = 6;
const LENGTH_FACTOR: f64 = 0.75;
const N_X: f64 = 3e-6;
const N_Y: f64 = 8e-7;
const N_TWIST: f64 = 1e-4;
const LEVER: f64 = 0.01;
const WEIGHT: f64 = 8.8 * 9.81;
const STATIC: [f64; 2] = [1.5, 1.4];
const KINETIC: [f64; 2] = [1.1, 1.0];
const P_REFERENCE: f64 = 2e5;

pub type Case = super::Point;

/// What the tables print.
#[derive(Debug, Clone, Copy)]
pub struct Answer {
    pub force: [f64; 3],
    pub moment: [f64; 3],
    pub camber: f64,
    pub yaw: f64,
    pub deflection: f64,
    /// Largest residual over the load (moments: load times 0.3 m).
    pub residual: f64,
}

type V = [f64; 3];
type M = [[f64; 3]; 3];

fn mul(a: &M, b: &M) -> M {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}
fn turn(a: &M, v: &V) -> V {
    std::array::from_fn(|i| (0..3).map(|k| a[i][k] * v[k]).sum())
}
fn transpose(a: &M) -> M {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i]))
}
fn cross(a: &V, b: &V) -> V {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
fn rx(a: f64) -> M {
    [[1., 0., 0.], [0., a.cos(), -a.sin()], [0., a.sin(), a.cos()]]
}
fn ry(a: f64) -> M {
    [[a.cos(), 0., a.sin()], [0., 1., 0.], [-a.sin(), 0., a.cos()]]
}
fn rz(a: f64) -> M {
    [[a.cos(), -a.sin(), 0.], [a.sin(), a.cos(), 0.], [0., 0., 1.]]
}

/// Penetration for a load on the rim.
pub fn penetration(load: f64) -> f64 {
    (-C_LIN + (C_LIN * C_LIN + 4.0 * C_QUAD * (load + WEIGHT)).sqrt()) / (2.0 * C_QUAD)
}

pub fn exponents(f: f64) -> [f64; 2] {
    [(3.8 + 90.5 * f + 1450.0 * f * f).max(1.0), (6.0 + 129.0 * f + 2070.0 * f * f).max(1.0)]
}

fn width_of_stripe() -> f64 {
    3.0 * WIDTH / (3.0 * STRIPES as f64 - 1.0)
}

fn place_of_stripe(i: usize) -> f64 {
    width_of_stripe() * ((STRIPES as f64 + 1.0) / 2.0 - (i as f64 + 1.0))
}

/// Corrected lengths of the stripes.
pub fn lengths(h: f64, eps: f64) -> [f64; STRIPES] {
    std::array::from_fn(|i| {
        let y = place_of_stripe(i);
        let r = R_MAX + (R_CROSS * R_CROSS - y * y).sqrt() - R_CROSS;
        let s = h + y * eps.tan();
        if s < r { LENGTH_FACTOR * 2.0 * r * (s / r).acos() } else { 0.0 }
    })
}

struct Solver {
    case: Case,
    n: usize,
    /// 1 - |2x/l|^e at the points of a stripe: the same for all stripes.
    shape: Vec<f64>,
    e_q: f64,
    f: f64,
    fz: f64,
}

struct Patch {
    residual: [f64; 6],
    force: V,
    side_moment: V,
    height: f64,
}

impl Solver {
    fn new(case: Case, n: usize) -> Self {
        let f = penetration(case.load);
        let [e_l, e_q] = exponents(f);
        let shape = (0..n).map(|k| 1.0 - (2.0 * Self::at(k, n)).abs().powf(e_l)).collect();
        Self { case, n, shape, e_q, f, fz: case.load + WEIGHT }
    }

    /// The points lie in the middle of the intervals, yet a bristle is loaded from the front to
    /// its first point for a whole interval: that is what makes the march first order, and what
    /// the tables contain.
    ///
    /// Place of point k over the length of the stripe, from the front.
    fn at(k: usize, n: usize) -> f64 {
        0.5 - (k as f64 + 0.5) / n as f64
    }

    fn patch(&self, share: f64, u: &[f64; 6]) -> Patch {
        let &[eps, yaw, windup, fx, fy, mz] = u;
        let Case { speed, .. } = self.case;
        let (slip, alpha, camber) =
            (share * self.case.slip, share * self.case.alpha, share * self.case.camber);
        let spin =
            if (alpha - FRAC_PI_2).abs() < 1e-12 { 0.0 } else { (slip + 1.0) * speed * alpha.cos() / R_DYN };
        let feed = -R_DYN * spin;

        let half = WIDTH / 2.0;
        let d = if eps.sin().abs() <= half / R_CROSS {
            (R_MAX - R_CROSS) * eps.cos() + R_CROSS
        } else {
            (R_MAX - R_CROSS + (R_CROSS * R_CROSS - half * half).sqrt()) * eps.cos() + half * eps.sin().abs()
        };
        let height = d - self.f;
        let h = height / eps.cos();
        let centre = [0.0, -h * eps.sin(), h * eps.cos()];

        let n_bend = N_Y / (R_MAX * R_MAX);
        let v_x = speed * (alpha + yaw).cos() - R_DYN * spin;
        let v_y = |x: f64| {
            -speed * (alpha + yaw).sin()
                + (N_TWIST * mz - 2.0 * n_bend * fy * x - eps.sin() * x / R_DYN) * feed
        };

        let lengths = lengths(h, eps);
        let lateral: [f64; STRIPES] = std::array::from_fn(|i| {
            (1.0 - (2.0 * place_of_stripe(i).abs() / WIDTH).powf(self.e_q)) * lengths[i]
        });
        let (mut s0, mut s1, mut s2) = (0.0, 0.0, 0.0);
        for i in 0..STRIPES {
            let w = lengths[i] / (self.n as f64 * L_BRISTLE);
            for k in 0..self.n {
                let x = Self::at(k, self.n) * lengths[i];
                let s = self.shape[k] * lateral[i] * w;
                s0 += s;
                s1 += x * s;
                s2 += x * x * s;
            }
        }
        let shift = N_X * fx;
        let m_y = -LEVER * self.fz * (R_DYN * spin).clamp(-1.0, 1.0) - fx * (R_DYN - h);
        let t = m_y + shift * self.fz;
        let area = L_BRISTLE * width_of_stripe();
        let a = (t * s1 + self.fz * s2) / (s0 * s2 - s1 * s1) / area;
        let b = (t * s0 + self.fz * s1) / (s1 * s1 - s0 * s2) / area;

        let mut force = [0.0, 0.0, self.fz];
        let mut moment = [0.0, m_y, 0.0];
        for i in 0..STRIPES {
            let l = lengths[i];
            if l == 0.0 {
                continue;
            }
            let w = l / (self.n as f64 * L_BRISTLE);
            let dt = if spin == 0.0 { f64::INFINITY } else { l / self.n as f64 / feed.abs() };
            let y = place_of_stripe(i);
            let (mut defl, mut stick) = ([0.0; 2], false);
            for k in 0..self.n {
                let x = Self::at(k, self.n) * l;
                let p = (a + b * x) * self.shape[k] * lateral[i];
                let fz = area * p;
                let mu = |m: [f64; 2]| m[0] + (m[1] - m[0]) * p / P_REFERENCE;
                let (f_h, f_g) = (mu(STATIC) * fz.max(0.0), mu(KINETIC) * fz.max(0.0));
                let v = [v_x, v_y(x)];
                let f = if dt.is_infinite() {
                    let size = v[0].hypot(v[1]);
                    v.map(|v| -f_g * v / size)
                } else {
                    let trial: [f64; 2] =
                        std::array::from_fn(|c| C_BRISTLE * (defl[c] - dt * v[c]) - D_BRISTLE * v[c]);
                    let size = trial[0].hypot(trial[1]);
                    stick = fz > 0.0 && size <= if stick { f_h } else { f_g };
                    let f = if stick || size == 0.0 { trial } else { trial.map(|w| w * f_g / size) };
                    defl = std::array::from_fn(|c| {
                        (f[c] * dt + D_BRISTLE * defl[c]) / (D_BRISTLE + C_BRISTLE * dt)
                    });
                    f
                };
                let x_def = x + shift;
                let y_def = y + N_Y * fy + N_TWIST * mz * x - n_bend * fy * x * x;
                force[0] += w * f[0];
                force[1] += w * f[1];
                moment[0] += w * y_def * fz;
                moment[2] += w * (x_def * f[1] - y_def * f[0]);
            }
        }

        let to_road = rz(yaw);
        let about = cross(&centre, &force);
        let belt_moment = turn(&to_road, &std::array::from_fn(|c| moment[c] - about[c]));
        let tilt = mul(&rz(yaw), &rx(eps));
        let r = mul(&transpose(&tilt), &mul(&rx(camber), &ry(windup)));
        let (r32, r13, r21) = (r[2][1], r[0][2], r[1][0]);
        let side_moment = turn(
            &tilt,
            &[C_TILT * r32 - D_TILT * r21 * spin, C_SPIN * r13, C_TILT * r21 + D_TILT * r32 * spin],
        );
        let (f_scale, m_scale) = (self.case.load, 0.3 * self.case.load);
        let residual = [
            (belt_moment[0] + side_moment[0]) / m_scale,
            (belt_moment[1] + side_moment[1]) / m_scale,
            (belt_moment[2] + side_moment[2]) / m_scale,
            (force[0] - fx) / f_scale,
            (force[1] - fy) / f_scale,
            (moment[2] - mz) / m_scale,
        ];
        Patch { residual, force: turn(&to_road, &force), side_moment, height }
    }

    fn newton(&self, share: f64, u: &mut [f64; 6], tolerance: f64) -> f64 {
        let size = |r: &[f64; 6]| r.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        let mut best = self.patch(share, u).residual;
        // Large steps of the differences average over the breaking away of single points; where
        // the search stalls, others are tried.
        for scale in [1e-4, 1e-5, 1e-3, 3e-5, 3e-4] {
            let steps = [1e-1, 1e-2, 1e-1, 1e4, 1e4, 1e3].map(|s: f64| s * scale);
            for _ in 0..12 {
                if size(&best) < tolerance {
                    return size(&best);
                }
                let mut jacobian = [[0.0; 7]; 6];
                for j in 0..6 {
                    let (mut up, mut down) = (*u, *u);
                    up[j] += steps[j];
                    down[j] -= steps[j];
                    let (up, down) = (self.patch(share, &up).residual, self.patch(share, &down).residual);
                    for i in 0..6 {
                        jacobian[i][j] = (up[i] - down[i]) / (2.0 * steps[j]);
                    }
                }
                for i in 0..6 {
                    jacobian[i][6] = best[i];
                }
                let Some(direction) = gauss(jacobian) else { break };
                let mut fraction = 1.0;
                let improved = loop {
                    let trial: [f64; 6] = std::array::from_fn(|i| u[i] - fraction * direction[i]);
                    let next = self.patch(share, &trial).residual;
                    if size(&next) < size(&best) {
                        let much = size(&next) < 0.99 * size(&best);
                        (*u, best) = (trial, next);
                        break much;
                    }
                    fraction *= 0.5;
                    if fraction < 1e-3 {
                        break false;
                    }
                };
                if !improved {
                    break;
                }
            }
        }
        size(&best)
    }
}

/// Gauss with pivoting on [A | b].
fn gauss(mut m: [[f64; 7]; 6]) -> Option<[f64; 6]> {
    for c in 0..6 {
        let pivot = (c..6).max_by(|a, b| m[*a][c].abs().total_cmp(&m[*b][c].abs()))?;
        m.swap(c, pivot);
        if m[c][c] == 0.0 {
            return None;
        }
        for r in 0..6 {
            if r != c {
                let factor = m[r][c] / m[c][c];
                let pivot = m[c];
                for (entry, above) in m[r].iter_mut().zip(pivot) {
                    *entry -= factor * above;
                }
            }
        }
    }
    Some(std::array::from_fn(|i| m[i][6] / m[i][i]))
}

/// Solves a case with n points per stripe, approaching it from straight rolling.
pub fn solve(case: Case, n: usize) -> Answer {
    let solver = Solver::new(case, n);
    let mut u = [0.0; 6];
    let locked = (case.alpha - FRAC_PI_2).abs() < 1e-12;
    let (coarse, parts) = (Solver::new(case, 200), 5);
    if !locked {
        for part in 1..=parts {
            coarse.newton(f64::from(part) / f64::from(parts), &mut u, 1e-3);
        }
    }
    let residual = solver.newton(1.0, &mut u, 1e-9);
    let patch = solver.patch(1.0, &u);

    let spin = if locked { 0.0 } else { (case.slip + 1.0) * case.speed * case.alpha.cos() / R_DYN };
    let on_belt = [-patch.force[0], -patch.force[1], WEIGHT - patch.force[2]];
    let tilt = mul(&rz(u[1]), &rx(u[0]));
    let local = turn(&transpose(&tilt), &on_belt);
    // (4.39): [c 0 -d; 0 q 0; d 0 c] r = F
    let (c, d) = (C_RAD, D_RAD * spin);
    let det = c * c + d * d;
    let apart = turn(
        &tilt,
        &[(c * local[0] + d * local[2]) / det, local[1] / C_LAT, (c * local[2] - d * local[0]) / det],
    );
    let lever = cross(&apart, &on_belt);
    Answer {
        force: on_belt.map(|f| -f),
        moment: std::array::from_fn(|k| -patch.side_moment[k] + lever[k]),
        camber: u[0],
        yaw: u[1],
        deflection: R_MAX - patch.height - apart[2],
        residual,
    }
}
