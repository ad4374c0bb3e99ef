"""Estimators, and rules that choose shadow rays.

An estimator is a value: it can be compared, hashed, printed and changed by
:func:`dataclasses.replace`. A setting that is None stays what the scene says, or else has its default;
names and meanings are those of the flags of ``bidir render``.
"""

from __future__ import annotations

import warnings
from dataclasses import InitVar, dataclass, fields
from typing import Literal, TypeAlias

from bidir import _bidir

__all__ = [
    "All",
    "Auto",
    "Bdpt",
    "Budget",
    "Integrator",
    "Light",
    "Lvc",
    "Path",
    "PerCameraVertex",
    "PerLightVertex",
    "PerPair",
    "RayRoulette",
    "Selector",
]

Mis: TypeAlias = Literal["balance", "power", "uniform"]
LightChoice: TypeAlias = Literal["power", "tree"]
LightPoint: TypeAlias = Literal["fresh", "shared"]
Proposal: TypeAlias = Literal["uniform", "learned"]
LightStart: TypeAlias = Literal["power", "learned"]
MisCount: TypeAlias = Literal["expected", "correlated", "resampled"]


class Selector:
    """A rule that chooses which connections are traced.

    None of them changes the expectation of an image: a connection that is chosen with probability π
    counts 1/π times.
    """

    def __str__(self) -> str:
        """Return the rule as ``--shadow-rays`` takes it."""
        raise NotImplementedError


@dataclass(frozen=True)
class All(Selector):
    """Trace every connection that could carry light."""

    def __str__(self) -> str:
        """Return the rule as ``--shadow-rays`` takes it."""
        return "all"


@dataclass(frozen=True)
class PerLightVertex(Selector):
    """Trace one connection for each light vertex: optimisation 1 of Lafortune and Willems."""

    def __str__(self) -> str:
        """Return the rule as ``--shadow-rays`` takes it."""
        return "per-light-vertex"


@dataclass(frozen=True)
class PerCameraVertex(Selector):
    """Trace one connection for each camera vertex: optimisation 2 of Lafortune and Willems."""

    def __str__(self) -> str:
        """Return the rule as ``--shadow-rays`` takes it."""
        return "per-camera-vertex"


@dataclass(frozen=True)
class PerPair(Selector):
    """Trace one connection for each pair of subpaths: optimisation 3 of Lafortune and Willems."""

    def __str__(self) -> str:
        """Return the rule as ``--shadow-rays`` takes it."""
        return "per-pair"


@dataclass(frozen=True)
class RayRoulette(Selector):
    """Trace each connection by chance, where it adds less than a part of the image's mean."""

    #: The part; above 0.
    part: float = 0.1

    def __str__(self) -> str:
        """Return the rule as ``--shadow-rays`` takes it."""
        return f"ray-roulette:{self.part}"


@dataclass(frozen=True)
class Budget(Selector):
    """Trace at most so many connections for each pair of subpaths, the largest for certain."""

    #: The number of rays; from 1.
    rays: int

    def __str__(self) -> str:
        """Return the rule as ``--shadow-rays`` takes it."""
        return f"budget:{self.rays}"


@dataclass(frozen=True, kw_only=True)
class Integrator:
    """An estimator of the image with its settings."""

    #: The most bounces of a path; 0 is no limit.
    max_depth: int | None = None
    #: How subpaths end by chance: ``albedo[:START]``, ``throughput[:START]``, ``off`` or ``auto``.
    path_roulette: str | None = None
    #: The random numbers.
    sampler: Literal["independent", "sobol"] | None = None

    def __post_init__(self) -> None:
        """Check every setting.

        Errors: :class:`bidir.SettingsError` where one has a value that is not known.
        """
        _bidir.check_settings(self.flags())
        if "suited" in self.flags().values():
            _warn("suited", "auto")

    @property
    def name(self) -> str:
        """The estimator as ``--integrator`` takes it."""
        return type(self).__name__.lower()

    def flags(self) -> dict[str, str]:
        """Return the settings that are not None, as texts by the names of flags."""
        own = {field.name: getattr(self, field.name) for field in fields(self)}
        texts = {name.replace("_", "-"): _text(value) for name, value in own.items() if value is not None}
        return {"integrator": self.name, **texts}


