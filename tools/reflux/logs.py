"""Logs of a run (docs/use/logs.md): the simulator's CSV, the firmware's telemetry, and the two joined by sample number."""

from __future__ import annotations

import csv
import math
import re
import struct
from dataclasses import dataclass, field
from pathlib import Path
from typing import Iterable

from reflux import textfile
from reflux.errors import RunFailed, UserError
from reflux.paths import shown

TELEMETRY_VERSION = "1"
FIRMWARE_PREFIX = "fw."  # marks the firmware's own columns in a joined log
# A telemetry line as it came, in a transcript (plant time, <), or on a person's screen, where ESC [ K wipes the prompt before it.
TELEMETRY = re.compile(r"(?:^(?:\s*[\d.]+\s+)?(?:< )?|\x1b?\[K)([HT],\d.*)$")


@dataclass
class Log:
    """Columns of text, as they stood in the file: parsing them is for those who need numbers."""

    columns: list[str]
    rows: list[list[str]]
    comments: list[str] = field(default_factory=list)
    source: str = ""
    left_out: int = 0  # rows of telemetry that were damaged or had no header

    def __post_init__(self) -> None:
        self._place = {bare(name): i for i, name in reversed(list(enumerate(self.columns)))}

    def has(self, name: str) -> bool:
        return bare(name) in self._place

    def place(self, name: str) -> int:
        if not self.has(name):
            raise UserError(f"{self.source or 'log'}: no column {name}; there are {', '.join(dict.fromkeys(map(bare, self.columns)))}")
        return self._place[bare(name)]

    def named(self, name: str) -> str:
        """The column that a person means: the name as it stands, else as the simulator or the board writes it (docs/use/logs.md)."""
        wanted = bare(name)
        return next((other for other in (wanted, *aliases(wanted)) if self.has(other)), wanted)

    def unit(self, name: str) -> str:
        return unit(self.columns[self.place(name)])

    def text(self, name: str) -> list[str]:
        i = self.place(name)
        return [row[i] for row in self.rows]

    def numbers(self, name: str) -> list[float]:
        """Values of a column; an empty cell is NaN. The firmware's are float32, however many digits its C
        library prints of them."""
        read = number32 if name.startswith(FIRMWARE_PREFIX) else number
        return [read(cell) for cell in self.text(name)]


def mode_of(setpoint: str) -> str:
    """The column with the mode of the loop that has this column of setpoints."""
    return setpoint.removesuffix(".sp") + ".mode"


def acted_on(setpoint: Iterable[float], mode: Iterable[float]) -> list[float]:
    """The setpoint where its loop acts on it, else NaN: in manual it follows the measurement, and would hide it in a picture."""
    return [math.nan if m == 0 else float(r) for r, m in zip(setpoint, mode)]


def bare(column: str) -> str:
    """T1.true[degC] -> T1.true"""
    return column.split("[", 1)[0].strip()


def unit(column: str) -> str:
    match = re.search(r"\[(.*)\]\s*$", column)
    return match.group(1) if match else ""


def aliases(name: str) -> list[str]:
    """Other names of the same thing: T1 is T1.meas of the simulator or fw.T1 of the board; Q1 of an output is Q1.app, which is Q1.applied."""
    own = name.removeprefix(FIRMWARE_PREFIX)
    same = {own}
    for short, long in ((".app", ".applied"), ("", ".meas"), (".q", ".quality")):
        if own.endswith(long) and long:
            same.add(own.removesuffix(long) + short)
        elif short and own.endswith(short):
            same.add(own.removesuffix(short) + long)
    if "." not in own:
        same |= {f"{own}.meas", f"{own}.app", f"{own}.applied"}
    ordered = sorted(same, key=lambda other: (other != own, other.endswith((".app", ".applied")), len(other)))
    return [other for other in (*ordered, *(FIRMWARE_PREFIX + other for other in ordered)) if other != name]


def label(name: str) -> str:
    """A column's name for people: one for each thing, whoever wrote the column."""
    own = name.removeprefix(FIRMWARE_PREFIX)
    for suffix, words in ((".meas", ""), (".applied", ""), (".app", ""), (".cmd", " commanded"), (".sp", " setpoint"), (".true", " true"),
                          (".mode", " mode"), (".quality", " quality"), (".q", " quality")):
        if own.endswith(suffix):
            return own.removesuffix(suffix) + words
    return own


