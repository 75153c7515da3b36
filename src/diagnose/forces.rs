//! Forces at the inputs of a machine that effects add to: how large one is for it, and which way it pushes.

use super::roles::Roles;
use crate::effect::Role;
use crate::fit::{Bench, Drive, Setup, Traces};
use crate::model::{Causality, Interface};
use crate::stats::root_mean_square;
use std::sync::Arc;

/// How often a force comes and goes in a run, how many sizes are tried for one, and how many times larger or smaller the next
/// one is at most.
const WAVES: usize = 4;
const SIZES: usize = 10;
const FAR: f64 = 1e3;
/// A force that tells which way it pushes, as a share of its size: the smallest with which effects are tried.
const SMALL: f64 = 0.02;

/// A machine that is pushed.
pub(super) struct Forces<'a> {
    pub bench: &'a Bench,
    /// What it is, and what is done with it.
    pub setup: Arc<Setup>,
    pub drives: &'a [Arc<Drive>],
}

impl Forces<'_> {
    /// The inputs that are forces.
    pub fn inputs(interface: &Interface, roles: &Roles) -> Vec<usize> {
        let is_force = |v: &usize| {
            let info = &interface.variables[*v];
            info.causality == Causality::Input && info.is_real() && roles.is(*v, Role::Force)
        };
        (0..interface.variables.len()).filter(is_force).collect()
    }

    /// What variables do when a force is added at an input, of which `course` says how much of it is there; nothing, if that
    /// breaks the machine.
    fn respond(
        &self,
        input: usize,
        course: impl Fn(&Drive, usize) -> f64,
        watch: &[usize],
    ) -> Option<Vec<Traces>> {
        let pushed = |drive: &Arc<Drive>| Arc::new(pushed(drive, input, |k| course(drive, k)));
        let drives: Vec<Arc<Drive>> = self.drives.iter().map(pushed).collect();
        let answers = self.bench.run(std::slice::from_ref(&self.setup), &drives, &watch.into());
        answers.into_iter().map(Result::ok).collect()
    }

    /// The size of a force at an input that nothing drives: what moves an output as much as it moves anyway. It is looked for,
    /// because a unit of force may be nothing for a machine, or break it. 0 where nothing answers.
    pub fn size(&self, input: usize, measured: &[usize], size: &[f64]) -> f64 {
        // on and off, so that also what only shows in motion answers
        let wave = |drive: &Drive, k: usize| (k / (drive.points / (2 * WAVES)).max(1)).is_multiple_of(2);
        let respond =
            |force: f64| self.respond(input, |drive, k| if wave(drive, k) { force } else { 0.0 }, measured);
        let Some(still) = respond(0.0) else { return 0.0 };
        // how many times its size the output moves that moves most
        let moves = |force: f64| -> Option<f64> {
            let moved = respond(force)?;
            let change = |c: usize| {
                let pairs = still.iter().zip(&moved).flat_map(|(a, b)| a[c].iter().zip(&b[c]));
                root_mean_square(pairs.map(|(a, b)| a - b)) / size[measured[c]]
            };
            let moving = (0..measured.len()).filter(|c| size[measured[*c]] > 0.0);
            Some(moving.map(change).filter(|change| change.is_finite()).fold(0.0, f64::max))
        };
        let (mut force, mut known) = (1.0, 0.0);
        for _ in 0..SIZES {
            match moves(force) {
                // it breaks the model
                None => force /= FAR,
                Some(times) => {
                    if times > 0.0 {
                        known = force / times;
                    }
                    if (0.5..2.0).contains(&times) {
                        break;
                    }
                    force /= times.clamp(1.0 / FAR, FAR);
                }
            }
        }
        if f64::is_finite(known) { known } else { 0.0 }
    }

    /// The positions and velocities that count against the way in which a force of this size pushes: one that stays displaces
    /// them, on average, to where they count backwards. Its own motion, and what springs and dampers hang on that, it displaces
    /// its own way.
    pub fn against(&self, input: usize, size: f64, roles: &Roles) -> Vec<usize> {
        let is_velocity = |v: usize| roles.is(v, Role::Velocity) || roles.is(v, Role::TravelSpeed);
        let is_motion = |v: &usize| {
            let info = &self.bench.interface().variables[*v];
            info.causality == Causality::Output
                && info.is_real()
                && (is_velocity(*v) || roles.is(*v, Role::Position))
        };
        let motions: Vec<usize> = (0..self.bench.interface().variables.len()).filter(is_motion).collect();
        // not from the start, where a machine may settle under what acts then
        let is_on = |drive: &Drive, k: usize| k > drive.points / (2 * WAVES);
        let push =
            |force: f64| self.respond(input, |drive, k| if is_on(drive, k) { force } else { 0.0 }, &motions);
        let (Some(still), Some(moved)) = (push(0.0), push(SMALL * size)) else { return Vec::new() };
        let displaced = |c: usize| -> f64 {
            let of = |(drive, (still, moved)): (&Arc<Drive>, (&Traces, &Traces))| -> f64 {
                let change = still[c].iter().zip(&moved[c]).map(|(still, moved)| moved - still);
                let mut so_far = 0.0;
                let way = |change: f64| {
                    so_far += drive.step * change;
                    if is_velocity(motions[c]) { so_far } else { change }
                };
                change.map(way).sum()
            };
            self.drives.iter().zip(still.iter().zip(&moved)).map(of).sum()
        };
        (0..motions.len()).filter(|c| displaced(*c) < 0.0).map(|c| motions[c]).collect()
    }
}

