"""reflux.Lab: a board and a plant in this process, and a board on a port; the log it gives; the doors to the firmware's methods; a Gymnasium environment."""

import concurrent.futures
import contextlib
import copy
import importlib.util
import json
import logging
import math
import os
import pickle
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import warnings
from pathlib import Path
from unittest import mock

from support import ROOT, FolderTest

import numpy as np
import reflux
from reflux import Lab, Plant, Refused, Scenario, build, lab_log, launch, libreflux, logs, runner
from reflux.errors import RunFailed, UserError
from reflux.in_process import LIBRARY, Taken


def setUpModule() -> None:
    build.build("host", ("reflux-sim", "reflux-sim-memory", "reflux-host", "libreflux", "libreflux_lab"), quiet=True)


def loaded() -> int:
    """Places of copies of the library in this process."""
    return sum(LIBRARY in line for line in Path("/proc/self/maps").read_text(encoding="utf-8").splitlines())


class LabTest(FolderTest):
    """A lab of its own for each test."""

    def setUp(self) -> None:
        super().setUp()
        self.lab = self.enterContext(Lab("pilot"))


class SameLog(FolderTest):
    def test_a_scenario_gives_the_log_of_the_tool_bit_for_bit(self) -> None:
        scenario = Scenario.named("demo")
        runner.run(scenario.with_options(firmware="memory"), runner.Options(self.folder / "run", quiet=True))
        with Lab(scenario) as lab:
            lab.play(csv=self.folder / "lab.csv")
        self.assertEqual((self.folder / "lab.csv").read_bytes(), (self.folder / "run" / "log.csv").read_bytes())

    def test_two_labs_at_once_do_not_disturb_one_another(self) -> None:
        with Lab("pilot", seed=5) as alone:
            alone.mode("bottom", "auto")
            expected = np.asarray(alone.run(ticks=20)["T10"])
        with Lab("pilot", seed=5) as one, Lab("pilot", seed=6) as other:
            one.mode("bottom", "auto")
            for _ in range(20):
                one.step()
                other.step()
            with Lab("pilot", seed=5) as again:
                again.mode("bottom", "auto")
                found = [again.run(ticks=1)["T10"][0] for _ in range(20)]
            self.assertEqual(np.float32(one.T10), np.float32(expected[-1]))
            self.assertNotEqual(np.float32(other.T10), np.float32(expected[-1]))
        self.assertEqual(list(found), list(expected))


class Threads(LabTest):
    def run_together(self, works: list) -> list:
        """What each of the functions returned; what one raised is raised."""
        with concurrent.futures.ThreadPoolExecutor(len(works)) as pool:
            return [one.result() for one in [pool.submit(work) for work in works]]

    def test_threads_that_share_a_lab_take_turns(self) -> None:
        lab, replies = self.lab, 60

        def stepping() -> None:
            for _ in range(replies):
                lab.step(2)

        def asking() -> None:
            for k in range(replies):
                lab.set("bottom.gain", 1.0 + k)
                self.assertTrue(lab.command("status").startswith("state "))
                self.assertEqual(list(lab.loops), ["top", "bottom"])
                self.assertTrue(set(lab.measurements) == {"T1", "T10"})

        def logging_on() -> int:
            return sum(len(lab.run(ticks=3)) for _ in range(replies))

        self.assertEqual(self.run_together([stepping, asking, logging_on, asking, logging_on])[2], 3 * replies)
        self.assertEqual(lab.time_s, 30.0 * replies * (2 + 3 + 3))

    def test_a_close_waits_for_its_turn(self) -> None:
        started = threading.Event()

        def stepping() -> str:
            try:
                for _ in range(100000):
                    self.lab.step()
                    started.set()
            except RunFailed as error:
                return str(error)
            return "never closed"

        def closing() -> None:
            started.wait(20)
            self.lab.close()

        self.assertEqual(self.run_together([stepping, closing])[0], "the lab is closed")

    def test_a_child_of_fork_does_not_wait_for_a_thread_that_it_lacks(self) -> None:
        running, over = threading.Event(), threading.Event()

        def holding() -> None:
            with self.lab._turn:
                running.set()
                over.wait(60)

        def forking() -> int:
            running.wait(20)
            child = os.fork()
            if child == 0:
                said = ""
                try:
                    signal.alarm(20)
                    self.lab.command("status")
                except RunFailed as error:
                    said = str(error)
                finally:
                    os._exit(7 if said == "the lab is closed" else 1)
            try:
                return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
            finally:
                over.set()

        self.assertEqual(self.run_together([holding, forking])[1], 7)
        self.assertTrue(self.lab.command("status"))

    def test_labs_in_threads_of_their_own_are_independent(self) -> None:
        def alone(seed: int) -> list[float]:
            with Lab("pilot", seed=seed) as lab:
                lab.mode("bottom", "auto")
                found: list[float] = []
                for k in range(40):
                    lab.setpoint("bottom", 108.0 + 0.1 * ((k + seed) % 7))
                    found += list(lab.run(ticks=5)["T10"])
                return found

        seeds = [1, 2, 3, 4]
        expected = [alone(seed) for seed in seeds]
        self.assertEqual(self.run_together([lambda seed=seed: alone(seed) for seed in seeds]), expected)
        self.assertNotEqual(expected[0], expected[1])


