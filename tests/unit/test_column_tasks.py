#!/usr/bin/python3
"""The columns as reflux-sim's tasks show them: --list, --steady, --linearise, --step; gains and pairings against the
independent reference; what cannot be, in one line.

usage: test_column_tasks.py REFLUX_SIM
"""
import csv
import json
import os
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

import numpy as np

SIM = sys.argv[1]
REFERENCE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "reference")
SS2 = ("R=32.2787", "Q=2804.458")
# name in the tables: plant, settings, outputs (None: all measurements)
CASES = {"pilot": ("pilot", (), None), "pilot-2x2": ("pilot", (), ("T1", "T10")),
         "splitter": ("splitter", (), None), "splitter-ss2": ("splitter", SS2, None)}


def sim(*arguments):
    return subprocess.run([SIM, *arguments], capture_output=True, text=True, timeout=900)


def settings(values):
    return [word for v in values for word in ("--set", v)]


def steady(plant, *values):
    done = sim("--steady", "--plant", plant, *settings(values))
    assert done.returncode == 0, done.stderr
    return {row["name"]: float(row["value"]) for row in csv.DictReader(done.stdout.splitlines())}


def linearised(plant, *values):
    done = sim("--linearise", "--plant", plant, "--format", "json", *settings(values))
    assert done.returncode == 0, done.stderr
    m = json.loads(done.stdout)
    return m | {key: np.array(m[key], float) for key in "ABCD"}


