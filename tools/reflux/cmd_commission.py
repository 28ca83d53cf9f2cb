"""tools/commission: guided start-up of a plant, from "unknown" to "tuned and running"."""

from __future__ import annotations

import argparse
import contextlib
import csv
import math
import re
import subprocess
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Callable, Iterator

from reflux import build, keys, launch, runner, simulator
from reflux import scenario as scenarios
from reflux.commission import first_settings
from reflux.commission.board import Board, Transcript
from reflux.commission.keyboard import Keyboard
from reflux.commission.startup import Options, Startup
from reflux.errors import RunFailed, UserError
from reflux.paths import named, out_root, shown, tool
from reflux.ports import Port
from reflux.schema import check_number, load_toml

if TYPE_CHECKING:
    from reflux.commission import closed_loops

FIRMWARES = ("host", "host-fixed", "stm32f405", "stm32f405-fixed")
RATE, RATE_UNATTENDED = 200.0, 1000.0  # samples a second of a simulated plant: its console keeps up with that
DOUBTFUL = 3  # exit status
FILES = ("transcript.txt", "telemetry.csv", "answers.toml", "board.conf", "report.html")


def parser() -> argparse.ArgumentParser:
    p = argparse.ArgumentParser(
        prog=tool("commission"),
        description="Guided start-up (docs/use/commission.md): tests every input of the plant, finds a model, proposes "
        "loops and settings, tries them. PORT is the board's console: a serial device (/dev/ttyUSB0, "
        "/dev/ttyUSB0@115200), a pseudo-terminal, or socket:PATH. Exit status: 0 the loops are kept, 1 they are not "
        "(the last line says why), 2 usage error, 3 the loops are kept, and something that was tested has "
        "none, or a loop is far slower than its plant (the last lines say what and why).")
    p.add_argument("port", nargs="?", metavar="PORT")
    p.add_argument("--plant", metavar="NAME", help="instead of a board: firmware and a simulated plant on this computer, "
                   "a plant of reflux-sim --list or a plant file, .json")
    p.add_argument("--firmware", choices=FIRMWARES, default="host", help="with --plant: a process, or the image in the "
                   "emulator (default host)")
    p.add_argument("--speed", metavar="max|X", help="with --plant: speed as a multiple of real time (default: 200 samples a "
                   "second, 1000 where nobody is asked)")
    p.add_argument("--tick", type=float, metavar="S", help="with --plant: sample interval (default: the plant's)")
    p.add_argument("--seed", type=int, metavar="N", help="with --plant: seed of the sensor noise")
    p.add_argument("--noise", type=float, metavar="X", help="with --plant: factor on the noise of all sensors")
    p.add_argument("--conf", type=named, metavar="FILE", help="with --plant: settings that the board has before the start-up, as tools/console --run sends "
                   "them: interlocks, alarms and estimators act in the rehearsal, and the board.conf that comes of it holds them")
    p.add_argument("--no-build", action="store_true", help="with --plant: do not build; use what is there")
    keys.add_option(p)
    p.add_argument("--file", type=named, metavar="FILE", help="take the answers from a .toml file instead of asking")
    p.add_argument("--yes", action="store_true", help="take all defaults and accept the proposal")
    p.add_argument("--write-file", type=named, metavar="FILE", help="write the answers given, for --file")
    p.add_argument("--out", type=named, metavar="FOLDER", help="folder for transcript, telemetry and report (default: "
                   "out/commission-PLANT, or out/commission)")
    p.add_argument("--no-report", action="store_true", help="write no report.html and no plots")
    p.add_argument("--report", type=named, metavar="FOLDER", help="make the report of such a folder again; run nothing")
    return p


@dataclass
class Bench:
    """Port of the console, and what is known of the plant behind it."""

    console: str
    operating: dict[str, float] = field(default_factory=dict)
    alive: Callable[[], None] = lambda: None


def main(arguments: list[str]) -> int:
    options = parser().parse_args(arguments)
    if options.report:
        return report(options)
    check(options)
    name = f"commission-{Path(options.plant).stem}" if options.plant else "commission"
    out = options.out or out_root() / name
    if options.file:
        load_toml(options.file)  # what is no file at all is told before anything is started
    conf = first_settings.read(options.conf) if options.conf else None
    with runner.locked(out), contextlib.ExitStack() as stack:
        set_aside(out)
        bench = stack.enter_context(simulated(options)) if options.plant else Bench(options.port)
        port = stack.enter_context(contextlib.closing(Port(bench.console)))
        transcript = stack.enter_context(contextlib.closing(Transcript(out)))
        try:
            left = start_up(bench, port, transcript, options, out, conf)
        finally:
            transcript.flush()
            transcript.telemetry.flush()
            if transcript.rows and not options.no_report:
                write_report(out)
    doubts = margin_doubts(out)
    for words in (*(doubt.words for doubt in doubts), *left):
        print(words, flush=True)
    return status(doubts, left)


def status(doubts: list[closed_loops.Doubt], left: list[str]) -> int:
    """Of kept loops."""
    return DOUBTFUL if left or any(doubt.slow for doubt in doubts) else 0


def set_aside(out: Path) -> None:
    """An earlier start-up's files go to OUT/before: hours on a plant are not thrown away for an answer that may be no. One that never
    began leaves what is there."""
    transcript = out / "transcript.txt"
    began = transcript.exists() and "COMMISSION_BEGUN" in transcript.read_text(encoding="utf-8", errors="replace")
    runner.set_aside(out, FILES, began)
    if began:
        print(f"files of the start-up before: {shown(out / runner.BEFORE_FOLDER)}", flush=True)


