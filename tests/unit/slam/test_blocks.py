import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robotd.slam.blocks import Structure, factored


@settings(max_examples=60, deadline=None)
@given(st.integers(1, 14), st.integers(0, 2**32))
def test_a_sparse_system_is_solved_as_the_dense_one(unknowns: int, seed: int) -> None:
    random = np.random.default_rng(seed)
    pairs = {
        tuple(sorted(pair)) for pair in random.integers(0, unknowns, (2 * unknowns, 2)).tolist() if len({*pair}) > 1
    }
    dense = np.zeros((3 * unknowns, 3 * unknowns))
    for one, other in pairs:
        block = random.normal(size=(3, 6))
        at = [*range(3 * one, 3 * one + 3), *range(3 * other, 3 * other + 3)]
        dense[np.ix_(at, at)] += block.T @ block
    dense += np.eye(3 * unknowns)
    structure = Structure.of(unknowns, [(one, other) for one, other in pairs])
    blocks = dense.reshape(unknowns, 3, unknowns, 3).transpose(0, 2, 1, 3)
    below = np.zeros((structure.below, 3, 3))
    for (row, column), place in structure.places.items():
        below[place] = blocks[row, column]
    right = random.normal(size=(unknowns, 3, 2))
    found = factored(structure, blocks[range(unknowns), range(unknowns)], below).solved(right)
    assert found.reshape(-1, 2) == pytest.approx(np.linalg.solve(dense, right.reshape(-1, 2)), abs=1e-9)


def test_a_chain_fills_nothing_in() -> None:
    assert Structure.of(100, [(at, at + 1) for at in range(99)]).below == 99


def test_a_singular_system_is_refused() -> None:
    with pytest.raises(np.linalg.LinAlgError):
        factored(Structure.of(1, []), np.zeros((1, 3, 3)), np.zeros((0, 3, 3)))
