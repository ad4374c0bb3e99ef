//! The words of the format in this version and in older ones.

use super::lexer::shorten;
use super::v3;
use crate::source::{Fault, Span};
use unicode_normalization::UnicodeNormalization;

/// Returns a name in Unicode's normal form C, in which names are compared.
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

/// All directives.
pub(super) const DIRECTIVES: &[(&str, Block)] = &[
    ("Accelerator", Block::Options),
    ("ActiveTransform", Block::Anywhere),
    ("AreaLightSource", Block::World),
    ("Attribute", Block::Anywhere),
    ("AttributeBegin", Block::World),
    ("AttributeEnd", Block::World),
    ("Camera", Block::Options),
    ("ColorSpace", Block::Anywhere),
    ("ConcatTransform", Block::Anywhere),
    ("CoordSysTransform", Block::Anywhere),
    ("CoordinateSystem", Block::Anywhere),
    ("Film", Block::Options),
    ("Identity", Block::Anywhere),
    ("Import", Block::World),
    ("Include", Block::Anywhere),
    ("Integrator", Block::Options),
    ("LightSource", Block::World),
    ("LookAt", Block::Anywhere),
    ("MakeNamedMaterial", Block::World),
    ("MakeNamedMedium", Block::Anywhere),
    ("Material", Block::World),
    ("MediumInterface", Block::Anywhere),
    ("NamedMaterial", Block::World),
    ("ObjectBegin", Block::World),
    ("ObjectEnd", Block::World),
    ("ObjectInstance", Block::World),
    ("Option", Block::Anywhere),
    ("PixelFilter", Block::Options),
    ("ReverseOrientation", Block::World),
    ("Rotate", Block::Anywhere),
    ("Sampler", Block::Options),
    ("Scale", Block::Anywhere),
    ("Shape", Block::World),
    ("Texture", Block::World),
    ("Transform", Block::Anywhere),
    ("TransformBegin", Block::World),
    ("TransformEnd", Block::World),
    ("TransformTimes", Block::Options),
    ("Translate", Block::Anywhere),
    ("WorldBegin", Block::Options),
];

/// Returns true for a word that begins a directive of this version or an older one.
pub(crate) fn is_directive(word: &str) -> bool {
    DIRECTIVES.iter().any(|(name, _)| *name == word) || v3::directive(word).is_some()
}

/// The type words of a directive.
pub(super) struct Names {
    /// The kind of thing that they name.
    what: &'static str,
    known: &'static [&'static str],
    /// The words of version 3, each with its replacement.
    old: &'static [(&'static str, &'static str)],
}

impl Names {
    /// Refuses words that the format does not have.
    pub(super) fn check(&self, name: &str, span: Span) -> Result<(), Fault> {
        if self.known.contains(&name) {
            return Ok(());
        }
        let what = self.what;
        if let Some((_, hint)) = self.old.iter().find(|(old, _)| *old == name) {
            return Err(v3::fault(span, &format!("the {what} `{name}`"), hint));
        }
        let fault = Fault::scene(span, format!("unknown {what} `{}`", shorten(name)));
        Err(fault.with_nearest(name, self.known.iter().copied()))
    }
}

pub(super) const CAMERAS: Names = Names {
    what: "camera",
    known: &["perspective", "orthographic", "spherical", "realistic"],
    old: &[(
        "environment",
        "write `spherical` with `\"string mapping\" \"equirectangular\"`",
    )],
};

pub(super) const FILMS: Names = Names {
    what: "film",
    known: &["rgb", "gbuffer", "spectral"],
    old: &[("image", "write `rgb`, and `iso` = 100·scale for `scale`")],
};

pub(super) const SENSORS: Names = Names {
    what: "sensor",
    known: &[
        "cie1931",
        "canon_eos_100d",
        "canon_eos_1dx_mkii",
        "canon_eos_200d",
        "canon_eos_200d_mkii",
        "canon_eos_5d",
        "canon_eos_5d_mkii",
        "canon_eos_5d_mkiii",
        "canon_eos_5d_mkiv",
        "canon_eos_5ds",
        "canon_eos_m",
        "hasselblad_l1d_20c",
        "nikon_d810",
        "nikon_d850",
        "sony_ilce_6400",
        "sony_ilce_7m3",
        "sony_ilce_7rm3",
        "sony_ilce_9",
    ],
    old: &[],
};

