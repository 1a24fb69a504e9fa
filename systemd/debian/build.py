"""A Debian package of a wheel, by dpkg-deb alone: ``python3 systemd/debian/build.py WHEEL DIRECTORY``.

The program and all that it needs are in a virtual environment of their own, for Debian's Python of one minor version.
Prints the path of the package. Completions and manuals are those that the wheel brings.
"""

import argparse
import gzip
import shutil
import subprocess
import sys
import tempfile
from email.utils import formatdate
from pathlib import Path

PYTHON = "python3.11"
HOME = "/usr/lib/robotd"
PROGRAMS = ("robotd", "robotctl")
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
_CHANGES = """robotd ({version}) unstable; urgency=medium

  * What changed stands in changelog.gz.

 -- robotd developers <robotd@localhost.invalid>  {date}
"""


def run(*words: object) -> str:
    """Run a command and return what it printed."""
    return subprocess.run([*map(str, words)], check=True, text=True, stdout=subprocess.PIPE).stdout


def program(root: Path, wheel: Path) -> Path:
    """Make the virtual environment; return its Python."""
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
        if script.name not in PROGRAMS:
            script.unlink()
            continue
        _, _, rest = script.read_text().partition("\n")
        script.write_text(f"#!{HOME}/bin/python\n{rest}")
    config = home / "pyvenv.cfg"
    config.write_text(config.read_text().replace(str(home), HOME))
    (root / "usr/bin").mkdir()
    for name in PROGRAMS:
        (root / "usr/bin" / name).symlink_to(f"../lib/robotd/bin/{name}")
    return python


def services(root: Path, python: Path) -> None:
    """Put units, rules, user and configuration where a package has them."""
    run(python, "-m", "robotd.cli.main", "install", "--prefix", HOME, "--root", root)
    for old, new in _MOVED.items():
        (root / new).parent.mkdir(parents=True, exist_ok=True)
        shutil.move(root / old, root / new)
    shutil.rmtree(root / "usr/local")
    shutil.rmtree(root / HOME.lstrip("/") / "share")  # what was in it is in its place now
    for gateway in root.glob("**/*robotd-gateway*"):  # a package of its own
        if "site-packages" not in gateway.parts:
            gateway.unlink()


def documents(root: Path, version: str) -> None:
    """Pack the manuals, and write what Debian wants to be told."""
    made = root / "usr/share"
    for page in (made / "man/man1").glob("*.1"):
        page.with_suffix(".1.gz").write_bytes(gzip.compress(page.read_bytes(), 9, mtime=0))
        page.unlink()
    doc = made / "doc/robotd"
    doc.mkdir(parents=True)
    (doc / "copyright").write_text((HERE / "copyright").read_text())
    (doc / "changelog.Debian.gz").write_bytes(
        gzip.compress(_CHANGES.format(version=version, date=formatdate()).encode(), 9, mtime=0)
    )
    (doc / "changelog.gz").write_bytes(gzip.compress((HERE.parents[1] / "CHANGELOG.md").read_bytes(), 9, mtime=0))
    (made / "lintian/overrides").mkdir(parents=True)
    shutil.copy(HERE / "lintian-overrides", made / "lintian/overrides/robotd")


def control(root: Path, version: str) -> None:
    """Write what dpkg must know."""
    debian = root / "DEBIAN"
    debian.mkdir()
    kib = sum(path.stat().st_size for path in root.rglob("*") if path.is_file() and not path.is_symlink()) // 1024
    told = {"@VERSION@": version, "@ARCHITECTURE@": run("dpkg", "--print-architecture").strip(), "@KIB@": str(kib)}
    text = (HERE / "control").read_text()
    for name, value in told.items():
        text = text.replace(name, value)
    (debian / "control").write_text(text)
    owners = [f"/{path.relative_to(root)}" for path in sorted((root / "etc").rglob("*")) if path.is_file()]
    (debian / "conffiles").write_text("\n".join(owners) + "\n")
    for name in ("postinst", "prerm", "postrm"):
        shutil.copy(HERE / name, debian / name)
        (debian / name).chmod(0o755)


def build(wheel: Path, out: Path, version: str) -> Path:
    """Return the package."""
    with tempfile.TemporaryDirectory() as directory:
        root = Path(directory) / "root"
        root.mkdir()
        root.chmod(0o755)
        python = program(root, wheel)
        services(root, python)
        documents(root, version)
        for cache in root.rglob("__pycache__"):
            shutil.rmtree(cache)
        for path in root.rglob("*"):  # a package has no umask
            if not path.is_symlink():
                path.chmod(0o755 if path.is_dir() or path.stat().st_mode & 0o100 else 0o644)
        for library in root.rglob("*.so*"):
            library.chmod(0o644)
        control(root, version)
        out.mkdir(parents=True, exist_ok=True)
        package = out / f"robotd_{version}.deb"
        run("dpkg-deb", "--root-owner-group", "-Zgzip", "-z1", "--build", root, package)
    return package


def main() -> None:
    """Build it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("wheel", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--revision", default="1")
    arguments = parser.parse_args()
    # What comes before a release is older than it: 0.2.0.dev0 is 0.2.0~dev0 there.
    version = arguments.wheel.name.split("-")[1].replace(".dev", "~dev")
    print(build(arguments.wheel.absolute(), arguments.out.absolute(), f"{version}-{arguments.revision}"))


if __name__ == "__main__":
    main()
