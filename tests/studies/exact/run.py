"""``make exact``: the exact algorithm at work, measured and drawn, into docs/exact."""

import argparse
import platform
from collections.abc import Iterable, Iterator, Sequence
from itertools import chain
from pathlib import Path

from robotd.exact.polygons import edge_count
from robotd.exact.rationals import DEFAULT, name_of
from tests.studies.exact import growth
from tests.studies.exact.figures import FIGURES
from tests.studies.exact.growth import Growth
from tests.studies.exact.plot import draw_growth, draw_laboratory
from tests.studies.exact.scenes import laboratory

ROOT = Path(__file__).parents[3]
OUT = ROOT / "docs" / "exact"
_RADII = ("0", "0.05")
_NAMES = ("n", "m", "eps [m]", "N", "s", "predicates", "predicates / ((N + s) log N)", "time [s]", "us / promise")
_READ = """*N* are the borders that the sweeps are given, *s* the points where borders of several sets meet or cross.
Predicates are all comparisons of points, sides of curves, orders of curves and intersections that were asked, counted:
over (N + s) log N they must not grow. The promise is the theorem's: (n + s) log n for one reading, (m n^2 + s) log m n
for an overlay of several; n^2 is what D and E of one reading may have at worst, and on maps of scattered obstacles they
have far less, so time over it falls with n. It may rise with m: what is spent on s grows with m^2, and here s is small
beside m n^2, so it does not yet show in the promise. The time of one predicate is not the same throughout: it rises by
up to a half from the smallest sweeps to the largest."""


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
        "Written by `make exact`. What it computes is told in `robotd/exact/`, how to ask it in",
        "`robotctl exact --help`.",
        "",
        f"Python {platform.python_version()}, arithmetic: {name_of(DEFAULT)}; time of one processor, the least of two",
        "runs where they are short.",
    ]
    print("\n".join(lines))
    lines += _laboratory(out)
    edges: list[Growth] = []
    single = (growth.with_edges(eps) for eps in _RADII)
    lines += _table("One reading, more edges: theorems 3 and 4", _NAMES, _rows(single, edges))
    many: list[Growth] = []
    overlays = (growth.with_readings(n, eps) for n in (20, 100, 400) for eps in _RADII)
    lines += _table("More readings: theorems 5 and 7", _NAMES, _rows(overlays, many))
    draw_growth(out / "growth.png", edges, many)
    lines += ["", _READ, "", "![Time and s, against what they should be proportional to](growth.png)"]
    pieces = ((n, count, f"{part:.4f}") for n, count, part in growth.lemma_2_pieces())
    lines += _table("Lemma 2 (i), fig. 12", ("n", "pieces of FP(M, z)", "pieces / n^2"), pieces)
    crossings = ((m, count, f"{part:.4f}") for m, count, part in growth.lemma_2_crossings())
    lines += _table("Lemma 2 (ii), fig. 13", ("m", "crossings", "crossings / m^2"), crossings)
    names = ("n", "m", "borders of all FP(M, z)", "borders / m n^2", "crossings", "crossings / m^2 n^2")
    both = ((*row[:3], f"{row[3]:.4f}", row[4], f"{row[5]:.5f}") for row in growth.lemma_2())
    return lines + _table("Lemmas 1 and 2, fig. 13's readings on fig. 12's map", names, both)


def _laboratory(out: Path) -> list[str]:
    walls, _ = laboratory()
    rows = [
        (row.eps, row.readings, row.best_rank, row.regions, f"{row.area_m2:.6f}", row.vertices, f"{row.seconds:.2f}")
        for row in growth.in_the_laboratory()
    ]
    names = ("eps [m]", "readings", "best rank", "regions", "area [m2]", "vertices", "time [s]")
    draw_laboratory(out / "laboratory.png")
    lines = _table(f"In the laboratory, {edge_count(walls)} edges", names, rows)
    speeds = ((name, f"{without:.2f}", f"{within:.2f}") for name, without, within in growth.by_arithmetic())
    lines += _table("The same with every arithmetic", ("module", "time [s], eps 0", "time [s], eps 0.1"), speeds)
    return [*lines, "", "![Ranks of 24 readings in the laboratory](laboratory.png)"]


def _rows(measured: Iterable[Iterable[Growth]], kept: list[Growth]) -> Iterator[tuple[object, ...]]:
    """Yield a table's row for each thing that is measured, at once, and keep it for the picture."""
    for row in chain.from_iterable(measured):
        kept.append(row)
        yield _row(row)


def _row(row: Growth) -> tuple[object, ...]:
    sizes = (row.edges, row.readings, row.eps, row.borders, row.crossings, row.predicates)
    promised = row.seconds / row.promise * 1e6
    return (*sizes, f"{row.predicates / row.work:.2f}", f"{row.seconds:.3f}", f"{promised:.2f}")


def _table(title: str, names: Sequence[str], rows: Iterable[Iterable[object]]) -> list[str]:
    lines = ["", f"## {title}", "", f"| {' | '.join(names)} |", "|---" * len(names) + "|"]
    print("\n".join(lines))
    for row in rows:
        lines.append(f"| {' | '.join(map(str, row))} |")
        print(lines[-1], flush=True)
    return lines


if __name__ == "__main__":
    raise SystemExit(main())
