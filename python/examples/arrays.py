"""A scene from arrays: a wavy surface with a checkered texture under a lamp."""

import numpy as np

import bidir


def waves(n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return vertices, faces and texture coordinates of a grid of n by n points."""
    u, v = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n))
    height = 0.1 * np.sin(12 * u) * np.cos(9 * v)
    vertices = np.stack([4 * u - 2, height, 4 * v - 2], axis=-1).reshape(-1, 3)
    corner = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    faces = np.stack([corner, corner + n, corner + n + 1, corner + 1], axis=-1)
    return vertices, faces, np.stack([u, v], axis=-1).reshape(-1, 2)


def scene() -> bidir.Scene:
    """Return the scene."""
    builder = bidir.SceneBuilder((320, 240)).camera((0, 2.2, 4), (0, 0, 0), fov=38)
    checks = np.indices((16, 16)).sum(axis=0)[..., None] % 2
    colours = np.where(checks, [0.8, 0.75, 0.6], [0.1, 0.2, 0.35])
    ground = builder.material("diffuse", reflectance=builder.texture(np.kron(colours, np.ones((8, 8, 1)))))
    vertices, faces, uv = waves(64)
    builder.mesh(vertices, faces, ground, uv=uv)
    builder.sphere((-0.6, 0.5, 0.3), 0.45, builder.material("dielectric"))
    gold = builder.material("conductor", **{"spectrum eta": "metal-Au-eta", "spectrum k": "metal-Au-k"})
    builder.sphere((0.6, 0.45, -0.2), 0.4, gold)
    lamp = builder.material("diffuse", reflectance=(0, 0, 0))
    builder.sphere((1.5, 2.5, 1.0), 0.25, lamp, emission=(40, 34, 26))
    builder.light("infinite", L=(0.25, 0.3, 0.4))
    return builder.build()


if __name__ == "__main__":
    image = bidir.render(scene(), bidir.Bdpt(), spp=64, layers=["albedo", "depth"])
    image.save("arrays.exr")
    image.save("arrays.png")
    print(image, {name: layer.shape for name, layer in image.layers.items()})
