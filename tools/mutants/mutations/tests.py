"""The tests that mutants name: a package, a target and a filter.

They are chosen to be the fastest that can notice.
"""

SUITE = "--test suite"
PATH = ("bidir", SUITE, "path_identities::")
RUNNING = ("bidir", SUITE, "running_weights::")


def within(package, target, module=""):
    """Returns a function of a filter, which names the tests of a module that contain it."""
    return lambda filter_: (package, target, module + filter_)


unit = within("bidir", "--lib")
formats = within("bidir-formats", "--lib")
# Tests against known images.
analytic = within("bidir", SUITE, "analytic::")
# Tests of fog and liquids.
media = within("bidir", SUITE, "media::")
# Tests of estimators against each other, on every material and on the torture scenes.
materials = within("bidir", SUITE, "materials::")
estimators = within("bidir-formats", "--test estimators")
# Tests of surfaces whose shading normals are bumped, and of what pixels cover of textures.
relief = within("bidir", SUITE, "relief::")
# Tests of surfaces that are not all there.
coverage = within("bidir-formats", SUITE, "coverage::")
