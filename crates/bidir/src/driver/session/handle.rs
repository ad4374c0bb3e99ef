//! The owner of the scene that a session renders.

use crate::scene::Scene;
use std::ops::Deref;
use std::sync::Arc;

/// The scene of a session: borrowed, or kept alive by it, for hosts whose objects borrow nothing.
#[derive(Clone)]
pub enum SceneHandle<'a> {
    /// Somebody else keeps it.
    Borrowed(&'a Scene),
    /// The session has a share in it.
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
