#!/usr/bin/python3
"""--linearise of the columns against exact derivatives of independent models: of pilot and splitter (tests/reference/
complex_step.py) at ordinary points and at odd ones, nothing of a component, pure products, total reflux, inputs at their
ends; of small columns of all kinds (columns_reference.py) at their nominal states.

usage: test_linearise.py REFLUX_SIM
"""
import json
import os
import subprocess
import sys
import tempfile
import unittest

import numpy as np

SIM = sys.argv[1]
ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
sys.path.insert(0, os.path.join(ROOT, "tests", "reference"))
import columns_reference  # noqa: E402
import complex_step  # noqa: E402

SS2 = ("R=32.2787", "Q=2804.458")


def linearised(plant, *values):
    done = subprocess.run([SIM, "--linearise", "--plant", plant, "--format", "json",
                           *(word for v in values for word in ("--set", v))], capture_output=True, text=True, timeout=900)
    assert done.returncode == 0, done.stderr
    m = json.loads(done.stdout)
    return m | {key: np.array(m[key], float) for key in "ABCDxuy"}


def spans(plant):
    """{name: width} of inputs and outputs."""
    text = subprocess.run([SIM, "--list", plant], capture_output=True, text=True, timeout=60).stdout
    lines = [line.split() for line in text.splitlines() if line.startswith("  ")]
    return {w[1]: float(w[5]) - float(w[3]) for w in lines if len(w) > 5 and w[4] == "to"}


