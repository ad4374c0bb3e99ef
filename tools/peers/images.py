"""EXR files for the scripts in the peers' environment. Images are float arrays of the shape
(height, width, 3), linear Rec. 709, the top row first."""

import json

import numpy as np
import OpenEXR

HEADER = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}


def write(path, image, layers=None):
    """Writes an image with layers of one channel each: {channel: (height, width)}."""
    channels = {name: np.ascontiguousarray(image[..., c])
                for c, name in enumerate("RGB")}
    channels.update(layers or {})
    with OpenEXR.File(HEADER, channels) as file:
        file.write(path)


def read(path, prefix=""):
    """Reads the channels R, G, B of an image or of a layer: read(path, "Variance.")."""
    with OpenEXR.File(path, separate_channels=True) as file:
        channels = file.channels()
        return np.stack([np.array(channels[prefix + c].pixels, np.float64) for c in "RGB"], -1)


def read_channel(path, name):
    with OpenEXR.File(path, separate_channels=True) as file:
        return np.array(file.channels()[name].pixels, np.float64)


def finish(path, image, samples, cpu, wall):
    """Writes an image, and reports samples and times to the caller, which reads the last line."""
    write(path, np.float32(image))
    print(json.dumps({"samples": samples, "cpu": cpu, "wall": wall}), flush=True)
