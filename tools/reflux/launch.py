"""Starting a firmware and saying where its two lines are. Whatever is started is ended again."""

from __future__ import annotations

import contextlib
import hashlib
import os
import signal
import subprocess
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Iterator

from reflux import build, port_lock
from reflux.boards import BOARDS, VIRTUAL
from reflux.errors import RunFailed, UserError
from reflux.paths import INSTALLED

BOOT_ID = 1


@dataclass
class Firmware:
    """A firmware that runs, or (memory) that the simulator carries inside."""

    kind: str
    console: str
    link: str
    simulator: str = "reflux-sim"
    image: Path | None = None
    process: subprocess.Popen[bytes] | None = None
    messages: Path | None = None
    facts: dict[str, str] = field(default_factory=dict)

    def sha256(self) -> str | None:
        return hashlib.sha256(self.image.read_bytes()).hexdigest() if self.image else None

    def died(self) -> str | None:
        """Last words of the process, when it is no longer there."""
        if self.process is None or self.process.poll() is None:
            return None
        if self.kind in VIRTUAL and self.process.returncode == 0:  # its peer has left first
            return None
        text = self.messages.read_text(errors="replace") if self.messages else ""
        lines = [line for line in text.splitlines() if line.strip() and ": info: " not in line]
        last = lines[-1] if lines else "it said nothing"
        return f"the firmware process ended with status {self.process.returncode}: {last}"


def preset_of(kind: str) -> str | None:
    """The build tree a kind of firmware comes from."""
    return {"memory": "host", "serial": None}.get(kind, VIRTUAL.get(kind, kind))


def programs_of(kind: str) -> list[tuple[str, tuple[str, ...]]]:
    """Presets and their targets that a scenario on that firmware runs; no target means the whole preset."""
    if kind in ("host", "memory"):
        return [("host", ("reflux-sim", "reflux-sim-memory", "reflux-plant", "reflux-host"))]
    out: list[tuple[str, tuple[str, ...]]] = [("host", ("reflux-sim",))]
    if kind == "host-fixed":
        out.append((kind, ("reflux-host",)))
    elif kind.startswith("stm32"):
        out.append((kind, ()))
    elif kind in VIRTUAL:
        out = [("host", ("reflux-sim", "reflux-board")), (VIRTUAL[kind], ())]
    return out


def at_hand(kind: str, pins: bool = False) -> str:
    """The firmware a scenario asks for. An installed package has the host build in place of one that has a build tree of its own; at the
    board's own pins that is the firmware inside the simulator."""
    if INSTALLED and any(preset != "host" for preset, _ in programs_of(kind)):
        return "memory" if pins else "host"
    return kind


NO_UNICORN = ("the virtual board needs the library Unicorn, version 2, with its headers and its file for pkg-config: on Debian and Ubuntu "
              "`apt install libunicorn-dev pkg-config` brings both; then run this again")


def build_for(kind: str, quiet: bool = False) -> None:
    """Builds the simulator and the firmware of that kind."""
    if kind in VIRTUAL and not INSTALLED and not build.knows("host", "reflux-board", quiet):
        raise RunFailed(NO_UNICORN)
    for preset, targets in programs_of(kind):
        build.build(preset, targets, quiet)


def check_ports(kind: str, console_port: str | None, link_port: str | None) -> None:
    """The two port options go with a real board, and a real board needs both."""
    if kind == "serial":
        _serial(console_port, link_port)
    elif console_port or link_port:
        raise UserError("--console-port and --link-port go with --firmware serial only")


@contextlib.contextmanager
def start(kind: str, console_port: str | None = None, link_port: str | None = None,
          extra: tuple[str, ...] = (), image: Path | None = None) -> Iterator[Firmware]:
    """extra: more options for the emulator. image: a file for it in place of the one that was built."""
    if kind == "serial":
        firmware = _serial(console_port, link_port)
        with contextlib.ExitStack() as stack:
            for port in (console_port, link_port):
                stack.enter_context(port_lock.held((port or "").split("@")[0]))
            yield firmware
        return
    check_ports(kind, console_port, link_port)
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        place = Path(folder)
        if kind == "memory":
            program = build.find_program("host", "reflux-sim-memory")
            yield Firmware(kind, "memory", "memory", "reflux-sim-memory", program)
            return
        if kind in VIRTUAL:
            firmware = _virtual_board(kind, place, extra)
        else:
            firmware = _host(kind, place) if kind.startswith("host") else _emulator(kind, place, image, extra)
        try:
            yield firmware
        finally:
            end(firmware.process)