def table(name):
    with open(os.path.join(REFERENCE, name), encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def channels(plant):
    """{name: (kind, lo, hi)}"""
    lines = [line.split() for line in sim("--list", plant).stdout.splitlines() if line.startswith("  ")]
    return {w[1]: (w[0], float(w[3]), float(w[5])) for w in lines if len(w) > 5 and w[4] == "to"}


class Columns(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.models = {case: linearised(plant, *values) for case, (plant, values, _) in CASES.items()}

    def gain(self, case, output, inlet):
        m = self.models[case]
        k = m["D"] - m["C"] @ np.linalg.solve(m["A"], m["B"])
        return k[m["outputs"].index(output), m["inputs"].index(inlet)]

    def test_the_splitter_is_listed_in_full(self):
        text = sim("--list", "splitter").stdout
        for word in ("source: Frau", "ours: ", "tick: 30 s", "37 stages"):
            self.assertIn(word, text)
        kinds = [kind for kind, _, _ in channels("splitter").values()]
        self.assertEqual([kinds.count(k) for k in ("manipulated", "disturbance", "measurement", "internal")],
                         [2, 10, 13, 32])

    def test_steady_prints_both_published_steady_states_of_the_splitter(self):
        first, second = steady("splitter"), steady("splitter", *SS2)
        self.assertAlmostEqual(first["iC4_D"], 0.02, delta=1e-5)
        self.assertAlmostEqual(second["iC4_D"], 0.02, delta=1e-5)
        self.assertAlmostEqual(second["C3_B"], 0.02, delta=1e-5)
        with open(os.path.join(REFERENCE, "splitter_steady.csv"), encoding="utf-8") as file:
            rows = [[float(x) for x in line.split(",")] for line in file if not line.startswith("#")]
        for found, row in zip((first, second), rows):
            for stage in range(1, 38):
                self.assertAlmostEqual(found[f"T{stage}"], row[1 + stage], delta=1e-4)

    def test_the_linearised_splitter_is_stable_and_has_all_states(self):
        for case in ("splitter", "splitter-ss2"):
            m = self.models[case]
            self.assertEqual(m["A"].shape, (185, 185))
            self.assertEqual((m["B"].shape, m["C"].shape), ((185, 12), (45, 185)))
            poles = np.linalg.eigvals(m["A"])
            self.assertLess(max(poles.real), 0)
            self.assertTrue(0.5 < -1 / max(poles.real) / 3600 < 5, "slowest time constant, h")

    def test_gains_of_the_linearised_columns_are_those_of_the_reference(self):
        rows = table("column_gains.csv")
        self.assertEqual(len(rows), 2 * (5 + 2 + 13 + 13))
        for row in rows:
            found = self.gain(row["plant"], row["output"], row["input"])
            self.assertAlmostEqual(found / float(row["gain"]), 1.0, delta=1e-7, msg=str(row))

    def test_pairings_follow_from_the_linearised_columns(self):
        found = {}
        for case, (plant, _, outputs) in CASES.items():
            span = {n: (kind, hi - lo) for n, (kind, lo, hi) in channels(plant).items()}
            inputs = [n for n, (kind, _) in span.items() if kind == "manipulated"]
            outputs = outputs or [n for n, (kind, _) in span.items() if kind == "measurement"]
            k = np.array([[self.gain(case, y, u) * span[u][1] / span[y][1] for u in inputs] for y in outputs])
            rga = k * np.linalg.pinv(k).T
            for row in table("column_pairing.csv"):
                if row["plant"] == case:
                    value = rga[outputs.index(row["output"]), inputs.index(row["input"])]
                    self.assertAlmostEqual(value / float(row["relative_gain"]), 1.0, delta=1e-5, msg=str(row))
                    found.setdefault(case, set()).add(row["input"])
        self.assertEqual([sorted(found[c]) for c in CASES], [["Lr", "Qrb"]] * 2 + [["Q", "R"]] * 2)

    def test_steps_of_the_splitter_are_those_of_its_linearisation_when_small(self):
        done = sim("--step", "--plant", "splitter", "--size", "0.0005", "--tick", "600", "--duration", "7200")
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = list(csv.DictReader(line for line in done.stdout.splitlines() if not line.startswith("#")))
        m = self.models["splitter"]
        n = len(m["A"])
        both = np.zeros((n + 1, n + 1))
        both[:n, :n], both[:n, n] = m["A"], m["B"][:, m["inputs"].index("Q")]
        values, vectors = np.linalg.eig(both)
        for row in rows[1::4]:
            t = float(row["time[s]"])
            x = (vectors @ np.diag(np.exp(values * t)) @ np.linalg.inv(vectors)).real[:n, n]
            expected = 6000 * 0.0005 / 100 * m["C"][m["outputs"].index("T30")] @ x
            self.assertAlmostEqual(float(row["T30.Q[K]"]), expected, delta=0.02 * abs(expected) + 1e-5)

    def test_a_table_is_made_and_says_the_same_when_it_is_read(self):
        done = sim("--table", "--plant", "splitter", "--components", "C3,iC4,nC4", "--truncated", "2-15,20-22",
                   "--block", "2", *settings(SS2))
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        head = [line for line in done.stdout.splitlines() if line.startswith("#")]
        self.assertEqual(head[0], "# splitter: 37 stages, feed on 19, components C3 iC4 nC4 (the last closes), "
                                  "57 states (17 stages truncated)")
        # The checksum by the words of docs/methods/column-table.md.
        value = dict(line.split()[1:] for line in done.stdout.splitlines() if line.startswith("set "))
        size, rows = int(value["block2.size"]), [value[f"block2.value.{k}"].split(",") for k in range(1, 22)]
        floats = [float(x) for row in rows for x in row][:size]
        crc = zlib.crc32(struct.pack(f"<HH{size}f", int(value["block2.version"]), size, *floats))
        self.assertEqual(value["block2.checksum.1"], f"{crc >> 16},{crc & 0xFFFF}")
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "table.txt")
            for text, said in ((done.stdout, None), (done.stdout.replace(",37,3,19,0.8", ",37,3,19,0.9"),
                                                     "block2.checksum: must be"),
                               ("apply\n", "no line `set blockN.kind column`")):
                with open(file, "w", encoding="utf-8") as out:
                    out.write(text)
                if said:
                    self.refused(said, 2, "--table-check", file)
                else:
                    self.assertEqual(sim("--table-check", file).stdout.splitlines(), ["# block2", *head[:2]])
        self.refused("has no meaning with --steady", 2, "--steady", "--plant", "splitter", "--components", "C3")
        self.refused("--table-check: a file is missing", 2, "--table-check")
        self.refused("--block 1.5: must be a whole number", 2, "--table", "--plant", "pilot", "--block", "1.5")

    def refused(self, because, status, *arguments):
        done = sim(*arguments)
        self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (status, "", 1), done.stderr)
        self.assertIn(because, done.stderr)

    def test_what_cannot_be_is_said_in_one_line(self):
        at = ("--steady", "--plant", "splitter")
        self.refused("Q = 9000 Mcal/h is outside 0 to 6000", 2, *at, "--set", "Q=9000")
        self.refused("leaves feed fractions that add up to less than 0.1", 2, *at,
                     *settings(("zC3=0", "ziC4=0", "znC4=0")))
        self.refused("no such input", 2, *at, "--set", "T31=330")
        self.refused("F must be 0 to 150 m3/h", 2, "--plant", "splitter", "--port", "x", "--event", "1:F=200")
        self.refused("Q is driven by the controller", 2, "--plant", "splitter", "--port", "x", "--event", "1:Q=2")

    def test_inputs_without_a_steady_state_are_refused_with_the_reason(self):
        self.refused("no steady state found for these inputs: nothing leaves at the top, the reflux takes all of it", 1,
                     "--steady", "--plant", "splitter", *settings(("R=110", "Q=5331", "zC2=0", "zC3=0")))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
