"""A render on the nodes of a Ray cluster, which survives the death of its driver."""

import bidir
import bidir.ray


def main(address: str | None, spp: int) -> bidir.Image:
    """Render; the same call with the same checkpoint continues."""
    scene = bidir.load("scenes/apartment.pbrt", size=(160, 90))
    return bidir.ray.render(
        scene,
        bidir.Bdpt(),
        spp=spp,
        address=address,
        checkpoint="apartment.film",
        progress=lambda done, of: print(f"{done} of {of} passes"),
    )


if __name__ == "__main__":
    image = main("local", 64)
    image.save("apartment.png")
    print(image)
