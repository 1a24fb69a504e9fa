"""An emulated head without a motor: nobody ever hears of it."""

from robotd.sim.physics.plant import HeadPlant


class FixedEmulator:
    """Has no line; it keeps the head where it is."""

    def __init__(self, plant: HeadPlant) -> None:
        self._plant = plant

    def receive(self, data: bytes, now_us: int) -> None:
        """Take no notice."""
        self._plant.advance(now_us)

    def advance(self, now_us: int) -> None:
        """Let time pass."""
        self._plant.advance(now_us)

    @property
    def next_event_us(self) -> int | None:
        """Nothing ever happens."""
        return None

    def take_output(self) -> bytes:
        """Return no bytes: a head without a motor says nothing."""
        return b""
