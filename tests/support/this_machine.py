"""What this machine is, for pages that say where their figures are from."""

import platform
from pathlib import Path


def processor() -> str:
    """Return what this machine calls its processor."""
    lines = Path("/proc/cpuinfo").read_text().splitlines() if Path("/proc/cpuinfo").exists() else []
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), platform.machine())
