#!/usr/bin/python3
"""reflux-sim as a program: exit codes, messages, and whole runs against the test controller.

usage: test_reflux_sim.py REFLUX_SIM TEST_CONTROLLER PYTHON_PLANT
"""
import csv, os, re, signal, socket, subprocess, sys, tempfile, time, unittest

SIM, CONTROLLER, PYTHON_PLANT = sys.argv[1:4]
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
HANG_S = 900  # stops what hangs; nothing here takes long, but how long is the machine's affair


def rows(path):
    with open(path) as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


class Bench(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.running = []

    def tearDown(self):
        for process in self.running:
            process.kill()
            process.wait()
        self.folder.cleanup()

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def write(self, name, text):
        with open(self.path(name), "w") as file:
            file.write(text)
        return self.path(name)

    def controller(self, *options, kind="socket"):
        process = subprocess.Popen([CONTROLLER, kind, self.path("link"), self.path("console"), *options])
        self.running.append(process)
        return process

    def arguments(self, *more):
        return [SIM, "--plant", "two_by_two", "--port", self.path("link"),
                "--console", self.path("console"), *more]

    def sim(self, *more):
        return subprocess.run(self.arguments(*more), capture_output=True, text=True, timeout=HANG_S)

    def within(self, patience_s, wanted, *more, controller=()):
        """A run that a time-out of its own ends. On a busy machine another wait can be the one that is too long:
        then again, with more patience."""
        for longer in (1, 4, 16, 64):
            self.fresh(*controller)
            done = self.sim("--timeout", f"{patience_s * longer}", *more)
            if wanted.format(patience_s * longer) in done.stderr:
                break
        self.assertIn(wanted.format(patience_s * longer), done.stderr)
        self.assertEqual(done.returncode, 1)

    def fresh(self, *options, kind="socket"):
        """A new controller; the lines of the one before are not to be taken for its."""
        for left_over in ("link", "console"):
            if os.path.lexists(self.path(left_over)):
                os.remove(self.path(left_over))
        return self.controller(*options, kind=kind)

    def refused(self, arguments, because):
        done = subprocess.run([SIM, *arguments], capture_output=True, text=True, timeout=HANG_S)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn(because, done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertEqual(done.stdout, "")


class Options(Bench):
    BASE = ["--plant", "two_by_two", "--port", "socket:/nowhere"]

    def test_wrong_options_are_refused_with_one_line_and_exit_code_2(self):
        for more, because in [
            (["--speed", "fast"], "must be max or a number"),
            (["--speed", "0"], "must be max or a number"),
            (["--speed", "nan"], "must be max or a number"),
            (["--duration", "-1"], "--duration -1: must be a number from 0"),
            (["--duration", "10s"], "--duration 10s"),
            (["--duration", "inf"], "--duration inf"),
            (["--tick", "0"], "--tick 0: must be a number from 0.001"),
            (["--tick", "0.0005"], "--tick 0.0005"),
            (["--tick", "1.0005"], "whole number of milliseconds"),
            (["--seed", "-1"], "--seed -1: must be a whole number"),
            (["--seed", "1.5"], "--seed 1.5"),
            (["--seed", "99999999999999999999"], "--seed 9999"),
            (["--noise", "-0.1"], "--noise -0.1"),
            (["--timeout", "0"], "--timeout 0"),
            (["--event", "1:nothing=3"], "has no \"nothing\"; disturbances: d"),
            (["--event=1:d=99"], "d must be -10 to 10 degC"),
            (["--event", "1:u1.lo=50", "--event", "2:u1.hi=40"], "lo must not be above hi"),
            (["--event"], "--event: a value is missing"),
            (["--nonsense", "1"], "--nonsense: unknown option"),
            (["--nonsense"], "--nonsense: unknown option"),
            (["rubbish"], "rubbish: not an option"),
            (["--script", "x"], "--script needs --console"),
            (["--telemetry", "x"], "--telemetry needs --console"),
            (["--console", "x", "--script", "/no/such/file"], "No such file"),
            (["--log", "/no/such/folder/log.csv"], "--log /no/such/folder/log.csv: No such file"),
            (["--port", ""], "--port: must not be empty"),
        ]:
            with self.subTest(more=more):
                self.refused(self.BASE + more, because)

    def test_every_fault_of_a_thermometer_in_the_fault_matrix_can_be_played(self):
        page = open(os.path.join(ROOT, "tests", "loop", "fault-matrix.md"), encoding="utf-8").read()
        faults = sorted(set(re.findall(r"`(T(?:1|5|10)\.\w+=[-0-9.]+)`", page)))
        self.assertGreater(len(faults), 15)
        for fault in faults:
            self.refused(["--plant", "pilot", "--event", "600:" + fault], "--port")

    def test_missing_plant_and_port_are_named(self):
        self.refused([], "--plant NAME is missing")
        self.refused(["--plant", "two_by_two"], "--port WHERE is missing")
        self.refused(["--plant", "steam_engine", "--port", "x"], "no such plant, and no path of a .json file; there is two_by_two")

    def test_a_wrong_script_is_refused_with_its_line_before_anything_is_connected(self):
        script = self.write("script", "# one\n10 log on\n5 log off\n")
        self.refused(self.BASE + ["--console", "x", "--script", script],
                     f"{script}:3: time 5 s comes after 10 s")

    def test_help_and_list_are_printed(self):
        for option, text in [("--help", "exit status: 0 done"), ("--list", "two_by_two: two first-order")]:
            done = subprocess.run([SIM, option], capture_output=True, text=True, timeout=HANG_S)
            self.assertEqual(done.returncode, 0)
            self.assertIn(text, done.stdout)

    def test_help_lists_the_options_of_instruments_that_the_page_explains(self):
        text = subprocess.run([SIM, "--help"], capture_output=True, text=True, timeout=HANG_S).stdout
        with open(os.path.join(ROOT, "docs", "inside", "faults.md"), encoding="utf-8") as file:
            page = file.read()
        for title, head in (("measurements", "measurement"), ("manipulated variables", "manipulated variable")):
            with self.subTest(title):
                listed = re.search(rf"^ +{title}:((?:(?:\n {{27}}| )[a-z_]+)+)$", text, re.MULTILINE)
                self.assertIsNotNone(listed, text)
                table = page.split(f"| option of a {head} |")[1].split("\n\n")[0]
                self.assertEqual(sorted(listed[1].split()), sorted(re.findall(r"^\| `(\w+)` \|", table, re.MULTILINE)),
                                 f"options of {title} in --help, and in the table of docs/inside/faults.md that explains them")
        self.assertLessEqual(max(map(len, text.splitlines())), 120)


class Runs(Bench):
    SCRIPT = "0 log on\n100 status\n200 ?nonsense\n500 log off\n"

    def run_once(self, name, *more, kind="socket", options=()):
        self.fresh(*options, kind=kind)
        if kind == "pty":
            while not os.path.exists(self.path("console")):
                time.sleep(0.01)
        done = self.sim("--log", self.path(name), "--duration", "3000", "--event", "300:d=4", "--event",
                        "600:u1.hi=15", "--telemetry", self.path(name + ".telemetry"), "--script",
                        self.write("script", self.SCRIPT), "--transcript", self.path("transcript"), *more)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.path(name), "rb") as file:
            return file.read()

    def test_the_same_run_gives_the_same_log_over_socket_and_pty_and_with_lost_commands(self):
        first = self.run_once("a.csv")
        self.assertEqual(first, self.run_once("b.csv", kind="pty"))
        self.assertEqual(first, self.run_once("c.csv", options=["drop=100"]))
        self.assertNotEqual(first, self.run_once("d.csv", "--seed", "2"))

    def test_the_log_holds_every_sample_and_the_events_at_their_times(self):
        self.run_once("a.csv")
        log = rows(self.path("a.csv"))
        self.assertEqual([int(r["number"]) for r in log], list(range(301)))
        for r in log:
            self.assertEqual(float(r["d[degC]"]), 4.0 if float(r["time[s]"]) >= 300 else 0.0)
            if float(r["time[s]"]) > 600:
                self.assertEqual(float(r["u1.applied[%]"]), 15.0)

    def test_no_telemetry_row_is_dropped(self):
        self.run_once("a.csv")
        with open(self.path("a.csv.telemetry")) as file:
            lines = file.read().splitlines()
        self.assertTrue(lines[0].startswith("H,"))
        self.assertEqual([int(x.split(",")[2]) for x in lines[1:]], list(range(50)))

    def test_no_transcript_and_no_message_holds_an_access_key(self):
        self.controller()
        transcript = self.path("transcript")
        script = self.write("script", "0 ?unlock still\n1 ?  key still\n2 ?set console.key  still\n3 ?get console.key\n4 unlock  still\n")
        done = self.sim("--duration", "100", "--script", script, "--transcript", transcript)
        with open(transcript) as file:
            text = file.read()
        for line in ("> unlock ***", "> key ***", "> set console.key ***", "> get console.key"):
            self.assertIn(f"{line}\n", text)
        self.assertIn('script:5: "unlock " was answered "err', done.stderr)
        self.assertNotIn("still", text + done.stderr)

    def test_a_refused_console_line_ends_the_run_and_is_named(self):
        self.controller()
        script = self.write("script", "0 log on\n\n50 nonsense 1\n")
        done = self.sim("--duration", "1000", "--script", script, "--log", self.path("log"))
        self.assertEqual(done.returncode, 1)
        self.assertIn(f'{script}:3: "nonsense 1" was answered "err UNKNOWN no such command"', done.stderr)
        self.assertEqual(len(rows(self.path("log"))), 5)  # what came before is kept

    def test_a_console_line_that_is_never_answered_is_named(self):
        self.within(1, 'no reply to console line 1, "sleep", within {:.3f} s', "--duration", "1000", "--script",
                    self.write("s", "20 sleep\n"))

    def test_a_rebooted_controller_is_taken_up_again_with_its_telemetry(self):
        self.controller()
        done = self.sim("--duration", "1000", "--telemetry", self.path("t"), "--script",
                        self.write("s", "0 log on\n400 reboot\n"))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("1 controller restarts", done.stdout)
        with open(self.path("t")) as file:
            numbers = [int(x.split(",")[2]) for x in file if x.startswith("T,")]
        self.assertEqual(numbers, list(range(101)))

    def test_a_vanished_controller_is_noticed_at_once(self):
        self.controller("die=20")
        done = self.sim("--log", self.path("log"), "--timeout", f"{2 * HANG_S}")  # which it does not wait for
        self.assertEqual(done.returncode, 1)
        self.assertIn("closed the line", done.stderr)
        self.assertGreaterEqual(len(rows(self.path("log"))), 19)

    def test_a_silent_controller_ends_the_run_after_the_timeout(self):
        self.within(3, "no COMMAND for the sample within {:.3f} s", "--duration", "1000", controller=["mute=10"])

    def test_nobody_there_is_said(self):
        for port in (self.path("link"), "pty:" + self.path("link"), "socket:" + self.path("link")):
            done = subprocess.run([SIM, "--plant", "two_by_two", "--port", port, "--timeout", "0.2"],
                                  capture_output=True, text=True, timeout=HANG_S)
            self.assertEqual(done.returncode, 1)
            waiting, why = done.stderr.splitlines()
            self.assertEqual(waiting, f"reflux-sim: waiting for {port}, 0.2 s at most")
            self.assertIn("No such file or directory", why)

    def test_another_version_is_said(self):
        self.controller("version")
        done = self.sim("--timeout", f"{HANG_S}")
        self.assertEqual(done.returncode, 1)
        self.assertIn("plant link: the other side speaks version 2, this side 1", done.stderr)

    def test_an_interrupted_run_keeps_its_log_and_paces_by_the_clock(self):
        self.controller()
        began = time.monotonic()
        process = subprocess.Popen(self.arguments("--log", self.path("log"), "--speed", "200", "--progress"),
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        while time.monotonic() - began < HANG_S:  # progress is told a few times a second
            time.sleep(0.2)
            if os.path.exists(self.path("log")) and len(rows(self.path("log"))) > 20:
                break
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=HANG_S)
        self.assertEqual(process.returncode, 130)
        self.assertIn("samples", out)
        self.assertIn("plant time", err)
        took = time.monotonic() - began
        self.assertTrue(20 < len(rows(self.path("log"))) < 20 * took + 2, took)  # 20 a second, never more

    def test_the_python_plant_speaks_the_same_protocol(self):
        self.controller("drop=7")
        while not os.path.exists(self.path("console")):  # it listens there last
            time.sleep(0.01)
        # The controller waits for its console too; a connection is enough.
        process = subprocess.Popen([sys.executable, PYTHON_PLANT, self.path("link"), "20"],
                                   stdout=subprocess.PIPE, text=True)
        with socket.socket(socket.AF_UNIX) as console:
            console.connect(self.path("console"))
            out, _ = process.communicate(timeout=HANG_S)
        self.assertEqual(process.returncode, 0)
        self.assertEqual(len(out.splitlines()), 20)
        self.assertGreater(float(out.splitlines()[-1].split(",")[1]), 25.0)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
