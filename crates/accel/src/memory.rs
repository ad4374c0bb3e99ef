//! The memory of a tree's arrays.

/// The size of arrays from which large pages are requested: smaller ones would not fill many. Unit: bytes.
const LARGE: usize = 1 << 20;

/// The size of a cache line. Unit: bytes.
const LINE: usize = 64;

/// Begins to load values that will be read soon into the nearest cache. It affects only time.
#[inline(always)]
pub fn load_ahead<T>(values: &[T]) {
    let place: *const u8 = values.as_ptr().cast();
    let in_line = place.addr() % LINE;
    let first = place.wrapping_sub(in_line);
    for line in 0..(in_line + size_of_val(values)).div_ceil(LINE) {
        prefetch::<LINE>(first.wrapping_add(LINE * line));
    }
}

/// Begins to load the lines of `BYTES` bytes from `place` on, which need not be valid.
#[inline(always)]
pub(crate) fn prefetch<const BYTES: usize>(place: *const u8) {
    #[cfg(target_arch = "x86_64")]
    for line in 0..BYTES.div_ceil(LINE) {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: a prefetch reads nothing that could be seen, wherever it points; it is part of SSE.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(place.wrapping_add(LINE * line).cast()) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = place;
}

/// Returns an empty array with room for exactly `count` elements. If it is large, it is in large pages if the system
/// allows it: rays jump about in it, and each jump to a small page costs a search for that page.
pub(crate) fn with_room<T>(count: usize) -> Vec<T> {
    let mut empty = Vec::with_capacity(count);
    if count * size_of::<T>() >= LARGE {
        ask_for_large_pages(&mut empty);
    }
    empty
}

/// Requests large pages before the memory is touched. A refusal changes nothing.
#[cfg(target_os = "linux")]
fn ask_for_large_pages<T>(empty: &mut Vec<T>) {
    /// The size of the smallest pages; the range of the advice must begin at a multiple.
    const PAGE: usize = 4096;
    let begin: *mut u8 = empty.as_mut_ptr().cast();
    let skipped = begin.align_offset(PAGE);
    let bytes = (empty.capacity() * size_of::<T>()).saturating_sub(skipped);
    // SAFETY: the range lies within the allocation, and the advice changes neither what is in it nor
    // who may use it.
    unsafe {
        libc::madvise(
            begin.add(skipped).cast(),
            bytes / PAGE * PAGE,
            libc::MADV_HUGEPAGE,
        );
    }
}

#[cfg(not(target_os = "linux"))]
fn ask_for_large_pages<T>(_: &mut Vec<T>) {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn room_is_as_asked() {
        for count in [0, 1, 1000, LARGE / 4, LARGE + 77] {
            let mut elements: Vec<u32> = with_room(count);
            elements.extend(0..count as u32);
            assert_eq!(elements.capacity(), count);
            assert!(elements.iter().copied().eq(0..count as u32));
        }
    }
}
