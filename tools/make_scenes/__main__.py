"""Writes the project's own scenes: python3 tools/make_scenes [--out FOLDER]

Standard library only; running it again gives the same files byte for byte.
"""

import argparse
import os
import sys

sys.dont_write_bytecode = True

import apartment
import broken
import cornell
import media
import readme
import room
import torture_camera
import torture_materials
import torture_views
import torture_worlds
from writer import Project


def main():
    here = os.path.dirname(os.path.abspath(__file__))
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", default=os.path.join(here, "..", "..", "scenes"))
    project = Project(parser.parse_args().out)
    room.write_all(project)
    apartment.write_all(project)
    cornell.write_all(project)
    media.write_all(project)
    torture_materials.write_all(project)
    torture_camera.write_all(project)
    torture_views.write_all(project)
    torture_worlds.write_all(project)
    broken.write_all(project)
    readme.write(project)
    for path, triangles, title in project.scenes:
        print("%-34s %7d  %s" % (path, triangles, title))


if __name__ == "__main__":
    main()
