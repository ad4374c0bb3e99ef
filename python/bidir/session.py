"""Renders: all at once, or pass by pass."""

from __future__ import annotations

import os
import time as clock
from collections.abc import Callable, Iterable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, Protocol, TypeAlias

from bidir import _bidir, check
from bidir.errors import FilmError, RenderError, RenderInterruptedError
from bidir.film import Film
from bidir.image import Image
from bidir.scene import Scene, StrPath, load
from bidir.settings import Integrator, integrator_of

__all__ = ["LAYERS", "Progress", "ProgressBar", "RenderRequest", "Session", "render"]

#: An integrator: its value, its class, or its name on the command line. None: the scene's.
AnyIntegrator: TypeAlias = Integrator | type[Integrator] | str | None
#: The names of all layers.
LAYERS: tuple[str, ...] = tuple(_bidir.LAYERS)


class ProgressBar(Protocol):
    """The interface of a progress bar, such as that of ``tqdm``."""

    total: Any

    def update(self, n: int) -> Any:
        """Report ``n`` more finished passes."""
        ...

    def close(self) -> Any:
        """End the bar."""
        ...


#: A receiver of progress: a bar; a class of bars such as ``tqdm``, called with ``total`` and ``unit``; or a
#: function of the numbers of finished passes and of all passes, None if there is no limit.
Progress: TypeAlias = ProgressBar | Callable[[int, int | None], object] | type


