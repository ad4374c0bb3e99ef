//! The images of a scene: each is decoded once for each of its uses.

use crate::source::Fault;
use bidir::texture::{Image, ImageFilter};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Images by their key, which says which file they are read from, and how.
#[derive(Default)]
pub(crate) struct Images<K, const N: usize>(BTreeMap<K, Arc<Image<N>>>);

impl<K: Ord, const N: usize> Images<K, N> {
    /// Returns the image of this key, with a pyramid of smaller copies if the filter needs one. For a new key, `read`
    /// returns the width and the texels.
    pub(crate) fn get<P: Clone>(
        &mut self,
        key: K,
        filter: ImageFilter,
        place: &P,
        read: impl FnOnce() -> Result<(usize, Vec<[f32; N]>), Fault<P>>,
    ) -> Result<Arc<Image<N>>, Fault<P>> {
        let mut image = if let Some(known) = self.0.get(&key) {
            Arc::clone(known)
        } else {
            let (width, texels) = read()?;
            Arc::new(image(width, texels, place)?)
        };
        if filter == ImageFilter::Trilinear && image.copies() == 0 {
            image = Arc::new(Arc::unwrap_or_clone(image).with_copies());
        }
        self.0.insert(key, Arc::clone(&image));
        Ok(image)
    }
}

/// Returns the image of texels in rows of `width`. Errors: there are none.
pub(crate) fn image<const N: usize, P: Clone>(
    width: usize,
    texels: Vec<[f32; N]>,
    place: &P,
) -> Result<Image<N>, Fault<P>> {
    let image = Image::new(width, texels);
    image.ok_or_else(|| Fault::scene(place.clone(), "the image has no pixels"))
}

/// Sets values that are not valid to 0. Returns their number.
pub(crate) fn replace_invalid<const N: usize>(
    texels: &mut [[f32; N]],
    is_valid: impl Fn(f32) -> bool,
) -> usize {
    let values = texels.iter_mut().flatten();
    let invalid = values.filter(|value| !is_valid(**value));
    invalid.map(|value| *value = 0.0).count()
}