def _warn(older: str, today: str) -> None:
    """Warn the caller of a constructor that a name has changed."""
    message = f"`{older}` is now `{today}`"
    warnings.warn(message, DeprecationWarning, stacklevel=4)


def _text(value: object) -> str:
    """Return a setting as flags have it: numbers that belong together have commas between them."""
    return ",".join(map(str, value)) if isinstance(value, tuple) else str(value)


@dataclass(frozen=True, kw_only=True)
class Path(Integrator):
    """Path tracing: next-event estimation and lights that are hit, combined."""

    #: How strategies that make the same path share it.
    mis: Mis | None = None
    #: How next-event estimation chooses the light.
    light_choice: LightChoice | None = None


@dataclass(frozen=True, kw_only=True)
class Light(Integrator):
    """Light tracing: every vertex of a light subpath is connected to the lens."""


@dataclass(frozen=True, kw_only=True)
class _Bidirectional(Integrator):
    """Settings of estimators that have connections to choose from."""

    #: Which connections are traced: a :class:`Selector`, or its text such as ``"budget:2"``.
    shadow_rays: Selector | str | None = None
    #: How strategies that make the same path share it.
    mis: Mis | None = None
    #: The strategies that take part, such as ``all,-s0,-t1``; the last rule that matches decides.
    strategies: str | None = None
    #: Where next-event estimation takes its light point from: each camera vertex draws its own, or
    #: all use the start of the light subpath.
    light_point: LightPoint | None = None
    #: How next-event estimation chooses the light.
    light_choice: LightChoice | None = None


@dataclass(frozen=True, kw_only=True)
class Bdpt(_Bidirectional):
    """Bidirectional path tracing: both ends of a sample, joined by every strategy."""


@dataclass(frozen=True, kw_only=True)
class Lvc(_Bidirectional):
    """Bidirectional path tracing that connects with light subpaths of many samples."""

    #: How many vertices of shared light subpaths are weighed for each camera vertex, 1 to 4096; two
    #: numbers are for the first vertex of a camera subpath, and for each of those behind it.
    #: ``"auto"`` leaves the numbers to the estimator.
    candidates: int | tuple[int, int] | Literal["auto", "suited"] | None = None
    #: How many light points next-event estimation draws for each camera vertex, in the same way.
    next_events: int | tuple[int, int] | None = None
    #: How vertices of shared light subpaths are chosen: each as likely as others, or by what a short
    #: render before learnt.
    proposal: Proposal | None = None
    #: How light subpaths choose their light: by power, or by what the same render found to reach
    #: what is seen.
    light_start: LightStart | None = None
    #: How many samples bring one light subpath to those that are shared: a power of two to 256.
    samples_per_subpath: int | None = None
    #: What weights take for the number of samples of a strategy whose light subpaths are shared: how
    #: often it makes the path, less where camera subpaths are rare, or how often it traces its ray.
    mis_count: MisCount | None = None
    #: The older name of ``light_start``, with a warning.
    emission: InitVar[LightStart | None] = None

    def __post_init__(self, emission: LightStart | None) -> None:
        """Check every setting, and take the older name of one of them.

        Errors: :class:`bidir.SettingsError` where one has a value that is not known.
        """
        if emission is not None:
            _warn("emission", "light_start")
            object.__setattr__(self, "light_start", emission)
        super().__post_init__()


@dataclass(frozen=True, kw_only=True)
class Auto(Lvc):
    """:class:`Path`, :class:`Bdpt` or :class:`Lvc`, by what a short render before the first pass finds.

    It tries several numbers of ``samples_per_subpath``: naming one has no influence. What it took is
    ``film.settings["plan"]``.
    """