class Operating(LabTest):
    def test_a_loop_in_auto_holds_its_setpoint(self) -> None:
        self.lab.mode("bottom", "auto")
        self.lab.setpoint("bottom", 108.5)
        log = self.lab.run(hours=2)
        self.assertEqual(len(log), 240)
        self.assertEqual(self.lab.time_s, 7200.0)
        self.assertLess(abs(float(np.mean(log["T10"][-60:])) - 108.5), 0.2)
        self.assertEqual(self.lab.loops["bottom"], {"mode": "auto", "pv": "T10", "out": "Qrb", "sp": 108.5})

    def test_a_refusal_is_an_exception_with_the_words_of_the_console(self) -> None:
        with self.assertRaisesRegex(Refused, r"^err UNKNOWN nowhere: no such loop; `loop` lists them$"):
            self.lab.mode("nowhere", "auto")
        with self.assertRaisesRegex(Refused, r"^err RANGE Lr: 99 refused, allowed: 1 \.\. 9 l/h$"):
            self.lab.output("Lr", 99)
        self.assertTrue(self.lab.command("status"))

    def test_a_parameter_is_set_and_read(self) -> None:
        self.lab.set("bottom.gain", 2.5)
        self.assertEqual(self.lab.get("bottom.gain"), "2.5")
        self.lab.set("bottom.action", "direct")
        self.assertEqual(self.lab.get("bottom.action"), "direct")

    def test_channels_have_the_names_of_teachers(self) -> None:
        self.lab.step()
        self.assertEqual(self.lab.T1, self.lab.measurements["T1"])
        self.assertEqual((self.lab.Qrb(), self.lab.value("Qrb"), self.lab.outputs["Qrb"]), (0.8, 0.8, 0.8))  # the board has 0.8000000715255737
        self.assertEqual(self.lab.Qrb(0.7), 0.7)
        self.assertEqual(self.lab.Qrb(), 0.8)  # until the next sample
        self.lab.step()
        self.assertEqual(self.lab.Q2(), 0.7)
        with self.assertRaises(Refused):
            self.lab.Qrb(99)
        with self.assertRaisesRegex(AttributeError, "measurements T1, T10 and the outputs Lr, Qrb"):
            self.lab.T2  # noqa: B018  T1 and T10 are names of trays here

    def test_channels_without_such_names_are_counted(self) -> None:
        with Lab(Plant("wood-berry")) as lab:
            lab.step()
            self.assertEqual(lab.T2, lab.measurements["xB"])
            lab.Q1(2.0)
            lab.step()
            self.assertEqual(lab.Q1(), lab.outputs["R"])

    def test_steps_without_a_log_are_in_no_log(self) -> None:
        self.lab.step(3)
        self.lab.step()
        self.assertEqual(list(self.lab.run(ticks=2)["time"]), [120.0, 150.0])

    def test_many_steps_without_a_log_take_no_more_memory_than_few(self) -> None:
        assert self.lab._in_process is not None
        held: list[int] = []
        text = self.lab._in_process._text

        def watched(which: int) -> str:
            found = text(which)
            held.append(len(found))
            return found

        with mock.patch.object(self.lab._in_process, "_text", watched):
            for samples in (2500, 20000):
                held.clear()
                self.lab.step(samples)
                self.lab.step()
                log = self.lab.run(ticks=1)
                self.assertEqual(len(log), 1)
                self.assertLess(max(held), 3_000_000, f"bytes at once, of {samples} samples")
        for _ in range(3000):
            self.lab.step()
        self.assertLessEqual(self.lab._in_process._loose, 2001)

    def test_nothing_is_measured_before_the_first_sample(self) -> None:
        self.assertTrue(math.isnan(self.lab.T1))

    def test_a_disturbance_meets_the_next_sample_or_a_later_one(self) -> None:
        self.lab.disturb("F", 5.5)
        self.lab.disturb("xF", 33.0, after_s=60)
        log = self.lab.run(ticks=3)
        self.assertEqual(list(log["F"]), [5.5, 5.5, 5.5])
        self.assertEqual(list(log["xF"]), [36.0, 36.0, 33.0])
        with self.assertRaisesRegex(UserError, "^F must be 0 to 10 l/h$"):
            self.lab.disturb("F", 1000)
        for name in ("", "T10", "Qrb", "T10.zzz", "F" * 600, "F=3,x"):
            with self.subTest(name), self.assertRaisesRegex(UserError, "^(?!--event)."):
                self.lab.disturb(name, 1.0)

    def test_disturbances_that_are_over_leave_room_for_more(self) -> None:
        for k in range(1200):
            self.lab.disturb("F", 5.0 + 0.5 * (k % 2))
            self.lab.step()
        with self.assertRaisesRegex(UserError, "more than 1024 events"):
            for k in range(1200):
                self.lab.disturb("F", 5.0, after_s=1e6 + k)
        self.assertEqual(len(self.lab.run(ticks=2)), 2)

    def test_an_interrupted_run_loses_no_sample(self) -> None:
        timer = threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            self.lab.run(ticks=500000)
        timer.join()
        samples = round(self.lab.time_s / self.lab.tick_s)
        log = self.lab.run(ticks=3)
        np.testing.assert_array_equal(log["number"], np.arange(samples + 3))
        self.assertEqual(len(self.lab.run(ticks=1)), 1)

    def test_an_interlock_holds_against_the_caller(self) -> None:
        self.lab.set("lock1.limit", 100.0)
        self.lab.output("Qrb", 0.8)
        self.lab.run(ticks=5)
        self.assertEqual(self.lab.outputs["Qrb"], 0.0)

    def test_a_time_that_makes_no_sense_is_refused(self) -> None:
        for wrong in ({}, {"hours": 1, "ticks": 5}, {"seconds": -5}, {"hours": 1e300}):
            with self.subTest(wrong), self.assertRaisesRegex(UserError, "how long?"):
                self.lab.run(**wrong)
        for value in (math.nan, math.inf, -math.inf, 10**400, "2", True, None, [1.0], 1j):
            with self.subTest(value), self.assertRaisesRegex(UserError, "^hours must be a number, not "):
                self.lab.run(hours=value)
        for value in (0, -1, 2.5, 2.0, math.nan, "3", True, 2**40, np.bool_(True)):
            for call in (lambda value: self.lab.run(ticks=value), self.lab.step):
                with self.subTest(value), self.assertRaisesRegex(UserError, "^ticks must be a whole number from 1 to 4294967295, not "):
                    call(value)
        with self.assertRaisesRegex(UserError, r"^how long\? run\(hours=10\) or run\(seconds=10\), also minutes= and ticks="):
            self.lab.run(10)
        self.assertEqual(self.lab.time_s, 0.0)
        self.assertEqual(len(self.lab.run(ticks=np.int32(2))), 2)
        self.assertEqual(len(self.lab.run(seconds=np.float32(60.0), minutes=np.array(1))), 4)

    def test_a_value_that_is_no_number_is_refused(self) -> None:
        for value in ("108", True, None, [108.0], np.bool_(False)):
            with self.subTest(value):
                with self.assertRaisesRegex(UserError, "^the setpoint of bottom must be a number, not "):
                    self.lab.setpoint("bottom", value)
                with self.assertRaisesRegex(UserError, "^output Qrb must be a number, not "):
                    self.lab.Qrb(value) if value is not None else self.lab.output("Qrb", value)
                with self.assertRaisesRegex(UserError, "^F must be a number, not "):
                    self.lab.disturb("F", value)
        for value in (math.nan, math.inf):
            for call in (lambda value: self.lab.setpoint("bottom", value), self.lab.Qrb):
                with self.subTest(value), self.assertRaisesRegex(Refused, "is not a number"):
                    call(value)
            with self.subTest(value), self.assertRaisesRegex(UserError, "after_s must be a number from 0"):
                self.lab.disturb("F", 5.5, after_s=value)
        with self.assertRaisesRegex(UserError, "after_s must be a number from 0, not -60"):
            self.lab.disturb("F", 5.5, after_s=-60)
        for value in (True, None, [2.0]):  # a name would be None then
            with self.subTest(value), self.assertRaisesRegex(UserError, "^meas5.name must be a number, not "):
                self.lab.set("meas5.name", value)
        self.lab.set("bottom.gain", np.float32(2.5))
        self.assertEqual(self.lab.get("bottom.gain"), "2.5")

    def test_a_command_of_two_lines_is_refused(self) -> None:
        lab = self.lab
        for smuggled in ("\nmode bottom auto", "\rmode bottom auto", "\r\nmode bottom auto\n"):
            for call in (lambda text: lab.command("status" + text), lambda text: lab.mode("top", "auto" + text), lambda text: lab.mode("top auto" + text, ""),
                         lambda text: lab.setpoint("top" + text, 88.0), lambda text: lab.output("Lr" + text, 4.0),
                         lambda text: lab.set("top.gain", "2" + text), lambda text: lab.set("top.gain 2" + text, 2.0), lambda text: lab.get("top.gain" + text)):
                with self.assertRaisesRegex(UserError, "one line"):
                    call(smuggled)
        self.assertEqual([loop["mode"] for loop in lab.loops.values()], ["manual", "manual"])

    def test_what_the_console_cannot_take_is_named(self) -> None:
        lab = self.lab
        for wrong in ("\0", "\t", "\x03", "\x15", "\x1b", "\x7f", "\x85", "\u00e9", "\u20ac", "\u2028", "\ud800", "\U0001f600"):
            for call in (lambda text: lab.command("status" + text), lambda text: lab.mode("bottom" + text, "auto"), lambda text: lab.mode("bottom", text),
                         lambda text: lab.setpoint(text, 1.0), lambda text: lab.output(text, 1.0), lambda text: lab.set("bottom.name", text),
                         lambda text: lab.set(text, 1.0), lab.get):
                with self.subTest(ascii(wrong)), self.assertRaises(UserError) as refused:
                    call(wrong)
                self.assertIn("printable ASCII only, not " + ascii(wrong), str(refused.exception))
            with self.subTest(ascii(wrong)), self.assertRaisesRegex(UserError, "plant pilot has no"):
                lab.disturb("F" + wrong, 5.0)
            with self.subTest(ascii(wrong)), self.assertRaisesRegex(UserError, "there is no channel"):
                lab.value("T10" + wrong)
        for wrong in (None, b"status", 5):
            with self.assertRaisesRegex(UserError, "a command is a text, not"):
                lab.command(wrong)
        self.assertTrue(lab.command("status"))

    def test_a_line_that_has_no_reply_does_no_harm(self) -> None:
        for line in ("", "   "):
            self.assertEqual(self.lab.command(line), "")
        with self.assertRaisesRegex(UserError, "machine mode"):
            self.lab.command("mode human")
        self.assertTrue(self.lab.command("status"))

    def test_a_closed_lab_says_so(self) -> None:
        handle = self.lab.Qrb
        self.lab.close()
        self.lab.close()
        lab = self.lab
        calls = {name: lambda name=name: getattr(lab, name)
                 for name in ("time_s", "tick_s", "channels", "measurements", "outputs", "loops", "T1", "Qrb")}
        calls |= {name: lambda name=name: getattr(lab, name)() for name in ("__enter__", "step", "play")}
        calls |= {"handle": handle, "Qrb(0.7)": lambda: handle(0.7), "value": lambda: lab.value("T1"), "command": lambda: lab.command("status"),
                  "empty": lambda: lab.command(""), "mode": lambda: lab.mode("bottom", "auto"), "setpoint": lambda: lab.setpoint("bottom", 1.0),
                  "output": lambda: lab.output("Qrb", 1.0), "set": lambda: lab.set("bottom.gain", 1.0), "get": lambda: lab.get("bottom.gain"),
                  "disturb": lambda: lab.disturb("F", 5.0), "run": lambda: lab.run(ticks=1), "run()": lambda: lab.run()}
        public = {name for name in vars(Lab) if not name.startswith("_")}
        self.assertLessEqual(public - {"close"}, set(calls))
        for name, call in calls.items():
            with self.subTest(name), self.assertRaisesRegex(RunFailed, "^the lab is closed$"):
                call()

    def test_a_board_whose_log_is_off_gives_the_samples_alone(self) -> None:
        self.lab.command("log off")
        log = self.lab.run(ticks=3)
        self.assertEqual(len(log["T1.meas"]), 3)
        self.assertNotIn("fw.T1", list(log.columns))

    def test_a_board_that_logs_every_third_sample_leaves_the_others_empty(self) -> None:
        self.lab.command("log on 3")
        log = self.lab.run(ticks=6)
        self.assertEqual(int(np.isfinite(np.asarray(log["fw.T1"])).sum()), 2)
        self.assertEqual(int(np.isfinite(np.asarray(log["T1.meas"])).sum()), 6)

    def test_a_file_that_cannot_be_written_is_named(self) -> None:
        with self.assertRaisesRegex(UserError, "nowhere/x.csv cannot be written"):
            self.lab.run(ticks=1, csv=self.folder / "nowhere" / "x.csv")
        with self.assertRaisesRegex(UserError, "cannot be written: it is a folder"):
            self.lab.run(ticks=1, csv="")
        for wrong in (5, b"x.csv", "a\0b"):
            with self.assertRaisesRegex(UserError, "^csv must be the name of a file, not "):
                self.lab.run(ticks=1, csv=wrong)
        self.assertEqual(self.lab.time_s, 0.0)

    def test_a_channel_is_not_assigned(self) -> None:
        for name in ("Qrb", "Q1", "T10"):
            with self.assertRaisesRegex(AttributeError, f"{name} is a channel: lab.{name}.50. moves an output"):
                setattr(self.lab, name, 50)
        self.assertAlmostEqual(self.lab.Qrb(), 0.8, 6)

    def test_a_channel_that_is_unknown_is_refused_with_what_there_is(self) -> None:
        for wrong in ("T99", None, 5, []):
            with self.assertRaisesRegex(UserError, r"there is no channel .*; there are T1, T10, Lr, Qrb, F, xF, .*\bT2\b"):
                self.lab.value(wrong)
        self.assertEqual(self.lab.value("F"), 5.0)

    def test_columns_that_change_on_the_way_stand_side_by_side(self) -> None:
        self.lab.run(ticks=2)
        self.lab.step()
        for line in ("begin", "set meas3.name T7", "set meas3.lo 70", "set meas3.hi 130", "apply"):
            self.lab.command(line)
        log = self.lab.run(ticks=3)
        self.assertIn("fw.T7", list(log.columns))
        self.assertFalse(math.isnan(log["fw.T7"][2]))

    def test_nothing_is_printed_and_the_logger_has_no_words_of_a_command(self) -> None:
        with self.assertLogs("reflux", logging.DEBUG) as seen, mock.patch("builtins.print", side_effect=AssertionError("print")):
            self.lab.command("status")
            self.lab.set("console.key", "secret1")
        self.assertNotIn("secret1", "".join(seen.output))


