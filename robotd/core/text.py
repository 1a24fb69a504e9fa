"""Text of others, made fit for a line of a log or of a terminal. Pure.

What clients and boards say may hold newlines that forge a line of the log, sequences that steer a terminal, marks
that turn the direction of writing round, half a character, or fifty thousand letters. Here each of these becomes
letters, and few.
"""

LONGEST = 200
"""Letters of foreign text in one line, unless somebody says otherwise."""
_CUT = "..."


def printable(text: str, longest: int = LONGEST) -> str:
    r"""Return foreign text as one line of letters that mean nothing but themselves, cut to ``longest``.

    >>> printable("bumper\x1b[2J\nINFO robotd: all is well")
    'bumper\\x1b[2J\\nINFO robotd: all is well'
    >>> printable("a" * 50_000, 10)
    'aaaaaaa...'
    """
    # Cut before anything looks at it: fifty thousand letters cost no more than few. One more shows that it is cut.
    head = text[: longest + 1]
    if not head.isprintable():
        head = "".join(letter if letter.isprintable() else _escaped(letter) for letter in head)
    if len(head) <= longest:
        return head
    return head[: max(0, longest - len(_CUT))] + _CUT[:longest]


def printable_lines(text: str, longest_line: int = 10_000) -> str:
    r"""Return a text of several lines, each :func:`printable`; only ``\n`` begins a new one.

    >>> printable_lines("one\ntwo\x1b[31m")
    'one\ntwo\\x1b[31m'
    """
    return "\n".join(printable(line, longest_line) for line in text.split("\n"))


def printable_bytes(data: bytes, longest: int = LONGEST) -> str:
    r"""Return foreign bytes, which were meant to be text, as :func:`printable` text.

    >>> printable_bytes(b"caf\xc3\xa9 \xff")
    'café \\xff'
    """
    # A letter of UTF-8 has four bytes at most.
    return printable(data[: 4 * longest + 4].decode("utf-8", "backslashreplace"), longest)


def _escaped(letter: str) -> str:
    return letter.encode("unicode_escape").decode("ascii")
