#!/usr/bin/python3
"""The settings that the firmware gives interacting loops, on the plants themselves.

Designs with libreflux.so on the first-order models of tests/reference/interact_plants.py, then closes the loops on the
plants as they are (second orders, zeros, state spaces, exact dead times; tests/reference/sampled_loops.py) and looks at
the eigenvalues. And: what the firmware says of stability, on random plants, against eigenvalues.

usage: test_detuned_loops.py LIBRARY
"""
import itertools
import json
import sys
import unittest
from pathlib import Path

import numpy as np
import scipy.optimize

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "reference"), str(HERE.parents[1] / "tools")]

from interact_plants import figures  # noqa: E402
from reflux import libreflux  # noqa: E402
from sampled_loops import Loop, fopdt_parts, plant_parts  # noqa: E402

RANDOM_SEED = 7
RANDOM_PLANTS = 150


def plants():
    """Every plant with a pairing that may be run at an interval of choice."""
    for q, g, L, T, pairs in figures():
        if pairs and q.j["model"] != "polynomial":
            yield q, libreflux.Plant(g, L, T), pairs, q.j["tick_s"]


class DetunedLoops(unittest.TestCase):
    def test_detuned_loops_are_stable_on_the_plants_themselves(self):
        for q, plant, pairs, h in plants():
            loops, said = libreflux.detune(plant, pairs, h)
            self.assertTrue(said["kept"], q.name)
            radius = [Loop(plant_parts(q, h), pairs, loops.gain * times, loops.ti, h).radius() for times in (1.0, 1.3)]
            print(f"{q.name:20s} F {said['factor']:5.2f}  log modulus {said['log_modulus_db']:5.2f} dB  "
                  f"largest eigenvalue {radius[0]:.6f}, gains times 1.3: {radius[1]:.6f}")
            self.assertLess(radius[0], 1.0, q.name)
            self.assertLess(radius[1], 1.0, q.name)

    def test_decoupled_loops_are_stable_on_the_plants_themselves(self):
        made = 0
        for q, plant, pairs, h in plants():
            try:
                d = libreflux.decoupler(plant, pairs)["d"]
            except libreflux.Refused:
                continue
            loops, said = libreflux.detune(plant, pairs, h, d)
            self.assertTrue(said["kept"], q.name)
            radius = [Loop(plant_parts(q, h), pairs, loops.gain * times, loops.ti, h, d).radius() for times in (1.0, 1.3)]
            print(f"{q.name:20s} with a decoupler: F {said['factor']:5.2f}  largest eigenvalue {radius[0]:.6f}, "
                  f"gains times 1.3: {radius[1]:.6f}")
            self.assertLess(max(radius), 1.0, q.name)
            made += 1
        self.assertGreaterEqual(made, 8)

    def test_loops_of_estimated_models_are_stable_on_the_plants_themselves(self):
        """Models wrong as an experiment with noise leaves them: gains by 3 %, dead times and lags by 3 % of their sum."""
        rng = np.random.default_rng(RANDOM_SEED)
        print("seed", RANDOM_SEED)
        for q, plant, pairs, h in plants():
            for _ in range(3):
                wrong = lambda a: a * (1.0 + 0.03 * rng.normal(size=a.shape))
                whole = plant.dead_time + plant.time_constant
                L = np.maximum(plant.dead_time + 0.03 * whole * rng.normal(size=whole.shape), 0.0)
                T = np.maximum(plant.time_constant + 0.03 * whole * rng.normal(size=whole.shape), 0.0)
                guess = libreflux.Plant(wrong(plant.gain), L, T)
                try:
                    loops, said = libreflux.detune(guess, pairs, h)
                except libreflux.Refused:  # no inverse: the pairing would not have been determined either
                    continue
                if not said["kept"]:
                    continue
                self.assertLess(Loop(plant_parts(q, h), pairs, loops.gain, loops.ti, h).radius(), 1.0, q.name)

    def test_what_is_said_of_stability_is_what_the_eigenvalues_say(self):
        rng = np.random.default_rng(RANDOM_SEED)
        print("seed", RANDOM_SEED)
        said_stable = said_unstable = 0
        for n in rng.integers(2, 5, size=RANDOM_PLANTS):
            g, T = rng.normal(size=(n, n)) + 1.5 * np.eye(n), rng.uniform(20.0, 100.0, size=(n, n))
            L = rng.uniform(0.0, 40.0, size=(n, n)) * rng.integers(0, 2, size=(n, n))
            gain = np.sign(np.diag(g)) * rng.uniform(0.1, 3.0, size=n)
            ti, pairs = rng.uniform(20.0, 150.0, size=n), [(k, k) for k in range(n)]
            radius = [Loop(fopdt_parts(g, L, T, 1.0), pairs, gain * x, ti, 1.0).radius() for x in (0.99, 1.0, 1.01)]
            if len({r < 1.0 for r in radius}) > 1:
                continue  # on the edge
            said = libreflux.nyquist(libreflux.Plant(g, L, T), libreflux.Loops(pairs, gain, ti, 1.0))
            self.assertEqual(said["stable"], radius[1] < 1.0, f"{g} {L} {T} {gain} {ti}")
            said_stable += said["stable"]
            said_unstable += not said["stable"]
        print(f"{said_stable} stable, {said_unstable} unstable")
        self.assertGreater(min(said_stable, said_unstable), 25)

    def test_a_trial_is_the_simulation_of_the_same_loops(self):
        for q, plant, pairs, h in plants():
            loops, _ = libreflux.detune(plant, pairs, h)
            t = libreflux.trial(plant, loops, 1, size=0.01, duration=400 * h)
            if t["sample"] != h:
                continue
            setpoint = np.zeros(len(pairs))
            setpoint[1] = 0.01
            y, _ = Loop(fopdt_parts(plant.gain, plant.dead_time, plant.time_constant, h), pairs, loops.gain, loops.ti,
                        h).simulate(400, setpoint)
            np.testing.assert_allclose(t["y"][:99], y[3:396:4][:, [a for a, _ in pairs]], atol=1e-12)


