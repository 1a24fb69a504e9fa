"""A machine of another kind in a directory: Debian's Python for aarch64, wheels for it, and qemu as its processor."""

import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

CPU = "cortex-a72"
"""Of a Raspberry Pi 4."""
_PLATFORMS = ("manylinux_2_28_aarch64", "manylinux_2_17_aarch64", "manylinux2014_aarch64", "linux_aarch64")
_PACKAGES = ("python3.11", "libpython3.11-dev", "libstdc++6")
"""To run, to compile against, and what NumPy wants beside."""
_TOOLS = ("pytest", "pytest-timeout", "hypothesis")
"""What the engine's tests need beside what robotd needs."""
_BUILDS = ("setuptools>=77", "cffi>=1.17", "wheel", "shtab>=1.7")
"""Beside what robotd needs, for it writes the manual that goes with it."""


class Machine:
    """What there is of it, each part made once."""

    def __init__(self, directory: Path) -> None:
        self._directory = directory
        self._root = directory / "root"
        self.site = directory / "site"
        """Where its Python finds packages."""

    def prepare(self) -> None:
        """Fetch Debian's Python for it and unpack that; the packages of this machine are left alone.

        Raises:
            CalledProcessError: apt could not fetch it.
        """
        if (self._root / "usr/bin/python3.11").exists():
            return
        apt = self._directory / "apt"
        for place in ("lists/partial", "cache/archives/partial"):
            (apt / place).mkdir(parents=True, exist_ok=True)
        (apt / "status").touch()  # of a machine on which nothing is installed yet
        options = {
            "APT::Architecture": "arm64",
            "APT::Architectures": "arm64",
            "APT::Install-Recommends": "false",
            "APT::Sandbox::User": "",
            "Acquire::Languages": "none",
            "Dir::State::Lists": apt / "lists",
            "Dir::State::status": apt / "status",
            "Dir::Cache": apt / "cache",
        }
        words = [word for name, value in options.items() for word in ("-o", f"{name}={value}")]
        _run("apt-get", "-qq", *words, "update")
        _run("apt-get", "-qq", *words, "install", "--yes", "--download-only", *_PACKAGES)
        for package in sorted((apt / "cache/archives").glob("*.deb")):
            _run("dpkg-deb", "-x", package, self._root)

    def wheel(self, source: Path) -> Path:
        """Build the wheel of robotd for it with the cross compiler, and return it."""
        tools = self._directory / "tools"
        if not (tools / "bin/python").exists():
            _run(sys.executable, "-m", "venv", tools)
            needed = tomllib.loads((source / "pyproject.toml").read_text())["project"]["dependencies"]
            _pip(tools / "bin/python", "install", *_BUILDS, *needed)
        wheels = self._directory / "wheel"
        shutil.rmtree(wheels, ignore_errors=True)
        copy = self._directory / "source"
        shutil.rmtree(copy, ignore_errors=True)
        for name in _listed(source):  # a clean copy: what was compiled here must not get into it
            (copy / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(source / name, copy / name, follow_symlinks=False)
        headers = self._root / "usr/include"
        compiler = "aarch64-linux-gnu-gcc"
        environment = {
            "CC": compiler,
            "LDSHARED": f"{compiler} -shared",
            # Before those of the Python that builds: they say how large the other machine's types are.
            "CFLAGS": f"-I{headers}/python3.11 -I{headers}",
            "_PYTHON_HOST_PLATFORM": "linux-aarch64",
        }
        _pip(tools / "bin/python", "wheel", "--no-deps", "--no-build-isolation", "-w", wheels, copy, **environment)
        (wheel,) = wheels.glob("robotd-*_aarch64.whl")
        return wheel

    def install(self, wheel: Path) -> None:
        """Put the wheel, what it needs, and what its tests need where its Python looks."""
        shutil.rmtree(self.site, ignore_errors=True)
        platforms = [word for platform in _PLATFORMS for word in ("--platform", platform)]
        _pip(
            Path(sys.executable),
            "install",
            *("--target", self.site, "--only-binary", ":all:", "--python-version", "3.11", "--implementation", "cp"),
            *platforms,
            f"{wheel}[interop]",
            *_TOOLS,
        )

    def run(self, *words: object) -> str:
        """Run its Python to the end and return what it printed."""
        done = subprocess.run(
            self._python(*words), env=self._environment(), cwd=self._directory, check=True, stdout=subprocess.PIPE
        )
        return done.stdout.decode()

    def test(self, source: Path, tests: tuple[str, ...]) -> int:
        """Run tests on it, from a copy beside which no package of this machine lies; return pytest's exit code."""
        place = self._directory / "tests"
        shutil.rmtree(place, ignore_errors=True)
        shutil.copytree(source / "tests", place / "tests", ignore=shutil.ignore_patterns("__pycache__"))
        for name in ("pyproject.toml", "docs", "systemd"):
            (place / name).symlink_to(source / name)
        words = ("-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "no:randomly", "-o", "timeout=1200", *tests)
        return subprocess.run(self._python(*words), env=self._environment(), cwd=place, check=False).returncode

    def _python(self, *words: object) -> list[str]:
        python = self._root / "usr/bin/python3.11"
        return ["qemu-aarch64-static", "-cpu", CPU, "-L", str(self._root), str(python), *map(str, words)]

    def _environment(self) -> dict[str, str]:
        return {**os.environ, "PYTHONPATH": str(self.site), "PYTHONDONTWRITEBYTECODE": "1"}


def _listed(source: Path) -> list[str]:
    said = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard"],
        cwd=source,
        check=True,
        capture_output=True,
        text=True,
    ).stdout
    # Links, too: by one of them the package has what lies beside it for systemd.
    return [name for name in said.splitlines() if (source / name).is_file() or (source / name).is_symlink()]


def _pip(python: Path, *words: object, **environment: str) -> None:
    _run(python, "-m", "pip", "--disable-pip-version-check", *words[:1], "-q", *words[1:], **environment)


def _run(*words: object, **environment: str) -> None:
    subprocess.run([*map(str, words)], check=True, env={**os.environ, **environment})