class Started(unittest.TestCase):
    def test_what_is_unknown_is_refused_with_what_there_is(self) -> None:
        with self.assertRaisesRegex(UserError, "no configuration, scenario or plant nowhere; .*demo"):
            Lab("nowhere")
        with self.assertRaisesRegex(UserError, "nowhere.toml"):
            Lab("nowhere.toml")
        with self.assertRaisesRegex(UserError, "plant nowhere"):
            Plant("nowhere")

    def test_a_plant_alone_may_be_named(self) -> None:
        with Lab("wood-berry") as lab:
            self.assertEqual((list(lab.measurements), lab.loops), (["xD", "xB"], {}))

    def test_a_plant_may_be_a_dictionary(self) -> None:
        data = json.loads((ROOT / "host_sim" / "plants" / "wood-berry.json").read_text(encoding="utf-8"))
        with Lab(Plant({**data, "name": "my-own"})) as lab:
            self.assertEqual(list(lab.measurements), ["xD", "xB"])

    def test_a_lab_that_is_refused_leaves_no_library_and_no_file(self) -> None:
        data = json.loads((ROOT / "host_sim" / "plants" / "wood-berry.json").read_text(encoding="utf-8"))
        before = loaded()
        attempts = [(UserError, what, {}) for what in ("nowhere", "nowhere.toml", "nowhere.conf", "", "\ud800", "a\0b", None, 3, ["pilot"])]
        attempts += [(UserError, "pilot", {"seed": seed}) for seed in (-1, 1.5, "x", True, 2**80)]
        attempts += [(UserError, "pilot", {"noise": noise}) for noise in (math.nan, -1.0, "x")]
        attempts += [(UserError, "pilot", {"tick_s": tick}) for tick in (math.nan, 0.0, "x")]
        kept: list[BaseException] = []  # with their tracebacks, which hold what was made
        with tempfile.TemporaryDirectory() as folder, mock.patch.object(tempfile, "tempdir", folder):
            for kind, what, options in attempts:
                with self.subTest(what=ascii(what), **options):
                    try:
                        Lab(what, **options)
                    except kind as error:
                        kept.append(error)
                    self.assertEqual(len(kept), 1, "not refused")
                    self.assertEqual(loaded(), before)
                    self.assertEqual(list(Path(folder).iterdir()), [])
                kept.clear()
            for wrong in ({**data, "inputs": []}, {**data, "gain": np.ones(2)}, {**data, "name": "../x"}):
                with self.subTest(wrong):
                    try:
                        Plant(wrong)
                    except UserError as error:
                        kept.append(error)
                    self.assertEqual(len(kept), 1, "not refused")
                    self.assertEqual(list(Path(folder).iterdir()), [])
                kept.clear()
            with mock.patch.object(Lab, "_operate", side_effect=RunFailed("no")), self.assertRaises(RunFailed) as refused:
                Lab("pilot")
            kept.append(refused.exception)
            self.assertEqual(loaded(), before)

    def test_a_lab_is_not_copied(self) -> None:
        with Lab("pilot") as lab:
            for call in (copy.copy, copy.deepcopy, pickle.dumps):
                with self.assertRaisesRegex(UserError, "^a lab cannot be copied or sent to another process"):
                    call(lab)
            self.assertTrue(lab.command("status"))

    def test_a_copy_of_a_plant_outlives_it(self) -> None:
        data = json.loads((ROOT / "host_sim" / "plants" / "wood-berry.json").read_text(encoding="utf-8"))
        for copied in (copy.copy, copy.deepcopy, lambda plant: pickle.loads(pickle.dumps(plant))):
            plant = Plant(data)
            first, other = Path(plant.argument), copied(plant)
            del plant
            self.assertFalse(first.exists())
            with Lab(other) as lab:
                self.assertEqual(list(lab.measurements), ["xD", "xB"])
        self.assertEqual(copy.copy(Plant("wood-berry")).argument, "wood-berry")

    def test_a_value_of_a_steady_state_is_a_number(self) -> None:
        with self.assertRaisesRegex(UserError, "^R must be a number, not 'x'"):
            Plant("wood-berry").at_rest(R="x")

    def test_a_child_of_fork_has_a_lab_of_its_own(self) -> None:
        with Lab("pilot", seed=3) as lab:
            lab.step(5)
            before = lab.outputs
            child = os.fork()
            if child == 0:
                try:
                    lab.output("Qrb", 0.4)
                    lab.step(100)
                    lab.close()
                finally:
                    os._exit(0 if lab._in_process is None else 1)
            self.assertEqual(os.waitpid(child, 0)[1], 0)
            self.assertEqual((lab.time_s, lab.outputs), (150.0, before))
            self.assertEqual(len(lab.run(ticks=2)), 2)

    def test_only_a_scenario_can_be_played(self) -> None:
        with Lab("pilot") as lab, self.assertRaisesRegex(UserError, "no scenario to play"):
            lab.play()

    def test_a_scenario_is_played_once(self) -> None:
        with Lab("demo") as lab:
            lab.play()
            with self.assertRaisesRegex(UserError, "the scenario goes once, from the start to .* s; start another Lab"):
                lab.play()

    def test_a_file_may_be_named_by_its_path(self) -> None:
        for path in ("scenarios/pilot.conf", "scenarios/demo.toml", "plants/wood-berry.json"):
            with Lab(ROOT / "host_sim" / path) as lab:
                self.assertTrue(lab.measurements)

    def test_every_name_of_the_package_is_there(self) -> None:
        for name in reflux.__all__:
            self.assertIsNotNone(getattr(reflux, name))
        with self.assertRaises(AttributeError):
            reflux.nothing  # noqa: B018

    def test_the_package_alone_loads_no_numbers_and_no_pictures(self) -> None:
        code = "import sys, reflux; print([m for m in ('numpy', 'matplotlib', 'pandas', 'scipy') if m in sys.modules])"
        said = subprocess.run([sys.executable, "-c", code], env={"PYTHONPATH": str(ROOT / "tools")}, capture_output=True, text=True, check=True)
        self.assertEqual(said.stdout.strip(), "[]")


