#!/usr/bin/python3
"""Draws the pictures of docs/start/tutorial.md from what its commands leave in out/, and types into tools/play for the one of the console.

usage: tools/figures/tutorial_figures.py [NAME ...]     (watch, start-up, gradients, estimate, broken, gains, board; default all)
"""

import fcntl
import os
import pty
import re
import select
import shutil
import signal
import struct
import subprocess
import sys
import termios
import time
from pathlib import Path
from xml.sax.saxutils import escape

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

import numpy as np  # noqa: E402

from reflux import logs, paths  # noqa: E402
from reflux.plots import BLUE, GREEN, GREY, ORANGE, RED, STYLE, plt  # noqa: E402

HERE = ROOT / "tools" / "figures"
TYPED = (("status", 2.0), ("sp bottom 108", 12.0), ("sp bottm 108", 1.5), ("sp bottom 1080", 1.5), ("mode bottom manual", 2.0), ("out Qrb 0.6", 3.0))
ROWS, COLUMNS = 30, 92
CONTROL = re.compile(r"\x1b\[([\d;]*)([A-Za-z])")


# ---- the console ----

class Screen:
    """The control sequences that tools/console --watch writes: position, clear to the end of the line, scrolling part."""

    def __init__(self) -> None:
        self.lines = [[" "] * COLUMNS for _ in range(ROWS)]
        self.row = self.column = 0
        self.part = (0, ROWS - 1)

    def feed(self, text: str) -> None:
        while text:
            if text[0] == "\x1b":
                found = CONTROL.match(text)
                if not found:
                    return
                self.control(found[2], [int(n) for n in found[1].split(";") if n])
                text = text[found.end():]
                continue
            if text[0] == "\n":
                self.newline()
            elif text[0] == "\r":
                self.column = 0
            elif self.column < COLUMNS:
                self.lines[self.row][self.column] = text[0]
                self.column += 1
            text = text[1:]

    def control(self, letter: str, numbers: list[int]) -> None:
        if letter == "H":
            self.row, self.column = min(ROWS, numbers[0]) - 1, numbers[1] - 1
        elif letter == "K":
            self.lines[self.row][self.column:] = [" "] * (COLUMNS - self.column)
        elif letter == "r":
            self.part = (numbers[0] - 1, numbers[1] - 1) if numbers else (0, ROWS - 1)

    def newline(self) -> None:
        top, bottom = self.part
        self.column = 0
        if self.row != bottom:
            self.row = min(self.row + 1, ROWS - 1)
            return
        del self.lines[top]
        self.lines.insert(bottom, [" "] * COLUMNS)

    def text(self) -> list[str]:
        return ["".join(line).rstrip() for line in self.lines]


def watch(picture: Path) -> None:
    pid, terminal = pty.fork()
    if pid == 0:
        os.execv(str(ROOT / "tools" / "play"), ["tools/play", "pilot", "--watch"])
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", ROWS, COLUMNS, 0, 0))
    screen = Screen()

    def read(seconds: float) -> None:
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if select.select([terminal], [], [], 0.1)[0]:
                screen.feed(os.read(terminal, 65536).decode(errors="replace"))

    try:
        end = time.monotonic() + 60.0
        while not any("plant time" in line for line in screen.text()) and time.monotonic() < end:
            read(0.5)
        for line, seconds in TYPED:
            os.write(terminal, line.encode() + b"\r")
            read(seconds)
    finally:
        os.kill(pid, signal.SIGTERM)
        os.waitpid(pid, 0)
    picture.write_text(terminal_svg(screen.text()), encoding="utf-8")


