#!/usr/bin/python3
"""Plant files as reflux-sim takes them: refusals, --list, --steady, --linearise, --step, and published figures.

usage: test_linear_files.py REFLUX_SIM
"""
import csv, json, os, re, subprocess, sys, tempfile, unittest
from copy import deepcopy

import numpy as np

SIM = sys.argv[1]
HERE = os.path.dirname(os.path.abspath(__file__))
REFERENCE = os.path.join(HERE, "..", "reference")

GOOD = {
    "name": "good", "title": "a good plant", "source": "this test", "tick_s": 1,
    "inputs": [{"name": "u1", "lo": 0, "hi": 100, "nominal": 50},
               {"name": "u2", "lo": 0, "hi": 100, "nominal": 50}],
    "disturbances": [{"name": "d", "lo": -1, "hi": 1, "nominal": 0}],
    "outputs": [{"name": "y1", "lo": 0, "hi": 10, "nominal": 5}, {"name": "y2", "lo": 0, "hi": 10, "nominal": 5}],
    "model": "transfer",
    "elements": [[{"gain": 0.1, "lags": 5, "dead_time": 1}, None, {"gain": 1, "lags": [2, 3], "zero": 1}],
                 [{"gain": 0.2, "quadratic": [1, 0.5]}, {"gain": -0.1, "lags": 4}, None]],
}
STATES = {
    "model": "state_space", "A": [[-0.1, 0], [0.1, -0.2]], "B": [[0.1, 0], [0, 0.1]], "E": [[1], [0]],
    "C": [[1, 0], [0, 1]],
}


def sim(*arguments, **more):
    return subprocess.run([SIM, *arguments], capture_output=True, text=True, timeout=900, **more)


def table(name):
    with open(os.path.join(REFERENCE, name)) as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def model(name):
    done = sim("--linearise", "--plant", name, "--format", "json")
    assert done.returncode == 0, done.stderr
    m = json.loads(done.stdout)
    n = len(m["A"])
    for key, shape in (("A", (n, n)), ("B", (n, -1)), ("C", (-1, n)), ("D", (len(m["outputs"]), -1))):
        m[key] = np.array(m[key], float).reshape(shape if n else (len(m["outputs"]), -1))
    return m


def gain(name):
    m = model(name)
    rates = np.eye(len(m["A"])) - m["A"] if m["period_s"] else -m["A"]
    return m["C"] @ np.linalg.solve(rates, m["B"]) + m["D"]


