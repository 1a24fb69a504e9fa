"""Duties that belong together: none outlives another, and no error is lost."""

import asyncio

import pytest

from robotd.core.together import ended, together


async def _goes_on(seen: list[str]) -> None:
    try:
        await asyncio.Event().wait()
    finally:
        seen.append("ended")


async def _fails(text: str) -> None:
    raise ValueError(text)


async def test_an_error_of_one_ends_the_others_first() -> None:
    seen: list[str] = []
    with pytest.raises(ValueError, match="the line broke"):
        await together(_goes_on(seen), _fails("the line broke"))
    assert seen == ["ended"]


async def test_what_tasks_raised_by_themselves_is_told_and_being_cancelled_is_not() -> None:
    seen: list[str] = []
    tasks = [asyncio.create_task(_goes_on(seen)), asyncio.create_task(_fails("a mistake"))]
    await asyncio.sleep(0)
    errors = await ended(tasks)
    assert [str(error) for error in errors] == ["a mistake"]
    assert seen == ["ended"]
    assert all(task.done() for task in tasks)
