"""Install, run, upgrade and purge packages in a root directory: ``try.py ROOT PACKAGE NEWER``, as root.

Those of the gateway are tried with them, which lie beside them.
ROOT is a minimal Debian of the package's release, as debootstrap makes one; nothing outside of it is touched.
"""

import subprocess
import sys
from pathlib import Path

CONFIG = "etc/robotd/robotd.toml"
SHARED = (
    "usr/share/man/man1/robotctl.1.gz",
    "usr/share/man/man1/robotd.1.gz",
    "usr/share/bash-completion/completions/robotctl",
    "usr/share/zsh/vendor-completions/_robotctl",
)
MINE = "# mine\n"


def inside(root: Path, *words: str, code: int = 0) -> str:
    """Run a command in the root directory, which must end with a code, and return what it printed."""
    done = subprocess.run(
        ["chroot", str(root), *words], text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False
    )
    print(f"  {' '.join(words)}: {done.returncode}")
    if done.returncode != code:
        sys.exit(done.stdout)
    return done.stdout


def installed(root: Path, package: Path) -> None:
    """Install a package, and its gateway's, over what is there."""
    both = (package, package.with_name(package.name.replace("robotd_", "robotd-gateway_")))
    for one in both:
        (root / "tmp" / one.name).write_bytes(one.read_bytes())
    inside(root, "dpkg", "--force-confold", "-i", *(f"/tmp/{one.name}" for one in both))


def gateway_tried(root: Path) -> None:
    """Try the gateway: it says that nobody may come in yet, and nothing enabled it."""
    assert "right" in inside(root, "robotd-gateway", "--check")
    assert "robotctl gateway token new" in inside(root, "robotd-gateway", code=78)
    assert "robotd-gateway" in inside(root, "getent", "passwd", "robotd-gateway")
    assert not list((root / "etc/systemd").rglob("*.wants/robotd-gateway.service")), "it opens a port: never by itself"


def gateway_gone(root: Path) -> None:
    """Purge it: the daemon stays, who might come in is forgotten."""
    inside(root, "dpkg", "--purge", "robotd-gateway")
    left = [path for name in ("usr/bin/robotd-gateway", "var/lib/robotd-gateway") if (path := root / name).exists()]
    assert not left, f"left behind: {left}"
    inside(root, "robotctl", "-V")


def main() -> None:
    """Try it; end with what failed."""
    root, package, newer = map(Path, sys.argv[1:])
    installed(root, package)
    print(inside(root, "robotctl", "-V").strip())
    assert "C kernels" in inside(root, "robotctl", "doctor", code=1)  # there are no boards
    assert "good" in inside(root, "robotctl", "config", "check")
    assert "robotd" in inside(root, "getent", "passwd", "robotd")
    assert any((root / "usr/lib/robotd").rglob("robotd/cli/__pycache__/main.*.pyc")), "each start would compile again"
    gateway_tried(root)
    missing = [name for name in SHARED if not (root / name).exists()]
    assert not missing, f"not there: {missing}"
    config = root / CONFIG
    config.write_text(MINE + config.read_text())
    installed(root, newer)
    assert config.read_text().startswith(MINE), "an upgrade must keep the owner's configuration"
    gateway_gone(root)
    kept = root / "var/lib/robotd/maps/office"
    kept.mkdir(parents=True, exist_ok=True)
    inside(root, "dpkg", "--purge", "robotd")
    assert kept.is_dir(), "maps are not the package's"
    kept.rmdir()
    left = [path for name in ("usr/lib/robotd", CONFIG, "usr/bin/robotctl", *SHARED) if (path := root / name).exists()]
    assert not left, f"left behind: {left}"
    print("installed, run, upgraded and purged; the configuration and the maps were kept")


if __name__ == "__main__":
    main()
