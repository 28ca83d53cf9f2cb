"""Scenario files: what is wrong gets one line that says what, where, and what would be right."""

import contextlib
import unittest
from dataclasses import replace

from support import GOOD, ROOT, FolderTest, call

from reflux import runner, scenario
from reflux.errors import UserError
from reflux.paths import every

LOOP = '[[loop]]\nname = "top"\npv = "T1"\nmv = "Lr"\n'
BAD = {
    "wrong key": (GOOD + "durations = 3\n", "durations is not a known key; known are: "),
    "wrong key in a line": (GOOD + '[[line]]\nat_s = 1\nsend = "x"\nallow = true\n', "line[1].allow is not a known key"),
    "missing": ('name = "a"\nplant = "pilot"\n', "duration_s is missing"),
    "wrong type": (GOOD.replace("600", '"600"'), "duration_s must be a number, not text"),
    "boolean for a number": (GOOD.replace("600", "true"), "duration_s must be a number, not true or false"),
    "not whole": (GOOD + "seed = 1.5\n", "seed must be a whole number, not a number"),
    "zero duration": (GOOD.replace("600", "0"), "duration_s is 0; it must be more than 0"),
    "NaN": (GOOD + "noise = nan\n", "noise is nan; it must be a finite number"),
    "infinite": (GOOD + "noise = inf\n", "noise is inf; it must be a finite number"),
    "negative noise": (GOOD + "noise = -1\n", "noise is -1; it must be 0 or more"),
    "unknown plant": (GOOD.replace("pilot", "pilots"), 'plant is "pilots"; known are: pilot'),
    "unknown firmware": (GOOD + 'firmware = "z80"\n', 'firmware is "z80"; known are: host, host-fixed'),
    "negative time": (GOOD + '[[line]]\nat_s = -1\nsend = "x"\n', "line[1].at_s is -1; it must be 0 or more"),
    "time after the end": (GOOD + "[[event]]\nat_s = 601\nset = { F = 1 }\n", "event[1].at_s is 601; it must be 600 or less"),
    "NaN in an event": (GOOD + "[[event]]\nat_s = 1\nset = { F = nan }\n", "event[1].set.F is nan"),
    "event of no channel": (GOOD + '[[event]]\nat_s = 1\nset = { "a b" = 1 }\n', "expected a channel, as F, or an option"),
    "empty event": (GOOD + "[[event]]\nat_s = 1\nset = {}\n", "event[1].set is empty"),
    "event not a table": (GOOD + '[[event]]\nat_s = 1\nset = "F=1"\n', "set must be a table, not text"),
    "two lines in one": (GOOD + '[[line]]\nat_s = 1\nsend = "a\\nb"\n', "line[1].send must be one line"),
    "line too long": (GOOD + f'[[line]]\nat_s = 1\nsend = "{"x" * 200}"\n', "at most 120 characters, this one 200"),
    "no console file": (GOOD + 'console = ["none.conf"]\n', "console: there is no file"),
    "no wiring file": (GOOD + 'wiring = "none.wiring"\n', "wiring: there is no file"),
    "console not a list": (GOOD + 'console = "a.conf"\n', "console must be a list in [ ], not text"),
    "limit of no loop": (GOOD + LOOP + '[[limit]]\nloop = "up"\niae = 1\n', 'limit[1].loop is "up"; known are: top'),
    "limit of nothing": (GOOD + LOOP + '[[limit]]\nloop = "top"\n', "this limit limits nothing"),
    "limit at no window": (GOOD + LOOP + '[[limit]]\nloop = "top"\nat_s = 5\niae = 1\n', "at_s is 5, and nothing happens then"),
    "unknown metric": (GOOD + LOOP + '[[limit]]\nloop = "top"\nise = 1\n', "limit[1].ise is not a known key"),
    "loop twice": (GOOD + LOOP + LOOP, "there is a loop top already"),
    "bad speed": (GOOD + 'speed = "fast"\n', 'speed is "fast"; "max", or how many times real time'),
    "bad name": (GOOD.replace("trial", "../x"), 'name is "../x"'),
    "not TOML": ("name = \n", "not valid TOML"),
    "line as a table": (GOOD + "line = 3\n", "line must be written as [[line]]"),
}


