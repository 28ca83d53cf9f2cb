#!/usr/bin/python3
"""Every column file there is, shipped or drawn at random, against the independent model in tests/reference: nominal state,
another state, responses to a step of every input.

usage: test_columns.py REFLUX_SIM [unittest options]
"""
import csv
import json
import os
import subprocess
import sys
import tempfile
import unittest

SIM = sys.argv.pop(1)
REFERENCE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "reference")
sys.path.insert(0, REFERENCE)

import columns_results  # noqa: E402
import columns_textbook  # noqa: E402
import numpy as np  # noqa: E402

FILES = columns_results.files()
SCALE = {"%": 1e-2, "%w": 1e-2, "ppm": 1e-6, "-": 1.0}
STEADY_FRACTION, STEADY_OTHERS = 1e-6, 1e-6  # mole fraction; relative
STEP_KELVIN, STEP_FRACTION, STEP_OTHERS = 0.002, 1e-5, 1e-4  # K; mole fraction; part of the nominal value


def rows(path):
    with open(path, encoding="utf-8", newline="") as file:
        return [row for row in csv.reader(file) if not row[0].startswith("#")]


def sim(*arguments):
    done = subprocess.run([SIM, *arguments], capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr
    return done.stdout


def channel(spec, value, fraction, steady):
    """Largest allowed error of a channel with this value."""
    kind = spec["is"]
    if kind in ("fraction", "vapour_fraction"):
        return fraction / SCALE[spec["unit"]]
    if kind == "log_fraction":
        x = min(max(1 / (1 + 2.718281828459045 ** -value), 1e-12), 1 - 1e-12)
        return fraction / (x * (1 - x))
    if kind in ("temperature", "temperature_difference"):
        return 1e-4 if steady else STEP_KELVIN
    return max(1e-9, (STEADY_OTHERS if steady else STEP_OTHERS) * abs(value))


class Columns(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.steady, cls.steps, cls.specs = {}, {}, {}
        for name, state, key, value in rows(columns_results.STEADY):
            cls.steady.setdefault((name, state), {})[key] = float(value)
        for name, key, seconds, *values in rows(columns_results.STEPS):
            cls.steps.setdefault(name, {})[key, float(seconds)] = [float(v) for v in values]
        for name, path in FILES.items():
            with open(path, encoding="utf-8") as file:
                cls.specs[name] = json.load(file)

    def inputs(self, name):
        return [c["name"] for c in self.specs[name]["inputs"] + self.specs[name].get("disturbances", [])]

    def compare(self, name, wanted, *settings, path=None):
        got = {row["name"]: float(row["value"]) for row in csv.DictReader(
            sim("--steady", "--plant", path or FILES[name], *settings).splitlines())}
        for spec in self.specs[name]["outputs"] + self.specs[name].get("truths", []):
            key = spec["name"]
            self.assertAlmostEqual(got[key], wanted[key], delta=channel(spec, wanted[key], STEADY_FRACTION, True), msg=key)
        for key in self.inputs(name):  # what the file trims is found to its seventh digit
            self.assertAlmostEqual(got[key], wanted[key], delta=1e-9 * abs(wanted[key]), msg=key)

    def test_every_file_has_its_results(self):
        self.assertEqual(set(FILES), set(self.steps))
        self.assertGreaterEqual(len(FILES), 24)

    def test_nominal_states_agree(self):
        for name in FILES:
            with self.subTest(name):
                self.compare(name, self.steady[name, "nominal"])

    def test_other_states_agree(self):
        for name in FILES:
            if (name, "moved") in self.steady:
                with self.subTest(name):
                    wanted = self.steady[name, "moved"]
                    self.compare(name, wanted, *(w for k in self.inputs(name) for w in ("--set", "%s=%.7g" % (k, wanted[k]))))

    def test_profiles_agree(self):
        wanted = {}
        for name, *values in rows(columns_results.PROFILES):
            wanted.setdefault(name, []).append([float(v) for v in values])
        for name in FILES:
            with self.subTest(name):
                lines = sim("--profile", "--plant", FILES[name]).splitlines()
                got = [[float(v or "nan") for v in line.split(",")] for line in lines[1:]]
                self.assertEqual(len(got), len(wanted[name]))
                for line, row in zip(got, wanted[name]):
                    del line[2]  # the difference of temperatures
                    self.assertAlmostEqual(line[1], row[1], delta=1e-4)
                    for a, b in zip(line[2:5], row[2:5]):
                        self.assertAlmostEqual(a, b, delta=1e-9 + 1e-6 * abs(b))
                    fractions = len(self.specs[name]["components"]) * (1 if row[0] == len(got) else 2)
                    for a, b in zip(line[5:5 + fractions], row[5:5 + fractions]):  # no vapour leaves the condenser
                        self.assertAlmostEqual(a, b, delta=1e-6)

    def test_the_page_has_the_figures_of_the_textbook_columns(self):
        with open(os.path.join(REFERENCE, "columns-textbook.md"), encoding="utf-8") as file:
            page = file.read()
        self.assertIn("\n".join(columns_textbook.table()), page)

    def test_column_a_has_the_published_relative_gains_as_lv_and_as_dv(self):
        for file, published in ((columns_textbook.read("column-a"), 35.1), (columns_textbook.twin(columns_textbook.read("column-a")), 0.45)):
            with tempfile.TemporaryDirectory() as folder:
                path = os.path.join(folder, "column-a.json")
                with open(path, "w", encoding="utf-8") as out:
                    json.dump(file, out)
                m = json.loads(sim("--linearise", "--plant", path, "--format", "json"))
            a, b, c, d = (np.array(m[k], float) for k in "ABCD")
            k = (d - c @ np.linalg.solve(a, b))[[m["outputs"].index("xD"), m["outputs"].index("xB")]][:, :2]
            self.assertAlmostEqual((k * np.linalg.inv(k).T)[0, 0] / published, 1, delta=0.03)

    def test_a_trim_is_found_to_its_last_digit_however_wide_the_span_of_its_channel(self):
        file = json.loads(json.dumps(self.specs["random-05"]))
        goal = file["steady_state"][0]
        next(c for c in file["outputs"] if c["name"] == goal["channel"]).update(lo=-1e6, hi=1e9)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "random-05.json")
            with open(path, "w", encoding="utf-8") as out:
                json.dump(file, out)
            self.compare("random-05", self.steady["random-05", "nominal"], path=path)

    def test_an_empty_drum_is_empty_in_the_profile(self):
        lines = sim("--profile", "--plant", FILES["random-14"], "--set", "Q=0", "--set", "q=1.5").splitlines()
        holdup = lines[0].split(",").index("holdup[mol]")
        self.assertAlmostEqual(float(lines[-1].split(",")[holdup]), 0.0, delta=1e-6)

    def test_linearisations_agree(self):
        """With complex steps: 1e-6 of the largest entry of a row, and 1e-3 of each entry above 1e-6."""
        for name in FILES:
            with self.subTest(name):
                m = json.loads(sim("--linearise", "--plant", FILES[name], "--format", "json"))
                column = columns_results.again(name)
                # Logarithms of a fraction below 1e-6 are left out: the states kept have twelve digits.
                said = [spec["is"] != "log_fraction" or abs(self.steady[name, "nominal"][spec["name"]]) < 14 for spec in column.outputs]
                reference = dict(zip("ABCD", column.linearise()))
                for key, right in reference.items():
                    rounding = 1e-11 * max(np.abs(reference[k]).max() for k in ("AB" if key in "AB" else "CD"))
                    got = np.array(m[key], float)
                    if key in "CD":
                        got, right = got[said], right[said]
                    far = np.abs(got - right)
                    # a row of nothing but zeros may hold rounding
                    allowed = 1e-6 * np.abs(right).max(axis=1, keepdims=True) + rounding
                    worst = np.unravel_index(np.argmax(far / allowed), far.shape)
                    self.assertLess((far / allowed)[worst], 1.0, "%s%s: %g, by the reference %g" % (key, worst, got[worst], right[worst]))
                    small = np.abs(right) > 1e-6
                    self.assertTrue(np.all(far[small] <= 1e-3 * np.abs(right)[small]), key)

    def test_steps_agree(self):
        for name in FILES:
            with self.subTest(name):
                self.steps_of(name)

    def steps_of(self, name):
        tick, last = columns_results.tick(name), max(t for _, t in self.steps[name])
        text = sim("--step", "--plant", FILES[name], "--size", str(columns_results.size(name)), "--tick", str(tick),
                   "--duration", str(last))
        table = list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))
        by_time = {round(float(row["time[s]"])): {k.split("[")[0]: float(v) for k, v in row.items()} for row in table}
        worst = (0.0, "")
        for (key, seconds), values in self.steps[name].items():
            for spec, wanted in zip(self.specs[name]["outputs"], values):
                at = self.steady[name, "nominal"][spec["name"]]
                got = by_time[round(seconds)]["%s.%s" % (spec["name"], key)]
                far = abs(got - wanted) / max(channel(spec, at, STEP_FRACTION, False), channel(spec, at + wanted, STEP_FRACTION, False))
                worst = max(worst, (far, "%s.%s after %g s: %.9g, by the reference %.9g" % (spec["name"], key, seconds, got, wanted)))
        self.assertLess(worst[0], 1.0, worst[1])


if __name__ == "__main__":
    unittest.main()