class Reporter(AbstractContextManager["Reporter"]):
    """Reports to a :data:`Progress`."""

    def __init__(self, progress: Progress | None, total: int | None, done: int = 0) -> None:
        """Begin with ``done`` of ``total`` passes finished."""
        self._total = total
        self._done = done
        self._own = isinstance(progress, type)
        self._call: Callable[[int, int | None], object] | None = None
        self._bar: Any = None
        if isinstance(progress, type):
            self._bar = progress(total=total, unit="pass", initial=done)
        elif progress is not None and hasattr(progress, "update"):
            self._bar = progress
            self._bar.total = total
            if done:
                self._bar.update(done)
        elif callable(progress):
            self._call = progress

    def advance(self, passes: int) -> None:
        """Report more finished passes."""
        self._done += passes
        if self._bar is not None:
            self._bar.update(passes)
        if self._call is not None:
            self._call(self._done, self._total)

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Close the bar if this reporter made it."""
        if self._own and self._bar is not None:
            self._bar.close()


@dataclass(frozen=True)
class RenderRequest:
    """The requested settings of a render: everything that a film depends on except scene and passes."""

    #: The integrator. None: that of the scene.
    integrator: Integrator | None = None
    #: The seed. None: that of the scene, or 0.
    seed: int | None = None
    #: Names of :data:`LAYERS`.
    layers: tuple[str, ...] = ()
    #: True if every light group has a layer.
    light_groups: bool = False
    #: The largest number of vertices of paths whose strategies have layers.
    strategy_layers: int = 0

    def native(self, scene: Scene) -> dict[str, Any]:
        """Return the settings for the native module."""
        layers = LAYERS if "all" in self.layers else self.layers
        return {
            "settings": self.integrator.flags() if self.integrator else {},
            "seed": self.seed,
            "layers": list(layers),
            "light_groups": scene.light_groups if self.light_groups else [],
            "strategy_layers": self.strategy_layers,
        }


def render_request(
    integrator: AnyIntegrator,
    seed: int | None,
    layers: Iterable[str],
    light_groups: bool,
    strategy_layers: int,
) -> RenderRequest:
    """Return the arguments of a render as a value.

    Errors: :class:`bidir.SettingsError` for one of another kind.
    """
    named = layers.split(",") if isinstance(layers, str) else layers
    names = tuple(named) if isinstance(named, Iterable) else (named,)
    if not all(isinstance(each, str) for each in names):
        check.refuse("layers", f"names among {', '.join(LAYERS)}", layers)
    most = _bidir.MOST_STRATEGY_VERTICES
    vertices = check.count("strategy_layers", strategy_layers, 0, most)
    if vertices == 1:
        check.refuse("strategy_layers", f"0, or a whole number from 2 to {most}", vertices)
    return RenderRequest(
        integrator_of(integrator),
        None if seed is None else check.count("seed", seed),
        names,
        bool(light_groups),
        vertices,
    )


def scene_of(scene: Scene | StrPath) -> Scene:
    """Return a scene, or that of a file.

    Errors: those of :func:`bidir.load`; :class:`bidir.SettingsError` for anything else.
    """
    if isinstance(scene, Scene):
        return scene
    return load(check.name("scene", scene, "a bidir.Scene or the name of its file"))


class Session:
    """A render, pass by pass.

    Other Python threads run during a pass. Ctrl-C discards the running pass; the session can continue
    with it.
    """

    def __init__(
        self,
        scene: Scene | StrPath,
        integrator: AnyIntegrator = None,
        *,
        seed: int | None = None,
        layers: Iterable[str] = (),
        light_groups: bool = False,
        strategy_layers: int = 0,
        threads: int = 0,
        training: int | None = None,
        _limits: tuple[float | None, float | None] = (None, None),
    ) -> None:
        """Start a render; only training, if the integrator has any, is done here.

        Args:
            scene: The scene, or its file.
            integrator: The integrator, or its class or name; None is the scene's.
            seed: Random seed; None is the scene's, or 0.
            layers: Extra layers: names of :data:`bidir.LAYERS`, or ``all``.
            light_groups: Keep one layer per light group.
            strategy_layers: Keep one layer per strategy, for paths of up to this many vertices, 2 to 16.
            threads: Number of threads, 0 is one per processor; does not change the image. More than 4 per
                processor are not used, with a `RuntimeWarning`; more than 1024 are an error. Where the system
                starts fewer, the session warns and continues with those, or with the calling thread only.
            training: The maximum number of samples of training; None is as many as it wants. To continue a
                film whose ``settings`` have ``training``, pass that number.

        Errors: :class:`bidir.SettingsError`, :class:`bidir.RenderError`, and those of :func:`bidir.load`.
        """
        self.scene = scene_of(scene)
        self.request = render_request(integrator, seed, layers, light_groups, strategy_layers)
        native = self.request.native(self.scene)
        threads = check.count("threads", threads)
        training = None if training is None else check.count("training", training)
        # The time of a render, of which training takes at most a tenth, and the time until its end.
        self._native = _bidir.Session(self.scene._native, native, threads, training, *_limits)

    def step(self, passes: int = 1) -> None:
        """Render the next passes, each with one sample per pixel.

        Errors: :class:`KeyboardInterrupt`, within a second; complete passes stay.
        """
        for _ in range(passes):
            self._native.step()

    def start_at(self, first: int) -> None:
        """Skip the passes before ``first``."""
        self._native.start_at(first)

    def snapshot(self) -> Image:
        """Return the image of all passes so far."""
        return Image(self.film())

    def film(self) -> Film:
        """Return the film of all passes so far."""
        return Film(self._native.film())

    def take_film(self) -> Film:
        """Return the film and continue with an empty one."""
        return Film(self._native.take_film())

    def checkpoint(self, path: StrPath) -> None:
        """Write a film file for :meth:`resume`.

        Errors: :class:`bidir.FileError`; an older file is then unchanged.
        """
        self.film().save(path)

    def resume(self, film: Film | StrPath) -> None:
        """Add a film of the same render; its passes are not rendered again.

        Errors: :class:`bidir.FilmError` if it belongs to another render or overlaps; those of
        :meth:`bidir.Film.load`.
        """
        film = film if isinstance(film, Film) else Film.load(film)
        self._native.add_film(film._native)

    @property
    def next_pass(self) -> int:
        """The pass that :meth:`step` renders next, counted from 0."""
        return self._native.next_pass

    @property
    def passes(self) -> list[range]:
        """The finished passes."""
        return [range(begin, end) for begin, end in self._native.passes]

    @property
    def noise(self) -> float:
        """The estimated RMS error of the pixels relative to the mean."""
        return self._native.noise

    @property
    def threads(self) -> int:
        """The number of threads."""
        return self._native.threads

    @property
    def settings(self) -> dict[str, str]:
        """Every setting of the integrator, defaults and automatic choices included."""
        return self._native.settings

    @property
    def identity(self) -> str:
        """The :attr:`bidir.Film.identity` of the films of this session."""
        return self._native.identity

    def __repr__(self) -> str:
        """Return the scene and the number of finished passes."""
        return f"<bidir.Session {self.scene.name!r}, {sum(map(len, self.passes))} passes>"


def render(
    scene: Scene | StrPath,
    integrator: AnyIntegrator = None,
    *,
    spp: int | None = None,
    time: float | None = None,
    noise: float | None = None,
    seed: int | None = None,
    layers: Iterable[str] = (),
    light_groups: bool = False,
    strategy_layers: int = 0,
    threads: int = 0,
    progress: Progress | None = None,
    checkpoint: StrPath | None = None,
    checkpoint_every: float = 300.0,
) -> Image:
    """Render a scene.

    Args:
        scene: The scene, or its file.
        integrator: The integrator, such as ``bidir.Bdpt(shadow_rays="per-pair")``, or a name such as
            ``"bdpt"``; None is the scene's, or ``auto`` for glTF.
        spp: Samples per pixel; None is the scene's, or unlimited with ``time`` or ``noise``.
        time: Stop within this time; a pass that would be late is left. Unit: seconds.
        noise: Stop at this error relative to the mean; checked from 16 passes on.
        seed, layers, light_groups, strategy_layers, threads: As for :class:`Session`.
        progress: ``tqdm``, a progress bar, or a function of finished and all passes.
        checkpoint: A film file to continue from, if it exists, and to write repeatedly.
        checkpoint_every: Time between checkpoints. Unit: seconds.

    Errors: those of :class:`Session`; :class:`bidir.RenderError` if no pass is complete within ``time``, and
    ``checkpoint`` is then unchanged; :class:`bidir.RenderInterruptedError` on Ctrl-C, with the image of the
    complete passes, which ``checkpoint`` contains too; :class:`bidir.FilmError` if ``checkpoint`` belongs to
    another render.
    """
    spp = None if spp is None else check.count("spp", spp, 1)
    time = None if time is None else check.number("time", time)
    noise = None if noise is None else check.number("noise", noise)
    checkpoint = None if checkpoint is None else check.name("checkpoint", checkpoint)
    checkpoint_every = check.number("checkpoint_every", checkpoint_every)
    scene = scene_of(scene)
    open_end = time is not None or noise is not None
    limit = spp if spp is not None else None if open_end else scene.spp
    begin = clock.monotonic()
    earlier = _earlier(checkpoint)

    def left() -> float | None:
        return None if time is None else time - (clock.monotonic() - begin)

    session = Session(
        scene,
        integrator,
        seed=seed,
        layers=layers,
        light_groups=light_groups,
        strategy_layers=strategy_layers,
        threads=threads,
        training=None if earlier is None else _training(earlier),
        _limits=(time if earlier is None else None, left()),
    )
    limits = {"spp": limit, "time": time, "noise": noise}
    keeper = _Keeper(session, checkpoint, earlier, checkpoint_every, limit)
    rendered = 0
    with Reporter(progress, limit, session.next_pass) as reporter:
        try:
            while not session._native.reached(limits) and session._native.step(left()):
                rendered += 1
                reporter.advance(1)
                keeper.now_and_then()
        except KeyboardInterrupt as error:
            keeper.save()
            image = session.snapshot() if session.passes else None
            done = session.next_pass
            raise RenderInterruptedError(f"stopped after {done} passes", image) from error
    if rendered == 0 and not session._native.reached(limits):
        raise RenderError(
            f"no pass was complete after {time:g} s: give it more time, or make the image smaller"
        )
    keeper.save()
    return session.snapshot()


def _earlier(checkpoint: StrPath | None) -> Film | None:
    """Return the film that a render continues."""
    return Film.load(checkpoint) if checkpoint is not None and Path(checkpoint).exists() else None


def _training(film: Film) -> int | None:
    """Return the number of samples that the training of a film was limited to."""
    samples = film.settings.get("training")
    return None if samples is None else int(samples)


class _Keeper:
    """Writes checkpoints at intervals."""

    def __init__(
        self, session: Session, path: StrPath | None, film: Film | None, every: float, limit: int | None
    ) -> None:
        self._session, self._every = session, every
        self._path = None if path is None else Path(path)
        self._written = clock.monotonic()
        self._kept = 0
        if self._path is not None and film is not None:
            beyond = [part for part in film.passes if limit is not None and part.stop > limit]
            if beyond:
                message = f"{os.fspath(self._path)}: it has passes beyond the {limit} asked for"
                raise FilmError(message)
            try:
                session.resume(film)
            except FilmError as error:
                raise FilmError(f"{os.fspath(self._path)}: {error}") from error
            self._kept = film.spp

    def now_and_then(self) -> None:
        if clock.monotonic() - self._written >= self._every:
            self.save()

    def save(self) -> None:
        passes = sum(map(len, self._session.passes))
        if self._path is not None and passes > self._kept:
            self._session.checkpoint(self._path)
            self._written, self._kept = clock.monotonic(), passes
