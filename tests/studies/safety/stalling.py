"""The daemon, with one thing more: on SIGRTMIN its event loop stands still, and says since when on standard output.

For how long [s] may follow the configuration on the command line.
"""

import asyncio
import signal
import sys
import time
from pathlib import Path

from robotd.app.daemon import run
from robotd.config import load
from robotd.core.clock import now_ns, run_counting

STALL_S = 0.4


def _stand_still() -> None:
    print(now_ns(), flush=True)
    until_s = time.monotonic() + (float(sys.argv[2]) if len(sys.argv) > 2 else STALL_S)
    while time.monotonic() < until_s:
        """Compute, and hold the interpreter's lock as computing does."""


async def _main() -> None:
    asyncio.get_running_loop().add_signal_handler(signal.SIGRTMIN, _stand_still)
    await run(load(Path(sys.argv[1])))


if __name__ == "__main__":
    run_counting(_main())
