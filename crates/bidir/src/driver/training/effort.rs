//! The limits of training.

use accel::Stop;

/// The limits of training. A host with little time for training renders with what fewer samples give: the image is
/// the same, with more noise.
#[derive(Clone, Copy)]
pub struct Effort<'a> {
    /// The most samples. Training takes the first 16 always, and more in rounds that double their number. Training to
    /// the same number gives the same results, whichever limit ended it.
    pub samples: u64,
    /// Ends training if it returns true, with the samples of the complete rounds. All threads call it.
    pub is_late: IsLate<'a>,
    /// The flag by which the host gives up training, and the session with it.
    pub stop: Stop<'a>,
}

/// Returns true when training is to end.
pub(super) type IsLate<'a> = &'a (dyn Fn() -> bool + Sync);

impl Effort<'_> {
    /// The inverse of the fraction of a render's time that hosts allow for training.
    pub const PART: u32 = 10;
    /// No limit: training takes the samples that it needs.
    pub const WHOLE: Effort<'static> = Effort::at_most(u64::MAX);

    /// Limits the number of samples.
    pub const fn at_most(samples: u64) -> Effort<'static> {
        Effort {
            samples,
            is_late: &|| false,
            stop: Stop::NEVER,
        }
    }
}
