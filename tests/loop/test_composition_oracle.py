#!/usr/bin/python3
"""Compares the firmware's estimates of the splitter, tick by tick, with a dense estimator in double precision that was written without
a look at it (tests/reference/composition_reference.py) and that gets the very readings the firmware had.

A tick has the temperatures and the feed of its own sample, but the applied outputs of the sample before, which are those of the time
between the two. At its very first tick the board knows no applied output yet: the model runs one tick without reflux and heat.

What single precision may cost: the logarithm of a vapour pressure is a sum of terms of up to 108 (isobutane), so each of about four
roundings is up to 4e-6 and the pressure is off by up to 1.5e-5 of itself; the slope of the logarithm being 0.024 1/K, bubble points
are off by up to 6e-4 K. Where a temperature draws the model, that is divided by the slope of the bubble point, 35 K and more for a
mole fraction: 1.8e-5. Rounding of the mole fractions themselves, 3e-8 a tick over some hundred ticks of memory at random, is ten
times less. So 2e-5 for whatever is integrated. The fraction that follows from the bubble point on truncated stages is a quotient by
the difference of two ratios of vapour to liquid, isobutane's and butane's, 0.2 at the least: 1.5e-5 / 0.2 at its own temperature,
and 6e-4 K times 0.024 1/K over 0.2 by that: 1.5e-4. Signals in fixed point add 7e-6 K, 1e-5 m3/h and 6e-8 of a mole fraction.
"""

import sys
import tempfile
import unittest
from dataclasses import dataclass, replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tools"), str(ROOT / "tests" / "reference")]

import composition_reference as reference  # noqa: E402
from reflux import column_slopes, runner  # noqa: E402
from research import trays  # noqa: E402
from reflux.logs import Log  # noqa: E402
from reflux.scenario import Event, Line  # noqa: E402
from research.trays import HOUR  # noqa: E402

import numpy as np  # noqa: E402

BOUND, BOUND_ALGEBRAIC = 2e-5, 1.5e-4
AUTO_S, FEED_S = 60.0, 120.0  # when the loop acts, and when the feed changes
TRUNCATED = "2-15,20-22"
FLOW, HEAT = f"{1 / 3600:.9g}", f"{4184e3 / 3600:.9g}"  # m3/s of a m3/h, W of a Mcal/h
ONE, THREE = ((30, 1),), ((30, 1), (31, 1), (33, 1))
FOUR = (*THREE, (5, 2))


@dataclass(frozen=True)
class Case:
    sensors: tuple = THREE  # stage, component
    state: str = "SS1"
    scenario: str = "SC1"
    components: str = "C3,iC4,nC4"
    truncated: str = ""
    between: str = "line"
    method: str = "geometric"
    tick_s: float = 10.0
    ticks: int = 120
    firmware: str = "memory"
    rates: tuple = (10.0, 20.0)  # lambda above and below the feed, 1/h
    damping: float = 3.0
    events: tuple = ()
    points: tuple = ((37, 2), (1, 1), (19, 1), (12, 1), (30, 1))

    def rate(self, stage: int) -> float:
        return self.rates[stage < trays.FEED_STAGE]

    def point_names(self) -> list[str]:
        return [f"x{stage}_{component}" for stage, component in self.points]


def table(case: Case) -> list[str]:
    command = ["--table", "--plant", "splitter", "--block", "2", "--components", case.components]
    for name, value in trays.STATES[case.state].items():
        command += ["--set", f"{name}={value}"]
    if case.truncated:
        command += ["--truncated", case.truncated]
    return [line for line in column_slopes.simulator(*command).splitlines() if line.startswith("set ")]


def configuration(case: Case, control: trays.Case, of: trays.Structure) -> list[str]:
    stages = sorted({s for p in of.pairings for s in p.stages} | {s for s, _ in case.sensors})
    rows = trays.channel_rows(stages, feed=True)
    channels = [("TFm", "K", 280, 345), *((name, "-", 0, 1) for name in case.point_names())]
    for k, (name, unit, lo, hi) in enumerate(channels, len(stages) + 2):
        rows += [f"set meas{k}.name {name}", f"set meas{k}.unit {unit}", f"set meas{k}.lo {lo}", f"set meas{k}.hi {hi}"]
    for k, pairing in enumerate(of.pairings, 1):
        rows += trays.loop_rows(k, control, pairing)
    rows += [*trays.block_rows(control, of, list(of.pairings)), *table(case)]
    inputs = [*(f"T{s}" for s, _ in case.sensors), "Fm", "TFm", "R", "Q"]
    n = len(case.sensors)
    rows += [
        "set block3.kind composition",
        "set block3.column 2",
        f"set block3.inputs {','.join(inputs)}",
        f"set block3.points {','.join(case.point_names())}",
        f"set block3.method {case.method}",
        "set block3.gate 0",
        "set block3.nis 0",
        f"set block3.between {case.between}",
        *(f"set block3.place.{k} {s},{c}" for k, (s, c) in enumerate(case.sensors, 1)),
        *(f"set block3.tune.{k} {case.rate(s):g},{case.damping:g}" for k, (s, _) in enumerate(case.sensors, 1)),
        *(f"set block3.point.{k} {s},{c}" for k, (s, c) in enumerate(case.points, 1)),
        f"set block3.is.{n + 1} feed",
        f"set block3.si.{n + 1} {FLOW},0",
        f"set block3.is.{n + 2} feed_temperature",
        f"set block3.is.{n + 3} reflux",
        f"set block3.si.{n + 3} {FLOW},0",
        f"set block3.is.{n + 4} heat",
        f"set block3.si.{n + 4} {HEAT},0",
        "apply",
    ]
    return rows


