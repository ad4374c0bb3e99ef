"""Renders: bits, progress, limits, interruptions."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import bidir


def test_images_are_arrays(cornell: bidir.Scene) -> None:
    image = bidir.render(cornell, bidir.Bdpt(shadow_rays=bidir.PerPair()), spp=2)
    assert image.pixels.shape == cornell.shape == image.shape
    assert image.pixels.dtype == np.float32
    assert not image.pixels.flags.writeable
    assert np.asarray(image) is image.pixels
    assert image.variance.shape == image.shape
    assert np.isfinite(image.pixels).all()
    assert image.pixels.mean() > 0
    assert image._repr_png_().startswith(b"\x89PNG")
    assert len(image.png(exposure=4)) != len(image.png())


def test_strategies_that_make_no_path_are_refused(cornell: bidir.Scene) -> None:
    with pytest.raises(bidir.SettingsError, match="`s0t0` makes no path"):
        bidir.render(cornell, bidir.Bdpt(strategies="s0t0"), spp=1)


def test_statistics_are_those_of_the_film(cornell: bidir.Scene) -> None:
    image = bidir.render(cornell, bidir.Bdpt(shadow_rays="per-pair"), spp=3, seed=7)
    stats = image.stats
    assert stats["spp"] == 3
    assert stats["samples"] == 3 * 24 * 16
    assert 0 < stats["rays.connection"] <= stats["samples"]
    assert stats["settings"]["shadow-rays"] == "per-pair"
    assert stats["settings"]["seed"] == "7"
    assert stats["seconds"] > 0


def test_layers_have_names_and_shapes(cornell: bidir.Scene) -> None:
    layers = bidir.render(cornell, spp=2, layers=["albedo", "depth"], strategy_layers=4).layers
    assert layers["Albedo"].shape == cornell.shape
    assert layers["Z"].shape == cornell.shape[:2]
    assert layers["Z"].max() > 0
    assert layers["depth"] is layers["Z"]
    assert "depth" in layers
    assert "normal" not in layers
    assert set(layers) >= {"Albedo", "Z", "Coverage"}
    names = r"no layer 'normal': it has Albedo \(albedo\), .*Z \(depth\).*; `layers` of bidir.render"
    with pytest.raises(KeyError, match=names) as raised:
        layers["normal"]
    assert isinstance(raised.value, bidir.LayerError)
    with pytest.raises(bidir.LayerError, match="no layer 'Z': it has none"):
        bidir.render(cornell, spp=1).layers["Z"]
    strategies = [name for name in layers if name.startswith("s")]
    assert "s0t2" in "".join(strategies) or strategies
    with pytest.raises(TypeError):
        layers["Z"] = layers["Albedo"]  # type: ignore[index]
    everything = bidir.render(cornell, spp=1, layers="all", light_groups=True).layers
    assert all(name in everything for name in bidir.LAYERS)
    assert {"Albedo", "P", "N", "Ns", "Z", "Samples", "Variance", "Rays"} <= everything.keys()


def test_strategies_add_up_to_the_image(cornell: bidir.Scene) -> None:
    image = bidir.render(cornell, bidir.Bdpt(max_depth=2), spp=4, strategy_layers=4)
    total = sum(layer.astype(float) for layer in image.layers.values())
    np.testing.assert_allclose(total, image.pixels, atol=1e-4)


@pytest.mark.parametrize("vertices", [-1, 1, 17, 32])
def test_strategy_layers_have_a_range(cornell: bidir.Scene, vertices: int) -> None:
    expected = f"strategy_layers: expected .* to 16, not {vertices}"
    with pytest.raises(bidir.SettingsError, match=expected):
        bidir.render(cornell, bidir.Bdpt(), spp=1, strategy_layers=vertices)


@pytest.mark.parametrize(
    "integrator",
    [bidir.Path(), bidir.Light(), bidir.Bdpt(), bidir.Lvc(), bidir.Auto()],
    ids=lambda integrator: integrator.name,
)
def test_threads_and_parts_change_no_bit(cornell: bidir.Scene, integrator: bidir.Integrator) -> None:
    whole = bidir.render(cornell, integrator, spp=5, threads=1).film
    assert bidir.render(cornell, integrator, spp=5, threads=3).film == whole
    session = bidir.Session(cornell, integrator)
    session.start_at(3)
    session.step(2)
    last = session.take_film()
    session.start_at(0)
    session.step(3)
    first = session.take_film()
    assert [last.passes, first.passes] == [[range(3, 5)], [range(3)]]
    assert bidir.Film.merge(last, first) == bidir.Film.merge([first, last]) == whole


def test_seeds_change_the_image(cornell: bidir.Scene) -> None:
    a, b = (bidir.render(cornell, spp=1, seed=seed) for seed in (1, 2))
    assert not bidir.identical(a, b)


def test_a_session_continues_from_a_film(cornell: bidir.Scene, tmp_path: Path) -> None:
    session = bidir.Session(cornell, bidir.Path())
    session.step(2)
    assert bidir.identical(session.snapshot(), bidir.render(cornell, bidir.Path(), spp=2))
    session.checkpoint(tmp_path / "a.film")
    again = bidir.Session(cornell, bidir.Path())
    again.resume(tmp_path / "a.film")
    assert (again.next_pass, again.passes) == (2, [range(2)])
    again.step()
    whole = bidir.render(cornell, bidir.Path(), spp=3)
    assert again.film() == whole.film
    assert again.film().counts == whole.film.counts
    other = bidir.Session(cornell, bidir.Path(max_depth=1))
    with pytest.raises(bidir.FilmError, match="max-depth is 1 in this render"):
        other.resume(tmp_path / "a.film")


def test_render_continues_from_its_checkpoint(cornell: bidir.Scene, tmp_path: Path) -> None:
    path = tmp_path / "a.film"
    bidir.render(cornell, spp=2, checkpoint=path)
    told: list[tuple[int, int | None]] = []
    image = bidir.render(cornell, spp=5, checkpoint=path, progress=lambda done, of: told.append((done, of)))
    assert told == [(3, 5), (4, 5), (5, 5)]
    assert image.film == bidir.render(cornell, spp=5).film == bidir.Film.load(path)
    with pytest.raises(bidir.FilmError, match="beyond the 3"):
        bidir.render(cornell, spp=3, checkpoint=path)
    with pytest.raises(bidir.FilmError, match="seed is 1 in this render"):
        bidir.render(cornell, spp=9, seed=1, checkpoint=path)


class Bar:
    """A bar that records its calls."""

    def __init__(self, total: Any = None, unit: str = "", initial: int = 0) -> None:
        self.total, self.unit, self.n, self.closed = total, unit, initial, False
        Bar.last = self

    last: Bar

    def update(self, n: int) -> None:
        self.n += n

    def close(self) -> None:
        self.closed = True


def test_progress_reaches_bars_and_functions(cornell: bidir.Scene) -> None:
    bar = Bar()
    bidir.render(cornell, spp=3, progress=bar)
    assert (bar.n, bar.total, bar.closed) == (3, 3, False)
    bidir.render(cornell, spp=2, progress=Bar)
    assert (Bar.last.n, Bar.last.total, Bar.last.unit, Bar.last.closed) == (2, 2, "pass", True)


def test_tqdm_is_a_progress_bar(cornell: bidir.Scene) -> None:
    tqdm = pytest.importorskip("tqdm", reason="tqdm is not installed")
    with tqdm.tqdm(disable=False, file=open(os.devnull, "w")) as bar:
        bidir.render(cornell, spp=3, progress=bar)
        assert (bar.n, bar.total) == (3, 3)


def test_limits_end_a_render(cornell: bidir.Scene) -> None:
    by_time = bidir.render(cornell, time=0.2)
    assert by_time.film.stopping == "time"
    assert by_time.film.spp >= 1
    by_noise = bidir.render(cornell, noise=0.2)
    assert by_noise.film.stopping == "noise"
    assert by_noise.film.noise <= 0.2
    # One pass would suffice, but the noise is checked from pass 16 on, as by the command.
    assert bidir.render(cornell, noise=1e6).film.spp == 16
    assert bidir.render(cornell, spp=1, time=1e6).film.stopping == "fixed"
    for wrong in (
        {"spp": 0},
        {"spp": 1, "threads": -1},
        {"spp": 1, "threads": 1025},
        {"spp": 1, "seed": -1},
    ):
        with pytest.raises(bidir.SettingsError):
            bidir.render(cornell, **wrong)  # type: ignore[arg-type]


@pytest.mark.skipif((os.cpu_count() or 1) >= 256, reason="1024 threads are not too many here")
def test_more_than_four_threads_per_processor_are_not_started(cornell: bidir.Scene) -> None:
    with pytest.warns(RuntimeWarning, match="threads instead of 1024"):
        session = bidir.Session(cornell, threads=1024)
    assert session.threads < 1024


def test_other_threads_run_meanwhile(scenes: Path) -> None:
    session = bidir.Session(bidir.load(scenes / "cornell.pbrt", size=(256, 256)))
    turns, done = 0, threading.Event()

    def render() -> None:
        session.step(2)
        done.set()

    thread = threading.Thread(target=render)
    thread.start()
    while not done.is_set():
        turns += 1
        time.sleep(0.001)
    thread.join()
    # With the GIL held, there would be one or two turns.
    assert turns > 10
    assert session.next_pass == 2


INTERRUPTED = """
import signal, sys, bidir
# Shells start background processes with this signal ignored.
signal.signal(signal.SIGINT, signal.default_int_handler)
scene = bidir.load(sys.argv[1], size=(512, 512))
def tell(done, of):
    print(done, flush=True)
