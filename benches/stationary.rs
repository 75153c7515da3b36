//! How long a stationary state of the ring-and-brush tire takes: `cargo bench --bench stationary`. Every figure is
//! the median of several runs; ratios are what to compare between machines.
#![allow(clippy::unwrap_used)]

use latsch::model::{Native, Settings};
use latsch::rig::RingBrushFlatTrack;
use latsch::tire::ring_brush::{Prepared, stationary};
use latsch::tire::{Motion, Vertical};
use nalgebra::Vector3;
use std::hint::black_box;
use std::time::Instant;

const ROUNDS: usize = 7;
/// Searches of one measurement.
const SEARCHES: u32 = 20;

/// Seconds that `work` takes, the median of its runs.
fn time(rounds: usize, mut work: impl FnMut()) -> f64 {
    let mut seconds: Vec<f64> = (0..rounds)
        .map(|_| {
            let start = Instant::now();
            work();
            start.elapsed().as_secs_f64()
        })
        .collect();
    seconds.sort_by(f64::total_cmp);
    seconds[seconds.len() / 2]
}

/// A wheel at a speed \[m/s\], slip, slip angle and camber \[rad\]; a slip of -1 is a locked wheel.
#[derive(Clone, Copy)]
struct Point {
    name: &'static str,
    load: f64,
    speed: f64,
    slip: f64,
    angle: f64,
    camber: f64,
}

const COMBINED: Point =
    Point { name: "combined slip", load: 4000.0, speed: 10.0, slip: 0.03, angle: 0.03, camber: 0.0 };

const POINTS: [Point; 12] = [
    COMBINED,
    Point { name: "1 kN", load: 1000.0, ..COMBINED },
    Point { name: "8 kN", load: 8000.0, ..COMBINED },
    Point { name: "free rolling", slip: 0.0, angle: 0.0, ..COMBINED },
    Point { name: "small slip", slip: 0.003, angle: -0.004, ..COMBINED },
    Point { name: "slip angle", slip: 0.0, angle: 0.05, ..COMBINED },
    Point { name: "braking", slip: -0.1, angle: 0.0, ..COMBINED },
    Point { name: "large slips", slip: -0.3, angle: 0.3, ..COMBINED },
    Point { name: "camber", slip: 0.0, angle: 0.0, camber: 0.1, ..COMBINED },
    Point { name: "all of it, fast", speed: 40.0, camber: -0.05, ..COMBINED },
    Point { name: "locked", slip: -1.0, angle: 0.1, ..COMBINED },
    Point { name: "standstill", speed: 0.0, ..COMBINED },
];

fn rim(tire: &Prepared, point: &Point) -> Motion<f64> {
    let (sin, cos) = libm::sincos(point.angle);
    Motion {
        velocity: Vector3::new(point.speed * cos, point.speed * sin, 0.0),
        angles: Vector3::new(point.camber, 0.0, 0.0),
        rates: Vector3::new(
            0.0,
            (1.0 + point.slip) * point.speed * cos / tire.parameters().rolling_radius,
            0.0,
        ),
        ..Motion::default()
    }
}

fn main() {
    // cargo test runs benchmarks with --test to see that they work
    let (rounds, searches) =
        if std::env::args().any(|a| a == "--test") { (1, 1) } else { (ROUNDS, SEARCHES) };
    let tire = Native::<RingBrushFlatTrack>::new(&Settings::default()).unwrap();
    let parameters = tire.model().tire().parameters.clone();
    let tire = Prepared::new(&parameters, &latsch::road::Road::default()).unwrap();

    let powers = time(rounds, || {
        for k in 0..1000 {
            black_box(libm::pow(black_box(1e-3 * f64::from(k)), black_box(5.3)));
        }
    });
    println!("yardstick: 1000 libm pow   {:8.3} ms", powers * 1e3);
    println!(
        "\na stationary state, 6 stripes        from the start  of the yardstick  from a near one  of the yardstick"
    );
    for point in &POINTS {
        let load = Vertical::Load(point.load);
        let search = |seconds: f64| seconds / f64::from(searches);
        let goal = rim(&tire, point);
        let fresh = search(time(rounds, || {
            for _ in 0..searches {
                black_box(stationary(&tire, black_box(&goal), load, 1.0).unwrap());
            }
        }));
        // a step of a sweep
        let before = Point { slip: point.slip - 1e-3, angle: point.angle - 1e-3, ..*point };
        let before = stationary(&tire, &rim(&tire, &before), load, 1.0).unwrap();
        let near = search(time(rounds, || {
            for _ in 0..searches {
                black_box(before.near(&tire, black_box(&goal), load, 1.0).unwrap());
            }
        }));
        println!(
            "  {:<20} {:4.0} kN  {:12.3} ms {:17.1} {:13.3} ms {:17.1}",
            point.name,
            point.load * 1e-3,
            fresh * 1e3,
            fresh / powers,
            near * 1e3,
            near / powers,
        );
    }
}
