"""What tools/console --watch shows of a board: loops, outputs and alarms, from its telemetry and a few listings."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field

from reflux.logs import TELEMETRY_VERSION, bare, unit
from reflux.scenario_settings import in_use

MODES = {0: "manual", 1: "auto", 2: "cascade"}
QUALITIES = {1: "uncertain", 2: "bad", 3: "missing"}
ALARMS_SHOWN = 4
EVENT = re.compile(r"^! *([\d.]+) (info|warning|alarm) (.*)$")


@dataclass
class BoardState:
    columns: list[str] = field(default_factory=list)
    units: dict[str, str] = field(default_factory=dict)
    row: dict[str, float] = field(default_factory=dict)
    loops: list[tuple[str, str, str]] = field(default_factory=list)  # name, measurement, output
    alarms: list[str] = field(default_factory=list)

    def telemetry(self, line: str) -> None:
        """An H or T line. A row that has lost something is left out."""
        cells = line.split(",")[1:]
        if line.startswith("H,") and cells and cells[0] == TELEMETRY_VERSION:
            self.columns, self.row = [bare(c) for c in cells[1:]], {}
            self.units = {bare(c): unit(c) for c in cells[1:]}
        elif line.startswith("T,") and len(cells) == len(self.columns) + 1:
            try:
                self.row = {name: float(cell or "nan") for name, cell in zip(self.columns, cells[1:])}
            except ValueError:
                return

    def forget(self) -> None:
        """A board that has restarted is not where its last row was."""
        self.row = {}

    def configuration(self, lines: list[str]) -> None:
        """The reply to `list`."""
        values = {name: value.split()[0] if value.split() else "-" for name, _, value in (line.partition(" = ") for line in lines)}
        self.loops = [(name, values.get(f"{k}.pv", "-"), values.get(f"{k}.out", "-")) for name, k in in_use(values, "loop").items()]

    def lines(self, width: int) -> list[str]:
        """As many for the same configuration and number of alarms, so that the screen does not jump."""
        out = [self.head(), *self.table()]
        rest = [self.value(name) for name in self.measurements() if name not in {pv for _, pv, _ in self.loops}]
        rest += [self.value(name, ".app") for name in self.outputs() if name not in {mv for _, _, mv in self.loops}]
        out += [", ".join(rest)] if rest else []
        out += [f"ALARM  {alarm}" for alarm in self.alarms[:ALARMS_SHOWN]] or ["no alarm"]
        if len(self.alarms) > ALARMS_SHOWN:
            out.append(f"and {len(self.alarms) - ALARMS_SHOWN} more: `alarm` lists them")
        return [line[:width] for line in out]

    def head(self) -> str:
        if not self.row:
            return "no telemetry yet: is a plant connected and the configuration applied?"
        seconds = int(self.row.get("time", 0.0))
        state = "run" if self.row.get("state") == 1 else "SAFE STATE: outputs at their safe values"
        return f"plant time {seconds // 3600}:{seconds // 60 % 60:02d}:{seconds % 60:02d}, {state}"

    def table(self) -> list[str]:
        rows = [["loop", "mode", "PV / SP", "output"]]
        for name, pv, out in self.loops:
            mode = MODES.get(int(self.row.get(f"{name}.mode", math.nan)) if math.isfinite(self.row.get(f"{name}.mode", math.nan)) else -1, "-")
            setpoint = f"{figure(self.row.get(f'{name}.sp', math.nan))} {self.units.get(pv, '')}".rstrip()
            driven = self.value(out, ".app") if f"{out}.app" in self.columns else f"setpoint of {out}"
            rows.append([name, mode, f"{self.value(pv, with_unit=False)} / {setpoint}", driven])
        widths = [max(len(row[i]) for row in rows) for i in range(4)]
        return ["  ".join(cell.ljust(w) for cell, w in zip(row, widths)).rstrip() for row in rows] if self.loops else ["no loops are configured"]

    def measurements(self) -> list[str]:
        return [name.removesuffix(".q") for name in self.columns if name.endswith(".q")]

    def outputs(self) -> list[str]:
        return [name.removesuffix(".app") for name in self.columns if name.endswith(".app")]

    def value(self, name: str, column: str = "", with_unit: bool = True) -> str:
        text = f"{name} {figure(self.row.get(name + column, math.nan))}"
        text += f" {self.units.get(name + column, '')}" if with_unit else ""
        quality = self.row.get(f"{name}.q", 0.0)
        return text.rstrip() + (f" ({QUALITIES[int(quality)]})" if quality in QUALITIES else "")


def figure(value: float) -> str:
    """Four significant digits."""
    return f"{value:.4g}" if math.isfinite(value) else "-"
