"""Measures the cost in time and memory of a render over Ray, relative to the same render without it.

    python3 tools/bench_ray                     both tables, in Markdown; some minutes
    python3 tools/bench_ray --only time         one of them
    python3 tools/bench_ray --rounds 5 --seconds 60

Needs the Python package with Ray: pip install '.[ray]'. Both renders have the same passes, and must
have the same bits; they take turns, and ratios are of the same round. The cluster is there before;
its actors are started anew for each render, which is part of its time. The driver's memory is
measured in a process of its own, with many films of 64 MiB that are rendered in no time.
"""

import argparse
import os
import resource
import statistics
import subprocess
import sys
import time
import warnings

import ray

import bidir
import bidir.ray

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

import harness

SCENE = harness.ROOT / "scenes" / "room-indirect.pbrt"
#: Pixels of a film of 64 MiB: 144 bytes each.
WIDE, HIGH = 720, 648
SKY = 'Film "rgb" "integer xresolution" {} "integer yresolution" {}\nWorldBegin\nLightSource "infinite"\n'


def arguments():
    """Read the command line."""
    parser = harness.parser("bench_ray", __doc__)
    add = parser.add_argument
    add("--only", choices=["time", "memory"], help="one table")
    add("--rounds", type=int, default=3, help="renders of each kind [%(default)s]")
    add("--seconds", type=float, default=60.0, help="of each render, about [%(default)s]")
    add("--task", type=float, default=10.0, help="seconds of a task [%(default)s]")
    add("--parts", type=int, default=64, help="films of 64 MiB [%(default)s]")
    add("--driver", action="store_true", help=argparse.SUPPRESS)
    return parser.parse_args()


def timed(render):
    """Return what a function returns, and how many seconds it took."""
    begin = time.perf_counter()
    image = render()
    return image, time.perf_counter() - begin


def times(args):
    """Print the time of both kinds of renders."""
    scene = bidir.load(SCENE)
    settings = bidir.Bdpt()
    _, first = timed(lambda: bidir.render(scene, settings, spp=2))
    spp = max(4, round(args.seconds / first * 2))
    # By default Ray's workers have a low priority, so that other processes would affect the measurement.
    even = {"worker_niceness": 0}
    ray.init(address="local", include_dashboard=False, log_to_driver=False, _system_config=even)
    rows, ratios = [], []
    for number in range(1, args.rounds + 1):
        local, seconds = timed(lambda: bidir.render(scene, settings, spp=spp))
        cluster, longer = timed(lambda: bidir.ray.render(scene, settings, spp=spp, task_seconds=args.task))
        if cluster.film != local.film:
            sys.exit("the films differ")
        ratios.append(longer / seconds)
        rows.append([number, f"{seconds:.1f} s", f"{longer:.1f} s", f"{ratios[-1]:.3f}"])
    ray.shutdown()
    width, height = scene.size
    print(f"room-indirect, {width} x {height}, {spp} samples per pixel, tasks of {args.task:g} s, bdpt:\n")
    rows.append(["median", "", "", f"{statistics.median(ratios):.3f}"])
    print(harness.table(["Round", "local", "Ray", "ratio"], rows) + "\n")


def mebibytes():
    """Return the most memory that this process had so far. Unit: MiB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * harness.RSS_UNIT / (1 << 20)


def driver(args):
    """Render films of 64 MiB, and print how much memory this process took for them."""
    scene = bidir.from_text(SKY.format(WIDE, HIGH))
    ray.init(address="local", include_dashboard=False, log_to_driver=False)
    before = mebibytes()
    # A task is a pass: every part is a film.
    image = bidir.ray.render(scene, bidir.Path(), spp=args.parts, task_seconds=1e-3)
    after = mebibytes()
    ray.shutdown()
    assert image.film.spp == args.parts
    print(f"{before:.0f} {after:.0f}")


def memory(args):
    """Print how much memory drivers take, for a few films and for many."""
    rows = []
    for parts in (args.parts // 8, args.parts):
        command = [sys.executable, os.path.dirname(__file__), "--driver", "--parts", str(parts)]
        before, after = map(int, subprocess.check_output(command).split())
        rows.append([parts, f"{before} MiB", f"{after} MiB", f"{(after - before) / 64:.1f}"])
    print(f"films of {WIDE} x {HIGH} pixels, 64 MiB each:\n")
    print(harness.table(["Parts", "driver before", "at most", "films more"], rows))


def main():
    """Measure."""
    args = arguments()
    warnings.simplefilter("ignore")
    if args.driver:
        return driver(args)
    if args.only != "memory":
        times(args)
    if args.only != "time":
        memory(args)
    return None


if __name__ == "__main__":
    main()
