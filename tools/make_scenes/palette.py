"""The named materials. Reflectances are linear sRGB."""


def _diffuse(r, g, b):
    return '"string type" "diffuse" "rgb reflectance" [%g %g %g]' % (r, g, b)


def _metal(reflectance, roughness):
    return ('"string type" "conductor" "rgb reflectance" [%g %g %g] "float roughness" %g'
            % (*reflectance, roughness))


MATERIALS = {
    # the building
    "wall": _diffuse(0.73, 0.70, 0.64),
    "wall-sage": _diffuse(0.50, 0.58, 0.46),
    "wall-blue": _diffuse(0.42, 0.53, 0.63),
    "wall-blush": _diffuse(0.70, 0.52, 0.44),
    "wall-sand": _diffuse(0.72, 0.61, 0.42),
    "ceiling": _diffuse(0.78, 0.78, 0.76),
    "floor": _diffuse(0.47, 0.32, 0.20),
    "floor-tile": _diffuse(0.55, 0.53, 0.50),
    "trim": _diffuse(0.76, 0.75, 0.71),
    "night": _diffuse(0.06, 0.09, 0.16),
    # furniture
    "wood": _diffuse(0.42, 0.25, 0.13),
    "wood-dark": _diffuse(0.20, 0.11, 0.06),
    "wood-pale": _diffuse(0.62, 0.46, 0.28),
    "white": _diffuse(0.74, 0.74, 0.72),
    "black": _diffuse(0.04, 0.04, 0.045),
    "grey": _diffuse(0.35, 0.36, 0.37),
    "fabric-teal": _diffuse(0.10, 0.33, 0.35),
    "fabric-rust": _diffuse(0.60, 0.22, 0.10),
    "fabric-cream": _diffuse(0.72, 0.64, 0.50),
    "fabric-blue": _diffuse(0.17, 0.24, 0.47),
    "fabric-mustard": _diffuse(0.68, 0.46, 0.10),
    "linen": _diffuse(0.70, 0.62, 0.52),
    "rug-dark": _diffuse(0.33, 0.09, 0.08),
    "rug-field": _diffuse(0.58, 0.36, 0.26),
    "rug-pale": _diffuse(0.70, 0.58, 0.42),
    "leaf": _diffuse(0.13, 0.36, 0.10),
    "soil": _diffuse(0.09, 0.06, 0.04),
    "clay": _diffuse(0.60, 0.29, 0.17),
    "glaze": _diffuse(0.20, 0.38, 0.55),
    "brass-paint": _diffuse(0.48, 0.36, 0.16),
    "book-red": _diffuse(0.52, 0.10, 0.08),
    "book-green": _diffuse(0.12, 0.30, 0.16),
    "book-blue": _diffuse(0.11, 0.19, 0.42),
    "book-ochre": _diffuse(0.65, 0.45, 0.14),
    "book-cream": _diffuse(0.73, 0.66, 0.52),
    "book-plum": _diffuse(0.30, 0.12, 0.25),
    "fruit-orange": _diffuse(0.78, 0.33, 0.05),
    "fruit-green": _diffuse(0.42, 0.55, 0.10),
    "fruit-red": _diffuse(0.62, 0.08, 0.06),
    "paper": _diffuse(0.78, 0.76, 0.70),
    # small accents only
    "metal-bowl": _metal((0.90, 0.88, 0.84), 0.05),
    "metal-brass": _metal((0.88, 0.70, 0.38), 0.1),
    "glass": '"string type" "dielectric" "float eta" 1.5',
}
