"""The front as a process: ``python -m robotd.front``, which only the daemon starts."""

import logging
import sys

from robotd.children.inside import Birth, adopted
from robotd.core.clock import run_counting
from robotd.core.errors import ChildError, RobotdError
from robotd.core.log import configure

log = logging.getLogger("robotd.front")


async def _run(birth: Birth) -> None:
    from robotd.front.program import serve_clients  # noqa: PLC0415  # NumPy begins threads: they are to be confined, too

    await serve_clients(*birth.channels())


def main() -> int:
    """Serve clients until the daemon hangs up; return the exit code."""
    birth = adopted(sys.argv[1:])
    configure(*birth.arguments)
    birth.tell(log)
    try:
        run_counting(_run(birth))
    except ChildError as error:
        log.debug("ending: %s", error)
    except RobotdError as error:  # foreseen, so it needs no traceback; others end the program with theirs
        log.error("%s", error)  # noqa: TRY400  # as above
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
