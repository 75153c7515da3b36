//! The drum rig: sums over elements on a round road, the arm's two masses, the turn of the drum, and where the energy goes.

use super::common::Shipped;

const RIG: &str = "super-elastic-drum";

/// No cleat.
const BARE: (&str, f64) = ("road_kind", 1.0);
/// As printed but for one contact point, the whole force on the rim and hardly any rubber, so that sums are those of springs.
const SPRINGS: &[(&str, f64)] = &[
    ("contact_points", 1.0),
    ("rim_force", 2.0),
    ("rubber_mass", 0.45),
    ("contact_stiffness", 1e8),
    ("contact_stiffness_of", 2.0),
    ("step_size", 2e-4),
];

fn with(more: &[(&str, f64)]) -> Vec<(&'static str, f64)> {
    // names live as long as the test
    let own = more.iter().map(|(name, value)| (&*String::from(*name).leak(), *value));
    SPRINGS.iter().copied().chain(own).collect()
}

/// Force of springs on a drum of a radius (negative: inside), pressed together by `e` \[m\]: sum of k z dh/dD over the elements
/// that reach the drum, with the distance h of the drum along their rays.
fn static_force(radius: f64, e: f64) -> f64 {
    let (r0, k, pitch) = (0.2265, 1.22e5, std::f64::consts::TAU / 45.0);
    let distance = radius + r0 - e;
    (-11..=11)
        .map(|n| {
            let (sin, cos) = (f64::from(n) * pitch).sin_cos();
            let root = (radius * radius - distance * distance * sin * sin).sqrt() * radius.signum();
            let h = distance * cos - root;
            let by_distance = cos + distance * sin * sin / root;
            if h < r0 { k * (r0 - h) * by_distance } else { 0.0 }
        })
        .sum()
}

#[test]
fn a_standing_wheel_carries_the_sum_of_its_springs() {
    let mut last = 0.0;
    for radius in [-0.8, -2.0, 50.0, 1.0, 0.5] {
        let inside = f64::from(u8::from(radius < 0.0));
        let mut rig = Shipped::new(
            RIG,
            &with(&[
                BARE,
                ("drum_speed", 0.0),
                ("drum_diameter", 2.0 * f64::abs(radius)),
                ("drum_inside", inside),
            ]),
        );
        let lowered = rig.get("wheel_lowered");
        // less the rubber, which hangs on the springs, and what the contact gives way: a hundredth of a millimetre
        let force = static_force(radius, lowered);
        let load = rig.get("force_z");
        assert!((force / load - 1.0).abs() < 3e-3, "{radius}: {force} {load}");
        assert!(lowered > last, "the rounder the drum, the deeper: {lowered} {last} at {radius}");
        last = lowered;
        rig.step(0.5);
        assert!((rig.get("wheel_lowered") - lowered).abs() < 1e-7, "it stays");
    }
}

#[test]
fn a_large_drum_is_a_road_and_a_rolling_wheel_stays_where_it_starts() {
    let mut drum = Shipped::new(RIG, &[BARE, ("drum_diameter", 100.0), ("drum_speed", 0.0)]);
    let (load, lowered) = (drum.get("force_z"), drum.get("wheel_lowered"));
    let mut press = Shipped::new("super-elastic-hydropulse", &[("force", load - 30.0 * 9.81)]);
    let on_road = press.get("piston_position");
    // the drum falls off by x²/100 at the end of the contact, 75 mm before its middle
    assert!((lowered - on_road).abs() < 6e-5, "{lowered} {on_road}");
    for (diameter, speed) in [(1.0, 2.0), (2.0, -4.0)] {
        let mut rig = Shipped::new(RIG, &[BARE, ("drum_diameter", diameter), ("drum_speed", speed)]);
        let lowered = rig.get("wheel_lowered");
        let mut off = 0.0_f64;
        for _ in 0..400 {
            rig.step(5e-3);
            off = off.max((rig.get("wheel_lowered") - lowered).abs());
        }
        assert!(off < 1e-4, "{diameter} m, {speed} m/s, ripple only: {off}");
        assert!(rig.get("slip").abs() < 0.05 && rig.get("wheel_speed") * speed > 0.0);
    }
}

