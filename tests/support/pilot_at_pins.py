"""The pilot column with T1, T10 and its outputs at the board's own pins, and three more thermometers at the link beside them."""

import contextlib
import re
import subprocess
import sys
import time
from pathlib import Path
from typing import Iterator

sys.path.insert(0, str(Path(__file__).resolve().parent))
import board  # noqa: E402

from reflux import build  # noqa: E402

SCENARIOS = board.ROOT / "host_sim" / "scenarios"
WIRING = SCENARIOS / "pilot-pins.wiring"
SPENT = "stat.tick"  # processor time
BY_LINK = ("T3", "T5", "T8")
REST_ON_LINK = ("--rest-on-link", *(word for name in BY_LINK for word in ("--measure", name)))


def settings(source: str = "both", without: str = "") -> list[str]:
    """Console lines. without: those that begin so are left out, as of an output that is at the link."""
    lines = [line for line in (SCENARIOS / "pilot-pins.conf").read_text(encoding="utf-8").splitlines() if line and line[0] != "#"]
    lines = [line.replace("io.source board", f"io.source {source}") for line in lines if not without or not line.startswith(without)]
    for number, name in enumerate(BY_LINK, 3):
        lines[-1:-1] = [f"set meas{number}.name {name}", f"set meas{number}.unit degC", f"set meas{number}.lo 70", f"set meas{number}.hi 130"]
    return lines


def read(path: Path) -> list[dict[str, str]]:
    """Rows of a log or of telemetry by the names of the header before them, without units."""
    names: list[str] = []
    rows = []
    for line in path.read_text(encoding="utf-8").splitlines():
        fields = line.split(",")
        if fields[0] == "H" or (not names and line[0] != "#"):
            names = [re.sub(r"\[.*", "", name) for name in fields]
        elif line[0] != "#":
            rows.append(dict(zip(names, fields)))
    return rows


def telemetry(out: Path) -> list[dict[str, str]]:
    """Rows without what no two boards have in common."""
    return [{name: field for name, field in row.items() if name != SPENT} for row in read(out / "telemetry.csv")]


@contextlib.contextmanager
def virtual_board(folder: Path, image: str, wiring: Path = WIRING) -> Iterator[tuple[str, list[str]]]:
    """The flashed image on a board of its own. Gives where it is, and at the end what it said of its resets."""
    control, said = folder / "control", list[str]()
    with subprocess.Popen([str(build.find_program("host", "reflux-board")), "--image", str(build.find_image(image)), "--control", str(control),
                           "--wiring", str(wiring), "--statistics"], stderr=subprocess.PIPE, text=True) as process:
        try:
            end = time.monotonic() + board.PATIENCE_S
            while not control.exists():
                if process.poll() is not None or time.monotonic() > end:
                    raise AssertionError("reflux-board did not start")
                time.sleep(0.01)
            yield f"board:{control}", said
            said.append(process.communicate(timeout=board.PATIENCE_S)[1])
        finally:
            process.kill()


def simulate(out: Path, duration_s: int, first: list[str], later: tuple[tuple[int, str], ...], *options: str, program: str = "reflux-sim-memory",
             where: str = "memory", wiring: Path = WIRING, preset: str = "host") -> str:
    """Runs the column in this new folder, with settings at 0 s and lines by their plant time in s. Returns what was said."""
    out.mkdir()
    script = out / "script.txt"
    script.write_text("".join(f"{at} {line}\n" for at, line in (*((0, line) for line in (*first, "log on")), *later)), encoding="utf-8")
    done = subprocess.run([str(build.find_program(preset, program)), "--plant", "pilot", "--port", where, "--console", where, "--wiring", str(wiring),
                           "--tick", "1", "--duration", str(duration_s), "--script", str(script), "--log", str(out / "simulator.csv"),
                           "--telemetry", str(out / "telemetry.csv"), "--transcript", str(out / "transcript.txt"),
                           "--timeout", str(board.PATIENCE_S), *options],
                          capture_output=True, text=True, timeout=board.PATIENCE_S, check=False)
    if done.returncode != 0:
        raise AssertionError(done.stderr)
    return f"{done.stdout.strip()}{done.stderr.strip()}"
