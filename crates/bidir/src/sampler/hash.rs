//! The hash that all keys of random numbers go through \[Steele14\].

/// Returns a bijective hash of 64 bits. Each output bit depends on every input bit: the finaliser of SplitMix64
/// \[Steele14\].
#[inline]
pub(super) fn mix(x: u64) -> u64 {
    let step = |x: u64, shift: u32, factor: u64| (x ^ (x >> shift)).wrapping_mul(factor);
    let begun = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let once = step(begun, 30, 0xbf58_476d_1ce4_e5b9);
    let twice = step(once, 27, 0x94d0_49bb_1331_11eb);
    twice ^ (twice >> 31)
}
