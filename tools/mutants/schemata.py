"""All faults in one build, of which an environment variable chooses one (mutant schemata, [Untch93]).

The body of a function that has faults becomes a `match` on the number of the fault, with one copy of
the body for each of them and the body as it was for all other numbers.
"""

import re

VARIABLE = "MUTANT"

# Appended to the root of a crate. The variable is read once per process.
CHOICE = """
#[doc(hidden)]
pub(crate) fn mutant() -> u32 {
    static NUMBER: std::sync::LazyLock<u32> = std::sync::LazyLock::new(|| {
        std::env::var("%s").ok().and_then(|number| number.parse().ok()).unwrap_or(0)
    });
    *NUMBER
}
""" % VARIABLE

# Comments, strings and characters, whose braces do not count. A lifetime is no character.
OPAQUE = re.compile(
    r"""//[^\n]*|/\*.*?\*/|r(\#*)".*?"\1|b?"(?:\\.|[^"\\])*"|b?'(?:\\[^\n]{1,8}?|[^'\\\n])'""", re.DOTALL
)
FUNCTION = re.compile(r"\bfn\s+\w+")


def blank(text):
    """Replaces comments, strings and characters by spaces of the same length."""
    return OPAQUE.sub(lambda found: re.sub(r"[^\n]", " ", found[0]), text)


def functions(text):
    """(begin of the signature, begin and end of the body, without its braces) of each function."""
    code = blank(text)
    for found in FUNCTION.finditer(code):
        # A semicolon ends a function without a body, but for that of an array's type.
        begin = re.compile(r"[{;](?![^\[\]\n]*\])").search(code, found.end())
        if not begin or begin[0] == ";":
            continue
        depth = 1
        for brace in re.compile(r"[{}]").finditer(code, begin.end()):
            depth += 1 if brace[0] == "{" else -1
            if depth == 0:
                yield found.start(), begin.end(), brace.start()
                break


def body_around(text, begin, end):
    """The body of the innermost function around a place; None where a copy of it would not compile."""
    around = [f for f in functions(text) if f[1] <= begin and end <= f[2]]
    if not around:
        return None
    signature, start, stop = max(around)
    line = text[text.rfind("\n", 0, signature) + 1 : signature]
    # A constant function reads no environment; two bodies have two types behind `impl`.
    if re.search(r"\bconst\b", line) or re.search(r"->\s*impl\b", text[signature:start]):
        return None
    return start, stop


def with_faults(text, faults):
    """The text with faults (number, old, new) to choose from, and the numbers of those it has."""
    bodies = {}
    for number, old, new in faults:
        place = text.index(old)
        body = body_around(text, place, place + len(old))
        if body:
            bodies.setdefault(body, []).append((number, place - body[0], old, new))
    # Faults in nested bodies are left out, as these would be copied with the outer body.
    outer = [b for b in bodies if not any(a[0] <= b[0] and b[1] <= a[1] for a in bodies if a != b)]
    taken = set()
    for begin, end in sorted(outer, reverse=True):
        body, arms = text[begin:end], ""
        for number, place, old, new in bodies[begin, end]:
            faulty = body[:place] + new + body[place + len(old) :]
            arms += "%d => {%s}\n" % (number, faulty)
            taken.add(number)
        text = "%s match crate::mutant() { %s _ => {%s} } %s" % (text[:begin], arms, body, text[end:])
    return text, taken
