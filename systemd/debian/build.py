"""Debian packages of a wheel, by dpkg-deb alone: ``python3 systemd/debian/build.py WHEEL DIRECTORY``.

``robotd`` is the daemon; ``robotd-gateway`` is what its console needs beside: the extra's packages in the same
environment, a unit that is never enabled by itself, a user and settings.

The program and all that it needs are in a virtual environment of their own, for Debian's Python of one minor version.
Prints the paths of the packages. Completions and manuals are those that the wheel brings.
"""

import argparse
import gzip
import os
import shutil
import subprocess
import sys
import tempfile
from email.utils import formatdate
from pathlib import Path

PYTHON = "python3.11"
HOME = "/usr/lib/robotd"
PROGRAMS = {"robotd": ("robotd", "robotctl"), "robotd-gateway": ("robotd", "robotctl", "robotd-gateway")}
"""What there is for people to run, of each package and those that it needs."""
HERE = Path(__file__).parent
_MOVED = {
    "etc/systemd/system": "usr/lib/systemd/system",
    "etc/sysusers.d": "usr/lib/sysusers.d",
    "etc/tmpfiles.d": "usr/lib/tmpfiles.d",
    "usr/local/share/man": "usr/share/man",
    "usr/local/share/bash-completion": "usr/share/bash-completion",
    "usr/local/share/zsh/site-functions": "usr/share/zsh/vendor-completions",
}
"""Where a package has what an administrator would put below /etc and /usr/local."""
_CHANGES = """{package} ({version}) unstable; urgency=medium

  * What changed stands in changelog.gz.

 -- robotd developers <robotd@localhost.invalid>  {date}
"""


def run(*words: object) -> str:
    """Run a command and return what it printed."""
    return subprocess.run([*map(str, words)], check=True, text=True, stdout=subprocess.PIPE).stdout


def program(root: Path, wheel: str, programs: tuple[str, ...]) -> Path:
    """Make the virtual environment, with these programs; return its Python."""
    home = root / HOME.lstrip("/")
    run(f"/usr/bin/{PYTHON}", "-m", "venv", "--without-pip", home)
    python = home / "bin" / "python"
    run(
        sys.executable,
        "-m",
        "pip",
        "--python",
        python,
        "install",
        "-q",
        "--no-compile",
        "--disable-pip-version-check",
        wheel,
    )
    for name in ("Activate.ps1", "activate", "activate.csh", "activate.fish"):
        (home / "bin" / name).unlink(missing_ok=True)
    for script in (home / "bin").iterdir():
        if script.is_symlink():
            continue
        if script.name not in programs:
            script.unlink()
            continue
        _, _, rest = script.read_text().partition("\n")
        script.write_text(f"#!{HOME}/bin/python\n{rest}")
    config = home / "pyvenv.cfg"
    config.write_text(config.read_text().replace(str(home), HOME))
    (root / "usr/bin").mkdir()
    for name in programs:
        (root / "usr/bin" / name).symlink_to(f"../lib/robotd/bin/{name}")
    return python


def services(root: Path, python: Path, package: str) -> None:
    """Put units, rules, user and configuration of a package where a package has them."""
    run(python, "-m", "robotd.cli.main", "install", "--prefix", HOME, "--root", root)
    for old, new in _MOVED.items():
        (root / new).parent.mkdir(parents=True, exist_ok=True)
        shutil.move(root / old, root / new)
    shutil.rmtree(root / "usr/local")
    shutil.rmtree(root / HOME.lstrip("/") / "share")  # what was in it is in its place now
    ours = ("etc", "usr/lib/systemd", "usr/lib/sysusers.d", "usr/lib/tmpfiles.d", "usr/share")
    for folder in map(root.joinpath, ours):
        for file in (path for path in folder.rglob("*") if path.is_file()):
            if ("robotd-gateway" in file.name) != (package == "robotd-gateway"):
                file.unlink()


