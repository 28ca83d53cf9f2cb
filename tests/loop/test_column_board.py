#!/usr/bin/python3
"""The lines of `tools/column FILE --board` on the firmware, for a column that is none of the repository's plants
(tests/tools/data/hexanes.json, ours) and for others made of it: pasted as printed, and what the loops and the estimator then do."""

import copy
import itertools
import json
import os
import select
import sys
import tempfile
import tty
import unittest
from collections.abc import Callable
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / part) for part in ("tools", "tests/tools", "tests/loop", "tests/support")]

import sample  # noqa: E402
from column_draws import draws  # noqa: E402
from support import board, call, told  # noqa: E402

from reflux import board_lines, build, column_loops, runner  # noqa: E402
from reflux import linear_analysis as linear  # noqa: E402
from reflux.scenario import Event, Line, Loop, Scenario  # noqa: E402

HEXANES = ROOT / "tests" / "tools" / "data" / "hexanes.json"
HOUR, PERCENT = 3600.0, 1.2  # s; K, of a thermometer's span
XON, XOFF = 0x11, 0x13
GOOD = "0"


def hexanes() -> dict[str, Any]:
    return json.loads(HEXANES.read_text(encoding="utf-8"))


def levels_open(plant: dict[str, Any]) -> None:
    """Four manipulated variables and two levels that no flow of the file holds."""
    plant["levels"] = {"condenser": {"by": "none"}, "reboiler": {"by": "none"}}
    plant["inputs"] += [{"name": "DC", "is": "distillate", "unit": "t/h", "lo": 0, "hi": 10}, {"name": "BC", "is": "bottoms", "unit": "t/h", "lo": 0, "hi": 15}]
    plant["outputs"] += [{"name": f"L{s}", "is": "level", "stage": s, "unit": "%", "lo": 0, "hi": 100} for s in (28, 1)]


def many_outputs(plant: dict[str, Any]) -> None:
    """More than a board has room for, an analyser among them."""
    plant["outputs"] += [{"name": f"TI{s}", "is": "temperature", "stage": s, "unit": "degC", "lo": 40, "hi": 160} for s in (2, 3, 4, 6, 7, 9)]
    plant["outputs"].append({"name": "AD", "is": "fraction", "of": "heptane", "stage": 28, "unit": "-", "lo": 0, "hi": 0.2, "every_s": 300, "delay_s": 120})


def long_names(plant: dict[str, Any]) -> None:
    for channel in plant["outputs"]:
        channel["name"] = f"column_{channel['name']}"


def a_loops_name(plant: dict[str, Any]) -> None:
    plant["outputs"][4]["name"] = "top"
    plant["title"] = "Säule"


def four_components_and_forty_stages(plant: dict[str, Any]) -> None:
    plant["stages"], plant["feed_stage"], plant["temperature_range"] = 40, 19, [280, 470]
    plant["components"].append(plant["components"][2] | {"name": "nonane", "vapour_pressure": [20.95, 3310, -70.5], "boiling_point": 424, "critical_temperature": 594.6})
    plant["constants"]["feed_fraction"] = [{"of": "octane", "value": 15, "unit": "%"}, {"of": "nonane", "value": 10, "unit": "%"}]
    plant["truths"][0]["stage"] = 40
    plant["outputs"][4]["stage"] = 31


