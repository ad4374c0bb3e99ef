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

# A function as rustfmt lays it out: its closing brace has the indentation of its signature. A constant one
# reads no environment, and copies of a body have different types behind `impl`.
FUNCTION = re.compile(
    r"^( *)(?:pub(?:\([^)]*\))? )?fn \w(?:(?!;\n|\bfn |-> impl )[\s\S])*?\{\n(?P<body>[\s\S]*?)^\1\}$", re.MULTILINE
)


def body_around(text, begin, end):
    """Returns the ends of the body of the function around a place; None where there is none to copy."""
    return next((found.span("body") for found in FUNCTION.finditer(text)
                 if found.start("body") <= begin and end <= found.end("body")), None)


def with_faults(text, faults):
    """Returns the text with faults (number, old, new) to choose from."""
    bodies = {}
    for number, old, new in faults:
        place = text.index(old)
        bodies.setdefault(body_around(text, place, place + len(old)), []).append((number, old, new))
    for (begin, end), inside in sorted(bodies.items(), reverse=True):
        body = text[begin:end]
        arms = "".join("%d => {\n%s}\n" % (number, body.replace(old, new)) for number, old, new in inside)
        text = "%smatch crate::mutant() {\n%s_ => {\n%s}\n}\n%s" % (text[:begin], arms, body, text[end:])
    return text