class Folder(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()

    def tearDown(self):
        self.folder.cleanup()

    def write(self, text, name="p.json"):
        path = os.path.join(self.folder.name, name)
        with open(path, "wb") as file:
            file.write(text if isinstance(text, bytes) else text.encode())
        return path

    def refused(self, text, because):
        path = self.write(text)
        for task in (["--steady"], ["--list"], ["--port", "x"]):
            done = sim(*task, "--plant", path)
            self.assertEqual(done.returncode, 2, done)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
            self.assertEqual(done.stdout, "")
            self.assertIn(because.replace("FILE", path), done.stderr)


class BadFiles(Folder):
    def test_what_is_not_json_is_refused_with_line_and_column(self):
        for text, because in [
            ("", "FILE:1:0: not JSON"),
            ("{", "FILE:1:1: not JSON"),
            ('{\n "name": "x",\n "title" "y"}', "FILE:3:12: not JSON: ':' expected"),
            ('{"a": 1, "a": 2}', "not JSON: duplicate object key"),
            ('{"a": NaN}', "FILE:1:9: not JSON: invalid token"),
            ('{"a": 1e999}', "not JSON: real number overflow"),
            ('{"a": "\n"}', "not JSON"),
            ("{} {}", "not JSON: end of file expected"),
            (b"{\"a\": \"\xff\"}", "not JSON"),
            (b"\x00\x01", "not JSON"),
            ("[" * 5000, "not JSON: maximum parsing depth"),
        ]:
            with self.subTest(text=text[:40]):
                self.refused(text, because)

    def changed(self, change, base=GOOD):
        plant = deepcopy(base)
        change(plant)
        return json.dumps(plant)

    def test_wrong_contents_are_refused_with_their_path(self):
        def at(*path):
            def put(value):
                def change(p):
                    for k in path[:-1]:
                        p = p[k]
                    if value is KeyError:
                        del p[path[-1]]
                    else:
                        p[path[-1]] = value
                return change
            return put
        e00 = ("elements", 0, 0)
        for change, because in [
            (at("name")(KeyError), 'FILE: $: the key "name" is missing'),
            (at("name")(7), "FILE: $.name: must be a text, is a number"),
            (at("name")("Big Plant"), "$.name: \"Big Plant\" may only have small letters"),
            (at("title")(""), "$.title: must have 1 to 120 characters, has 0"),
            (at("title")("x" * 121), "$.title: must have 1 to 120 characters, has 121"),
            (at("title")("two\nlines"), "$.title: must be one line"),
            (at("colour")("red"), 'FILE: $: no key "colour" is known here; known are name, title'),
            (at("tick_s")("1"), "$.tick_s: must be a number, is a text"),
            (at("tick_s")(0), "$.tick_s: 0 must be 0.001 to 86400"),
            (at("tick_s")(0.0015), "$.tick_s: 0.0015 must be a whole number of milliseconds"),
            (at("time_unit")("fortnight"), "$.time_unit: must have 1 to 8 characters, has 9"),
            (at("time_unit")("day"), '$.time_unit: must be s, min or h, is "day"'),
            (at("inputs")({}), "$.inputs: must be an array of channels, is an object"),
            (at("inputs")([]), "$.inputs: must hold 1 to 16 channels, holds 0"),
            (at("inputs", 0)(3), "$.inputs[0]: must be an object, is a number"),
            (at("inputs", 1, "name")("u1"), '$.inputs[1].name: "u1" is the name of an earlier channel too'),
            (at("inputs", 1, "name")("u 2"), "$.inputs[1].name: \"u 2\" may only have letters"),
            (at("inputs", 1, "name")("a_very_long_name"), "$.inputs[1].name: must have 1 to 15 characters"),
            (at("inputs", 0, "unit")("furlongs/week"), "$.inputs[0].unit: must have 1 to 11 characters"),
            (at("inputs", 0, "lo")(200), "$.inputs[0]: lo, 200, must be below hi, 100"),
            (at("inputs", 0, "nominal")(KeyError), '$.inputs[0]: the key "nominal" is missing'),
            (at("inputs", 0, "nominal")(101), "$.inputs[0].nominal: 101 must be 0 to 100"),
            (at("inputs", 0, "safe")(-1), "$.inputs[0].safe: -1 must be 0 to 100"),
            (at("inputs", 0, "slew")(-1), "$.inputs[0].slew: -1 must be 0 to"),
            (at("inputs", 0, "noise")(1), '$.inputs[0]: no key "noise" is known here'),
            (at("outputs", 0, "noise")(-1), "$.outputs[0].noise: -1 must be 0 to"),
            (at("outputs", 0, "lag_s")(True), "$.outputs[0].lag_s: must be a number, is true or false"),
            (at("outputs", 0, "safe")(1), '$.outputs[0]: no key "safe" is known here'),
            (at("model")("neural"), '$.model: must be transfer, state_space, discrete or polynomial, is "neural"'),
            (at("A")([[1]]), '$: the key "A" has no meaning in a model "transfer"'),
            (at("period")(1), '$: the key "period" has no meaning in a model "transfer"'),
            (at("elements")(KeyError), '$: the key "elements" is missing'),
            (at("elements")([[None] * 3]), "$.elements: must hold 2 rows, one an output, holds 1"),
            (at("elements", 1)([None]), "$.elements[1]: must hold 3 elements, one an input and disturbance, holds 1"),
            (at("elements", 1, 0)(7), "$.elements[1][0]: must be an object, is a number"),
            (at(*e00, "gain")(KeyError), '$.elements[0][0]: the key "gain" is missing'),
            (at(*e00, "gain")(None), "$.elements[0][0].gain: must be a number, is null"),
            (at(*e00, "lag")(1), '$.elements[0][0]: no key "lag" is known here; known are gain, zero, lags'),
            (at(*e00, "lags")(0), "$.elements[0][0].lags: 0 must be 1e-09 to 1e+06"),
            (at(*e00, "lags")([1, -2]), "$.elements[0][0].lags[1]: -2 must be"),
            (at(*e00, "lags")([1, 2, 3]), "$.elements[0][0].lags: must hold 1 to 2 time constants, holds 3"),
            (at(*e00, "quadratic")([1, 1]), "$.elements[0][0]: has lags and quadratic"),
            (at("elements", 1, 0, "quadratic")([0, 1]), "$.elements[1][0].quadratic[0]: 0 must be"),
            (at("elements", 1, 0, "quadratic")([1]), "$.elements[1][0].quadratic: must hold 2 numbers"),
            (at("elements", 1, 0, "integrator")(1), "$.elements[1][0].integrator: must be true or false"),
            (at(*e00, "dead_time")(-1), "$.elements[0][0].dead_time: -1 must be 0 to"),
            (at(*e00)({"gain": 1, "zero": 1}), "$.elements[0][0]: has a zero but no lag"),
            (at(*e00)({"parameter": "r", "cases": []}), '$.elements[0][0]: "r" is not the name of a parameter'),
        ]:
            text = self.changed(change)
            with self.subTest(because=because):
                self.refused(text, because)

    def test_wrong_matrices_are_refused_with_their_path(self):
        base = {k: v for k, v in GOOD.items() if k != "elements"} | STATES
        for more, because in [
            ({"A": [[1, 2]]}, "$.A[0]: must hold 1 numbers, holds 2"),
            ({"A": [[-0.1, 0], [0.1]]}, "$.A[1]: must hold 2 numbers, holds 1"),
            ({"A": [[-0.1, 0], [0.1, "x"]]}, "$.A[1][1]: must be a number, is a text"),
            ({"A": []}, "$.A: must hold 1 to 200 rows, holds 0"),
            ({"B": [[1, 1]]}, "$.B: must hold 2 rows, holds 1"),
            ({"B": 3}, "$.B: must be an array of rows, is a number"),
            ({"C": [[1, 0]]}, "$.C: must hold 2 rows, holds 1"),
            ({"D": [[1], [1]]}, "$.D[0]: must hold 2 numbers, holds 1"),
            ({"E": [[1, 1], [1, 1]]}, "$.E[0]: must hold 1 numbers, holds 2"),
            ({"E": None}, "$: there are disturbances, but neither E nor F"),
            ({"period": 1}, '$: the key "period" has no meaning in a model "state_space"'),
            ({"model": "discrete"}, '$: the key "period" is missing'),
            ({"model": "discrete", "period": 2}, "$: tick_s, 1, must be the period of a discrete plant, 2 s"),
            ({"model": "discrete", "period": 0.0015}, "$: period must be a whole number of milliseconds"),
            ({"model": "polynomial", "period": 1, "A": [[[1]]], "C": None, "E": None}, "$.A[0]: must hold 2 rows, holds 1"),
            ({"model": "polynomial", "period": 1, "A": [], "C": None, "E": None}, "$.A: must hold 1 to 50 matrices"),
        ]:
            plant = base | more
            with self.subTest(more=more):
                self.refused(json.dumps({k: v for k, v in plant.items() if v is not None}), because)

    def test_a_missing_file_and_a_file_too_long_are_said(self):
        for path, because in [("/no/such.json", "No such file"), (self.folder.name + "/", "Is a directory")]:
            done = sim("--steady", "--plant", path)
            self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1))
            self.assertIn(because, done.stderr)
        self.refused(" " * 1000001, "may have 1000000 bytes at most")

    def test_every_cut_of_a_good_file_is_refused_and_nothing_crashes(self):
        text = json.dumps(GOOD)
        for end in range(0, len(text), 23):
            self.assertEqual(sim("--steady", "--plant", self.write(text[:end])).returncode, 2)

    def test_events_out_of_range_are_refused(self):
        for event, because in [("1:d=2", "d must be -1 to 1"), ("1:u9.hi=3", "u9"), ("1:regime=1", "regime")]:
            done = sim("--plant", self.write(json.dumps(GOOD)), "--port", "x", "--event", event)
            self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1), done.stderr)
            self.assertIn(because, done.stderr)


