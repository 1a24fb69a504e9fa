"""The head as a program: bytes of jobs in, bytes of answers out, one at a time, while it shows that it lives.

What comes first are the settings, what is said first is what computes. After that each message begins with a number,
which its answer repeats.
"""

import asyncio
from collections.abc import Sequence

import msgspec

from robotd import __version__
from robotd.children.channel import Channel
from robotd.children.inside import live
from robotd.core.errors import TooLarge
from robotd.grid import kernels
from robotd.head.answering import answer_to
from robotd.head.compute import ThreadCompute
from robotd.head.cores import cores
from robotd.head.desk import Desk
from robotd.head.settings import HeadSettings
from robotd.head.wire import NUMBER, pack_error


async def serve(life: Channel, lanes: Sequence[Channel]) -> None:
    """Do what is asked over the one lane, until the parent hangs up."""
    # Jobs have a thread, so that pings are answered whatever is computed, and who hangs up is heard.
    worker = ThreadCompute()
    tasks = [asyncio.create_task(live(life, __version__)), asyncio.create_task(_work(lanes[0], worker))]
    try:
        done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        for task in done:
            task.result()
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.wait(tasks)
        # The parent has gone: whatever is computed still has no reader.
        worker.abandon()


async def _work(lane: Channel, worker: ThreadCompute) -> None:
    desk = Desk(msgspec.msgpack.decode(await lane.receive(), type=HeadSettings), threads=cores())
    # Said unasked: the log of the daemon then tells by which kernels it computes.
    lane.send(str(kernels.in_use().about).encode())
    while True:
        message = await lane.receive()
        number, job = message[:NUMBER], message[NUMBER:]
        # One job at a time: an answer must not wait behind another, nor two share the desk.
        answer = await worker.run("", answer_to, desk, job)
        # Too large for the channel: who asked must hear so, not wait for what never comes.
        if not lane.send(number, answer):
            lane.send(number, pack_error(TooLarge(f"an answer of {len(answer)} bytes")))
