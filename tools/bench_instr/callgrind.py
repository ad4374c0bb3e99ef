"""Profiles of callgrind: instructions by function."""

import re
from collections import Counter
from typing import NamedTuple

# A cost: its position, one number or more that may be relative, then the count.
COST = re.compile(r"^[+*\-]?\d*(?: [+*\-]?\d*)* (\d+)$")


class Profile(NamedTuple):
    """Instructions by function: its own, and those of the functions that it called."""

    own: Counter
    called: Counter

    def total(self):
        return sum(self.own.values())

    def inclusive(self, name):
        """Own instructions and those of all callees; the function must not be recursive."""
        return self.own[name] + self.called[name]

    def minus(self, other):
        """Returns the additional instructions of this run over another."""
        def difference(a, b):
            return Counter({name: a[name] - b[name] for name in a | b if a[name] != b[name]})
        return Profile(difference(self.own, other.own), difference(self.called, other.called))

    def find(self, pattern):
        """Functions whose names match, without those that the linker merged away."""
        return sorted(name for name in self.own | self.called if re.search(pattern, name))


def parse(lines):
    """The profile in a file of callgrind, whose names may be compressed: `fn=(7) name`, then
    `fn=(7)`. Calls of a function to itself count once, as its own."""
    names, own, called = {}, Counter(), Counter()
    function, callee, is_call = None, None, False
    for line in lines:
        line = line.rstrip("\n")
        if line.startswith("fn="):
            function = _name(line[3:], names)
        elif line.startswith("cfn="):
            callee = _name(line[4:], names)
        elif line.startswith("calls="):
            is_call = True
        else:
            cost = COST.match(line)
            if cost is None or function is None:
                continue
            if not is_call:
                own[function] += int(cost[1])
            elif callee != function:
                called[function] += int(cost[1])
            is_call = False
    return Profile(own, called)


def _name(text, names):
    match = re.match(r"^\((\d+)\)(?: (.*))?$", text)
    if match is None:
        return text
    if match[2] is not None:
        names[match[1]] = match[2]
    return names[match[1]]
