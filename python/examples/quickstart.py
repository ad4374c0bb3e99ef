"""A scene becomes an image; the example of README.md."""

import bidir

scene = bidir.load("scenes/cornell.pbrt", size=(256, 256))
image = bidir.render(scene, bidir.Bdpt(shadow_rays=bidir.PerPair()), spp=16)
image.save("cornell.png")
print(image, image.pixels.shape, image.pixels.dtype)