class Scenarios(FolderTest):
    def test_bad_files_get_one_line_each(self) -> None:
        for what, (text, expected) in BAD.items():
            with self.subTest(what):
                path = self.file("trial.toml", text)
                with self.assertRaises(UserError) as raised:
                    scenario.load(path, plants=["pilot"])
                message = str(raised.exception)
                self.assertIn(expected, message)
                self.assertIn({"no console file": "none.conf", "no wiring file": "none.wiring"}.get(what, "trial.toml"), message)
                self.assertNotIn("\n", message)

    def test_binary_and_missing_files(self) -> None:
        path = self.folder / "binary.toml"
        path.write_bytes(b"\xff\xfe")
        with self.assertRaisesRegex(UserError, "is UTF-16 text"):
            scenario.load(path)
        with self.assertRaisesRegex(UserError, "cannot be read: No such file"):
            scenario.load(self.folder / "none.toml")

    def test_a_folder_of_that_name_hides_no_scenario(self) -> None:
        (self.folder / "smoke").mkdir()
        with contextlib.chdir(self.folder):
            self.assertEqual(scenario.find("smoke"), scenario.SCENARIOS / "smoke.toml")

    def test_a_wiring_wants_a_firmware_with_pins(self) -> None:
        self.file("a.wiring", "T1 max31865 spi1 PA4\n")
        loaded = scenario.load(self.file("trial.toml", GOOD + 'wiring = "a.wiring"\n'))
        self.assertEqual(loaded.wiring, self.folder / "a.wiring")
        for firmware in scenario.FIRMWARES:
            wanted = loaded.with_options(firmware=firmware)
            with self.subTest(firmware):
                if firmware == "memory" or firmware.startswith("board"):
                    scenario.check_pins(wanted)
                else:
                    with self.assertRaisesRegex(UserError, f"with a wiring the firmware must have pins: .*{firmware} has none"):
                        scenario.check_pins(wanted)
        with self.assertRaisesRegex(UserError, "its plant is at the board's own pins; tools/run runs it"):
            scenario.check_link(loaded)

    def test_a_virtual_board_gets_the_wiring_and_the_simulator_too(self) -> None:
        path = self.file("a.wiring", "T1 max31865 spi1 PA4\n")
        loaded = scenario.load(self.file("trial.toml", GOOD + 'wiring = "a.wiring"\nseed = 5\n'))
        self.assertEqual(runner.board_options(loaded.with_options(firmware="board")), ("--wiring", str(path), "--seed", "5"))
        self.assertEqual(runner.board_options(loaded.with_options(firmware="memory")), ())
        self.assertEqual(runner.board_options(replace(loaded, wiring=None, firmware="board")), ())

    def test_console_file_and_script(self) -> None:
        self.file("a.conf", "# comment\nbegin\n\nset a 1   # why\n?set b#2 3\napply\n")
        path = self.file("trial.toml", GOOD + 'console = ["a.conf"]\n[[line]]\nat_s = 30\nsend = "sp top 5"\n'
                         '[[line]]\nat_s = 10\nsend = "bad"\nallow_err = true\n')
        loaded = scenario.load(path)
        self.assertEqual([line.text for line in loaded.config], ["begin", "set a 1", "set b#2 3", "apply"])
        self.assertEqual([line.allow_err for line in loaded.config], [False, False, True, False])
        script = self.folder / "script"
        runner.write_script(loaded, script)
        self.assertEqual(script.read_text().splitlines()[-2:], ["10 ?bad", "30 sp top 5"])

    def test_events_of_options(self) -> None:
        path = self.file("trial.toml", GOOD + '[[event]]\nat_s = 1\nset = { Qrb.hi = 0.6, "T1.bias" = 1, F = 5 }\n')
        self.assertEqual([(e.name, e.value) for e in scenario.load(path).events],
                         [("Qrb.hi", 0.6), ("T1.bias", 1.0), ("F", 5.0)])

    def test_windows_begin_where_something_happens(self) -> None:
        path = self.file("trial.toml", GOOD + '[[line]]\nat_s = 60\nsend = "mode top auto"\n'
                         '[[line]]\nat_s = 90\nsend = "status"\n[[event]]\nat_s = 300\nset = { F = 1, xF = 2 }\n')
        self.assertEqual(scenario.window_starts(scenario.load(path)), [0.0, 60.0, 300.0])

    def test_scenarios_of_the_repository_are_good(self) -> None:
        for path in every(ROOT / "host_sim" / "scenarios", "*.toml"):
            with self.subTest(path.name):
                scenario.load(path)


class Commands(FolderTest):
    def test_exit_status_and_one_line(self) -> None:
        bad = str(self.file("bad.toml", GOOD + "x = 1\n"))
        for arguments, expected in (
            (["run", bad], "x is not a known key"),
            (["run", "nosuch"], "no scenario nosuch"),
            (["run"], "which scenario?"),
            (["run", "smoke", "--seed", "-1"], "--seed is -1; it must be 0 or more"),
            (["run", "smoke", "--noise", "nan"], "--noise is nan"),
            (["run", "smoke", "--speed", "0"], '--speed is "0"'),
            (["run", "smoke", "--firmware", "serial"], "needs --console-port and --link-port"),
            (["run", "smoke", "--link-port", "/dev/null"], "go with --firmware serial only"),
            (["run", "--compare", "/nonexistent", bad], "no such file"),
            (["test", "units"], '"units" is not a label'),
            (["campaign", "none"], 'no campaign "none"'),
            (["campaign", "pilot-noise", "--fraction", "0"], "--fraction must be more than 0"),
            (["plot", bad], "not a log"),
            (["bench", "--before", "deadbeef"], "--before deadbeef is not a commit here"),
            (["bench", "--tick", "--before", "deadbeef"], "--before deadbeef is not a commit here"),
        ):
            with self.subTest(arguments):
                status, _out, err = call(*arguments)
                self.assertEqual(status, 2, err)
                self.assertIn(expected, err)
                self.assertEqual(err.count("\n"), 1)

    def test_paths_of_nothing_are_refused(self) -> None:
        for arguments in (["run", "smoke", "--out", ""], ["demo", "--out="], ["bench", "--out", ""],
                          ["evidence", "--out", ""], ["plot", ""], ["plot", "x", "-o", ""], ["flash", "--image", ""],
                          ["console", "x", "--log", ""], ["console", "x", "--dump", ""]):
            with self.subTest(arguments):
                status, _out, err = call(*arguments)
                self.assertEqual(status, 2, err)
                self.assertIn("must not be empty", err)

    def test_help(self) -> None:
        for name in ("run", "demo", "test", "campaign", "bench", "plot", "style"):
            status, out, err = call(name, "--help")
            self.assertEqual(status, 0, err)
            self.assertIn(f"usage: tools/{name}", out)


if __name__ == "__main__":
    unittest.main()
