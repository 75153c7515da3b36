//! How the processor computes with floating-point numbers, which no call of an FMU may leave changed.

/// The parts of the floating-point control registers that say how to compute.
pub(super) fn now() -> u32 {
    #[cfg(target_arch = "x86_64")]
    {
        let (mut sse, mut x87) = (0u32, 0u16);
        // SAFETY: both instructions store a register at the place they are given, which is large enough.
        unsafe {
            std::arch::asm!("stmxcsr [{}]", in(reg) &mut sse, options(nostack, preserves_flags));
            std::arch::asm!("fnstcw word ptr [{}]", in(reg) &mut x87, options(nostack, preserves_flags));
        }
        // The low bits of mxcsr tell what happened, not how to compute.
        (sse & 0xffc0) | u32::from(x87) << 16
    }
    #[cfg(not(target_arch = "x86_64"))]
    {
        0
    }
}

/// Puts back what a call has changed.
pub(super) fn restore(mode: u32) {
    #[cfg(target_arch = "x86_64")]
    {
        let (sse, x87) = (mode & 0xffc0, (mode >> 16) as u16);
        // SAFETY: the values were read from the same registers.
        unsafe {
            std::arch::asm!("ldmxcsr [{}]", in(reg) &sse, options(nostack, preserves_flags));
            std::arch::asm!("fldcw word ptr [{}]", in(reg) &x87, options(nostack, preserves_flags));
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = mode;
}
