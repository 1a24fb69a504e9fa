"""``robotctl``: parse the command line, run one verb, turn what it raises into one line and an exit code.

Exit codes: 0 done, 1 failed, 2 wrong usage, 78 wrong configuration, 130 interrupted.
"""

import argparse
import os
import signal
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from rich_argparse import RawDescriptionRichHelpFormatter

from robotd import __version__
from robotd.cli import configuration, control, imports, maps, recordings, simulate, where
from robotd.cli.demo import verbs as demonstrations
from robotd.cli.terminal import complain
from robotd.cli.verb import BAD_CONFIG, FAILED, INTERRUPTED, Verb
from robotd.core.errors import ConfigError, RobotdError

VERBS: tuple[Verb, ...] = (
    *control.VERBS,
    *maps.VERBS,
    *where.VERBS,
    *simulate.VERBS,
    *imports.VERBS,
    *recordings.VERBS,
    *configuration.VERBS,
    *demonstrations.VERBS,
)

FAMILIES = {
    "demo": "show the main job, end to end, on a robot that is not there",
    "config": "check and show configurations",
    "import": "make a recorded building of somebody else's log",
    "map": "make, save, load and look at maps",
    "record": "record everything that happens to a file",
}


def build_parser() -> argparse.ArgumentParser:
    """Return the parser of all verbs."""
    parser = argparse.ArgumentParser(
        prog="robotctl",
        description="Talk to robotd: missions, maps, poses, recordings, and robots that are not there.",
        epilog="robotctl VERB --help tells more, with an example.",
        formatter_class=RawDescriptionRichHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"robotctl {__version__}")
    top = parser.add_subparsers(metavar="VERB", required=True)
    families = {}
    for verb in VERBS:
        family, _, name = verb.name.rpartition(" ")
        if family and family not in families:
            helped = top.add_parser(family, help=FAMILIES[family], formatter_class=parser.formatter_class)
            families[family] = helped.add_subparsers(metavar="VERB", required=True)
        group = families[family] if family else top
        verb.add_to(
            group.add_parser(
                name,
                help=verb.summary,
                description=verb.summary[:1].upper() + verb.summary[1:] + ".",
                epilog=f"Example: {verb.example}",
                formatter_class=parser.formatter_class,
            )
        )
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Run ``robotctl`` and return its exit code; wrong usage leaves by ``SystemExit(2)``, as argparse does."""
    arguments = build_parser().parse_args(argv)
    try:
        with _ended_like_interrupted():
            code: int = arguments.run(arguments)
    except ConfigError as error:
        for problem in error.problems:
            complain(str(problem))
        return BAD_CONFIG
    except RobotdError as error:
        complain(f"robotctl: {error}")
        return FAILED
    except KeyboardInterrupt:
        return INTERRUPTED
    except BrokenPipeError:  # the reader of our output went away, as `head` does
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return FAILED
    except OSError as error:  # a file that was named on the command line
        complain(f"robotctl: {error.filename or ''}: {error.strerror or error}")
        return FAILED
    return code


@contextmanager
def _ended_like_interrupted() -> Iterator[None]:
    """Let SIGTERM do what Ctrl-C does: stop the robot first."""
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


if __name__ == "__main__":
    sys.exit(main())
