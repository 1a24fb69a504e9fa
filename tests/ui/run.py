"""``make ui-test``: types and units of the console by Node, then its flows in Chromium."""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from robotd.gateway.web.bundle import HERE, WORKSHOP, build, fetch, is_fresh

ROOT = Path(__file__).parents[2]
TYPES = """{"extends": "%s/tsconfig.json", "compilerOptions": {"paths": {"*": ["./node_modules/*"]}},
"include": ["%s/app/**/*.js", "%s/app/**/*.d.ts"]}"""


def main() -> int:
    """Run all of it; return the first exit code that is not 0."""
    node = fetch(with_tools=True)
    if not is_fresh():
        build()
    (WORKSHOP / "tsconfig.json").write_text(TYPES % (HERE, HERE, HERE), encoding="utf-8")
    print("console: types", flush=True)
    typed = subprocess.run([*node, "node_modules/typescript/bin/tsc", "-p", "."], cwd=WORKSHOP, check=False)
    print("console: units", flush=True)
    with tempfile.TemporaryDirectory() as directory:
        vectors = Path(directory) / "vectors.json"
        subprocess.run([sys.executable, "-m", "tests.web.vectors", str(vectors)], cwd=ROOT, check=True)
        tried = _units(node, vectors, Path(directory))
    if "--no-browser" in sys.argv:
        return typed.returncode or tried
    print("console: flows", flush=True)
    # Mostly they wait for what takes its time, as people do: three go side by side on two processors.
    chosen = ("-o", "python_files=*.py", "-n", "3", "--dist", "worksteal", "tests/ui/flows")
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:randomly", *chosen]
    flown = subprocess.run(command, cwd=ROOT, check=False).returncode
    return typed.returncode or tried or flown


def _units(node: list[str], vectors: Path, directory: Path) -> int:
    program = bundled(ROOT / "tests" / "web" / "console.test.mjs", directory)
    paths = os.environ | {"ROBOTD_VECTORS": str(vectors)}
    return subprocess.run([*node, "--test", str(program)], env=paths, check=False).returncode


def bundled(source: Path, directory: Path) -> Path:
    """Return a program for Node with all that it needs in it, for what others made is not beside its source."""
    out = directory / source.name
    wanted = {
        "entryPoints": [str(source)],
        "outfile": str(out),
        "bundle": True,
        "platform": "node",
        "format": "esm",
        "nodePaths": [str(WORKSHOP / "node_modules")],
        "logLevel": "warning",
        # Modules of the older kind, which ask for those of Node by a function that newer ones do not have.
        "banner": {
            "js": "import { createRequire } from 'node:module'; const require = createRequire(import.meta.url);"
        },
    }
    program = f"import {{ build }} from 'esbuild'; await build({json.dumps(wanted)});"
    subprocess.run([*fetch(with_tools=True), "--input-type=module", "-e", program], cwd=WORKSHOP, check=True)
    return out


if __name__ == "__main__":
    sys.exit(main())
