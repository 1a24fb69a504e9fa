"""A library that was compiled from other source is refused when it is loaded, with what differs."""

import importlib
from typing import Any

import pytest

from robotd.grid.kernels.shared.packed_map import TILE_ROWS
from tests.support.kernel_tables import needs_native

pytestmark = needs_native


def library() -> Any:
    return importlib.import_module("robotd.grid.kernels.shared.library")


def test_constants_that_are_the_same_are_no_news() -> None:
    library().agree(TILE_ROWS=TILE_ROWS)


@pytest.mark.parametrize(
    ("constants", "said"),
    [
        ({"TILE_ROWS": TILE_ROWS + 1}, f"TILE_ROWS is {TILE_ROWS} in it, not {TILE_ROWS + 1}"),
        ({"UNHEARD_OF": 3}, "UNHEARD_OF is None in it, not 3"),
    ],
)
def test_a_library_of_other_constants_is_refused(constants: dict[str, int], said: str) -> None:
    with pytest.raises(ImportError, match=said):
        library().agree(**constants)


def test_the_best_instructions_are_some_that_there_are() -> None:
    assert library().instruction_set() in library().INSTRUCTION_SETS
    assert library().instructions_named(None) == -1
    assert [library().instructions_named(name) for name in library().INSTRUCTION_SETS] == [0, 1, 2]
