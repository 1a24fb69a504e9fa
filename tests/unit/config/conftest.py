"""No directory of this machine's systemd gets into a configuration."""

import pytest


@pytest.fixture(autouse=True)
def _no_directories_of_systemd(monkeypatch: pytest.MonkeyPatch) -> None:
    for variable in ("ROBOTD_CONFIG", "STATE_DIRECTORY", "RUNTIME_DIRECTORY"):
        monkeypatch.delenv(variable, raising=False)
