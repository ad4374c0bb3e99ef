//! Light transport: a [`Scene`](scene::Scene) in memory goes in, a [`Film`](film::Film) in memory comes out.
//!
//! The renderer estimates the path integral `I_q = ∫ h_q(x̄) f(x̄) dμ(x̄)` of every pixel `q`
//! [Veach97, §8.1]: `f` is the measurement contribution of a path `x̄ = x_0 … x_{n-1}`, counted from
//! the light, and `h_q` the pixel's filter. Every estimator here is the same five steps, each in its
//! own place:
//!
//! ```text
//! walk a light subpath · walk a camera subpath                              path::walk
//!   → candidates: every connection (s, t), weighted, before visibility      path::connect, path::mis
//!   → select: a probability π for each candidate                            select
//!   → trace only the chosen segments                                        scene::visibility
//!   → film: add C w v / π                                                   film
//! ```
//!
//! The crate does not read files, print, look at a clock or hold statics. A built scene is valid,
//! so rendering cannot fail: it can only be stopped.
//!
//! Reading order: [`path`], [`select`], [`integrator`], [`driver`]; the things of a scene
//! ([`bsdf`], [`light`], [`camera`], [`shape`], [`texture`], [`material`]) each have their contract
//! on the page of their module.
//!
//! # Example
//!
//! A grey sphere under a white sky:
//!
//! ```
//! use bidir::camera::{Camera, Perspective, PerspectiveSettings};
//! use bidir::driver::{self, Resources, Settings};
//! use bidir::film::{FilmSettings, Filter};
//! use bidir::light::{InfiniteLight, Light};
//! use bidir::material::Material;
//! use bidir::math::{Affine3A, Vec2, Vec3};
//! use bidir::scene::SceneBuilder;
//! use bidir::shape::{Orientation, Shape, Sphere};
//! use bidir::texture::ColorTexture;
//! use bidir::view::View;
//!
//! // At the origin, looking along +z; 90 degrees wide.
//! let camera = PerspectiveSettings {
//!     world_from_camera: Affine3A::IDENTITY,
//!     resolution: Vec2::splat(16.0),
//!     screen: [Vec2::new(-1.0, 1.0), Vec2::new(1.0, -1.0)],
//!     lens_radius: 0.0,
//!     focal_distance: 1.0,
//! };
//! let camera = Perspective::new(&camera).ok_or("no rigid camera")?;
//! let film = FilmSettings::new([16, 16], Filter::default());
//! let view = View::new(Camera::Perspective(camera), film)?;
//!
//! let mut builder = SceneBuilder::new();
//! let grey = builder.material(Material::Diffuse {
//!     reflectance: ColorTexture::Constant([0.5; 3]),
//! });
//! let place = Affine3A::from_translation(Vec3::new(0.0, 0.0, 3.0));
//! let sphere = Sphere::new(place, 1.0, Orientation::Natural);
//! builder.shape(Shape::Sphere(sphere), grey, None);
//! builder.light(Light::Infinite(InfiniteLight::constant([1.0; 3])));
//! let scene = builder.build()?;
//!
//! let film = driver::render(&scene, &view, &Settings::default(), 64, &Resources::default())?;
//! let picture = film.develop();
//! assert!(picture.pixels.iter().flatten().all(|channel| channel.is_finite()));
//! // The sphere is convex: it shows its reflectance times the sky.
//! let [_, centre, _] = picture.pixels[8 * picture.width + 8];
//! assert!((centre - 0.5).abs() < 0.25, "{centre}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod analysis;
pub mod bsdf;
pub mod camera;
pub mod contribution;
pub mod driver;
pub mod film;
pub mod guide;
pub mod integrator;
pub mod light;
pub mod locus;
pub mod material;
pub mod math;
pub mod medium;
pub mod names;
pub mod path;
pub mod sampler;
pub mod scene;
pub mod select;
pub mod settings;
pub mod shape;
pub mod spectrum;
pub mod stats;
mod strategy;
pub mod texture;
pub mod view;

// Tests of units share scenes with those of `tests`, which name the crate.
#[cfg(test)]
extern crate self as bidir;

#[cfg(test)]
pub(crate) mod testing;

/// Which estimates the program makes: films of different numbers are never added.
///
/// Raise it with every change after which the same scene, settings and passes have other bits, be it
/// in an estimator, in random numbers, in the intersector, or in what readers make of a scene. The
/// version of the program is not enough: people build what is between two of them.
pub const ESTIMATOR_VERSION: u32 = 40;