def run(case: Case) -> Log:
    """The temperature of stage 33 is controlled by the duty, and the feed swings."""
    control = trays.Case("sC[Q,33]", state=case.state, scenario=case.scenario, tick_s=case.tick_s)
    of = trays.structure(control.structure)
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        base = trays.scenario(control, Path(folder))
        played = replace(
            base,
            duration_s=case.ticks * case.tick_s,
            firmware=case.firmware,
            measure=(*trays.more_measured(s for s, _ in case.sensors), "Fm", "TFm"),
            lines=tuple(replace(line, at_s=min(line.at_s, AUTO_S)) for line in base.lines),
            events=(*(replace(e, at_s=min(e.at_s, FEED_S)) for e in base.events), *case.events),
            config=tuple(Line(0.0, row) for row in configuration(case, control, of)),
        )
        return runner.run(played, runner.Options(Path(folder) / "out", quiet=True)).log


def fresh(case: Case, step_s: float) -> reference.Estimator:
    sensors = [reference.Sensor(s - 1, c - 1, case.rate(s) / HOUR, case.damping) for s, c in case.sensors]
    settings = reference.Settings(case.method, between=case.between)
    return reference.Estimator(reference.Table(table(case)), sensors, step_s, settings)


def had(case: Case, log: Log) -> list[tuple[dict, list]]:
    """The firmware's data in every tick: inputs, and temperatures, NaN where there was no good reading."""

    def seen(name: str, factor: str = "1") -> np.ndarray:
        return np.array(log.numbers(f"fw.{name}")) * float(np.float32(factor))

    readings = [np.where(seen(f"T{s}.q") == 0, seen(f"T{s}"), np.nan) for s, _ in case.sensors]
    driven = {"feed": seen("Fm", FLOW), "feed_temperature": seen("TFm")}
    for what, name, factor in (("reflux", "R", FLOW), ("heat", "Q", HEAT)):
        driven[what] = np.concatenate([[np.nan], seen(f"{name}.app", factor)[:-1]])  # nothing before the first
    ticks = range(len(driven["feed"]))
    return [({what: values[k] for what, values in driven.items()}, [r[k] for r in readings]) for k in ticks]


def replay(case: Case, log: Log) -> np.ndarray:
    """The points of every tick, by the reference."""
    estimator, found = fresh(case, case.tick_s), []
    for inputs, temperatures in had(case, log):
        if np.isfinite(inputs["heat"]):
            estimator.step(inputs, temperatures)
        else:  # in the first tick nobody knows what was applied: no step
            estimator.look({})
        found.append([estimator.fraction(s - 1, c - 1) for s, c in case.points])
    return np.array(found)


