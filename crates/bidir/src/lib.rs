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
//!   → film: add value / π                                                   film
//! ```
//!
//! The crate does not read files, print, look at a clock or hold statics. A built scene is valid,
//! so rendering cannot fail: it can only be stopped.
//!
//! Reading order: [`path`], [`select`], [`integrator`], [`driver`]; the things of a scene
//! ([`bsdf`], [`light`], [`camera`], [`shape`], [`texture`], [`material`]) each have their contract
//! on the page of their module.

pub mod bsdf;
pub mod camera;
pub mod driver;
pub mod film;
pub mod integrator;
pub mod light;
pub mod material;
pub mod math;
pub mod path;
pub mod sampler;
pub mod scene;
pub mod select;
pub mod shape;
pub mod spectrum;
pub mod stats;
pub mod texture;

#[cfg(test)]
pub(crate) mod testing;
