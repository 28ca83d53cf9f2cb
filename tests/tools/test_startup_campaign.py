"""The campaign of start-ups on other plants: its plants, what it reads from the console, rows that are kept, tables, and a few whole runs."""

import subprocess
import unittest
from concurrent.futures import Future
from typing import Callable
from unittest import mock

from support import FolderTest, call

import numpy as np

from reflux import build
from reflux.errors import UserError
from research import cmd_campaign, startup_campaign, startup_plants, startup_runs, startup_table

SAID = """\
50.000 > commission begin
50.000 < ok
7000.000 < ! 7000.000 info TEST_STEP u1 0.02 test of this input; amplitude, fraction of span
9000.000 < ! 9000.000 info PROPOSAL - 1 pairing determined, see `commission proposal`; probability
9010.000 > commission model
9010.000 < element y1 u1 gain 1.25 sd 0.02 %/% T 140 sd 5 s L 24 sd 2 s flags -
9010.000 < element y2 u1 gain 0.4 sd 0.01 %/% T 180 sd 6 s L 30 sd 2 s flags short not_settled
9010.000 < element y1 u2 gain 0.5 sd 0.01 %/% T 200 sd 8 s L 40 sd 3 s flags inverse
9010.000 < element y2 u2 gain 1.0 sd 0 %/% T 120 sd 6 s L 25 sd 2 s residence 150 sd 4 s flags -
9010.000 < ok
9010.000 > commission pairing
9010.000 < pairing determined probability 1 niederlinski 0.83
9010.000 < ok
9010.000 > commission edit
9010.000 < ok
9010.000 > diff
9010.000 < set loop1.name y1
9010.000 < set loop1.pv y1
9010.000 < set loop1.out u1
9010.000 < set loop1.gain 1.5
9010.000 < set loop1.ti 150
9010.000 < set loop2.name y2
9010.000 < set loop2.pv y2
9010.000 < set loop2.out u2
9010.000 < set loop2.gain 2
9010.000 < set loop2.ti 120
9010.000 < set loop2.action direct
9010.000 < ok
9010.000 > commission accept
9010.000 < ok
"""
KEPT = "12000.000 < ! 12000.000 info TRIAL_KEPT - 2 proposed loops matched the prediction and stay; loops\n"
BACK = "12000.000 < ! 12000.000 alarm TRIAL_FAILED y1 0 trial failed, the old settings return: did not come to rest on trial\n"
OPEN = """\
9000.000 < ! 9000.000 info NOT_DETERMINED - 0.4 pairing not determined, see `commission pairing`; probability
9010.000 < pairing not determined: a response was not seen to its end probability 1 niederlinski 0.8
9010.000 < doubt integrity 0.5: share of draws in which any loop may be in manual; 0.9 needed
9010.000 < doubt element y2 u1 half 900 s needs 2500 s flags short not_settled
9010.000 < doubt element y1 u1 half 900 s needs 1800 s flags not_settled
9010.000 < no proposal: not determined: a response was not seen to its end
"""
SLOW = "9000.000 < ! 9000.000 alarm COMMISSION_ENDED y1 0 automatic start-up given up: is too slow for `test.longest` or its `test_time`: raise it\n"


def row(**more: str) -> dict[str, str]:
    return {**dict.fromkeys(startup_campaign.FIELDS, ""), "plant": "plain", "kind": "first-order", "seed": "1", "noise": "0.001", "outcome": "kept",
            "proposed": "yes", "stable": "yes", "ms": "1.5", "gain_margin": "3", "niederlinski": "0.8", "hours_tests": "2", "starts": "1", **more}


