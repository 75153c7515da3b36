//! The source's equations once more, written from them and sharing no code with the product: a wheel whose speed is led, its height
//! and all elements free, by Dormand and Prince's explicit method.

use std::f64::consts::{PI, TAU};

/// A wheel with equal elements, one contact point each; SI units.
#[derive(Clone)]
pub struct Wheel {
    pub elements: usize,
    pub stiffness: f64,
    pub damping: f64,
    /// Mass of all elements, and of what else hangs on the rim.
    pub rubber: f64,
    pub mass: f64,
    /// Speed and spin speed, which are led.
    pub speed: f64,
    pub spin: f64,
    /// Contact: N/m^e, e, N.s/m, m.
    pub contact: (f64, f64, f64, f64),
    /// Points of the road.
    pub road: Vec<(f64, f64)>,
    pub gravity: f64,
}

pub const RADIUS: f64 = 0.2265;
pub const THICKNESS: f64 = 0.005;

impl Wheel {
    fn road_at(&self, x: f64) -> (f64, f64) {
        let last = self.road.len() - 2;
        let i = (0..=last).rev().find(|i| self.road[*i].0 <= x).unwrap_or(0);
        let ((x0, z0), (x1, z1)) = (self.road[i], self.road[i + 1]);
        let slope = (z1 - z0) / (x1 - x0);
        (z0 + slope * (x - x0), slope)
    }

    /// Angle of element n at a time.
    fn angle(&self, n: usize, time: f64) -> f64 {
        n as f64 * TAU / self.elements as f64 - PI / 2.0 - self.spin * time
    }

    /// Contact force on an element whose middle is at a distance and moves with a speed: forward, up.
    fn contact(&self, n: usize, time: f64, (z, vz): (f64, f64), (r, v): (f64, f64)) -> (f64, f64) {
        let (sin, cos) = self.angle(n, time).sin_cos();
        if sin >= 0.0 {
            return (0.0, 0.0);
        }
        let out = r + THICKNESS / 2.0;
        let (x, height) = (self.speed * time + out * cos, z + out * sin);
        let (road, slope) = self.road_at(x);
        let tilt = slope.atan();
        let depth = (road - height) * tilt.cos();
        if depth <= 0.0 {
            return (0.0, 0.0);
        }
        let velocity = (self.speed + v * cos + out * self.spin * sin, vz + v * sin - out * self.spin * cos);
        let leaving = -tilt.sin() * velocity.0 + tilt.cos() * velocity.1;
        let (k, e, d, full) = self.contact;
        let s = (depth / full).min(1.0);
        let force = (k * depth.powf(e) - d * s * s * (3.0 - 2.0 * s) * leaving).max(0.0);
        (-tilt.sin() * force, tilt.cos() * force)
    }

    /// State: z, its speed, distances, speeds of the elements. Derivatives by the arrow-shaped system (4-45 to 4-48).
    fn slope(&self, time: f64, y: &[f64], dy: &mut [f64]) {
        let n = self.elements;
        let m = self.rubber / n as f64;
        let free = RADIUS - THICKNESS / 2.0;
        let (z, vz) = (y[0], y[1]);
        // M z'' + sum m sin r'' = ..., and m sin z'' + m r'' = g_n
        let mut whole = self.mass + self.rubber;
        let mut force = -whole * self.gravity;
        let mut own = vec![0.0; n];
        for k in 0..n {
            let (sin, cos) = self.angle(k, time).sin_cos();
            let (r, v) = (y[2 + k], y[2 + n + k]);
            let (fx, fz) = self.contact(k, time, (z, vz), (r, v));
            let radial = self.stiffness * (r - free) + self.damping * v;
            own[k] = -radial - m * self.gravity * sin + fx * cos + fz * sin + m * r * self.spin * self.spin;
            let bar = -2.0 * v * self.spin * cos - r * self.spin * self.spin * sin;
            force += fz - m * bar - sin * own[k];
            whole -= m * sin * sin;
        }
        let up = force / whole;
        dy[0] = vz;
        dy[1] = up;
        for k in 0..n {
            dy[2 + k] = y[2 + n + k];
            dy[2 + n + k] = own[k] / m - self.angle(k, time).sin() * up;
        }
    }

    /// One step of Dormand and Prince's method of fifth order.
    pub fn step(&self, time: f64, y: &mut [f64], h: f64) {
        const A: [&[f64]; 6] = [
            &[],
            &[1.0 / 5.0],
            &[3.0 / 40.0, 9.0 / 40.0],
            &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
            &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0],
            &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0],
        ];
        const B: [f64; 6] = [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0];
        const C: [f64; 6] = [0.0, 1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0];
        let mut stages: Vec<Vec<f64>> = Vec::new();
        for (a, c) in A.iter().zip(C) {
            let mut at = y.to_vec();
            for (stage, a) in stages.iter().zip(*a) {
                at.iter_mut().zip(stage).for_each(|(y, k)| *y += h * a * k);
            }
            let mut slope = vec![0.0; y.len()];
            self.slope(time + c * h, &at, &mut slope);
            stages.push(slope);
        }
        for (stage, b) in stages.iter().zip(B) {
            y.iter_mut().zip(stage).for_each(|(y, k)| *y += h * b * k);
        }
    }
}