/// With a force beside what there is.
fn pushed(drive: &Drive, input: usize, force: impl Fn(usize) -> f64) -> Drive {
    let mut drive = drive.clone();
    let course: Vec<f64> = (0..drive.points).map(force).collect();
    match drive.inputs.iter_mut().find(|(v, _)| *v == input) {
        Some((_, own)) => own.iter_mut().zip(course).for_each(|(value, more)| *value += more),
        None => drive.inputs.push((input, course)),
    }
    drive
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::Factory;
    use crate::model::{Access, Model, Native, Settings, Slave, Table, input, output};
    use crate::{Result, real};
    use serde::{Deserialize, Serialize};

    /// Two masses of 1 kg between springs of 100 N/m, a force on each; sensors count either way.
    #[derive(Clone, Default, PartialEq, Serialize, Deserialize)]
    struct Masses {
        forces: [f64; 2],
        positions: [f64; 2],
        velocities: [f64; 2],
    }

    macro_rules! shown {
        ($value:expr) => {
            Access::computed($value)
        };
    }

    impl Model for Masses {
        const NAME: &'static str = "masses";
        const DESCRIPTION: &'static str = "Two masses between springs";
        fn variables() -> Table<Self> {
            Table::new([
                input("first_force", "N", real!(forces[0]), 0.0, "Force on the first"),
                input("second_force", "N", real!(forces[1]), 0.0, "Force on the second"),
                output("first_position", "m", shown!(|m: &Self| m.positions[0]), "Of the first"),
                output("first_turned", "m", shown!(|m: &Self| -m.positions[0]), "The other way"),
                output("second_velocity", "m/s", shown!(|m: &Self| m.velocities[1]), "Of the second"),
                output("second_turned", "m/s", shown!(|m: &Self| -m.velocities[1]), "The other way"),
            ])
        }
        fn step_size(&self) -> f64 {
            1e-3
        }
        fn initialize(&mut self) -> Result<()> {
            // at rest under what acts
            let [f, g] = self.forces;
            self.positions = [(2.0 * f + g) / 300.0, (f + 2.0 * g) / 300.0];
            Ok(())
        }
        fn step(&mut self, h: f64) -> Result<()> {
            let [a, b] = self.positions;
            let springs = [-100.0 * a + 100.0 * (b - a), -100.0 * b - 100.0 * (b - a)];
            for (i, spring) in springs.into_iter().enumerate() {
                self.velocities[i] += h * (self.forces[i] + spring - 0.4 * self.velocities[i]);
                self.positions[i] += h * self.velocities[i];
            }
            Ok(())
        }
    }

    fn with_forces<T>(courses: [Option<f64>; 2], ask: impl Fn(&Forces<'_>, &Roles, &[usize]) -> T) -> T {
        let factory: Factory = Arc::new(|| {
            let slave: Box<dyn Slave> = Box::new(Native::<Masses>::new(&Settings::default())?);
            Ok(slave)
        });
        let bench = Bench::new(&factory, &[], 1).unwrap();
        let interface = bench.interface();
        let roles = Roles::of(interface, &[]).unwrap();
        let inputs = Forces::inputs(interface, &roles);
        let points = 2001;
        let sine = |f: f64| (0..points).map(|k| f * (0.01 * k as f64).sin()).collect::<Vec<f64>>();
        let driven = inputs.iter().zip(courses).filter_map(|(v, f)| Some((*v, sine(f?))));
        let drive = Drive::new(0.0, 2e-3, points, driven.collect());
        let setup = Arc::new(Setup { values: Vec::new(), attachments: Vec::new() });
        let drives = [Arc::new(drive)];
        ask(&Forces { bench: &bench, setup, drives: &drives }, &roles, &inputs)
    }

    #[test]
    fn motions_that_count_against_a_force_are_told_from_those_that_go_its_way() {
        // driven and at rest, large and small
        for courses in [[None, None], [Some(30.0), None], [None, Some(0.1)], [Some(5.0), Some(-7.0)]] {
            for size in [1e-3, 1.0, 1e4] {
                let turned = with_forces(courses, |forces, roles, inputs| {
                    let name = |v: usize| forces.bench.interface().variables[v].name.clone();
                    let of = |input: &usize| -> Vec<String> {
                        forces.against(*input, size, roles).into_iter().map(name).collect()
                    };
                    inputs.iter().map(of).collect::<Vec<_>>()
                });
                // a spring takes the other mass along
                assert_eq!(turned, vec![vec!["first_turned", "second_turned"]; 2], "{courses:?}, {size}");
            }
        }
    }

    #[test]
    fn a_force_has_the_size_that_moves_the_machine_as_it_moves_anyway() {
        // by hand: a force f that is on half of the time moves the first mass by about f / 150 N/m; it moves by 20 mm
        let size = with_forces([None, None], |forces, _, inputs| {
            let first = forces.bench.interface().index("first_position").unwrap();
            let mut sizes = vec![0.0; forces.bench.interface().variables.len()];
            sizes[first] = 0.02;
            forces.size(inputs[0], &[first], &sizes)
        });
        assert!(size > 2.0 && size < 8.0, "{size}");
    }
}