try:
    bidir.render(scene, spp=10**6, progress=tell, checkpoint=sys.argv[2])
except KeyboardInterrupt as error:
    assert isinstance(error, bidir.RenderInterruptedError)
    assert error.image.film.stopping == "time"
    print("kept", error.image.film.spp)
"""


@pytest.mark.skipif(os.name != "posix", reason="signals are sent as POSIX has them")
def test_an_interrupted_render_keeps_its_passes(scenes: Path, tmp_path: Path) -> None:
    film = tmp_path / "a.film"
    command = [sys.executable, "-c", INTERRUPTED, str(scenes / "cornell.pbrt"), str(film)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        # The second pass is running now.
        assert process.stdout.readline() == "1\n"
        process.send_signal(signal.SIGINT)
        try:
            said = process.communicate(timeout=300)[0].split()
        finally:
            process.kill()
    assert process.returncode == 0
    kept = int(said[said.index("kept") + 1])
    assert kept >= 1
    assert bidir.Film.load(film).passes == [range(kept)]


def test_the_command_gives_the_same_bits(cornell: bidir.Scene, tmp_path: Path) -> None:
    command = os.environ.get("BIDIR_COMMAND")
    if not command:
        pytest.skip("BIDIR_COMMAND does not name the program bidir")
    film = tmp_path / "a.film"
    flags = (
        "--size 24x24 --crop 0,0,24,16 --spp 3 --integrator lvc --shadow-rays budget:2 --max-depth 6 --seed 4"
    )
    flags += f" --aov albedo --checkpoint {film} -o {tmp_path}/a.exr -q"
    subprocess.run([command, "render", cornell.name, *flags.split()], check=True)
    lvc = bidir.Lvc(shadow_rays=bidir.Budget(2), max_depth=6)
    image = bidir.render(cornell, lvc, spp=3, seed=4, layers=["albedo"])
    assert image.film == bidir.Film.load(film)
    assert bidir.identical(image, bidir.read_image(tmp_path / "a.exr"))
    image.film.save(tmp_path / "b.film")
    merged = [command, "merge", str(tmp_path / "b.film"), "-o", str(tmp_path / "c.film")]
    subprocess.run(merged, check=True, capture_output=True)
    assert bidir.Film.load(tmp_path / "c.film") == image.film
