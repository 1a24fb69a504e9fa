"""Pictures as grey values: PGM, PNG and BMP of every depth, read by Pillow within stated bounds."""

import io
import warnings
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image, UnidentifiedImageError

from robotd.core.errors import MapError
from robotd.core.grid_spec import MAX_SIDE_CELLS
from robotd.core.text import printable

FORMATS = ("PPM", "PNG", "BMP")
"""As Pillow calls them; PPM is the family of PGM."""
IMAGE_MAX_BYTES = 2 * MAX_SIDE_CELLS**2 + 4096
"""16 bits a pixel and a header."""


@dataclass(frozen=True, slots=True, eq=False)
class GreyImage:
    """A picture; row 0 is the top."""

    grey: NDArray[np.uint8]
    """``uint8[rows, cols]``: 0 is black."""
    clear: NDArray[np.bool_]
    """``bool[rows, cols]``: where it can be seen through, even a little."""


def decode_grey(data: bytes) -> GreyImage:
    """Return the grey values of a picture; colours as the eye weighs them, 16 bits rounded to 8.

    Raises:
        MapError: it is no such picture, damaged, or larger than any map; says which.
    """
    if len(data) > IMAGE_MAX_BYTES:
        raise MapError(f"it has {len(data)} bytes; a picture of the largest map has {IMAGE_MAX_BYTES}")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # what Pillow thinks large is small for a map; bounds are ours, below
            with Image.open(io.BytesIO(data), formats=FORMATS) as picture:
                if max(picture.size) > MAX_SIDE_CELLS:
                    raise MapError(f"it has {picture.width} x {picture.height} pixels; at most {MAX_SIDE_CELLS} a side")
                return _grey_of(picture)
    except UnidentifiedImageError as error:
        raise MapError("it is no PGM, PNG or BMP picture") from error
    except (OSError, ValueError, SyntaxError, EOFError, ArithmeticError, Image.DecompressionBombError) as error:
        raise MapError(f"the picture is damaged: {printable(str(error)) or type(error).__name__}") from error


def _grey_of(picture: Image.Image) -> GreyImage:
    if picture.mode.startswith("I"):
        deep = np.asarray(picture).astype(np.int64).clip(0, 65535)
        grey = ((deep + 128) // 257).astype(np.uint8)
        return GreyImage(grey, np.zeros(grey.shape, np.bool_))
    if "A" in picture.getbands() or "transparency" in picture.info:
        shown = picture.convert("RGBA")
        clear = np.asarray(shown.getchannel("A")) < 255
        return GreyImage(np.array(shown.convert("RGB").convert("L")), clear)
    grey = np.array(picture.convert("L"))
    return GreyImage(grey, np.zeros(grey.shape, np.bool_))


def encode_png(grey: NDArray[np.uint8], clear: NDArray[np.bool_] | None = None) -> bytes:
    """Return a PNG of ``uint8[rows, cols]``, row 0 at the top; what is ``clear`` can be seen through."""
    picture = Image.fromarray(grey)
    if clear is not None:
        picture.putalpha(Image.fromarray(np.where(clear, np.uint8(0), np.uint8(255))))
    found = io.BytesIO()
    picture.save(found, "PNG")
    return found.getvalue()
