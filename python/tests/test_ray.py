"""Renders on nodes that die, join and fail have the bits of one machine."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import bidir

pytest.importorskip("ray", reason="ray is not installed: pip install 'bidir[ray]'")
pytestmark = pytest.mark.ray

import bidir.ray  # noqa: E402
from bidir.ray._crew import Limits  # noqa: E402
from bidir.ray._render import Keeper, Renderer, RenderWork, versions  # noqa: E402
from bidir.ray._tree import Tree  # noqa: E402
from bidir.session import RenderRequest, Reporter  # noqa: E402

sys.path.insert(0, os.path.dirname(__file__))
from ray_cluster import Journal, Nodes, slow, wait_for  # noqa: E402

SPP = 48


@pytest.fixture(scope="module")
def nodes() -> Iterator[Nodes]:
    """Return three nodes."""
    nodes = Nodes()
    nodes.start()
    yield nodes
    nodes.stop()


@pytest.fixture(autouse=True)
def _three(nodes: Nodes) -> None:
    """Begin every test with three nodes."""
    nodes.complete()


@pytest.fixture(scope="module")
def local(cornell: bidir.Scene) -> bidir.Film:
    """Return the render of this machine."""
    return bidir.render(cornell, spp=SPP).film


class Rendering:
    """A render in a thread, while this one kills and adds: nodes are those of the main thread."""

    def __init__(self, scene: bidir.Scene, journal: Journal, seconds: float = 0.1, **more: Any):
        """Start a render with a least duration of passes, in tasks of about four."""
        settings = {"spp": SPP, "task_seconds": 4 * seconds, "fan_in": 2, **more}
        self._journal, self._result, self._error = journal, None, None

        def run() -> None:
            try:
                actor = slow(journal, seconds)
                self._result = bidir.ray.render(scene, _actor=actor, **settings).film
            except BaseException as error:
                self._error = error

        self._thread = threading.Thread(target=run)
        self._thread.start()

    def wait_for(self, ranges: int) -> None:
        """Wait until a number of ranges have started."""

        def is_there() -> bool:
            assert self._thread.is_alive(), f"the render ended too early: {self._error}"
            return len(self._journal.entries()) >= ranges

        wait_for(is_there)

    def film(self) -> bidir.Film:
        """Wait for the end; the gate of the journal is open."""
        self._thread.join()
        if self._error is not None:
            raise self._error
        assert self._result is not None
        return self._result


def check(film: bidir.Film, local: bidir.Film) -> None:
    """Fail where a film is not that of one machine, or has a pass twice."""
    assert film.passes == [range(SPP)]
    assert film.counts["samples"] == local.counts["samples"]
    assert film == local


def test_the_bits_are_those_of_one_machine(nodes: Nodes, cornell: bidir.Scene, local: bidir.Film) -> None:
    told: list[int] = []
    journal = Journal()
    rendering = Rendering(cornell, journal, progress=lambda done, of: told.append(done))
    wait_for(lambda: len({node for *_, node in journal.entries()}) == 3)
    journal.open_gate()
    check(rendering.film(), local)
    assert told[-1] == SPP


def test_a_killed_worker(nodes: Nodes, cornell: bidir.Scene, local: bidir.Film) -> None:
    journal = Journal()
    rendering = Rendering(cornell, journal)
    rendering.wait_for(5)
    _, _, pid, node = journal.entries()[-1]
    os.kill(pid, signal.SIGKILL)
    journal.open_gate()
    check(rendering.film(), local)
    # Another process repeated the ranges of the killed one.
    assert sum(end - begin for begin, end, _, _ in journal.entries()) > SPP
    assert not nodes.has_lost_any()
    assert node in {other for *_, other in journal.entries()}


def test_a_killed_node(nodes: Nodes, cornell: bidir.Scene, local: bidir.Film) -> None:
    journal = Journal()
    rendering = Rendering(cornell, journal)
    rendering.wait_for(6)
    nodes.kill()
    journal.open_gate()
    check(rendering.film(), local)


def test_an_added_node(nodes: Nodes, cornell: bidir.Scene, local: bidir.Film) -> None:
    nodes.kill()
    journal = Journal()
    rendering = Rendering(cornell, journal)
    rendering.wait_for(2)
    added = nodes.add()
    wait_for(lambda: added in {node for *_, node in journal.entries()})
    journal.open_gate()
    check(rendering.film(), local)


DRIVER = """
import os, sys
sys.path.insert(0, sys.argv[1])
from ray_cluster import Journal, slow
import ray, bidir, bidir.ray
from pathlib import Path
ray.init(address=sys.argv[2], log_to_driver=False)
journal = Journal()
journal.folder = Path(sys.argv[4])
scene = bidir.load(sys.argv[5], size=(24, 24), crop=(0, 0, 24, 16))
bidir.ray.render(scene, spp=int(sys.argv[6]), task_seconds=0.4, fan_in=2, checkpoint=sys.argv[3],
                 checkpoint_every=0, _actor=slow(journal, 0.2))