class Logs(LabTest):
    def test_fast_numbers_are_those_of_the_log_as_written(self) -> None:
        assert self.lab._in_process is not None
        self.lab.mode("bottom", "auto")
        self.lab._in_process.step(50)
        taken = self.lab._in_process.take()
        fast, slow = taken.numbers(), lab_log.numbers(taken.log())
        assert fast is not None
        self.assertEqual(list(fast[0]), list(slow[0]))
        self.assertEqual(fast[1], slow[1])
        for name, values in fast[0].items():
            np.testing.assert_array_equal(values, slow[0][name], err_msg=name)

    def test_text_in_a_row_leaves_the_fast_way(self) -> None:
        taken = Taken([], ["number", "time[s]"], ["0,0", "1,x"], ["H,1,number,T1[K]", "T,1,0,5", "T,1,1,6"])
        self.assertIsNone(taken.numbers())
        self.assertTrue(math.isnan(lab_log.numbers(taken.log())[0]["time"][1]))

    def test_a_name_that_people_use_finds_its_column_and_units_are_there(self) -> None:
        log = self.lab.run(ticks=4)
        np.testing.assert_array_equal(log["T1"], log["T1.meas"])
        np.testing.assert_array_equal(log["Qrb"], log["Qrb.applied"])
        np.testing.assert_array_equal(log["bottom.sp"], log["fw.bottom.sp"])
        self.assertEqual(log.attrs["units"]["T1.meas"], "degC")
        for table in (log, lab_log.Table({"T1.meas": np.ones(2)}, {})):
            for wrong in ("nowhere", *((5, None, slice(1, 2)) if isinstance(table, lab_log.Table) else ())):
                with self.assertRaises(KeyError):
                    table[wrong]

    def test_a_plot_has_an_axis_for_each_unit(self) -> None:
        import matplotlib
        matplotlib.use("Agg")
        figure = self.lab.run(ticks=4).plot()
        self.assertEqual([axis.get_ylabel() for axis in figure.axes], ["degC", "degC", "l/h", "kW"])
        self.assertEqual(len(self.lab.run(ticks=4).plot("T10", "bottom.sp").axes), 1)

    def test_a_setpoint_is_drawn_where_its_loop_acts_on_it(self) -> None:
        log = self.lab.run(ticks=4)
        acts = np.asarray(log["bottom.mode"]) != 0
        np.testing.assert_array_equal(np.isfinite(lab_log.drawn_values(log, "fw.bottom.sp")), acts)
        table = lab_log.Table({"fw.a.sp": np.array([1.0, 2.0]), "fw.a.mode": np.array([0.0, 1.0])}, {})
        np.testing.assert_array_equal(lab_log.drawn_values(table, "fw.a.sp"), [math.nan, 2.0])

    def test_curves_that_would_look_flat_do_not_share_an_axis(self) -> None:
        top, bottom = np.array([96.0, 96.8]), np.array([0.5, 0.9])
        self.assertEqual(lab_log.together({"xD": top, "xB": bottom, "top.sp": np.array([98.0, 98.0])}), [["xD", "top.sp"], ["xB"]])
        self.assertEqual(lab_log.together({"xD": top, "yD": top + 2}), [["xD", "yD"]])
        self.assertEqual(lab_log.together({"R.app": np.array([2.0, 2.0]), "S.app": np.array([5.0, 5.0])}), [["R.app", "S.app"]])
        self.assertEqual(lab_log.together({"a": np.array([math.nan])}), [["a"]])
        self.assertEqual(lab_log.together({"a.sp": np.array([1.0]), "b.sp": np.array([math.nan])}), [["a.sp", "b.sp"]])

    def test_a_table_stands_in_for_pandas(self) -> None:
        with mock.patch.object(lab_log, "pandas", None):
            log = self.lab.run(ticks=4)
        self.assertIsInstance(log, lab_log.Table)
        self.assertEqual(len(log), 4)
        self.assertIn("T1.meas", log)
        self.assertEqual(log.columns, list(log))

    @unittest.skipUnless(importlib.util.find_spec("pandas"), "pandas is not installed; python3-pandas is an extra")
    def test_with_pandas_it_is_a_data_frame(self) -> None:
        import pandas
        log = self.lab.run(ticks=4)
        self.assertIsInstance(log, pandas.DataFrame)
        self.assertEqual(log.attrs["units"]["T1.meas"], "degC")
        np.testing.assert_array_equal(log["T1"], log["T1.meas"])


