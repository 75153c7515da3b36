//! The C function of a [tire that a host calls](crate::tire_function), with the job flags of the source's tire function.
//!
//! [`export_tire_function!`](crate::export_tire_function) makes the symbol in a crate of type `cdylib`; `latsch_tire.h` there is its
//! declaration in C.

use super::float::HostSettings;
use super::panics;
use super::pointers::{array_mut, text};
use crate::tire_function::{Answer, Posture, TireFunction, open};
use crate::{Error, Result, one_line};
use nalgebra::{Matrix3, Vector3};
use std::ffi::{c_char, c_int};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::ptr::null_mut;

/// Force and moment for a motion.
pub const NORMAL: c_int = 0;
/// What arrays the host has to have: none.
pub const INQUIRE: c_int = 1;
/// Reads both files.
pub const INIT: c_int = 2;
/// Reads both files again and forgets all states.
pub const RESET: c_int = 3;
/// The step that ended at the motion's time has succeeded.
pub const SSTEP: c_int = 4;
/// As [`NORMAL`], for a derivative.
pub const DIFF: c_int = 5;
/// Frees all.
pub const ENDSIM: c_int = 99;

/// Values of `varinf` in an answer.
pub const VARINF: usize = 10;

/// A tire between calls.
pub struct CTire {
    files: (PathBuf, Option<PathBuf>),
    function: Box<dyn TireFunction>,
}

/// How the wheel carrier moves, as in C.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct CMotion {
    /// Time \[s\].
    pub time: f64,
    /// The wheel's centre, road axes \[m\].
    pub dis: [f64; 3],
    /// From carrier axes to road axes, row after row.
    pub tramat: [[f64; 3]; 3],
    /// Velocity of the centre, carrier axes \[m/s\].
    pub vel: [f64; 3],
    /// Angular velocity of the carrier, carrier axes \[rad/s\].
    pub omega: [f64; 3],
    /// Angle of the wheel against the carrier \[rad\].
    pub angtwc: f64,
    /// Its rate \[rad/s\].
    pub omegar: f64,
}

/// What the tire does, as in C.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct CForces {
    /// On the wheel carrier at the wheel's centre, road axes \[N\].
    pub force: [f64; 3],
    /// About the wheel's centre, road axes \[N.m\].
    pub torque: [f64; 3],
    /// Force and moment in H axes, deflection \[m\], energy lost in the contact \[J\], mass \[kg\] and inertia \[kg.m²\] that the host's wheel
    /// has to carry.
    pub varinf: [f64; VARINF],
}

impl CMotion {
    fn posture(&self) -> Posture {
        let [a, b, c] = self.tramat;
        Posture {
            time: self.time,
            place: Vector3::from(self.dis),
            carrier: Matrix3::from_row_slice(&[a, b, c].concat()),
            velocity: Vector3::from(self.vel),
            turning: Vector3::from(self.omega),
            wheel_angle: self.angtwc,
            wheel_speed: self.omegar,
        }
    }
}

impl From<Answer> for CForces {
    fn from(answer: Answer) -> Self {
        let [force, moment] = answer.in_heading;
        let varinf = [
            force.x,
            force.y,
            force.z,
            moment.x,
            moment.y,
            moment.z,
            answer.deflection,
            answer.energy_loss,
            answer.carried_mass,
            answer.carried_inertia,
        ];
        Self { force: answer.force.into(), torque: answer.moment.into(), varinf }
    }
}

