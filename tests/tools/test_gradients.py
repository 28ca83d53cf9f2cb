"""tools/gradients: shares against an independent derivative of the bubble point, the source's claims, rules on made-up profiles, profiles of
one's own with their refusals, columns of other classes."""

import json
import math
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

from support import ROOT, FolderTest, board, call, told

from reflux import build, estimate_lines, gradients, plant_file, sensor_rules
from reflux.errors import UserError
from reflux.gradients import Diagram
from reflux.sensor_rules import Steps, Thresholds

PLANTS = ROOT / "host_sim" / "plants"
HEXANES = str(ROOT / "tests" / "tools" / "data" / "hexanes.json")
SS2 = ("--set", "R=32.2787", "--set", "Q=2804.458")


def report(*arguments: str) -> dict:
    status, out, err = call("gradients", *arguments, "--format", "json")
    assert status == 0, err
    return json.loads(out)


def splitter_constants() -> dict[str, list[float]]:
    return gradients.constants_of(json.loads((PLANTS / "splitter.json").read_text(encoding="utf-8")))


def bubble_point(x: list[float], constants: list[list[float]], pressure: float) -> float:
    """By bisection, so that no derivative is used. x need not add up to 1."""
    low, high = 220.0, 440.0
    for _ in range(80):
        t = (low + high) / 2
        above = sum(xj * gradients.vapour_pressure(c, t)[0] for xj, c in zip(x, constants)) > pressure
        low, high = (low, t) if above else (t, high)
    return low


class Shares(unittest.TestCase):
    def test_shares_are_the_bubble_points_derivative_by_one_fraction_alone_times_its_step(self) -> None:
        constants = list(splitter_constants().values())
        x = [
            [0.01, 0.3, 0.25, 0.02, 0.01, 0.41],
            [0.02, 0.38, 0.22, 0.01, 0.005, 0.365],
            [0.02, 0.4, 0.22, 0.01, 0.005, 0.345],
        ]
        t = 340.0
        pressure = sum(xj * gradients.vapour_pressure(c, t)[0] for xj, c in zip(x[0], constants))
        of = gradients.diagram([t, t - 3, t - 4], x, list("abcdef"), gradients.Liquid(constants))
        for j in range(6):
            moved = [[xk + (d if k == j else 0.0) for k, xk in enumerate(x[0])] for d in (1e-4, -1e-4)]
            slope = (bubble_point(moved[0], constants, pressure) - bubble_point(moved[1], constants, pressure)) / 2e-4
            self.assertAlmostEqual(of.share[0][j], slope * (x[1][j] - x[0][j]), delta=1e-5 + 1e-5 * abs(of.share[0][j]))

    def test_the_derivative_of_the_vapour_pressure_is_its_slope(self) -> None:
        for c in splitter_constants().values():
            both = [gradients.vapour_pressure(c, t)[0] for t in (349.99, 350.01)]
            self.assertAlmostEqual(
                gradients.vapour_pressure(c, 350.0)[1] / ((both[1] - both[0]) / 0.02), 1.0, delta=1e-6
            )

    def test_relative_volatilities_count_as_vapour_pressures_of_one_reference(self) -> None:
        known = gradients.constants_of(
            {
                "reference_vapour_pressure": [10, 2000, 0],
                "components": [{"name": "a", "relative_volatility": 3}, {"name": "b", "relative_volatility": 1}],
            }
        )
        p = [gradients.vapour_pressure(known[n], 350.0)[0] for n in "ab"]
        self.assertAlmostEqual(p[0] / p[1], 3.0)


