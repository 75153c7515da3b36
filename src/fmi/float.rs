//! The processor's floating-point settings: rounding, subnormal numbers, signals.
//!
//! A host may have changed them, and then the same formulas give other bits; compiled Rust takes the
//! usual ones for granted. So each call runs under the usual ones, and the host finds its own again,
//! in its callbacks as well.

/// What a host has set, if that is unusual; put back when this is dropped.
#[derive(Default)]
// other processors have no settings that are looked at
pub struct HostSettings(#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))] Option<u32>);

/// MXCSR with all signals masked, rounding to nearest, subnormal numbers kept.
#[cfg(target_arch = "x86_64")]
const USUAL: u32 = 0x1f80;
/// The bits of MXCSR that are settings; the others are flags, which any computation may raise.
#[cfg(target_arch = "x86_64")]
const SETTINGS: u32 = 0xffc0;

impl HostSettings {
    /// Notes the host's settings and makes them the usual ones. Costs a register read where they
    /// are that already.
    pub fn replace() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            let now = read();
            if now & SETTINGS != USUAL {
                write(USUAL);
                return Self(Some(now));
            }
        }
        Self(None)
    }

    /// Runs `callback`, code of the host, under the host's settings.
    pub fn during<T>(&self, callback: impl FnOnce() -> T) -> T {
        self.put_back();
        let result = callback();
        #[cfg(target_arch = "x86_64")]
        if self.0.is_some() {
            write(USUAL);
        }
        result
    }

    fn put_back(&self) {
        #[cfg(target_arch = "x86_64")]
        if let Some(settings) = self.0 {
            write(settings);
        }
    }
}

impl Drop for HostSettings {
    fn drop(&mut self) {
        self.put_back();
    }
}

#[cfg(target_arch = "x86_64")]
fn read() -> u32 {
    let mut value = 0_u32;
    // SAFETY: stores the register in `value`.
    unsafe { std::arch::asm!("stmxcsr [{}]", in(reg) &raw mut value, options(nostack, preserves_flags)) };
    value
}

#[cfg(target_arch = "x86_64")]
fn write(value: u32) {
    // SAFETY: `value` is `USUAL` or was read from the register; the code that runs after writing
    // anything but `USUAL` is the host's.
    unsafe { std::arch::asm!("ldmxcsr [{}]", in(reg) &raw const value, options(nostack, preserves_flags)) };
}
