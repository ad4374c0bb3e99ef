"""Scenes built in Python from arrays."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from bidir import check
from bidir.errors import SettingsError
from bidir.scene import Scene, StrPath, from_text

__all__ = ["Material", "Medium", "SceneBuilder", "Texture"]

Rgb: TypeAlias = Sequence[float]
Point: TypeAlias = Sequence[float]


@dataclass(frozen=True)
class Material:
    """A material of a :class:`SceneBuilder`."""

    #: Its name in the text.
    name: str


@dataclass(frozen=True)
class Texture:
    """A texture of a :class:`SceneBuilder`."""

    #: Its name in the text.
    name: str


@dataclass(frozen=True)
class Medium:
    """A participating medium of a :class:`SceneBuilder`."""

    #: Its name in the text.
    name: str


#: The value of a parameter of a material, a light or a shape: numbers, flags and texts keep their type;
#: three numbers are a colour, linear Rec. 709.
Value: TypeAlias = float | int | bool | str | Rgb | Texture


class SceneBuilder:
    """Builds a scene: calls add objects, :meth:`build` returns the scene.

    The world is right-handed, lengths have no unit, +y is up unless the camera has another ``up``. The
    builder keeps pbrt-v4 text with meshes and images in memory; :meth:`save` writes them. Kinds of
    materials, media and lights, and the names of their parameters, are those of pbrt-v4.
    """

    def __init__(self, size: tuple[int, int] | str = (640, 480), *, spp: int = 16) -> None:
        """Begin an empty scene.

        Args:
            size: Width and height of the film. Unit: pixels.
            spp: Samples per pixel, unless a render sets them.
        """
        width, height = check.size("size", size)
        self._film = (
            f'Film "rgb" "integer xresolution" {width} "integer yresolution" {height}\n'
            f'Sampler "sobol" "integer pixelsamples" {check.count("spp", spp, 1, 2**31 - 1)}\n'
            'Integrator "bdpt" "integer maxdepth" 16\n'
        )
        self._camera = ""
        self._media: list[str] = []
        self._world: list[str] = []
        self._files: dict[str, bytes] = {}
        self._count = 0

    def camera(
        self,
        eye: Point,
        target: Point,
        *,
        up: Point = (0.0, 1.0, 0.0),
        fov: float = 40.0,
        lens_radius: float = 0.0,
        focal_distance: float | None = None,
        medium: Medium | None = None,
    ) -> SceneBuilder:
        """Set the camera.

        Args:
            eye: Position. Space: world.
            target: The point in the middle of the image.
            up: The upward direction in the image.
            fov: The angle of view along the shorter side. Unit: degrees.
            lens_radius: Radius of the lens; 0 is a pinhole camera.
            focal_distance: Distance in focus; None is the distance of the target.
            medium: The medium around it; None is the vacuum.
        """
        eye_, target_, up_ = (_numbers(part, 3, "camera") for part in (eye, target, up))
        if focal_distance is None:
            focal_distance = float(np.linalg.norm(np.subtract(target_, eye_)))
        place = " ".join(_number(x) for x in (*eye_, *target_, *up_))
        # pbrt's space is left-handed, which would mirror the image of a right-handed world.
        around = "" if medium is None else f'MediumInterface "{medium.name}"\n'
        self._camera = (
            f'{around}Scale -1 1 1\nLookAt {place}\nCamera "perspective" "float fov" {_number(fov)} '
            f'"float lensradius" {_number(lens_radius)} '
            f'"float focaldistance" {_number(focal_distance)}\n'
        )
        return self

    def material(self, kind: str, **parameters: Value) -> Material:
        """Add a material, such as ``material("diffuse", reflectance=(0.7, 0.1, 0.1))``.

        Args:
            kind: A pbrt-v4 material: ``diffuse``, ``coateddiffuse``, ``conductor``, ``dielectric`` and more.
            **parameters: Its parameters. A key may begin with its type:
                ``**{"spectrum eta": "metal-Cu-eta"}``.

        :meth:`build` reports invalid parameters.
        """
        material = Material(self._name("material"))
        self._world.append(
            f'MakeNamedMaterial "{material.name}" "string type" {_text(kind)}{_list(parameters)}\n'
        )
        return material

    def medium(
        self,
        kind: str,
        *,
        low: Point | None = None,
        high: Point | None = None,
        cells: Mapping[str, npt.ArrayLike] | None = None,
        **parameters: Value,
    ) -> Medium:
        """Add a medium, such as ``medium("homogeneous", sigma_a=(0.1, 0.1, 0.1), sigma_s=(1, 1, 1))``.

        It is where shapes have it ``inside`` or ``outside``, and around the camera.

        Args:
            kind: A pbrt-v4 medium: ``homogeneous``, ``uniformgrid``, ``rgbgrid``, ``cloud``, ``nanovdb``.
            low: The corner of its box with the smallest coordinates; None is the origin.
            high: The other corner; None is (1, 1, 1).
            cells: Parameters with a value for each cell of the box, such as ``{"density": array}``. Shape:
                (nx, ny, nz); (nx, ny, nz, 3) for colours.
            **parameters: The other parameters, as for :meth:`material`.

        Errors: :class:`bidir.SettingsError` for other or different shapes.
        """
        medium = Medium(self._name("medium"))
        text = f'MakeNamedMedium "{medium.name}" "string type" {_text(kind)}{_list(parameters)}'
        for name, corner in (("p0", low), ("p1", high)):
            if corner is not None:
                numbers = " ".join(_number(x) for x in _numbers(corner, 3, name))
                text += f' "point3 {name}" [{numbers}]'
        self._media.append(f"{text}{_cells(cells or {})}\n")
        return medium

    def texture(self, image: npt.ArrayLike) -> Texture:
        """Add an image, linear Rec. 709 or plain numbers, row 0 at v = 1.

        Args:
            image: Shape: (rows, columns, 3) for colours, (rows, columns) for numbers.

        Errors: :class:`bidir.SettingsError` for other shapes.
        """
        array = np.asarray(image, "<f4")
        is_color = array.ndim == 3 and array.shape[2] == 3
        if array.size == 0 or not (is_color or array.ndim == 2):
            raise SettingsError(f"texture: the shape {array.shape} is not that of an image")
        name = self._name("texture")
        head = f"{'PF' if is_color else 'Pf'}\n{array.shape[1]} {array.shape[0]}\n-1.0\n"
        # The format stores the bottom row first.
        self._files[f"{name}.pfm"] = head.encode() + array[::-1].tobytes()
        kind = "spectrum" if is_color else "float"
        self._world.append(f'Texture "{name}" "{kind}" "imagemap" "string filename" "{name}.pfm"\n')
        return Texture(name)

    def mesh(
        self,
        vertices: npt.ArrayLike,
        faces: npt.ArrayLike,
        material: Material,
        *,
        normals: npt.ArrayLike | None = None,
        uv: npt.ArrayLike | None = None,
        emission: Rgb | None = None,
        transform: npt.ArrayLike | None = None,
        inside: Medium | None = None,
        outside: Medium | None = None,
    ) -> SceneBuilder:
        """Add a mesh.

        Args:
            vertices: Points. Shape: (n, 3).
            faces: Indices of vertices, counterclockwise seen from the front. Shape: (m, 3) or (m, 4).
            material: Its material.
            normals: Shading normals. Shape: (n, 3).
            uv: Texture coordinates. Shape: (n, 2).
            emission: Radiance that its front emits, linear Rec. 709. Unit: W/(m² sr).
            transform: Object to world, for column vectors. Shape: (4, 4).
            inside: The medium behind its front, which closed meshes enclose. With the material
                ``interface`` the mesh is its boundary alone. None is the vacuum where ``outside`` is given.
            outside: The medium before its front, likewise.

        Errors: :class:`bidir.SettingsError` for other shapes, or vertices that do not exist.
        """
        name = self._name("mesh")
        self._files[f"{name}.ply"] = _ply(vertices, faces, normals, uv)
        shape = f'"plymesh" "string filename" "{name}.ply"'
        self._shape(shape, material, emission, transform, (inside, outside))
        return self

    def sphere(
        self,
        center: Point,
        radius: float,
        material: Material,
        *,
        emission: Rgb | None = None,
        inside: Medium | None = None,
        outside: Medium | None = None,
    ) -> SceneBuilder:
        """Add a sphere; ``emission``, ``inside`` and ``outside`` as for :meth:`mesh`.

        Errors: :class:`bidir.SettingsError` if the centre is not a point.
        """
        place = np.eye(4)
        place[:3, 3] = _numbers(center, 3, "center")
        shape = f'"sphere" "float radius" {_number(radius)}'
        self._shape(shape, material, emission, place, (inside, outside))
        return self

    def light(self, kind: str, **parameters: Value) -> SceneBuilder:
        """Add a light without a shape, such as ``light("infinite", L=(1, 1, 1))``.

        Args:
            kind: A pbrt-v4 light: ``point``, ``spot``, ``distant``, ``infinite``.
            **parameters: Its parameters, as for :meth:`material`; ``from`` and ``to`` are points:
                ``light("point", I=(5, 5, 5), **{"point3 from": (0, 2, 0)})``.
        """
        self._world.append(f"LightSource {_text(kind)}{_list(parameters)}\n")
        return self

    def text(self) -> str:
        """Return the scene as pbrt-v4 text.

        Errors: :class:`bidir.SettingsError` if there is no camera.
        """
        if not self._camera:
            raise SettingsError("the scene has no camera: call camera()")
        world = "".join(self._world)
        return "".join(self._media) + self._camera + self._film + "WorldBegin\n" + world

    def build(self) -> Scene:
        """Return the scene.

        Errors: :class:`bidir.SceneError` with the line of :meth:`text`.
        """
        return from_text(self.text(), files=self._files, name="builder.pbrt")

    def save(self, folder: StrPath) -> Path:
        """Write ``scene.pbrt`` with its meshes and images into a folder, and create the folder if needed.

        Returns: The path of ``scene.pbrt``.

        Errors: :class:`OSError`.
        """
        path = Path(folder)
        path.mkdir(parents=True, exist_ok=True)
        for name, data in self._files.items():
            (path / name).write_bytes(data)
        (path / "scene.pbrt").write_text(self.text(), encoding="utf-8")
        return path / "scene.pbrt"

    def _name(self, kind: str) -> str:
        self._count += 1
        return f"{kind}-{self._count}"

    def _shape(
        self,
        shape: str,
        material: Material,
        emission: Rgb | None,
        transform: npt.ArrayLike | None,
        media: tuple[Medium | None, Medium | None],
    ) -> None:
        parts = ["AttributeBegin\n"]
        if media != (None, None):
            names = ['""' if medium is None else f'"{medium.name}"' for medium in media]
            parts.append(f"  MediumInterface {' '.join(names)}\n")
        if transform is not None:
            matrix = np.asarray(transform, float)
            if matrix.shape != (4, 4):
                raise SettingsError(f"transform: the shape is {matrix.shape}, not (4, 4)")
            numbers = " ".join(_number(x) for x in matrix.T.ravel())
            parts.append(f"  ConcatTransform [{numbers}]\n")
        if emission is not None:
            parts.append(f'  AreaLightSource "diffuse"{_list({"L": tuple(emission)})}\n')
        parts.append(f'  NamedMaterial "{material.name}"\n  Shape {shape}\nAttributeEnd\n')
        self._world.append("".join(parts))


def _number(value: float) -> str:
    return repr(float(value))


def _text(value: str | os.PathLike[str]) -> str:
    return json.dumps(os.fspath(value), ensure_ascii=False)


def _numbers(value: Sequence[float], count: int, name: str) -> list[float]:
    numbers = [float(x) for x in value]
    if len(numbers) != count:
        raise SettingsError(f"{name}: {count} numbers are needed, not {len(numbers)}")
    return numbers


def _list(parameters: Mapping[str, Value]) -> str:
    return "".join(f" {_parameter(name, value)}" for name, value in parameters.items())


def _parameter(name: str, value: Value) -> str:
    """Return a parameter in the notation of the format; a type in front of the name stays."""
    kind, text = _typed(name, value)
    full = name if " " in name else f"{kind} {name}"
    return f'"{full}" {text}'


def _typed(name: str, value: Value) -> tuple[str, str]:
    if isinstance(value, Texture):
        return "texture", _text(value.name)
    if isinstance(value, bool):
        return "bool", "true" if value else "false"
    if isinstance(value, str):
        return "string", _text(value)
    if isinstance(value, (int, np.integer)):
        # Whole numbers are valid values of real parameters.
        return ("integer" if name in _INTEGERS else "float"), str(int(value))
    if isinstance(value, (float, np.floating)):
        return "float", _number(value)
    numbers = " ".join(_number(x) for x in value)
    return "rgb", f"[{numbers}]"


def _cells(arrays: Mapping[str, npt.ArrayLike]) -> str:
    """Return parameters with a value for each cell, x fastest, and the numbers of cells.

    Errors: :class:`bidir.SettingsError` for other or different shapes.
    """
    text = ""
    sizes = set()
    for name, given in arrays.items():
        array = np.asarray(given, float)
        is_color = array.ndim == 4 and array.shape[3] == 3
        if array.size == 0 or not (is_color or array.ndim == 3):
            raise SettingsError(f"{name}: the shape {array.shape} is not that of cells")
        sizes.add(array.shape[:3])
        values = array.transpose((2, 1, 0, 3) if is_color else (2, 1, 0)).ravel()
        numbers = " ".join(_number(x) for x in values)
        text += f' "{"rgb" if is_color else "float"} {name}" [{numbers}]'
    if len(sizes) > 1:
        raise SettingsError(f"the cells of a medium have different shapes: {sorted(sizes)}")
    for size in sizes:
        text += "".join(f' "integer n{axis}" {n}' for axis, n in zip("xyz", size, strict=True))
    return text


#: The integer parameters of materials and lights.
_INTEGERS = {"maxdepth", "nsamples"}


def _ply(
    vertices: npt.ArrayLike,
    faces: npt.ArrayLike,
    normals: npt.ArrayLike | None,
    uv: npt.ArrayLike | None,
) -> bytes:
    """Return a mesh as a binary PLY.

    Errors: :class:`bidir.SettingsError` for other shapes, or vertices that do not exist.
    """
    points = _columns(vertices, 3, "vertices")
    columns, names = [points], ["x", "y", "z"]
    for given, width, label, more in (
        (normals, 3, "normals", ["nx", "ny", "nz"]),
        (uv, 2, "uv", ["u", "v"]),
    ):
        if given is None:
            continue
        array = _columns(given, width, label)
        if len(array) != len(points):
            raise SettingsError(f"{label}: {len(array)} rows for {len(points)} vertices")
        columns.append(array)
        names += more
    indices = np.asarray(faces)
    is_faces = indices.ndim == 2 and indices.shape[1] in (3, 4)
    if not is_faces or not np.issubdtype(indices.dtype, np.integer):
        raise SettingsError("faces: whole numbers of the shape (m, 3) or (m, 4) are needed")
    if indices.size and not 0 <= indices.min() <= indices.max() < len(points):
        raise SettingsError(f"faces: an index is not that of one of the {len(points)} vertices")
    packed = np.empty(len(indices), [("count", "u1"), ("index", "<i4", (indices.shape[1],))])
    packed["count"], packed["index"] = indices.shape[1], indices
    head = ["ply", "format binary_little_endian 1.0", f"element vertex {len(points)}"]
    head += [f"property float {name}" for name in names]
    head += [f"element face {len(indices)}", "property list uchar int vertex_indices", "end_header"]
    data = np.concatenate(columns, axis=1).astype("<f4").tobytes()
    return "\n".join(head).encode() + b"\n" + data + packed.tobytes()


def _columns(given: npt.ArrayLike, width: int, name: str) -> npt.NDArray[np.float32]:
    array = np.asarray(given, "<f4")
    if array.ndim != 2 or array.shape[1] != width:
        raise SettingsError(f"{name}: the shape is {array.shape}, not (n, {width})")
    return array
