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

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.realpath(os.path.join(HERE, "..", ".."))
SCENE = os.path.join(ROOT, "scenes", "room-indirect.pbrt")
#: Pixels of a film of 64 MiB: 144 bytes each.
WIDE, HIGH = 720, 648
SKY = 'Film "rgb" "integer xresolution" {} "integer yresolution" {}\nWorldBegin\nLightSource "infinite"\n'


def arguments():
    """Read the command line."""
    parser = argparse.ArgumentParser(
        prog="tools/bench_ray", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
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
    rows = []
    for _ in range(args.rounds):
        local, seconds = timed(lambda: bidir.render(scene, settings, spp=spp))
        cluster, longer = timed(lambda: bidir.ray.render(scene, settings, spp=spp, task_seconds=args.task))
        if cluster.film != local.film:
            sys.exit("the films differ")
        rows.append((seconds, longer, longer / seconds))
    ray.shutdown()
    width, height = scene.size
    print(f"room-indirect, {width} x {height}, {spp} samples per pixel, tasks of {args.task:g} s, bdpt:\n")
    print("| Round | local | Ray | ratio |\n|---|---:|---:|---:|")
    for number, (seconds, longer, ratio) in enumerate(rows):
        print(f"| {number + 1} | {seconds:.1f} s | {longer:.1f} s | {ratio:.3f} |")
    print(f"| median | | | {statistics.median(ratio for *_, ratio in rows):.3f} |\n")


def mebibytes():
    """Return the most memory that this process had so far. Unit: MiB."""
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (1 << 20 if sys.platform == "darwin" else 1 << 10)


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
    print(f"| {args.parts} | {before:.0f} MiB | {after:.0f} MiB | {(after - before) / 64:.1f} |")


def memory(args):
    """Print how much memory drivers take, for a few films and for many."""
    print(f"films of {WIDE} x {HIGH} pixels, 64 MiB each:\n")
    print("| Parts | driver before | at most | films more |\n|---|---:|---:|---:|", flush=True)
    for parts in (args.parts // 8, args.parts):
        command = [sys.executable, HERE, "--driver", "--parts", str(parts)]
        subprocess.run(command, check=True)


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
