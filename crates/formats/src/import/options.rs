//! The options of a reader.

use crate::error::ErrorKind;

use crate::limits::{self, LARGEST_SIDE};
use crate::source::Fault;
use bidir::film::PixelRect;

/// The options of the caller, which have priority over the file.
#[derive(Clone, Copy, Debug, Default)]
pub struct LoadOptions {
    /// True to replace unsupported features by substitutes.
    pub lenient: bool,
    /// Width and height of the film, instead of the file's. Unit: pixels.
    pub resolution: Option<[u32; 2]>,
    /// The part of the film that is rendered, instead of the file's. Errors: of kind
    /// [`ErrorKind::Options`], if the film has no such pixels.
    pub crop: Option<Crop>,
    /// The instruction set of the intersector. None: the fastest that the machine has.
    pub isa: Option<bidir::scene::Isa>,
    /// Maximum number of primitives of the scene, and of vertices of its meshes; shared objects count
    /// once. None: 2²², and 16 more for every byte of the scene's files, but at most 2²⁸.
    pub most_primitives: Option<u64>,
}

impl LoadOptions {
    /// Returns the maximum number of primitives, and of vertices, of a scene whose files take `stored` bytes.
    pub(super) fn most_primitives(&self, stored: u64) -> u64 {
        let allowed = limits::PRIMITIVES.of(stored).min(limits::MOST_PRIMITIVES);
        self.most_primitives.unwrap_or(allowed)
    }

    /// Returns width and height of the film: those of the options, else the file's `own`. Errors: beyond the limit.
    pub(crate) fn resolution<P>(&self, own: [u32; 2], place: P) -> Result<[u32; 2], Fault<P>> {
        let [width, height] = self.resolution.unwrap_or(own);
        let sides = 1..=LARGEST_SIDE;
        if sides.contains(&width) && sides.contains(&height) {
            return Ok([width, height]);
        }
        let message = format!(
            "the film has {width} × {height} pixels; each side can have 1 to {LARGEST_SIDE}"
        );
        Err(Fault::new(ErrorKind::Limit, place, message))
    }

    /// Returns the pixels to render: those of the options, else those that the file describes, else all.
    /// Errors: there are none.
    pub(crate) fn crop<P>(
        &self,
        described: Option<Crop>,
        resolution: [u32; 2],
        place: P,
    ) -> Result<PixelRect, Fault<P>> {
        let wanted = self.crop.or(described).unwrap_or(Crop::WHOLE);
        let crop = wanted.pixels(resolution);
        if crop.area() > 0 {
            return Ok(crop);
        }
        if self.crop.is_none() {
            return Err(Fault::scene(place, "the crop leaves no pixels of the film"));
        }
        let [width, height] = resolution;
        let message = format!("the crop lies outside the film of {width} × {height} pixels");
        Err(Fault::new(ErrorKind::Options, place, message))
    }
}

/// The part of a film that is rendered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Crop {
    /// Left, right, top and bottom as fractions of the film.
    Fractions([f32; 4]),
    /// Left, right (exclusive), top and bottom (exclusive). Unit: pixels.
    Pixels([u32; 4]),
}

impl Crop {
    const WHOLE: Self = Self::Fractions([0.0, 1.0, 0.0, 1.0]);

    fn pixels(self, [width, height]: [u32; 2]) -> PixelRect {
        let [left, right, top, bottom] = match self {
            Self::Pixels(bounds) => bounds,
            Self::Fractions([x0, x1, y0, y1]) => {
                let [x0, x1] = [x0, x1].map(|x| (x * width as f32).ceil() as u32);
                let [y0, y1] = [y0, y1].map(|y| (y * height as f32).ceil() as u32);
                [x0, x1, y0, y1]
            }
        };
        PixelRect {
            min: [left, top],
            max: [right.min(width), bottom.min(height)],
        }
    }
}
