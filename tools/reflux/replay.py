"""A recorded run played to the firmware by a plant that does nothing else (docs/inside/plant-link.md): its readings, and as read-back what was
really applied; what the firmware answers changes nothing. After each tick the values of a block are read at the console. Lockstep: as
fast as the firmware goes, and the same each time."""

from __future__ import annotations

import contextlib
import math
import re
import select
import socket
import struct
import threading
import time
import zlib
from typing import Callable, Iterator

from reflux import launch, recorded_run
from reflux.errors import RunFailed, UserError
from reflux.ports import Port
from reflux.recorded_run import Block, Recorded, is_setting
from reflux.session import Refused, Session

HELLO, PAGE_REQUEST, PAGE, READY, SAMPLE, COMMAND, KEEP_ALIVE = range(1, 8)
PLANT, CONTROLLER, VERSION = 1, 2, 1
GREETING_S, KEEP_ALIVE_S, REPEAT_S = 0.25, 0.4, 0.5
ANSWER_S = 60.0  # of a firmware that is there
FRAME_MOST = 248

# The monitor's means are over one tick then, so that each innovation can be read; its alarms would change nothing but the quality.
WATCH = (("watch", "1"), ("nis", "0"), ("pull", "0"), ("apart", "0"))


def stuff(body: bytes) -> bytes:
    return b"".join(bytes([len(group) + 1]) + group for group in body.split(b"\0")) + b"\0"


def unstuff(piece: bytes) -> bytes:
    groups, at = [], 0
    while at < len(piece):
        if at + piece[at] > len(piece):
            return b""
        groups.append(piece[at + 1 : at + piece[at]])
        at += piece[at]
    return b"\0".join(groups)


class Plant:
    """Keeps the line alive on a thread of its own, whatever the console does meanwhile."""

    def __init__(self, line: socket.socket, recorded: Recorded):
        self.line, self.recorded, self.session = line, recorded, 1
        self.sequence, self.rest, self.frames = 0, b"", list[tuple[int, bytes]]()
        self.sampling, self.lost, self.greeted = False, False, -math.inf
        self.lock, self.over = threading.Lock(), threading.Event()
        self.alive = threading.Thread(target=self._keep_alive, daemon=True)
        self.alive.start()

    def close(self) -> None:
        self.over.set()
        self.alive.join()

    def _keep_alive(self) -> None:
        while not self.over.wait(KEEP_ALIVE_S):
            with contextlib.suppress(OSError):
                self.send(KEEP_ALIVE)

    def send(self, kind: int, payload: bytes = b"") -> None:
        with self.lock:
            body = struct.pack("<BH", kind, self.sequence) + payload
            self.sequence = (self.sequence + 1) & 0xFFFF
            self.line.sendall(stuff(body + struct.pack("<I", zlib.crc32(body))))

    def receive(self, wait_s: float) -> tuple[int, bytes] | None:
        if not self.frames and select.select([self.line], [], [], wait_s)[0]:
            came = self.line.recv(65536)
            if not came:
                raise ConnectionError
            *pieces, self.rest = (self.rest + came).split(b"\0")
            for body in [unstuff(p) for p in pieces if len(p) <= FRAME_MOST]:
                if len(body) >= 7 and zlib.crc32(body[:-4]) == struct.unpack("<I", body[-4:])[0]:
                    self.frames.append((body[0], body[3:-4]))
        return self.frames.pop(0) if self.frames else None

    def greet(self) -> None:
        self.greeted = time.monotonic()
        self.send(HELLO, struct.pack("<BBIBBI24s", VERSION, PLANT, self.session, len(self.recorded.measured), len(self.recorded.driven),
                                     round(self.recorded.tick_s * 1000), b"replay"))

    def page(self, index: int) -> None:
        both = [*self.recorded.measured, *self.recorded.driven]
        if index < len(both):
            c = both[index]
            self.send(PAGE, struct.pack("<BBfff16s12s", index, index >= len(self.recorded.measured), c.lo, c.hi, c.lo, c.name.encode(), c.unit.encode()))

    def sample(self, row: int, died: Callable[[], str | None]) -> None:
        """Sends a sample, again where no answer comes, until it is answered. The firmware's estimators have in a tick what the tick
        before has taken for applied, its read-back: so a sample carries what applies from it on."""
        values = [*self.recorded.readings[row], *((x, 0) for x in self.recorded.applied[row])]
        data = struct.pack("<IQBB", row, round(self.recorded.time_s[row] * 1000), len(self.recorded.measured), len(self.recorded.driven))
        data += b"".join(struct.pack("<fB", x, quality) for x, quality in values)
        self._until(f"the sample at {self.recorded.time_s[row]:g} s", died, data)

    def connect(self, died: Callable[[], str | None]) -> None:
        self._until("the greeting", died, b"")

    def _until(self, what: str, died: Callable[[], str | None], data: bytes) -> None:
        """The command to this sample has come; without one, the session stands."""
        began, last = time.monotonic(), -math.inf
        while data or not self.sampling:
            now = time.monotonic()
            if now - began > ANSWER_S:
                raise RunFailed(f"the firmware did not answer {what} within {ANSWER_S:g} s")
            try:
                if not self.sampling:
                    last = -math.inf
                    if now - self.greeted > GREETING_S:
                        self.greet()
                elif now - last > REPEAT_S:
                    self.send(SAMPLE, data)
                    last = now
                kind, payload = self.receive(0.1) or (0, b"")
            except OSError:
                raise RunFailed(died() or "the firmware closed the plant link") from None
            if kind == COMMAND and self.sampling and payload[:12] == data[:12]:
                return
            self._answer(kind, payload)

    def _answer(self, kind: int, payload: bytes) -> None:
        if kind == HELLO and payload[1:2] == bytes([CONTROLLER]):
            self.lost = self.lost or self.sampling
            self.sampling = False
            self.greet()
        elif kind == PAGE_REQUEST and len(payload) == 1:
            self.page(payload[0])
        elif kind == READY and payload == struct.pack("<I", self.session):
            self.sampling = True


