"""Logging for a journal: one line each, time left to the journal when it is there."""

import logging
import os
import sys


def configure(level: str) -> None:
    """Send the log to standard error, with a time stamp only where no journal adds its own."""
    in_journal = "JOURNAL_STREAM" in os.environ
    form = "%(levelname)s %(name)s: %(message)s" if in_journal else "%(asctime)s %(levelname)-7s %(name)s: %(message)s"
    logging.basicConfig(level=level.upper(), format=form, stream=sys.stderr, force=True)
