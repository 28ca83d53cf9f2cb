"""One run: firmware and simulator started, the console script played, the logs read and judged."""

from __future__ import annotations

import contextlib
import fcntl
import json
import re
import shutil
import signal
import subprocess
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Iterator

from reflux import build, launch, limits, logs, metrics, simulator
from reflux.boards import VIRTUAL
from reflux.errors import RunFailed, UserError
from reflux.paths import shown
from reflux.scenario import Line, Scenario, check_pins, relative

# reflux-sim says `mode machine` itself, as soon as the firmware answers.
BEFORE = (Line(0.0, "version"),)
AFTER = (Line(0.0, "log on 1"),)

FILES = ("report.html", "script.txt", "transcript.txt", "telemetry.csv", "simulator.csv", "log.csv", "result.json")  # the last one of a run that ended
BEFORE_FOLDER = "before"

SUMMARY = re.compile(r"reflux-sim: \d+ samples, ")


@dataclass
class Options:
    out: Path
    console_port: str | None = None
    link_port: str | None = None
    quiet: bool = False
    extra: tuple[str, ...] = ()  # for the emulator


@dataclass
class Result:
    scenario: Scenario
    out: Path
    log: logs.Log
    windows: list[metrics.Window]
    checks: list[limits.Check]
    facts: dict[str, object] = field(default_factory=dict)

    @property
    def passed(self) -> bool:
        return all(check.passed for check in self.checks)

    def units(self) -> dict[str, tuple[str, str]]:
        """Units of each loop's measurement and output."""
        return {loop.name: (logs.channel_unit(self.log, loop.pv), logs.channel_unit(self.log, loop.mv))
                for loop in self.scenario.loops}

    def failures(self) -> list[str]:
        return [check.sentence() for check in self.checks if not check.passed]

    def as_dict(self) -> dict[str, object]:
        return {"scenario": self.scenario.name, "title": self.scenario.title, "passed": self.passed, **self.facts,
                "windows": [w.as_dict() for w in self.windows], "limits": [c.as_dict() for c in self.checks]}


def script_lines(scenario: Scenario) -> list[Line]:
    """Everything typed into the console: who is there, the configuration, telemetry on, then the scenario."""
    return [*BEFORE, *scenario.config, *AFTER, *scenario.lines]


def write_script(scenario: Scenario, path: Path) -> None:
    """For reflux-sim: time, then the line; ? before it lets the firmware refuse it."""
    lines = [f"{line.at_s:.17g} {'?' if line.allow_err else ''}{line.text}\n" for line in script_lines(scenario)]
    path.write_text("".join(lines), encoding="utf-8")


def simulator_command(scenario: Scenario, firmware: launch.Firmware, out: Path) -> list[str]:
    command = [str(build.find_program("host", firmware.simulator)), "--plant", scenario.plant_argument,
               "--port", firmware.link, "--console", firmware.console, "--script", str(out / "script.txt"),
               "--transcript", str(out / "transcript.txt"), "--telemetry", str(out / "telemetry.csv"),
               "--log", str(out / "simulator.csv"), "--speed", scenario.speed, "--seed", str(scenario.seed),
               "--noise", f"{scenario.noise:.17g}", "--duration", f"{scenario.duration_s:.17g}",
               "--timeout", f"{scenario.timeout_s:.17g}", "--progress", *scenario.plant_options()]
    if scenario.wiring is not None:
        command += ["--wiring", str(scenario.wiring)]
    for event in scenario.events:
        command += ["--event", f"{event.at_s:.17g}:{event.name}={event.value:.17g}"]
    return command


def board_options(scenario: Scenario) -> tuple[str, ...]:
    """For reflux-board: what is at its pins. A simulator with the firmware inside reads the wiring itself."""
    if scenario.wiring is None or scenario.firmware not in VIRTUAL:
        return ()
    return ("--wiring", str(scenario.wiring), "--seed", str(scenario.seed))


def run(scenario: Scenario, options: Options) -> Result:
    """Everything but the report. An earlier run in the folder that came to its end is set aside."""
    check_pins(scenario)
    out = options.out
    with locked(out):
        ended = (out / FILES[-1]).exists()
        set_aside(out, FILES, ended)
        try:
            return _run_in(scenario, options, out)
        except BaseException:
            if ended and not options.quiet:
                print(f"\nfiles of the run before: {shown(out / BEFORE_FOLDER)}", flush=True)
            raise


def set_aside(out: Path, names: tuple[str, ...], keep: bool) -> None:
    """Moves these files and the plots to OUT/before and replaces what is there, or removes them where they are not worth keeping."""
    before = out / BEFORE_FOLDER
    try:
        if keep:
            shutil.rmtree(before, ignore_errors=True)
            before.mkdir()
        for file in [*(out / name for name in names), *out.glob("plot-*.png")]:
            if keep and file.exists():
                file.rename(before / file.name)
            file.unlink(missing_ok=True)
    except OSError as error:
        raise UserError(f"{shown(out)} cannot be written: {error.strerror}") from None


@contextlib.contextmanager
def locked(out: Path) -> Iterator[None]:
    """Makes the folder. Two runs must not write into one. What is refused leaves no folder that was not there before."""
    if out.exists() and not out.is_dir():
        raise UserError(f"{shown(out)} is a file; --out names a folder")
    made = [folder for folder in (out, *out.parents) if not folder.exists()]
    try:
        with _locked(out):
            yield
    except UserError:
        if made:
            shutil.rmtree(out, ignore_errors=True)
        for folder in made[1:]:
            with contextlib.suppress(OSError):
                folder.rmdir()
        raise


