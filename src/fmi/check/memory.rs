//! The memory functions that are given to an FMU, and what came of them.

use libc::c_void;
use std::collections::HashSet;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Calls of allocateMemory.
static ALLOCATED: AtomicUsize = AtomicUsize::new(0);
/// Calls of freeMemory with what allocateMemory did not return.
static FOREIGN: AtomicUsize = AtomicUsize::new(0);
/// What allocateMemory returned and was not freed.
static LIVING: Mutex<Option<HashSet<usize>>> = Mutex::new(None);

/// How often allocateMemory was called, how often freeMemory with anything else than its results, and
/// how many of its results were not freed.
pub(super) fn account() -> (usize, usize, usize) {
    let living = LIVING.lock().unwrap_or_else(PoisonError::into_inner).as_ref().map_or(0, HashSet::len);
    (ALLOCATED.load(Ordering::Relaxed), FOREIGN.load(Ordering::Relaxed), living)
}

/// `calloc`, counted.
///
/// # Safety
/// None: it takes any numbers.
pub(super) unsafe extern "C" fn calloc(count: usize, size: usize) -> *mut c_void {
    // SAFETY: calloc takes any numbers.
    let memory = unsafe { libc::calloc(count, size) };
    ALLOCATED.fetch_add(1, Ordering::Relaxed);
    if !memory.is_null() {
        let mut living = LIVING.lock().unwrap_or_else(PoisonError::into_inner);
        living.get_or_insert_default().insert(memory as usize);
    }
    memory
}

/// `free`, counted.
///
/// # Safety
/// As `free`.
pub(super) unsafe extern "C" fn free(memory: *mut c_void) {
    if memory.is_null() {
        return;
    }
    let mut living = LIVING.lock().unwrap_or_else(PoisonError::into_inner);
    if !living.get_or_insert_default().remove(&(memory as usize)) {
        FOREIGN.fetch_add(1, Ordering::Relaxed);
    }
    drop(living);
    // SAFETY: demanded of the caller: most FMUs that free what they did not get here got it from malloc.
    unsafe { libc::free(memory) }
}
