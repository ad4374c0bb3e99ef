"""Compares bidir with other renderers: error in equal CPU time.

    python3 tools/peers setup [--with-cycles]   installs the peers into an environment of their own
    python3 tools/peers bench                   error in equal CPU time, as tables in Markdown
    python3 tools/peers verify                  checks that all renderers converge to the same image
    python3 tools/peers scenes                  writes the scenes, as PLY and pbrt-v4
    python3 tools/peers reference               renders the references of the scenes anew
    python3 tools/peers check                   checks this tool; needs only bidir

`bench` and `verify` install missing peers; a peer that cannot be installed is left out, with a message.
The exit code is 0 on success, 1 if a renderer failed, if its image differs from the reference or if no
peer could run, and 2 if the command line is wrong.
"""

import os
import sys

sys.dont_write_bytecode = True
sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

import bench as benchmark
import check
import environment
import harness
import neutral
import reference
import renderers
import verify


def arguments():
    parser = harness.parser("peers", __doc__)
    harness.add_program(parser)
    add = parser.add_argument
    add("command", choices=["setup", "bench", "verify", "scenes", "reference", "check"])
    add("--folder", default=str(harness.TARGET / "peers"),
        help="where environment, scenes and images are [%(default)s]")
    add("--with-cycles", action="store_true", help="set up Cycles, too: 0.4 GB more")
    add("--scenes", default=neutral.SCENES, help="[%(default)s]")
    add("--only", default="", metavar="TEXT", help="renderers whose names contain this")
    add("--ours", default=[], action="append", metavar="FLAGS",
        help="a row more: 'path --path-roulette albedo:5'")
    add("--threads", type=int, default=os.cpu_count(), help="of each renderer [%(default)s]")
    add("--seconds", type=float, metavar="CPU",
        help="CPU seconds of a render [bench 8, verify 8, reference 600]")
    add("--repetitions", type=int, help="renders of each [bench 3, verify 8]")
    options = parser.parse_args()
    if not set(options.scenes) <= set(neutral.SCENES):
        parser.error("--scenes: %s are known" % neutral.SCENES)
    return options


def prepare(options):
    """Environment, scenes and the renderers that can run here."""
    place = environment.Environment(os.path.abspath(options.folder))
    packages = environment.PEERS | (environment.CYCLES if options.with_cycles else {})
    if any(not place.has(name) for name in environment.TOOLS | packages):
        environment.set_up(place, packages)
    neutral.write(place.path("scenes"))
    able = []
    for renderer in renderers.all_renderers(options.bidir, place, options.ours):
        if options.only not in renderer.name:
            continue
        problem = renderer.problem(place)
        if problem:
            print("skipped: %s: %s" % (renderer.name, problem), file=sys.stderr)
        else:
            able.append(renderer)
    return benchmark.Bench(place, options.bidir, able, options.scenes, options.threads)


def run_bench(options):
    bench = prepare(options)
    records, failed = benchmark.measure(bench, options.seconds or 8.0, options.repetitions or 3)
    benchmark.save(bench.environment.path("bench.json"), records)
    print(benchmark.machine(bench.environment))
    for scene in bench.scenes:
        print("\n%s\n\n%s" % (benchmark.table(records, scene),
                              benchmark.verdict(records, scene)))
    for name in benchmark.differing(records):
        failed.add(name)
        print("peers: the image is not that of the reference:", name, file=sys.stderr)
    alone = all(renderer.ours for renderer in bench.renderers)
    return 1 if failed or alone else 0


def run_verify(options):
    bench = prepare(options)
    return min(1, verify.verify(bench, options.seconds or 8.0, options.repetitions or 8))


def run(options):
    if options.command == "check":
        return check.check(options.bidir)
    if options.command == "reference":
        return reference.render(prepare(options), options.seconds or 600.0)
    return run_bench(options) if options.command == "bench" else run_verify(options)


def main():
    options = arguments()
    if options.command == "scenes":
        neutral.write(os.path.join(options.folder, "scenes"))
    elif options.command == "setup":
        prepare(options)
    else:
        return harness.main("peers", options, run)
    return 0


if __name__ == "__main__":
    sys.exit(main())
