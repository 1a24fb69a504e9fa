"""Random lives of a board: requests, repeats, damage, time that passes, and what its plant does meanwhile."""

import random
from collections import Counter
from collections.abc import Callable, Iterator

from firmware_proto.common import (
    Arm,
    BoardKind,
    Clear,
    Configure,
    Disarm,
    Fault,
    Hello,
    Identify,
    Kill,
    Ping,
    Stop,
)
from firmware_proto.drive_messages import SetVelocity
from firmware_proto.framing import RawFrame, encode_frame
from firmware_proto.pantilt_messages import Aim, ReadAim, ReadLimits
from firmware_proto.rangefinder_messages import SetLaser, Shoot, ShotStatus
from firmware_proto.schema import Message
from tests.studies.firmware.streams import damaged, random_frame

Maker = Callable[[random.Random], Message]


def _sometimes(dice: random.Random, rare: int, usual: int) -> int:
    return rare if dice.random() < 0.05 else usual


_COMMON: tuple[tuple[int, Maker], ...] = (
    (2, lambda dice: Hello(_sometimes(dice, 2, 1), 0, dice.randrange(1 << 32))),
    (4, lambda dice: Ping(dice.randrange(1 << 64))),
    (2, lambda dice: Identify(dice.randrange(3000))),
    (
        4,
        lambda dice: Configure(
            _sometimes(dice, 0, dice.randrange(5, 100)), _sometimes(dice, 0, dice.randrange(10, 2000))
        ),
    ),
    (16, lambda dice: Arm()),
    (1, lambda dice: Disarm()),
    (14, lambda dice: Clear()),
    (1, lambda dice: Stop()),
    (1, lambda dice: Kill()),
)
_OF_KIND: dict[BoardKind, tuple[tuple[int, Maker], ...]] = {
    BoardKind.DRIVE: (
        (12, lambda dice: SetVelocity(0, 0, dice.randrange(1, 2500))),
        (
            20,
            lambda dice: SetVelocity(
                dice.choice([0, 300, dice.randrange(-32768, 32768)]),
                dice.choice([0, -500, dice.randrange(-32768, 32768)]),
                _sometimes(dice, 0, dice.randrange(1, 2500)),
            ),
        ),
    ),
    BoardKind.PANTILT: (
        (
            20,
            lambda dice: Aim(
                dice.choice([-27_001, -27_000, 0, 27_000, 27_001, dice.randrange(-27_000, 27_000)]),
                dice.choice([-8001, -8000, 0, 5000, 5001, dice.randrange(-8000, 5000)]),
                _sometimes(dice, 0, dice.randrange(1, 500)),
            ),
        ),
        (5, lambda dice: ReadAim()),
        (3, lambda dice: ReadLimits()),
    ),
    BoardKind.RANGEFINDER: (
        (10, lambda dice: SetLaser(_sometimes(dice, dice.randrange(256), dice.choice([0, 1, 1, 1])))),
        (20, lambda dice: Shoot(_sometimes(dice, 0, dice.randrange(1, 100)))),
    ),
}


def random_script(kind: BoardKind, seed: int, frames: int) -> str:
    """Return a script with this many frames."""
    return "\n".join(_Life(kind, seed).lines(frames)) + "\n"


class _Life:
    def __init__(self, kind: BoardKind, seed: int) -> None:
        self._kind = kind
        self._dice = random.Random(f"{kind.name} {seed}")
        self._seqs: Counter[int] = Counter()
        self._last = b"\0"
        """The request before, to be said again."""
        self._now_us = self._dice.choice([0, 1_000_000, 1 << 40])
        makers = _COMMON + _OF_KIND[kind]
        self._makers, self._weights = [maker for _, maker in makers], [weight for weight, _ in makers]

    def lines(self, frames: int) -> Iterator[str]:
        yield from self._begin()
        while frames > 0:
            chance = self._dice.random()
            if chance < 0.2:
                yield self._plant()
            elif chance < 0.4:
                yield self._wait()
            elif chance < 0.45:
                yield from self._begin()
            elif chance < 0.455:
                yield f"B {self._dice.randrange(1 << 32)}"
            else:
                count = self._dice.choice([1, 1, 1, 1, 2, 3, 5])
                frames -= count
                yield from self._said(b"".join(self._frame() for _ in range(count)))

    def _begin(self) -> Iterator[str]:
        """Lead the board to where most can happen, mostly."""
        ttl_max_ms = self._dice.choice([200, 200, 3000])
        for request in (Hello(1, 0, 5), Configure(50, ttl_max_ms), Clear(), Arm()):
            yield self._heard(self._wire(request))

    def _frame(self) -> bytes:
        dice = self._dice
        if dice.random() < 0.05:
            return random_frame(dice)
        if dice.random() < 0.15:
            return self._last
        self._last = self._wire(dice.choices(self._makers, self._weights)[0](dice))
        return damaged(dice, self._last) if dice.random() < 0.1 else self._last

    def _wire(self, request: Message) -> bytes:
        """Put a request under the next number of its type, or under the same again, or under any."""
        last = self._seqs[request.TYPE]
        self._seqs[request.TYPE] = self._dice.choice([last, *[(last + 1) % 65536] * 5, self._dice.randrange(65536)])
        return encode_frame(RawFrame(request.TYPE, self._seqs[request.TYPE], request.to_payload()))

    def _said(self, data: bytes) -> Iterator[str]:
        """Deliver bytes at once, or in two pieces with some time between them."""
        if self._dice.random() < 0.8:
            yield self._heard(data)
            return
        cut = self._dice.randrange(len(data) + 1)
        yield self._heard(data[:cut])
        yield self._wait()
        yield self._heard(data[cut:])

    def _heard(self, data: bytes) -> str:
        return f"R {self._now_us} {data.hex()}"

    def _wait(self) -> str:
        longest_us = self._dice.choice([100, 20_000, 80_000, 80_000, 700_000, 1_500_000])
        self._now_us += self._dice.randrange(longest_us)
        return f"A {self._now_us}"

    def _plant(self) -> str:
        dice = self._dice
        match self._kind:
            case BoardKind.DRIVE:
                counts = [dice.randrange(-(1 << 31), 1 << 31) for _ in range(2)]
                speeds = [dice.choice([0, 0, dice.randrange(-32768, 32768)]) for _ in range(2)]
                bumpers = dice.choice([*[0] * 12, 1, 3, dice.randrange(1 << 16)])
                broken = dice.choice([*[Fault.NONE] * 9, Fault.MOTOR, Fault.BATTERY, Fault.MOTOR | Fault.BATTERY])
                numbers = [*counts, *speeds, bumpers, dice.randrange(1 << 16), 0, broken]
            case BoardKind.PANTILT:
                angles = [dice.randrange(-30_000, 30_000), dice.randrange(-9000, 6000)]
                broken = dice.choice([*[Fault.NONE] * 9, Fault.MOTOR])
                numbers = [*angles, dice.randrange(400_000), 0, 0, 0, 0, broken]
            case BoardKind.RANGEFINDER:
                status = dice.choice([ShotStatus.OK, *ShotStatus])
                takes_us = dice.choice([1, 4000, 50_000, dice.randrange(1, 120) * 1000])
                numbers = [dice.randrange(1 << 32), dice.randrange(1 << 16), status, takes_us]
        return "P " + " ".join(str(int(number)) for number in [*numbers, *[0] * (8 - len(numbers))])
