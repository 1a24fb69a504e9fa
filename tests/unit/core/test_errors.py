"""Errors cross processes whole: a pool of workers hands on what went wrong, not that it could not be unpacked."""

import pickle

import pytest

from robotd.core import errors
from robotd.core.errors import ConfigError, ConfigErrors, DeviceError, RobotdError, ServerError

PROBLEM = ConfigError("must be positive", file="robotd.toml", line=3, key="grid.rows")
EVERY = [
    PROBLEM,
    ConfigErrors((PROBLEM, ConfigError("unknown key", key="grid.row"))),
    DeviceError("drive", "bumper", "pressed ahead"),
    DeviceError("drive", "bumper"),
    ServerError("refused", "not now"),
    *(
        kind("what went wrong")
        for kind in vars(errors).values()
        if isinstance(kind, type)
        and issubclass(kind, RobotdError)
        and kind not in {ConfigError, ConfigErrors, DeviceError, ServerError}
    ),
]


@pytest.mark.parametrize("error", EVERY, ids=lambda error: type(error).__name__)
def test_an_error_comes_out_of_another_process_as_it_went_in(error: RobotdError) -> None:
    again = pickle.loads(pickle.dumps(error))
    assert (type(again), str(again)) == (type(error), str(error))
    told = {name: value for name, value in vars(error).items() if name != "problems"}
    assert {name: value for name, value in vars(again).items() if name != "problems"} == told
    assert list(map(str, getattr(again, "problems", ()))) == list(map(str, getattr(error, "problems", ())))
