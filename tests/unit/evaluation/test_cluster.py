"""A cluster as a schedule: answers in order, no more cases than are under way, and no way to one that is not safe."""

from collections.abc import Iterator
from typing import Any

import pytest

from robotd.core.errors import RobotdError
from robotd.evaluation.cluster import checked_address, over_cluster, spread_over
from robotd.evaluation.schedule import AHEAD

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    dask: Any = pytest.importorskip("distributed")
    with dask.Client(processes=False, n_workers=1, threads_per_worker=1, dashboard_address=None) as client:
        yield client


def double(number: int) -> int:
    return 2 * number


def fails(number: int) -> int:
    raise RobotdError(f"case {number} makes no map")


def test_every_case_is_answered_in_order_and_no_more_are_taken_than_are_under_way(client: Any) -> None:
    taken = []

    def source() -> Iterator[int]:
        for number in range(20):
            taken.append(number)
            yield number

    answers = spread_over(client, double, source())
    assert next(answers) == 0
    assert len(taken) == AHEAD
    assert list(answers) == [2 * number for number in range(1, 20)]


def test_what_a_case_raises_is_raised_here(client: Any) -> None:
    with pytest.raises(RobotdError, match="case 3 makes no map"):
        list(spread_over(client, fails, [3]))


@pytest.mark.parametrize("address", ["local:1", "local:16", "tls://hub", "tls://hub.lab:8786"])
def test_an_address_is_of_this_machine_or_behind_certificates(address: str) -> None:
    assert checked_address(address) == address


@pytest.mark.parametrize(
    "address", ["tcp://hub", "tcp://127.0.0.1:8786", "local:0", "local:", "tls://", "hub", "local:-1", ""]
)
def test_another_is_refused(address: str) -> None:
    with pytest.raises(ValueError, match="expected local:N or tls://HOST, got"):
        checked_address(address)
    if address.startswith("tcp"):
        with pytest.raises(
            ValueError, match="anyone who reaches a scheduler by plain TCP runs programs on its machines"
        ):
            checked_address(address)


def test_without_certificates_nothing_is_sent() -> None:
    with pytest.raises(RobotdError, match="tls://hub: no certificates; name them in the configuration of Dask"):
        list(over_cluster("tls://hub")(double, [1]))