class OnAPort(FolderTest):
    """The host build on its console, as a board on a serial port."""

    def setUp(self) -> None:
        super().setUp()
        self.firmware = self.enterContext(launch.start("host"))
        self.enterContext(launch.plant(self.firmware, "pilot", "--speed", "600", "--tick", "30", "--timeout", "3600"))
        self.lab = self.enterContext(Lab(port=self.firmware.console))

    def test_the_same_calls_drive_a_board(self) -> None:
        lab = self.lab
        self.configure()
        log = lab.run(ticks=3)
        self.assertGreaterEqual(len(log), 3)  # and what came while the lines were sent
        self.assertGreater(lab.time_s, 0.0)
        lab.mode("bottom", "auto")
        log = lab.run(ticks=3)
        self.assertEqual(log.attrs["units"]["T10"], "degC")
        self.assertEqual(lab.loops["bottom"]["mode"], "auto")
        self.assertTrue(math.isfinite(lab.value("T10")))
        with self.assertRaisesRegex(Refused, "err RANGE"):
            lab.output("Lr", 99)

    def test_what_needs_a_plant_in_this_process_is_refused(self) -> None:
        for name, call in (("disturb", lambda: self.lab.disturb("F", 5.5)), ("step", lambda: self.lab.step()), ("play", lambda: self.lab.play()),
                           ("tick_s", lambda: self.lab.tick_s)):
            with self.assertRaisesRegex(UserError, f"^lab.{name} goes with a plant in this process, not with a board on a port$"):
                call()
        with self.assertRaisesRegex(UserError, "^lab.channels goes with .* on a port; lab.measurements and lab.outputs name what the board has"):
            self.lab.channels  # noqa: B018

    def test_a_measurement_right_after_connecting_waits_for_the_first_row(self) -> None:
        self.configure()
        self.lab.close()
        for _ in range(2):  # a row comes every 50 ms
            with Lab(port=self.firmware.console) as lab:
                self.assertTrue(60 < lab.T10 < 130)

    def test_a_board_without_a_plant_is_not_waited_for(self) -> None:
        with launch.start("host") as firmware, Lab(port=firmware.console) as lab:
            began = time.monotonic()
            self.assertTrue(math.isnan(lab.time_s))
            self.assertLess(time.monotonic() - began, 2.0)

    def configure(self) -> None:
        with (ROOT / "host_sim" / "scenarios" / "pilot.conf").open(encoding="utf-8") as lines:
            for line in (text.strip() for text in lines):
                if line and not line.startswith("#"):
                    self.lab.command(line)

    def test_numbers_are_those_that_have_come_meanwhile(self) -> None:
        self.configure()
        self.lab.run(ticks=1)
        before, end = self.lab.time_s, time.monotonic() + 20
        while self.lab.time_s < before + 90 and time.monotonic() < end:
            time.sleep(0.05)
        self.assertGreaterEqual(self.lab.time_s, before + 90)
        self.assertGreaterEqual(len(self.lab.run(ticks=1)), 4)

    def test_after_an_interrupted_command_replies_belong_to_their_commands(self) -> None:
        session = self.lab._on_port._session
        with mock.patch.object(session, "line", side_effect=KeyboardInterrupt), self.assertRaises(KeyboardInterrupt):
            self.lab.command("help")
        self.assertEqual(self.lab.command("get loop1.gain"), "loop1.gain = 1 fraction/fraction")
        self.assertRegex(self.lab.command("status"), "^state ")
        with self.assertRaises(Refused):
            self.lab.command("nonsense")
        self.assertRegex(self.lab.command("status"), "^state ")

    def test_a_child_of_fork_leaves_the_port_alone(self) -> None:
        self.configure()
        self.lab.run(ticks=1)
        child = os.fork()
        if child == 0:
            refused = 0
            try:
                for call in (lambda: self.lab.command("status"), lambda: self.lab.run(ticks=1), lambda: self.lab.time_s):
                    try:
                        call()
                    except RunFailed as error:
                        refused += "another process" in str(error)
                self.lab.close()
            finally:
                os._exit(refused)
        self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), 3)
        self.assertGreaterEqual(len(self.lab.run(ticks=2)), 2)  # its log is still on

    def test_what_is_no_port_or_not_for_one_is_refused(self) -> None:
        for wrong in (5, b"/dev/null", "a\0b"):
            with self.assertRaisesRegex(UserError, "^a port is a name such as /dev/ttyUSB0, not "):
                Lab(port=wrong)
        for options in ({"seed": 1}, {"noise": 0.0}, {"tick_s": 1.0}):
            with self.assertRaisesRegex(UserError, "not for a board on a port"):
                Lab(port=self.firmware.console, **options)

    def test_a_board_that_is_away_is_refused(self) -> None:
        with self.assertRaises((UserError, RunFailed)):
            Lab(port=str(self.folder / "nowhere"))


