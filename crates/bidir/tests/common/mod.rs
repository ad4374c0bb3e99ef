#![allow(
    dead_code,
    unused_imports,
    reason = "every test file uses a part of this module"
)]
//! Scenes, statistics and walks, for the tests of whole paths.

pub(crate) mod materials;
pub(crate) mod rooms;
pub(crate) mod scenes;
pub(crate) mod statistics;
pub(crate) mod walks;

/// Names that most tests of whole paths use.
pub(crate) mod prelude {
    pub(crate) use super::materials::*;
    pub(crate) use super::scenes::*;
    pub(crate) use super::statistics::{
        Replicates, WHOLE, check_agree, check_agree_to, replicates, replicates_of,
    };
    pub(crate) use bidir::driver::{Session, Settings};
    pub(crate) use bidir::film::{Film, Layers};
    pub(crate) use bidir::integrator::IntegratorKind;
    pub(crate) use bidir::math::{Affine3A, PI, Vec2, Vec3};
    pub(crate) use bidir::shape::{Orientation, Shape, Sphere};
    pub(crate) use bidir::spectrum::{Rgb, Spectrum};
}

use scenes::Shot;
use statistics::Shown;

impl<'a> From<&'a Shot> for Shown<'a> {
    fn from(shot: &'a Shot) -> Self {
        Self {
            scene: &shot.scene,
            view: &shot.view,
        }
    }
}
