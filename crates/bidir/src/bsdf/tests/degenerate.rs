use super::simulation::{Base, Stack};
use super::{MODES, direction};
use crate::bsdf::microfacet::Ggx;
use crate::bsdf::{
    Bsdf, Conductor, Dielectric, Diffuse, DiffuseTransmission, FacetScattering, ThinDielectric,
};
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
        let metal = |scattering| {
            let [eta, k] = [eta, k].map(Spectrum::splat);
            Bsdf::Conductor(Conductor::new(eta, k, ggx, scattering))
        };
        let glass = |scattering| Bsdf::Dielectric(Dielectric::new(eta, ggx, scattering));
        let (single, multiple) = (FacetScattering::Single, FacetScattering::Multiple);
        let reflectance = Spectrum::splat(k / 5.0);
        prop::sample::select(vec![
            Bsdf::Diffuse(Diffuse { reflectance }),
            metal(single),
            metal(multiple),
            glass(single),
            glass(multiple),
            Bsdf::ThinDielectric(ThinDielectric { eta }),
            Bsdf::DiffuseTransmission(DiffuseTransmission {
                reflectance,
                transmittance: Spectrum::splat(1.0 - k / 5.0),
            }),
        ])
    })
}

/// Layers with every index and slope that is odd, under every filling: they are integrated once.
fn coated() -> Vec<Bsdf> {
    let mut all = Vec::new();
    for eta in [1.0, 1.0 + 1e-5, 0.7, 1.5, 3.0, 1e3, 1e-3] {
        for alpha in [0.0, 1.1e-3, 0.3, 1.0] {
            // Few indices, as scattering layers are walked.
            let is_hazy = (eta, alpha) == (1.5, 0.0) || (eta, alpha) == (0.7, 0.3);
            let hazes = if is_hazy { 3 } else { 1 };
            let metal = Base::Metal {
                eta: 0.0,
                k: 1.0,
                alpha: 0.2,
            };
            for &(thickness, albedo) in &[(0.0, 0.0), (1e4, 1.0), (2.0, 0.5)][..hazes] {
                let stack = |base| Stack {
                    eta,
                    alpha,
                    thickness,
                    albedo,
                    g: -1.0,
                    base,
                };
                all.extend([Base::Diffuse(1.0), metal].map(|base| stack(base).bsdf()));
            }
        }
    }
    all
}

/// No direction, roughness or index gives a value that is not a number, nor a density that is
/// negative or infinite.
#[test]
fn values_are_numbers_in_every_corner() {
    let numbers = (a_number(), a_number(), a_number());
    let bsdf = prop_oneof![a_bsdf().boxed(), prop::sample::select(coated()).boxed()];
    check_property(&(bsdf, a_direction(), a_direction(), numbers), |case| {
        let (bsdf, wo, wi, (u_lobe, u_x, u_y)) = case;
        let mut albedos = bsdf.albedo(wo).0.into_iter();
        prop_assert!(albedos.all(|lane| (0.0..=1.0).contains(&lane)));
        for mode in MODES {
            let value = bsdf.eval(wo, wi, mode);
            let is_density = |pdf: f32| pdf >= 0.0 && pdf.is_finite();
            let f = value.f;
            prop_assert!(is_density(value.pdf), "density {}", value.pdf);
            prop_assert!(is_density(value.pdf_reverse), "{}", value.pdf_reverse);
            let is_positive = f.is_finite() && f.0.iter().all(|&lane| lane >= 0.0);
            prop_assert!(is_positive, "f = {f:?}");
            if let Some(drawn) = bsdf.sample(wo, mode, || u_lobe, Vec2::new(u_x, u_y)) {
                prop_assert!((drawn.wi.length() - 1.0).abs() < 1e-3, "{drawn:?}");
                prop_assert!(drawn.weight.is_finite() && drawn.weight.max_lane() >= 0.0);
                let is_fine = is_density(drawn.pdf) && is_density(drawn.pdf_reverse);
                prop_assert!(is_fine, "{drawn:?}");
                prop_assert!(drawn.is_delta || !bsdf.is_delta());
            }
        }
        Ok(())
    });
}
