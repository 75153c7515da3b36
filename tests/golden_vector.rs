//! One instantaneous evaluation of the tire against numbers that were computed outside this code,
//! by a prototype in another language, from the same equations.
#![allow(missing_docs, clippy::expect_used)]

mod common;

use common::{example, example_tire};
use latsch::tire::Motion;
use latsch::tire::ring_brush::{
    Contact, Friction, Loads, Moments, Pressure, PressureState, Shape, Tops, coupling, moment_y,
};
use nalgebra::{Matrix3, Vector3};

/// Agreement to 1e-9 of the expected number, or to one unit of its last printed digit: some of the
/// printed numbers are cut off, not rounded.
#[track_caller]
fn same(what: &str, value: f64, printed: &str) {
    let expected: f64 = printed.parse().expect("a number");
    let decimals = printed.split(['e', 'E']).next().unwrap_or("").split_once('.').map_or(0, |(_, d)| d.len());
    let exponent: i32 = printed.split(['e', 'E']).nth(1).map_or(0, |e| e.parse().expect("an exponent"));
    let last_digit = 1.000001 * 10f64.powi(exponent - decimals as i32);
    let tolerance = last_digit.max(1e-9 * expected.abs());
    assert!((value - expected).abs() <= tolerance, "{what}: {value:?} instead of {printed}");
}

#[track_caller]
fn same_all<'a>(what: &str, values: impl IntoIterator<Item = &'a f64>, printed: &str) {
    let values: Vec<f64> = values.into_iter().copied().collect();
    let printed: Vec<&str> = printed.split_whitespace().collect();
    assert_eq!(values.len(), printed.len(), "{what}");
    for (i, (value, printed)) in values.into_iter().zip(printed).enumerate() {
        same(&format!("{what}[{i}]"), value, printed);
    }
}

fn rows(m: &Matrix3<f64>) -> Vec<f64> {
    m.transpose().iter().copied().collect()
}

fn belt() -> Motion<f64> {
    Motion {
        position: Vector3::new(0.1, -0.05, 0.315),
        velocity: Vector3::new(9.9, -0.2, -0.05),
        angles: Vector3::new(0.02, 0.7, -0.03),
        rates: Vector3::new(0.1, 30.0, -0.05),
    }
}

fn rim() -> Motion<f64> {
    Motion {
        position: Vector3::new(0.1005, -0.047, 0.3138),
        velocity: Vector3::new(9.95, -0.15, -0.02),
        angles: Vector3::new(0.03, 0.701, -0.028),
        rates: Vector3::new(0.02, 30.1, 0.01),
    }
}

const LAGGED: Loads<f64> = Loads { force_x: 800.0, force_y: 500.0, moment_z: -20.0 };
const LAG_RATES: Loads<f64> = Loads { force_x: 1000.0, force_y: 2000.0, moment_z: -300.0 };

#[test]
fn side_wall() {
    let p = example();
    same_all(
        "A_G0",
        &rows(&belt().rotation()),
        "0.764884480984 0.029989501302 0.643469005129 -0.010064126316 0.999350130406 -0.034612573140
         -0.644088847995 0.019998666693 0.764689223946",
    );
    same_all(
        "Omega_G0",
        &rows(&belt().rate_map()),
        "0.999550033749 0.029989501302 0 -0.029995500202 0.999350130406 0 0 0.019998666693 1",
    );
    same_all("omega_G0", &belt().angular_velocity(), "0.999640042448 29.977504362154 0.549960000800");
    let c = coupling(&p, &rim(), &belt());
    same_all("r_FG", &c.offset, "0.001125156479 0.002989046742 -0.000699730286");
    same_all("r_FG rate", &c.offset_rate, "0.039487836264 0.051961424020 0.086812192122");
    same_all("phi_FGlin", &c.rotation, "0.006360470214 0.001075312469 0.007977764377");
    same_all("omega_FGlin", &c.rotation_rate, "-0.338949855790 0.100852873178 0.185439316151");
    let b = c.belt_in_belt_frame;
    same_all("F_FGG", &b.force, "5272.210796050703 256.225372152929 -3228.761759444224");
    same_all("M_FGG", &b.moment, "505.580309020813 490.321210874855 640.003221988886");
    same_all("F_FG0", &c.on_belt.force, "1962.708172358856 314.754416206257 -5859.647336334523");
    same_all("M_FG0", &c.on_belt.moment, "813.237257385705 462.762183604573 173.570698808365");
    same_all("F_F0", &c.on_rim.force, "-1962.708172358856 -314.754416206257 5859.647336334523");
    same_all("M_F0", &c.on_rim.moment, "-830.438494095261 -462.187609743236 -179.301446117338");
}