class Activity(unittest.TestCase):
    def test_the_simulators_temperatures_are_bubble_points_of_the_same_liquid(self) -> None:
        """Columns of methanol and water (NRTL), and with Wilson's equation in its place."""
        from reflux import column_slopes

        plant = json.loads((PLANTS / "methanol-water.json").read_text(encoding="utf-8"))
        wilson = {**plant, "name": "wilson", "steady_state": [], "activity": {"model": "wilson", "a": [[0, -0.6], [-0.05, 0]], "b": [[0, 30], [-20, 0]]}}
        with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
            file.write(json.dumps(wilson))
            file.flush()
            for column, name in ((plant, "methanol-water"), (wilson, file.name)):
                at = column_slopes.steady(name)
                liquid = gradients.liquid_of(column, at.names)
                for s, (t, x) in enumerate(zip(at.temperature, at.x)):
                    pressure = 101325 + column["pressure_drop"] * (at.stages - 1 - s) / (at.stages - 1)
                    self.assertAlmostEqual(liquid.pressure(x, t) / pressure, 1.0, delta=1e-6)

    def test_coefficients_that_are_one_leave_the_shares_as_they_are(self) -> None:
        constants = list(splitter_constants().values())[:2]
        ideal, x = gradients.Liquid(constants), [0.3, 0.7]
        zero = [[0.0, 0.0], [0.0, 0.0]]
        for activity in ({"model": "wilson", "a": zero}, {"model": "nrtl", "a": zero, "alpha": zero}):
            for a, b in zip(ideal.slopes(x, 320.0), gradients.Liquid(constants, activity).slopes(x, 320.0)):
                self.assertAlmostEqual(a / b, 1.0, delta=1e-4)

    def test_components_in_another_order_have_their_own_coefficients(self) -> None:
        plant = json.loads((PLANTS / "methanol-water.json").read_text(encoding="utf-8"))
        one, other = (gradients.liquid_of(plant, names).slopes(x, 350.0) for names, x in
                      ((("methanol", "water"), (0.2, 0.8)), (("water", "methanol"), (0.8, 0.2))))
        for a, b in zip(one, reversed(other)):
            self.assertAlmostEqual(a, b, delta=1e-6)


class Source(unittest.TestCase):
    """Statements of Frau about her diagrams (sections 3.4 and 5.1 of the thesis)."""

    @classmethod
    def setUpClass(cls) -> None:
        cls.ss1, cls.ss2 = report("splitter", "--no-steps"), report("splitter", *SS2, "--no-steps")

    def test_the_steepest_stages_are_near_thirty_and_near_five(self) -> None:
        for found, first, last, near in ((self.ss1, 20, 35, 30), (self.ss2, 20, 35, 30), (self.ss2, 2, 17, 5)):
            stage = min((s for s in found["stages"] if first <= s["stage"] <= last), key=lambda s: s["gradient"])[
                "stage"
            ]
            self.assertLessEqual(abs(stage - near), 2)

    def test_the_shares_add_up_to_the_gradient_within_a_fifth_of_a_kelvin(self) -> None:
        for found in (self.ss1, self.ss2):
            for s in found["stages"][:-1]:
                self.assertLess(abs(sum(s["shares"].values()) - s["gradient"]), 0.2)

    def test_propane_pulls_with_the_gradient_and_butane_against_it_and_ethane_counts_at_the_top_only(self) -> None:
        for s in self.ss1["stages"][25:33]:
            self.assertLess(s["shares"]["C3"], 0)
            self.assertGreater(s["shares"]["nC4"], 0)
        ethane = [abs(s["shares"]["C2"]) for s in self.ss1["stages"][:-1]]
        self.assertGreater(min(ethane[34:]), 3 * max(ethane[20:33]))

    def test_candidates_at_the_first_state_are_hers_and_rule_a_chooses_what_she_chose(self) -> None:
        enriching = self.ss1["control"][0]
        self.assertEqual(enriching["candidates"], list(range(26, 34)))
        self.assertEqual(enriching["by_keys"], 33)
        self.assertEqual(enriching["near_feed"], 23)

    def test_at_the_second_state_rule_a_has_her_enriching_stage_and_rule_b_her_stripping_one(self) -> None:
        enriching, stripping = self.ss2["control"]
        self.assertEqual(enriching["by_keys"], 33)
        self.assertLessEqual(abs(stripping["by_product"] - 5), 1)
        self.assertIn("disagree", stripping["reason"])

    def test_three_components_are_modelled_and_propane_is_innovated(self) -> None:
        for found in (self.ss1, self.ss2):
            self.assertEqual(sorted(found["estimation"]["modelled"]), ["C3", "iC4", "nC4"])
            self.assertEqual(set(found["estimation"]["innovated"].values()), {"C3"})
            for first, last in found["estimation"]["averaged"]:
                self.assertFalse(first <= 19 <= last)

    def test_keys_are_propane_and_isobutane(self) -> None:
        self.assertEqual(self.ss1["keys"], ["C3", "iC4"])


