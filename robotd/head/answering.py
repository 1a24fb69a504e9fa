"""What a head does, whatever process it is in: bytes of a job in, bytes of its answer out."""

from robotd.head.desk import Desk
from robotd.head.job_table import perform
from robotd.head.wire import pack_answer, pack_error, unpack_job


def answer_to(desk: Desk, data: bytes | memoryview) -> bytes:
    """Do what bytes ask for, and return the answer as bytes; never raises."""
    try:
        # One function for the process and for replays: what a test sees is what the daemon runs.
        return pack_answer(perform(desk, unpack_job(data)))
    except Exception as error:  # whatever it is, who asked must hear of it
        return pack_error(error)
