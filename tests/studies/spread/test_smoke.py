"""``make spread`` has each way answer the same, and a worker that is killed changes nothing of it."""

import pytest

from tests.studies.spread.run import main


@pytest.mark.slow
@pytest.mark.real_clock
def test_a_killed_worker_of_a_cluster_costs_no_answer(capsys: pytest.CaptureFixture[str]) -> None:
    main(["--count", "4", "--only", "Dask, two workers, one killed"])
    assert capsys.readouterr().out.count("| 44, the same |") == 2
