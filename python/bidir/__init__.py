"""bidir: physically based rendering by bidirectional path tracing with chosen shadow rays.

::

    import bidir

    scene = bidir.load("scenes/cornell.pbrt", size=(256, 256))
    image = bidir.render(scene, bidir.Bdpt(shadow_rays="per-pair"), spp=16)
    image.save("cornell.png")
    image.pixels  # linear Rec. 709, float32, (256, 256, 3)

The same scene, settings and seed give the same bits as ``bidir render``, whatever the number of
threads; films of either can be merged with those of the other.
"""

from bidir import _bidir
from bidir.build import SceneBuilder
from bidir.errors import (
    BidirError,
    DataError,
    ExperimentError,
    FileError,
    FilmError,
    LayerError,
    MissingFileError,
    RenderError,
    RenderInterruptedError,
    SceneError,
    SceneWarning,
    SettingsError,
    UnsupportedError,
)
from bidir.experiment import Experiment, Results
from bidir.film import Film
from bidir.image import Image, png, read_image, read_layers, write_image
from bidir.metrics import (
    METRICS,
    compare,
    error_map,
    flip,
    flip_hdr,
    identical,
    mape,
    metric,
    mse,
    relmse,
    rmse,
)
from bidir.scene import Scene, from_text, load
from bidir.session import LAYERS, Session, render
from bidir.settings import (
    All,
    Auto,
    Bdpt,
    Budget,
    Integrator,
    Light,
    Lvc,
    Path,
    PerCameraVertex,
    PerLightVertex,
    PerPair,
    RayRoulette,
    Selector,
)

ESTIMATOR_VERSION: int = _bidir.ESTIMATOR_VERSION
"""The version of the estimators; films of different versions cannot be merged."""
__version__: str = _bidir.VERSION

__all__ = [
    "ESTIMATOR_VERSION",
    "LAYERS",
    "METRICS",
    "All",
    "Auto",
    "Bdpt",
    "BidirError",
    "Budget",
    "DataError",
    "Experiment",
    "ExperimentError",
    "FileError",
    "Film",
    "FilmError",
    "Image",
    "Integrator",
    "LayerError",
    "Light",
    "Lvc",
    "MissingFileError",
    "Path",
    "PerCameraVertex",
    "PerLightVertex",
    "PerPair",
    "RayRoulette",
    "RenderError",
    "RenderInterruptedError",
    "Results",
    "Scene",
    "SceneBuilder",
    "SceneError",
    "SceneWarning",
    "Selector",
    "Session",
    "SettingsError",
    "UnsupportedError",
    "__version__",
    "compare",
    "error_map",
    "flip",
    "flip_hdr",
    "from_text",
    "identical",
    "load",
    "mape",
    "metric",
    "mse",
    "png",
    "read_image",
    "read_layers",
    "relmse",
    "render",
    "rmse",
    "write_image",
]
