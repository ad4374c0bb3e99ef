"""Scenes for all parts, as text."""

BOX = """LookAt 0 1 -3.7 0 1 0 0 1 0
Camera "perspective" "float fov" 45
Film "rgb" "integer xresolution" 24 "integer yresolution" 16
WorldBegin
%s
"""
LAMP = """AttributeBegin
AreaLightSource "diffuse" "rgb L" [10 10 10]
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3]
  "point3 P" [-0.3 1.9 0.7 0.3 1.9 0.7 0.3 1.9 1.3 -0.3 1.9 1.3]
AttributeEnd
"""
# Floor, back, ceiling and both sides of a room of two units whose front is open.
WALLS = """Material "diffuse" "rgb reflectance" [0.7 0.7 0.7]
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point3 P" [-1 0 0 -1 0 2 1 0 2 1 0 0]
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point3 P" [-1 0 2 -1 2 2 1 2 2 1 0 2]
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point3 P" [-1 2 0 1 2 0 1 2 2 -1 2 2]
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point3 P" [-1 0 0 -1 2 0 -1 2 2 -1 0 2]
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point3 P" [1 0 0 1 0 2 1 2 2 1 2 0]
"""
BALL = """AttributeBegin
Translate 0.3 0.4 1.2
Material "dielectric" "float eta" 1.5
Shape "sphere" "float radius" 0.4
AttributeEnd
"""
# A room with a lamp and a ball of glass: every strategy has light to bring.
ROOM = BOX % (LAMP + WALLS + BALL)
INTEGRATORS = ("path", "light", "bdpt", "lvc", "auto")
