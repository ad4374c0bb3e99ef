"""Writes scenes/README.md from what was generated."""

_HEAD = """# The project's own scenes

pbrt-v4 text with meshes in `meshes/` (binary PLY); lengths in metres, y up. All files here,
this one included, are written by a script without dependencies:

    python3 tools/make_scenes

Running it again gives the same files byte for byte. `--out FOLDER` writes elsewhere. Change the
script, not the files.

The files in `parts/` are included by the others and are no scenes by themselves. In the closed
rooms no light can leave: walls, floors and ceilings are one surface without gaps. Light values are
chosen for viewing without tone mapping.

## Main scenes

| Scene | Triangles | What it shows |
|---|---|---|
"""

_MAIN_NOTES = {
    "room-direct.pbrt": "The easy case of the 1995 paper: a ceiling panel that most points see.",
    "room-indirect.pbrt": "The hard case: the emitter is deep in an opaque bowl, about 95 % of"
                          " the picture has no direct light, most shadow rays are blocked.",
    "apartment.pbrt": "Many light subpaths start where they cannot matter to the pixel.",
    "apartment-dark.pbrt": "Strongly indirect: light arrives through two doorways.",
    "cornell.pbrt": "A quick look at direct light, soft shadows and colour bleeding.",
}

_TORTURE = """
## torture/: small films for tests that compare estimators

Each comparison is between strategies, selections or integrators on one scene; the comment at the
head of each file says what it is after.

| Scene | Triangles | What it is |
|---|---|---|
"""

_BROKEN = """
## broken/: must be refused with a clear message

| File | What is wrong |
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
            text += "| `%s` | %d | %s |\n" % (path[8:], triangles, title)
    text += _BROKEN
    for path, what in project.broken:
        text += "| `%s` | %s |\n" % (path[7:], what.replace("Broken: ", "", 1))
    project.write("README.md", text)
