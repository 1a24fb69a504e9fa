"""Parts of one thing, put together as they come. Pure."""

import hashlib

from robotd.core.errors import MapError


class Parts:
    """What came so far of one thing; the first part of another one takes its place, so one alone is ever held."""

    def __init__(self) -> None:
        self._key: tuple[str, int] | None = None
        self._data = bytearray()

    def take(self, sha256: str, size: int, offset: int, part: bytes) -> bytes | None:
        """Take a part of ``size`` bytes whose digest is ``sha256``; return all of them when this was the last.

        Whatever is wrong, nothing is held afterwards, so that who brings them may begin again.

        Raises:
            MapError: it does not go on where the one before ended, or all together are not what was announced.
        """
        if offset == 0:
            self._key, self._data = (sha256, size), bytearray()
        if (sha256, size) != self._key:
            # Another one began meanwhile, or what held the others has died.
            raise MapError("the parts before this one are gone: begin again, at 0")
        if offset != len(self._data) or offset + len(part) > size:
            held = len(self._data)
            self._forget()
            raise MapError(f"{len(part)} bytes at {offset} of {size} do not go on at {held}: begin again, at 0")
        self._data += part
        if len(self._data) < size:
            return None
        whole = bytes(self._data)
        self._forget()
        if hashlib.sha256(whole).hexdigest() != sha256:
            raise MapError(f"its {size} bytes have another sha256 than was announced: begin again, at 0")
        return whole

    def _forget(self) -> None:
        self._key, self._data = None, bytearray()
