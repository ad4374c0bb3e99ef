//! The crate from outside: whole paths, estimators and films, in scenes made in memory.

#[path = "../common/mod.rs"]
mod common;

mod analytic;
mod dropped;
mod layers;
mod materials;
mod media;
mod module_order;
mod path_identities;
mod relief;
mod reproducibility;
mod running_weights;
mod seen_directly;
