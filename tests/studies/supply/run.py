"""``make supply``: what an installation of the wheel consists of: as a CycloneDX document, with licences and warnings.

In environments of their own, below ``build/supply``. Ends with 1 where a licence is not allowed, or a vulnerability is
known that a newer version mends.
"""

import json
import subprocess
import sys
from pathlib import Path

from tests.studies.lowest.bounds import EXTRAS
from tests.studies.supply.licences import NOTED, is_allowed, licence_of

ROOT = Path(__file__).parents[3]
BUILD = ROOT / "build" / "supply"
_METADATA = """
import importlib.metadata as m, json
print(json.dumps([
    {"name": d.name, "version": d.version, "expression": d.metadata.get("License-Expression"),
     "classifiers": d.metadata.get_all("Classifier") or [], "text": d.metadata.get("License")}
    for d in m.distributions()]))
"""


def environment(name: str) -> Path:
    """Make an environment, and return its Python."""
    python = BUILD / name / "bin" / "python"
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(BUILD / name)], check=True)
    return python


def install(python: Path, *words: str) -> None:
    """Install into an environment, from outside: its own pip is no part of what is looked at."""
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "--python", str(python)]
    subprocess.run([*pip, "install", "-q", *words], check=True)


def installed_wheel() -> Path:
    """Install the wheel with what a user may ask for; return the Python that has it."""
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check"]
    for old in BUILD.glob("robotd-*.whl"):
        old.unlink()
    subprocess.run([*pip, "wheel", "-q", "--no-deps", "-w", str(BUILD), str(ROOT)], check=True)
    (wheel,) = BUILD.glob("robotd-*.whl")
    python = environment("wheel")
    install(python, "--force-reinstall", f"{wheel}[{','.join(EXTRAS)}]")
    return python


def refused_licences(python: Path) -> list[str]:
    """Print each package with its licence; return those under one that is not allowed."""
    said = subprocess.run([str(python), "-I", "-c", _METADATA], check=True, capture_output=True, text=True).stdout
    refused = []
    for one in sorted(json.loads(said), key=lambda each: str(each["name"]).lower()):
        licence = licence_of(one["expression"], one["classifiers"], one["text"])
        remark = "" if is_allowed(licence) else NOTED.get(one["name"], "not allowed")
        print(f"  {one['name']:24} {one['version']:14} {licence or 'not told'}{f' ({remark})' if remark else ''}")
        refused += [one["name"]] if remark == "not allowed" else []
    return refused


def bill(tools: Path, python: Path) -> None:
    """Write the CycloneDX document."""
    file = BUILD / "robotd.cdx.json"
    words = ["-m", "cyclonedx_py", "environment", str(python), "--output-format", "JSON", "--output-file", str(file)]
    subprocess.run([str(tools), *words], check=True)
    parts = json.loads(file.read_text())["components"]
    print(f"bill of materials: {file.relative_to(ROOT)}, {len(parts)} components")


def audit(tools: Path, python: Path) -> bool:
    """Ask whether vulnerabilities are known; return whether none is, or nobody could be asked, which is said."""
    site = subprocess.run(
        [str(python), "-c", "import sysconfig; print(sysconfig.get_path('purelib'))"],
        check=True,
        capture_output=True,
        text=True,
    ).stdout.strip()
    words = ["-m", "pip_audit", "--path", site, "--progress-spinner", "off", "--format", "json", "--skip-editable"]
    done = subprocess.run([str(tools), *words], capture_output=True, text=True, check=False)
    try:
        parts = json.loads(done.stdout)["dependencies"]
    except (json.JSONDecodeError, KeyError):
        why = (done.stderr.strip().splitlines() or ["no answer"])[-1]
        print(f"pip-audit: nobody could be asked: {why[:200]}")
        return True
    known = [(one, bug) for one in parts for bug in one.get("vulns", ())]
    print(f"pip-audit: {len(parts)} packages, {len(known)} known vulnerabilities")
    for one, bug in known:
        print(
            f"  {one['name']} {one['version']}: {bug['id']}, mended in {', '.join(bug['fix_versions']) or 'no version'}"
        )
    return not any(bug["fix_versions"] for _, bug in known)


def main() -> int:
    """Look at all of it; return 1 if something is wrong."""
    BUILD.mkdir(parents=True, exist_ok=True)
    python = installed_wheel()
    refused = refused_licences(python)
    tools = environment("tools")
    install(tools, "cyclonedx-bom>=7", "pip-audit>=2.9")
    bill(tools, python)
    is_safe = audit(tools, python)
    if refused:
        print(f"not allowed: {', '.join(refused)}", file=sys.stderr)
    return 1 if refused or not is_safe else 0


if __name__ == "__main__":
    sys.exit(main())
