"""``robotctl``: parse the command line, run one verb, turn what it raises into one line and an exit code.

Exit codes: 0 done, 1 failed, 2 wrong usage, 78 wrong configuration, 130 interrupted; those of a verb are in its help.
"""

import argparse
import importlib
import io
import os
import signal
import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

from robotd import __version__
from robotd.cli.exit_codes import BAD_CONFIG, FAILED, INTERRUPTED, OK, WRONG_USAGE
from robotd.cli.usage import Parser, WrongUsage, nearest
from robotd.core.errors import ConfigError, RobotdError

if TYPE_CHECKING:
    from robotd.cli.verb import Verb

WORDS = {
    "status": ("status_and_arming", "show the whole robot in one look"),
    "arm": ("status_and_arming", "allow motion"),
    "disarm": ("status_and_arming", "stop and forbid motion"),
    "stop": ("status_and_arming", "stop now, whatever is under way; it needs arm before it moves again"),
    "clear": ("status_and_arming", "acknowledge latched faults; the robot stays disarmed"),
    "map": ("maps", "make, save, load and look at maps"),
    "explore": ("explore", "map a place without being told where to stop"),
    "localize": ("where", "sweep where it stands and say where that is on the map in use"),
    "resolve": ("where", "find out which of several places it is: look round, drive to where they differ, look again"),
    "pose": ("where", "print the newest pose estimate"),
    "watch": ("where", "print what happens, as it happens, until Ctrl-C"),
    "top": ("top", "show mode, links, pose, mission, sweep and log as they change; keys stop and arm"),
    "plan": ("where", "say by which way a place on the map in use is reached, or why not; nothing moves"),
    "drive-to": ("where", "drive to a place on the map in use, and stand there"),
    "drive": ("hands", "drive straight ahead, or back, by odometry; needs no map"),
    "turn": ("hands", "turn on the spot by odometry; needs no map"),
    "look": ("hands", "point the head"),
    "measure": ("hands", "measure the range where the head points"),
    "scan": ("hands", "take one sweep where it stands, without a map"),
    "calibrate": ("calibrate", "find the robot's own constants by driving and sweeping, and write them down"),
    "sim": ("simulate", "simulate a robot in a room: its three boards, on pseudo-terminals"),
    "fake": ("simulate", "answer as the recorded boards did, on pseudo-terminals: run a fresh daemon on them"),
    "import": ("imports", "make a recorded building of somebody else's log"),
    "record": ("recordings", "record everything that happens to a file"),
    "replay": (
        "recordings",
        "run the daemon again on recorded bytes, and compare every result; exit code 1 if one differs",
    ),
    "export": (
        "exports",
        "write a recording for other programs: a trajectory, a CARMEN log, a bag of ROS, a file for Foxglove",
    ),
    "report": (
        "reports",
        "write what a recorded robot did as one page: map and way, stops, looks round, failures, lines, digests",
    ),
    "eval": ("evaluate", "tell how often localization is right, ambiguous, lost, or sure and wrong on real logs"),
    "config": ("configuration", "check and show configurations"),
    "schema": ("wire_schema", "print every request, reply and event as one JSON Schema, made from the types"),
    "exact": ("exact", "localize on a map of polygons by the exact combinatorial algorithm, without rounding"),
    "gateway": ("gateway", "say who may sign in to the console that robotd-gateway serves"),
    "install": (
        "install",
        "put unit, rules, user, configuration, manuals and completions where they belong; what you changed is kept",
    ),
    "doctor": ("doctor", "say what this installation consists of, which kernels it uses and why, and what it can see"),
    "demo": ("demo", "show the main job, end to end, on a simulated robot"),
}
"""The first words of the command line: the module of `robotd.cli.verbs` with the verbs that begin so, and what they do.

Only that module is imported: half of the verbs need simulation, maps or a configuration, and a ``stop`` must not wait
for what it does not need.
"""


_JSON = {"--json", "--events"}
"""With these, errors are objects, too."""


def verbs_of(word: str) -> "tuple[Verb, ...]":
    """Return the verbs that begin with a word: one, or a family."""
    # By name, so that ``robotctl stop`` loads what stops and nothing else.
    verbs: tuple[Verb, ...] = importlib.import_module(f"robotd.cli.verbs.{WORDS[word][0]}").VERBS
    return tuple(verb for verb in verbs if verb.name.split()[0] == word)


