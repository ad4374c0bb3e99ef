"""Estimators, and rules that choose shadow rays.

An estimator is a value: it can be compared, hashed, printed and changed by
:func:`dataclasses.replace`. A setting that is None stays what the scene says, or else has its default;
names and meanings are those of the flags of ``bidir render``.
"""

from __future__ import annotations

import warnings
from dataclasses import InitVar, dataclass, fields
from typing import Literal, TypeAlias

from bidir import _bidir, check

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


class Selector:
    """A rule that chooses which connections are traced.

    No rule changes the expected image: a connection chosen with probability π has the weight 1/π.
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
    """Russian roulette for connections that contribute less than a fraction of the image's mean."""

    #: The fraction; above 0.
    part: float = 0.1

    def __str__(self) -> str:
        """Return the rule as ``--shadow-rays`` takes it."""
        return f"ray-roulette:{self.part}"


@dataclass(frozen=True)
class Budget(Selector):
    """Trace at most ``rays`` connections for each pair of subpaths, the largest contributions always."""

    #: The number of rays, from 1.
    rays: int

    def __str__(self) -> str:
        """Return the rule as ``--shadow-rays`` takes it."""
        return f"budget:{self.rays}"


@dataclass(frozen=True, kw_only=True)
class Integrator:
    """An integrator with its settings; ``None`` leaves a setting to the scene or its default."""

    #: Maximum number of bounces; 0 is unlimited.
    max_depth: int | None = None
    #: Russian roulette of subpaths: ``albedo[:START]``, ``throughput[:START]``, ``off`` or ``auto``.
    path_roulette: str | None = None
    #: The sampler.
    sampler: Literal["independent", "sobol"] | None = None

    def __post_init__(self) -> None:
        """Check every setting.

        Errors: :class:`bidir.SettingsError` where one has a value that is not known.
        """
        for field in fields(self):
            # A rule may be given without parentheses.
            object.__setattr__(self, field.name, check.value(getattr(self, field.name), Selector))
        _bidir.check_settings(self.flags())
        if "suited" in self.flags().values():
            _warn("suited", "auto")

    @property
    def name(self) -> str:
        """The value of ``--integrator``."""
        return type(self).__name__.lower()

    def flags(self) -> dict[str, str]:
        """Return the settings that are not None, as text by the names of flags."""
        own = {field.name: getattr(self, field.name) for field in fields(self)}
        texts = {name.replace("_", "-"): _text(value) for name, value in own.items() if value is not None}
        return {"integrator": self.name, **texts}


def _warn(older: str, today: str) -> None:
    """Warn the caller of a constructor that a name has changed."""
    message = f"`{older}` is now `{today}`"
    warnings.warn(message, DeprecationWarning, stacklevel=4)


def _text(value: object) -> str:
    """Return a setting in the notation of flags: tuples of numbers are separated by commas."""
    return ",".join(map(str, value)) if isinstance(value, tuple) else str(value)


@dataclass(frozen=True, kw_only=True)
class Path(Integrator):
    """Path tracing with next-event estimation."""

    #: The MIS heuristic.
    mis: Mis | None = None
    #: How next-event estimation picks a light.
    light_choice: LightChoice | None = None


@dataclass(frozen=True, kw_only=True)
class Light(Integrator):
    """Light tracing: connects every vertex of a light subpath to the lens."""


@dataclass(frozen=True, kw_only=True)
class _Bidirectional(Integrator):
    """Settings of estimators that have connections to choose from."""

    #: The connections to trace: a :class:`Selector`, or its text such as ``"budget:2"``.
    shadow_rays: Selector | str | None = None
    #: The MIS heuristic.
    mis: Mis | None = None
    #: Strategies in use, such as ``all,-s0,-t1``; the last rule that matches wins.
    strategies: str | None = None
    #: The light point of next-event estimation: a fresh one per camera vertex, or the start of the
    #: light subpath.
    light_point: LightPoint | None = None
    #: How next-event estimation picks a light.
    light_choice: LightChoice | None = None


@dataclass(frozen=True, kw_only=True)
class Bdpt(_Bidirectional):
    """Bidirectional path tracing."""


@dataclass(frozen=True, kw_only=True)
class Lvc(_Bidirectional):
    """Bidirectional path tracing with light subpaths shared by many samples."""

    #: Light vertices considered per camera vertex, 1 to 4096; of two numbers the first is for the first
    #: vertex of a camera subpath, the second for later ones.
    #: ``"auto"`` leaves the numbers to the integrator.
    candidates: int | tuple[int, int] | Literal["auto", "suited"] | None = None
    #: Light samples of next-event estimation per camera vertex, likewise.
    next_events: int | tuple[int, int] | Literal["auto"] | None = None
    #: How candidates are drawn: uniformly, or as learned in training.
    proposal: Proposal | None = None
    #: How light subpaths choose their light: by power, or as learned in training.
    light_start: LightStart | None = None
    #: Samples per light subpath: a power of two up to 256.
    samples_per_subpath: int | None = None
    #: The former name of ``light_start``, which warns.
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
    """:class:`Path`, :class:`Bdpt` or :class:`Lvc`, chosen by a short survey before the first pass.

    It decides ``samples_per_subpath`` and ignores the setting.
    ``film.settings["plan"]`` has the choice.
    """


#: The integrators by the names that ``--integrator`` takes.
INTEGRATORS: dict[str, type[Integrator]] = {
    kind.__name__.lower(): kind for kind in (Path, Light, Bdpt, Lvc, Auto)
}


def integrator_of(given: Integrator | type[Integrator] | str | None) -> Integrator | None:
    """Return an integrator by its value, its class or its name.

    Errors: :class:`bidir.SettingsError` for anything else.
    """
    if isinstance(given, str):
        _bidir.check_settings({"integrator": given})
        return INTEGRATORS[given]()
    if isinstance(given, type) and given in INTEGRATORS.values():
        return given()
    if given is None or isinstance(given, Integrator):
        return given
    names = ", ".join(INTEGRATORS)
    check.refuse("integrator", f"an integrator such as bidir.Bdpt(), or one of {names}", given)
