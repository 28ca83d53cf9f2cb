#!/usr/bin/python3
"""tools/consistency on recorded runs of the splitter and of the methanol column: the replay is what the board had, the noise of thermometers
is found, one that is off is named and by how much, and where no covariance does it that is said (docs/methods/consistency.md)."""

import contextlib
import io
import json
import math
import re
import shutil
import sys
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
sys.dont_write_bytecode = True

from reflux import recorded_run, replay, runner, scenario  # noqa: E402
from reflux.__main__ import call  # noqa: E402
from reflux.scenario import Event, Line  # noqa: E402

HOUR = 3600.0
SPLITTER, METHANOL = ("T30", "T31", "T33"), ("T4", "T12")
SURE = 4.0  # standard deviations
SECOND_DIFFERENCES = 0.99  # of a standard deviation found by them, times the root of the number of samples: its relative error


def record(name: str, folder: Path, hours: float, events: list[Event], more: tuple[str, ...] = (), keep_feed: bool = False) -> Path:
    """A run of a scenario of the repository by the reduced EKF, without what happens to its feed, with these events."""
    base = scenario.load(ROOT / "host_sim" / "scenarios" / f"{name}.toml")
    rows = [line.text.replace("method geometric", "method rekf") for line in base.config]
    block = next(m[1] for row in rows if (m := re.match(r"set (block\d)\.kind composition", row)))
    rows = [*rows[:-1], f"set {block}.method rekf", *more, rows[-1]]
    lines = [line for line in base.lines if line.at_s < hours * HOUR] + [Line(hours * HOUR, f"block {block[-1]}")]
    feed = [e for e in base.events if keep_feed and 0 < e.at_s < hours * HOUR]
    played = replace(base, firmware="memory", noise=1.0, duration_s=hours * HOUR, config=tuple(Line(0.0, row) for row in rows), lines=tuple(lines),
                     events=(*feed, *events))
    runner.run(played, runner.Options(folder, quiet=True))
    return folder


def noise(names: tuple[str, ...], sd: float) -> list[Event]:
    return [Event(0.0, f"{name}.noise", sd) for name in names]


def check(*arguments: object) -> dict:
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        status = call("consistency", ["check", *map(str, arguments), "--no-build", "--format", "json"])
    assert status == 0, err.getvalue()
    return json.loads(out.getvalue())