class Tasks(Folder):
    def test_a_file_and_a_folder_of_files_are_found(self):
        path = self.write(json.dumps(GOOD), "good.json")
        self.assertIn("measurement,y1,-,5\n", sim("--steady", "--plant", path).stdout)
        user = os.environ | {"REFLUX_PLANTS": self.folder.name}
        self.assertIn("\ngood: a good plant", sim("--list", env=user).stdout)
        self.assertIn("good: a good plant", sim("--list", "good", env=user).stdout)
        self.assertIn("wood-berry, good\n", sim("--list", "bad", env=user).stderr)
        self.write("{", "worse.json")
        self.assertIn("cannot be read", sim("--list", env=user).stdout)

    def test_the_worked_example_of_the_page_works(self):
        with open(os.path.join(HERE, "..", "..", "docs", "use", "linear-plants.md"), encoding="utf-8") as file:
            text = re.search(r"```json\n(.*?)```", file.read(), re.S).group(1)
        done = sim("--steady", "--plant", self.write(text, "oven.json"), "--set", "air=10")
        self.assertIn("measurement,T1,degC,160\n", done.stdout)

    def test_lists(self):
        lines = sim("--list").stdout.splitlines()
        names = [line.split(":")[0] for line in lines if not line.startswith(" ")]
        self.assertIn("pilot", names)
        self.assertGreaterEqual(len(names), 17)
        self.assertIn("example 11", lines[-1])
        for name in names:
            done = sim("--list", name)
            self.assertEqual(done.returncode, 0)
            for word in ("source: ", "tick: ", "manipulated", "measurement"):
                self.assertIn(word, done.stdout)
            self.assertIn("ours: ", done.stdout)

    def test_wrong_tasks_are_refused(self):
        for arguments, because in [
            (["--steady"], "--plant NAME is missing"),
            (["--steady", "--step", "--plant", "pilot"], "--steady and --step: only one of them"),
            (["--steady", "--plant", "pilot", "--speed", "1"], "--speed: has no meaning with --steady"),
            (["--step", "--plant", "wood-berry", "--size", "0"], "--size 0: must be a number"),
            (["--step", "--plant", "wood-berry", "--duration", "1e9", "--tick", "1"], "ticks of 1 s; at most"),
            (["--linearise", "--plant", "wood-berry", "--format", "xml"], "must be csv or json"),
            (["--step", "--plant", "kotyk-column", "--tick", "60"], "no other tick will do"),
            (["--plant", "kotyk-column", "--tick", "60", "--port", "x"], "no other tick will do"),
            (["--list", "nothing"], "--plant nothing: no such plant, and no path of a .json file; there is pilot-cold, "),
            (["--steady", "rubbish"], "rubbish: not an option"),
        ]:
            with self.subTest(arguments=arguments):
                done = sim(*arguments)
                self.assertEqual((done.returncode, done.stderr.count("\n"), done.stdout), (2, 1, ""), done.stderr)
                self.assertIn(because, done.stderr)

    def test_points_that_cannot_be_are_refused(self):
        for value, because in [("R=9", "R = 9 lb/min is outside 0 to 4"), ("R", "must be NAME=NUMBER"),
                               ("Q=1", "wood-berry has no such input; there is R S"), ("R=nan", "must be NAME=NUMBER")]:
            done = sim("--steady", "--plant", "wood-berry", "--set", value)
            self.assertEqual((done.returncode, done.stderr.count("\n"), done.stdout), (2, 1, ""), done.stderr)
            self.assertIn(because, done.stderr)

        done = sim("--steady", "--plant", "boiler-9002", "--set", "u1=0.5")
        self.assertEqual((done.returncode, done.stderr.count("\n"), done.stdout), (1, 1, ""), done.stderr)
        self.assertIn("no steady state: y2 would end", done.stderr)

    def test_steps_are_those_of_the_plant(self):
        done = sim("--step", "--plant", "wood-berry", "--tick", "30", "--duration", "600", "--size", "10")
        lines = [line for line in done.stdout.splitlines() if not line.startswith("#")]
        self.assertEqual(lines[0], "number,time[s],xD.R[%w],xB.R[%w],xD.S[%w],xB.S[%w]")
        for line in lines[1:]:
            k, t, a, b, c, d = map(float, line.split(","))
            for found, (g, lag, dead) in zip((a, b, c, d), ((12.8, 16.7, 1), (6.6, 10.9, 7), (-18.9, 21, 3), (-19.4, 14.4, 3))):
                s = max(t / 60 - dead, 0)
                self.assertAlmostEqual(found, 0.4 * g * (1 - np.exp(-s / lag)), delta=1e-10)

    def test_the_same_commands_give_the_same_bytes(self):
        for task in (["--step", "--plant", "luyben-4x4"], ["--linearise", "--plant", "pilot"]):
            self.assertEqual(sim(*task).stdout, sim(*task).stdout)