"""


def test_a_killed_driver(
    nodes: Nodes, cornell: bidir.Scene, local: bidir.Film, tmp_path_factory: Any
) -> None:
    folder = tmp_path_factory.mktemp("driver")
    path, journal = folder / "a.film", Journal()
    arguments = [os.path.dirname(__file__), nodes.address, path, journal.folder, cornell.name, SPP]
    command = [sys.executable, "-c", DRIVER, *map(str, arguments)]
    with subprocess.Popen(command) as driver:

        def is_kept() -> bool:
            assert driver.poll() is None, "the driver ended by itself"
            return path.exists()

        wait_for(is_kept)
        driver.send_signal(signal.SIGKILL)
    kept = bidir.Film.load(path)
    assert 0 < kept.spp < SPP
    again = Journal()
    told: list[int] = []
    tell = told.append
    again.open_gate()
    rendering = Rendering(cornell, again, checkpoint=path, progress=lambda done, of: tell(done))
    check(rendering.film(), local)
    assert bidir.Film.load(path) == local
    # Passes in the checkpoint are not rendered again.
    begun = {p for begin, end, _, _ in again.entries() for p in range(begin, end)}
    assert not begun & {p for part in kept.passes for p in part}
    assert told[-1] == SPP


def failing(error: str) -> type[Renderer]:
    """Return an actor that fails in pass 9."""

    class Failing(Renderer):
        def render(self, begin: int, end: int) -> tuple[dict[str, Any], bytes]:
            if begin <= 9 < end:
                if error == "exit":
                    os._exit(1)
                raise ValueError(error)
            return super().render(begin, end)

    return Failing


def test_a_range_that_always_fails(nodes: Nodes, cornell: bidir.Scene) -> None:
    words = r"range of passes \d+\.\.\d+ failed 3 times, .*ValueError: pass nine"
    with pytest.raises(bidir.ray.TaskFailedError, match=words) as raised:
        bidir.ray.render(cornell, spp=SPP, task_seconds=0.05, _actor=failing("pass nine"))
    begin, end = str(raised.value).split("passes ")[1].split(" ")[0].split("..")
    assert int(begin) <= 9 < int(end)


def test_a_range_that_always_kills_its_worker(nodes: Nodes, cornell: bidir.Scene) -> None:
    limits = Limits(losses=2)
    words = r"range of passes \d+\.\.\d+ lost its worker 2 times"
    with pytest.raises(bidir.ray.TaskFailedError, match=words):
        bidir.ray.render(cornell, spp=12, task_seconds=0.05, limits=limits, _actor=failing("exit"))


def test_nodes_of_another_version_are_refused(nodes: Nodes, cornell: bidir.Scene) -> None:
    class Old(Renderer):
        def prepare(self, *arguments: Any) -> dict[str, Any]:
            return {**super().prepare(*arguments), "version": "0.0.1"}

    with pytest.raises(bidir.ray.NodeRefusedError, match=r"its version of bidir is 0\.0\.1"):
        bidir.ray.render(cornell, spp=4, _actor=Old)


@pytest.mark.parametrize(
    ("told", "words"),
    [
        ({}, None),
        ({"estimator version": 1}, "its estimator version of bidir is 1, here it is"),
        ({"architecture": "pdp11"}, "its architecture of bidir is pdp11"),
        ({"scene": "0123456789abcdef"}, "it reads another scene: 0123456789ab"),
        ({"identity": "b"}, "its films are of another render"),
    ],
)
def test_nodes_that_differ_are_refused(
    nodes: Nodes, cornell: bidir.Scene, told: dict[str, Any], words: str | None
) -> None:
    keeper = Keeper(None, 0, 1, cornell.digest)
    work = RenderWork(cornell, RenderRequest(), None, range(1), 1, Tree(2), keeper, Reporter(None, 1))
    usual = {**versions(), "scene": cornell.digest, "identity": "a"}
    assert work.check(usual) is None
    reason = work.check({**usual, **told})
    assert (reason is None) if words is None else (words in str(reason))


def test_a_scene_on_shared_storage(nodes: Nodes, tmp_path: Path) -> None:
    path = tmp_path / "s.pbrt"
    text = 'WorldBegin\nLightSource "infinite"\nTranslate 0 0 3\nShape "sphere"\n'
    path.write_text(text)
    scene = bidir.load(path, size=(16, 9))
    film = bidir.ray.render(scene, spp=6, ship="path").film
    assert film == bidir.render(scene, spp=6).film
    path.unlink()
    with pytest.raises(bidir.ray.NodeRefusedError, match=r"MissingFileError: .*no such file"):
        bidir.ray.render(scene, spp=6, ship="path")


def test_checkpoints_of_other_renders_are_refused(nodes: Nodes, cornell: bidir.Scene, tmp_path: Path) -> None:
    path = tmp_path / "a.film"
    bidir.render(cornell, bidir.Path(), spp=2, checkpoint=path)
    with pytest.raises(bidir.ray.NodeRefusedError, match="films are of another render"):
        bidir.ray.render(cornell, spp=4, checkpoint=path)
    with pytest.raises(bidir.FilmError, match="beyond the 1"):
        bidir.ray.render(cornell, bidir.Path(), spp=1, checkpoint=path)


@pytest.mark.filterwarnings("ignore:.*noise of the reference")
def test_an_experiment_has_the_records_of_one_machine(nodes: Nodes, tmp_path: Path, scenes: Path) -> None:
    experiment = bidir.Experiment.of(
        scenes={"cornell": scenes / "cornell.pbrt"},
        methods={"all": bidir.Bdpt(), "one": bidir.Bdpt(shadow_rays=bidir.PerPair())},
        budgets=[{"samples": 2}],
        seeds=4,
        size=(8, 8),
        reference_spp=32,
        threads=1,
    )

    def records(results: bidir.Results) -> list[dict[str, Any]]:
        return [{k: v for k, v in r.items() if "seconds" not in k} for r in results.records]

    told: list[tuple[str, int, int]] = []
    with contextlib.suppress(RuntimeError):
        # A stopped driver keeps finished records.
        bidir.ray.experiment(experiment, tmp_path / "ray", progress=stopping(4))
    results = bidir.ray.experiment(experiment, tmp_path / "ray", progress=lambda *a: told.append(a))
    assert [done for what, done, _ in told if "seed" in what] == [6, 8]
    assert records(results) == records(experiment.run(tmp_path / "local"))
    assert (tmp_path / "ray" / "report.html").exists()


def stopping(at: int) -> Any:
    """Return a progress function that raises after some progress."""

    def tell(what: str, done: int, of: int) -> None:
        if "seed" in what and done >= at:
            raise RuntimeError("enough")

    return tell
