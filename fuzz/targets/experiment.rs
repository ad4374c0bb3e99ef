//! See `bidir_fuzz::experiments::experiment`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| bidir_fuzz::experiments::experiment(bytes));
