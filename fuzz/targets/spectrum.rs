//! See `bidir_fuzz::inputs::spectrum`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| bidir_fuzz::inputs::spectrum(bytes));
