//! Bringing data into the core's cache before it is needed.

/// Asks for one of several shares of a value's cache lines, to the second-level cache; nothing but time depends on it.
///
/// Asked for all at once they would queue up in front of what is being worked on.
#[inline]
pub fn prefetch<T>(value: &T, share: usize, shares: usize) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T1, _mm_prefetch};
        const LINE_BYTES: usize = 64;
        let start = std::ptr::from_ref(value).cast::<i8>();
        let before = start.addr() % LINE_BYTES;
        let mut offset = share * LINE_BYTES;
        while offset < before + size_of::<T>() {
            // SAFETY: a prefetch reads nothing and faults on no address; this one is of a line of `value`.
            #[allow(unsafe_code)]
            unsafe {
                _mm_prefetch::<_MM_HINT_T1>(start.wrapping_sub(before).wrapping_add(offset));
            }
            offset += shares * LINE_BYTES;
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (value, share, shares);
}
