"""``report``: what a recorded robot did, as one page to keep."""

import argparse

from robotd.cli.exit_codes import OK
from robotd.cli.heard import HeardRecording
from robotd.cli.inputs import RECORDING_HELP, input_argument
from robotd.cli.outputs import Kind, output_argument, write
from robotd.cli.show.terminal import out, print_json
from robotd.cli.verb import Verb
from robotd.core.clock import NS_PER_S
from robotd.interop.mission_facts import MissionFacts
from robotd.interop.report_page import Provenance, page

_PAGE = Kind("a report made by robotctl", lambda head: b"<title>Mission report: " in head)


def _report(arguments: argparse.Namespace) -> int:
    from robotd.app.replaying import replay_recording  # noqa: PLC0415  # only here is a daemon needed inside
    from robotd.recording.reader import read  # noqa: PLC0415  # as above

    heard = HeardRecording.of(arguments.file, object)
    replayed = replay_recording(arguments.file)
    source = Provenance(
        name=arguments.file.name,
        recorded_by=replayed.recorded_by,
        began_unix_s=(read(arguments.file).header.started_ns + heard.wall_offset_ns) / NS_PER_S,
        wall_offset_ns=heard.wall_offset_ns,
        duration_s=replayed.duration_s,
        recorded_digest=replayed.recorded_digest,
        replayed_digest=replayed.digest,
        is_whole=replayed.complete,
    )
    facts = MissionFacts.of(heard.events)
    write(arguments.out, page(facts, source).encode())
    if arguments.json:
        print_json({"file": str(arguments.out), "missions": len(facts.missions), "failures": len(facts.failures)})
    else:
        out().print(f"{arguments.out}: {len(facts.missions)} missions, {len(facts.failures)} not done")
    return OK


def _arguments(parser: argparse.ArgumentParser) -> None:
    input_argument(parser, "file", RECORDING_HELP, metavar="RECORDING")
    output_argument(parser, "out", _PAGE, "the page, to be opened in any browser, offline too")


VERBS = (
    Verb(
        "report",
        "write what a recorded robot did as one page: map and way, stops, looks round, failures, lines, digests",
        "robotctl report monday.mcap monday.html",
        _report,
        _arguments,
    ),
)
