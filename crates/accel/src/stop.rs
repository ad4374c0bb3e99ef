//! Requests to end a long computation.

use std::fmt;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::bvh::Bvh;
use crate::lockstep::AreBlocked;
use crate::query::{Anything, ClosestHit, EachHit, Query};
use crate::ray::{Hit, Ray};
use crate::traverse::Ask;

/// A flag that asks a computation to end, because its result is no longer needed. Once set, it must stay set for as
/// long as anything reads it: whatever has seen it may have left its work undone.
#[derive(Clone, Copy, Default)]
pub struct Stop<'a>(Option<&'a AtomicBool>);

impl<'a> Stop<'a> {
    /// Never asks.
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

/// The queries of a [`Bvh`], until they are asked to stop; then they return at once, with arbitrary results. A ray
/// checks the flag before each instance, as it may hit a million of them.
#[derive(Clone, Copy, Debug)]
pub struct Queries<'a> {
    bvh: &'a Bvh,
    stop: Stop<'a>,
}

impl Bvh {
    /// Returns the queries of the tree, to end when `stop` asks.
    #[inline(always)]
    pub fn until<'a>(&'a self, stop: Stop<'a>) -> Queries<'a> {
        Queries { bvh: self, stop }
    }
}

impl Queries<'_> {
    /// Like [`Bvh::closest`].
    #[inline]
    pub fn closest<F: Fn(&Hit) -> bool>(self, ray: &Ray, accept: F) -> Option<Hit> {
        let mut query = ClosestHit::new(accept);
        self.ask(ray, &mut query);
        query.best
    }

    /// Like [`Bvh::is_blocked`].
    #[inline]
    pub fn is_blocked(self, ray: &Ray) -> bool {
        let mut query = Anything { found: false };
        self.ask(ray, &mut query);
        query.found
    }

    /// Like [`Bvh::are_blocked`].
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

    /// Like [`Bvh::each_hit`].
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