class Pasted(unittest.TestCase):
    def setUp(self) -> None:
        build.build("host", ("reflux-host", "reflux-sim", "libreflux"), quiet=True)
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory(prefix="reflux-")))

    def lines(self, change: Callable[[dict[str, Any]], None] | None) -> list[str]:
        plant = copy.deepcopy(hexanes())
        if change:
            change(plant)
        (self.folder / "column.json").write_text(json.dumps(plant), encoding="utf-8")
        status, out, err = call("column", str(self.folder / "column.json"), "--board")
        self.assertEqual(status, 0, err)
        return out.splitlines()

    def paste(self, console: str, lines: list[str]) -> list[str]:
        """All at once, as a terminal with flow control does it: the replies."""
        port = os.open(console, os.O_RDWR | os.O_NOCTTY)
        tty.setraw(port)
        left, heard, stopped = "".join(f"{line}\n" for line in ("mode machine", *lines)).encode("ascii"), b"", False
        try:
            while replies(heard) <= len(lines):
                readable, writable, _ = select.select([port], [port] if left and not stopped else [], [], 10)
                self.assertTrue(readable or writable, f"no reply any more after {heard[-300:]!r}")
                if readable:
                    for byte in os.read(port, 4096):
                        stopped = byte == XOFF or (stopped and byte != XON)
                        heard += b"" if byte in (XON, XOFF) else bytes([byte])
                elif writable:
                    left = left[os.write(port, left[:64]) :]
        finally:
            os.close(port)
        return heard.decode("ascii").splitlines()

    def test_one_paste_is_taken_as_printed_and_is_all_that_the_board_then_has(self) -> None:
        program = str(build.find_program("host", "reflux-host"))
        for change in (None, levels_open, many_outputs, long_names, a_loops_name, four_components_and_forty_stages):
            with self.subTest(change.__name__ if change else "as it is"):
                lines = self.lines(change)
                with board(program) as console:  # which is another column's so far
                    self.assertEqual([line for line in self.paste(console, lines) if line.startswith("err ")], [])
                    there = dict(line.split(None, 2)[1:] for line in told(console, "diff defaults") if line.startswith("set "))
                wanted = dict(line.split(None, 2)[1:] for line in lines if line.startswith("set "))
                for name in there.keys() | {n for n in wanted if n.endswith((".name", ".kind", ".pv", ".out"))}:
                    self.assertIn(name, wanted)
                    self.assertIn(name, there)


def replies(heard: bytes) -> int:
    return sum(line == b"ok" or line.startswith(b"err ") for line in heard.splitlines())


def scenario(file: Path, plant: dict[str, Any], lines: list[str], hours: float, events: tuple[Event, ...], after: tuple[Line, ...] = (), **more: Any) -> Scenario:
    """The paste, the outputs of its last remarks, and after an eighth of the time the modes and setpoints of these."""
    settings = dict(line.split(None, 2)[1:] for line in lines if line.startswith("set "))
    names = [name for name in settings if name.startswith("loop") and name.endswith(".name")]
    loops = tuple(Loop(settings[name], settings[name.replace("name", "pv")], settings[name.replace("name", "out")]) for name in names)
    outs = [Line(0.0, line[4:]) for line in lines if line.startswith("#   out ")]
    modes = [Line(hours * HOUR / 8, word) for line in lines if line.startswith("#   mode ") for word in line[4:].split(", then ")]
    config = tuple(Line(0.0, line) for line in lines if not line.startswith("#"))
    return Scenario(file, plant["name"], plant["title"], str(file), hours * HOUR, firmware="memory", loops=loops, config=config,
                    lines=(*outs, *modes, *after), events=events, **more)  # fmt: skip


