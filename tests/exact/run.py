"""``make exact``: the exact algorithm at work, measured and drawn, into docs/exact."""

import argparse
import platform
from collections.abc import Iterable, Sequence
from pathlib import Path

from robotd.localization.exact.polygons import edge_count
from robotd.localization.exact.rationals import ARITHMETIC
from tests.exact import growth
from tests.exact.figures import FIGURES
from tests.exact.growth import Growth
from tests.exact.plot import draw_growth, draw_laboratory
from tests.exact.scenes import laboratory

ROOT = Path(__file__).parents[2]
OUT = ROOT / "docs" / "exact"


def main(argv: Sequence[str] | None = None) -> int:
    """Print the tables as they come, and write the page and its pictures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=OUT, metavar="DIR", help="where to write (default: docs/exact)")
    parser.add_argument("--figures-only", action="store_true", help="draw the paper's figures, measure nothing")
    arguments = parser.parse_args(argv)
    out: Path = arguments.out
    out.mkdir(parents=True, exist_ok=True)
    page = [] if arguments.figures_only else _measured(out)
    page += ["", "## The paper's figures, computed"]
    for figure in FIGURES:
        figure.draw(out / f"{figure.name}.png")
        page += ["", f"![{figure.caption}]({figure.name}.png)", "", f"*{figure.caption}*"]
    if not arguments.figures_only:
        (out / "README.md").write_text("\n".join(page) + "\n", encoding="utf-8")
    print(f"robotd: wrote {out}")
    return 0


def _measured(out: Path) -> list[str]:
    """Measure everything, print it as it comes, and return the page."""
    lines = [
        "# The exact algorithm, measured",
        "",
        "Written by `make exact`. What it computes is told in `robotd/localization/exact/`, how to ask it in",
        "`robotctl exact --help`.",
        "",
        f"Python {platform.python_version()}, numbers: {ARITHMETIC}; time of one processor, the least of two runs.",
    ]
    print("\n".join(lines))
    lines += _laboratory(out)
    edges = [row for eps in ("0", "0.05") for row in growth.with_edges(eps)]
    lines += _growth("One reading, more edges", "n", "theorems 3 and 4: (n + s) log n", edges)
    many = [row for eps in ("0", "0.05") for row in growth.with_readings(eps)]
    lines += _growth("More readings on one map", "m", "theorems 5 and 7: (m n^2 + s) log m n", many)
    draw_growth(out / "growth.png", edges, many)
    lines += ["", "![Time against what it should be proportional to](growth.png)"]
    pieces = ((n, count, f"{part:.4f}") for n, count, part in growth.lemma_2_pieces())
    lines += _table("Lemma 2 (i), fig. 12", ("n", "pieces of FP(M, z)", "pieces / n^2"), pieces)
    crossings = ((m, count, f"{part:.4f}") for m, count, part in growth.lemma_2_crossings())
    return lines + _table("Lemma 2 (ii), fig. 13", ("m", "crossings", "crossings / m^2"), crossings)


def _laboratory(out: Path) -> list[str]:
    walls = laboratory()
    rows = [
        (row.eps, row.readings, row.best_rank, row.regions, f"{row.area_m2:.6f}", row.vertices, f"{row.seconds:.2f}")
        for row in growth.in_the_laboratory()
    ]
    names = ("eps [m]", "readings", "best rank", "regions", "area [m2]", "vertices", "time [s]")
    draw_laboratory(out / "laboratory.png", walls)
    lines = _table(f"In the laboratory, {edge_count(walls)} edges", names, rows)
    return [*lines, "", "![Ranks of 24 readings in the laboratory](laboratory.png)"]


def _growth(title: str, size: str, promise: str, rows: Iterable[Growth]) -> list[str]:
    """Return the table of a growth: time over (N + s) log N must not grow, time over the promise neither."""
    names = (size, "eps [m]", "borders N", "vertices", "time [s]", "us / ((N + s) log N)", f"us / ({promise})")
    return _table(title, names, (_growth_row(row) for row in rows))


def _growth_row(row: Growth) -> tuple[object, ...]:
    promised = row.seconds / row.bound * 1e6
    sizes = (row.size, row.eps, row.borders, row.vertices)
    return (*sizes, f"{row.seconds:.3f}", f"{row.constant * 1e6:.1f}", f"{promised:.2f}")


def _table(title: str, names: Sequence[str], rows: Iterable[Iterable[object]]) -> list[str]:
    lines = ["", f"## {title}", "", f"| {' | '.join(names)} |", "|---" * len(names) + "|"]
    print("\n".join(lines))
    for row in rows:
        lines.append(f"| {' | '.join(map(str, row))} |")
        print(lines[-1], flush=True)
    return lines


if __name__ == "__main__":
    raise SystemExit(main())