class Rules(unittest.TestCase):
    def test_a_flat_section_gets_no_stage(self) -> None:
        of = Diagram([-0.01] * 20, [[-0.01, 0.0]] * 20, ["a", "b"])
        choice = sensor_rules.choose(of, 10, "enriching", ("a", "b"), Thresholds())
        self.assertIsNone(choice.by_product)
        self.assertIn("I do not know", choice.reason)

    def test_a_section_without_room_gets_no_stage(self) -> None:
        of = Diagram([-5.0] * 20, [[-5.0, 0.0]] * 20, ["a", "b"])
        self.assertIn("I do not know", sensor_rules.choose(of, 3, "stripping", ("a", "b"), Thresholds()).reason)

    def test_regions_of_one_temperature_end_at_the_feed(self) -> None:
        of = Diagram([0.0] * 20, [], ["a", "b"])
        self.assertEqual(sensor_rules.even_regions(of, 10, 0.1, 3), ((1, 9), (11, 21)))

    def test_without_a_pair_of_which_one_goes_up_and_the_other_down_there_are_no_keys(self) -> None:
        self.assertIsNone(sensor_rules.keys_of([0.5, 0.3, 0.2], [0.5, 0.3, 0.2], list("abc"), [1, 2, 3]))
        self.assertEqual(sensor_rules.keys_of([0.2, 0.7, 0.1], [0.0, 0.2, 0.8], list("cba"), [1, 2, 3]), ("b", "a"))

    def test_steps_that_move_one_way_only_choose_nothing(self) -> None:
        self.assertIsNone(Steps("u", [1.0, 2.0], [1.0, 2.0]).best())
        self.assertEqual(Steps("u", [1.0, 2.0, 2.5], [-1.0, -2.0, -0.5]).best(), 2)

    def test_singular_vectors_choose_the_stages_that_see_each_direction(self) -> None:
        steps = [Steps("a", [1.0, 0.1, 0.0], [-1.0, -0.1, 0.0]), Steps("b", [0.0, 0.0, 0.5], [0.0, 0.0, -0.5])]
        stages, values = sensor_rules.singular(steps)
        self.assertEqual(stages, [1, 3])
        self.assertAlmostEqual(values[1], 0.5)
        self.assertAlmostEqual(sensor_rules.condition(steps, [1, 3]), 2.0)


class OwnProfile(FolderTest):
    def csv(self, change: object = None, kelvin: bool = True) -> str:
        lines = [f"stage,T[{'K' if kelvin else 'degC'}],x.C3,x.nC4"]
        rows = [[s, 380.0 - 5 * s - (0 if kelvin else 273.15), 0.05 * s, 1 - 0.05 * s] for s in range(1, 13)]
        if callable(change):
            change(lines, rows)
        return str(self.file("own.csv", "\n".join(lines + [",".join(str(v) for v in row) for row in rows]) + "\n"))

    def gradients(self, path: str, *more: str) -> tuple[int, str, str]:
        return call("gradients", *more, "--profile", path, "--feed", "6", "--out", str(self.folder / "own.png"))

    def test_the_simulators_own_profile_as_a_file_gives_the_same(self) -> None:
        found = report("splitter", "--no-steps", "--out", str(self.folder / "a.png"))
        from reflux import column_slopes

        at = column_slopes.steady("splitter")
        head = ",".join(["stage", "T[degC]", *(f"x.{n}" for n in at.names)])
        rows = [",".join(repr(v) for v in (s, t - 273.15, *x)) for s, (t, x) in enumerate(zip(at.temperature, at.x), 1)]
        path = self.file("own.csv", "\n".join([head, *rows]))
        own = report("splitter", "--profile", str(path), "--out", str(self.folder / "b.png"))
        for a, b in zip(found["control"], own["control"]):
            self.assertEqual(
                {k: v for k, v in a.items() if k != "reason"}, {k: v for k, v in b.items() if k != "reason"}
            )
        self.assertAlmostEqual(found["stages"][29]["shares"]["C3"], own["stages"][29]["shares"]["C3"], places=6)

    def test_without_a_column_k_values_do_and_without_both_only_the_gradient_counts(self) -> None:
        def with_k(lines: list, rows: list) -> None:
            lines[0] += ",K.C3,K.nC4"
            for row in rows:
                row += [3.0 * math.exp(0.02 * (row[1] - 350)), math.exp(0.02 * (row[1] - 350))]

        status, out, err = self.gradients(self.csv(with_k))
        self.assertEqual(status, 0, err)
        self.assertIn("keys C3 and nC4", out)
        status, out, err = self.gradients(self.csv())
        self.assertEqual(status, 0, err)
        self.assertIn("I do not know what each component has to do", out)

    def test_what_is_wrong_with_a_file_is_said(self) -> None:
        def column(lines: list, rows: list) -> None:
            lines[0] = lines[0].replace("T[K]", "T")

        def nan(lines: list, rows: list) -> None:
            rows[4][1] = math.nan

        def order(lines: list, rows: list) -> None:
            rows[0][0], rows[1][0] = 2, 1

        def total(lines: list, rows: list) -> None:
            rows[3][2] += 0.05

        def one_k(lines: list, rows: list) -> None:
            lines[0] += ",K.C3"
            for row in rows:
                row.append(2.0)

        def short(lines: list, rows: list) -> None:
            del rows[3:]

        for change, words in (
            (column, "needs columns stage, T[K] or T[degC]"),
            (nan, "stage 5, T[K]"),
            (order, "stages are 1 (the reboiler)"),
            (total, "add up to 1"),
            (one_k, "K.NAME of every component"),
            (short, "has 3 stages"),
        ):
            with self.subTest(words):
                status, _, err = self.gradients(self.csv(change))
                self.assertEqual(status, 2, err)
                self.assertIn(words, err)

    def test_a_component_that_the_column_does_not_have_is_named(self) -> None:
        def rename(lines: list, rows: list) -> None:
            lines[0] = lines[0].replace("x.nC4", "x.nC9")

        status, _, err = self.gradients(self.csv(rename), "splitter")
        self.assertEqual(status, 2)
        self.assertIn("nC9: no component of splitter", err)

    def test_a_profile_without_a_feed_stage_asks_for_it(self) -> None:
        status, _, err = call("gradients", "--profile", self.csv())
        self.assertEqual(status, 2)
        self.assertIn("--feed", err)