class Doors(unittest.TestCase):
    GAIN = [[12.8, -18.9], [6.6, -19.4]]  # Wood and Berry's column
    DEAD, CONSTANT = [[60, 180], [420, 180]], [[1002, 1260], [654, 864]]

    def test_relative_gains_of_a_matrix_and_at_a_frequency(self) -> None:
        np.testing.assert_allclose(reflux.rga(self.GAIN), [[2.00939, -1.00939], [-1.00939, 2.00939]], atol=1e-5)
        at = reflux.rga(self.GAIN, dead_time=self.DEAD, time_constant=self.CONSTANT, omega=0.01)
        self.assertLess(at[0, 0], 1.0)

    def test_a_design_pairs_and_tunes(self) -> None:
        found = reflux.design(self.GAIN, self.DEAD, self.CONSTANT, interval_s=60)
        self.assertEqual((found.pairs, found.verdict, found.kept), ([(0, 0), (1, 1)], "determined", True))
        self.assertTrue(found.gain[0] > 0 > found.gain[1])
        given = reflux.design(self.GAIN, self.DEAD, self.CONSTANT, interval_s=60, pairs=[(0, 0), (1, 1)])
        np.testing.assert_array_equal(found.gain, given.gain)
        self.assertEqual(reflux.pair(self.GAIN)["pairs"], [(0, 0), (1, 1)])

    def test_a_model_is_found_in_a_record_and_in_a_log(self) -> None:
        rng = np.random.default_rng(1)
        u, y = rng.standard_normal((600, 1)), np.zeros((600, 1))
        for k in range(2, 600):
            y[k] = 0.8 * y[k - 1] + 0.5 * u[k - 2] + 0.02 * rng.standard_normal()
        model = reflux.identify(u=u, y=y)[0]
        self.assertAlmostEqual(model.a[0], -0.8, 1)
        self.assertAlmostEqual(model.b[0][1], 0.5, 1)
        self.assertGreater(model.fit, 0.9)
        log = lab_log.Table({"u.cmd": u[:, 0], "y.meas": y[:, 0]}, {})
        same = reflux.identify(log, inputs=["u"], outputs=["y"])[0]
        self.assertEqual((same.output, same.a, same.b), ("y", model.a, model.b))

    def test_a_record_that_is_none_is_refused(self) -> None:
        with self.assertRaisesRegex(UserError, "a log with inputs"):
            reflux.identify()
        u = np.ones((30, 1))
        for options, words in (({"u": u[:, 0], "y": u[:, 0]}, "samples x channels"), ({"u": u, "y": u[:9]}, "a row for each sample"),
                               ({"u": u[:0], "y": u[:0]}, "a row for each sample"), ({"u": [["a"]], "y": u}, "^u must be numbers"),
                               ({"u": u, "y": u, "na": 2.5}, "na and nb must be whole numbers"), ({"u": u, "y": u, "method": "x"}, "method must be one of"),
                               ({"u": u, "y": u, "validation": "x"}, "^validation must be a number"), ({"log": lab_log.Table({}, {})}, "needs the names")):
            with self.subTest(words), self.assertRaisesRegex(UserError, words):
                reflux.identify(**options)
        with self.assertRaisesRegex(UserError, "no numbers"):
            reflux.identify(u=np.ones((30, 1)), y=np.full((30, 1), np.nan))

    def test_what_is_no_matrix_is_refused(self) -> None:
        for wrong in ([], [1, 2], [["a", "b"], ["c", "d"]], [[1], [1, 2]], None, [[1j, 1], [1, 1]], [[True, False], [False, True]], np.zeros((2, 2, 2))):
            for door in (reflux.rga, reflux.pair):
                with self.subTest(ascii(wrong)), self.assertRaisesRegex(UserError, "^gain must be "):
                    door(wrong)
        for wrong in ([[math.nan, 1.0], [1.0, 1.0]], np.eye(17)):
            with self.assertRaises(libreflux.Refused):
                reflux.rga(wrong)
        with self.assertRaisesRegex(UserError, "^dead_time must be one number, or 2 x 2 as gain"):
            reflux.rga(self.GAIN, dead_time=[1, 2, 3])
        with self.assertRaisesRegex(UserError, "^omega must be a number"):
            reflux.rga(self.GAIN, omega="x")

    def test_pairs_and_settings_that_are_wrong_are_named(self) -> None:
        for wrong in ([(5, 7)], [(-1, 0)], [(2**40, 0)], [(2**32, 0)], [(0.5, 1.5), (1, 0)], ["ab"], [(0,)], [3]):  # 2**40 was output 0, 0.5 too
            with self.subTest(wrong), self.assertRaisesRegex(UserError, "^pairs are .output, input., which count from 0"):
                reflux.design(self.GAIN, self.DEAD, self.CONSTANT, interval_s=60, pairs=wrong)
        with self.assertRaisesRegex(UserError, "^interval_s must be a number"):
            reflux.design(self.GAIN, self.DEAD, self.CONSTANT, interval_s="x")
        with self.assertRaisesRegex(UserError, "^there is no setting margin; there are .*gain_margin"):
            reflux.design(self.GAIN, self.DEAD, self.CONSTANT, interval_s=60, margin=3)
        with self.assertRaisesRegex(UserError, "^floor must be a number"):
            reflux.pair(self.GAIN, floor="x")

    def test_a_column_has_a_profile_a_steady_state_and_gains(self) -> None:
        column = reflux.columns.read("splitter")
        self.assertEqual(len(reflux.columns.steady("splitter").temperature), column.stages)
        self.assertEqual(len(reflux.columns.profile("splitter")["T[K]"]), column.stages)
        gains = reflux.columns.gains("splitter", outputs=["T5", "T27"], inputs=["R", "Q"])
        self.assertTrue((gains[:, 0] < 0).all() and (gains[:, 1] > 0).all())
        with self.assertRaisesRegex(UserError, "^splitter has no output X; there are "):
            reflux.columns.gains("splitter", outputs=["X"], inputs=["R"])