class Plants(FolderTest):
    def test_there_are_enough_and_each_has_a_class(self) -> None:
        self.assertGreaterEqual(len(startup_plants.names()), 24)
        kinds = {startup_plants.case(name).kind for name in startup_plants.names() if name != "column"}
        for kind in ("damped", "inverse", "whole-inverse", "integrating", "near-integrating", "unstable", "dead-time", "two-scales", "slow-cross",
                     "one-way", "near-singular", "wrong-diagonal", "relative-gain", "recycle", "overshoot", "backlash", "stiction", "drift",
                     "gain-doubles"):
            self.assertIn(kind, kinds)

    def test_relative_gains_are_those_of_the_names(self) -> None:
        for name, expected in (("wrong-diagonal-10", -1.0), ("gain-5", 5.0), ("gain-20", 20.0), ("gain-60", 60.0)):
            gains = startup_plants.case(name).linear().gains()
            self.assertAlmostEqual(gains[0, 0] * np.linalg.inv(gains)[0, 0] / expected, 1.0, delta=0.02, msg=name)

    def test_random_ones_are_the_same_each_time_and_can_be_paired(self) -> None:
        for seed in range(27):
            case = startup_plants.randomly(seed)
            self.assertEqual(case.data, startup_plants.randomly(seed).data)
            self.assertTrue(case.linear().stable())
            self.assertIn(case.linear().shape[0], (2, 3, 4))

    def test_the_simulator_takes_them_and_has_the_same_gains(self) -> None:
        program = str(build.find_program("host", "reflux-sim-memory"))
        for name in ("damping-03", "inverse", "recycle", "mixed-three", "random-8", "random-24"):
            case = startup_plants.case(name)
            with self.subTest(plant=name):
                path = self.file(f"{name}.json", startup_plants.text(case))
                done = subprocess.run([program, "--steady", "--plant", str(path), "--set", "u1=51"], capture_output=True, text=True, check=False)
                self.assertEqual(done.returncode, 0, done.stderr)
                at = {w[1]: float(w[3]) for line in done.stdout.splitlines()[1:] if (w := line.split(",")) and len(w) > 3}
                for i, y in enumerate(case.data["outputs"]):
                    self.assertAlmostEqual(at[y["name"]] - 50.0, case.linear().gains()[i, 0], places=6)

    def test_the_simulator_runs_those_without_a_steady_state(self) -> None:
        program = str(build.find_program("host", "reflux-sim-memory"))
        for name in ("integrating", "unstable"):
            path = self.file(f"{name}.json", startup_plants.text(startup_plants.case(name)))
            done = subprocess.run([program, "--list", str(path)], capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)


class Console(unittest.TestCase):
    case = startup_plants.case("plain")

    def test_settings_and_flags_of_what_was_kept(self) -> None:
        said = startup_runs.read(SAID + KEPT, self.case)
        self.assertEqual((said.outcome, said.proposed, said.tested_s, said.end_s), ("kept", True, 9000.0, 12000.0))
        self.assertEqual(said.loops, [("y1", "u1", 1.5, 150.0, 0.0), ("y2", "u2", -2.0, 120.0, 0.0)])
        self.assertEqual(startup_runs.slow_elements(said, self.case), ["y2/u1:not_settled+short"])
        self.assertEqual(said.events, {"TEST_STEP": 1, "PROPOSAL": 1, "TRIAL_KEPT": 1})

    def test_deviations_are_errors_over_what_is_stated(self) -> None:
        found = {(y, u): (gain, time, is_open) for y, u, gain, time, is_open in
                 startup_runs.deviations(startup_runs.read(SAID + KEPT, self.case), self.case.linear())}
        self.assertAlmostEqual(found["y1", "u1"][0], (1.25 - 1.2) / 0.02)
        self.assertAlmostEqual(found["y1", "u1"][1], (164 - 170) / np.hypot(5, 2))
        self.assertEqual(found["y2", "u2"][:2], (0.0, (150 - 145) / 4))
        self.assertEqual([found[e][2] for e in (("y2", "u1"), ("y1", "u2"))], [True, False])

    def test_outcomes(self) -> None:
        back = startup_runs.read(SAID + BACK, self.case)
        self.assertEqual((back.outcome, back.reason), ("taken back", "y1 did not come to rest on trial"))
        still_open = startup_runs.read(OPEN, self.case)
        self.assertEqual((still_open.outcome, still_open.proposed), ("not determined", False))
        self.assertEqual(still_open.doubts, ["integrity", "y2/u1:short+not_settled", "y1/u1:not_settled"])
        self.assertEqual(startup_runs.read(OPEN.replace("not determined: a response was not seen to its end", "impossible: no pairs"),
                                           self.case).outcome, "refused")
        self.assertEqual(startup_runs.read("", self.case).outcome, "no end")

    def test_advice_is_what_the_board_says_or_four_times_as_long(self) -> None:
        self.assertEqual(startup_runs.read(OPEN, self.case).advice, ["mv1.test_time 2500"])
        slow = startup_runs.read(SLOW, self.case)
        self.assertEqual((slow.outcome, slow.advice), ("ended early", ["test.longest 40000"]))
        self.assertEqual(startup_runs.advice(SLOW, self.case, ["test.longest 20000"]), ["test.longest 80000"])
        self.assertEqual(startup_runs.advice(OPEN + "9010.000 < advice longer: `set test.longest 9000` instead of 1000 s\n", self.case),
                         ["test.longest 9000"])

    def test_an_element_that_does_integrate_may_be_called_so(self) -> None:
        said = startup_runs.read(SAID.replace("flags inverse", "flags integrating"), startup_plants.case("integrating"))
        self.assertEqual(startup_runs.slow_elements(said, startup_plants.case("integrating")), ["y2/u1:not_settled+short"])
        self.assertIn("y1/u2:integrating", startup_runs.slow_elements(said, self.case))