/// The function: 0 if all went well, and the message is empty or says what the user should know; otherwise it says what was wrong, and
/// forces are left as they were.
///
/// # Safety
/// `tire` points to a pointer that is null or came from this function and was not freed, and which no other thread uses; files are null or
/// zero-terminated; `motion` and `forces` are null or point to one; `message` points to `size` characters.
#[allow(clippy::too_many_arguments)] // as hosts have them
pub unsafe fn tire(
    job: c_int,
    tire: *mut *mut CTire,
    property: *const c_char,
    road: *const c_char,
    motion: *const CMotion,
    forces: *mut CForces,
    message: *mut c_char,
    size: usize,
) -> c_int {
    panics::silence();
    let settings = HostSettings::replace();
    let done = catch_unwind(AssertUnwindSafe(|| {
        // SAFETY: the caller's promise.
        let place = unsafe { tire.as_mut() }
            .ok_or_else(|| Error::call("the place for the tire is a null pointer"))?;
        // SAFETY: the caller's promise: null, or from Box::into_raw below.
        let known = unsafe { place.as_mut() };
        match (job, known) {
            (INQUIRE, _) => Ok(None),
            (INIT, None) => {
                // SAFETY: the caller's promise.
                let (property, road) =
                    unsafe { (text(property, "the property file")?, text(road, "the road file")?) };
                let property = property.ok_or_else(|| Error::call("INIT needs a property file"))?;
                let files = (PathBuf::from(property), road.filter(|r| !r.is_empty()).map(PathBuf::from));
                let (function, notes) = opened(&files)?;
                *place = Box::into_raw(Box::new(CTire { function, files }));
                Ok(joined(&notes))
            }
            (INIT, Some(_)) => {
                Err(Error::call("this tire is there already: ENDSIM frees it, RESET reads its files again"))
            }
            (ENDSIM, _) => {
                let was = std::mem::replace(place, null_mut());
                if !was.is_null() {
                    // SAFETY: from Box::into_raw, and no longer known to the host.
                    drop(unsafe { Box::from_raw(was) });
                }
                Ok(None)
            }
            (NORMAL | RESET | SSTEP | DIFF, None) => Err(Error::call("there is no tire yet: INIT makes one")),
            (RESET, Some(known)) => {
                let (function, notes) = opened(&known.files)?;
                known.function = function;
                Ok(joined(&notes))
            }
            (NORMAL | SSTEP | DIFF, Some(known)) => {
                // SAFETY: the caller's promise.
                let motion =
                    unsafe { motion.as_ref() }.ok_or_else(|| Error::call("the motion is a null pointer"))?;
                if job == SSTEP {
                    return known.function.commit(&motion.posture()).map(|()| None);
                }
                // SAFETY: the caller's promise.
                let forces =
                    unsafe { forces.as_mut() }.ok_or_else(|| Error::call("the forces are a null pointer"))?;
                let answer = known.function.evaluate(&motion.posture())?;
                let warning = answer.warning.clone();
                *forces = answer.into();
                Ok(warning)
            }
            (job, _) => Err(Error::call(format!("there is no job {job}; there are 0 to 5 and 99"))),
        }
    }));
    drop(settings);
    let (status, said) = match done {
        Ok(Ok(said)) => (0, said.unwrap_or_default()),
        Ok(Err(error)) => (1, error.to_string()),
        Err(_) => (1, Error::fmu(panics::about()).to_string()),
    };
    // SAFETY: the caller's promise.
    if let Ok(message) = unsafe { array_mut(message.cast::<u8>(), size, "characters of the message") } {
        write(&one_line(&said), message);
    }
    status
}

fn joined(notes: &[String]) -> Option<String> {
    (!notes.is_empty()).then(|| notes.join("; "))
}

fn opened((property, road): &(PathBuf, Option<PathBuf>)) -> Result<(Box<dyn TireFunction>, Vec<String>)> {
    open(property, road.as_deref().map(Path::new))
}

/// Writes as much of a text as there is room for, with a zero behind it.
fn write(said: &str, message: &mut [u8]) {
    let Some(room) = message.len().checked_sub(1) else { return };
    let end = (0..=room.min(said.len())).rev().find(|end| said.is_char_boundary(*end)).unwrap_or(0);
    message[..end].copy_from_slice(&said.as_bytes()[..end]);
    message[end] = 0;
}

/// Makes the symbol `latsch_tire`, in a crate of type `cdylib`.
#[macro_export]
macro_rules! export_tire_function {
    () => {
        /// See `latsch_tire.h`.
        ///
        /// # Safety
        /// As there.
        #[unsafe(no_mangle)]
        #[allow(clippy::too_many_arguments)]
        pub unsafe extern "C" fn latsch_tire(
            job: ::std::ffi::c_int,
            tire: *mut *mut $crate::fmi::tire_function::CTire,
            property_file: *const ::std::ffi::c_char,
            road_file: *const ::std::ffi::c_char,
            motion: *const $crate::fmi::tire_function::CMotion,
            forces: *mut $crate::fmi::tire_function::CForces,
            message: *mut ::std::ffi::c_char,
            message_size: usize,
        ) -> ::std::ffi::c_int {
            // SAFETY: the caller's promise.
            unsafe {
                $crate::fmi::tire_function::tire(
                    job,
                    tire,
                    property_file,
                    road_file,
                    motion,
                    forces,
                    message,
                    message_size,
                )
            }
        }
    };
}
