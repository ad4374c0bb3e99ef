"""Films, image files and metrics."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest

import bidir


@pytest.fixture(scope="module")
def films(cornell: bidir.Scene) -> list[bidir.Film]:
    """Return films of the passes 0..2, 2..3 and 4..6 of one render."""
    session = bidir.Session(cornell, bidir.Path())
    films = []
    for begin, end in [(0, 2), (2, 3), (4, 6)]:
        session.start_at(begin)
        session.step(end - begin)
        films.append(session.take_film())
    return films


def test_films_list_their_passes(films: list[bidir.Film]) -> None:
    merged = bidir.Film.merge(films)
    assert merged.passes == [range(3), range(4, 6)]
    assert merged.spp == 5
    assert merged.missing(range(8)) == [range(3, 4), range(6, 8)]
    assert merged.missing(range(1, 5)) == [range(3, 4)]
    assert merged.missing(range(2)) == []
    assert films[2].missing(range(4)) == [range(4)]
    assert merged.counts["samples"] == 5 * 24 * 16


def test_merging_is_exact_and_counts_no_pass_twice(films: list[bidir.Film]) -> None:
    a, b, c = films
    assert bidir.Film.merge(a, b, c) == bidir.Film.merge(c, bidir.Film.merge(b, a))
    assert bidir.Film.merge(a, b) != bidir.Film.merge(a, c)
    assert a != "a film"
    with pytest.raises(bidir.FilmError, match=r"both have the passes 0\.\.2"):
        bidir.Film.merge(a, b, a)
    with pytest.raises(bidir.FilmError, match="no film"):
        bidir.Film.merge()


def test_films_of_other_renders_are_refused(cornell: bidir.Scene, films: list[bidir.Film]) -> None:
    session = bidir.Session(cornell, bidir.Path(), seed=3)
    session.start_at(9)
    session.step()
    with pytest.raises(bidir.FilmError, match="seed is 3 here and 0 there"):
        bidir.Film.merge(films[0], session.film())


def test_outputs_replace_no_file_of_the_scene(tmp_path: Path) -> None:
    texture, scene_file, film_file = (tmp_path / name for name in ("wood.png", "a.pbrt", "a.film"))
    bidir.write_image(texture, np.full((2, 2, 3), 0.5, np.float32))
    scene_file.write_text(
        'Film "rgb" "integer xresolution" 4 "integer yresolution" 4 WorldBegin LightSource "infinite" '
        'Texture "t" "spectrum" "imagemap" "string filename" "wood.png" '
        'Material "diffuse" "texture reflectance" "t" Shape "sphere"'
    )
    before = texture.read_bytes()
    image = bidir.render(scene_file, bidir.Path(), spp=1)
    with pytest.raises(bidir.FileError, match=r"wood\.png`: it would replace the input `.*wood\.png`"):
        image.save(texture)
    image.film.save(film_file)
    loaded = bidir.Film.load(film_file)
    session = bidir.Session(bidir.load(scene_file), bidir.Path())
    session.start_at(1)
    session.step()
    merged = bidir.Film.merge(loaded, session.film())
    with pytest.raises(bidir.FileError, match="would replace the input"):
        merged.save(scene_file)
    merged.save(film_file)
    assert bidir.Film.load(film_file) == merged
    assert texture.read_bytes() == before
    image.save(tmp_path / "wood.exr")


def test_films_survive_files(films: list[bidir.Film], tmp_path: Path) -> None:
    path = tmp_path / "a.film"
    films[0].save(path)
    assert bidir.Film.load(path) == films[0] == pickle.loads(pickle.dumps(films[0]))
    assert bidir.Film.load(path).to_bytes() == path.read_bytes()
    damaged = bytearray(path.read_bytes())
    # The checksum of the first pixels: packed bytes may have two spellings.
    header = int.from_bytes(damaged[12:16], "little")
    damaged[16 + header + 4 + 4] ^= 1
    path.write_bytes(damaged)
    with pytest.raises(bidir.DataError, match="damaged"):
        bidir.Film.load(path)
    with pytest.raises(bidir.MissingFileError):
        bidir.Film.load(tmp_path / "b.film")
    with pytest.raises(OSError, match="cannot write"):
        films[0].save(tmp_path / "missing" / "a.film")


def test_images_survive_files(cornell: bidir.Scene, tmp_path: Path) -> None:
    image = bidir.render(cornell, spp=2, layers=["albedo"])
    image.save(tmp_path / "a.exr")
    assert bidir.identical(bidir.read_image(tmp_path / "a.exr"), image)
    layers = bidir.read_layers(tmp_path / "a.exr")
    assert np.array_equal(layers["Albedo.G"], image.layers["Albedo"][:, :, 1])
    image.save(tmp_path / "a.png")
    assert (tmp_path / "a.png").read_bytes() == image.png()
    shown = bidir.read_image(tmp_path / "a.png")
    assert np.abs(shown - np.clip(image.pixels, 0, 1)).max() < 0.01
    bidir.write_image(tmp_path / "b.exr", 2 * image.pixels)
    assert bidir.identical(bidir.read_image(tmp_path / "b.exr"), 2 * image.pixels)
    with pytest.raises(bidir.SettingsError, match=r"output images are \.exr or \.png"):
        image.save(tmp_path / "a.jpg")
    with pytest.raises(bidir.SettingsError, match=r"the shape \(rows, columns, 3\)"):
        bidir.write_image(tmp_path / "c.exr", np.zeros((4, 4)))


def test_metrics_are_as_defined() -> None:
    a = np.array([[[1, 2, 3], [0, 0, 0]]], np.float32)
    b = np.array([[[1, 1, 1], [0, 0, 0]]], np.float32)
    assert bidir.mse(a, b) == pytest.approx(5 / 6)
    assert bidir.rmse(a, b) == pytest.approx((5 / 6) ** 0.5)
    assert bidir.relmse(a, b) == pytest.approx(5 / 1.01 / 6)
    assert bidir.mape(a, b) == pytest.approx(3 / 1.01 / 6)
    assert bidir.error_map("rmse", a, b) == pytest.approx(np.array([[(5 / 3) ** 0.5, 0]]))
    numbers = bidir.compare(a, b)
    assert set(numbers) == {name for name in bidir.METRICS if "flip" not in name}
    assert numbers["rmse"] == bidir.rmse(a, b)


def test_flip_is_zero_for_equal_images_only() -> None:
    black, white = np.zeros((16, 16, 3)), np.ones((16, 16, 3))
    assert bidir.flip(black, black) == 0
    assert bidir.flip_hdr(white, white) == 0
    assert bidir.flip(black, white) > 0.9
    assert set(bidir.compare(black, white, ["flip"])) == {"flip"}


def test_metrics_refuse_images_of_different_shapes() -> None:
    image = np.zeros((4, 4, 3))
    with pytest.raises(bidir.SettingsError, match="differ in shape"):
        bidir.rmse(image, image[:2])
    with pytest.raises(bidir.SettingsError, match="there is no metric `rsme`"):
        bidir.metric("rsme", image, image)
    assert not bidir.identical(image, image[:2])
    # Negative zero is another number.
    assert not bidir.identical(image, -image)
