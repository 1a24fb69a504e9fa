"""``eval``: what its command line takes."""

import argparse
from collections.abc import Callable
from pathlib import Path

from robotd.cli.inputs import input_argument
from robotd.cli.logs import LOG_HELP, RAW_HELP, reading_arguments
from robotd.cli.outputs import EVAL_LINES, PICTURES, STANDARD_OUTPUT, output_argument
from robotd.cli.quantities import positive, whole, within
from robotd.cli.verb import Verb
from robotd.evaluation.cluster import checked_address
from robotd.evaluation.protocol import WORDS as PROTOCOL_WORDS
from robotd.evaluation.protocol import checked_word
from robotd.grid.settings import GridSettings


def _eval(arguments: argparse.Namespace) -> int:
    from robotd.cli.asking import evaluate  # noqa: PLC0415  # the engine
    from robotd.cli.eval_lines import is_standard_output, result_lines  # noqa: PLC0415  # as above
    from robotd.cli.surveys import evaluate_surveys  # noqa: PLC0415  # as above

    if not arguments.slam:
        return evaluate(arguments)
    with result_lines(arguments.json) as say:
        return evaluate_surveys(arguments, say, shows=not is_standard_output(arguments.json))


def _typed(check: Callable[[str], str]) -> Callable[[str], str]:
    """Have argparse say what is wrong with a word."""

    def checked(text: str) -> str:
        try:
            return check(text)
        except ValueError as error:
            raise argparse.ArgumentTypeError(str(error)) from error

    return checked


def _map_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--resolution",
        type=within(GridSettings, "resolution_m"),
        nargs="+",
        default=[0.05],
        metavar="M",
        help="sides of cells of the map [m], each a map of its own (default: 0.05)",
    )
    parser.add_argument(
        "--raise-alpha",
        type=within(GridSettings, "raise_alpha"),
        default=0.5,
        metavar="A",
        help="share of the doubt that a hit leaves (default: 0.5)",
    )
    parser.add_argument(
        "--lower-alpha",
        type=within(GridSettings, "lower_alpha"),
        default=0.9,
        metavar="A",
        help="share of an obstacle that a beam through it leaves (default: 0.9)",
    )
    reading_arguments(parser, range_max_m=30.0)
    parser.add_argument(
        "--clear",
        type=positive,
        default=8.0,
        metavar="M",
        help="how far a beam that met nothing is believed to be free [m] (default: 8)",
    )
    parser.add_argument(
        "--config",
        type=Path,
        metavar="FILE",
        help="take the settings of localization from a configuration of robotd",
    )


def _arguments(parser: argparse.ArgumentParser) -> None:
    input_argument(parser, "log", f"{LOG_HELP}; its poses are the truth", nargs="+", metavar="LOG")
    parser.add_argument("--raw", action="store_true", help=RAW_HELP)
    parser.add_argument(
        "--slam",
        action="store_true",
        help="map each log from its raw odometry, as the daemon maps, and tell how far it is from the relations in the "
        "file beside it (intel.relations beside intel.raw.clf); nothing is sought then",
    )
    parser.add_argument("--cases", type=whole(1), default=100, metavar="N", help="scans to seek (default: 100)")
    parser.add_argument("--seed", type=whole(0), default=0, metavar="N", help="chooses them (default: 0)")
    parser.add_argument(
        "--protocol",
        type=_typed(checked_word),
        action="append",
        metavar="P",
        help=f"how to ask, once for each: {', '.join(PROTOCOL_WORDS)} (default: interleaved)",
    )
    spread = parser.add_mutually_exclusive_group()
    spread.add_argument(
        "--workers", type=whole(1), default=1, metavar="N", help="processes that share the cases (default: 1)"
    )
    spread.add_argument(
        "--scheduler",
        type=_typed(checked_address),
        metavar="WHERE",
        help="share the cases by Dask (extra scale): local:N starts N workers here, tls://HOST[:PORT] is a scheduler "
        "whose workers have this robotd, too; its certificates are those of Dask's configuration",
    )
    _map_arguments(parser)
    output_argument(parser, "--pictures", PICTURES, "draw each case that is not right into a file there")
    parser.add_argument(
        "--resume",
        action="store_true",
        help="go on where the run was ended that wrote the file of --json: what it answered, by the same program and "
        "settings, is not asked again",
    )
    words = "write results to a file as they come, a JSON line each; without a file print them instead of the tables"
    output_argument(parser, "--json", EVAL_LINES, words, nargs="?", const=STANDARD_OUTPUT)


VERBS = (
    Verb(
        "eval",
        "tell how often localization is right, ambiguous, lost, or sure and wrong on real logs",
        "robotctl eval intel.corrected.log.gz --cases 100 --pictures failures",
        _eval,
        _arguments,
        prints_json=False,
    ),
)