def build_parser(argv: Sequence[str], *, knows_all: bool = False) -> argparse.ArgumentParser:
    """Return a parser that knows every first word, and all about the one on this command line, or about every one."""
    parser = Parser(
        prog="robotctl",
        description="Talk to robotd: missions, maps, poses, recordings, and simulated robots.",
        epilog="robotctl VERB --help tells more, with an example.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("-V", "--version", action="version", version=f"robotctl {__version__}")
    words = _family(parser)
    typed = iter([text for text in argv if not text.startswith("-")])
    wanted = next(typed, None)
    _refuse_unknown(parser, wanted, WORDS)
    for word, (_, summary) in WORDS.items():
        helped = words.add_parser(word, help=summary, formatter_class=parser.formatter_class)
        if knows_all or word == wanted:
            _add_verbs(helped, verbs_of(word), typed)
    return parser


def whole_parser() -> Iterator[tuple[str, argparse.ArgumentParser]]:
    """Yield every verb with its own parser, the program itself first: for manuals, which know all."""
    yield "robotctl", build_parser(())
    for word in WORDS:
        for verb in verbs_of(word):
            parser = Parser(prog="robotctl " + verb.name, formatter_class=argparse.RawDescriptionHelpFormatter)
            verb.add_to(parser)
            yield verb.name, parser


def _add_verbs(
    parser: argparse.ArgumentParser, verbs: "tuple[Verb, ...]", typed: Iterator[str], depth: int = 1
) -> None:
    """Give the parser of some words their verb, or a further word to choose one of the family."""
    families: dict[str, tuple[Verb, ...]] = {}
    for verb in verbs:
        words = verb.name.split()
        if len(words) == depth:
            verb.add_to(parser)
            return
        families[words[depth]] = (*families.get(words[depth], ()), verb)
    _refuse_unknown(parser, next(typed, None), families)
    family = _family(parser)
    for word, kin in families.items():
        summary = kin[0].summary if len(kin) == 1 else ", ".join(verb.name.split()[-1] for verb in kin)
        helped = family.add_parser(word, help=summary, formatter_class=parser.formatter_class)
        _add_verbs(helped, kin, typed if len(kin) > 1 else iter(()), depth + 1)


def _family(parser: argparse.ArgumentParser) -> "argparse._SubParsersAction[argparse.ArgumentParser]":
    """Let a further word choose; without one, what there is to choose from is told."""

    def helped(_: argparse.Namespace) -> int:
        parser.print_help()
        return OK

    parser.set_defaults(run=helped)
    return parser.add_subparsers(metavar="VERB")


def _refuse_unknown(parser: argparse.ArgumentParser, wanted: str | None, known: Iterable[str]) -> None:
    """Refuse a word that no verb begins with, and name the nearest that one does: argparse would list them all."""
    if wanted is not None and wanted not in known:
        parser.error(f"there is no {parser.prog} {wanted}{nearest(wanted, known)} (robotctl --help lists all verbs)")


def main(argv: Sequence[str] | None = None) -> int:
    """Run ``robotctl`` and return its exit code; wrong usage leaves by ``SystemExit(2)``, as argparse does."""
    words = sys.argv[1:] if argv is None else argv
    if isinstance(sys.stdout, io.TextIOWrapper):  # a terminal that lacks a letter gets its number, not a traceback
        sys.stdout.reconfigure(errors="backslashreplace")
    try:
        with _ended_like_interrupted():
            return _run(build_parser(words), words)
    except WrongUsage as wrong:
        sys.stderr.write(wrong.usage)
        _complain(WRONG_USAGE, words, wrong, str(wrong))
        raise
    except ConfigError as error:
        return _complain(BAD_CONFIG, words, error, *map(str, error.problems))
    except RobotdError as error:
        return _complain(FAILED, words, error, f"robotctl: {error}")
    except KeyboardInterrupt:
        return INTERRUPTED
    except BrokenPipeError:  # the reader of our output went away, as `head` does
        # Else the interpreter would complain once more, as it flushes what nobody reads.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return FAILED
    except OSError as error:  # a file that was named on the command line
        line = ": ".join(filter(None, ("robotctl", error.filename, error.strerror or str(error))))
        return _complain(FAILED, words, error, line)


def _run(parser: argparse.ArgumentParser, words: Sequence[str]) -> int:
    arguments = parser.parse_args(words)
    from robotd.cli.inputs import require  # noqa: PLC0415  # help needs none of it
    from robotd.cli.outputs import refuse  # noqa: PLC0415  # as above

    refuse(arguments)
    require(vars(arguments).values())
    code: int = arguments.run(arguments)
    return code


def _complain(code: int, words: Sequence[str], error: BaseException, *lines: str) -> int:
    """Say what went wrong: a line each for people, for programs an object."""
    from robotd.cli.show.terminal import complain, print_json  # noqa: PLC0415  # what starts quickly ends cleanly

    for line in lines:
        complain(line)
    if _JSON & set(words):
        try:
            print_json({"code": _code_of(error), "message": str(error)})
        except OSError:  # as little as the answer can an error be written
            return code
    return code


def _code_of(error: BaseException) -> str:
    """Return the word that programs know an error by: the server's, or that of its class.

    >>> _code_of(ConfigError("unknown key"))
    'config_error'
    """
    given = getattr(error, "code", None)  # a number for what ends the program
    return (
        given
        if isinstance(given, str)
        else "".join(
            f"_{letter.lower()}" if letter.isupper() else letter for letter in type(error).__name__
        ).removeprefix("_")
    )


@contextmanager
def _ended_like_interrupted() -> Iterator[None]:
    """Let SIGTERM, and a terminal that is closed, do what Ctrl-C does: stop the robot first."""
    signals = [one for one in (signal.SIGTERM, signal.SIGHUP) if signal.getsignal(one) is not signal.SIG_IGN]
    before = {one: signal.signal(one, signal.default_int_handler) for one in signals}  # nohup ignores SIGHUP, and may
    try:
        yield
    finally:
        for one, handler in before.items():
            signal.signal(one, handler)


if __name__ == "__main__":
    sys.exit(main())
