"""Pairs of rates, and their table."""

import statistics


class Pair:
    """Samples per second and processor seconds per sample, without clients and with them, measured one
    after the other."""

    def __init__(self, alone, watched):
        self.alone = alone
        self.watched = watched

    def speed(self):
        """Returns the speed with clients relative to that without."""
        return self.watched[0] / self.alone[0]

    def cost(self):
        """Returns the processor time with clients relative to that without."""
        return self.watched[1] / self.alone[1]


def median_interval(values):
    """Returns bounds of the median with a confidence of at least 95 %: order statistics, by the binomial
    distribution of the number of values below the median."""
    ordered = sorted(values)
    count = len(ordered)
    below = 0.0
    rank = 0
    # The probability that at most `rank` of the values are below the median.
    term = 0.5 ** count
    while rank < count // 2 and below + term <= 0.025:
        below += term
        rank += 1
        term *= (count - rank + 1) / rank
    rank = max(rank - 1, 0)
    return ordered[rank], ordered[count - 1 - rank]


def table(pairs, memory, clients):
    """Formats Markdown; `memory` is the server's first, last and largest memory in bytes."""
    first, last, most = ("%.0f MB" % (size / 1e6) for size in memory)
    alone = statistics.median(pair.alone[0] for pair in pairs)
    watched = statistics.median(pair.watched[0] for pair in pairs)
    rows = [
        ("clients, one of which never reads", "0", str(clients)),
        ("samples per second, median", "%.0f k" % (alone / 1e3), "%.0f k" % (watched / 1e3)),
        ("the same of the pair", "1", interval([pair.speed() for pair in pairs])),
        ("processor time of the server for a sample, of the pair", "1",
         interval([pair.cost() for pair in pairs])),
        ("memory of the server: at first; at last, at most", first, "%s, %s" % (last, most)),
    ]
    lines = ["| %d pairs | alone | watched |" % len(pairs), "|---|---:|---:|"]
    return "\n".join(lines + ["| %s | %s | %s |" % row for row in rows])


def interval(ratios):
    """Formats the median with its bounds."""
    return "%.3f (%.3f to %.3f)" % (statistics.median(ratios), *median_interval(ratios))