pub(super) const FILTERS: Names = Names {
    what: "pixel filter",
    known: &["box", "gaussian", "mitchell", "sinc", "triangle"],
    old: &[],
};

pub(super) const SAMPLERS: Names = Names {
    what: "sampler",
    known: &[
        "zsobol",
        "paddedsobol",
        "sobol",
        "halton",
        "pmj02bn",
        "independent",
        "stratified",
    ],
    old: &[
        ("lowdiscrepancy", "write `paddedsobol`"),
        ("02sequence", "write `paddedsobol`"),
        ("maxmindist", "write `pmj02bn`"),
        ("random", "write `independent`"),
    ],
};

pub(super) const INTEGRATORS: Names = Names {
    what: "integrator",
    known: &[
        "volpath",
        "path",
        "simplepath",
        "simplevolpath",
        "randomwalk",
        "lightpath",
        "bdpt",
        "mlt",
        "sppm",
        "ambientocclusion",
        "function",
    ],
    old: &[
        ("directlighting", "write `path` with `maxdepth` 1"),
        ("whitted", "write `path`"),
        ("ao", "write `ambientocclusion`"),
    ],
};

pub(super) const ACCELERATORS: Names = Names {
    what: "accelerator",
    known: &["bvh", "kdtree"],
    old: &[("grid", "write `bvh`")],
};

pub(super) const SHAPES: Names = Names {
    what: "shape",
    known: &[
        "sphere",
        "disk",
        "cylinder",
        "trianglemesh",
        "bilinearmesh",
        "plymesh",
        "loopsubdiv",
        "curve",
    ],
    old: &[
        ("cone", "make it a mesh"),
        ("paraboloid", "make it a mesh"),
        ("hyperboloid", "make it a mesh"),
        ("heightfield", "make it a mesh"),
        ("heightfield2", "make it a mesh"),
        ("nurbs", "make it a mesh"),
    ],
};

pub(super) const MATERIALS: Names = Names {
    what: "material",
    known: &[
        "diffuse",
        "diffusetransmission",
        "dielectric",
        "thindielectric",
        "conductor",
        "coateddiffuse",
        "coatedconductor",
        "subsurface",
        "hair",
        "measured",
        "mix",
        "interface",
        "none",
        "",
    ],
    old: &[
        ("matte", "write `diffuse`, and `reflectance` for `Kd`"),
        (
            "plastic",
            "write `coateddiffuse`, and `reflectance` for `Kd`",
        ),
        (
            "substrate",
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
        ("metal", "write `conductor`"),
        ("translucent", "write `diffusetransmission`"),
        ("disney", "write `coateddiffuse` or `diffuse`"),
        ("fourier", "write `measured`"),
        ("kdsubsurface", "write `subsurface` with `reflectance`"),
        ("shinymetal", "write `conductor`"),
    ],
};

pub(super) const TEXTURES: Names = Names {
    what: "texture class",
    known: &[
        "constant",
        "scale",
        "mix",
        "directionmix",
        "bilerp",
        "checkerboard",
        "dots",
        "imagemap",
        "ptex",
        "fbm",
        "wrinkled",
        "windy",
        "marble",
    ],
    old: &[("uv", "use an `imagemap`")],
};

pub(super) const TEXTURE_KINDS: Names = Names {
    what: "texture type",
    known: &["float", "spectrum"],
    old: &[("color", "write `spectrum`")],
};

pub(super) const LIGHTS: Names = Names {
    what: "light source",
    known: &[
        "point",
        "spot",
        "distant",
        "goniometric",
        "projection",
        "infinite",
    ],
    old: &[],
};

pub(super) const AREA_LIGHTS: Names = Names {
    what: "area light source",
    known: &["diffuse"],
    old: &[("area", "write `diffuse`")],
};

pub(super) const MEDIA: Names = Names {
    what: "medium",
    known: &["homogeneous", "uniformgrid", "rgbgrid", "cloud", "nanovdb"],
    old: &[("heterogeneous", "write `uniformgrid`")],
};

/// The names of options, normalised.
pub(super) const OPTIONS: Names = Names {
    what: "option",
    known: &[
        "disablepixeljitter",
        "disablewavelengthjitter",
        "disabletexturefiltering",
        "forcediffuse",
        "pixelstats",
        "wavefront",
        "displacementedgescale",
        "seed",
        "msereferenceimage",
        "msereferenceout",
        "rendercoordsys",
    ],
    old: &[],
};