/// Heights of a wheel that swings behind a cleat, at zero crossings.
fn period(values: &[(&str, f64)]) -> f64 {
    let mut rig = Shipped::new(RIG, values);
    let (mut last, mut up) = (0.0, Vec::new());
    for n in 0..2000 {
        rig.step(1e-3);
        let now = rig.get("arm_displacement");
        // from a tenth of a second behind the cleat on
        if n > 1250 && last < 0.0 && now >= 0.0 {
            up.push(1e-3 * (f64::from(n) - now / (now - last)));
        }
        last = now;
    }
    (up[2] - up[0]) / 2.0
}

/// The same load by weights over the wheel, or by fewer ones farther out: the wheel carries the same, and swings slower.
#[test]
fn the_arm_swings_with_its_moment_of_inertia() {
    let near = [("weight_mass", 627.924), ("weight_distance", 1.0), ("arm_mass", 60.0)];
    let far = [("weight_mass", 313.962), ("weight_distance", 2.0), ("arm_mass", 60.0)];
    let mass = |w: &[(&str, f64)]| 12.0 + 20.0 + w[0].1 * w[1].1 * w[1].1;
    let [slow, fast] = [far, near].map(|w| period(&w));
    let expected = (mass(&far) / mass(&near)).sqrt();
    assert!((slow / fast / expected - 1.0).abs() < 5e-3, "{slow} {fast} {expected}");
}

/// What turns the arm at its pivot unloads the wheel by itself over the arm's length.
#[test]
fn a_torque_at_the_pivot_unloads_the_wheel() {
    let mut rig =
        Shipped::new(RIG, &[BARE, ("drum_speed", 0.0), ("arm_damping", 3000.0), ("arm_length", 0.8)]);
    let load = rig.get("force_z");
    rig.set("pivot_torque", 800.0);
    rig.step(8.0);
    let lifted = load - rig.get("force_z");
    assert!((lifted - 1000.0).abs() < 1.0, "{lifted}");
    assert!(rig.get("arm_rate").abs() < 1e-4);
}

#[test]
fn a_cleat_comes_once_per_turn() {
    let mut rig = Shipped::new(RIG, &[("drum_speed", 4.0), ("road_start", 3.0)]);
    let (mut hits, mut quiet) = (Vec::new(), 0.0);
    for n in 1..6000 {
        rig.step(1e-3);
        let time = 1e-3 * f64::from(n);
        if rig.get("arm_acceleration_1").abs() > 4.0 && time > quiet {
            hits.push(time);
            quiet = time + 0.8;
        }
    }
    let turn = std::f64::consts::PI * 2.0 / 4.0;
    assert_eq!(hits.len(), 4, "{hits:?}");
    for pair in hits.windows(2) {
        assert!((pair[1] - pair[0] - turn).abs() < 0.02, "{hits:?} {turn}");
    }
}

/// What the drum's drive gives goes into the dampers and the slip; the wheel rolls freely and stays in the mean where it is.
#[test]
fn the_drive_of_the_drum_pays_for_what_is_lost() {
    for (inside, diameter, speed) in [(0.0, 1.0, 3.0), (1.0, 1.5, -3.0)] {
        let mut rig = Shipped::new(
            RIG,
            &[
                ("rim_force", 2.0),
                ("rolling_resistance", 0.0),
                ("drum_inside", inside),
                ("drum_diameter", diameter),
                ("road_kind", 1.0),
                ("drum_speed", speed),
                ("step_size", 2.5e-4),
                ("slip_stiffness", 6e4),
            ],
        );
        rig.step(0.5);
        let (mut paid, mut lost) = (0.0, -rig.get("contact_energy_loss"));
        for _ in 0..8000 {
            rig.step(2.5e-4);
            paid += 2.5e-4 * rig.get("drum_torque") * speed / (0.5 * diameter);
            lost += 2.5e-4 * rig.get("rubber_power_loss");
        }
        lost += rig.get("contact_energy_loss");
        assert!(lost > 10.0 && (paid / lost - 1.0).abs() < 0.03, "{inside}: {paid} J for {lost} J");
    }
}

