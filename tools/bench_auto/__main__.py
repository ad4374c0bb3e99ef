"""Compares the time of `auto` to the same noise with that of the estimators that it chooses from.

    python3 tools/bench_auto                                  the project's own scenes, in Markdown
    python3 tools/bench_auto SCENE.pbrt ... --size 256x144    others, or larger; also folders of scenes
    python3 tools/bench_auto --worlds FOLDER                  scenes of daylight, glass and fog, written there

Needs the Python package: pip install . The figure is the variance of a pixel per sample, relative to the
square of its mean (plus 0.01), times microseconds of a thread per sample: lower is better, and half of it
means half of the time to the same noise. The variance is that between renders with different seeds, without
the noisiest thousandth of the pixels. The figure in brackets is 256 times that of means over blocks of
16 x 16, which is equal if pixels are uncorrelated. `auto` is compared with the best of the others; the
interval holds 90 % of what seeds and blocks, drawn anew, would give. Times are the least of all seeds with
the same plan, without training. Scenes without noise are reported and left out. All estimators must sample
the same light: a scene of which `path` misses some, such as the light of a point light behind glass, allows
no comparison.
"""

import sys
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1]))

import figures
import harness
import measure
import worlds

SCENES = harness.ROOT / "scenes"


def arguments():
    """Read the command line."""
    parser = harness.parser("bench_auto", __doc__)
    add = parser.add_argument
    add("scenes", nargs="*", type=Path, metavar="SCENE", help="files, or folders of them [scenes]")
    add("--worlds", type=Path, metavar="FOLDER", help="write the scenes of worlds.py there, and measure them")
    add("--size", default=(192, 108), type=size, metavar="WxH", help="pixels of each film [192x108]")
    add("--spp", type=int, default=16, help="samples per pixel [%(default)s]")
    add("--seeds", type=int, default=6, help="renders of each estimator, at least 2 [%(default)s]")
    add("--sampler", default="independent", choices=["independent", "sobol"], help="[%(default)s]")
    add("--jobs", type=int, default=1, help="scenes at a time [%(default)s]")
    args = parser.parse_args()
    if args.seeds < 2:
        parser.error("--seeds: a variance needs 2")
    if args.worlds:
        args.worlds.mkdir(parents=True, exist_ok=True)
        args.scenes += worlds.write(args.worlds)
    return args


def size(text):
    """Return width and height."""
    width, height = map(int, text.split("x"))
    return width, height


def scene_files(places):
    """Return the scene files among `places`, and those in its folders."""
    found = []
    for place in places:
        inside = sorted([*place.glob("*.pbrt"), *place.glob("*.gltf"), *place.glob("*.glb")])
        found += inside if place.is_dir() else [place]
    return found


def main():
    """Measure."""
    args = arguments()
    paths = scene_files(args.scenes or [SCENES, SCENES / "torture"])
    rows = []
    try:
        with ProcessPoolExecutor(args.jobs, mp_context=get_context("spawn")) as pool:
            for row in pool.map(measure.measured, paths, [args] * len(paths)):
                if isinstance(row, str):
                    print(row, file=sys.stderr, flush=True)
                else:
                    print(f"{row.scene}: {row.behind():.2f}, {row.plan()}", file=sys.stderr, flush=True)
                    rows.append(row)
    finally:
        # Finished rows are printed even after an error.
        if rows:
            print(figures.table(rows))
    if not rows:
        sys.exit("bench_auto: no scene was measured")


if __name__ == "__main__":
    main()
