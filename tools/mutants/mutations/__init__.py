"""The list of mutants: one deliberate fault each, and the test that must notice it.

An entry is (name, file, old text, new text, test). The old text occurs exactly once in the file.
"""

from .diffuse import DIFFUSE_ENDS
from .laboratory import LABORATORY
from .materials import MATERIALS
from .media import MEDIA
from .normals import NORMALS
from .paths import PATHS
from .pictures import PICTURES
from .principled import PRINCIPLED
from .scenes import SCENES
from .textures import TEXTURES
from .training import TRAINING
from .views import VIEWS

MUTATIONS = (PATHS + DIFFUSE_ENDS + TRAINING + PICTURES + SCENES + MATERIALS + NORMALS + MEDIA
             + PRINCIPLED + TEXTURES + VIEWS + LABORATORY)
