"""Writes scenes/README.md from the generated scenes."""

_HEAD = """# The project's own scenes

`tools/make_scenes` writes all files here, this one included.
It is deterministic and needs Python alone:

    python3 tools/make_scenes

`--out FOLDER` writes elsewhere.
To change a scene, change the script.

Scenes are pbrt-v4 text with binary PLY meshes in `meshes/`; files in `parts/` are included by others.
Lengths are in metres, and y is up.
The closed rooms have no gaps for light to leave by.
Light values are chosen for viewing without tone mapping.

## Main scenes

| Scene | Triangles | Content |
|---|---|---|
"""

_MAIN_NOTES = {
    "room-direct.pbrt": "The easy case of the 1995 paper: most points see the ceiling light.",
    "room-indirect.pbrt": "The hard case: the emitter is deep in an opaque bowl, about 95 % of the image has no"
                          " direct light, and most shadow rays are blocked.",
    "apartment.pbrt": "Many light subpaths start where they cannot matter to a given pixel.",
    "apartment-dark.pbrt": "Strongly indirect: light arrives through two doorways.",
    "cornell.pbrt": "A quick test of direct light, soft shadows and colour bleeding.",
    "fog.pbrt": "A caustic in fog, behind the ball: no camera walk finds it.",
    "cloud.pbrt": "Noise in a grid of cells, bounded by an ellipsoid: light that scatters many times.",
    "liquids.pbrt": "Media within smooth glass: light that is absorbed, and light that scatters many times.",
    "candles.pbrt": "Flames that glow by their temperature, as light of wax, wall and a caustic.",
}

_TORTURE = """
## torture/: small films for tests that compare estimators

Each comparison takes strategies, selectors or integrators on one scene.
The comment at the head of a file states its purpose.

| Scene | Triangles | Content |
|---|---|---|
"""

# Clearer titles than those in the files, whose bytes must not change.
_TORTURE_NOTES = {
    "shading-normal.pbrt": "Shading normals that differ from the geometric ones.",
    "mirror.pbrt": "Mirroring transforms; one-sided and two-sided lights.",
    "filter-gaussian.pbrt": "Gaussian filter on bright edges against black.",
    "filter-mitchell.pbrt": "Mitchell filter on bright edges against black.",
    "filter-sinc.pbrt": "Sinc filter on bright edges against black.",
    "filter-triangle.pbrt": "Triangle filter on bright edges against black.",
    "lights.pbrt": "Point, spot, distant and infinite lights together.",
    "parallel.pbrt": "Orthographic camera outdoors under a sky.",
    "around-longitude.pbrt": "Spherical camera, equirectangular mapping.",
    "around-octahedron.pbrt": "Spherical camera, equal-area mapping.",
    "picture-lamp.pbrt": "Area lights that emit an image.",
    "sky-alone.pbrt": "An environment map as the only light.",
    "within-glass.pbrt": "A camera inside a glass ball.",
    "bulb.pbrt": "A lamp inside glass, seen in a mirror.",
    "narrow-spot.pbrt": "A spot light three degrees wide.",
    "shapes.pbrt": "Parts of cylinders, disks and spheres; patches and subdivision.",
    "leaves.pbrt": "Instances of leaves, cut out of squares by alpha.",
    "empty.pbrt": "No shapes and no lights.",
    "empty-sky.pbrt": "A sky and no shapes.",
}

_BROKEN = """
## broken/: scenes that must be refused with a clear message

| File | Fault |
|---|---|
"""


def write(project):
    text = _HEAD
    main = [s for s in project.scenes if "/" not in s[0]]
    for path, triangles, title in main:
        text += "| `%s` | %d | %s %s |\n" % (path, triangles, title, _MAIN_NOTES[path])
    text += _TORTURE
    for path, triangles, title in project.scenes:
        if path.startswith("torture/"):
            name = path[8:]
            text += "| `%s` | %d | %s |\n" % (name, triangles, _TORTURE_NOTES.get(name, title))
    text += _BROKEN
    for path, what in project.broken:
        text += "| `%s` | %s |\n" % (path[7:], what.replace("Broken: ", "", 1))
    project.write("README.md", text)
