//! Bringing data into the core's cache before it is needed.

/// Asks for one of several shares of a value's cache lines, to the second-level cache; nothing but time depends on it.
///
/// Asked for all at once they would queue up in front of what is being worked on.
#[inline]
pub fn prefetch<T, const SHARES: usize>(value: &T, share: usize) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T1, _mm_prefetch};
        const LINE_BYTES: usize = 64;
        let start = std::ptr::from_ref(value).cast::<i8>();
        let first = start.wrapping_sub(start.addr() % LINE_BYTES).wrapping_add(share * LINE_BYTES);
        // As many as there are wherever the value begins in a line: a number that is known while compiling needs no loop.
        for line in 0..(size_of::<T>() + LINE_BYTES - 1).div_ceil(LINE_BYTES * SHARES) {
            // SAFETY: a prefetch reads nothing and faults on no address; this one is of a line of `value` or of the next.
            #[allow(unsafe_code)]
            unsafe {
                _mm_prefetch::<_MM_HINT_T1>(first.wrapping_add(line * SHARES * LINE_BYTES));
            }
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (value, share);
}
