//! Asking what takes long to end.

use std::fmt;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::bvh::Bvh;
use crate::lockstep::AreBlocked;
use crate::query::{Anything, ClosestHit, EachHit, Query};
use crate::ray::{Hit, Ray};
use crate::traverse::Ask;

/// A flag of somebody who may lose interest in an answer. Once set it must stay set for as long as anybody looks at
/// it: whoever has seen it may have left anything undone.
#[derive(Clone, Copy, Default)]
pub struct Stop<'a>(Option<&'a AtomicBool>);

impl<'a> Stop<'a> {
    /// Nobody asks.
    pub const NEVER: Stop<'static> = Stop(None);

    /// Asks as soon as `flag` is set.
    pub fn when(flag: &'a AtomicBool) -> Self {
        Self(Some(flag))
    }

    /// Returns true once the flag is set.
    #[inline(always)]
    pub fn is_asked(self) -> bool {
        self.0.is_some_and(|flag| flag.load(Ordering::Relaxed))
    }
}

impl fmt::Debug for Stop<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Stop").field(&self.is_asked()).finish()
    }
}

/// The questions that a [`Bvh`] answers until it is asked to stop; then their answers mean nothing, and come at once:
/// a ray that meets a million instances looks at each of them first.
#[derive(Clone, Copy, Debug)]
pub struct Queries<'a> {
    bvh: &'a Bvh,
    stop: Stop<'a>,
}

impl Bvh {
    /// The same questions, for as long as nobody asks to `stop`.
    #[inline(always)]
    pub fn until<'a>(&'a self, stop: Stop<'a>) -> Queries<'a> {
        Queries { bvh: self, stop }
    }
}

impl Queries<'_> {
    /// As [`Bvh::closest`].
    #[inline]
    pub fn closest<F: Fn(&Hit) -> bool>(self, ray: &Ray, accept: F) -> Option<Hit> {
        let mut query = ClosestHit::new(accept);
        self.ask(ray, &mut query);
        query.best
    }

    /// As [`Bvh::is_blocked`].
    #[inline]
    pub fn is_blocked(self, ray: &Ray) -> bool {
        let mut query = Anything { found: false };
        self.ask(ray, &mut query);
        query.found
    }

    /// As [`Bvh::are_blocked`].
    pub fn are_blocked(self, rays: &[Ray], blocked: &mut Vec<bool>) {
        let Self { bvh, stop } = self;
        blocked.clear();
        blocked.resize(rays.len(), false);
        bvh.isa().call(AreBlocked {
            bvh,
            rays,
            blocked,
            stop,
        });
    }

    /// As [`Bvh::each_hit`].
    #[inline]
    pub fn each_hit<F: FnMut(&Hit) -> ControlFlow<()>>(
        self,
        ray: &Ray,
        found: F,
    ) -> ControlFlow<()> {
        let mut query = EachHit::new(found);
        self.ask(ray, &mut query);
        query.flow
    }

    #[inline]
    pub(crate) fn ask(self, ray: &Ray, query: &mut impl Query) {
        let Self { bvh, stop } = self;
        if !stop.is_asked() {
            bvh.isa().call(Ask {
                bvh,
                ray,
                query,
                stop,
            });
        }
    }
}