def terminal_svg(lines: list[str]) -> str:
    """Lines as they stand on a dark terminal."""
    width, height = 8 * COLUMNS + 24, 17 * len(lines) + 24
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" role="img">',
           f'<rect width="{width}" height="{height}" rx="6" fill="#1b1f24"/>', '<g font-family="DejaVu Sans Mono, Menlo, Consolas, monospace" font-size="13">']
    for k, line in enumerate(lines):
        colour = "#7fd1a0" if line.startswith("> ") else "#f0a8a0" if line.startswith(("err ", "ALARM")) else "#dfe4e8"
        if line:
            out.append(f'<text x="12" y="{17 * k + 25}" fill="{colour}" xml:space="preserve">{escape(line)}</text>')
    return "\n".join([*out, "</g>", "</svg>", ""])


# ---- runs ----

def log_of(name: str) -> logs.Log:
    return logs.read_csv(paths.out_root() / name / "log.csv")


def hours(log: logs.Log) -> np.ndarray:
    return np.array(log.numbers("time")) / 3600


def temperature(ax, log: logs.Log, pv: str, loop: str) -> None:
    ax.plot(hours(log), log.numbers(f"{pv}.true"), color=BLUE, lw=1.3, label=f"{pv}, true")
    ax.step(hours(log), log.numbers(f"fw.{loop}.sp"), where="post", color=ORANGE, lw=1.1, label=f"setpoint of {loop}")
    ax.set_ylabel(f"{pv} [degC]")
    ax.legend(loc="lower right", fontsize=8, ncols=2)


def outputs(ax, log: logs.Log) -> None:
    ax.step(hours(log), log.numbers("R.applied"), color=GREEN, lw=1.1, label="reflux R [l/h]")
    ax.step(hours(log), log.numbers("Q.applied"), color="#8e2d2d", lw=1.1, label="heat Q [kW]")
    ax.legend(loc="upper right", fontsize=8, ncols=2)


def estimates(ax, log: logs.Log, name: str) -> None:
    ax.plot(hours(log), log.numbers(name), color=BLUE, lw=1.3, label=f"{name}, true")
    ax.plot(hours(log), log.numbers(f"fw.{name}_est"), color=ORANGE, lw=1.1, ls=(0, (4, 2)), label=f"{name}_est, estimated on the board")
    ax.set_ylabel(f"{name} [%w]")
    ax.legend(loc="upper right", fontsize=8, ncols=2)


def estimate(picture: Path) -> None:
    log = log_of("spirit")
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(4, 1, sharex=True, figsize=(8.6, 6.6), height_ratios=(3, 3, 2, 3))
        temperature(axes[0], log, "T10", "top")
        axes[0].set_ylim(83.5, 85.5)
        temperature(axes[1], log, "T3", "bottom")
        outputs(axes[2], log)
        axes[2].set_ylim(0, 4.5)
        estimates(axes[3], log, "xB")
        for hour, what in ((1, "setpoint of bottom"), (4, "feed +10 %")):
            mark(axes, hour, what)
        finish(figure, axes, log, picture)


def broken(picture: Path) -> None:
    log = log_of("broken")
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(4, 1, sharex=True, figsize=(8.6, 6.8), height_ratios=(3, 3, 2, 3))
        temperature(axes[0], log, "T10", "top")
        axes[0].set_ylim(80, 90)
        read = np.array(log.numbers("T3.meas"))
        temperature(axes[1], log, "T3", "bottom")
        axes[1].plot(hours(log), np.where(read < 0, 83, np.nan), color=RED, lw=2.5, label="reads -50 degC")
        axes[1].set_ylim(82, 100)
        axes[1].legend(loc="lower right", fontsize=8, ncols=3)
        outputs(axes[2], log)
        axes[2].set_ylim(0, 4.5)
        estimates(axes[3], log, "xB")
        axes[3].set_ylim(0, 12)
        for ax in axes:
            ax.axvspan(3660 / 3600, 4200 / 3600, color=RED, alpha=0.12, lw=0)
        for hour, what in ((1, "dead thermometer,\nthen the interlock (red)"), (4, "closed valve"), (7, "pulled plug")):
            mark(axes, hour, what)
        finish(figure, axes, log, picture)


