"""Pictures need an extra; whether it is there is asked before anything else begins."""

import importlib

from robotd.core.errors import RobotdError


def require_plots(what: str) -> None:
    """Load what draws.

    Raises:
        RobotdError: it is not installed; says how to.
    """
    try:
        importlib.import_module("robotd.cli.pictures.sheet")
    except ImportError as error:
        raise RobotdError(
            f"{what} needs matplotlib ({error}): install the extra plots,"
            " pip install 'robotd[plots]', or pip install -e '.[plots]' in a clone"
        ) from error