def check(options: argparse.Namespace) -> None:
    if bool(options.plant) == bool(options.port):
        raise UserError("which board? PORT, or --plant NAME for a simulated plant on this computer")
    options.key = keys.key_of(options.key)
    if options.file and options.yes:
        raise UserError("--file has the answers, --yes takes the defaults: one of them")
    for name in ("speed", "tick", "seed", "noise", "conf"):
        if options.port and getattr(options, name) is not None:
            raise UserError(f"--{name} goes with --plant")
    if options.speed is not None:
        scenarios.check_speed(options.speed, "--speed")
    if options.tick is not None:
        check_number("--tick", options.tick, above=0)
    if options.seed is not None:
        check_number("--seed", options.seed, low=0)
    if options.noise is not None:
        check_number("--noise", options.noise, low=0)


def start_up(bench: Bench, port: Port, transcript: Transcript, options: argparse.Namespace, out: Path,
             conf: list[tuple[int, str]] | None) -> list[str]:
    """Runs the start-up; returns what has no loop, where the loops are kept."""
    board = Board(port, transcript, options.key)
    unattended = options.yes or options.file is not None
    keyboard = Keyboard(board, listens=not unattended)
    if unattended and not keyboard.terminal:
        keyboard = None
    run = Startup(board, Options(options.file, options.yes, options.write_file, out, options.plant is not None, options.conf), bench.operating,
                  bench.alive, keyboard)
    try:
        if conf is not None:
            first_settings.send(run, conf)
        run.run()
    finally:
        with contextlib.suppress(RunFailed, OSError):
            board.ask("log off")
            run.note_end()
            board.ask("mode human")
    return run.left


# ---- a simulated plant ----

@contextlib.contextmanager
def simulated(options: argparse.Namespace) -> Iterator[Bench]:
    if not options.no_build:
        launch.build_for(options.firmware)
        build.build("host", ("libreflux",))  # for the report
    simulator.check_plant(options.plant)
    tick_s = tick_of(options)
    rate = RATE_UNATTENDED if options.yes or options.file else RATE
    speed = options.speed or f"{rate * tick_s:.6g}"
    more = ["--speed", speed, "--tick", f"{tick_s:.9g}"]
    for name in ("seed", "noise"):
        if getattr(options, name) is not None:
            more += [f"--{name}", f"{getattr(options, name):.17g}"]
    with launch.start(options.firmware) as firmware, launch.plant(firmware, options.plant, *more) as plant:
        yield Bench(firmware.console, steady(options.plant), lambda: alive(firmware, plant))


def alive(firmware: launch.Firmware, plant: subprocess.Popen[bytes]) -> None:
    if plant.poll() is not None:
        raise RunFailed(f"the simulated plant has ended: {launch.plant_said(plant)}")
    if died := firmware.died():
        raise RunFailed(died)


def tick_of(options: argparse.Namespace) -> float:
    """--tick, or the answers', or the plant's own."""
    if options.tick is not None:
        return float(options.tick)
    if options.file:
        asked = load_toml(options.file).get("plant", {})
        tick = asked.get("tick_s") if isinstance(asked, dict) else None
        if isinstance(tick, (int, float)) and not isinstance(tick, bool) and math.isfinite(tick) and tick > 0:
            return float(tick)
    match = re.search(r"^\s*tick: ([\d.e+-]+) s", simulator.ask("--list", options.plant), re.MULTILINE)
    if not match:
        raise RunFailed(f"reflux-sim --list {options.plant} tells no tick")
    return float(match[1])


def steady(plant: str) -> dict[str, float]:
    """The inputs' values at which the plant begins: its operating point."""
    rows = csv.DictReader(simulator.ask("--steady", "--plant", plant).splitlines())
    return {row["name"]: float(row["value"]) for row in rows if row["kind"] == "manipulated"}


# ---- report ----

def write_report(out: Path) -> None:
    """Writes a report of what there is, also where the start-up ended early."""
    from reflux.commission import report as reports  # matplotlib takes a second to load
    try:
        print(f"\nReport: {shown(reports.write(out))}", flush=True)
    except (RunFailed, UserError) as error:  # the reason of the end is told last
        print(f"\nno report: {error}", flush=True)


def margin_doubts(out: Path) -> list[closed_loops.Doubt]:
    """What there is to say about the margins of each kept loop. The loops run all the same where nothing was logged or a package is missing."""
    with contextlib.suppress(RunFailed, UserError, ModuleNotFoundError):
        from reflux.commission import closed_loops, record  # numpy takes a part of a second to load
        r = record.load(out)
        return [doubt for said in closed_loops.doubts(r, closed_loops.of_proposal(r)).values() for doubt in said]
    return []


def report(options: argparse.Namespace) -> int:
    for name in ("port", "plant", "file", "write_file", "out"):
        if getattr(options, name):
            raise UserError(f"--report makes a report again and runs nothing; it does not go with "
                            f"{name if name == 'port' else '--' + name.replace('_', '-')}")
    if not (options.report / "transcript.txt").is_file():
        raise UserError(f"{shown(options.report)} holds no transcript.txt; is it the --out of a start-up?")
    from reflux.commission import report as reports
    print(f"Report: {shown(reports.write(options.report))}")
    return 0