#[test]
fn contact_frame_and_stripes() {
    let (p, tire) = (example(), example_tire());
    let c = Contact::new(&p, &belt());
    same("eps", c.camber, "0.02");
    same("d", c.depth, "0.3380673977533633");
    same("f_G", c.penetration, "0.023067397753363306");
    same("f_G rate", c.penetration_rate, "0.05067395506756533");
    same("F_z", c.normal_force, "4870.884144894877");
    same("h", c.distance, "0.31506301050170826");
    same("h rate", c.distance_rate, "-0.049379791615686744");
    same_all("r_K rate", &c.velocity, "9.901859476162 0.127557915261");
    let contact_point = belt().position - c.rotation() * c.centre;
    same_all("r_K0", &contact_point, "0.100188996852 -0.043701995031 0");

    same("b_RKE", p.stripe_width(), "0.03970588235294118");
    same_all(
        "y",
        tire.stripe_places(),
        "0.099264705882 0.059558823529 0.019852941176 -0.019852941176 -0.059558823529 -0.099264705882",
    );
    same_all(
        "R",
        tire.stripe_radii(),
        "0.330661230091 0.335367270574 0.337707981816 0.337707981816 0.335367270574 0.330661230091",
    );
    let lengths: Vec<f64> = tire
        .stripe_places()
        .iter()
        .zip(tire.stripe_radii())
        .map(|(y, r)| c.stripe_length(&p, *y, *r))
        .collect();
    same_all(
        "l_mat",
        &lengths,
        "0.142813972493 0.170653279825 0.184899019192 0.188208237074 0.181087630081 0.162479136482",
    );
    let arcs: Vec<f64> = lengths.iter().map(|l| l / p.stripe_length_factor).collect();
    same_all(
        "l",
        &arcs,
        "0.190418629991 0.227537706434 0.246532025590 0.250944316099 0.241450173442 0.216638848642",
    );
}

/// x of bristle j, counted from 1, at the spin angle 0.7 (4.17).
fn place(j: usize) -> f64 {
    let p = example();
    let ring = p.ring_length();
    (-(j as f64) * p.bristle_length - p.rolling_radius * 0.7).rem_euclid(ring) - 0.5 * ring
}

#[test]
fn pressure() {
    let (p, tire) = (example(), example_tire());
    let contact = Contact::new(&p, &belt());
    let shape = Shape::new(&p, contact.penetration);
    let (long, lat) = shape.exponents();
    same("e_l", long, "6.659151513391591");
    same("e_q", lat, "10.077151327145438");

    let cell = |i: usize, j: usize| {
        let y = tire.stripe_places()[i - 1];
        let length = contact.stripe_length(&p, y, tire.stripe_radii()[i - 1]);
        let x = place(j);
        if x.abs() <= 0.5 * length { shape.along(x, length) * shape.stripe(y, length) } else { 0.0 }
    };
    let cells = || (1..=6).flat_map(|i| (1..=30).map(move |j| (i, j)));
    let touching: Vec<f64> = (1..=6).map(|i| (1..=30).filter(|j| cell(i, *j) > 0.0).count() as f64).collect();
    same_all("bristles in contact", &touching, "10 12 14 14 13 12");
    let sum = |power: i32| cells().map(|(i, j)| place(j).powi(power) * cell(i, j)).sum::<f64>();
    let sums = Moments { s0: sum(0), s1: sum(1), s2: sum(2) };
    same("S0", sums.s0, "10.241022702823042");
    same("S1", sums.s1, "-0.0018894541694429515");
    same("S2", sums.s2, "0.021040604875456892");

    let moment = moment_y(&p, &contact, 30.0, LAGGED.force_x);
    same("M_LGKy", moment, "-59.05843304758217");
    let shift = p.patch_compliance_x * LAGGED.force_x;
    let tilting = moment + shift * contact.normal_force;
    same("T", tilting, "-47.368311099834465");
    let pressure = Pressure::new(&p, &sums, contact.normal_force, tilting, 0.19);
    assert_eq!(pressure.state, PressureState::Regular);
    same("a", pressure.level, "856382.6866245214");
    same("b", pressure.tilt, "4126826.730249452");

    let at = |i: usize, j: usize| pressure.at(place(j), cell(i, j));
    let row = |i: usize, js: &[usize]| js.iter().map(|j| at(i, *j)).collect::<Vec<_>>();
    same_all(
        "p of stripe 1",
        &row(1, &[1, 2, 3, 24, 25, 26, 27, 28, 29, 30]),
        "72978.21 63013.13 38590.61 57120.03 98239.89 101872.40 97075.02 91204.37 85290.73 79362.56",
    );
    same_all(
        "p of stripe 4",
        &row(4, &[1, 2, 3, 4, 5, 22, 23, 24, 25, 26, 27, 28, 29, 30]),
        "134939.10 122879.74 106589.84 78616.88 25518.85 26691.26 156234.45 194302.24 197191.40
         189110.98 178563.80 167702.56 156828.74 145950.66",
    );
    let area = p.cell_area();
    let total: f64 = cells().map(|(i, j)| area * at(i, j)).sum();
    let turning: f64 = cells().map(|(i, j)| (place(j) + shift) * area * at(i, j)).sum();
    same("sum of F_z", total, "4870.884144894877");
    same("sum of (x + dx) F_z", turning, "59.058433047582");
}

