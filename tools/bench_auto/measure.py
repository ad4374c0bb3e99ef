"""Renders a scene by each estimator, in a separate process."""

import time
import warnings

import figures
import numpy as np

import bidir

METHODS = {"path": bidir.Path, "bdpt": bidir.Bdpt, "lvc": bidir.Lvc, "auto": bidir.Auto}


def rendered(scene, integrator, seed, spp):
    """Return the pixels, the seconds of a thread that a sample took, and the plan of `auto`, if any."""
    session = bidir.Session(scene, integrator, seed=seed, threads=1)
    begin = time.process_time()
    session.step(spp)
    seconds = time.process_time() - begin
    image = session.snapshot()
    plan = image.film.settings.get("plan")
    return np.asarray(image.pixels, np.float64), seconds / (spp * image.pixels[..., 0].size), plan


def least(runs):
    """Return the seconds of each run: the least of all runs with its plan, as slower ones were disturbed."""
    return np.array([min(other[1] for other in runs if other[2] == run[2]) for run in runs])


def measured(path, args):
    """Return the figures of all estimators in a scene as figures.Row, or a text with the reason why not."""
    warnings.simplefilter("ignore")
    try:
        scene = bidir.load(path, size=args.size)
        runs = {name: [] for name in METHODS}
        # In turns, so that a slow minute of the machine does not meet one estimator alone.
        for seed in range(args.seeds):
            for name, make in METHODS.items():
                runs[name].append(rendered(scene, make(sampler=args.sampler), seed, args.spp))
    except bidir.BidirError as error:
        return f"{path.stem}: left out: {error}"
    images = {name: np.stack([run[0] for run in all_of]) for name, all_of in runs.items()}
    seconds = {name: least(all_of) for name, all_of in runs.items()}
    products = figures.products(images, seconds, args.spp)
    if not all(product.pixels() > 0.0 for product in products.values()):
        return f"{path.stem}: left out: an estimator has no noise"
    return figures.Row(path.stem, products, [run[2] for run in runs["auto"]])
