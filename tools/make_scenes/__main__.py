"""Writes the scenes of furnished rooms: python3 tools/make_scenes [--out FOLDER]

Standard library only; running it again gives the same files byte for byte. The other scenes are text that
people wrote.
"""

import argparse
import os
import sys

sys.dont_write_bytecode = True

import apartment
import room
from writer import Project


def main():
    here = os.path.dirname(os.path.abspath(__file__))
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", default=os.path.join(here, "..", "..", "scenes"))
    project = Project(parser.parse_args().out)
    room.write_all(project)
    apartment.write_all(project)


if __name__ == "__main__":
    main()
