"""Renders and experiments on more than one machine, by Ray; ``pip install 'bidir[ray]'``.

:func:`render` splits a render by ranges of passes over the nodes of a cluster, and gives the bits that
one machine would give. docs/guide/ray.md has the setup with KubeRay and Slurm.
"""

try:
    import ray as _ray  # noqa: F401
except ImportError as error:
    raise ImportError("bidir.ray needs Ray, which is not installed: pip install 'bidir[ray]'") from error

from bidir.ray._crew import ClusterError, Limits, NodeRefusedError, TaskFailedError
from bidir.ray._experiment import experiment
from bidir.ray._render import render

__all__ = ["ClusterError", "Limits", "NodeRefusedError", "TaskFailedError", "experiment", "render"]