class Environment(unittest.TestCase):
    def test_without_gymnasium_it_says_what_is_missing(self) -> None:
        sys.modules.pop("reflux.column_env", None)
        with mock.patch.dict(sys.modules, {"gymnasium": None}), self.assertRaisesRegex(UserError, "pip install gymnasium"):
            reflux.ColumnEnv  # noqa: B018

    @unittest.skipUnless(importlib.util.find_spec("gymnasium"), "gymnasium is not installed; pip install gymnasium")
    def test_gymnasium_finds_nothing_wrong_and_interlocks_hold(self) -> None:
        from gymnasium.utils.env_checker import check_env
        for setpoints in (False, True):
            with self.subTest(setpoints=setpoints), contextlib.closing(reflux.ColumnEnv("pilot", targets={"T10": 108.5}, setpoints=setpoints)) as env:
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore")  # it has no spec and no picture
                    check_env(env)
                env.reset(seed=1)
                for _ in range(30):
                    _, reward, *_, info = env.step(np.array([1.0, 1.0], np.float32))
                    self.assertLessEqual(info["applied"]["Qrb"], 1.25 + 1e-6)
                    self.assertLessEqual(reward, 0.0)


@unittest.skipUnless(importlib.util.find_spec("gymnasium"), "gymnasium is not installed; pip install gymnasium")
class EnvironmentUnderAttack(unittest.TestCase):
    def setUp(self) -> None:
        self.env = self.enterContext(contextlib.closing(reflux.ColumnEnv("pilot", targets={"T10": 108.5})))
        self.env.reset(seed=1)

    def test_an_action_that_is_not_finite_is_refused_by_the_board(self) -> None:
        before = self.env.step(np.array([0.2, 0.1]))[4]["applied"]
        for action in ([math.nan, math.inf], [-math.inf, math.nan]):
            seen, reward, *_, info = self.env.step(np.array(action, np.float32))
            self.assertEqual(len(info["refused"]), 2)
            self.assertRegex(info["refused"][0], "err PARSE .*is not a number")
            self.assertEqual(info["applied"], before)
            self.assertTrue(np.isfinite(seen).all() and math.isfinite(reward))

    def test_an_action_of_another_shape_or_kind_is_refused_and_no_time_passes(self) -> None:
        before = self.env._lab.time_s
        for action in (0.5, None, "ab", ["a", "b"], {}, [True, False], [[0.1], [0.2, 0.3]], np.zeros(1), np.zeros(3), np.zeros((2, 1)), np.zeros(2, complex)):
            with self.subTest(ascii(action)), self.assertRaisesRegex(UserError, "^an action is 2 numbers from -1 to 1, of Lr, Qrb, not "):
                self.env.step(action)
        self.assertEqual(self.env._lab.time_s, before)
        self.env.step([0, 1])

    def test_a_reset_in_mid_episode_begins_anew_and_looks_for_no_configuration(self) -> None:
        def episode(steps: int) -> list[list[float]]:
            return [list(self.env.reset(seed=7)[0])] + [list(self.env.step(np.array([0.3, 0.2]))[0]) for _ in range(steps)]

        first = episode(5)
        with mock.patch("reflux.lab._beginning", side_effect=AssertionError("looks for the configuration")):
            self.assertEqual(episode(5), first)
        before = loaded()
        for _ in range(5):
            episode(1)
        self.assertEqual(loaded(), before)

    def test_what_makes_no_environment_is_refused_and_leaves_nothing(self) -> None:
        before = loaded()
        for wrong, words in (({"targets": {"X": 1}}, "X is no measurement"), ({"targets": {"T10": math.nan}}, "the target of T10 must be a number"),
                             ({"targets": {"T10": "hot"}}, "the target of T10 must be a number"), ({"targets": ["T10"]}, "targets are a dictionary"),
                             ({"steps": 0}, "steps must be a whole number"), ({"ticks": 2.5}, "ticks must be a whole number")):
            with self.subTest(wrong), self.assertRaisesRegex(UserError, words) as refused:
                reflux.ColumnEnv("pilot", **wrong)
            self.assertIsNotNone(refused.exception)
            self.assertEqual(loaded(), before)

    def test_it_is_not_copied_and_a_closed_one_says_so(self) -> None:
        for call in (copy.deepcopy, pickle.dumps):
            with self.assertRaisesRegex(UserError, "a lab cannot be copied"):
                call(self.env)
        self.env.close()
        with self.assertRaisesRegex(RunFailed, "the lab is closed"):
            self.env.step(np.zeros(2))

    def test_environments_in_processes_of_their_own(self) -> None:
        from gymnasium.vector import AsyncVectorEnv, SyncVectorEnv
        seen = []
        for kind in (SyncVectorEnv, AsyncVectorEnv):
            with contextlib.closing(kind([lambda: reflux.ColumnEnv("pilot", steps=3) for _ in range(2)])) as both:
                both.reset(seed=3)
                seen.append([both.step(np.full((2, 2), 0.1, np.float32))[0] for _ in range(5)])
        np.testing.assert_array_equal(*seen)


if __name__ == "__main__":
    unittest.main()
