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


@pytest.mark.parametrize("size", [(32, 24), [32, 24], "32x24", "32X24", np.array([32, 24])])
def test_sizes_are_numbers_or_texts(scenes: Path, size: tuple[int, int]) -> None:
    with pytest.warns(bidir.SceneWarning, match="stretched"):
        assert bidir.load(scenes / "cornell.pbrt", size=size).size == (32, 24)


@pytest.mark.parametrize(
    "size",
    [
        256,
        "256",
        "256x",
        "x",
        "256x256x3",
        (256,),
        (1, 2, 3),
        (0, 4),
        (4, 70000),
        (4.5, 4),
        "4.5x4",
        {"a": 1},
    ],
)
def test_other_sizes_are_refused(scenes: Path, size: object) -> None:
    words = r"size: expected width and height, such as \(640, 480\) or \"640x480\", up to 65536 each, not "
    with pytest.raises(bidir.SettingsError, match=words):
        bidir.load(scenes / "cornell.pbrt", size=size)  # type: ignore[arg-type]
    with pytest.raises(bidir.SettingsError, match=words):
        bidir.from_text(SKY, size=size)  # type: ignore[arg-type]


@pytest.mark.parametrize("crop", [3, (1, 2, 3), (0, 0, -1, 4), "0,0,4,4", (4, 0, 4, 4), (0, 0, 1.5, 4)])
def test_crops_of_another_kind_are_refused(scenes: Path, crop: object) -> None:
    with pytest.raises(bidir.SettingsError, match="crop: expected "):
        bidir.load(scenes / "cornell.pbrt", crop=crop)  # type: ignore[arg-type]


def test_names_of_another_kind_are_refused() -> None:
    with pytest.raises(bidir.SettingsError, match="path: expected the name of a file, not 3"):
        bidir.load(3)  # type: ignore[arg-type]


def test_a_missing_scene_has_the_nearest_name_as_its_hint(tmp_path: Path) -> None:
    folder = tmp_path / "scenes"
    folder.mkdir()
    right = folder / "cornell.pbrt"
    right.write_text(SKY)
    for missing in (folder / "cornel.pbrt", tmp_path / "scene" / "cornell.pbrt"):
        with pytest.raises(bidir.MissingFileError, match="no such file; did you mean `") as raised:
            bidir.load(missing)
        assert raised.value.hint == f"did you mean `{right}`?"


def test_a_film_beyond_memory_has_the_place_of_its_size() -> None:
    film = 'Film "rgb" "integer xresolution" 65536 "integer yresolution" 65536\n'
    large = bidir.from_text(film + SKY)
    with pytest.raises(
        bidir.RenderError, match=r"scene.pbrt:1:\d+: a film of 65536 x 65536 pixels is too large"
    ):
        bidir.render(large, spp=1)
    with pytest.raises(bidir.RenderError, match="size: a film of 65536 x 65536 pixels is too large"):
        bidir.render(bidir.from_text(SKY, size=(65536, 65536)), spp=1)


def test_builders_check_size_and_samples() -> None:
    assert bidir.SceneBuilder("8x6").light("infinite").camera((0, 0, 5), (0, 0, 0)).build().size == (8, 6)
    with pytest.raises(bidir.SettingsError, match="size: expected width and height"):
        bidir.SceneBuilder(8)  # type: ignore[arg-type]
    with pytest.raises(bidir.SettingsError, match=r"spp: expected a whole number .*, not 4\.0"):
        bidir.SceneBuilder((8, 6), spp=4.0)  # type: ignore[arg-type]
