use super::sse::Sse4;
use super::*;

const SAMPLES: [f32; 9] = [
    0.0,
    -0.0,
    1.0,
    -2.5,
    1e-45,
    f32::MAX,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
];

fn is_same(a: f32, b: f32) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

/// Compares four lanes of set `S` with the portable ones.
struct Four<'a>(&'a [f32; 4], f32);

impl Kernel for Four<'_> {
    type Output = ();

    fn run<S: Simd>(self) {
        let Self(lanes, b) = self;
        let (p, q) = (Scalar4::load(lanes), Scalar4::splat(b));
        let (r, s) = (S::Four::load(lanes), S::Four::splat(b));
        let pairs = [
            (p + q, r + s),
            (p - q, r - s),
            (p * q, r * s),
            (p.min(q), r.min(s)),
            (p.max(q), r.max(s)),
            (p.abs(), r.abs()),
        ];
        for (scalar, simd) in pairs {
            check_lanes(scalar, simd);
        }
        assert_eq!((p.lt(q), p.le(q)), (r.lt(s), r.le(s)));
        // Products of these are exact, fused or not.
        let exact = |x: f32| [0.0, 1.0, 2.5].contains(&x.abs());
        if lanes.iter().all(|&x| exact(x)) && exact(b) {
            check_lanes(p.mul_add(q, q), r.mul_add(s, s));
            check_lanes(p.mul_sub(q, q), r.mul_sub(s, s));
            check_lanes(p.sub_from(q, q), r.sub_from(s, s));
        }
    }
}

#[track_caller]
fn check_lanes(scalar: Scalar4, simd: impl F32x4) {
    let (a, b) = (scalar.to_array(), simd.to_array());
    let mut pairs = a.into_iter().zip(b);
    assert!(pairs.all(|(a, b)| is_same(a, b)), "{a:?} {b:?}");
}

/// The same for eight lanes.
struct Eight<'a>(&'a [f32; 8], f32);

impl Kernel for Eight<'_> {
    type Output = ();

    fn run<S: Simd>(self) {
        type Plain = Pair<Scalar4>;
        let Self(lanes, b) = self;
        let low: [u32; 8] = std::array::from_fn(|k| 100 + k as u32);
        let (p, q) = (Plain::load(lanes), Plain::splat(b));
        let (r, s) = (S::Eight::load(lanes), S::Eight::splat(b));
        let zero = (Plain::splat(0.0), S::Eight::splat(0.0));
        check_words(p.over(&low), r.over(&low));
        check_words(
            p.mul_sub(q, zero.0).over(&low),
            r.mul_sub(s, zero.1).over(&low),
        );
        // The operands that comparisons are defined for.
        let ordered = |x: f32| !x.is_nan() && x.to_bits() != (-0.0_f32).to_bits();
        if lanes.iter().all(|&x| ordered(x)) && ordered(b) && b >= 0.0 {
            check_words(p.min(q).over(&low), r.min(s).over(&low));
            check_words(p.max(q).over(&low), r.max(s).over(&low));
            assert_eq!((p.le(q), q.le(p)), (r.le(s), s.le(r)));
        }
    }
}

#[track_caller]
fn check_words(scalar: [u64; 8], simd: [u64; 8]) {
    for (a, b) in scalar.into_iter().zip(simd) {
        assert_eq!(a as u32, b as u32);
        let upper = |word: u64| f32::from_bits((word >> 32) as u32);
        assert!(is_same(upper(a), upper(b)), "{scalar:?} {simd:?}");
    }
}

#[test]
fn implementations_agree_on_special_values() {
    for a in SAMPLES {
        for b in SAMPLES {
            let four = [a, b, 1.0, a];
            let eight = [a, 1.0, 2.0, b, -a, b, a, 3.0];
            for isa in crate::Isa::supported() {
                isa.call(Four(&four, b));
                isa.call(Eight(&eight, b));
            }
        }
    }
}

#[test]
fn nan_selects_the_second_operand() {
    let (nan, one) = (Sse4::<false>::splat(f32::NAN), Sse4::splat(1.0));
    assert_eq!((nan.min(one).lt(one), nan.min(one).le(one)), (0, 0b1111));
    assert_eq!((nan.max(one).lt(one), nan.max(one).le(one)), (0, 0b1111));
    assert!(one.max(nan).to_array()[0].is_nan());
}

/// Compares what is done with eight words with plain loops.
struct Words<'a>(&'a [u32; 8]);

impl Kernel for Words<'_> {
    type Output = ();

    fn run<S: Simd>(self) {
        let Self(words) = self;
        let upper = (0..8).filter(|&k| words[k] >= 1 << 30);
        let expected = upper.fold(0, |mask, k| mask | 1 << k);
        assert_eq!(S::Eight::upper_two(words), expected, "{words:x?}");
        for mask in 0..256_u32 {
            let mut packed = [MaybeUninit::new(0); 8];
            S::Eight::pack(mask, words, &mut packed);
            let set = (0..8).filter(|k| mask >> k & 1 == 1);
            for (packed, k) in packed.into_iter().zip(set) {
                // SAFETY: all are initialised above.
                assert_eq!(unsafe { packed.assume_init() }, words[k], "{mask:b}");
            }
        }
    }
}

#[test]
fn words_are_packed_and_distinguished() {
    let bits = [0, 1 << 29, 1 << 30, 1 << 31];
    for shift in 0..8 {
        let words = std::array::from_fn(|k| bits[(k + shift) % 3 + k % 2] | k as u32);
        for isa in crate::Isa::supported() {
            isa.call(Words(&words));
        }
    }
}