#[test]
fn tops_and_friction() {
    let (p, tire) = (example(), example_tire());
    let contact = Contact::new(&p, &belt());
    let tops = Tops::new(&p, &contact, 30.0, &LAGGED, &LAG_RATES);
    same("n_LKb", p.bend_compliance(), "7.002555932915513e-06");
    let deformation = latsch::tire::ring_brush::Deformation::new(&p, &LAGGED);
    same("dy", deformation.shift_y, "4.0e-4");
    same("tw", deformation.twist, "-0.002");
    same("bend", deformation.bend, "0.003501277966457757");
    // (stripe, bristle, x, y_def, y_phi, v_x, v_y, F_z)
    let cells = [
        (
            1,
            1,
            "-0.0336",
            "0.09972795307957993",
            "0.09995225840296455",
            "0.06985708908234578",
            "0.13102514204022653",
        ),
        (
            4,
            24,
            "0.0644",
            "-0.019596262236657558",
            "-0.01946397516868019",
            "0.06388627740376407",
            "0.18823162389630232",
        ),
        (
            6,
            30,
            "-0.0196",
            "-0.09882685093329655",
            "-0.09857983980662961",
            "0.05993048417186664",
            "0.13939319904286823",
        ),
    ];
    for (i, j, x, y_def, y_phi, v_x, v_y) in cells {
        let y = tire.stripe_places()[i - 1];
        same("x", place(j), x);
        same("y_def", deformation.place(place(j), y)[1], y_def);
        same("y_phi", tops.virtual_y(place(j), y), y_phi);
        let [x, y] = tops.velocity(place(j), y);
        same("v_0Kx", x, v_x);
        same("v_0Ky", y, v_y);
    }
    // friction coefficients at the pressures of these cells
    let coefficients = [
        (40.56729918043002, "1.4635108949", "1.0635108949"),
        (108.00918864932842, "1.4028488779", "1.0028488779"),
        (50.1962305205218, "1.4548499514", "1.0548499514"),
    ];
    for (normal, sticking, sliding) in coefficients {
        let limits = Friction::new(&p).limits(normal / p.cell_area(), normal);
        same("mu_static", limits.sticking / normal, sticking);
        same("mu_sliding", limits.sliding / normal, sliding);
    }
}

#[test]
fn shell_depth_is_continuous_where_its_edge_becomes_the_deepest_point() {
    let p = example();
    let depth = |camber: f64| {
        let mut belt = belt();
        belt.angles.x = camber;
        Contact::new(&p, &belt).depth
    };
    same("edge", (p.width / (2.0 * p.cross_section_radius)).asin(), "0.16744807921968932");
    same("branch 1", depth(0.16), "0.34230440550241");
    same("branch 2", depth(0.25), "0.34617781813825");
    same("branch 2, other side", depth(-0.25), "0.34617781813825");
    let edge = 0.16744807921968932;
    let (below, above) = (depth(edge - 1e-7), depth(edge + 1e-7));
    same("at the edge", depth(edge), "0.34271351884924");
    let slopes = [(depth(edge) - below) / 1e-7, (above - depth(edge)) / 1e-7];
    assert!((slopes[0] - slopes[1]).abs() < 1e-5, "a kink at the edge: {slopes:?}");
}