def channel_unit(log: Log, channel: str) -> str:
    """The unit of a channel, from whichever of its columns the log has."""
    for suffix in (".true", ".meas", ".applied", ".cmd", ".app", ""):
        if log.has(channel + suffix):
            return log.unit(channel + suffix)
    return "-"


def number(cell: str) -> float:
    try:
        return float(cell)
    except ValueError:
        return math.nan


def number32(cell: str) -> float:
    return struct.unpack("f", struct.pack("f", number(cell)))[0]


def read(path: Path) -> Log:
    """Any log that a tool has written, whatever its form."""
    log = read_if_log(path)
    if log is None:
        raise UserError(f"{shown(path)}: not a log: neither a header line that begins with number nor telemetry (H, lines; `log on` at the "
                        "console begins them)")
    return log


def read_if_log(path: Path) -> Log | None:
    """None: the file is something else."""
    lines = textfile.read(path, damaged=True).splitlines()
    first = next((line for line in lines if line.strip() and not line.startswith("#")), "")
    if first.startswith("number,"):
        return read_csv(path)
    if any(TELEMETRY.search(line) for line in lines):
        return telemetry_in(lines, shown(path), damaged=True)
    return None


def read_csv(path: Path) -> Log:
    """A log as one table: # comments, one header line, rows of the same width."""
    lines = textfile.read(path).splitlines()
    comments = [line for line in lines if line.startswith("#")]
    numbered = [(n, line) for n, line in enumerate(lines, 1) if line.strip() and not line.startswith("#")]
    if not numbered:
        raise UserError(f"{shown(path)}: empty; expected a header line that begins with number,time[s]")
    columns = next(csv.reader([numbered[0][1]]))
    if not columns or bare(columns[0]) != "number":
        raise UserError(f"{shown(path)}:{numbered[0][0]}: not a log: the header line must begin with number")
    rows = []
    for n, line in numbered[1:]:
        row = next(csv.reader([line]))
        if len(row) != len(columns):
            raise UserError(f"{shown(path)}:{n}: {len(row)} fields, the header has {len(columns)}")
        rows.append(row)
    return Log(columns, rows, comments, shown(path))


def read_telemetry(path: Path) -> Log:
    """Telemetry lines of a console: H, headers and T, rows. A configuration that is applied brings a new
    header; columns of all of them stand side by side, empty where a row did not have them."""
    return telemetry_in(textfile.read(path, damaged=True).splitlines(), shown(path))


def telemetry_in(lines: list[str], source: str, damaged: bool = False) -> Log:
    """damaged: rows that have lost something on the way, or whose header is not there, are left out and counted."""
    columns: list[str] = []
    header: list[str] | None = None
    rows: list[dict[str, str]] = []
    left_out = 0
    for n, line in enumerate(lines, 1):
        match = TELEMETRY.search(line)
        if not match:
            continue
        if match[1].startswith("H,"):
            header = _header(match[1], f"{source}:{n}")
            columns += [name for name in header if name not in columns]
        elif damaged and not _is_whole(match[1], header):
            left_out += 1
        else:
            rows.append(_row(match[1], header, f"{source}:{n}"))
    if header is None:
        raise RunFailed(f"{source}: no telemetry header (H, line) from the firmware. `log on` sends one: type it after the recording has begun")
    return Log(columns, [[row.get(name, "") for name in columns] for row in rows], [], source, left_out)


def _header(line: str, where: str) -> list[str]:
    fields = line.split(",")[1:]
    if not fields or fields[0] != TELEMETRY_VERSION:
        raise RunFailed(f"{where}: telemetry of version {fields[0] if fields else '?'}; "
                        f"these tools read version {TELEMETRY_VERSION}")
    if len(fields) < 2 or bare(fields[1]) != "number":
        raise RunFailed(f"{where}: the second column of a telemetry header must be number")
    return fields[1:]


