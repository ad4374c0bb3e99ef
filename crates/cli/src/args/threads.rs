//! The flag for the number of threads.

use super::values::count;
use bidir::driver::Threads;
use clap::Args;

/// The flag of all commands with long computations. Commands for which 0 has another meaning replace the
/// help text.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct ThreadsArgs {
    /// Threads [default: one per processor].
    ///
    /// 0 is the default. At most 4 per processor are used, or as many as the system starts, with a
    /// warning. The number never changes the image. pbrt's spelling --nthreads is accepted.
    #[arg(id = "threads", long = "threads", env = "BIDIR_THREADS")]
    #[arg(value_name = "N")]
    #[arg(default_value_t = 0, hide_default_value = true)]
    #[arg(value_parser = count::<u16>(0..=Threads::MOST as u64))]
    pub(crate) count: u16,
}
