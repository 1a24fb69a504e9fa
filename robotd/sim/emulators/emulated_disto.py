"""An emulated Leica DISTO or Dimetix DLS-A: the older single letters on top of a laser's physics."""

from robotd.sim.emulators.emulated_dimetix import DimetixEmulator

_LETTERS = {b"g": "g", b"o": "o", b"p": "c"}
_TEMPERATURE = "40..06+00000253"


class DistoEmulator(DimetixEmulator):
    """Does what the newer ones do, says it in other words, and is alone on its line."""

    def _obey(self, typed: bytes, now_us: int) -> None:
        if typed == b"t":
            self._pending = None
            self._say(_TEMPERATURE)
        elif typed in _LETTERS:
            self._do(_LETTERS[typed], now_us)
        elif typed:
            self._say("@E203")

    def _say_distance(self, tenth_mm: int) -> None:
        self._say(f"31..06{tenth_mm:+09d} 51....+00000000")

    def _say(self, text: str) -> None:
        self._said += f"{text}\r\n".encode()
