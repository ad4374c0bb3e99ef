//! Trees that are asked for every instruction set of the machine.

use std::ops::Deref;

use bidir_accel::{BuildOptions, Bvh, Hit, Isa, Primitive, Ray, accept_all};

use crate::oracle::hit_bits;

/// One tree for each instruction set; all must give the same answers. Else it is the portable one.
pub(crate) struct Trees(Vec<Bvh>);

impl Trees {
    /// Validates the tree.
    #[track_caller]
    pub(crate) fn new(bvh: &Bvh) -> Self {
        assert_eq!(bvh.validate(), Ok(()));
        let for_isa = |isa| bvh.clone().with_isa(isa).expect("supported");
        Self(Isa::supported().map(for_isa).collect())
    }

    #[track_caller]
    pub(crate) fn closest(&self, ray: &Ray, accept: impl Fn(&Hit) -> bool) -> Option<Hit> {
        let expected = self.0[0].closest(ray, &accept);
        for bvh in &self.0[1..] {
            let hit = bvh.closest(ray, &accept);
            let isa = bvh.isa();
            assert_eq!(hit_bits(hit), hit_bits(expected), "{isa}: {ray:?}");
        }
        expected
    }

    /// Checks the closest of the accepted hits, to the bit.
    #[track_caller]
    pub(crate) fn check(&self, ray: &Ray, accept: impl Fn(&Hit) -> bool, expected: Option<Hit>) {
        let hit = self.closest(ray, &accept);
        assert_eq!(hit_bits(hit), hit_bits(expected), "{ray:?}");
    }

    /// True if there is any hit, by one tree and one question, other ones with every `turn`.
    pub(crate) fn is_hit_in_turn(&self, turn: usize, ray: &Ray) -> bool {
        let bvh = &self.0[turn % self.0.len()];
        match turn / self.0.len() % 3 {
            0 => bvh.closest(ray, accept_all).is_some(),
            1 => are_blocked(bvh, std::slice::from_ref(ray))[0],
            _ => bvh.is_blocked(ray),
        }
    }

    /// True if there is any hit, without a filter.
    #[track_caller]
    pub(crate) fn is_blocked(&self, ray: &Ray) -> bool {
        let expected = self.0[0].is_blocked(ray);
        for bvh in &self.0[1..] {
            assert_eq!(bvh.is_blocked(ray), expected, "{}: {ray:?}", bvh.isa());
        }
        expected
    }

    /// Which of `rays` hit anything, without a filter.
    #[track_caller]
    pub(crate) fn are_blocked(&self, rays: &[Ray]) -> Vec<bool> {
        let expected = are_blocked(&self.0[0], rays);
        for bvh in &self.0[1..] {
            assert_eq!(are_blocked(bvh, rays), expected, "{}", bvh.isa());
        }
        expected
    }

    /// True if anything is in the way, by all questions, which must agree.
    #[track_caller]
    pub(crate) fn is_hit(&self, ray: &Ray) -> bool {
        let expected = self.closest(ray, accept_all).is_some();
        assert_eq!(self.is_blocked(ray), expected, "{ray:?}");
        let many = self.are_blocked(std::slice::from_ref(ray));
        assert_eq!(many, [expected], "{ray:?}");
        expected
    }
}

fn are_blocked(bvh: &Bvh, rays: &[Ray]) -> Vec<bool> {
    let mut blocked = vec![true];
    bvh.are_blocked(rays, &mut blocked);
    blocked
}

impl Deref for Trees {
    type Target = Bvh;

    fn deref(&self) -> &Bvh {
        &self.0[0]
    }
}

/// A validated tree, for each instruction set.
#[track_caller]
pub(crate) fn build(primitives: &[Primitive]) -> Trees {
    Trees::new(&build_one(primitives))
}

/// The tree that most renders use.
#[track_caller]
pub(crate) fn build_one(primitives: &[Primitive]) -> Bvh {
    Bvh::build(primitives, &BuildOptions::default()).expect("a valid scene")
}

/// What `work` returns on so many threads.
pub(crate) fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.expect("threads").install(work)
}
