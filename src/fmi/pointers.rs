//! What the master's pointers point to.

use super::c::Text;
use crate::{Error, Result};
use std::ffi::CStr;

/// The text at a pointer that may be null.
///
/// # Safety
/// `text` is null or points to a zero-terminated text that lives for `'a`.
pub(super) unsafe fn text<'a>(text: Text, what: &str) -> Result<Option<&'a str>> {
    if text.is_null() {
        return Ok(None);
    }
    // SAFETY: not null, and the caller promises the rest.
    let text = unsafe { CStr::from_ptr(text) };
    text.to_str().map(Some).map_err(|_| Error::call(format!("{what} is not UTF-8")))
}

/// The items of an array of the master.
///
/// # Safety
/// `items` is null or points to `count` items that live for `'a`.
pub(super) unsafe fn array<'a, T>(items: *const T, count: usize, what: &str) -> Result<&'a [T]> {
    if count == 0 {
        return Ok(&[]);
    }
    if items.is_null() {
        return Err(Error::call(format!("{count} {what} at a null pointer")));
    }
    // SAFETY: not null, and the caller promises the rest.
    Ok(unsafe { std::slice::from_raw_parts(items, count) })
}

/// The items of an array of the master to write to.
///
/// # Safety
/// `items` is null or points to `count` items that live for `'a` and that nobody else uses.
pub(super) unsafe fn array_mut<'a, T>(items: *mut T, count: usize, what: &str) -> Result<&'a mut [T]> {
    if count == 0 {
        return Ok(&mut []);
    }
    if items.is_null() {
        return Err(Error::call(format!("{count} {what} at a null pointer")));
    }
    // SAFETY: not null, and the caller promises the rest.
    Ok(unsafe { std::slice::from_raw_parts_mut(items, count) })
}
