//! A handle to the scene that a session renders.

use crate::scene::Scene;
use std::ops::Deref;
use std::sync::Arc;

/// The scene of a session: borrowed, or shared with it, for hosts that cannot hold a borrow.
#[derive(Clone)]
pub enum SceneHandle<'a> {
    /// The caller keeps the scene alive.
    Borrowed(&'a Scene),
    /// The session keeps the scene alive.
    Shared(Arc<Scene>),
}

impl<'a> From<&'a Scene> for SceneHandle<'a> {
    fn from(scene: &'a Scene) -> Self {
        Self::Borrowed(scene)
    }
}

impl<'a> From<&'a Arc<Scene>> for SceneHandle<'a> {
    fn from(scene: &'a Arc<Scene>) -> Self {
        Self::Borrowed(scene)
    }
}

impl From<Arc<Scene>> for SceneHandle<'_> {
    fn from(scene: Arc<Scene>) -> Self {
        Self::Shared(scene)
    }
}

impl Deref for SceneHandle<'_> {
    type Target = Scene;

    #[inline]
    fn deref(&self) -> &Scene {
        match self {
            Self::Borrowed(scene) => scene,
            Self::Shared(scene) => scene,
        }
    }
}
