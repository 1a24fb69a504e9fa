"""Every arithmetic that is installed, for property tests: all that one example draws is of one of them."""

from hypothesis import strategies as st

from robotd.exact.rationals import ARITHMETICS, Rational, rational

arithmetics = st.shared(st.sampled_from(list(ARITHMETICS.values())), key="arithmetic")


def rationals(numbers: st.SearchStrategy[int] | st.SearchStrategy[str]) -> st.SearchStrategy[Rational]:
    """Return a strategy of the same numbers in the example's arithmetic."""
    return st.builds(rational, numbers, arithmetics)
