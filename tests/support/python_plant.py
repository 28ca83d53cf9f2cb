#!/usr/bin/python3
"""A plant written from docs/inside/plant-link.md alone: two first-order tanks with cross flow, lockstep.

usage: python_plant.py WHERE [SAMPLES]     WHERE: a unix socket to connect to, a serial device (115200 8N1), or a pseudo-terminal
Prints one CSV row a sample; exit status 0 when all samples were answered.
"""
import fcntl, math, os, select, socket, stat, struct, sys, termios, time, tty, zlib

HELLO, PAGE_REQUEST, PAGE, READY, SAMPLE, COMMAND, KEEP_ALIVE = range(1, 8)
NAME, TICK_MS = "python tanks", 10000
#            name   unit    lo    hi   safe
MEASURED = [("T1", "degC", 0.0, 100.0, 0.0), ("T2", "degC", 0.0, 100.0, 0.0)]
DRIVEN = [("u1", "%", 0.0, 100.0, 0.0), ("u2", "%", 0.0, 100.0, 0.0)]
GAIN, TAU_S = [[0.8, 0.3], [0.2, 0.9]], [120.0, 180.0]


def stuff(body):
    return b"".join(bytes([len(g) + 1]) + g for g in body.split(b"\0")) + b"\0"


def unstuff(piece):
    groups, at = [], 0
    while at < len(piece):
        if at + piece[at] > len(piece):
            return b""
        groups.append(piece[at + 1:at + piece[at]])
        at += piece[at]
    return b"\0".join(groups)


def in_use(where):
    """The words of the tools, which take the same lock."""
    sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tools"))
    from reflux import port_lock
    return port_lock.in_use(where)


class Link:
    """Frames over a file descriptor, with keep-alive and silence on this side's own clock."""

    def __init__(self, where):
        if stat.S_ISSOCK(os.stat(where).st_mode):
            self.socket = socket.socket(socket.AF_UNIX)
            self.socket.connect(where)
            self.fd = self.socket.fileno()
        else:
            self.fd = os.open(where, os.O_RDWR | os.O_NOCTTY)
            try:  # two programs on one line would each take a part of what the board says
                fcntl.flock(self.fd, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                raise SystemExit(in_use(where)) from None
            tty.setraw(self.fd)
            line = termios.tcgetattr(self.fd)
            line[4] = line[5] = termios.B115200
            termios.tcsetattr(self.fd, termios.TCSANOW, line)
        self.sequence, self.piece, self.frames = 0, b"", []
        self.sent = self.heard = time.monotonic()

    def send(self, kind, payload=b""):
        body = struct.pack("<BH", kind, self.sequence) + payload
        data = stuff(body + struct.pack("<I", zlib.crc32(body)))
        while data:
            data = data[os.write(self.fd, data):]
        self.sequence = (self.sequence + 1) & 0xFFFF
        self.sent = time.monotonic()

    def receive(self, wait_s):
        """The next good frame as (type, payload), or None after wait_s."""
        if not self.frames and select.select([self.fd], [], [], wait_s)[0]:
            data = os.read(self.fd, 4096)
            if not data:
                raise SystemExit("python_plant: the controller closed the line")
            *pieces, self.piece = (self.piece + data).split(b"\0")
            self.piece = self.piece[:300]  # more than any frame: dropped at its delimiter
            for body in [unstuff(p) for p in pieces if len(p) <= 248]:
                if len(body) >= 7 and zlib.crc32(body[:-4]) == struct.unpack("<I", body[-4:])[0]:
                    self.frames.append((body[0], body[3:-4]))
                    self.heard = time.monotonic()
        if time.monotonic() - self.sent > 0.4:
            self.send(KEEP_ALIVE)
        return self.frames.pop(0) if self.frames else None


class Plant:
    def __init__(self, link):
        self.link, self.session = link, time.time_ns() & 0xFFFFFFFF
        self.y, self.u, self.sampling = [20.0, 20.0], [row[4] for row in DRIVEN], False

    def greet(self):
        self.link.send(HELLO, struct.pack("<BBIBBI24s", 1, 1, self.session, len(MEASURED),
                                          len(DRIVEN), TICK_MS, NAME.encode()))

    def lost(self):
        self.sampling, self.u = False, [row[4] for row in DRIVEN]

    def page(self, index):
        if index < len(MEASURED) + len(DRIVEN):
            name, unit, lo, hi, safe = (MEASURED + DRIVEN)[index]
            self.link.send(PAGE, struct.pack("<BBfff16s12s", index, index >= len(MEASURED), lo, hi,
                                             safe, name.encode(), unit.encode()))

    def exchange(self, wait_s):
        """Takes one frame; returns the payload of a command, else None."""
        kind, payload = self.link.receive(wait_s) or (None, b"")
        if time.monotonic() - self.link.heard > 2.0 and self.sampling:
            self.lost()
        if kind == HELLO and len(payload) >= 2 and payload[1] == 2:
            self.lost()
            self.greet()
            if payload[0] != 1:
                print(f"plant link: the other side speaks version {payload[0]}, this side 1")
        elif kind == PAGE_REQUEST and len(payload) == 1:
            self.page(payload[0])
        elif kind == READY and payload == struct.pack("<I", self.session):
            self.sampling = True
        elif kind == COMMAND and len(payload) == 14 + 5 * len(DRIVEN):
            return payload
        return None

    def sample(self, number, time_ms):
        """Sends a sample, again every 500 ms and after a new greeting, until it is answered."""
        readings = self.y + self.u
        data = struct.pack("<IQBB", number, time_ms, len(self.y), len(self.u))
        data += b"".join(struct.pack("<fB", x, 0) for x in readings)
        last = 0.0
        while True:
            now = time.monotonic()
            if self.sampling and now - last > 0.5:
                self.link.send(SAMPLE, data)
                last = now
            elif not self.sampling:
                last = 0.0
                if now - self.link.sent > 0.25:
                    self.greet()
            command = self.exchange(0.1)
            if command and self.sampling and command[:12] == data[:12]:
                for i, (value, drive) in enumerate(struct.iter_unpack("<fB", command[14:])):
                    if drive:
                        self.u[i] = min(max(value, DRIVEN[i][2]), DRIVEN[i][3])
                return

    def advance(self):
        for i, (gain, tau) in enumerate(zip(GAIN, TAU_S)):
            target = 20.0 + sum(g * u for g, u in zip(gain, self.u))
            self.y[i] = target + (self.y[i] - target) * math.exp(-TICK_MS / 1000.0 / tau)


def main():
    plant = Plant(Link(sys.argv[1]))
    plant.greet()
    for number in range(int(sys.argv[2]) if len(sys.argv) > 2 else 100):
        plant.sample(number, number * TICK_MS)
        print(number * TICK_MS / 1000.0, *plant.y, *plant.u, sep=",", flush=True)
        plant.advance()


if __name__ == "__main__":
    main()
