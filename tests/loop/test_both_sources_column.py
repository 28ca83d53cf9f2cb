#!/usr/bin/python3
"""The pilot column with some channels at the board's own pins and the others at the plant link, which is unplugged for a while."""

import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from pilot_at_pins import BY_LINK, REST_ON_LINK, WIRING, read, settings, simulate  # noqa: E402

DURATION_S, UNPLUGGED_S, FOR_S = 300, 150, 40
LATER = ((3, "out Lr 4.5"), (3, "out Qrb 0.8"), (10, "mode top auto"), (10, "mode bottom auto"))


class ColumnTest(unittest.TestCase):
    def setUp(self) -> None:
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory(prefix="reflux-")))

    def run_column(self, name: str, *options: str, source: str = "both", without: str = "", load: str = "",
                   later: tuple[tuple[int, str], ...] = LATER) -> Path:
        """The folder with log, telemetry and transcript. without: settings of an output of this row are left out, with the line of its load."""
        out = self.folder / name
        wiring = self.folder / f"{name}.wiring"
        wiring.write_text("".join(f"{line}\n" for line in WIRING.read_text(encoding="utf-8").splitlines() if not load or not line.startswith(load)),
                          encoding="utf-8")
        simulate(out, DURATION_S, settings(source, without), later, *REST_ON_LINK, *options, wiring=wiring)
        return out

    def rows(self, out: Path) -> list[dict[str, str]]:
        """The telemetry of plant time: a row for each of its seconds."""
        return read(out / "telemetry.csv")[-DURATION_S - 1:]

    UNPLUGGED = ("--event", f"{UNPLUGGED_S}:board.unplug_link={FOR_S}")

    def test_readings_of_the_link_are_those_of_the_tick_before(self) -> None:
        out = self.run_column("run")
        rows, log = self.rows(out), read(out / "simulator.csv")
        for at in range(10, DURATION_S):
            for name in BY_LINK:
                self.assertEqual(rows[at][f"{name}.q"], "0")
                self.assertAlmostEqual(float(rows[at][name]), float(log[at - 1][f"{name}.meas"]), delta=1e-3, msg=f"{name} at {at} s")

    def test_loops_at_the_pins_do_not_notice_that_the_link_is_unplugged(self) -> None:
        whole, cut = self.rows(self.run_column("whole")), self.rows(self.run_column("cut", *self.UNPLUGGED))
        for name in ("T1", "T10", "top.mode", "bottom.mode", "Lr.cmd", "Qrb.cmd", "state"):
            self.assertEqual([row[name] for row in whole], [row[name] for row in cut], name)
        left = self.rows(self.run_column("left", *self.UNPLUGGED, later=tuple(line for line in LATER if "mode" not in line[1])))
        for name, setpoint in (("T1", "top.sp"), ("T10", "bottom.sp")):
            away, unheld = (sum(abs(float(row[name]) - float(held[setpoint])) for row, held in zip(rows[-60:], cut[-60:])) for rows in (cut, left))
            self.assertLess(away, unheld, f"{name}: no nearer than a column in manual")

    def test_channels_of_the_link_fall_and_come_back(self) -> None:
        rows = self.rows(self.run_column("cut", *self.UNPLUGGED))
        for name in BY_LINK:
            self.assertTrue(all(row[f"{name}.q"] == "0" for row in rows[10:UNPLUGGED_S]))
            self.assertTrue(all(row[f"{name}.q"] != "0" for row in rows[UNPLUGGED_S + 4:UNPLUGGED_S + FOR_S]))
            self.assertTrue(all(row[f"{name}.q"] == "0" for row in rows[UNPLUGGED_S + FOR_S + 3:]))

    def test_a_loop_with_its_output_at_the_link_goes_to_manual_and_the_other_holds(self) -> None:
        out = self.run_column("cut", *self.UNPLUGGED, without="set out1.", load="Lr")
        rows, log = self.rows(out), read(out / "simulator.csv")
        before, after = rows[UNPLUGGED_S - 1], rows[-1]
        self.assertEqual((before["top.mode"], before["bottom.mode"]), ("1", "1"))
        self.assertEqual((after["top.mode"], after["bottom.mode"]), ("0", "1"))
        for at in range(20, UNPLUGGED_S):  # what the link commands is what the plant gets
            self.assertAlmostEqual(float(log[at]["Lr.cmd"]), float(rows[at]["Lr.cmd"]), delta=1e-4, msg=f"at {at} s")
        self.assertEqual({float(row["Lr.cmd"]) for row in log[UNPLUGGED_S + 5:]}, {4.5})  # safe, and so it stays
        self.assertIn("MANUAL_BY_BOARD top", (out / "transcript.txt").read_text(encoding="utf-8"))

    def test_a_run_repeats_to_the_bit(self) -> None:
        first, second = self.run_column("first", *self.UNPLUGGED), self.run_column("second", *self.UNPLUGGED)
        for kept in ("simulator.csv", "telemetry.csv", "transcript.txt"):
            self.assertEqual((first / kept).read_bytes(), (second / kept).read_bytes(), kept)

    def test_a_board_that_does_not_look_at_its_link_has_none_of_it(self) -> None:
        rows = self.rows(self.run_column("board", source="board"))
        self.assertEqual({row[f"{name}.q"] for row in rows for name in BY_LINK}, {"3"})
        self.assertEqual({row["T1.q"] for row in rows}, {"0"})


if __name__ == "__main__":
    unittest.main()
