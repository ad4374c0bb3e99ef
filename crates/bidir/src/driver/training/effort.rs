//! The limits of training.

use accel::Stop;

/// The limits of training. A host that has little time for it renders with the results of fewer samples: with
/// more noise, but of the same image.
#[derive(Clone, Copy)]
pub struct Effort<'a> {
    /// The most samples. The first 16 are always taken, and the others in rounds that double their number:
    /// training with as many as another one took is the same.
    pub samples: u64,
    /// Training ends when it returns true, with the samples of the complete rounds. All threads call it.
    pub is_late: IsLate<'a>,
    /// Asks to give up training, and the session with it.
    pub stop: Stop<'a>,
}

/// True where training is to end.
pub(super) type IsLate<'a> = &'a (dyn Fn() -> bool + Sync);

impl Effort<'_> {
    /// Hosts give training at most one part in so many of the time of a render.
    pub const PART: u32 = 10;
    /// The number of samples that training needs.
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
