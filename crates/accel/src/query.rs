//! The queries about the hits of a ray.

use std::ops::ControlFlow;

use crate::ray::Hit;

/// A query about the hits of a ray.
pub(crate) trait Query {
    /// True if any hit answers the query.
    const ANYTHING: bool = false;

    /// Takes a hit at most as far as the ray's `t_max`, which it may shorten.
    fn offer(&mut self, hit: Hit, t_max: &mut f32) -> ControlFlow<()>;
}

/// Finds the first of the accepted hits in the order of [`Hit::is_before`].
pub(crate) struct ClosestHit<F> {
    accept: F,
    pub(crate) best: Option<Hit>,
}

impl<F> ClosestHit<F> {
    pub(crate) fn new(accept: F) -> Self {
        Self { accept, best: None }
    }
}

impl<F: Fn(&Hit) -> bool> Query for ClosestHit<F> {
    #[inline(always)]
    fn offer(&mut self, hit: Hit, t_max: &mut f32) -> ControlFlow<()> {
        if self.best.is_none_or(|best| hit.is_before(&best)) && (self.accept)(&hit) {
            *t_max = hit.t;
            self.best = Some(hit);
        }
        ControlFlow::Continue(())
    }
}

/// Finds whether there is any hit.
pub(crate) struct Anything {
    pub(crate) found: bool,
}

impl Query for Anything {
    const ANYTHING: bool = true;

    #[inline(always)]
    fn offer(&mut self, _: Hit, _: &mut f32) -> ControlFlow<()> {
        self.found = true;
        ControlFlow::Break(())
    }
}

/// Finds all hits, until `found` breaks.
pub(crate) struct EachHit<F> {
    found: F,
    pub(crate) flow: ControlFlow<()>,
}

impl<F> EachHit<F> {
    pub(crate) fn new(found: F) -> Self {
        Self {
            found,
            flow: ControlFlow::Continue(()),
        }
    }
}

impl<F: FnMut(&Hit) -> ControlFlow<()>> Query for EachHit<F> {
    #[inline(always)]
    fn offer(&mut self, hit: Hit, _: &mut f32) -> ControlFlow<()> {
        self.flow = (self.found)(&hit);
        self.flow
    }
}