/// A tire that rolls on a plane: it carries the weights, and meets the cleat as its window bridges it.
#[test]
fn the_ring_brush_tire_rolls_on_the_drum_too() {
    let mut rig =
        Shipped::new("ring-brush-drum", &[("weight_mass", 250.0), ("drum_speed", 5.0), ("road_start", 2.0)]);
    let load = rig.get("force_z");
    rig.step(0.2);
    let now = rig.get("force_z");
    // its bristles ripple by some millionths
    assert!((now / load - 1.0).abs() < 1e-5, "{now} {load}");
    rig.step(0.22);
    assert!(rig.get("force_z") / load > 1.1, "on the cleat");
}

/// A drum that turns faster and faster pulls nothing on a wheel that stays where it is and that nothing drives: its rubber is not
/// accelerated. On a road, half of the rubber goes across its rays and takes that.
#[test]
fn a_drum_that_speeds_up_accelerates_no_rubber() {
    let ice: &[(&str, f64)] = &[
        BARE,
        ("friction_factor", 0.0),
        ("rim_force", 2.0),
        ("rubber_mass", 20.0),
        ("drum_speed", 2.0),
        ("command_actuators", 0.0),
    ];
    let mean = |rate: f64| {
        let mut rig = Shipped::new(RIG, ice);
        let steps = 500;
        let sum: f64 = (1..=steps)
            .map(|k| {
                rig.set("drum_speed", 2.0 + rate * 1e-3 * f64::from(k));
                rig.step(1e-3);
                rig.get("force_x")
            })
            .sum();
        sum / f64::from(steps)
    };
    let [steady, faster] = [0.0, 10.0].map(mean);
    assert!((faster - steady).abs() < 2.0, "{steady} {faster}; half of the rubber would take 100 N");
}

/// Accelerometers on the arm, from where they go: a point at a distance along the arm and a height over it.
#[test]
fn sensors_go_where_the_arm_takes_them() {
    let mut rig = Shipped::new(
        RIG,
        &[("sensor_5_distance", 1.3), ("sensor_5_height", 0.4), ("weight_mass", 300.0), ("drum_speed", 4.0)],
    );
    let step = 1e-3;
    let course: Vec<[f64; 3]> = (0..3000)
        .map(|_| {
            rig.step(step);
            let angle = rig.get("arm_displacement");
            [angle, rig.get("arm_acceleration_5_x"), rig.get("arm_acceleration_5_z")]
        })
        .collect();
    // sensor 4 is at 1 m: its height is the angle; places of a rigid arm, to the second order of the angle
    let place =
        |angle: f64| [1.3 * (1.0 - 0.5 * angle * angle) - 0.4 * angle, 1.3 * angle - 0.2 * angle * angle];
    let (mut off, mut most) = ([0.0_f64; 2], [0.0_f64; 2]);
    for three in course.windows(3) {
        let at = [0, 1, 2].map(|i| place(three[i][0]));
        for i in 0..2 {
            let expected = (at[2][i] - 2.0 * at[1][i] + at[0][i]) / (step * step);
            off[i] = off[i].max((three[1][1 + i] - expected).abs());
            most[i] = most[i].max(expected.abs());
        }
    }
    for i in 0..2 {
        assert!(most[i] > 1.0 && off[i] < 0.05 * most[i], "{off:?} {most:?}");
    }
}
