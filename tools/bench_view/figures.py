"""From pairs of rates to a table."""

import statistics


class Pair:
    """Samples per second without clients and with them, measured one after the other."""

    def __init__(self, alone, watched):
        self.alone = alone
        self.watched = watched

    def ratio(self):
        return self.watched / self.alone


def median_interval(values):
    """Bounds that the median of what is measured is between, with a confidence of 95 % or more: order
    statistics, by the binomial distribution of how many values are below it."""
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
    """Markdown; `memory` is the server's at first, at last and at most, in bytes."""
    ratios = [pair.ratio() for pair in pairs]
    low, high = median_interval(ratios)
    first, last, most = ("%.0f MB" % (size / 1e6) for size in memory)
    alone = statistics.median(pair.alone for pair in pairs)
    watched = statistics.median(pair.watched for pair in pairs)
    rows = [
        ("clients, one of which never reads", "0", str(clients)),
        ("samples per second, median", "%.0f k" % (alone / 1e3), "%.0f k" % (watched / 1e3)),
        ("of the pair, median", "1", "%.3f (%.3f to %.3f)" % (statistics.median(ratios), low, high)),
        ("memory of the server: at first; at last, at most", first, "%s, %s" % (last, most)),
    ]
    lines = ["| %d pairs | alone | watched |" % len(pairs), "|---|---:|---:|"]
    return "\n".join(lines + ["| %s | %s | %s |" % row for row in rows])
