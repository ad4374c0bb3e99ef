"""EXR files, for the scripts that run in the peers' environment. Images are float arrays of the
shape (height, width, 3), linear Rec. 709, the top row first."""

import json

import numpy as np
import OpenEXR

HEADER = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}


def write(path, image, layers=None):
    """Writes a picture, and layers of one channel each beside it: {channel: (height, width)}."""
    channels = {name: np.ascontiguousarray(image[..., c])
                for c, name in enumerate("RGB")}
    channels.update(layers or {})
    with OpenEXR.File(HEADER, channels) as file:
        file.write(path)


def read(path, prefix=""):
    """The triple of channels R, G, B, or of a layer: read(path, "Variance.")."""
    with OpenEXR.File(path, separate_channels=True) as file:
        channels = file.channels()
        return np.stack([np.array(channels[prefix + c].pixels, np.float64) for c in "RGB"], -1)


def read_channel(path, name):
    with OpenEXR.File(path, separate_channels=True) as file:
        return np.array(file.channels()[name].pixels, np.float64)


def report(samples, cpu, wall):
    """Tells the caller what was done; it is the last line that is looked at."""
    print(json.dumps({"samples": samples, "cpu": cpu, "wall": wall}), flush=True)
