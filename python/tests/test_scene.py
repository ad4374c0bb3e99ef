"""Scenes from files, texts and arrays, and their errors."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest

import bidir

SKY = 'WorldBegin\nLightSource "infinite"\n'
QUAD = ([[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]], [[0, 3, 2, 1]])


def test_a_scene_has_its_properties(scenes: Path) -> None:
    scene = bidir.load(scenes / "cornell.pbrt", size=(40, 40), crop=(4, 2, 14, 30))
    assert (scene.size, scene.crop, scene.shape) == ((40, 40), (4, 2, 14, 30), (28, 10, 3))
    assert scene.settings["integrator"] == "bdpt"
    assert scene.summary["area_lights"] == 1
    assert scene.files == [str(scenes / "cornell.pbrt")]
    assert len(scene.digest) == 64
    assert bidir.render(scene, spp=1).shape == scene.shape


@pytest.mark.parametrize(
    ("name", "line", "column"),
    [("missing-mesh", 13, 35), ("misspelt-material", 12, 10)],
)
def test_errors_have_a_place(scenes: Path, name: str, line: int, column: int) -> None:
    with pytest.raises(bidir.SceneError) as raised:
        bidir.load(scenes / "broken" / f"{name}.pbrt")
    error = raised.value
    assert (error.line, error.column) == (line, column)
    assert error.file is not None
    assert error.file.endswith(f"{name}.pbrt")
    assert str(error).startswith(f"{error.file}:{line}:{column}: {error.reason}")
    again = pickle.loads(pickle.dumps(error))
    assert (type(again), str(again), again.column) == (type(error), str(error), column)


def test_scenes_have_warnings(scenes: Path) -> None:
    with pytest.warns(bidir.SceneWarning, match=r"cornell.pbrt:\d+:\d+: the scene's film") as told:
        scene = bidir.load(scenes / "cornell.pbrt", size=(40, 30))
    assert [str(warning.message) for warning in told] == scene.warnings
    assert told[0].filename == __file__


def test_hints_are_given() -> None:
    with pytest.raises(bidir.SceneError, match="did you mean `diffuse`") as raised:
        bidir.from_text('WorldBegin\nMaterial "difuse"')
    assert raised.value.hint == "did you mean `diffuse`?"
    with pytest.raises(bidir.UnsupportedError, match="is not supported"):
        bidir.from_text(SKY + 'Shape "curve" "point3 P" [0 0 0 1 0 0 1 1 0 1 1 1]')


def test_a_missing_file_is_an_error() -> None:
    with pytest.raises(bidir.MissingFileError, match="no such file"):
        bidir.load("no-such-scene.pbrt")
    with pytest.raises(FileNotFoundError):
        bidir.load("no-such-scene.pbrt")


def test_a_crop_outside_the_film_is_refused(scenes: Path) -> None:
    with pytest.raises(bidir.SettingsError):
        bidir.load(scenes / "cornell.pbrt", size=(8, 8), crop=(9, 9, 12, 12))


def test_a_scene_from_text_reads_files_in_memory() -> None:
    part = 'LightSource "point"\n'
    scene = bidir.from_text(
        'WorldBegin\nInclude "part.pbrt"\n', files={"part.pbrt": part.encode()}, size=(16, 9)
    )
    assert scene.files == ["scene.pbrt", "part.pbrt"]
    assert scene.summary["other_lights"] == 1


def test_pickled_scenes_need_no_files(tmp_path: Path) -> None:
    builder = bidir.SceneBuilder((8, 8)).camera((0, 2, 2), (0, 0, 0))
    white = builder.material("diffuse", reflectance=builder.texture(np.full((2, 2, 3), 0.5)))
    builder.mesh(*QUAD, white, uv=[[0, 0], [1, 0], [1, 1], [0, 1]]).light("infinite")
    path = builder.save(tmp_path / "scene")
    scene = bidir.load(path)
    packed = pickle.dumps(scene)
    for file in path.parent.iterdir():
        file.unlink()
    again = pickle.loads(packed)
    assert again.digest == scene.digest == builder.build().digest
    assert again.size == (8, 8)
    with pytest.raises(bidir.MissingFileError):
        bidir.load(path)


def test_a_scene_with_a_changed_file_cannot_be_pickled(tmp_path: Path) -> None:
    path = tmp_path / "s.pbrt"
    path.write_text(SKY)
    scene = bidir.load(path, size=(16, 9))
    path.write_text(SKY + 'LightSource "point"\n')
    with pytest.raises(bidir.SceneError, match="changed after it was read"):
        pickle.loads(pickle.dumps(scene))


def test_a_built_scene_has_the_expected_radiance() -> None:
    builder = bidir.SceneBuilder((9, 9)).camera((0, 5, 0), (0, 0, 0), up=(0, 0, -1), fov=10)
    grey = builder.material("diffuse", reflectance=(0.5, 0.25, 0.0))
    builder.mesh(*QUAD, grey).light("infinite", L=(1, 1, 1))
    image = bidir.render(builder.build(), bidir.Path(max_depth=1), spp=64)
    # A plane under a white sky shows its reflectance.
    np.testing.assert_allclose(image.pixels[4, 4], [0.5, 0.25, 0.0], atol=0.02)


def test_a_ball_of_gas_shines_along_its_diameter() -> None:
    builder = bidir.SceneBuilder((9, 9)).camera((0, 0, 5), (0, 0, 0), fov=1)
    gas = builder.medium("homogeneous", sigma_a=(0.5, 1, 2), sigma_s=(0, 0, 0), Le=(1, 2, 3))
    builder.sphere((0, 0, 0), 1, builder.material("interface"), inside=gas)
    pixels = bidir.render(builder.build(), bidir.Path(), spp=1024).pixels
    expected = np.array([1, 2, 3]) * -np.expm1([-1, -2, -4])
    np.testing.assert_allclose(pixels.mean(axis=(0, 1)), expected, rtol=0.03)


def test_cells_of_a_medium_are_indexed_by_x_y_z() -> None:
    density = np.zeros((3, 2, 1))
    density[2, 0, 0] = 50
    builder = bidir.SceneBuilder((30, 20))
    arrays = {"density": density, "Lescale": np.ones_like(density)}
    box = {"low": (-3, -2, -1), "high": (3, 2, 1)}
    smoke = builder.medium("uniformgrid", cells=arrays, **box, sigma_s=(0, 0, 0), Le=(1, 1, 1))
    builder.camera((0, 0, 8), (0, 0, 0), medium=smoke)
    pixels = bidir.render(builder.build(), bidir.Path(), spp=16).pixels
    row, column = np.unravel_index(pixels.sum(axis=2).argmax(), pixels.shape[:2])
    # Lower right.
    assert row >= 10
    assert column >= 20


@pytest.mark.parametrize(
    ("arrays", "words"),
    [
        ({"density": np.ones((2, 2))}, "density: the shape"),
        ({"density": np.ones((2, 2, 1)), "Lescale": np.ones((2, 1, 2))}, "different shapes"),
    ],
)
def test_cells_of_wrong_shapes_are_refused(arrays: dict[str, np.ndarray], words: str) -> None:
    with pytest.raises(bidir.SettingsError, match=words):
        bidir.SceneBuilder().medium("uniformgrid", cells=arrays)


def test_the_world_of_a_builder_is_right_handed() -> None:
    builder = bidir.SceneBuilder((30, 30)).camera((0, 0, 5), (0, 0, 0))
    white = builder.material("diffuse", reflectance=(0, 0, 0))
    builder.sphere((1, 1, 0), 0.3, white, emission=(1, 2, 3))
    pixels = bidir.render(builder.build(), bidir.Path(), spp=4).pixels
    row, column = np.unravel_index(pixels.sum(axis=2).argmax(), pixels.shape[:2])
    # Upper right.
    assert row < 15
    assert column > 15
    np.testing.assert_allclose(pixels[row, column], [1, 2, 3], rtol=0.01)


def test_a_transform_moves_a_mesh() -> None:
    def mean(transform: np.ndarray | None) -> float:
        builder = bidir.SceneBuilder((9, 9)).camera((0, 5, 0), (0, 0, 0), up=(0, 0, -1), fov=10)
        builder.mesh(*QUAD, builder.material("diffuse"), emission=(1, 1, 1), transform=transform)
        return float(bidir.render(builder.build(), bidir.Path(), spp=1).pixels.mean())

    away = np.eye(4)
    away[0, 3] = 9
    assert mean(None) > 0.99
    assert mean(away) == 0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (([[0, 0]], [[0, 0, 0]]), "vertices: the shape is"),
        ((QUAD[0], [[0, 1, 4]]), "not that of one of the 4 vertices"),
        ((QUAD[0], [[0.0, 1.0, 2.0]]), "whole numbers"),
    ],
)
def test_meshes_of_wrong_shapes_are_refused(arguments: tuple[list, list], words: str) -> None:
    builder = bidir.SceneBuilder()
    with pytest.raises(bidir.SettingsError, match=words):
        builder.mesh(*arguments, builder.material("diffuse"))


def test_a_builder_reports_errors() -> None:
    builder = bidir.SceneBuilder()
    with pytest.raises(bidir.SettingsError, match="no camera"):
        builder.build()
    builder.camera((0, 0, 1), (0, 0, 0)).material("diffuse", reflectanc=(1, 1, 1))
    with pytest.raises(bidir.SceneError, match="did you mean `reflectance`"):
        builder.build()
