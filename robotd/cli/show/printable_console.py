"""A console on which foreign text cannot steer the terminal: control characters come out as letters."""

from collections.abc import Iterator

from rich.console import Console, ConsoleOptions, ConsoleRenderable, RenderHook
from rich.segment import Segment

from robotd.core.text import printable_lines

_LONGEST_ESCAPE = len("\\U0010ffff")


class PrintableOnly(RenderHook):
    """Escapes what is printed; colours and movements of the cursor are rich's own, and pass."""

    def process_renderables(self, renderables: list[ConsoleRenderable]) -> list[ConsoleRenderable]:
        """Wrap what is about to be printed."""
        return [_Escaped(renderable) for renderable in renderables]


class _Escaped:
    def __init__(self, renderable: ConsoleRenderable) -> None:
        self._renderable = renderable

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[Segment]:
        for segment in console.render(self._renderable, options):
            text = segment.text
            yield (
                segment
                if segment.control
                else segment._replace(text=printable_lines(text, _LONGEST_ESCAPE * len(text)))
            )
