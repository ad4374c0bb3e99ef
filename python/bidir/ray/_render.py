"""A render over the nodes of a cluster, by ranges of passes."""

from __future__ import annotations

import os
import platform
import socket
import threading
import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Literal

import ray
from ray.exceptions import RayError

from bidir import _bidir, check
from bidir.errors import FilmError, RenderInterruptedError, SettingsError
from bidir.film import Film
from bidir.image import Image
from bidir.ray._crew import ClusterError, Crew, Limits, Worker, connected, first_line, logger
from bidir.ray._tree import Part, Tree
from bidir.scene import Scene, StrPath
from bidir.session import (
    AnyIntegrator,
    Progress,
    RenderRequest,
    Reporter,
    Session,
    render_request,
    scene_of,
)

__all__ = ["Renderer", "render"]


def versions() -> dict[str, Any]:
    """Return the versions that all nodes must share."""
    return {
        "version": _bidir.VERSION,
        "estimator version": _bidir.ESTIMATOR_VERSION,
        "architecture": platform.machine(),
    }


class Renderer:
    """The actor of a node: it reads the scene once, and renders ranges of passes."""

    def __init__(self) -> None:
        """Begin without a scene."""
        self._turn = threading.Lock()

    def prepare(
        self, scene: Scene | tuple[str, dict[str, Any]], request: RenderRequest, threads: int
    ) -> dict[str, Any]:
        """Read the scene and start a session; return a description of the node."""
        if not isinstance(scene, Scene):
            scene = Scene(*scene)
        self.session = Session(
            scene,
            request.integrator,
            seed=request.seed,
            layers=request.layers,
            light_groups=request.light_groups,
            strategy_layers=request.strategy_layers,
            threads=threads,
        )
        return {
            **versions(),
            "scene": scene.digest,
            "identity": self.session.identity,
            "isa": _bidir.ISA,
            "host": socket.gethostname(),
        }

    def render(self, begin: int, end: int) -> tuple[dict[str, Any], bytes]:
        """Render the passes from ``begin`` up to, but excluding, ``end``; return their film.

        One range renders at a time, with all threads; the next one starts while its film is packed.
        """
        with self._turn:
            started = time.monotonic()
            self.session.start_at(begin)
            try:
                self.session.step(end - begin)
            finally:
                # A failed range must not leave passes to the next one.
                film = self.session.take_film()
            seconds = time.monotonic() - started
        return {"seconds": seconds, "passes": film.spp}, film.to_bytes()


class _Ranges:
    """The remaining passes."""

    def __init__(self, ranges: Iterable[range]) -> None:
        self._ranges = sorted(ranges, key=lambda part: part.start)
        self._again: list[range] = []

    def __len__(self) -> int:
        return sum(map(len, self._ranges + self._again))

    def take(self, passes: int) -> range | None:
        """Take a failed range unchanged, or else at most ``passes`` of the first passes."""
        if self._again:
            return self._again.pop()
        if not self._ranges:
            return None
        first = self._ranges[0]
        taken = range(first.start, min(first.start + passes, first.stop))
        rest = range(taken.stop, first.stop)
        self._ranges[:1] = [rest] if len(rest) else []
        return taken

    def try_again(self, unit: range) -> None:
        """Give back a failed range; it stays one unit, so that its failures can be counted."""
        self._again.append(unit)

    def give_back(self, ranges: Iterable[range]) -> None:
        self._ranges = sorted([*self._ranges, *ranges], key=lambda part: part.start)


