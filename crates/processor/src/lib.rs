//! What the board's processor does in one instruction and `libm` in a hundred: the square root; and comparisons that need not care for NaN.
//!
//! IEEE 754 asks for the nearest number, so both give the same bits, and a host's results are the board's.
//!
//! ```
//! assert_eq!(processor::sqrtf(2.25), 1.5);
//! ```

#![no_std]

/// The square root of `x`, rounded to the nearest number of single precision; NaN for `x < 0`, and -0 for -0.
#[inline]
#[must_use]
pub fn sqrtf(x: f32) -> f32 {
    #[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
    return instruction(x);
    #[cfg(not(all(target_arch = "arm", target_abi = "eabihf")))]
    return libm::sqrtf(x);
}

/// The larger of both, `a` where `b` is no number. Not `max`, which has to care for NaN.
#[inline(always)]
#[must_use]
pub fn higher(a: f32, b: f32) -> f32 {
    if b > a { b } else { a }
}

/// The smaller of both, `b` where `a` is no number.
#[inline(always)]
#[must_use]
pub fn lower(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// `core` has no square root, and `libm` 0.2.16 computes it bit by bit.
#[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
// Called: in a hundred places it would cost three kilobytes.
#[inline(never)]
#[allow(unsafe_code)]
fn instruction(x: f32) -> f32 {
    let mut bits = x.to_bits();
    // The compiler offers assembly no registers of a processor with single precision alone: s0 is borrowed and given back.
    // VSQRT rounds as IEEE 754 asks (Arm v7-M Architecture Reference Manual, DDI 0403), to the nearest as after a reset.
    // SAFETY: every register but `bits` and `kept` is afterwards what it was; no memory is touched.
    unsafe {
        core::arch::asm!(
            "vmov {kept}, s0",
            "vmov s0, {bits}",
            "vsqrt.f32 s0, s0",
            "vmov {bits}, s0",
            "vmov s0, {kept}",
            bits = inout(reg) bits,
            kept = out(reg) _,
            options(pure, nomem, nostack),
        );
    }
    f32::from_bits(bits)
}

#[cfg(test)]
mod tests {
    /// Every 1021st number, among them subnormal ones, infinities and NaN, against the computer's own instruction.
    #[test]
    fn every_root_is_the_nearest() {
        for bits in (0..=u32::MAX).step_by(1021) {
            let x = f32::from_bits(bits);
            let (root, expected) = (super::sqrtf(x), x.sqrt());
            let same = root.to_bits() == expected.to_bits() || root.is_nan() && expected.is_nan();
            assert!(same, "{x:e}: {root:e} {expected:e}");
        }
    }
}
