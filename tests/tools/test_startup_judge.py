"""The judge of PI loops on linear plants, beside eigenvalues of the sampled loops and cases that are known by hand."""

import json
import random
import tempfile
import unittest
from pathlib import Path

import support  # noqa: F401 - finds the tools

import numpy as np

from research import known_plants, startup_plants
from research.startup_judge import PI, Judge, niederlinski, poles_outside
from research.startup_linear import Linear

from linear_reference import Plant  # found by known_plants
from sampled_loops import Loop, plant_parts

SEED = 35


def of(elements: list, tick_s: float = 1.0) -> Linear:
    return Linear(startup_plants.transfer("case", tick_s, elements))


class Steps(unittest.TestCase):
    def test_responses_are_those_of_the_reference_at_all_samples(self) -> None:
        for name in ("wood-berry", "furnace", "lime-kiln", "packed-bed"):
            with self.subTest(plant=name):
                data = json.loads((known_plants.PLANTS / f"{name}.json").read_text(encoding="utf-8"))
                plant, reference = Linear(data), known_plants.linear(name)
                spans = [[(u["hi"] - u["lo"]) / (y["hi"] - y["lo"]) for u in data["inputs"]] for y in data["outputs"]]
                found = plant.steps(400)
                for i, row in enumerate(reference.elements):
                    for j, e in enumerate(row[:len(data["inputs"])]):
                        for k in (0, 1, 7, 60, 399):
                            expected = (e.step(k * plant.h) if e else 0.0) * spans[i][j]
                            self.assertAlmostEqual(found[k, i, j], expected, delta=1e-9 * (1.0 + abs(expected)), msg=f"{i} {j} {k}")

    def test_the_residence_time_is_the_area_beside_the_step_response(self) -> None:
        for e in (startup_plants.lag(1.5, 60, 100, dead=35, zero=-50), startup_plants.damped(-0.7, 50, 0.3, dead=12),
                  startup_plants.two_scales(1.2, 40, 300, 0.6)):
            plant = of([[e]])
            steps = plant.steps(20000)[:, 0, 0]
            # Trapezia: half of the first sample too much.
            area = float(np.sum(1.0 - steps / plant.gains()[0, 0])) - 0.5
            self.assertAlmostEqual(plant.residences()[0, 0], area, delta=0.3)

    def test_an_integrator_climbs_by_its_rate(self) -> None:
        steps = of([[startup_plants.integrator(0.002, dead=10)]]).steps(111)[:, 0, 0]
        self.assertAlmostEqual(steps[110], 0.2, places=9)
        self.assertAlmostEqual(steps[10], 0.0, places=9)


class Known(unittest.TestCase):
    def test_a_proportional_loop_on_an_integrator(self) -> None:
        """The pole is at 1 - K k h: the margin is 2 / (K k h), and the sensitivity is largest at half the sampling frequency."""
        judge = Judge(of([[startup_plants.integrator(0.5)]]))
        for kc in (0.2, 1.0, 3.0):
            v = judge.judge([PI(0, 0, kc, 0.0)])
            self.assertTrue(v.stable)
            self.assertAlmostEqual(v.gain_margin, 2.0 / (0.5 * kc), places=6)
            self.assertAlmostEqual(v.ms, 1.0 / (1.0 - 0.25 * kc), places=6)
        self.assertFalse(judge.judge([PI(0, 0, 4.1, 0.0)]).stable)
        self.assertFalse(judge.judge([PI(0, 0, -0.1, 0.0)]).stable)

    def test_what_runs_away_is_stable_with_enough_gain_only(self) -> None:
        plant = Linear(startup_plants.states("away", 1.0, [[0.01]], [[0.01]], [[1.0]]))
        self.assertEqual(plant.unstable_poles(), 1)
        self.assertEqual(poles_outside(plant, [PI(0, 0, 0.5, 0.0)]), 1)
        self.assertEqual(poles_outside(plant, [PI(0, 0, 1.5, 0.0)]), 0)
        # From 1 upwards it is stable: the margin counts downwards, too.
        self.assertAlmostEqual(Judge(plant).judge([PI(0, 0, 1.5, 0.0)]).gain_margin, 1.5, delta=0.02)

    def test_integral_action_with_the_wrong_pairs_is_not_stable(self) -> None:
        case = startup_plants.case("wrong-diagonal-10")
        plant = case.linear()
        loops = [PI(0, 0, 0.02, 200.0), PI(1, 1, 0.02, 200.0)]
        self.assertLess(niederlinski(plant.gains(), loops), 0.0)
        self.assertFalse(Judge(plant).judge(loops).stable)
        right = [PI(0, 1, 0.1, 600.0), PI(1, 0, 0.1, 600.0)]
        self.assertGreater(niederlinski(plant.gains(), right), 0.0)
        self.assertTrue(Judge(plant).judge(right).stable)

    def test_a_valve_whose_gain_doubles_takes_half_of_the_margin(self) -> None:
        case = startup_plants.case("gain-doubles")
        loops = [PI(0, 0, 1.0, 150.0)]
        before, after = (Judge(case.linear(1, t)).judge(loops).gain_margin for t in (0.0, 1e9))
        self.assertAlmostEqual(before / after, 2.0, delta=0.02)


