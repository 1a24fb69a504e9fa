"""The head, but every estimate of it holds 32 large regions: the rest of an estimate's way is what is measured."""

from typing import Any

from robotd.head.__main__ import main
from robotd.localization.localizer import Localizer
from tests.studies.lag.workload import large_estimate


def _estimate(_: Localizer, time_ns: int, *, final: bool) -> Any:
    return large_estimate(time_ns, final=final)


if __name__ == "__main__":
    Localizer.estimate = _estimate  # type: ignore[assignment,method-assign]  # as above
    main()