class ManyLoops(unittest.TestCase):
    """Demands of the limit of 6 dB on sixteen loops that act on each other a little, tests/loop/data/sixteen.json, and what
    Luyben's 2 dB a loop would: the largest singular value of the sensitivity (hold: half an interval)."""

    @staticmethod
    def sensitivity(plant: libreflux.Plant, loops: libreflux.Loops, h: float) -> float:
        pairs, largest = np.array(loops.pairs), 0.0
        g, L, T = (a[np.ix_(*pairs.T)] for a in (plant.gain, plant.dead_time, plant.time_constant))
        c = np.sign(np.diag(g)) * np.abs(loops.gain)
        for w in np.geomspace(1e-5, np.pi / h, 1500):
            held = g * np.exp(-1j * w * (L + h / 2)) / (1 + 1j * w * T)
            controller = np.diag(c * (1 + h / (loops.ti * (np.exp(1j * w * h) - 1))))
            largest = max(largest, np.linalg.norm(np.linalg.inv(np.eye(len(c)) + held @ controller), 2))
        return largest

    def test_six_db_slow_many_loops_more_than_their_distance_from_instability_wants(self):
        q, column, pairs, h = next(x for x in plants() if x[0].name == "wood-berry")
        loops, said = libreflux.detune(column, pairs, h)
        of_two = self.sensitivity(column, loops, h)
        print(f"wood-berry: F {said['factor']:.2f}, largest singular value of the sensitivity {of_two:.2f}")
        data = json.loads((HERE.parent / "loop" / "data" / "sixteen.json").read_text())
        of = lambda what: np.array([[what(e) for e in row] for row in data["elements"]])
        plant = libreflux.Plant(of(lambda e: e["gain"]), of(lambda e: e["dead_time"]), of(lambda e: e["lags"][0]))
        factor, distance = {}, {}
        for most in (6.0, 12.0, 24.0, 32.0):
            loops, said = libreflux.detune(plant, [(k, k) for k in range(16)], data["tick_s"], db_most=most)
            self.assertTrue(said["kept"])
            factor[most], distance[most] = said["factor"], self.sensitivity(plant, loops, data["tick_s"])
            print(f"sixteen, at most {most:g} dB: F {factor[most]:.2f}, {distance[most]:.2f}")
        self.assertGreater(factor[6.0], 10.0 * factor[32.0])
        self.assertLess(distance[32.0], of_two)