class Eigenvalues(unittest.TestCase):
    """The judge counts turns of a determinant; the reference takes the eigenvalues of one large matrix."""

    def radius(self, data: dict, loops: list[PI], decoupler: np.ndarray | None = None) -> float:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "plant.json"
            path.write_text(json.dumps(data), encoding="utf-8")
            q = Plant(path)
        return Loop(plant_parts(q, data["tick_s"]), [(c.output, c.input) for c in loops], [c.kc for c in loops], [c.ti_s for c in loops],
                    data["tick_s"], decoupler).radius()

    def test_it_agrees_with_eigenvalues_on_random_loops(self) -> None:
        print(f"seed {SEED}")
        chance, seen = random.Random(SEED), {True: 0, False: 0}
        data_of = [startup_plants.case(name).data for name in ("plain", "damping-015", "inverse", "gain-20", "dead-time", "two-scales", "recycle",
                                                             "unstable", "random-1", "random-12")]
        for data in data_of:
            plant = Linear(data)
            judge, n = Judge(plant), plant.shape[0]
            for _ in range(6):
                columns = list(range(n))
                chance.shuffle(columns)
                gains = plant.gains()
                loops = [PI(i, j, 10 ** chance.uniform(-2.0, 0.3) / (gains[i, j] or 1.0), 10 ** chance.uniform(1.0, 2.8))
                         for i, j in zip(range(n), columns)]
                d = np.eye(n) + np.array([[0.0 if i == j else chance.uniform(-0.4, 0.4) for j in range(n)] for i in range(n)])
                decoupler = d if chance.random() < 0.3 else None
                radius = self.radius(data, loops, decoupler)
                if abs(radius - 1.0) < 1e-7:
                    continue
                stable = judge.judge(loops, decoupler).stable
                self.assertEqual(stable, radius < 1.0, f"{data['name']} {loops} {decoupler} {radius}")
                seen[stable] += 1
        print(f"stable {seen[True]}, unstable {seen[False]}")
        self.assertGreater(min(seen.values()), 8)

    def test_the_margin_is_where_eigenvalues_reach_the_circle(self) -> None:
        data = startup_plants.case("plain").data
        loops = [PI(0, 0, 1.5, 120.0), PI(1, 1, 1.0, 120.0)]
        margins = []
        for k in range(2):
            low, high = 1.0, 50.0
            for _ in range(30):
                middle = (low * high) ** 0.5
                changed = [PI(c.output, c.input, c.kc * (middle if n == k else 1.0), c.ti_s) for n, c in enumerate(loops)]
                low, high = (middle, high) if self.radius(data, changed) < 1.0 else (low, middle)
            margins.append(low)
        self.assertAlmostEqual(Judge(Linear(data)).judge(loops).gain_margin, min(margins), delta=0.01 * min(margins))


if __name__ == "__main__":
    unittest.main()