class Oracle(unittest.TestCase):
    def agree(self, case: Case) -> np.ndarray:
        """Returns the reference's points."""
        log = run(case)
        theirs = np.array([log.numbers(f"fw.{name}") for name in case.point_names()]).T
        ours = replay(case, log)
        self.assertEqual(len(ours), case.ticks + 1)
        off = np.abs(theirs - ours).max(0)
        table_of = reference.Table(table(case))
        for (stage, component), name, worst in zip(case.points, case.point_names(), off):
            algebraic = table_of.truncated[stage - 1] and component == table_of.parts - 1
            self.assertLess(worst, BOUND_ALGEBRAIC if algebraic else BOUND, (case, name))
        self.assertGreater(np.ptp(ours, axis=0).max(), 0.01)  # it moves at all
        return ours

    def test_the_slopes_of_the_reference_are_those_of_complex_steps(self) -> None:
        estimator = reference.Estimator(reference.Table(table(Case())), [], 10.0)
        s = estimator.look({})
        column, each, m = estimator.column, estimator.efficiencies(s), estimator.free

        def rates(x: np.ndarray) -> np.ndarray:  # flows and holdups held
            full = np.concatenate([x, 1 - x.sum(-1, keepdims=True)], -1)
            t = column.mixture.bubble(full, s.pressure, np.broadcast_to(s.t, x.shape[:-1]))
            y = full * column.mixture.partial(full, t)
            v = y / y.sum(-1, keepdims=True)
            for i in range(1, column.n - 1):
                v[..., i, :] = v[..., i - 1, :] + each[i] * (v[..., i, :] - v[..., i - 1, :])
            v = v[..., :m]
            change = -s.up[:, None] * (v - x)
            change[..., 1:, :] += s.up[:-1, None] * (v[..., :-1, :] - x[..., 1:, :])
            change[..., :-1, :] += s.down[1:, None] * (x[..., 1:, :] - x[..., :-1, :])
            change[..., column.feed, :] += s.feed * (s.z[:m] - x[..., column.feed, :])
            return (change / s.moles[:, None]).reshape(x.shape[:-2] + (-1,))

        size = estimator.x.size
        moved = estimator.x + 1e-30j * np.eye(size).reshape(size, *estimator.x.shape)
        np.testing.assert_allclose(rates(estimator.x + 0j).real, s.rates, atol=1e-14)
        np.testing.assert_allclose(rates(moved).imag.T / 1e-30, estimator.jacobian(s), atol=1e-13)

    def test_one_three_and_four_sensors(self) -> None:
        for sensors in (ONE, THREE, FOUR):
            with self.subTest(sensors):
                self.agree(Case(sensors))

    def test_reduced_kalman_filter(self) -> None:
        self.agree(Case(FOUR, method="rekf"))

    def test_the_other_steady_state_in_fixed_point(self) -> None:
        for method in ("geometric", "rekf"):
            self.agree(Case(FOUR, "SS2", "SC2", method=method, firmware="host-fixed"))

    def test_truncated_stages(self) -> None:
        points = ((37, 2), (1, 1), (19, 1), (12, 1), (12, 2))
        for between in ("line", "mean"):
            with self.subTest(between):
                self.agree(Case(truncated=TRUNCATED, between=between, points=points))
        with self.subTest("at the other steady state, where fractions are kept within limits"):
            self.agree(
                Case(
                    THREE,
                    "SS2",
                    "SC2",
                    truncated=TRUNCATED,
                    between="mean",
                    method="rekf",
                    points=points,
                    firmware="host-fixed",
                )
            )

    def test_two_and_four_components(self) -> None:
        two, four = ((37, 1), (1, 1), (19, 1), (12, 1)), ((37, 2), (37, 3), (1, 2), (19, 2), (12, 3))
        by_propane = tuple((s, 2) for s, _ in THREE)
        for truncated in ("", TRUNCATED):
            with self.subTest(truncated=truncated):
                self.agree(Case(components="C3,nC4", points=two, truncated=truncated))
                self.agree(Case(by_propane, components="C2,C3,iC4,nC4", points=four, truncated=truncated))

    def test_a_sensor_that_is_missing_for_ten_minutes(self) -> None:
        for method in ("geometric", "rekf"):
            with self.subTest(method):
                events = (Event(200.0, "T31.quality", 3.0), Event(800.0, "T31.quality", 0.0))
                self.agree(Case(FOUR, method=method, events=events))

    def test_a_sensor_so_far_off_that_its_integral_is_limited(self) -> None:
        """And that fractions are kept within their limits."""
        events = (Event(300.0, "T31.bias", 45.0), Event(800.0, "T31.bias", 0.0))
        self.agree(Case(FOUR, rates=(40.0, 40.0), damping=0.5, events=events))

    def test_ticks_of_one_and_of_sixty_seconds(self) -> None:
        self.agree(Case(FOUR, tick_s=1.0, ticks=200))
        self.agree(Case(FOUR, tick_s=60.0, ticks=100))

    def test_the_steps_converge_to_the_estimator_in_continuous_time_in_proportion_to_the_tick(self) -> None:
        """Readings held for 30 s; the firmware's steps are those of the reference, which takes shorter ones as well. No fraction
        meets a limit here: in continuous time there is none."""
        case = Case(ONE, "SS2", "SC2", tick_s=30.0, ticks=20)
        readings = had(case, run(case))[1:]
        states: dict[float, list] = {0.0: [], 1.0: [], 10.0: [], 30.0: []}
        for step_s, found in states.items():
            estimator = fresh(case, step_s)
            for inputs, temperatures in readings:
                if step_s:
                    for _ in range(round(case.tick_s / step_s)):
                        estimator.step(inputs, temperatures)
                        self.assertEqual(estimator.clipped, 0)
                else:
                    estimator.integrate(inputs, temperatures, case.tick_s)
                found.append(estimator.x)
        off = {h: np.abs(np.array(found) - np.array(states[0.0])).max() for h, found in states.items() if h}
        print(*(f"tick {h:g} s: {worst:.1e} off;" for h, worst in off.items()), end=" ", file=sys.stderr)
        self.assertTrue(2 < off[30.0] / off[10.0] < 4, off)
        self.assertTrue(20 / 3 < off[10.0] / off[1.0] < 15, off)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