class OtherColumns(FolderTest):
    def test_columns_of_other_classes_are_drawn_and_what_is_not_known_is_said(self) -> None:
        for name, words in (
            ("pilot", "All components are keys"),
            ("methanol-water", "sensors on stages 3 to 6, 10 to 16"),
            ("c3-splitter", "I do not know"),
            ("column-a", "All components are keys"),
        ):
            with self.subTest(name):
                picture = self.folder / f"{name}.png"
                status, out, err = call("gradients", name, "--out", str(picture))
                self.assertEqual(status, 0, err)
                self.assertIn(words, out)
                self.assertGreater(picture.stat().st_size, 10000)

    def test_lines_for_the_console_are_the_rows_of_the_kind(self) -> None:
        lines = report("splitter", "--no-steps", "--loop", "Q:33,34", "--out", str(self.folder / "a.png"))["lines"]
        self.assertIn("set block1.stage.1 33,34", lines)
        self.assertTrue(any(line.startswith("set block1.gradient.1 -2.0") for line in lines))

    def test_nonsense_is_refused(self) -> None:
        for arguments, words in (
            (("wood-berry",), "is not a column"),
            ((), "names no column"),
            (("splitter", "--loop", "Q33"), "must be MV:STAGE"),
            (("splitter", "--loop", "F:33"), "is not a reflux, heat or boil-up"),
            (("splitter", "--loop", "Q:37"), "has no stage above"),
            (("splitter", "--keys", "C3,C9"), "not a component"),
            (("splitter", "--set", "Q"), "NAME=NUMBER"),
            (("splitter", "--step", "2"), "below 0.5"),
        ):
            with self.subTest(arguments):
                status, _, err = call(
                    "gradients",
                    *arguments,
                    *(("--no-steps",) if arguments and "--step" not in arguments else ()),
                    "--out",
                    str(self.folder / "x.png"),
                )
                self.assertEqual(status, 2, err)
                self.assertIn(words, err)

    def test_thresholds_are_options(self) -> None:
        found = report("splitter", "--no-steps", "--half", "0.9", "--out", str(self.folder / "a.png"))
        self.assertLess(len(found["control"][0]["candidates"]), 5)


class Trimmed(FolderTest):
    """A column whose file names products and leaves its inputs to be found; the file's own numbers of them are far off."""

    def report(self, *arguments: str) -> dict:
        return report(HEXANES, *arguments, "--out", str(self.folder / "a.png"))

    def test_steps_of_an_input_begin_where_the_column_rests(self) -> None:
        steps = {s["input"]: s for s in self.report()["steps"]}
        for name in ("FC101", "QC102"):
            self.assertIsNotNone(steps[name]["best"])
            self.assertLess(steps[name]["asymmetry"], 0.2)

    def test_the_flow_of_a_loop_is_that_of_the_steady_state(self) -> None:
        from reflux import column_slopes, simulator

        rest = simulator.at_rest(HEXANES)
        self.assertAlmostEqual(rest["xD"], 1.0, delta=1e-3)
        lines = self.report("--no-steps", "--loop", "QC102:8", "--loop", "FC101:19")["lines"]
        for k, moves, mv in ((1, "heat", "QC102"), (2, "reflux", "FC101")):
            value = next(float(line.split()[-1]) for line in lines if line.startswith(f"set block1.flow.{k} "))
            self.assertAlmostEqual(value / column_slopes.steady(HEXANES).flow(moves, rest[mv]), 1.0, delta=1e-5)


