//! The words of the format in this version and in older ones.

use super::lexer::shorten;
use super::v3;
use crate::source::{Fault, Span};
use unicode_normalization::UnicodeNormalization;

/// Returns a name in Unicode's normalization form C, which makes equal names comparable.
pub(super) fn normalized(name: &str) -> String {
    if name.is_ascii() {
        name.into()
    } else {
        name.nfc().collect()
    }
}

/// The block in which a directive may stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Block {
    /// Before `WorldBegin`.
    Options,
    /// After `WorldBegin`.
    World,
    Anywhere,
}

/// All directives by their block.
const DIRECTIVES: [(Block, &str); 3] = [
    (
        Block::Options,
        "Accelerator Camera Film Integrator PixelFilter Sampler TransformTimes WorldBegin",
    ),
    (
        Block::World,
        "AreaLightSource AttributeBegin AttributeEnd Import LightSource MakeNamedMaterial Material \
         NamedMaterial ObjectBegin ObjectEnd ObjectInstance ReverseOrientation Shape Texture TransformBegin \
         TransformEnd",
    ),
    (
        Block::Anywhere,
        "ActiveTransform Attribute ColorSpace ConcatTransform CoordSysTransform CoordinateSystem Identity \
         Include LookAt MakeNamedMedium MediumInterface Option Rotate Scale Transform Translate",
    ),
];

/// Returns all directives with their blocks.
pub(super) fn directives() -> impl Iterator<Item = (&'static str, Block)> {
    let of_block =
        |(block, names): (Block, &'static str)| names.split(' ').map(move |name| (name, block));
    DIRECTIVES.into_iter().flat_map(of_block)
}

/// Returns true for a word that begins a directive of this version or an older one.
pub(crate) fn is_directive(word: &str) -> bool {
    directives().any(|(name, _)| name == word) || v3::directive(word).is_some()
}

/// The type words of a directive.
pub(super) struct Names {
    /// The kind of thing that the words name, for messages.
    what: &'static str,
    /// The words, separated by spaces. A space at the end stands for an empty word.
    known: &'static str,
    /// Words of version 3, separated by spaces, with their replacement.
    old: &'static [(&'static str, &'static str)],
}

const fn names(
    what: &'static str,
    known: &'static str,
    old: &'static [(&'static str, &'static str)],
) -> Names {
    Names { what, known, old }
}

impl Names {
    /// Refuses words that the format does not have.
    pub(super) fn check(&self, name: &str, span: Span) -> Result<(), Fault> {
        if self.known.split(' ').any(|known| known == name) {
            return Ok(());
        }
        let what = self.what;
        if let Some((_, hint)) = self
            .old
            .iter()
            .find(|(old, _)| old.split(' ').any(|old| old == name))
        {
            return Err(v3::fault(span, &format!("the {what} `{name}`"), hint));
        }
        Err(unknown(span, what, name, self.known.split(' ')))
    }
}

/// Returns the fault of a name that is none of `known`.
pub(super) fn unknown<'a>(
    span: Span,
    what: &str,
    name: &str,
    known: impl IntoIterator<Item = &'a str>,
) -> Fault {
    let fault = Fault::scene(span, format!("unknown {what} `{}`", shorten(name)));
    fault.with_nearest(name, known)
}

pub(super) const CAMERAS: Names = names(
    "camera",
    "perspective orthographic spherical realistic",
    &[(
        "environment",
        "write `spherical` with `\"string mapping\" \"equirectangular\"`",
    )],
);

pub(super) const FILMS: Names = names(
    "film",
    "rgb gbuffer spectral",
    &[("image", "write `rgb`, and `iso` = 100·scale for `scale`")],
);

pub(super) const SENSORS: Names = names(
    "sensor",
    "cie1931 canon_eos_100d canon_eos_1dx_mkii canon_eos_200d canon_eos_200d_mkii canon_eos_5d \
        canon_eos_5d_mkii canon_eos_5d_mkiii canon_eos_5d_mkiv canon_eos_5ds canon_eos_m hasselblad_l1d_20c \
        nikon_d810 nikon_d850 sony_ilce_6400 sony_ilce_7m3 sony_ilce_7rm3 sony_ilce_9",
    &[],
);

pub(super) const FILTERS: Names = names("pixel filter", "box gaussian mitchell sinc triangle", &[]);

pub(super) const SAMPLERS: Names = names(
    "sampler",
    "zsobol paddedsobol sobol halton pmj02bn independent stratified",
    &[
        ("lowdiscrepancy 02sequence", "write `paddedsobol`"),
        ("maxmindist", "write `pmj02bn`"),
        ("random", "write `independent`"),
    ],
);

pub(super) const INTEGRATORS: Names = names(
    "integrator",
    "volpath path simplepath simplevolpath randomwalk lightpath bdpt mlt sppm ambientocclusion function",
    &[
        ("directlighting", "write `path` with `maxdepth` 1"),
        ("whitted", "write `path`"),
        ("ao", "write `ambientocclusion`"),
    ],
);

pub(super) const ACCELERATORS: Names =
    names("accelerator", "bvh kdtree", &[("grid", "write `bvh`")]);

pub(super) const SHAPES: Names = names(
    "shape",
    "sphere disk cylinder trianglemesh bilinearmesh plymesh loopsubdiv curve",
    &[(
        "cone paraboloid hyperboloid heightfield heightfield2 nurbs",
        "make it a mesh",
    )],
);

pub(super) const MATERIALS: Names = names(
    "material",
    "diffuse diffusetransmission dielectric thindielectric conductor coateddiffuse coatedconductor \
        subsurface hair measured mix interface none ",
    &[
        ("matte", "write `diffuse`, and `reflectance` for `Kd`"),
        (
            "plastic substrate",
            "write `coateddiffuse`, and `reflectance` for `Kd`",
        ),
        (
            "uber",
            "write `coateddiffuse` or `diffuse`, and `alpha` of the shape for `opacity`",
        ),
        ("glass", "write `dielectric`, and `eta` for `index`"),
        (
            "mirror",
            "write `conductor` with `metal-Ag-eta`, `metal-Ag-k` and no roughness",
        ),
        ("metal shinymetal", "write `conductor`"),
        ("translucent", "write `diffusetransmission`"),
        ("disney", "write `coateddiffuse` or `diffuse`"),
        ("fourier", "write `measured`"),
        ("kdsubsurface", "write `subsurface` with `reflectance`"),
    ],
);

pub(super) const TEXTURES: Names = names(
    "texture class",
    "constant scale mix directionmix bilerp checkerboard dots imagemap ptex fbm wrinkled windy marble",
    &[("uv", "use an `imagemap`")],
);

pub(super) const TEXTURE_KINDS: Names = names(
    "texture type",
    "float spectrum",
    &[("color", "write `spectrum`")],
);

pub(super) const LIGHTS: Names = names(
    "light source",
    "point spot distant goniometric projection infinite",
    &[],
);

pub(super) const AREA_LIGHTS: Names = names(
    "area light source",
    "diffuse",
    &[("area", "write `diffuse`")],
);

pub(super) const MEDIA: Names = names(
    "medium",
    "homogeneous uniformgrid rgbgrid cloud nanovdb",
    &[("heterogeneous", "write `uniformgrid`")],
);

/// The names of options, normalised.
pub(super) const OPTIONS: Names = names(
    "option",
    "disablepixeljitter disablewavelengthjitter disabletexturefiltering forcediffuse pixelstats wavefront \
        displacementedgescale seed msereferenceimage msereferenceout rendercoordsys",
    &[],
);