class Linearised(unittest.TestCase):
    def near(self, what, found, right):
        """To 1e-6 of the largest entry of the row, and to 1e-3 of each entry above 1e-6."""
        off = np.abs(found - right)
        largest = np.abs(right).max(axis=1, keepdims=True)
        for allowed in (np.broadcast_to(1e-6 * largest, off.shape), np.where(np.abs(right) > 1e-6, 1e-3 * np.abs(right), np.inf)):
            bad = np.argwhere(off > allowed + 1e-12)
            if len(bad):
                i, j = max(bad.tolist(), key=lambda at: off[tuple(at)])
                self.fail(f"{what}: {len(bad)} entries are off, the worst [{i},{j}]: {found[i, j]:.9g}, right {right[i, j]:.9g}")

    def exact(self, plant, *values):
        """All four matrices; inputs and outputs in spans, so that rows are of one kind. The notes."""
        m, span = linearised(plant, *values), spans(plant)
        du, dy = (np.array([span[name] for name in m[key]]) for key in ("inputs", "outputs"))
        a, b, c, d = complex_step.PLANTS[plant].derivatives(m["x"], dict(zip(m["inputs"], m["u"])), m["inputs"], m["outputs"])
        where = " ".join((plant, *values))
        self.near(f"A at {where}", m["A"], a)
        self.near(f"B at {where}", m["B"] * du, b * du)
        self.near(f"C at {where}", m["C"] / dy[:, None], c / dy[:, None])
        self.near(f"D at {where}", m["D"] * du / dy[:, None], d * du / dy[:, None])
        return m["notes"]

    def test_the_pilot_at_its_nominal_state(self):
        self.assertEqual(self.exact("pilot"), [])

    def test_the_splitter_at_both_published_states(self):
        self.exact("splitter")
        self.exact("splitter", *SS2)

    def test_nothing_of_a_component_anywhere(self):
        self.exact("pilot", "xF=0")
        self.exact("splitter", "zC2=0")
        self.exact("splitter", "zC3=0", "zC2=0")

    def test_a_pure_feed(self):
        self.exact("pilot", "xF=100")
        self.exact("splitter", "znC4=1", "zC2=0", "zC3=0", "ziC4=0", "ziC5=0", "znC5=0")

    def test_a_product_pure_to_twelve_digits(self):
        self.exact("splitter", "R=120")

    def test_total_reflux(self):
        self.exact("pilot", "Lr=8")

    def test_no_reflux_and_no_bottoms(self):
        self.assertEqual(self.exact("pilot", "Lr=0"), ["Lr is at an end of its range; slopes are those upwards"])

    def test_spans_that_are_far_too_wide_do_no_harm(self):
        with open(os.path.join(ROOT, "host_sim", "plants", "pilot.json"), encoding="utf-8") as file:
            data = json.load(file)
        for channel in data["inputs"] + data["disturbances"]:
            if channel["name"] in ("Lr", "Qrb", "F", "Qloss"):
                channel["hi"] = 1e7
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "wide.json")
            with open(path, "w", encoding="utf-8") as file:
                json.dump(data, file)
            wide, right = linearised(path), linearised("pilot")
        self.near("B", wide["B"].T, right["B"].T)
        self.near("D", wide["D"].T, right["D"].T)

    def file_agrees(self, path):
        """A column's file against columns_reference.py at the simulator's nominal state, whose flows the levels count from."""
        m, tiny = linearised(path), columns_reference.STEP
        column = columns_reference.Column(path, nominal=False)
        u = dict(zip(m["inputs"], m["u"]))
        base = column.evaluate(m["x"], u, perfect=True)
        column.rest = {"distillate": base.distillate, "bottoms": base.bottoms, "reflux": base.reflux, "boilup": base.up[0],
                       "down": base.down, "up": base.up}
        n = len(m["x"])
        states = column.evaluate(m["x"] + 1j * tiny * np.eye(n), u, guess=np.repeat(base.t[None], n, axis=0))
        moved = [column.evaluate(m["x"] + 0j, u | {name: u[name] + 1j * tiny}, guess=base.t) for name in u]
        span = np.array([c["hi"] - c["lo"] for c in column.inputs])
        over = np.array([[1 / (spec["hi"] - spec["lo"])] for spec in column.outputs])
        # A logarithm of 1 less the sum of the other fractions is as right as that difference of doubles.
        seen = [i for i, spec in enumerate(column.outputs) if spec["is"] != "log_fraction" or m["y"][i] > -14]

        c = np.array([np.broadcast_to(np.imag(column.value(states, spec)), n) for spec in column.outputs]) / tiny
        d = np.array([[np.imag(column.value(f, spec)) for f in moved] for spec in column.outputs]) / tiny
        b = np.stack([np.imag(f.rates) / tiny for f in moved], axis=-1)
        self.near(f"A of {path}", m["A"], np.imag(states.rates).T / tiny)
        self.near(f"B of {path}", m["B"] * span, b * span)
        self.near(f"C of {path}", (m["C"] * over)[seen], (c * over)[seen])
        self.near(f"D of {path}", (m["D"] * span * over)[seen], (d * span * over)[seen])

    def test_columns_of_all_kinds(self):
        """Those whose constants are trimmed are left out: their values are known to the simulator alone."""
        folder, count = os.path.join(ROOT, "tests", "reference", "columns"), 0
        for name in sorted(os.listdir(folder)):
            path = os.path.join(folder, name)
            with open(path, encoding="utf-8") as file:
                data = json.load(file)
            channels = [c["name"] for c in data["inputs"]]
            if all(goal["trim"] in channels for goal in data.get("steady_state", [])):
                self.file_agrees(path)
                count += 1
        self.assertGreaterEqual(count, 15)

    def test_without_a_feed(self):
        self.assertEqual(linearised("splitter", "F=0")["notes"], ["F is at an end of its range; slopes are those upwards"])

    def test_other_inputs_at_their_ends(self):
        self.exact("splitter", "P=14", "dTr=0")
        self.exact("splitter", "Q=6000")

    def test_a_heater_that_just_makes_up_for_the_loss_has_a_slope_on_either_side_and_that_is_said(self):
        m = linearised("pilot", "Qrb=0.15")
        self.assertEqual(m["notes"], [f"{name}: the rate of state 1 has a kink here, so there is no derivative; slopes are "
                                      "those upwards" for name in ("Qrb", "Qloss")])
        u = dict(zip(m["inputs"], m["u"]))
        for name, right in (("Qrb", 0.15 + 1e-9), ("Qloss", 0.15 + 1e-9)):
            b = complex_step.PLANTS["pilot"].derivatives(m["x"], u | {name: right}, m["inputs"], m["outputs"])[1]
            at = m["inputs"].index(name)
            self.near("B", m["B"][:, at:at + 1], b[:, at:at + 1])
            self.assertEqual(name == "Qrb", bool(b[:, at].any()))

    def test_trays_without_liquid_draw_from_below_and_that_kink_is_said(self):
        notes = linearised("splitter", "R=0")["notes"]
        self.assertTrue(any("kink" in note for note in notes), notes)

    def test_gains_of_a_plant_that_is_differentiated_as_it_is_are_those_between_steady_states(self):
        running = ("vLr=37.5", "vD=40", "vB=39.6", "vF=50", "vCW=90")
        m = linearised("pilot-cold", "Qrb=0.823", *running)
        gain = m["D"] - m["C"] @ np.linalg.solve(m["A"], m["B"])
        h = 0.001
        below, above = (linearised("pilot-cold", f"Qrb={0.823 + sign * h}", *running)["y"] for sign in (-1, 1))
        for name in ("T1", "T10", "TB", "xD", "xB", "D", "LD"):
            at = m["outputs"].index(name)
            right = (above[at] - below[at]) / (2 * h)
            self.assertAlmostEqual(gain[at, m["inputs"].index("Qrb")] / right, 1, delta=2e-3, msg=name)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