class Tables(unittest.TestCase):
    def test_harm_is_a_kept_set_that_is_unstable_or_wrongly_paired(self) -> None:
        rows = [row(), row(outcome="taken back", stable="no"), row(stable="no", seed="2"), row(niederlinski="-0.5", seed="3"),
                row(niederlinski="-0.5", kind="unstable")]
        self.assertEqual([line.split(":")[0] for line in startup_table.harmful(rows)], ["plain seed 2 noise 0.001", "plain seed 3 noise 0.001"])

    def test_demands_are_counted(self) -> None:
        rows = [row(), row(seed="2", ms="2.6"), row(seed="3", outcome="taken back"), row(seed="4", outcome="ended early", proposed="no", stable="",
                                                                                     ms="", gain_margin="", niederlinski="")]
        rows[0]["deviations"] = "y1/u1:2.5:0.1:0 y1/u2:0.1:nan:0 y2/u1:-9:1:1"
        rows[1]["excursion_tests"] = "1.2"
        engineers = [{"plant": "plain", "seed": str(k), "noise": "0.001", "stable": "yes", "ms": ms} for k, ms in ((1, "2"), (3, "2.1"), (4, "2.5"))]
        found = {line[0].split(",")[0]: line[2] for line in startup_table.demands(rows, engineers)[1]}
        self.assertEqual(found["kept with gain margin below 1.5 or Ms above 2.5"], "1 of 2 (50.0 %)")
        self.assertEqual(found["kept"], "0 of 1 (0.0 %)")  # the last of that name: where the engineer does not
        self.assertEqual(found["sound loops taken back"], "1 of 2 (50.0 %)")
        self.assertEqual(found["gains beyond 2 sd; beyond 3 sd"], "50.0; 0.0 of 2")
        self.assertEqual(found["elements left open by a flag"], "1 of 3 (33.3 %)")
        self.assertEqual(found["true limit passed by more than 5 %"], "1 of 4 (25.0 %)")
        self.assertIn("Ms 2.6", startup_table.text("title", rows, engineers))


