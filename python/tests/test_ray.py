"""Renders over nodes that die, come and fail: the bits are those of one machine."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import bidir
import pytest

pytest.importorskip("ray", reason="ray is not installed: pip install 'bidir[ray]'")
pytestmark = pytest.mark.ray

import bidir.ray  # noqa: E402
from bidir.ray._crew import Limits  # noqa: E402
from bidir.ray._render import Renderer  # noqa: E402

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


class Meanwhile:
    """Does something when a render is in its middle."""

    def __init__(self, when: Callable[[], bool], what: Callable[[], object]) -> None:
        self.result: Any = None
        self.error: BaseException | None = None
        self._when, self._what = when, what
        self._thread = threading.Thread(target=self._run)

    def _run(self) -> None:
        try:
            wait_for(self._when)
            self.result = self._what()
        except BaseException as error:
            self.error = error

    def __enter__(self) -> Meanwhile:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._thread.join()
        if self.error is not None:
            raise self.error


def render(scene: bidir.Scene, journal: Journal, **settings: Any) -> bidir.Film:
    """Render with passes that take a tenth of a second, in tasks of about four."""
    settings = {"spp": SPP, "task_seconds": 0.4, "fan_in": 2, **settings}
    return bidir.ray.render(scene, _actor=slow(journal), **settings).film


def check(film: bidir.Film, local: bidir.Film) -> None:
    """Fail where a film is not that of one machine, or has a pass twice."""
    assert film.passes == [range(SPP)]
    assert film.counts["samples"] == local.counts["samples"]
    assert film == local


def test_the_bits_are_those_of_one_machine(nodes: Nodes, cornell: bidir.Scene, local: bidir.Film) -> None:
    told: list[int] = []
    journal = Journal()
    film = render(cornell, journal, progress=lambda done, of: told.append(done))
    check(film, local)
    assert told[-1] == SPP
    assert len({node for *_, node in journal.entries()}) == 3


def test_a_killed_worker(nodes: Nodes, cornell: bidir.Scene, local: bidir.Film) -> None:
    journal = Journal()

    def kill() -> int:
        pid = journal.entries()[-1][2]
        os.kill(pid, signal.SIGKILL)
        return pid

    with Meanwhile(lambda: len(journal.entries()) >= 5, kill) as killed:
        check(render(cornell, journal), local)
    # A fresh process took the place of the one that was killed, and its node rendered on.
    dead = next(node for _, _, pid, node in journal.entries() if pid == killed.result)
    assert len({pid for _, _, pid, node in journal.entries() if node == dead}) <= 2
    begun = sum(end - begin for begin, end, _, _ in journal.entries())
    assert begun > SPP


def test_a_killed_node(nodes: Nodes, cornell: bidir.Scene, local: bidir.Film) -> None:
    journal = Journal()
    with Meanwhile(lambda: len(journal.entries()) >= 6, nodes.kill):
        check(render(cornell, journal), local)


def test_an_added_node(nodes: Nodes, cornell: bidir.Scene, local: bidir.Film) -> None:
    nodes.kill()
    journal = Journal()
    long_enough = slow(journal, 0.5)
    with Meanwhile(lambda: len(journal.entries()) >= 2, nodes.add) as added:
        film = bidir.ray.render(cornell, spp=SPP, task_seconds=1, fan_in=2, _actor=long_enough).film
    check(film, local)
    assert added.result in {node for *_, node in journal.entries()}


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
    film = render(cornell, again, checkpoint=path, progress=lambda done, of: told.append(done))
    check(film, local)
    assert bidir.Film.load(path) == local
    # What was kept is not rendered again.
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


def preparing(told: dict[str, Any]) -> type[Renderer]:
    """Return an actor that tells something else of itself."""

    class Preparing(Renderer):
        def prepare(self, *arguments: Any) -> dict[str, Any]:
            return {**super().prepare(*arguments), **told}

    return Preparing


@pytest.mark.parametrize(
    ("told", "words"),
    [
        ({"version": "0.0.1"}, "its version of bidir is 0.0.1"),
        ({"architecture": "pdp11"}, "its architecture of bidir is pdp11"),
        ({"scene": "0123456789abcdef"}, "it reads another scene: 0123456789ab"),
    ],
    ids=["version", "architecture", "scene"],
)
def test_nodes_that_differ_are_refused(
    nodes: Nodes, cornell: bidir.Scene, told: dict[str, Any], words: str
) -> None:
    with pytest.raises(bidir.ray.NodeRefusedError, match=words):
        bidir.ray.render(cornell, spp=4, _actor=preparing(told))


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
