"""What is written reads back to the same tree."""

import enum
from dataclasses import dataclass, field

from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.toml.settings_reader import read_text
from robotd.toml.writer import write_table


class Colour(enum.StrEnum):
    RED = "red"
    DARK_BLUE = "dark_blue"


@dataclass(frozen=True, slots=True)
class Leaf:
    size_m: float = 1.0
    name: str = ""
    note: str | None = None


@dataclass(frozen=True, slots=True)
class Branch:
    leaf: Leaf
    on: bool = False
    count: int = 0
    colour: Colour = Colour.RED
    path_m: tuple[tuple[float, float], ...] = ()
    words: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Tree:
    left: Branch
    right: Leaf = field(default_factory=Leaf)


_FLOATS = st.floats(allow_nan=False, allow_infinity=False)
_TEXTS = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), max_size=12)
_LEAVES = st.builds(Leaf, _FLOATS, _TEXTS, st.none() | _TEXTS)
_BRANCHES = st.builds(
    Branch,
    _LEAVES,
    st.booleans(),
    st.integers(-(2**63), 2**63 - 1),
    st.sampled_from(Colour),
    st.lists(st.tuples(_FLOATS, _FLOATS), max_size=3).map(tuple),
    st.lists(_TEXTS, max_size=3).map(tuple),
)


@settings(max_examples=80)
@given(tree=st.builds(Tree, _BRANCHES, _LEAVES))
def test_what_is_written_reads_back(tree: Tree) -> None:
    assert read_text(Tree, write_table(tree), "t.toml") == tree


def test_it_is_written_as_people_write_it() -> None:
    tree = Tree(Branch(Leaf(0.5, "a"), on=True, colour=Colour.DARK_BLUE, path_m=((0.0, 1.5),)))
    assert write_table(tree) == (
        "[left]\non = true\ncount = 0\n"
        'colour = "dark_blue"\npath_m = [[0.0, 1.5]]\nwords = []\n\n'
        '[left.leaf]\nsize_m = 0.5\nname = "a"\n\n[right]\nsize_m = 1.0\nname = ""\n'
    )
