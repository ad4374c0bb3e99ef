"""``python3 -m bidir.ray experiment``, which ``bidir experiment --ray`` calls."""

from __future__ import annotations

import argparse
import logging
import os
import sys
import warnings

import bidir
import bidir.ray
from bidir import _bidir


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python3 -m bidir.ray", description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    experiment = commands.add_parser("experiment", help="run an experiment over a cluster")
    experiment.add_argument("description", help="the description, a file of TOML")
    experiment.add_argument("-o", "--output", required=True, help="the folder of the results")
    experiment.add_argument("--address", default="auto", help="the cluster: auto, local or HOST:PORT")
    experiment.add_argument("--quick", action="store_true", help="small and coarse")
    experiment.add_argument("--restart", action="store_true", help="begin anew")
    experiment.add_argument("-q", "--quiet", action="store_true", help="no progress")
    return parser.parse_args()


def _say(text: str) -> None:
    print(_bidir.printable(text), file=sys.stderr, flush=True)


def main() -> int:
    """Run the command; return an exit code of ``bidir``."""
    arguments = _arguments()
    logging.basicConfig(format="warning: %(message)s", level=logging.WARNING)
    warnings.showwarning = lambda message, *_rest, **_more: _say(f"warning: {message}")

    def show(part: str, done: int, of: int) -> None:
        if not arguments.quiet:
            _say(f"{done}/{of} {part}")

    try:
        results = bidir.ray.experiment(
            arguments.description,
            arguments.output,
            address=arguments.address,
            quick=arguments.quick,
            restart=arguments.restart,
            progress=show,
        )
    except KeyboardInterrupt:
        _say("stopped: run the same command to continue")
        return 75
    except bidir.ray.ClusterError as error:
        _say(f"error: {error}")
        return 1
    except (bidir.SceneError, bidir.ExperimentError) as error:
        _say(f"error: {error}")
        return 3
    except (bidir.BidirError, OSError, ConnectionError) as error:
        _say(f"error: {error}")
        return 4
    print(results.tables)
    if not arguments.quiet:
        _say(f"wrote {os.path.join(arguments.output, 'report.html')}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
