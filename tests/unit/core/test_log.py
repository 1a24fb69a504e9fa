"""Nobody forges a line of the log, steers the terminal that it is read on, or fills it."""

import io
import logging

import pytest

from robotd.core.log import LONGEST_LINE, MOST_LINES, PrintableFormatter


@pytest.fixture
def written() -> tuple[logging.Logger, io.StringIO]:
    # A logger of its own: the runner would capture the others' lines, and cannot pass on half a letter.
    logger, text = logging.Logger("robotd.test of the log", logging.INFO), io.StringIO()  # noqa: LOG001  # as said
    handler = logging.StreamHandler(text)
    handler.setFormatter(PrintableFormatter("%(levelname)s %(name)s: %(message)s"))
    logger.addHandler(handler)
    return logger, text


@pytest.mark.parametrize(
    "reason",
    [
        "a\nINFO robotd.mission: idle -> driving: all is well",
        "\x1b[2J\x1b[1;1H",
        "\r\x1b[K",
        "\u202egnp",
        "a\x85b\u2028c",
        "\ud800",
    ],
)
def test_foreign_text_is_one_line_or_marked(written: tuple[logging.Logger, io.StringIO], reason: str) -> None:
    logger, text = written
    logger.info("disarmed: %s", reason)
    first, *others = text.getvalue().removesuffix("\n").split("\n")
    assert first.startswith("INFO robotd.test of the log: disarmed: ")
    assert all(line.startswith("  | ") for line in others)
    assert all(line.isprintable() for line in (first, *others))


def fail(words: str) -> None:
    raise ValueError(words)


def test_fifty_thousand_letters_are_cut(written: tuple[logging.Logger, io.StringIO]) -> None:
    logger, text = written
    logger.info("%s", "x" * 50_000)
    logger.info("%s", "\n" * 50_000)
    assert len(text.getvalue()) < 2 * LONGEST_LINE + 10 * MOST_LINES


def test_a_traceback_is_told_with_what_foreign_text_it_quotes_escaped(
    written: tuple[logging.Logger, io.StringIO],
) -> None:
    logger, text = written
    try:
        fail("\x1b[31m\nERROR robotd: forged")
    except ValueError:
        logger.exception("mission %d", 3)
    lines = text.getvalue().removesuffix("\n").split("\n")
    assert lines[0] == "ERROR robotd.test of the log: mission 3"
    assert lines[1] == "  | Traceback (most recent call last):"
    assert lines[-2:] == ["  | ValueError: \\x1b[31m", "  | ERROR robotd: forged"]