class Figures(unittest.TestCase):
    def test_poles_are_those_of_the_reference(self):
        wanted = {}
        for row in table("linear_poles.csv"):
            wanted.setdefault(row["plant"], []).append(complex(float(row["re"]), float(row["im"])))
        for name, poles in wanted.items():
            found = np.linalg.eigvals(model(name)["A"])
            self.assertEqual(len(found), len(poles), name)
            for p in poles:  # a double pole is only found to the root of the rounding error
                nearest = min(found, key=lambda f: abs(f - p))
                self.assertLess(abs(nearest - p), 1e-6 * abs(p) + 1e-9, (name, p, nearest))

    def test_published_figures(self):
        rga = lambda k: (k * np.linalg.inv(k).T)[0, 0]
        self.assertAlmostEqual(rga(gain("wood-berry")), 2.009, delta=5e-4)
        self.assertAlmostEqual(rga(gain("luyben-vinante")), 1.60, delta=5e-3)
        kotyk = gain("kotyk-column")
        self.assertAlmostEqual(rga(kotyk), 1.4526, delta=5e-5)
        np.testing.assert_allclose(kotyk, [[0.15553, -0.05629], [0.19767, -0.22961]], atol=5e-6)
        self.assertAlmostEqual(rga(gain("folami-gains")), 6.253, delta=5e-4)
        poles = np.linalg.eigvals(model("column-9001")["A"])
        self.assertLess(max(poles.real), 0)
        self.assertAlmostEqual(1 / min(abs(poles)), 8229, delta=0.5)
        poles = np.sort(np.linalg.eigvals(model("boiler-9002")["A"]).real)
        self.assertLess(abs(poles[-1]), 1e-8)
        self.assertLess(poles[-2], -1e-3)

    def test_the_paper_machine_has_rank_4_and_the_printed_gains(self):
        k = gain("paper-machine")
        s = np.linalg.svd(k)[1]
        self.assertGreater(s[3], 1e-3)
        self.assertLess(s[4], 1e-12 * s[0])
        # Johansson's K to its one decimal, but for column u3 and K22 (docs/use/linear-plants.md)
        np.testing.assert_allclose(k[[0, 2, 3, 4]][:, [0, 1, 3, 4]],
                                   [[-6.8, -6.6, 6.6, 0], [0.5, 0.5, -0.5, 0], [1, 1, -1, 0], [0.3, 0.3, 0, 0.3]],
                                   atol=0.085)
        np.testing.assert_allclose(k[1, [0, 3, 4]], [-0.2, 0.1, 0.0], atol=0.05)

    def test_pairings_follow_from_the_gains_of_the_program(self):
        pairs = [row for row in table("linear_pairing.csv") if row["output"] != "none"]
        for row in pairs:
            m = model(row["plant"])
            done = sim("--list", row["plant"]).stdout.splitlines()
            span = {w[1]: float(w[5]) - float(w[3]) for w in map(str.split, done) if w[0] in ("manipulated", "measurement")}
            inputs = [j for j, u in enumerate(m["inputs"]) if u in span]
            k = gain(row["plant"])[:, inputs] * [[span[m["inputs"][j]] / span[y] for j in inputs] for y in m["outputs"]]
            kept = [r["output"] for r in pairs if r["plant"] == row["plant"]]  # the outputs that are controlled
            sums = dict(zip(m["outputs"], (k * np.linalg.pinv(k).T).sum(axis=1)))
            self.assertGreaterEqual(min(sums[y] for y in kept), max([0, *(sums[y] for y in sums if y not in kept)]))
            k = k[[m["outputs"].index(y) for y in kept]]
            rga = k * np.linalg.inv(k).T
            found = rga[kept.index(row["output"]), [m["inputs"][j] for j in inputs].index(row["input"])]
            self.assertAlmostEqual(found, float(row["relative_gain"]), delta=1e-6)

    def test_the_pilot_linearised_has_its_own_steady_gains(self):
        m = model("pilot")
        k = gain("pilot")
        self.assertEqual(m["A"].shape, (12, 12))
        self.assertLess(max(np.linalg.eigvals(m["A"]).real), 0)
        for name, h in (("Lr", 0.01), ("Qrb", 0.001), ("F", 0.01)):
            ends = []
            for sign in (-1, 1):
                nominal = {"Lr": 4.5, "Qrb": 0.8, "F": 5.0}[name]
                text = sim("--steady", "--plant", "pilot", "--set", f"{name}={nominal + sign * h}").stdout
                ends.append({r["name"]: float(r["value"]) for r in csv.DictReader(text.splitlines())})
            for output in ("T1", "T10", "xB"):
                by_steady = (ends[1][output] - ends[0][output]) / (2 * h)
                by_matrices = k[m["outputs"].index(output), m["inputs"].index(name)]
                self.assertAlmostEqual(by_matrices / by_steady, 1.0, delta=2e-3, msg=f"{output} to {name}")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
