"""The tests that mutants name: a package, a target and a filter.

They are chosen to be the fastest that can notice.
"""

SUITE = "--test suite"
PATH = ("bidir", SUITE, "path_identities::")
RUNNING = ("bidir", SUITE, "running_weights::")
ESTIMATORS = "--test estimators"


def unit(filter_):
    """The unit tests of the `bidir` crate whose names contain `filter_`."""
    return ("bidir", "--lib", filter_)


def layers(filter_):
    """Tests of what a film keeps beside the picture."""
    return ("bidir", SUITE, filter_)


def analytic(filter_):
    """Tests against known images."""
    return ("bidir", SUITE, "analytic::" + filter_)


def media(filter_):
    """Tests of fog and liquids."""
    return ("bidir", SUITE, "media::" + filter_)


def materials(filter_):
    """Tests of estimators against each other on every material."""
    return ("bidir", SUITE, "materials::" + filter_)


def relief(filter_):
    """Tests of surfaces whose shading normals are bumped, and of what pixels cover of textures."""
    return ("bidir", SUITE, "relief::" + filter_)


def lab(filter_):
    """The unit tests of the `lab` crate whose names contain `filter_`."""
    return ("bidir-lab", "--lib", filter_)


def experiment(filter_):
    """Tests of experiments as a host runs them."""
    return ("bidir-lab", SUITE, filter_)


def formats(filter_):
    """The unit tests of the `formats` crate whose names contain `filter_`."""
    return ("bidir-formats", "--lib", filter_)


def coverage(filter_):
    """Tests of surfaces that are not all there."""
    return ("bidir-formats", SUITE, f"coverage::{filter_}")


def estimators(filter_):
    """Tests of estimators against each other on the torture scenes."""
    return ("bidir-formats", ESTIMATORS, filter_)
