"""The list of mutants: one deliberate fault each, and the test that must notice it.

An entry is (name, file, old text, new text, test). The old text occurs exactly once in the file.
"""

from .diffuse import DIFFUSE_ENDS
from .ends import ENDS
from .materials import MATERIALS
from .media import MEDIA
from .normals import NORMALS
from .paths import PATHS
from .principled import PRINCIPLED

MUTATIONS = PATHS + DIFFUSE_ENDS + ENDS + MATERIALS + NORMALS + MEDIA + PRINCIPLED
