"""An emulated LightWare LW20 on its ASCII line: it measures all the time, and answers with the newest."""

from firmware_proto.rangefinder_messages import ShotStatus
from robotd.sim.emulators.speaking import SpeakingWhenAsked
from robotd.sim.physics.plant import LaserPlant

_PRODUCT = "p:LW20,1.0,1.0"
_LOST = -1.0


class Lw20Emulator(SpeakingWhenAsked):
    """Fires from power-up, and never answers the first message after it."""

    def __init__(self, plant: LaserPlant) -> None:
        super().__init__()
        self._plant = plant
        self._plant.switch(on=True)
        self._typed = bytearray()
        self._is_awake = False

    def receive(self, data: bytes, now_us: int) -> None:
        """Take bytes from the host."""
        self._typed += data
        while (end := self._typed.find(b"\n")) >= 0:
            typed = bytes(self._typed[:end]).strip()
            del self._typed[: end + 1]
            # The first message after power-up only wakes it.
            if self._is_awake:
                self._obey(typed.decode("ascii", errors="replace"), now_us)
            self._is_awake = True

    def _obey(self, typed: str, now_us: int) -> None:
        if typed == "?P":
            self._say(_PRODUCT)
        elif typed.startswith("?LDF,"):
            answer = self._plant.shoot(now_us)
            distance_m = answer.range_m if answer.status is ShotStatus.OK else _LOST
            self._say(f"ldf,{typed[5:]}:{distance_m:.2f}")
        elif typed in {"#LF,0", "#LF,1"}:
            self._plant.switch(on=typed.endswith("1"))
            self._say(f"lf:{typed[-1]}")
        elif typed.startswith("#LM,"):
            self._say(f"lm:{typed[4:]}")

    def _say(self, text: str) -> None:
        self._said += f"{text}\r\n".encode()
