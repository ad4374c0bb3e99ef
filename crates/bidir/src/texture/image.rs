//! Images laid over a surface: the texel at the point, or four around it interpolated, in linear
//! values. There are no smaller copies of an image for distant views: a pixel's samples average it.

use crate::math::Vec2;
use std::sync::Arc;

/// A rectangle of texels with `N` linear channels; row 0 is the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Image<const N: usize> {
    width: usize,
    height: usize,
    texels: Vec<[f32; N]>,
}

impl<const N: usize> Image<N> {
    /// An image of `texels.len() / width` rows. None: empty, or no whole number of rows.
    pub fn new(width: usize, texels: Vec<[f32; N]>) -> Option<Self> {
        let whole = width > 0 && !texels.is_empty() && texels.len().is_multiple_of(width);
        whole.then(|| Self {
            width,
            height: texels.len() / width,
            texels,
        })
    }

    /// Texels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The texels, row by row from the top.
    pub fn texels(&self) -> &[[f32; N]] {
        &self.texels
    }

    /// The texel at column `x` of row `y`.
    #[inline]
    pub fn texel(&self, x: usize, y: usize) -> [f32; N] {
        self.texels[y * self.width + x]
    }
}

/// What lies beyond an image's border.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// The image again.
    Repeat,
    /// The image mirrored, then again.
    Mirror,
    /// The border's texel.
    Clamp,
    /// Zero.
    Black,
}

/// How texels become a function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageFilter {
    /// The texel that the point lies in.
    Point,
    /// Interpolation between the four nearest texel centres.
    Bilinear,
}

/// An image laid over (s, t) = `scale`·(u, v) + `offset`; t = 1 is the top row.
#[derive(Clone, Debug)]
pub struct ImageMap<const N: usize> {
    /// The texels, shared between textures.
    pub image: Arc<Image<N>>,
    /// What lies beyond the border.
    pub wrap: Wrap,
    /// How texels are interpolated.
    pub filter: ImageFilter,
    /// Factors of u and v.
    pub scale: Vec2,
    /// Offsets of s and t.
    pub offset: Vec2,
}

impl<const N: usize> ImageMap<N> {
    /// The value at `uv`.
    #[inline]
    pub fn eval(&self, uv: Vec2) -> [f32; N] {
        let st = uv * self.scale + self.offset;
        let (x, y) = (
            st.x * self.image.width as f32,
            (1.0 - st.y) * self.image.height as f32,
        );
        match self.filter {
            ImageFilter::Point => self.fetch(x.floor() as i64, y.floor() as i64),
            ImageFilter::Bilinear => self.bilinear(x - 0.5, y - 0.5),
        }
    }

    #[inline]
    fn bilinear(&self, x: f32, y: f32) -> [f32; N] {
        let (x0, y0) = (x.floor(), y.floor());
        let (fx, fy) = (x - x0, y - y0);
        let (i, j) = (x0 as i64, y0 as i64);
        let [a, b, c, d] =
            [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)].map(|(x, y)| self.fetch(x, y));
        std::array::from_fn(|channel| {
            let top = a[channel] * (1.0 - fx) + b[channel] * fx;
            let bottom = c[channel] * (1.0 - fx) + d[channel] * fx;
            top * (1.0 - fy) + bottom * fy
        })
    }

    #[inline]
    fn fetch(&self, x: i64, y: i64) -> [f32; N] {
        let (width, height) = (self.image.width as i64, self.image.height as i64);
        let (x, y) = match self.wrap {
            Wrap::Repeat => (x.rem_euclid(width), y.rem_euclid(height)),
            Wrap::Mirror => (mirrored(x, width), mirrored(y, height)),
            Wrap::Clamp => (x.clamp(0, width - 1), y.clamp(0, height - 1)),
            Wrap::Black if x < 0 || y < 0 || x >= width || y >= height => return [0.0; N],
            Wrap::Black => (x, y),
        };
        self.image.texel(x as usize, y as usize)
    }
}

/// The texel that number `x` of a row is which is laid out forwards and backwards by turns.
#[inline]
fn mirrored(x: i64, width: i64) -> i64 {
    let x = x.rem_euclid(2 * width);
    x.min(2 * width - 1 - x)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(wrap: Wrap, filter: ImageFilter) -> ImageMap<1> {
        let image = Image::new(2, vec![[1.0], [2.0], [3.0], [4.0]]).unwrap();
        let image = Arc::new(image);
        ImageMap {
            image,
            wrap,
            filter,
            scale: Vec2::ONE,
            offset: Vec2::ZERO,
        }
    }

    #[track_caller]
    fn check(map: &ImageMap<1>, u: f32, v: f32, expected: f32) {
        let value = map.eval(Vec2::new(u, v))[0];
        assert!(
            (value - expected).abs() < 1e-6,
            "{value} instead of {expected}"
        );
    }

    #[test]
    fn the_top_row_is_at_v_one() {
        let point = map(Wrap::Repeat, ImageFilter::Point);
        check(&point, 0.25, 0.75, 1.0);
        check(&point, 0.75, 0.75, 2.0);
        check(&point, 0.25, 0.25, 3.0);
    }

    #[test]
    fn texel_centres_keep_their_value_and_the_middle_is_the_mean() {
        let bilinear = map(Wrap::Repeat, ImageFilter::Bilinear);
        check(&bilinear, 0.25, 0.75, 1.0);
        check(&bilinear, 0.5, 0.5, 2.5);
    }

    #[test]
    fn borders_wrap_as_asked() {
        check(&map(Wrap::Repeat, ImageFilter::Point), -0.75, 1.75, 1.0);
        check(&map(Wrap::Mirror, ImageFilter::Point), -0.25, 0.75, 1.0);
        check(&map(Wrap::Mirror, ImageFilter::Point), 1.25, 1.25, 2.0);
        check(&map(Wrap::Mirror, ImageFilter::Point), 2.25, 0.75, 1.0);
        check(&map(Wrap::Clamp, ImageFilter::Point), 7.0, -3.0, 4.0);
        check(&map(Wrap::Black, ImageFilter::Point), 1.25, 0.5, 0.0);
        check(&map(Wrap::Black, ImageFilter::Bilinear), 0.0, 0.75, 0.5);
    }

    #[test]
    fn ragged_and_empty_images_are_refused() {
        assert!(Image::<1>::new(2, vec![[0.0]; 3]).is_none());
        assert!(Image::<1>::new(0, vec![]).is_none());
    }
}
