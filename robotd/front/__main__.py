"""The front as a process: ``python -m robotd.front``, which only the daemon starts."""

import logging
import os
import sys
from typing import NoReturn

from robotd.children.inside import Birth, adopted
from robotd.core.clock import run_counting
from robotd.core.errors import ChildError, RobotdError
from robotd.core.freed_memory import give_back_what_is_large
from robotd.core.garbage import looked_at_once
from robotd.core.log import configure

log = logging.getLogger("robotd.front")


async def _run(birth: Birth) -> None:
    from robotd.front.program import serve_clients  # noqa: PLC0415  # NumPy begins threads: they are to be confined, too

    give_back_what_is_large()
    with looked_at_once():
        await serve_clients(*birth.channels())


def main() -> NoReturn:
    """Serve clients until the daemon hangs up."""
    # Before the heavy imports, which begin threads: what is confined later does not bind those.
    birth = adopted(sys.argv[1:])
    configure(*birth.arguments)
    birth.tell(log)
    code = 1
    try:
        run_counting(_run(birth))
    except ChildError as error:
        log.debug("ending: %s", error)
        code = 0
    except RobotdError as error:  # foreseen, so it needs no traceback
        log.error("%s", error)  # noqa: TRY400  # as above
    except Exception:
        log.exception("the front ends")
    os._exit(code)  # nobody waits for its memory to be cleared up


if __name__ == "__main__":
    main()
