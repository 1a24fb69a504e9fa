"""``python -m robotd.head``: started by the daemon, for the daemon."""

import asyncio
import logging
import os
import sys
from contextlib import suppress

from robotd.children.channel import HungUp
from robotd.children.inside import Birth, adopted
from robotd.core.log import configure

log = logging.getLogger("robotd.head")


async def _main(birth: Birth) -> None:
    from robotd.head.program import serve  # noqa: PLC0415  # NumPy begins threads: they are to be confined, too

    life, lanes = birth.channels()
    await serve(life, lanes)


def main() -> None:
    """Serve until the parent hangs up."""
    birth = adopted(sys.argv[1:])
    configure(*birth.arguments)
    birth.tell(log)
    code = 1
    try:
        with suppress(HungUp):  # over whichever channel is looked at first
            asyncio.run(_main(birth))
        code = 0
    except Exception:
        log.exception("the head ends")
    os._exit(code)  # whatever is computed still: nobody waits for it any more


if __name__ == "__main__":
    main()
