"""A full collection looks at what is new, and at that once; garbage in rings is found as ever."""

import gc
import weakref

from robotd.core.garbage import looked_at_once


class Ring:
    """Refers to itself."""

    def __init__(self) -> None:
        self.itself = self


def test_what_was_there_and_what_outlived_a_full_collection_is_not_looked_at_again() -> None:
    before = Ring()
    with looked_at_once():
        new = Ring()
        assert not any(one is before for one in gc.get_objects())
        assert any(one is new for one in gc.get_objects())
        gc.collect()
        assert not any(one is new for one in gc.get_objects())
    assert all(any(one is ring for one in gc.get_objects()) for ring in (before, new))


def test_new_garbage_is_found_and_old_objects_are_freed_with_their_last_reference() -> None:
    with looked_at_once():
        gone = weakref.ref(Ring())
        gc.collect()
        assert gone() is None
        old: list[Ring] = [Ring()]
        gc.collect()
        ring = old.pop()
        gone = weakref.ref(ring)
        ring.__dict__.clear()
        del ring
        assert gone() is None
