//! See `bidir_fuzz::inputs::ply`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| bidir_fuzz::inputs::ply(bytes));
