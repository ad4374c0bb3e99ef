"""Five scenes that must be refused with a clear message."""

_HEADER = """LookAt 0 1 -3  0 0.5 0  0 1 0
Camera "perspective" "float fov" 40
Film "rgb" "integer xresolution" %d "integer yresolution" %d
  "string filename" "%s.exr"
Sampler "independent" "integer pixelsamples" 4
Integrator "bdpt" "integer maxdepth" 3

WorldBegin
LightSource "point" "rgb I" [5 5 5] "point3 from" [0 2 -1]
"""
_MATERIAL = 'Material "diffuse" "rgb reflectance" [0.5 0.5 0.5]\n'
_FLOOR = """Shape "trianglemesh" "integer indices" [0 1 2 0 2 3]
  "point3 P" [-1 0 -1 -1 0 1 1 0 1 1 0 -1]
"""
_NAN_PLY = """ply
format ascii 1.0
comment the third vertex is not a number
element vertex 4
property float x
property float y
property float z
element face 2
property list uchar int vertex_indices
end_header
-1 0 -1
-1 0 1
nan 0 1
1 0 -1
3 0 1 2
3 0 2 3
"""

_CASES = (
    ("missing-mesh", "Broken: the PLY file it names does not exist.",
     _MATERIAL + 'Shape "plymesh" "string filename" "no-such-mesh.ply"\n'),
    ("misspelt-material", 'Broken: the material "difuse" does not exist (it means "diffuse").',
     'Material "difuse" "rgb reflectance" [0.5 0.5 0.5]\n' + _FLOOR),
    ("unclosed-string", 'Broken: the quote after "diffuse is missing (line 12).',
     'Material "diffuse "rgb reflectance" [0.5 0.5 0.5]\n' + _FLOOR),
    ("nan-vertex", "Broken: a vertex of nan-vertex.ply has x = nan.",
     _MATERIAL + 'Shape "plymesh" "string filename" "nan-vertex.ply"\n'),
    ("huge-film", "Broken: a film of 10^12 pixels, more than any memory holds.",
     _MATERIAL + _FLOOR),
)


def write_all(project):
    for name, what, world in _CASES:
        size = 1000000 if name == "huge-film" else 32
        text = "# %s\n\n%s%s" % (what, _HEADER % (size, size, name), world)
        project.write("broken/%s.pbrt" % name, text)
        project.broken.append(("broken/%s.pbrt" % name, what))
    project.write("broken/nan-vertex.ply", _NAN_PLY)
