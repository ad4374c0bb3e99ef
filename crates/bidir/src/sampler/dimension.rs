//! Dimensions of random numbers: each is a vertex and a purpose. Numbers have names instead of an order, so that code
//! may ask for them in any order, or leave some out, without an effect on others.

/// The decision that a random number makes at a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Position within the pixel's filter (vertex 0 of a camera subpath).
    Film,
    /// Position on the lens (vertex 0 of a camera subpath).
    Lens,
    /// Wavelengths of a group. They are not drawn for red, green and blue; the purpose keeps the numbers of later
    /// ones.
    Wavelengths,
    /// The light on which a light subpath starts.
    Light,
    /// The point on the light where it starts.
    LightPosition,
    /// The direction in which it leaves the light.
    LightDirection,
    /// Direction of scattering.
    Scatter,
    /// Choice of the lobe that scatters.
    Lobe,
    /// Path roulette.
    Roulette,
    /// The light to which next-event estimation connects.
    NextEventLight,
    /// The point on that light.
    NextEventPosition,
    /// The lens point that a light vertex connects to (t = 1).
    LightImageLens,
    /// The pixel, within the filter, that receives the connection (t = 1).
    LightImagePixel,
    /// The draw of shadow-ray selection; the vertex counts the groups.
    Select,
    /// The passage of a walk through surfaces with partial coverage, on its way to the vertex.
    Alpha,
    /// The choice of a material of a mixture.
    Mix,
    /// The vertices of the light cache that a camera vertex is connected with.
    CachedVertex,
    /// The vertices of long subpaths that are connected (vertex 0 of a camera subpath).
    Pairs,
    /// The lane and the optical depth by which a walk draws the distance to the vertex in media.
    Flight,
    /// The third coordinate of a light subpath's start in a medium that emits.
    LightDepth,
    /// The third coordinate of the light point of next-event estimation in a medium that emits.
    NextEventDepth,
}

/// The address of a random number, or of a pair, within a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dimension(u64);

impl Dimension {
    /// Returns the dimension of `purpose` at vertex `vertex` of a subpath.
    #[inline]
    pub const fn at(vertex: usize, purpose: Purpose) -> Self {
        Self(((vertex as u64) << 8) | purpose as u64)
    }

    /// Returns the dimension of another purpose at the same vertex.
    #[inline]
    #[must_use]
    pub const fn with_purpose(self, purpose: Purpose) -> Self {
        Self::at((self.0 >> 8) as usize, purpose)
    }

    /// Returns a well-spread key: an odd multiple, so that neighbouring dimensions differ in many bits.
    #[inline]
    pub(super) const fn key(self) -> u64 {
        self.0.wrapping_add(1).wrapping_mul(0xd1b5_4a32_d192_ed03)
    }
}