def documents(root: Path, version: str, package: str) -> None:
    """Pack the manuals, and write what Debian wants to be told."""
    made = root / "usr/share"
    for page in (made / "man/man1").glob("*.1"):
        page.with_suffix(".1.gz").write_bytes(gzip.compress(page.read_bytes(), 9, mtime=0))
        page.unlink()
    doc = made / "doc" / package
    doc.mkdir(parents=True)
    (doc / "copyright").write_text((HERE / "copyright").read_text())
    (doc / "changelog.Debian.gz").write_bytes(
        gzip.compress(_CHANGES.format(package=package, version=version, date=formatdate()).encode(), 9, mtime=0)
    )
    (doc / "changelog.gz").write_bytes(gzip.compress((HERE.parents[1] / "CHANGELOG.md").read_bytes(), 9, mtime=0))
    (made / "lintian/overrides").mkdir(parents=True)
    overrides = (HERE / "lintian-overrides").read_text().replace("robotd:", f"{package}:")
    (made / "lintian/overrides" / package).write_text(overrides)


def control(root: Path, version: str, package: str) -> None:
    """Write what dpkg must know."""
    here = HERE if package == "robotd" else HERE / "gateway"
    debian = root / "DEBIAN"
    debian.mkdir()
    kib = sum(path.stat().st_size for path in root.rglob("*") if path.is_file() and not path.is_symlink()) // 1024
    told = {"@VERSION@": version, "@ARCHITECTURE@": run("dpkg", "--print-architecture").strip(), "@KIB@": str(kib)}
    text = (here / "control").read_text()
    for name, value in told.items():
        text = text.replace(name, value)
    (debian / "control").write_text(text)
    owners = [f"/{path.relative_to(root)}" for path in sorted((root / "etc").rglob("*")) if path.is_file()]
    (debian / "conffiles").write_text("\n".join(owners) + "\n")
    for name in ("postinst", "prerm", "postrm"):
        shutil.copy(here / name, debian / name)
        (debian / name).chmod(0o755)


def packed(root: Path, out: Path, version: str, package: str) -> Path:
    """Return the package of a root directory."""
    for path in root.rglob("*"):  # a package has no umask
        if not path.is_symlink():
            path.chmod(0o755 if path.is_dir() or path.stat().st_mode & 0o100 else 0o644)
    for library in root.rglob("*.so*"):
        library.chmod(0o644)
    control(root, version, package)
    out.mkdir(parents=True, exist_ok=True)
    file = out / f"{package}_{version}.deb"
    run("dpkg-deb", "--root-owner-group", "-Zgzip", "-z1", "--build", root, file)
    return file


def without(root: Path, other: Path) -> None:
    """Leave out what another package has."""
    for path in sorted(root.rglob("*"), reverse=True):  # what is in a directory before the directory
        if path.is_dir() and not path.is_symlink():
            if not any(path.iterdir()):
                path.rmdir()
        elif os.path.lexists(other / path.relative_to(root)):
            path.unlink()


def build(wheel: Path, out: Path, version: str) -> list[Path]:
    """Return the packages: the daemon's, and the gateway's."""
    with tempfile.TemporaryDirectory() as directory:
        roots = {package: Path(directory) / package for package in PROGRAMS}
        for package, root in roots.items():
            root.mkdir()
            root.chmod(0o755)
            extra = "" if package == "robotd" else "[gateway]"
            python = program(root, f"{wheel}{extra}", PROGRAMS[package])
            services(root, python, package)
            documents(root, version, package)
            for cache in root.rglob("__pycache__"):
                shutil.rmtree(cache)
        without(roots["robotd-gateway"], roots["robotd"])
        return [packed(root, out, version, package) for package, root in roots.items()]


def main() -> None:
    """Build it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("wheel", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--revision", default="1")
    arguments = parser.parse_args()
    # What comes before a release is older than it: 0.2.0.dev0 is 0.2.0~dev0 there.
    version = arguments.wheel.name.split("-")[1].replace(".dev", "~dev")
    for file in build(arguments.wheel.absolute(), arguments.out.absolute(), f"{version}-{arguments.revision}"):
        print(file)


if __name__ == "__main__":
    main()
