"""What a calibration leaves unexplained, as a picture (needs the extra ``plots``)."""

import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from robotd.calibration.found import Residuals
from robotd.cli.outputs import PNG, check, write
from robotd.cli.pictures.sheet import ESTIMATE, INK

_SHOWN = {"m": ("mm", 1000.0), "rad": ("deg", 180.0 / np.pi)}


def draw_residuals(file: Path, title: str, residuals: Sequence[Residuals]) -> None:
    """Draw each set of residuals, a point for each, in the order in which they were seen.

    Raises:
        RobotdError: the file cannot be written.
    """
    figure = Figure(figsize=(9.0, 1.2 + 1.6 * len(residuals)), dpi=150, layout="constrained")
    FigureCanvasAgg(figure)
    figure.suptitle(title, color=INK)
    for axes, one in zip(np.atleast_1d(figure.subplots(len(residuals), 1)), residuals, strict=True):
        unit, factor = _SHOWN[one.unit]
        axes.axhline(0.0, color=INK, linewidth=0.8)
        axes.plot(factor * one.values, "o", color=ESTIMATE, markersize=3.0)
        axes.set_ylabel(unit)
        spread = factor * float(np.sqrt((one.values**2).mean()))
        axes.set_title(f"{one.name}: {spread:.2f} {unit} root mean square", fontsize="small", color=INK)
        axes.set_xticks([])
    picture = io.BytesIO()
    figure.savefig(picture, format="png")
    check(file, PNG)
    write(file, picture.getvalue())