class Shell(unittest.TestCase):
    """The outputs that the row sums of the non-square relative gains keep, of the 35 choices of three out of seven."""

    def setUp(self):
        self.gain, self.pairs = next((g, pairs) for q, g, _, _, pairs in figures() if q.name == "shell-fractionator")

    def test_the_outputs_kept_have_the_largest_least_singular_value_of_all_choices(self):
        least = {c: np.linalg.svd(self.gain[list(c)], compute_uv=False)[-1] for c in itertools.combinations(range(7), 3)}
        self.assertEqual(max(least, key=least.get), tuple(sorted(a for a, _ in self.pairs)))
        self.assertEqual(len(least), 35)

    def test_assigning_on_the_non_square_array_would_choose_a_worse_square_plant(self):
        lam = libreflux.rga(libreflux.Plant(self.gain))
        cost = np.where(lam > 0.0, np.abs(np.log(np.maximum(lam, 1e-9))), 1e3)
        out, inp = scipy.optimize.linear_sum_assignment(cost)
        square = np.diag(libreflux.rga(libreflux.Plant(self.gain[np.ix_(out, inp)])))
        kept = libreflux.pairing(libreflux.Plant(self.gain))["lambda"]
        print("Shell: assigned on 7 x 3", [(f"y{a + 1}-u{b + 1}", round(lam[a, b], 2)) for a, b in zip(out, inp)],
              "relative gains of its square plant", square.round(2), "of the one kept", kept.round(2))
        self.assertGreater(np.abs(np.log(square)).sum(), 1.5 * np.abs(np.log(kept)).sum())


class Binding(unittest.TestCase):
    def test_every_function_gives_what_numpy_gives(self):
        for q, g, L, T, pairs in figures():
            if not pairs:
                continue
            plant = libreflux.Plant(g, L, T)
            np.testing.assert_allclose(libreflux.rga(plant), g * np.linalg.pinv(g).T, rtol=1e-9, atol=1e-9)
            w = np.array([1e-3, 1e-2]) / max(T.max(), 1.0)
            response = g * np.exp(-1j * w[1] * L) / (1 + 1j * w[1] * T)
            modulus, real = libreflux.rga_at(plant, w)
            np.testing.assert_allclose(modulus[1], np.abs(response * np.linalg.pinv(response).T), rtol=1e-8, atol=1e-8)
            np.testing.assert_allclose(real[1], (response * np.linalg.pinv(response).T).real, rtol=1e-8, atol=1e-8)
            found = libreflux.gains(plant)
            np.testing.assert_allclose(found["singular"], np.linalg.svd(g, compute_uv=False), rtol=1e-12)
            self.assertEqual(libreflux.pairing(plant)["pairs"], pairs)
            square = g[np.ix_([a for a, _ in pairs], [b for _, b in pairs])]
            lam = libreflux.measure(plant, pairs)["lambda"]
            np.testing.assert_allclose(lam, square * np.linalg.inv(square).T, rtol=1e-9, atol=1e-9)
            self.assertEqual(libreflux.structure(plant, pairs)["effect"].shape, g.shape)

    def test_a_refusal_says_what_was_wrong(self):
        plant = libreflux.Plant([[1.0, 0.5], [0.4, 1.0]], 1.0, 10.0)
        with self.assertRaisesRegex(libreflux.Refused, "confidence"):
            libreflux.pairing(plant, confidence=2.0)
        with self.assertRaisesRegex(libreflux.Refused, "inverse"):
            libreflux.rga(libreflux.Plant([[1.0, 2.0], [2.0, 4.0]]))
        with self.assertRaises(libreflux.Refused):
            libreflux.rga(libreflux.Plant([[np.nan]]))

    def test_cascades_are_named(self):
        plant = libreflux.Plant([[1.0], [0.5]], [[1.0], [5.0]], [[10.0], [200.0]])
        self.assertEqual([(c["inner"], c["outer"]) for c in libreflux.cascades(plant)], [(0, 1)])


if __name__ == "__main__":
    libreflux.load(sys.argv.pop(1))
    unittest.main(verbosity=2)