class Slopes(unittest.TestCase):
    def test_the_consistent_slope_is_how_a_tray_begins_to_move_after_a_step_to_a_third(self) -> None:
        """It leaves out what the subcooled reflux condenses and what the trays beside it do meanwhile; the printed one is six times as much."""
        from research import trays

        for state, mv, stage in (("SS1", "Q", 33), ("SS1", "R", 33), ("SS2", "Q", 5), ("SS2", "R", 33)):
            with self.subTest(state, mv=mv, stage=stage):
                began = trays.step_slope(stage, mv, state)
                self.assertLess(abs(trays.slope(stage, mv, state, "consistent") / began - 1), 1 / 3)

    def test_a_stage_without_one_above_has_no_gradient(self) -> None:
        from research import trays

        with self.assertRaisesRegex(UserError, "no stage above"):
            trays.steady("SS1").slope(37, "heat", 4143.0)


def channels(plant: dict) -> list[str]:
    """Settings of a board whose channels are those of the plant."""
    out = ["set tick.base 10"]
    for kind, those in (("meas", plant["outputs"]), ("mv", plant["inputs"])):
        for k, c in enumerate(those, 1):
            out += [f"set {kind}{k}.{field} {c[key]}" for field, key in (("name", "name"), ("unit", "unit"), ("lo", "lo"), ("hi", "hi"))]
    return out


