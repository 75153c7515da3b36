//! The car's stop with four channels of ABS.
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod causes;
#[path = "../common/mod.rs"]
mod common;
mod controller;
mod physics;
mod procedures;

const WHEELS: [&str; 4] = ["front_left", "front_right", "rear_left", "rear_right"];

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn deviation(values: &[f64]) -> f64 {
    let mean = mean(values);
    (values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / values.len() as f64).sqrt()
}

/// Amplitude of what a signal does between two frequencies \[Hz\], behind a Hamming window.
fn amplitude(values: &[f64], step: f64, band: [f64; 2]) -> f64 {
    let mean = mean(values);
    let n = values.len() as f64;
    let bin = 1.0 / (n * step);
    let (first, last) = ((band[0] / bin).ceil() as usize, (band[1] / bin).floor() as usize);
    let square = |k: usize| {
        let (mut re, mut im) = (0.0, 0.0);
        for (i, value) in values.iter().enumerate() {
            let turn = std::f64::consts::TAU * i as f64;
            let window = 0.54 - 0.46 * (turn / (n - 1.0)).cos();
            re += window * (value - mean) * (turn * k as f64 / n).cos();
            im += window * (value - mean) * (turn * k as f64 / n).sin();
        }
        (re * re + im * im) * (2.0 / (0.54 * n)).powi(2)
    };
    (first..=last).map(square).sum::<f64>().sqrt()
}
