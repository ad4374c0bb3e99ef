//! See `bidir_fuzz::inputs::nanovdb`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| bidir_fuzz::inputs::nanovdb(bytes));