@contextlib.contextmanager
def plant(firmware: Firmware, name: str, *options: str) -> Iterator[subprocess.Popen[bytes]]:
    """A simulated plant that runs on its own at the firmware's link."""
    process = subprocess.Popen(
        [str(build.find_program("host", "reflux-sim")), "--plant", name, "--port", firmware.link, *options,
         "--duration", "1e9"], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
        start_new_session=True)
    try:
        time.sleep(0.3)
        if process.poll() is not None:
            raise UserError(f"the plant did not start: {plant_said(process)}")
        yield process
    finally:
        end(process)


def plant_said(process: subprocess.Popen[bytes]) -> str:
    """The last line of a plant that has ended."""
    said = (process.stderr.read() if process.stderr else b"").decode(errors="replace").strip().splitlines()
    return (said or ["it said nothing"])[-1]


def _serial(console_port: str | None, link_port: str | None) -> Firmware:
    if not console_port or not link_port:
        raise UserError("--firmware serial needs --console-port and --link-port, such as /dev/ttyUSB0 and /dev/ttyUSB1")
    for port in (console_port, link_port):
        if not os.path.exists(port.split("@")[0]):
            raise UserError(f"there is no {port}; a serial port such as /dev/ttyUSB0, or /dev/ttyUSB0@115200")
    return Firmware("serial", _where(console_port), _where(link_port))


def _where(port: str) -> str:
    """A pseudo-terminal is opened by its name alone; a real port wants its speed too."""
    if os.path.realpath(port.split("@")[0]).startswith("/dev/pts/"):
        return f"pty:{port}"
    return f"serial:{port}" if "@" in port else f"serial:{port}@115200"


def _host(kind: str, place: Path) -> Firmware:
    program = build.find_program(kind, "reflux-host")
    console, link = place / "console", place / "link"
    command = [str(program), "--console", f"socket:{console}", "--link", f"socket:{link}",
               "--nvm", str(place / "nvm"), "--boot-id", str(BOOT_ID)]
    firmware = spawn(kind, command, place, program)
    firmware.console, firmware.link = f"socket:{console}", f"socket:{link}"
    await_paths(firmware, [console, link])
    return firmware


def emulator_command(image: Path, console: Path, link: Path, extra: tuple[str, ...] = ()) -> list[str]:
    """USART1 (the first -serial) is the console, USART2 the plant link. The link listens first and waits for
    nobody; the processor starts once the console has been opened. So the simulator may open them in any order,
    and no byte meets a firmware without its console."""
    machine = BOARDS[image.stem.removeprefix("reflux-")].machine
    return ["qemu-system-arm", "-M", machine, "-nographic", "-monitor", "none", "-kernel", str(image),
            "-chardev", f"socket,id=lnk,path={link},server=on,wait=off",
            "-chardev", f"socket,id=con,path={console},server=on,wait=on",
            "-serial", "chardev:con", "-serial", "chardev:lnk", *extra]


def _emulator(kind: str, place: Path, image: Path | None, extra: tuple[str, ...]) -> Firmware:
    image = image or build.find_image(kind)
    console, link = place / "console", place / "link"
    firmware = spawn(kind, emulator_command(image, console, link, extra), place, image)
    firmware.console, firmware.link = f"socket:{console}", f"socket:{link}"
    await_paths(firmware, [link, console])
    return firmware


def _virtual_board(kind: str, place: Path, extra: tuple[str, ...]) -> Firmware:
    image, control = build.find_image(VIRTUAL[kind]), place / "control"
    command = [str(build.find_program("host", "reflux-board")), "--image", str(image), "--control", str(control), *extra]
    firmware = spawn(kind, command, place, image)
    firmware.console = firmware.link = f"board:{control}"
    await_paths(firmware, [control])
    return firmware


def spawn(kind: str, command: list[str], place: Path, image: Path) -> Firmware:
    messages = place / "messages"
    try:
        with messages.open("wb") as out:
            process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=out, stderr=out,
                                       start_new_session=True)
    except FileNotFoundError:
        raise RunFailed(f"there is no program {command[0]}; tools/bootstrap installs it") from None
    return Firmware(kind, "", "", image=image, process=process, messages=messages)


def await_paths(firmware: Firmware, sockets: list[Path], seconds: float = 20.0) -> None:
    deadline = time.monotonic() + seconds
    while not all(path.exists() for path in sockets):
        died = firmware.died()
        if died or time.monotonic() > deadline:
            end(firmware.process)
            raise RunFailed(died or f"the firmware process opened no sockets within {seconds:g} s")
        time.sleep(0.01)


def end(process: subprocess.Popen[bytes] | None) -> None:
    """Asks the process (a session of its own) to end, and makes it when it does not."""
    if process is None or process.poll() is not None:
        return
    process.send_signal(signal.SIGTERM)
    try:
        process.wait(timeout=3)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