class RenderWork:
    """The work of a :class:`bidir.ray._crew.Crew`: units are ranges of passes."""

    #: One range renders while the film of another is packed.
    concurrency = 2

    def __init__(
        self,
        scene: Scene,
        request: RenderRequest,
        shipped: Any,
        passes: range,
        task_seconds: float,
        tree: Tree,
        keeper: Keeper,
        reporter: Reporter,
        actor: type = Renderer,
    ) -> None:
        self.actor = actor
        self._scene, self._request, self._shipped = scene, request, shipped
        self._seconds = task_seconds
        self._tree, self._keeper, self._reporter = tree, keeper, reporter
        self._todo = _Ranges(keeper.missing(passes))
        self._running = 0
        self._losses = 0
        self.identity = keeper.identity

    def prepare(self, actor: Any, cpus: int) -> Any:
        return actor.prepare.remote(self._shipped, self._request, cpus)

    def check(self, report: dict[str, Any]) -> str | None:
        for name, here in versions().items():
            if report[name] != here:
                return f"its {name} of bidir is {report[name]}, here it is {here}"
        if report["scene"] != self._scene.digest:
            return f"it reads another scene: {report['scene'][:12]}, not {self._scene.digest[:12]}"
        if self.identity is None:
            self.identity = report["identity"]
        if report["identity"] != self.identity:
            return "its films are of another render than those that are there"
        return None

    def next(self, worker: Worker, workers: int) -> range | None:
        self._tree.set_workers(workers)
        pace = worker.notes.get("pace")
        if pace is None:
            # The first two units have one pass each, to measure its time.
            passes = 1
        else:
            share = -(-len(self._todo) // workers)
            passes = max(1, min(round(self._seconds / pace), share))
        unit = self._todo.take(passes) if passes else None
        self._running += unit is not None
        return unit

    def submit(self, worker: Worker, unit: range) -> tuple[Any, Any]:
        report, film = worker.actor.render.options(num_returns=2).remote(unit.start, unit.stop)
        return report, film

    def done(self, worker: Worker, unit: range, report: dict[str, Any], result: Any) -> None:
        self._running -= 1
        worker.notes["pace"] = max(report["seconds"] / len(unit), 1e-6)
        self._tree.add(Part(result, (unit,)))
        self._reporter.advance(len(unit))

    def again(self, unit: range) -> None:
        self._running -= 1
        self._todo.try_again(unit)

    def name(self, unit: range) -> str:
        passes = f"{unit.start}..{unit.stop}"
        return f"{self._scene.name}: the range of passes {passes}"

    def pending(self) -> list[Any]:
        return self._tree.pending()

    def turn(self) -> bool:
        self._lose(self._tree.settle())
        is_last = not self._todo and not self._running
        while part := self._tree.fetchable(everything=is_last and not self._tree.pending()):
            self._fetch(part)
        return bool(len(self._todo)) or self._running > 0 or not self._tree.is_empty()

    def _fetch(self, part: Part) -> None:
        try:
            data: Any = ray.get(part.film)
        except RayError as error:
            self._tree.cause = first_line(error)
            logger.warning("a film was lost before it was fetched: %s", self._tree.cause)
            self._lose(part.ranges)
            return
        self._losses = 0
        self._keeper.add(Film(_bidir.Film.from_bytes(data, self._scene._native)))

    def _lose(self, ranges: Iterable[range]) -> None:
        """Render passes again after the loss of their films."""
        lost = list(ranges)
        if not lost:
            return
        self._losses += 1
        if self._losses > Limits.losses:
            message = "films are lost again and again before the driver has them"
            raise ClusterError(f"{message}, the last time: {self._tree.cause}")
        self._todo.give_back(lost)
        self._reporter.advance(-sum(map(len, lost)))


class Keeper:
    """The film of the driver, and its checkpoint."""

    def __init__(self, path: Path | None, every: float, spp: int, digest: str) -> None:
        self._path, self._every = path, every
        self.film: Film | None = None
        self._saved = time.monotonic()
        self._is_saved = True
        if path is None or not path.exists():
            return
        film = Film.load(path)
        if film.settings.get("scene-digest") != digest:
            raise FilmError(f"{os.fspath(path)} is the film of another scene")
        if film.passes and film.passes[-1].stop > spp:
            raise FilmError(f"{os.fspath(path)}: it has passes beyond the {spp} of this render")
        self.film = film

    @property
    def identity(self) -> str | None:
        return self.film.identity if self.film else None

    def missing(self, passes: range) -> list[range]:
        return self.film.missing(passes) if self.film else [passes]

    def add(self, film: Film) -> None:
        """Add passes; :meth:`bidir.Film.merge` fails for duplicates."""
        self.film = film if self.film is None else Film.merge(self.film, film)
        self._is_saved = False
        if time.monotonic() - self._saved >= self._every:
            self.save()

    def save(self) -> None:
        if self._path is not None and self.film is not None and not self._is_saved:
            self.film.save(self._path)
            self._saved, self._is_saved = time.monotonic(), True


def render(
    scene: Scene | StrPath,
    integrator: AnyIntegrator = None,
    *,
    spp: int | None = None,
    seed: int | None = None,
    layers: Iterable[str] = (),
    light_groups: bool = False,
    strategy_layers: int = 0,
    address: str | None = None,
    ship: Literal["object", "path"] = "object",
    task_seconds: float = 20.0,
    fan_in: int = 8,
    checkpoint: StrPath | None = None,
    checkpoint_every: float = 30.0,
    progress: Progress | None = None,
    limits: Limits | None = None,
    _actor: type = Renderer,
) -> Image:
    """Render a scene on the nodes of a cluster; the bits are those of :func:`bidir.render`.

    Every node with processors renders ranges of passes with all of its threads. Nodes may come and go;
    lost passes are rendered again, and no pass is counted twice.

    Args:
        scene: The scene, or its file.
        integrator: The integrator, or its class or name; None is the scene's.
        spp: Samples per pixel; None is the scene's.
        seed, layers, light_groups, strategy_layers: As for :class:`bidir.Session`.
        address: Address of the cluster, as for ``ray.init``: ``local`` starts one on this machine, None
            takes a running cluster or starts a local one. A connected process stays connected.
        ship: ``object`` sends the scene with its files once to each node; with ``path`` each node reads
            the file from a shared path and checks that it is the same.
        task_seconds: Approximate duration of a task; 10 to 60 works well. Unit: seconds.
        fan_in: Number of films merged at a time on the cluster.
        checkpoint: A film file to continue from, if it exists, and to write repeatedly.
        checkpoint_every: Time between checkpoints. Unit: seconds.
        progress: As for :func:`bidir.render`.
        limits: Numbers of retries.

    Errors: those of :func:`bidir.load`; :class:`TaskFailedError` with the range of passes that keeps
    failing; :class:`NodeRefusedError` if no node has the same version of bidir or can read the scene;
    :class:`ClusterError`; :class:`bidir.FilmError` if ``checkpoint`` belongs to another render;
    :class:`bidir.RenderInterruptedError` on Ctrl-C.
    """
    scene = scene_of(scene)
    request = render_request(integrator, seed, layers, light_groups, strategy_layers)
    request.native(scene)
    passes = scene.spp if spp is None else check.count("spp", spp, 1)
    task_seconds = check.number("task_seconds", task_seconds, above=True)
    fan_in = check.count("fan_in", fan_in, 2)
    path = None if checkpoint is None else Path(checkpoint)
    keeper = Keeper(path, checkpoint_every, passes, scene.digest)
    done = keeper.film.spp if keeper.film else 0
    disconnect = connected(address)
    try:
        with Reporter(progress, passes, done) as reporter:
            work = RenderWork(
                scene,
                request,
                _shipped(scene, ship),
                range(passes),
                task_seconds,
                Tree(fan_in),
                keeper,
                reporter,
                _actor,
            )
            Crew(work, limits or Limits()).run()
    except KeyboardInterrupt as error:
        image = keeper.film.develop() if keeper.film else None
        raise RenderInterruptedError("stopped", image) from error
    finally:
        keeper.save()
        disconnect()
    if keeper.film is None:
        raise ClusterError("nothing was rendered")
    return keeper.film.develop()


def _shipped(scene: Scene, ship: str) -> Any:
    """Return the scene for actors: a reference that each node fetches once, or a path to read."""
    if ship == "object":
        return ray.put(scene)
    if ship == "path":
        return (os.path.abspath(scene.name), {**scene._source, "sealed": False})
    raise SettingsError(f"ship: `{ship}` is neither `object` nor `path`")