class Runs(unittest.TestCase):
    def setUp(self) -> None:
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory(prefix="reflux-")))

    def test_what_the_replay_is_told_is_what_the_board_had(self) -> None:
        """To the last digit, with loops that act, a feed that swings and a filter on a reading."""
        run = record("splitter-estimate", self.folder / "run", 1.5, noise(SPLITTER, 0.2), ("set meas1.filter 20",), keep_feed=True)
        of, block = recorded_run.read(run, [], None)
        said = {name: float(text) for line in runner.replies_in(run / "transcript.txt", "block 3") if (m := re.match(r" *(\w+) = (\S+)$", line))
                for name, text in [m.groups()]}
        played = replay.play(of, block, {})
        self.assertEqual(len(played.time_s), 541)
        self.assertGreater(len(said), 10)
        for name in ("states", "distillate", "bottoms", "e_1", "e_2", "e_3", "slope_1", "slope_3"):
            self.assertEqual(played.values_of(name)[-2], said[name], name)  # asked before the last sample

    def test_the_noise_of_the_thermometers_is_found(self) -> None:
        """Also where the model is off and its feed is not what it was. Resolution 0.01 K."""
        for sd, feed in ((0.3, False), (0.1, True)):
            run = record("splitter-estimate", self.folder / f"{sd}", 2.0, noise(SPLITTER, sd), keep_feed=feed)
            found = check(run)
            one = found["replays"][0]
            n = sum(t["ticks"] for t in one["thermometers"])
            self.assertGreater(n, 1200)
            self.assertLess(abs(one["proposed"]["noise"] / sd - 1), SURE * SECOND_DIFFERENCES / math.sqrt(n))
            self.assertFalse(found["consistent"])
            self.assertEqual(one["odd"], "")

    def test_covariances_that_fit_are_found_where_the_model_does(self) -> None:
        run = record("methanol-estimate", self.folder / "run", 3.0, noise(METHANOL, 0.3))
        before = check(run, "--set", "noise=0.05")
        self.assertFalse(before["consistent"])
        self.assertTrue(any("`noise` is too small" in v["words"] for v in before["replays"][0]["verdicts"]), before)
        found = check(run, "--set", "noise=0.05", "--try")
        self.assertTrue(found["consistent"], found["reasons"])
        last = found["replays"][-1]
        n = sum(t["ticks"] for t in last["thermometers"])
        self.assertLess(abs(last["setting"]["noise"] / 0.3 - 1), SURE * SECOND_DIFFERENCES / math.sqrt(n))
        again = check(run, "--set", f"noise={last['setting']['noise']:.3g}", "--set", f"model={last['setting']['model']:.3g}")
        self.assertTrue(again["consistent"])

    def test_a_thermometer_that_is_off_is_named_with_its_offset_and_nothing_widened_for_it(self) -> None:
        """1 K; a model of lumped components puts those that are right a tenth of a kelvin apart."""
        for name in ("T31", "T33"):
            run = record("splitter-estimate", self.folder / name, 1.5, [*noise(SPLITTER, 0.2), Event(0.0, f"{name}.bias", 1.0)])
            found = check(run, "--try")
            self.assertEqual(found["replays"][0]["odd"], name)
            self.assertEqual(found["offset"]["thermometer"], name)
            self.assertAlmostEqual(found["offset"]["K"], 1.0, delta=0.2)
            self.assertEqual(found["replays"][1]["odd"], "")

    def test_where_no_covariance_does_it_that_is_said(self) -> None:
        """The feed changes, which the reduced EKF does not estimate."""
        run = record("methanol-estimate", self.folder / "run", 3.5, noise(METHANOL, 0.1), keep_feed=True)
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            self.assertEqual(call("consistency", ["check", str(run), "--try", "--no-build"]), 0)
        self.assertIn("no covariance makes it so: ", out.getvalue())
        self.assertNotIn("\nconsistent", out.getvalue())
        self.assertTrue((run / "consistency.png").read_bytes().startswith(b"\x89PNG"))

    def test_telemetry_of_a_board_alone_says_the_same_as_the_whole_log(self) -> None:
        run = record("methanol-estimate", self.folder / "run", 2.0, noise(METHANOL, 0.3))
        shutil.copy(run / "telemetry.csv", self.folder / "session.txt")
        conf = self.folder / "a.conf"
        conf.write_text("\n".join(line.split(" ", 1)[1] for line in (run / "script.txt").read_text().splitlines() if " set " in line
                                  or line.endswith((" begin", " apply"))), encoding="utf-8")
        whole, alone = check(run)["replays"][0], check(self.folder / "session.txt", "--conf", conf)["replays"][0]
        for a, b in zip(whole["thermometers"], alone["thermometers"]):
            self.assertAlmostEqual(a["nis"], b["nis"], delta=0.01)
            self.assertAlmostEqual(a["rho"], b["rho"], delta=0.01)

    def test_a_method_without_covariances_and_lines_that_the_firmware_refuses_are_told(self) -> None:
        run = record("methanol-estimate", self.folder / "run", 1.0, [])
        for more, why in ((("--set", "method=geometric"), "has no covariances"), (("--set", "noise=-1"), "err RANGE"), (("--set", "nose=1"), "err UNKNOWN"),
                          (("--to", "0.3"), "nothing is left between"),
                          (("--from", "5"), "nothing is left between"), (("--block", "7"), "no block of the kind composition; there is 2")):
            err = io.StringIO()
            with contextlib.redirect_stderr(err):
                self.assertNotEqual(call("consistency", ["check", str(run), *more, "--no-build"]), 0)
            self.assertIn(why, err.getvalue())


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
