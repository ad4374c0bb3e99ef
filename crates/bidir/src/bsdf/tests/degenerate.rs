use super::{MODES, direction};
use crate::bsdf::microfacet::Ggx;
use crate::bsdf::{Bsdf, Conductor, Dielectric, Diffuse};
use crate::math::{ONE_MINUS_EPSILON, Vec2, Vec3};
use crate::spectrum::Spectrum;
use crate::testing::check_property;
use proptest::prelude::*;

fn a_direction() -> impl Strategy<Value = Vec3> {
    let small = prop::sample::select(vec![0.0, 1e-14, 1e-12, 1e-7, 1e-4, 1.0]);
    let cos = prop_oneof![
        (-1.0f32..1.0).boxed(),
        small.clone().boxed(),
        small.prop_map(|z| -z).boxed()
    ];
    (cos, 0.0f32..6.3).prop_map(|(cos, phi)| direction(cos, phi))
}

fn a_number() -> impl Strategy<Value = f32> {
    prop_oneof![
        (0.0f32..1.0).boxed(),
        Just(0.0).boxed(),
        Just(ONE_MINUS_EPSILON).boxed()
    ]
}

fn a_bsdf() -> impl Strategy<Value = Bsdf> {
    let alpha = || prop::sample::select(vec![0.0, 1e-5, 1e-3, 1.1e-3, 0.01, 0.3, 1.0, 10.0]);
    let eta = prop::sample::select(vec![1.0, 1.0 + 1e-5, 0.99, 1.5, 1e-3, 1e3, 1e6]);
    (alpha(), alpha(), eta, 0.0f32..5.0).prop_flat_map(|(x, y, eta, k)| {
        let ggx = Ggx::new(x, y);
        let metal = Conductor {
            eta: Spectrum::splat(eta),
            k: Spectrum::splat(k),
            ggx,
        };
        let reflectance = Spectrum::splat(k / 5.0);
        prop::sample::select(vec![
            Bsdf::Diffuse(Diffuse { reflectance }),
            Bsdf::Conductor(metal),
            Bsdf::Dielectric(Dielectric { eta, ggx }),
        ])
    })
}

/// No direction, roughness or index gives a value that is not a number, nor a density that is
/// negative or infinite.
#[test]
fn values_are_numbers_in_every_corner() {
    let numbers = (a_number(), a_number(), a_number());
    check_property(&(a_bsdf(), a_direction(), a_direction(), numbers), |case| {
        let (bsdf, wo, wi, (u_lobe, u_x, u_y)) = case;
        prop_assert!(bsdf.pdf(wo, wi) >= 0.0 && bsdf.pdf(wo, wi).is_finite());
        prop_assert!(
            bsdf.albedo(wo)
                .0
                .iter()
                .all(|lane| (0.0..=1.0).contains(lane))
        );
        for mode in MODES {
            let f = bsdf.eval(wo, wi, mode);
            prop_assert!(
                f.is_finite() && f.0.iter().all(|&lane| lane >= 0.0),
                "f = {f:?}"
            );
            if let Some(drawn) = bsdf.sample(wo, mode, u_lobe, Vec2::new(u_x, u_y)) {
                prop_assert!((drawn.wi.length() - 1.0).abs() < 1e-3, "{drawn:?}");
                prop_assert!(drawn.weight.is_finite() && drawn.weight.max_lane() >= 0.0);
                prop_assert!(drawn.pdf >= 0.0 && drawn.pdf.is_finite(), "{drawn:?}");
                prop_assert!(drawn.pdf_reverse >= 0.0 && drawn.pdf_reverse.is_finite());
                prop_assert_eq!(drawn.is_delta, bsdf.is_delta());
            }
        }
        Ok(())
    });
}