def _is_whole(line: str, header: list[str] | None) -> bool:
    fields = line.split(",")[2:]
    return header is not None and len(fields) == len(header) and not any(math.isnan(number(cell)) for cell in fields[:2])


def _row(line: str, header: list[str] | None, where: str) -> dict[str, str]:
    if header is None:
        raise RunFailed(f"{where}: a telemetry row before any header")
    fields = line.split(",")[1:]
    if len(fields) != len(header) + 1:
        raise RunFailed(f"{where}: {len(fields)} fields, the header has {len(header) + 1}")
    return dict(zip(header, fields[1:]))


def join(simulator: Log, telemetry: Log) -> Log:
    """One row per sample: the simulator's columns, then the firmware's with fw. before their names.
    A sample without its telemetry row, or a row without its sample, fails the run."""
    by_number: dict[str, list[str]] = {}
    for row, key in zip(telemetry.rows, telemetry.text("number")):
        if key in by_number:
            raise RunFailed(f"{telemetry.source}: two telemetry rows for sample {key}")
        by_number[key] = row
    skip = telemetry.place("number")
    kept = [i for i in range(len(telemetry.columns)) if i != skip]
    columns = simulator.columns + [FIRMWARE_PREFIX + telemetry.columns[i] for i in kept]
    rows = []
    missing = []
    for row, key in zip(simulator.rows, simulator.text("number")):
        own = by_number.pop(key, None)
        if own is None:
            missing.append(key)
        else:
            rows.append(row + [own[i] for i in kept])
    if missing:
        raise RunFailed(f"{telemetry.source}: no telemetry row for {_some(missing)} of {len(simulator.rows)} samples")
    if by_number:
        raise RunFailed(f"{telemetry.source}: telemetry rows for {_some(list(by_number))}, which are not "
                        f"in {simulator.source}")
    return Log(columns, rows, simulator.comments, "joined log")


def at_pins(simulator: Log, telemetry: Log) -> tuple[Log, Log]:
    """Both logs of a board at its own pins, by the numbers of the simulator. The board takes samples before plant time begins, so that its first
    row here is sample 0; and where its base tick is several ticks of the plant, the rows of the plant's in which it takes none are left out, and
    outputs are means over its base tick."""
    k = telemetry.place("number")
    step = max(1, round(_step(telemetry) / _step(simulator))) if min(len(telemetry.rows), len(simulator.rows)) > 1 else 1
    first = int(telemetry.rows[0][k]) if telemetry.rows else 0
    rows = [[*row[:k], str((int(row[k]) - first) * step), *row[k + 1 :]] for row in telemetry.rows]
    # What was applied is the mean over the tick before a row, what was commanded over the one after it.
    spans = {i: (1 - step, 1) if bare(name).endswith(".applied") else (0, step) for i, name in enumerate(simulator.columns)
             if step > 1 and bare(name).endswith((".applied", ".cmd"))}
    kept = [list(row) for row in simulator.rows[::step]]
    for i, (begin, end) in spans.items():
        values = simulator.numbers(simulator.columns[i])
        for n, row in enumerate(kept):
            inside = values[max(n * step + begin, 0) : n * step + end]
            row[i] = f"{sum(inside) / len(inside):.9g}"
    return (Log(simulator.columns, kept, simulator.comments, simulator.source),
            Log(telemetry.columns, rows, telemetry.comments, telemetry.source, telemetry.left_out))


def _step(log: Log) -> float:
    """Between the first two rows, s."""
    first, second = log.numbers("time")[:2]
    return second - first


def _some(numbers: list[str]) -> str:
    if len(numbers) == 1:
        return f"sample {numbers[0]}, 1"
    return f"samples {', '.join(numbers[:5])}{' ...' if len(numbers) > 5 else ''}, {len(numbers)}"


def write_csv(log: Log, path: Path) -> None:
    """As one table. A file that is there keeps its contents until the new ones are whole."""
    fresh = path.with_name(path.name + ".new")
    with fresh.open("w", encoding="utf-8", newline="") as out:
        for comment in log.comments:
            out.write(comment + "\n")
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(log.columns)
        writer.writerows(log.rows)
    fresh.replace(path)