class Run(unittest.TestCase):
    """Eight hours on the column itself: a richer feed, then less of it, then a setpoint."""

    @classmethod
    def setUpClass(cls) -> None:
        build.build("host", ("reflux-sim", "reflux-sim-memory", "libreflux"), quiet=True)
        with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
            run = scenario(HEXANES, hexanes(), board_lines.lines(str(HEXANES), (), hexanes()), 8, (Event(2 * HOUR, "zF", 44), Event(4.5 * HOUR, "F", 8.5)),
                           (Line(6.5 * HOUR, "sp top 82"),))  # fmt: skip
            result = runner.run(run, runner.Options(Path(folder) / "out", quiet=True))
            cls.log, cls.events = result.log, runner.events_in(Path(folder) / "out" / "transcript.txt")

    def reading(self, name: str, hours: float) -> float:
        return self.log.numbers(name)[int(hours * HOUR / 10)]

    def test_the_board_finds_every_channel_and_raises_no_alarm(self) -> None:
        self.assertEqual([e for e in self.events if e[2].startswith("CHANNEL_") or e[1] == "alarm"], [])

    def test_both_temperatures_are_held_through_changes_of_the_feed(self) -> None:
        for name, setpoint in (("TI19.true", 78.997), ("TI8.true", 99.294)):
            for hours in (1.9, 4.4, 6.4):
                self.assertAlmostEqual(self.reading(name, hours), setpoint, delta=PERCENT)

    def test_a_setpoint_is_reached_while_the_other_loop_stays(self) -> None:
        self.assertAlmostEqual(self.reading("TI19.true", 7.9), 82, delta=PERCENT)
        self.assertAlmostEqual(self.reading("TI8.true", 7.9), 99.294, delta=PERCENT)

    def test_both_products_are_estimated_within_a_tenth_and_called_good(self) -> None:
        for name in ("xD", "xB"):
            quality = self.log.text(f"fw.{name}_est.q")
            for hours in (1.9, 3.0, 4.4, 5.5, 6.4, 7.9):
                true = self.reading(name, hours)
                self.assertAlmostEqual(self.reading(f"fw.{name}_est", hours), true, delta=0.1 * true)
                self.assertEqual(quality[int(hours * HOUR / 10)], GOOD)


class Drawn(unittest.TestCase):
    """Columns drawn at random: the board takes the paste, and the loops hold what they hold through a richer feed, less of it, a leaner one.
    One loop in twenty may lose it: that of a column so pure that its temperature has nowhere to go on one side."""

    FIRST_SEED, COLUMNS = (1000, 40) if sample.EVERY else (1, 3)
    HELD = 0.02  # of the span, at the end of each change

    def test_their_loops_hold_what_they_control(self) -> None:
        build.build("host", ("reflux-sim", "reflux-sim-memory", "libreflux"), quiet=True)
        loops, lost = 0, []
        with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
            for plant, file in itertools.islice(draws(self.FIRST_SEED, Path(folder)), self.COLUMNS):
                far = self.run_one(plant, file, Path(folder) / "out")
                loops += len(far)
                lost += [f"{plant['name']} {name}: {part:.1%} of the span" for name, part in far.items() if part > self.HELD]
        print(f"{loops} loops of {self.COLUMNS} columns; lost: {', '.join(lost) or 'none'}")
        self.assertLessEqual(len(lost), loops / 20, lost)

    def run_one(self, plant: dict[str, Any], file: Path, out: Path) -> dict[str, float]:
        """Distance of each loop from its setpoint at the ends of the changes, part of the span; none where a remark calls them no loops."""
        lines = board_lines.lines(str(file), (), plant)
        slowest = -1 / linear.poles(column_loops.model_of(str(file), ()))[0].real
        part = min(max(6 * slowest, 2 * HOUR), 40 * HOUR)  # between two changes
        feed, z = plant["disturbances"]
        events = (Event(part, "z", min(1.06 * z["nominal"], z["hi"])), Event(2 * part, "F", 0.9 * feed["nominal"]), Event(3 * part, "z", 0.95 * z["nominal"]))
        tick = max(plant["tick_s"], round(part / 5000))
        run = scenario(file, plant, lines, 4 * part / HOUR, events, tick_s=tick)
        log = runner.run(run, runner.Options(out, quiet=True)).log
        if any("relative gain above" in line for line in lines):
            return {}
        far = {}
        for loop in run.loops:
            setpoint = next(float(line.text.split()[-1]) for line in run.lines if line.text.startswith(f"sp {loop.name} "))
            values = log.numbers(f"{loop.pv}.true")
            ends = [v for k in range(1, 5) for v in values[int((k - 0.1) * part / tick) : int(k * part / tick)]]
            far[loop.name] = max(abs(v - setpoint) for v in ends) / column_loops.span(next(c for c in plant["outputs"] if c["name"] == loop.pv))
        return far


if __name__ == "__main__":
    unittest.main()