def mark(axes, hour: float, what: str) -> None:
    for ax in axes:
        ax.axvline(hour, color=GREY, lw=0.9, ls=(0, (4, 3)), zorder=1)
    axes[0].annotate(what, (hour, 1.03), xycoords=("data", "axes fraction"), fontsize=8, color="#5c6670")


def finish(figure, axes, log: logs.Log, picture: Path) -> None:
    axes[-1].set_xlabel("plant time [h]")
    axes[-1].set_xlim(0, hours(log)[-1])
    figure.align_ylabels()
    figure.savefig(picture, dpi=90)


# ---- wires ----

WIRES = (("console", "USART1", ("PA9  TX", "PA10 RX"), "/dev/ttyUSB0", "tools/console"),
         ("plant link", "USART2", ("PA2  TX", "PA3  RX"), "/dev/ttyUSB1", "reflux-sim, or your program"))


def board(picture: Path) -> None:
    ink, wire = "#22292f", (BLUE, ORANGE)
    out = ['<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 820 350" width="820" height="350" role="img">',
           '<rect width="820" height="350" fill="#fff"/>', f'<g font-family="DejaVu Sans, Arial, sans-serif" font-size="14" fill="{ink}">']
    out += [box(20, 20, 190, 310, "STM32F405 board"), box(610, 20, 190, 310, "computer")]
    for k, (name, port, pins, device, program) in enumerate(WIRES):
        y = 75 + 140 * k
        out += [box(340, y, 150, 105, "USB adapter, 3.3 V"), f'<text x="36" y="{y - 2}" font-size="12" fill="#5c6670">{name}: {port}</text>']
        for row, (pin, there, colour) in enumerate((*zip(pins, ("RX", "TX"), wire), ("GND", "GND", ink))):
            at = y + 40 + 26 * row
            out += [f'<text x="198" y="{at + 5}" text-anchor="end" xml:space="preserve">{pin}</text>', f'<text x="352" y="{at + 5}">{there}</text>',
                    f'<line x1="212" y1="{at}" x2="338" y2="{at}" stroke="{colour}" stroke-width="2.5"/>']
        out += [f'<line x1="492" y1="{y + 66}" x2="608" y2="{y + 66}" stroke="#5c6670" stroke-width="5"/>',
                f'<text x="622" y="{y + 62}">{device}</text>', f'<text x="622" y="{y + 82}" font-size="12" fill="#5c6670">{program}</text>']
    picture.write_text("\n".join([*out, "</g>", "</svg>", ""]), encoding="utf-8")


def box(x: int, y: int, width: int, height: int, title: str) -> str:
    return (f'<rect x="{x}" y="{y}" width="{width}" height="{height}" rx="6" fill="#f5f7f9" stroke="#5c6670"/>'
            f'<text x="{x + width / 2}" y="{y + 20}" text-anchor="middle" font-weight="bold" font-size="13">{title}</text>')


# ---- all ----

def by_script(*command: str | Path) -> None:
    subprocess.run([*map(str, command)], cwd=ROOT, check=True)


def start_up(picture: Path) -> None:
    by_script(HERE / "commissioning_figure.py", paths.out_root() / "commission-mine", picture)


def gradients(picture: Path) -> None:
    by_script(ROOT / "tools" / "gradients", paths.out_root() / "spirit.json", "--out", picture)


def gains(picture: Path) -> None:
    shutil.copyfile(paths.out_root() / "gains.png", picture)


PICTURES = {"watch": (watch, "svg"), "start-up": (start_up, "png"), "gradients": (gradients, "png"), "estimate": (estimate, "png"),
            "broken": (broken, "png"), "gains": (gains, "png"), "board": (board, "svg")}


def main() -> int:
    names = sys.argv[1:] or list(PICTURES)
    if wrong := [name for name in names if name not in PICTURES]:
        print(__doc__.strip())
        return 0 if wrong[0] in ("-h", "--help") else 2
    for name in names:
        draw, kind = PICTURES[name]
        draw(paths.figures() / f"tutorial-{name}.{kind}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