class Lines(unittest.TestCase):
    """Console lines of an estimator, docs/methods/composition-estimation.md."""

    def test_three_thermometers_in_the_section_of_the_product(self) -> None:
        _, out, _ = call("gradients", "splitter", "--no-steps", "--estimate", "iC4:37")
        for line in (
            "--components C3,iC4,nC4 --block 1",
            "set block2.inputs T30,T31,T33,R,Q,Fm,TFm",
            "set block2.place.1 30,1",
            "set block2.place.3 33,1",
            "set block2.is.4 reflux",
            "set block2.si.4 0.000277777778,0",
            "set block2.point.1 37,2",
        ):
            self.assertIn(line, out)

    def run_on_a_board(self, column: str, *arguments: str) -> dict[str, str]:
        """Settings of the board after the lines for this column: `block2.inputs` and `block2.points`."""
        build.build("host", ("reflux-sim", "reflux-host"), quiet=True)
        status, out, err = call("gradients", column, "--no-steps", *arguments, "--out", os.devnull)
        self.assertEqual(status, 0, err)
        command, *lines = (line.strip() for line in out.split("between begin and apply:\n")[1].split("\n\n")[0].splitlines())
        table = subprocess.run(command.removeprefix("# "), shell=True, cwd=ROOT, capture_output=True, text=True, check=True).stdout
        settings = [line for line in (*table.splitlines(), *lines) if line.startswith("set ")]
        with board(str(build.find_program("host", "reflux-host")), [*channels(plant_file.load(column)[0]), *settings]) as console:
            return dict(told(console, f"get block2.{name}")[0].split(" = ") for name in ("inputs", "points"))

    def test_lines_for_a_column_of_ones_own_run_as_they_are_printed(self) -> None:
        there = self.run_on_a_board(str(ROOT / "tests" / "tools" / "data" / "bt25.json"), "--estimate", "benzene:25")
        self.assertEqual(there["block2.points"], "est_benzene_25")
        self.assertIn("T17,T20,", there["block2.inputs"])  # those that the column has

    def test_a_liquid_with_activity_coefficients_has_lines_too(self) -> None:
        there = self.run_on_a_board("methanol-water", "--estimate", "methanol:1", "--estimate", "water:32")
        self.assertEqual(there["block2.points"], "est_methanol_1,est_water_32")

    def thermometers(self, column: str, *arguments: str) -> list[int]:
        _, out, err = call("gradients", column, "--no-steps", *arguments, "--out", os.devnull)
        return [int(stage) for stage in re.findall(r"set block2\.place\.\d+ (\d+),[1-9]", out)]

    def test_each_point_has_a_thermometer_in_its_section(self) -> None:
        """Also where no stage of it is free of what is not modelled: the clearest ones do, and a remark says it."""
        for column, feed, *arguments in (
            ("splitter", 19, *SS2, "--estimate", "iC4:37", "--estimate", "C3:1", "--alien", "0.002"),
            (HEXANES, 13, "--estimate", "hexane:1", "--estimate", "heptane:28"),
            ("methanol-water", 9, "--estimate", "water:32", "--estimate", "methanol:1"),
        ):
            with self.subTest(column):
                stages = self.thermometers(column, *arguments)
                self.assertTrue(min(stages) <= feed < max(stages), stages)

    def test_a_section_with_fewer_thermometers_than_components_gets_help_from_the_other(self) -> None:
        self.assertEqual(self.thermometers(HEXANES, "--estimate", "heptane:28"), [5, 8, 19, 22])  # three components, two thermometers
        self.assertGreater(min(self.thermometers("splitter", "--estimate", "iC4:37")), 19)  # three of each

    def test_of_the_thermometers_that_are_there_a_section_gets_two_if_it_can(self) -> None:
        """Less steep ones too; an end only where there is no other, and the feed stage never."""
        of = Diagram([-2.0, -1.0, -4.0, -1.0, -1.0, -1.0, -2.0, -0.1, -0.1, -0.1, -0.1], [[-1.0, 0.0]] * 11, ["a", "b"])
        for there, wanted in (((1, 3, 5), [3, 5]), ((1, 3), [1, 3]), ((3, 6), [3]), ((2,), [2])):
            seen = tuple({"name": f"T{s}", "is": "temperature", "stage": s, "unit": "K"} for s in there)
            column = estimate_lines.Column("", (), {"feed_stage": 6}, of, Thresholds(), seen, installed_only=True)
            self.assertEqual(estimate_lines.usable(column, False, ["a", "b"]), wanted)

    def test_the_table_is_made_at_the_state_of_the_diagram(self) -> None:
        _, out, _ = call("gradients", "splitter", *SS2, "--no-steps", "--estimate", "iC4:37", "--out", os.devnull)
        self.assertIn("--set R=32.2787 --set Q=2804.458 --block 1", out)

    def test_a_reflux_that_a_level_moves_must_be_measured(self) -> None:
        plant = json.loads(Path(HEXANES).read_text(encoding="utf-8"))
        plant["levels"] = {"condenser": {"by": "reflux", "gain": 0.01}, "reboiler": {"by": "bottoms", "gain": 0.01}}
        plant["constants"]["reflux"] = {"value": 5, "unit": "t/h"}
        plant["inputs"][0] = {"name": "D", "is": "distillate", "unit": "t/h", "lo": 0, "hi": 10}
        plant["steady_state"][0]["trim"] = "reflux"
        for unit, words in ((None, "the level of the condenser moves the reflux"), ("kmol/h", "FIR: the file has its reflux as a flow of mass"), ("t/h", "")):
            measured = [{"name": "FIR", "is": "reflux", "unit": unit, "lo": 0, "hi": 200}] if unit else []
            with self.subTest(unit), tempfile.NamedTemporaryFile("w", suffix=".json") as file:
                file.write(json.dumps(plant | {"outputs": [*plant["outputs"], *measured]}))
                file.flush()
                status, out, err = call("gradients", file.name, "--no-steps", "--estimate", "heptane:28", "--out", os.devnull)
                self.assertEqual(status, 2 if words else 0)
                self.assertIn(words or ",QC102,FI1,TIF,FIR", err or out)

    def test_a_long_name_of_a_component_makes_a_point_that_the_board_takes(self) -> None:
        self.assertEqual([estimate_lines.point(text).name for text in ("trichloroethylene:12", "C3:1")], ["est_trichlor_12", "est_C3_1"])

    def test_what_cannot_be_estimated_is_refused_in_words(self) -> None:
        for words, wanted in (
            (("splitter", "C9:37"), "must be COMPONENT:STAGE"),
            (("splitter", "iC4:99"), "must be COMPONENT"),
            (("splitter", "iC4"), "must be COMPONENT:STAGE, as iC4:37"),
            (("c3-splitter", "propane:111"), "is never good without a thermometer in its section"),
            (("column-a", "light:41"), "no table for a board: the column has 41 stages, a table 40 at most"),
        ):
            status, _, err = call("gradients", words[0], "--no-steps", "--estimate", words[1])
            self.assertEqual(status, 2)
            self.assertIn(wanted, err)


if __name__ == "__main__":
    unittest.main()