class Rows(FolderTest):
    def test_what_has_a_row_is_not_run_again_and_a_torn_line_does_not_count(self) -> None:
        path, mark = self.folder / "startup.csv", ("program", "abc")
        rows = startup_campaign.Rows(path, startup_campaign.FIELDS, mark)
        for seed in ("1", "2"):
            rows.add(row(program="abc", seed=seed))
        path.write_text(path.read_text(encoding="utf-8") + "plain,first-order,3,0.0", encoding="utf-8")  # torn
        again = startup_campaign.Rows(path, startup_campaign.FIELDS, mark)
        self.assertEqual(sorted(again.done), [("plain", "1", "0.001"), ("plain", "2", "0.001")])
        ran = []
        jobs = [startup_campaign.Job("plain", seed, 0.001) for seed in (1, 2, 3)]
        with mock.patch.object(startup_campaign, "processes", Here):
            startup_campaign.run_missing("test", jobs, again, 1, "host", lambda job: ran.append(job) or row(program="abc", seed=str(job.seed)))
        self.assertEqual([job.seed for job in ran], [3])
        self.assertEqual(len(startup_campaign.Rows(path, startup_campaign.FIELDS, mark).done), 3)
        self.assertEqual(startup_campaign.Rows(path, startup_campaign.FIELDS, ("program", "new")).others, 3)

    def test_the_program_is_that_of_the_preset_in_use(self) -> None:
        self.addCleanup(startup_runs.use, "host")
        with mock.patch.object(build, "find_program", side_effect=lambda preset, name: self.folder / preset / name):
            self.assertEqual(startup_runs.program(), self.folder / "host" / "reflux-sim-memory")
            startup_runs.use("host-fixed")
            self.assertEqual(startup_runs.program(), self.folder / "host-fixed" / "reflux-sim-memory")

    def test_a_sample_is_the_beginning_of_one_order_and_takes_all_plants_in_turn(self) -> None:
        start = cmd_campaign.load("startup")
        jobs = start.jobs()
        self.assertEqual(jobs, start.jobs())
        self.assertEqual(len(set(jobs)), len(jobs))
        self.assertEqual(len(jobs), len(startup_plants.names()) * start.seeds * 3 + start.random)
        self.assertEqual({job.plant for job in jobs[:len(startup_plants.names())]}, set(startup_plants.names()))

    def test_options_of_another_campaign_are_refused(self) -> None:
        with self.assertRaises(UserError):
            cmd_campaign.main(["kalman", "--no-build", "--sample", "3"])
        status, _, err = call("campaign", "startup", "--no-build", "--sample", "0")
        self.assertNotEqual(status, 0)
        self.assertIn("must be 1 or more", err)


class Here:
    """An executor that runs everything at once, in this process."""

    def __init__(self, workers: int, preset: str):
        del workers, preset

    def __enter__(self) -> "Here":
        return self

    def __exit__(self, *error: object) -> None:
        pass

    def submit(self, function: Callable[..., object], *arguments: object) -> Future:
        done: Future = Future()
        done.set_result(function(*arguments))
        return done


class Whole(FolderTest):
    """Runs of the firmware. What must always hold of more of them: tools/campaign startup --check."""

    def test_an_easy_plant_is_kept_with_sound_loops(self) -> None:
        found = startup_campaign.run_one(startup_campaign.Job("plain", 1, 0.003), 1, 120.0)
        self.assertEqual(found["outcome"], "kept", found)
        self.assertTrue(startup_table.sound(found), found)
        self.assertEqual(set(found), set(startup_campaign.FIELDS))
        self.assertEqual(len(found["deviations"].split()), 4)
        self.assertLess(float(found["excursion_tests"]), 1.0)

    def test_advice_is_followed_in_a_further_start_up(self) -> None:
        found = startup_campaign.run_one(startup_campaign.Job("very-slow", 1, 0.001), 2, 120.0)
        self.assertIn(found["outcome"], ("kept", "not determined", "ended early", "taken back"))
        if found["starts"] == "1":
            self.assertEqual(found["advice"], "")

    def test_the_tables_of_a_small_sample_are_written_and_printed_again(self) -> None:
        status, out, err = call("campaign", "startup", "--no-build", "--jobs", "1", "--only", "one-way", "--sample", "2", "--out", str(self.folder))
        self.assertIn(status, (0, 1), err)
        self.assertIn("kept and unstable on the true plant", out)
        self.assertLessEqual({"startup.csv", "startup.md"}, {path.name for path in self.folder.iterdir()})
        _, again, _ = call("campaign", "startup", "--no-build", "--table", "--out", str(self.folder))
        self.assertEqual(again.count("| one-way | 2 |"), 2)  # by class and by plant


if __name__ == "__main__":
    unittest.main()