@contextlib.contextmanager
def _locked(out: Path) -> Iterator[None]:
    try:
        out.mkdir(parents=True, exist_ok=True)
        (out / ".lock").touch()
    except OSError as error:
        raise UserError(f"{shown(out)} cannot be written: {error.strerror}") from None
    with (out / ".lock").open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise UserError(f"{shown(out)}: another run is writing there; --out names another folder") from None
        yield


def _run_in(scenario: Scenario, options: Options, out: Path) -> Result:
    write_script(scenario, out / "script.txt")
    started = time.monotonic()
    with launch.start(scenario.firmware, options.console_port, options.link_port, (*options.extra, *board_options(scenario))) as firmware:
        _simulate(simulator_command(scenario, firmware, out), scenario, firmware, options.quiet)
        sha256 = firmware.sha256()
    wall = time.monotonic() - started
    telemetry = logs.read_telemetry(out / "telemetry.csv")
    simulated = logs.read_csv(out / "simulator.csv")
    joined = logs.join(*((simulated, telemetry) if scenario.wiring is None else logs.at_pins(simulated, telemetry)))
    logs.write_csv(joined, out / "log.csv")
    logs.write_csv(telemetry, out / "telemetry.csv")
    (out / "simulator.csv").unlink()
    windows = [w for loop in scenario.loops for w in metrics.windows(joined, scenario, loop)]
    facts: dict[str, object] = {
        "plant": scenario.plant, "firmware": scenario.firmware, "seed": scenario.seed, "noise": scenario.noise,
        "duration_s": scenario.duration_s, "samples": len(joined.rows), "wall_s": round(wall, 2),
        "image": relative(firmware.image) if firmware.image else None, "image_sha256": sha256,
        "version": version_in(out / "transcript.txt"), "scenario_file": relative(scenario.file),
        **({"wiring": relative(scenario.wiring)} if scenario.wiring is not None else {}),
    }
    result = Result(scenario, out, joined, windows, limits.check(scenario, windows), facts)
    (out / "result.json").write_text(json.dumps(result.as_dict(), indent=1) + "\n", encoding="utf-8")
    return result


def _simulate(command: list[str], scenario: Scenario, firmware: launch.Firmware, quiet: bool) -> None:
    """Runs reflux-sim to its end, passing its progress on; its last word is the reason of a failure."""
    process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                               stderr=subprocess.STDOUT)
    words = ""
    try:
        words = _follow(process, build.Progress(f"running {scenario.name} on {firmware.kind}", quiet))
        status = process.wait()
    finally:
        if process.poll() is None:
            process.send_signal(signal.SIGTERM)
            process.wait()
    if status == 0:
        return
    # A firmware that dies takes the line with it: give it a moment so that its own last words are told.
    time.sleep(0.2)
    died = firmware.died()
    reason = words or f"reflux-sim ended with status {status}"
    if died:
        reason = f"{reason} ({died})"
    raise (UserError if status == 2 else RunFailed)(reason)


def _follow(process: subprocess.Popen[bytes], progress: build.Progress) -> str:
    """Progress lines end in a carriage return or a newline; what it said last, its summary apart, is kept."""
    assert process.stdout is not None
    last, line = "", b""
    started = time.monotonic()
    while chunk := process.stdout.read1(4096):
        *whole, line = re.split(rb"[\r\n]+", line + chunk)
        for text in (piece.decode(errors="replace").strip() for piece in whole):
            if text and not SUMMARY.match(text):
                last = text.removeprefix("reflux-sim: ")
                progress.show(last)
    progress.end(f"{time.monotonic() - started:.1f} s of wall time")
    return last


def replies_in(transcript: Path, command: str) -> list[str]:
    """The lines of the first reply to a console line. Transcript lines: plant time, > or <, text."""
    said = [line.split(" ", 2) for line in _read(transcript) if line.count(" ") >= 2]
    answer: list[str] = []
    inside = False
    for _time, direction, text in said:
        if direction == ">":
            if inside:
                break
            inside = text == command
        elif inside and text != "ok" and not text.startswith(("H,", "T,", "!", "err ")):
            answer.append(text)
    return answer


def version_in(transcript: Path) -> str | None:
    """The first line of the reply to `version`."""
    return next(iter(replies_in(transcript, "version")), None)


def events_in(transcript: Path) -> list[tuple[float, str, str, str]]:
    """Events that the firmware reported by itself: plant time, level, code, text."""
    out = []
    for line in _read(transcript):
        match = re.match(r"[\d.]+ < ! *([\d.]+) (\S+) (\S+) ?(.*)$", line)
        if match:
            out.append((float(match.group(1)), match.group(2), match.group(3), match.group(4)))
    return out


def _read(path: Path) -> list[str]:
    try:
        return path.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return []


def check_plant(scenario: Scenario) -> None:
    """Refuses the plant of a scenario before anything is started."""
    try:
        simulator.check_plant(scenario.plant_argument)
    except UserError as error:
        raise UserError(f"{shown(scenario.file)}: {error}") from None