# ---- a replay ----


class Replay:
    """Values of the block after each tick, by their names, NaN where there was none."""

    def __init__(self) -> None:
        self.time_s: list[float] = []
        self.values: dict[str, list[float]] = {}
        self.settings: dict[str, str] = {}
        self.events: list[str] = []

    def add(self, time_s: float, said: list[str]) -> None:
        for line in said:
            name, sign, text = line.strip().partition(" = ")
            if sign:
                column = self.values.setdefault(name, [])
                column += [math.nan] * (len(self.time_s) - len(column))
                try:
                    column.append(float(text))
                except ValueError:
                    column.append(math.nan)
        self.time_s.append(time_s)

    def values_of(self, name: str) -> list[float]:
        column = self.values.get(name, [])
        return [*column, *[math.nan] * (len(self.time_s) - len(column))]


def shifted(of: Recorded, shift: dict[str, float]) -> list[list[tuple[float, int]]]:
    """Readings with something added to some channels."""
    more = [shift.get(c.name, 0.0) for c in of.measured]
    return [[(x + d, quality) for (x, quality), d in zip(row, more)] for row in of.readings]


def play(of: Recorded, block: Block, candidates: dict[str, str], shift: dict[str, float] | None = None,
         show: Callable[[str], None] = lambda text: None) -> Replay:
    """candidates: parameters of the block for this replay. shift: what is added to the readings of a channel, in its unit."""
    out = Replay()
    played = Recorded(**{**of.__dict__, "readings": shifted(of, shift or {})})
    with launch.start("host") as firmware, contextlib.ExitStack() as stack:
        talk = Session(stack.enter_context(contextlib.closing(Port(firmware.console))),
                       aside=lambda line: out.events.append(line) if line.startswith("! ") else None)
        configure(talk, of, block, candidates)
        out.settings = settings(talk, block)
        plant = stack.enter_context(_plant(firmware.link.removeprefix("socket:"), played))
        verbs = list(of.later)
        for row, at in enumerate(of.time_s):
            while verbs and verbs[0][0] <= at:
                with contextlib.suppress(Refused):  # it may have been refused then as well
                    talk.ask(verbs.pop(0)[1])
            if row == 0:
                place_outputs(talk, plant, of, firmware)
            plant.sample(row, firmware.died)
            out.add(at, talk.ask(f"block {block.number}"))
            show(f"{at / 3600:.1f} h of {of.time_s[-1] / 3600:.1f} h")
            if plant.lost:
                raise RunFailed(f"at {at:g} s the firmware heard nothing for 2 s: this computer is too busy; once more")
    return out


@contextlib.contextmanager
def _plant(path: str, of: Recorded) -> Iterator[Plant]:
    """The line has no XON and XOFF, which a console's port would take out."""
    with socket.socket(socket.AF_UNIX) as line:
        line.connect(path)
        plant = Plant(line, of)
        try:
            yield plant
        finally:
            plant.close()


def configure(talk: Session, of: Recorded, block: Block, candidates: dict[str, str]) -> None:
    for text in of.config:
        if not is_setting(text):
            continue
        try:
            talk.ask(text)
        except Refused as error:
            raise UserError(f"the firmware refuses a line of the run's configuration, `{text}`: {error}") from None
    rows = [f"block{block.number}.{name} {value}" for name, value in {**dict(WATCH), **candidates}.items()]
    rows += [f"{name.removesuffix('name')}band 0" for name in recorded_run.settings_of(of.config) if re.fullmatch(r"mv\d+\.name", name)]
    for text in ("begin", *(f"set {row}" for row in rows), "apply"):
        try:
            talk.ask(text)
        except Refused as error:
            raise UserError(f"`{text}`: {error}") from None


def place_outputs(talk: Session, plant: Plant, of: Recorded, firmware: launch.Firmware) -> None:
    """At its first sample a firmware has no read-back yet."""
    plant.connect(firmware.died)
    for channel, x in zip(of.driven, of.applied[0]):
        with contextlib.suppress(Refused):  # limits of the configuration: one tick is off by that
            talk.ask(f"out {of.owner.get(channel.name, channel.name)} {x:.9g}")


def settings(talk: Session, block: Block) -> dict[str, str]:
    """Settings in force, with the defaults."""
    prefix = f"block{block.number}."
    pairs = (line.partition(" = ") for line in talk.ask(f"list {prefix.rstrip('.')}"))
    return {name.strip().removeprefix(prefix): text.split()[0] for name, sign, text in pairs if sign and text.split()}
