#!/usr/bin/python3
"""Files of columns as reflux-sim takes them: hand-broken ones, each refused with one line that says what, where and what
would be right; nominal states that are met or cannot be; structures, units and analysers that come out as asked.

usage: test_column_files.py REFLUX_SIM
"""
import csv
import json
import math
import os
import re
import subprocess
import sys
import tempfile
import unittest
from copy import deepcopy

SIM = sys.argv[1]
PLANTS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "host_sim", "plants")


def plant_file(name):
    with open(os.path.join(PLANTS, name), encoding="utf-8") as file:
        return json.load(file)


# All property data, volumes and heat.
PILOT = plant_file("pilot.json")
# Relative volatility, moles and boil-up, levels that move.
STILL = {
    "column": 1, "name": "still", "title": "a column", "source": "this test", "tick_s": 10,
    "reference_vapour_pressure": [20.9066, 3096.5, -53.67],
    "components": [{"name": "light", "relative_volatility": 2.4}, {"name": "heavy", "relative_volatility": 1}],
    "stages": 12, "feed_stage": 6, "temperature_range": [320, 420],
    "holdup": {"form": "molar", "reboiler": 200, "tray": 10, "condenser": 100},
    "levels": {"condenser": {"by": "distillate", "gain": 0.02}, "reboiler": {"by": "bottoms", "gain": 0.02}},
    "constants": {"pressure": {"value": 1, "unit": "atm"}},
    "inputs": [{"name": "L", "is": "reflux", "unit": "mol/s", "lo": 0, "hi": 6, "nominal": 1.5},
               {"name": "V", "is": "boilup", "unit": "mol/s", "lo": 0, "hi": 6, "nominal": 2, "safe": 0}],
    "disturbances": [{"name": "F", "is": "feed", "unit": "mol/s", "lo": 0, "hi": 2, "nominal": 1},
                     {"name": "z", "is": "feed_fraction", "of": "light", "lo": 0, "hi": 1, "nominal": 0.5}],
    "outputs": [{"name": "T", "is": "temperature", "stage": 3, "unit": "degC", "lo": 70, "hi": 120},
                {"name": "xD", "is": "fraction", "of": "light", "stage": 12, "unit": "%", "lo": 0, "hi": 100}],
    "truths": [{"name": "xB", "is": "fraction", "of": "light", "stage": 1, "unit": "%", "lo": 0, "hi": 100},
               {"name": "LD", "is": "level", "stage": 12, "unit": "%", "lo": 0, "hi": 100},
               {"name": "LB", "is": "level", "stage": 1, "unit": "%", "lo": 0, "hi": 100},
               {"name": "D", "is": "distillate", "unit": "mol/s", "lo": 0, "hi": 5},
               {"name": "B", "is": "bottoms", "unit": "mol/s", "lo": 0, "hi": 5}],
    "steady_state": [{"channel": "xD", "value": 95, "trim": "L"}, {"channel": "xB", "value": 5, "trim": "V"}],
}
# Rebuilt from a public report: ethanol and water, of which more is wanted than the azeotrope lets through.
SPIRIT = {
    "column": 1, "name": "ew25", "title": "ethanol-water, 25 stages", "source": "this test", "tick_s": 10,
    "components": [{"name": "ethanol", "vapour_pressure": [73.304, 7122.3, 0, 0, -7.1424, 2.8853e-6, 2], "molar_mass": 0.04607,
                    "density": [1054, -0.9], "vaporisation_heat": 38560, "boiling_point": 351.4, "critical_temperature": 514, "heat_capacity": 130},
                   {"name": "water", "vapour_pressure": [73.649, 7258.2, 0, 0, -7.3037, 4.1653e-6, 2], "molar_mass": 0.018015,
                    "density": [1170, -0.57], "vaporisation_heat": 40660, "boiling_point": 373.15, "critical_temperature": 647.1, "heat_capacity": 75.5}],
    "activity": {"model": "nrtl", "a": [[0, -0.8009], [3.4578, 0]], "b": [[0, 246.18], [-586.08, 0]], "alpha": [[0, 0.3], [0.3, 0]]},
    "stages": 25, "feed_stage": 8, "efficiency": 0.6, "temperature_range": [285, 380],
    "holdup": {"form": "conservative", "reboiler": 0.02, "tray": 0.0001, "condenser": 0.0005, "temperatures": [373, 351]},
    "constants": {"pressure": {"value": 1, "unit": "atm"}},
    "inputs": [{"name": "R", "is": "reflux", "unit": "l/h", "lo": 0, "hi": 20, "nominal": 4},
               {"name": "Q", "is": "heat", "unit": "kW", "lo": 0, "hi": 3, "nominal": 1.5, "safe": 0}],
    "disturbances": [{"name": "F", "is": "feed", "unit": "l/h", "lo": 0, "hi": 20, "nominal": 8},
                     {"name": "zF", "is": "feed_fraction", "of": "ethanol", "unit": "%w", "lo": 0, "hi": 90, "nominal": 10},
                     {"name": "TF", "is": "feed_temperature", "unit": "degC", "lo": 15, "hi": 100, "nominal": 60}],
    "outputs": [{"name": "T5", "is": "temperature", "stage": 5, "unit": "degC", "lo": 60, "hi": 110}],
    "truths": [{"name": "xD", "is": "fraction", "of": "ethanol", "stage": 25, "unit": "%w", "lo": 0, "hi": 100},
               {"name": "xB", "is": "fraction", "of": "ethanol", "stage": 1, "unit": "%w", "lo": 0, "hi": 100}],
    "steady_state": [{"channel": "xD", "value": 98, "trim": "R"}, {"channel": "xB", "value": 0.2, "trim": "Q"}],
}
NRTL = {"model": "nrtl", "a": [[0, 0.1], [0.2, 0]], "b": [[0, 50], [80, 0]], "alpha": [[0, 0.3], [0.3, 0]]}


def sim(*arguments):
    return subprocess.run([SIM, *arguments], capture_output=True, text=True, timeout=900)


def put(*path_and_value):
    """A change of a plant: the value at a path; KeyError takes the key away."""
    *path, last, value = path_and_value

    def change(plant):
        for k in path:
            plant = plant[k]
        if value is KeyError:
            del plant[last]
        elif isinstance(plant, list) and last == len(plant):
            plant.append(value)
        else:
            plant[last] = value
    return change


def both(*changes):
    def change(plant):
        for c in changes:
            c(plant)
    return change


class Files(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()

    def tearDown(self):
        self.folder.cleanup()

    def write(self, base, *changes):
        plant = deepcopy(base)
        for change in changes:
            change(plant)
        path = os.path.join(self.folder.name, "p.json")
        with open(path, "w", encoding="utf-8") as file:
            json.dump(plant, file)
        return path

    def refused(self, base, change, because):
        path = self.write(base, change)
        done = sim("--list", "--plant", path)
        self.assertEqual((done.returncode, done.stdout), (2, ""), done)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertIn(path + ": " + because, done.stderr)
        return done.stderr

    def steady(self, base, *changes, settings=()):
        done = sim("--steady", "--plant", self.write(base, *changes), *settings)
        self.assertEqual(done.returncode, 0, done.stderr)
        return {row["name"]: float(row["value"]) for row in csv.DictReader(done.stdout.splitlines())}


class Broken(Files):
    def test_a_key_given_twice_is_refused_with_line_and_column(self):
        path = os.path.join(self.folder.name, "p.json")
        with open(path, "w", encoding="utf-8") as file:
            file.write('{"column": 1, "stages": 10,\n "stages": 12}')
        done = sim("--list", "--plant", path)
        self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1))
        self.assertIn(path + ":2:", done.stderr)
        self.assertIn("not JSON: duplicate object key", done.stderr)

    def test_what_is_wrong_is_said_with_its_path_and_what_would_be_right(self):
        for base, change, because in [
            (STILL, put("column", 2),
             "$.column: 2 is not a known version of this format; must be 1"),
            (STILL, put("column", "1"),
             "$.column: must be a number, is a text"),
            (STILL, put("colour", "red"),
             '$: no key "colour" is known here; known are name'),
            (STILL, put("time_unit", "min"),
             '$: no key "time_unit" is known here; known are name'),
            (STILL, put("name", KeyError),
             '$: the key "name" is missing'),
            (STILL, put("tick_s", 0),
             "$.tick_s: 0 must be 0.001 to 86400"),
            (STILL, put("components", KeyError),
             '$: the key "components" is missing'),
            (STILL, put("components", [STILL["components"][0]]),
             "$.components: must hold 2 to 10 components, holds 1"),
            (STILL, put("components", 0, "light"),
             "$.components[0]: must be an object, is a text"),
            (STILL, put("components", 0, "name", KeyError),
             '$.components[0]: the key "name" is missing'),
            (STILL, put("components", 0, "name", "trichloroethylene"),
             "$.components[0].name: must have 1 to 15 characters, has 17"),
            (STILL, put("components", 0, "name", "a b"),
             '$.components[0].name: "a b" may only have letters, digits and underscores'),
            (STILL, put("components", 1, "name", "light"),
             '$.components[1].name: "light" is the name of an earlier component too'),
            (STILL, put("components", 1, "relative_volatility", KeyError),
             '$.components[1]: the key "relative_volatility" is missing; with a reference_vapour_pressure every '
             'component has one'),
            (STILL, put("components", 1, "relative_volatility", 0),
             "$.components[1].relative_volatility: 0 must be 1e-06 to 1e+06"),
            (STILL, put("components", 1, "vapour_pressure", [20, 3000, -50]),
             "$.components[1]: has both vapour_pressure and relative_volatility; must have one"),
            (STILL, put("components", 1, "antoine", [1, 2, 3]),
             '$.components[1]: no key "antoine" is known here; known are name'),
            (STILL, put("reference_vapour_pressure", KeyError),
             "$.components[0]: a relative_volatility needs $.reference_vapour_pressure"),
            (STILL, put("reference_vapour_pressure", [20, 3000]),
             "$.reference_vapour_pressure: must hold 3 to 7 constants, holds 2"),
            (STILL, put("reference_vapour_pressure", 2, -330),
             "$.reference_vapour_pressure: C + T, -330 + 320, must be above 0 over the whole temperature_range"),
            (STILL, put("stages", KeyError),
             '$: the key "stages" is missing'),
            (STILL, put("stages", 3),
             "$.stages: 3 must be 4 to 200"),
            (STILL, put("stages", 201),
             "$.stages: 201 must be 4 to 200"),
            (STILL, put("stages", 12.5),
             "$.stages: 12.5 must be a whole number"),
            (STILL, put("feed_stage", 11),
             "$.feed_stage: 11 must be 2 to 10"),
            (STILL, put("efficiency", 0),
             "$.efficiency: 0 must be 0.01 to 1"),
            (STILL, put("efficiency", 1.1),
             "$.efficiency: 1.1 must be 0.01 to 1"),
            (STILL, put("pressure_drop", -1),
             "$.pressure_drop: -1 must be 0 to 1e+07"),
            (STILL, put("temperature_range", [420, 320]),
             "$.temperature_range: must be [lowest, highest] in K, at least 1 K apart; is [420, 320]"),
            (STILL, put("temperature_range", [320]),
             "$.temperature_range: must hold 2 numbers, holds 1"),
            (STILL, put("limit_softness", 0),
             "$.limit_softness: 0 must be 0.001 to 0.5"),
            (STILL, put("holdup", KeyError),
             '$: the key "holdup" is missing'),
            (STILL, put("holdup", "form", "constant"),
             '$.holdup.form: must be molar, volumetric or conservative, is "constant"'),
            (STILL, put("holdup", "tray", 0),
             "$.holdup.tray: 0 must be 1e-09 to 1e+09"),
            (STILL, put("holdup", "tray", KeyError),
             '$.holdup: the key "tray" is missing'),
            (STILL, put("holdup", "form", "volumetric"),
             "$.holdup: a holdup in m3 needs the molar_mass of every component; light has none"),
            (STILL, put("holdup", "temperatures", [350, 340]),
             "$.holdup.temperatures: a molar holdup has no temperature"),
            (STILL, put("holdup", "hydraulics", {"time": 0}),
             "$.holdup.hydraulics.time: 0 must be 0.001 to 1e+06"),
            (STILL, put("holdup", "hydraulics", {"time": 1000001}),
             "$.holdup.hydraulics.time: 1000001 must be 0.001 to 1e+06"),
            (STILL, put("holdup", "hydraulics", {"vapour": 1}),
             '$.holdup.hydraulics: the key "time" is missing'),
            (STILL, put("levels", "capacity", 1),
             "$.levels: capacity, 1, must be more than 1"),
            (STILL, put("levels", "reboiler", KeyError),
             '$.levels: the key "reboiler" is missing'),
            (STILL, put("levels", "condenser", "by", "boilup"),
             '$.levels.condenser.by: must be none, distillate or reflux, is "boilup"'),
            (STILL, put("levels", "condenser", "gain", KeyError),
             '$.levels.condenser: the key "gain" is missing'),
            (STILL, put("levels", "condenser", "gain", 0),
             "$.levels.condenser.gain: 0 must be 1e-09 to 1000"),
            (STILL, put("levels", "condenser", {"by": "none", "gain": 1}),
             "$.levels.condenser: has a gain, but no flow that it could move"),
            (STILL, put("levels", "condenser", {"by": "none"}),
             "$: distillate is missing: no level moves it, so it must be an input or a constant"),
            (STILL, put("levels", "condenser", "by", "reflux"),
             "$: distillate is missing: no level moves it, so it must be an input or a constant"),
            (STILL, put("levels", "reboiler", "by", "boilup"),
             "$: bottoms is missing: no level moves it, so it must be an input or a constant"),
            (STILL, put("levels", KeyError),
             "$.truths[1].stage: only the reboiler, 1, and the condenser, 12, have a level in %, and only with "
             "levels; others have mol or kmol"),
            (STILL, put("activity", {"model": "margules"}),
             '$.activity.model: must be wilson or nrtl, is "margules"'),
            (STILL, put("activity", {"model": "wilson"}),
             '$.activity: the key "a" is missing'),
            (STILL, put("activity", NRTL | {"a": [[0, 1]]}),
             "$.activity.a: must hold 2 rows, holds 1"),
            (STILL, put("activity", NRTL | {"a": [[0, 1], [1, 2]]}),
             "$.activity.a[1][1]: must be 0 on the diagonal"),
            (STILL, put("activity", NRTL | {"alpha": [[0, 0.3], [0.2, 0]]}),
             "$.activity.alpha[0][1]: must be symmetric"),
            (STILL, put("activity", {k: NRTL[k] for k in ("model", "a", "b")}),
             '$.activity: the key "alpha" is missing'),
            (STILL, put("activity", {"model": "wilson", "a": [[0, 1], [1, 0]], "alpha": [[0, 0], [0, 0]]}),
             '$.activity: no key "alpha" is known here; known are model, a, b'),
            (STILL, put("inputs", []),
             "$.inputs: must hold 1 to 16 channels, holds 0"),
            (STILL, put("inputs", 0, "is", KeyError),
             '$.inputs[0]: the key "is" is missing'),
            (STILL, put("inputs", 0, "is", "steam"),
             '$.inputs[0].is: "steam" drives no column; must be one of reflux'),
            (STILL, put("inputs", 0, "unit", "gpm"),
             '$.inputs[0].unit: "gpm" is not a unit of reflux; must be one of mol/s'),
            (STILL, put("inputs", 0, "unit", KeyError),
             '$.inputs[0].unit: "-" is not a unit of reflux; must be one of mol/s'),
            (STILL, put("inputs", 0, "unit", "kg/h"),
             "$.inputs[0].unit: the unit kg/h needs the molar_mass of every component; light has none"),
            (STILL, put("inputs", 0, "unit", "l/h"),
             "$.inputs[0].unit: the unit l/h needs the molar_mass of every component; light has none"),
            (STILL, put("inputs", 1, "unit", "kW"),
             '$.inputs[1].unit: "kW" is not a unit of boilup; must be one of mol/s'),
            (STILL, put("inputs", 0, "lo", -1),
             "$.inputs[0].lo: -1 mol/s is not valid for reflux; must be 0 to 1e+12"),
            (STILL, put("inputs", 0, "lo", 7),
             "$.inputs[0]: lo, 7, must be below hi, 6"),
            (STILL, put("inputs", 0, "nominal", 7),
             "$.inputs[0].nominal: 7 must be 0 to 6"),
            (STILL, put("inputs", 0, "nominal", KeyError),
             '$.inputs[0]: the key "nominal" is missing'),
            (STILL, put("inputs", 0, "noise", 1),
             '$.inputs[0]: no key "noise" is known here; known are name'),
            (STILL, put("inputs", 0, "of", "light"),
             "$.inputs[0].of: only a feed_fraction is of a component"),
            (STILL, put("inputs", 1, "name", "L"),
             '$.inputs[1].name: "L" is the name of an earlier channel too'),
            (STILL, put("inputs", 1, {"name": "L2", "is": "reflux", "unit": "mol/s", "lo": 0, "hi": 1, "nominal": 1}),
             "$.inputs[1]: reflux is given twice"),
            (STILL, put("inputs", 2, {"name": "D", "is": "distillate", "unit": "mol/s", "lo": 0, "hi": 1}),
             "$: distillate: the level in the condenser moves it, so it can be no channel"),
            (STILL, put("disturbances", 1, KeyError),
             "$: feed fractions of 0 components are given; must be of all 2, or of all but one, which has the rest"),
            (STILL, put("disturbances", 0, KeyError),
             "$: feed is missing: it must be an input, a disturbance or a constant"),
            (STILL, put("disturbances", 1, "of", "water"),
             '$.disturbances[1].of: "water" is not a component; there is light heavy'),
            (STILL, put("disturbances", 1, "of", KeyError),
             '$.disturbances[1]: the key "of" is missing'),
            (STILL, put("disturbances", 1, "hi", 1.1),
             "$.disturbances[1].hi: 1.1 - is not valid for feed_fraction; must be 0 to 1"),
            (STILL, put("disturbances", 1, "unit", "%w"),
             "$.disturbances[1].unit: the unit %w needs the molar_mass of every component; light has none"),
            (STILL, put("disturbances", 1, "safe", 0),
             '$.disturbances[1]: no key "safe" is known here; known are name'),
            (STILL, put("constants", KeyError),
             "$: pressure is missing: it must be an input, a disturbance or a constant"),
            (STILL, put("constants", "pressure", 1),
             "$.constants.pressure: must be an object, is a number"),
            (STILL, put("constants", "pressure", "unit", "psi"),
             '$.constants.pressure.unit: "psi" is not a unit of pressure; must be one of Pa, kPa, bar, mbar, mmHg, atm'),
            (STILL, put("constants", "pressure", "value", 1000),
             "$.constants.pressure.value: 1000 atm is not valid for pressure; must be 0.000986923 to 98.6923"),
            (STILL, put("constants", "pressure", "value", KeyError),
             '$.constants.pressure: the key "value" is missing'),
            (STILL, put("constants", "reflux", {"value": 1, "unit": "mol/s"}),
             "$.constants.reflux: reflux is given twice"),
            (STILL, put("constants", "steam", {"value": 1}),
             '$.constants: no key "steam" is known here; known are reflux'),
            (STILL, put("constants", "feed_quality", {"value": 2.5}),
             "$.constants.feed_quality.value: 2.5 - is not valid for feed_quality; must be 0 to 2"),
            (STILL, put("constants", "feed_temperature", {"value": 350, "unit": "K"}),
             "$.constants.feed_temperature: feed_temperature needs the vaporisation_heat of every component; "
             "light has none"),
            (STILL, put("constants", "reflux_subcooling", {"value": 5, "unit": "K"}),
             "$.constants.reflux_subcooling: reflux_subcooling needs the vaporisation_heat of every component; "
             "light has none"),
            (STILL, put("constants", "heat_loss", {"value": 5, "unit": "W"}),
             "$: heat_loss and boilup are both given; must be one of them"),
            (STILL, put("constants", "distillate", {"value": 0.5, "unit": "mol/s"}),
             "$: distillate: the level in the condenser moves it, so it can be no constant"),
            (STILL, put("constants", "feed_fraction", {"of": "heavy", "value": 0.5}),
             "$.constants.feed_fraction: must be an array of fractions, is an object"),
            (STILL, put("constants", "feed_fraction", [{"of": "light", "value": 0.5}]),
             "$.constants.feed_fraction[0]: feed_fraction of light is given twice"),
            (STILL, put("outputs", KeyError),
             '$: the key "outputs" is missing'),
            (STILL, put("outputs", []),
             "$.outputs: must hold 1 to 16 channels, holds 0"),
            (STILL, put("outputs", 0, "is", "weight"),
             '$.outputs[0].is: "weight" is nothing to be seen of a column; must be one of temperature,'),
            (STILL, put("outputs", 0, "stage", KeyError),
             '$.outputs[0]: the key "stage" is missing'),
            (STILL, put("outputs", 0, "stage", 13),
             "$.outputs[0].stage: 13 must be 1 to 12"),
            (STILL, put("outputs", 0, "stage", 2.5),
             "$.outputs[0].stage: 2.5 must be a whole number"),
            (STILL, put("outputs", 0, "stages", [1, 2]),
             "$.outputs[0]: has both stage and stages; must have one"),
            (STILL, put("outputs", 0, "of", "light"),
             "$.outputs[0].of: temperature is of no component"),
            (STILL, put("outputs", 0, "unit", "%"),
             '$.outputs[0].unit: "%" is not a unit of temperature; must be one of K, degC'),
            (STILL, put("outputs", 0, "nominal", 90),
             '$.outputs[0]: no key "nominal" is known here; known are name'),
            (STILL, put("outputs", 0, "every_s", 0),
             "$.outputs[0].every_s: 0 must be 0.001 to 86400"),
            (STILL, put("outputs", 0, "name", "L"),
             '$.outputs[0].name: "L" is the name of an earlier channel too'),
            (STILL, put("outputs", 1, "of", "water"),
             '$.outputs[1].of: "water" is not a component; there is light heavy'),
            (STILL, put("outputs", 1, "of", KeyError),
             '$.outputs[1]: the key "of" is missing'),
            (STILL, put("outputs", 1, "of", ["light", "light"]),
             "$.outputs[1].of[1]: light stands here twice"),
            (STILL, put("outputs", 1, "unit", "%w"),
             "$.outputs[1].unit: the unit %w needs the molar_mass of every component; light has none"),
            (STILL, put("truths", 0, "noise", 1),
             '$.truths[0]: no key "noise" is known here; known are name'),
            (STILL, put("truths", 0, {"name": "q", "is": "temperature_difference", "unit": "K", "stage": 3,
                     "lo": 0, "hi": 1}),
             "$.truths[0].stage: temperature_difference has no stage, but stages, a list"),
            (STILL, put("truths", 0, {"name": "q", "is": "temperature_difference", "unit": "K", "stages": [3],
                     "lo": 0, "hi": 1}),
             "$.truths[0].stages: must hold 2 stages, holds 1"),
            (STILL, put("truths", 0, {"name": "q", "is": "temperature_difference", "unit": "K", "stages": [3, 3],
                     "lo": 0, "hi": 1}),
             "$.truths[0].stages: stage 3 stands here twice"),
            (STILL, put("truths", 0, {"name": "q", "is": "vapour_fraction", "of": "light", "stage": 12, "lo": 0,
                     "hi": 1}),
             "$.truths[0].stage: no vapour leaves the condenser; must be 1 to 11"),
            (STILL, put("truths", 0, {"name": "q", "is": "level", "stage": 2, "unit": "%", "lo": 0, "hi": 1}),
             "$.truths[0].stage: only the reboiler, 1, and the condenser, 12, have a level in %, and only with "
             "levels; others have mol or kmol"),
            (STILL, put("truths", 0, {"name": "q", "is": "distillate", "stage": 2, "unit": "mol/s", "lo": 0,
                     "hi": 1}),
             "$.truths[0].stage: distillate has no stage"),
            (STILL, put("truths", 0, {"name": "q", "is": "bottoms", "unit": "m3/h", "lo": 0, "hi": 1}),
             "$.truths[0].unit: the unit m3/h needs the molar_mass of every component; light has none"),
            (PILOT, put("truths", 0, {"name": "q", "is": "feed", "unit": "mol/s", "lo": 0, "hi": 1}),
             "$.truths[0].unit: feed is seen in the kind of unit in which it is driven, and only then"),
            (STILL, put("truths", 0, {"name": "q", "is": "feed_temperature", "unit": "K", "lo": 0, "hi": 1}),
             "$.truths[0].unit: feed_temperature is seen in the kind of unit in which it is driven, and only then"),
            (STILL, put("truths", 0, {"name": "q", "is": "boilup", "unit": "kg/h", "lo": 0, "hi": 1}),
             '$.truths[0].unit: "kg/h" is not a unit of boilup; must be one of mol/s'),
            (STILL, put("truths", 0, {"name": "q", "is": "heat", "unit": "kW", "lo": 0, "hi": 1}),
             "$.truths[0]: heat needs the vaporisation_heat of every component; light has none"),
            (STILL, put("steady_state", {}),
             "$.steady_state: must be an array of values, is an object"),
            (STILL, put("steady_state", 0, "channel", "V"),
             '$.steady_state[0].channel: "V" is neither an output nor a truth'),
            (STILL, put("steady_state", 0, "trim", "F"),
             '$.steady_state[0].trim: "F" is not an input, and not a constant reflux, heat or boilup that could be trimmed'),
            (STILL, put("steady_state", 0, "trim", "V"),
             "$.steady_state[1]: an earlier entry has the same trim"),
            (STILL, put("steady_state", 0, "channel", "xB"),
             "$.steady_state[1]: an earlier entry has the same channel"),
            (STILL, put("steady_state", 0, "value", KeyError),
             '$.steady_state[0]: the key "value" is missing'),
            (STILL, put("steady_state", 0, "value", 100),
             "$.steady_state[0].value: 100 % must be more than nothing and less than all, 100"),
            (STILL, put("steady_state", 0, "value", 101),
             "$.steady_state[0].value: 101 must be 0 to 100"),
            (STILL, put("steady_state", 0, "value", 99.999),
             "$.steady_state: cannot be met; nearest is xD = 99.9237 % (wanted 99.999), xB = 48.456 % (wanted "
             "5) with L = 6 mol/s, its highest, V = 6 mol/s, its highest"),
            (STILL, both(put("outputs", 1, {"name": "xD", "is": "log_fraction", "of": "light", "stage": 12,
                     "lo": -9, "hi": 9}), put("steady_state", 0, "value", 3)),
             "$.steady_state[0].channel: xD is a logarithm; must be met by the fraction itself"),
            (STILL, put("steady_state", 0, "channel", "LD"),
             "$.steady_state: cannot be met; nearest is LD = 50 % (wanted 95), xB = 3.20884 % (wanted 5) with L "
             "= 1.5 mol/s, V = 2 mol/s"),
            (STILL, both(put("levels", "condenser", {"by": "none"}), put("inputs", 2, {"name": "Dp",
                     "is": "distillate", "unit": "mol/s", "lo": 0, "hi": 0.1})),
             "$: Dp is 0.5 mol/s in the nominal state, outside its span, 0 to 0.1"),
            (STILL, both(put("levels", "condenser", {"by": "none"}), put("inputs", 2, {"name": "Dp",
                     "is": "distillate", "unit": "mol/s", "lo": 0, "hi": 1, "nominal": 0.5})),
             "$.inputs[2].nominal: distillate follows from the nominal state and has no nominal of its own"),
            (STILL, both(put("levels", "condenser", {"by": "none"}), put("inputs", 2, {"name": "Dp",
                     "is": "distillate", "unit": "mol/s", "lo": 0, "hi": 1}), put("steady_state", 0, "trim", "Dp")),
             "$.steady_state[0].trim: Dp follows from the nominal state and cannot be trimmed"),
            (PILOT, put("components", 0, "molar_mass", KeyError),
             "$.inputs[0].unit: the unit l/h needs the molar_mass of every component; TCE has none"),
            (PILOT, put("components", 1, "density", KeyError),
             "$.inputs[0].unit: the unit l/h needs the density of every component; PCE has none"),
            (PILOT, put("components", 0, "density", [1991, -5]),
             "$.components[0].density: is -159 kg/m3 at 430 K; must be 1 to 30000 over the whole temperature_range"),
            (PILOT, put("components", 0, "vaporisation_heat", KeyError),
             "$.inputs[1]: heat needs the vaporisation_heat of every component; TCE has none"),
            (PILOT, put("components", 0, "boiling_point", KeyError),
             "$.inputs[1]: heat needs the boiling_point of every component; TCE has none"),
            (PILOT, put("components", 0, "critical_temperature", KeyError),
             "$.inputs[1]: heat needs the critical_temperature of every component; TCE has none"),
            (PILOT, put("components", 0, "critical_temperature", 425),
             "$.components[0].critical_temperature: 425 K must be above the boiling_point and above the "
             "temperature_range, which ends at 430 K"),
            (PILOT, put("components", 0, "heat_capacity", KeyError),
             "$.disturbances[2]: feed_temperature needs the heat_capacity of every component; TCE has none"),
            (PILOT, put("components", 0, "vapour_pressure", KeyError),
             '$.components[0]: the key "vapour_pressure" is missing'),
            (PILOT, put("components", 0, "relative_volatility", 2),
             "$.components[0]: has both vapour_pressure and relative_volatility; must have one"),
            (PILOT, both(put("holdup", "form", "volumetric"), put("holdup", "temperatures", [380, 350]),
                     put("levels", STILL["levels"])),
             "$.levels: levels that rise and fall need a holdup of the form molar"),
            (PILOT, both(put("holdup", "form", "volumetric"), put("holdup", "temperatures", [380, 350]),
                     put("holdup", "hydraulics", {"time": 5})),
             "$.holdup.hydraulics: holdups that move must have the form molar"),
            (PILOT, both(put("holdup", "form", "volumetric"), put("holdup", "temperatures", [480, 350])),
             "$.holdup.temperatures[0]: 480 must be 280 to 430"),
            (PILOT, put("holdup", "form", "conservative"),
             '$.holdup: the key "temperatures" is missing'),
            (PILOT, put("disturbances", 2, KeyError),
             "$: feed is a volume, l/h, and needs a feed_temperature; a feed with a quality has none"),
            (PILOT, put("disturbances", 2, {"name": "q", "is": "feed_quality", "lo": 0, "hi": 1, "nominal": 1}),
             "$: feed is a volume, l/h, and needs a feed_temperature; a feed with a quality has none"),
            (PILOT, put("disturbances", 2, "hi", 200),
             "$.disturbances[2].hi: 200 degC is not valid for feed_temperature; must be 6.85 to 156.85, by $.temperature_range"),
            (PILOT, put("disturbances", 3, "hi", 200),
             "$.disturbances[3].hi: 200 K is not valid for reflux_subcooling; must be 0 to 100"),
            (PILOT, put("disturbances", 5, "lo", 0),
             "$.disturbances[5].lo: 0 mmHg is not valid for pressure; must be 0.750064 to 75006.4"),
            (PILOT, put("inputs", 2, {"name": "V", "is": "boilup", "unit": "mol/h", "lo": 0, "hi": 10, "nominal": 1}),
             "$: heat and boilup are both given; must be one of them"),
            (PILOT, put("inputs", 2, {"name": "D", "is": "distillate", "unit": "mol/h", "lo": 0, "hi": 10}),
             "$: distillate: with perfect levels it is what is left over; only with levels can it be given"),
            (PILOT, put("disturbances", 6, {"name": "x2", "is": "feed_fraction", "of": "PCE", "unit": "%", "lo": 0,
                     "hi": 100, "nominal": 50}),
             "$: feed fractions must all be of moles or all of mass (%w); TCE and PCE differ"),
            (PILOT, put("inputs", 1, KeyError),
             "$: heat or boilup is missing: one of them must be an input, a disturbance or a constant"),
            (PILOT, put("steady_state", [{"channel": "xD", "value": 99.99, "trim": "Lr"}]),
             "$.steady_state: cannot be met; nearest is xD = 99.887 %w (wanted 99.99) with Lr = "),
            (SPIRIT, put("title", "more than distils over"),
             "$.steady_state: cannot be met: an azeotrope is in the way, at xD = 95.6"),
            (PILOT, put("truths", 201 * [PILOT["truths"][0]]),
             "$.truths: must hold 0 to 200 channels, holds 201"),
            (STILL, put("temperature_range", [320, 350]),
             "$.temperature_range: light has a vapour pressure of 2.573e+04 to 8.35e+04 Pa in it, the column "
             "has 1.013e+05 to 1.013e+05; must hold the boiling points of all components"),
            (STILL, put("temperature_range", [360, 420]),
             "$.temperature_range: light has a vapour pressure of 1.174e+05 to 6.15e+05 Pa in it, the column "
             "has 1.013e+05 to 1.013e+05; must hold the boiling points of all components"),
            (STILL, put("inputs", 1, "nominal", 0), "$.steady_state: cannot be met; nearest is xD = "),
            (STILL, both(put("components", 2, {"name": "third", "relative_volatility": 1.5}),
             put("disturbances", 2, {"name": "z2", "is": "feed_fraction", "of": "heavy", "lo": 0, "hi": 1,
                                          "nominal": 0.7})),
             "$: what is nominal leaves less than nothing for the component of the feed that has the rest"),
            (STILL, both(put("disturbances", 1, "nominal", 0),
             put("disturbances", 2, {"name": "z2", "is": "feed_fraction", "of": "heavy", "lo": 0, "hi": 1,
                                          "nominal": 0})),
             "$: what is nominal leaves feed fractions that add up to less than 0.1"),
        ]:
            with self.subTest(because=because):
                self.refused(base, change, because)

    def test_a_column_that_cannot_rest_at_its_nominal_inputs_says_why(self):
        path = self.write(STILL, put("steady_state", []), put("levels", "reboiler", {"by": "none"}),
                          put("constants", "bottoms", {"value": 0.1, "unit": "mol/s"}))
        done = sim("--steady", "--plant", path)
        self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (1, "", 1))
        self.assertIn("still: at the nominal inputs: column: no steady state: the level of the reboiler runs away, "
                      "it rises by 0.4 mol/s", done.stderr)

    # The pure components boil within the range, their mixture does not: with Wilson's L = e^3 both ways its boiling point is a
    # maximum.
    AZEOTROPE = (put("activity", {"model": "wilson", "a": [[0, 3], [3, 0]]}), put("levels", KeyError),
                 put("truths", []), put("steady_state", []))

    def test_a_stage_that_boils_nowhere_in_the_temperature_range_is_named(self):
        done = sim("--steady", "--plant", self.write(STILL, *self.AZEOTROPE))
        self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (1, "", 1))
        self.assertRegex(done.stderr, r"still: at the nominal inputs: column: stage \d+ has no boiling point within the "
                         r"temperature_range, 320 to 420 K, at 1.013e\+05 Pa with mole fractions light 0.\d+, heavy 0.\d+")

    def test_a_stage_that_comes_to_the_end_of_the_temperature_range_is_named(self):
        """A feed without light, of which half becomes light: the reboiler goes to the azeotrope of its pressure."""
        path = self.write(STILL, *self.AZEOTROPE, put("activity", "a", [[0, 1.3], [1.3, 0]]), put("pressure_drop", 50000),
                          put("temperature_range", [320, 414]), put("stages", 5), put("feed_stage", 2),
                          put("outputs", 1, KeyError), put("disturbances", 1, "nominal", 0))
        self.assertEqual(sim("--steady", "--plant", path).returncode, 0)
        done = sim("--step", "--plant", path, "--size", "50")
        self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1), done)
        self.assertRegex(done.stderr, r"column: stage 1 comes to 41(3\.9|4\.0)\d* K and would leave the temperature_range, "
                         "320 to 414 K")


class Nominal(Files):
    def test_trims_are_met_wherever_the_search_starts_and_are_rounded_to_seven_digits(self):
        found = []
        for reflux, boilup in ((1.5, 2), (4, 5), (0.2, 0.9), (5, 5.9)):
            v = self.steady(STILL, put("inputs", 0, "nominal", reflux), put("inputs", 1, "nominal", boilup))
            self.assertAlmostEqual(v["xD"], 95, delta=1e-4)
            self.assertAlmostEqual(v["xB"], 5, delta=1e-4)
            for name in "LV":
                self.assertEqual(v[name], float(f"{v[name]:.7g}"))
            found.append((v["L"], v["V"]))
        self.assertEqual(len(set(found)), 1, found)

    def test_a_search_that_gets_stuck_says_so(self):
        # More reflux than the boil-up makes: it is cut, and neither input moves what they are to meet.
        said = self.refused(STILL, both(put("inputs", 0, "nominal", 5.9), put("inputs", 1, "nominal", 5)),
                            "$.steady_state: cannot be met; nearest is xD = 99.9146 % (wanted 95), xB = 50 % (wanted 5)")
        self.assertIn("where they do not move them apart: a search from other nominal values may help", said)

    def test_pure_products_are_met_though_both_inputs_do_nearly_the_same(self):
        pure = both(put("stages", 40), put("feed_stage", 20), put("outputs", 1, "stage", 40), put("truths", 1, "stage", 40),
                    put("steady_state", 0, "value", 99.99), put("steady_state", 1, "value", 0.02))
        for reflux, boilup in ((1.4, 1.8), (1.4, 2), (3, 3.6), (0.3, 0.5)):
            v = self.steady(STILL, pure, put("inputs", 0, "nominal", reflux), put("inputs", 1, "nominal", boilup))
            self.assertAlmostEqual(100 - v["xD"], 0.01, delta=1e-5 * 5)
            self.assertAlmostEqual(v["xB"], 0.02, delta=2e-5 * 5)

    def test_a_constant_is_trimmed_as_an_input_is(self):
        with_input = self.steady(STILL)
        v = self.steady(STILL, put("inputs", 0, KeyError), put("constants", "reflux", {"value": 1.5, "unit": "mol/s"}),
                        put("steady_state", 0, "trim", "reflux"))
        for name in ("xD", "xB", "V", "D", "B"):
            self.assertEqual(v[name], with_input[name], name)

    def test_the_logarithm_of_a_fraction_ends_where_the_page_says(self):
        none, pure = (self.steady(plant_file("column-a.json"), settings=("--set", f"zF={z}")) for z in (0, 1))
        self.assertAlmostEqual(none["XD"], math.log(1e-12), delta=1e-9)
        self.assertAlmostEqual(pure["XB"], -math.log(1e-12), delta=1e-3)  # 1 - 1e-12 has few digits

    def test_the_splitter_has_its_duty_from_its_trim(self):
        v = self.steady(plant_file("splitter.json"), put("inputs", 1, "nominal", 3700))
        self.assertEqual(v["Q"], 4143.046)


class Structures(Files):
    """Which flows the levels move makes no difference to where the column stands, only to what follows from what."""
    REFLUX = {"value": 1.5, "unit": "mol/s"}

    def product(self, name, quantity, at):
        return put("inputs", at, {"name": name, "is": quantity, "unit": "mol/s", "lo": 0, "hi": 2})

    def changes(self, structure):
        moved = {"LV": (), "DV": ("reflux",), "LB": ("boilup",), "DB": ("reflux", "boilup"), "free": ("none",)}
        moved = moved[structure]
        changes = []
        if "boilup" in moved:
            changes += [put("levels", "reboiler", "by", "boilup"), put("inputs", 1, KeyError),
                        put("constants", "boilup", {"value": 2, "unit": "mol/s"}),
                        put("steady_state", 1, "trim", "boilup"), self.product("Bf", "bottoms", 1)]
        if "reflux" in moved:
            changes += [put("levels", "condenser", "by", "reflux"), put("inputs", 0, KeyError),
                        put("constants", "reflux", self.REFLUX), put("steady_state", 0, "trim", "reflux"),
                        lambda p: p["inputs"].insert(0, {"name": "Df", "is": "distillate", "unit": "mol/s", "lo": 0,
                                                         "hi": 2})]
        if "none" in moved:
            changes += [put("levels", {"condenser": {"by": "none"}, "reboiler": {"by": "none"}}),
                        self.product("Df", "distillate", 2), self.product("Bf", "bottoms", 3)]
        return changes

    def test_all_structures_have_one_nominal_state(self):
        lv = self.steady(STILL)
        for structure in ("DV", "LB", "DB", "free"):
            with self.subTest(structure=structure):
                v = self.steady(STILL, *self.changes(structure))
                for name in ("T", "xD", "xB", "D", "B"):
                    self.assertAlmostEqual(v[name], lv[name], delta=1e-6 * max(1, abs(lv[name])), msg=name)
                self.assertAlmostEqual(v["LD"], 50, delta=1e-6)
                self.assertAlmostEqual(v["LB"], 50, delta=1e-6)
                if structure != "LB":
                    self.assertAlmostEqual(v["Df"], v["D"], delta=1e-12)

    def test_more_feed_leaves_where_the_structure_says(self):
        for structure, fixed, free in (("LV", "L", "B"), ("DV", "D", "B"), ("LB", "B", "D"), ("DB", "D", None)):
            with self.subTest(structure=structure):
                path = self.write(STILL, *self.changes(structure))
                done = sim("--steady", "--plant", path, "--set", "F=1.05")
                self.assertEqual(done.returncode, 0, done.stderr)
                v = {row["name"]: float(row["value"]) for row in csv.DictReader(done.stdout.splitlines())}
                self.assertAlmostEqual(v["D"] + v["B"], 1.05, delta=1e-6)
                if structure == "DB":  # both products are given: a vessel runs over
                    self.assertGreater(max(v["LD"], v["LB"]), 100)
                    continue
                before = self.steady(STILL, *self.changes(structure))
                self.assertAlmostEqual(v[fixed], before[fixed], delta=1e-6)
                self.assertAlmostEqual(v[free], before[free] + 0.05, delta=1e-6)

    def test_a_vessel_that_is_empty_has_no_level(self):
        v = self.steady(STILL, put("truths", 5, {"name": "MB", "is": "level", "stage": 1, "unit": "mol", "lo": 0, "hi": 400}),
                        settings=("--set", "F=0", "--set", "L=0"))
        self.assertEqual((v["LB"], v["MB"]), (0, 0))

    def test_trays_that_are_all_but_dry_come_to_rest(self):
        """Less reflux than at nominal: what these trays would let down is far more than comes, so each holds a thousandth of
        its holdup, and passes it on within microseconds. Where the column rests has nothing to do with it."""
        plain = put("levels", KeyError), put("truths", []), put("steady_state", []), put("limit_softness", 0.001)
        dry = put("holdup", "tray", 0.3), put("holdup", "hydraulics", {"time": 60})
        for reflux in ("L=0.5", "L=0.9", "L=1.3"):
            there = self.steady(STILL, *plain, *dry, settings=("--set", reflux))
            without = self.steady(STILL, *plain, settings=("--set", reflux))
            for name in ("T", "xD"):
                self.assertAlmostEqual(there[name], without[name], delta=1e-5, msg=reflux)

    def test_levels_that_nothing_holds_run_away_in_words(self):
        path = self.write(STILL, *self.changes("free"))
        done = sim("--steady", "--plant", path, "--set", "Df=0.6")
        self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (1, "", 1))
        self.assertIn("the level of the condenser runs away", done.stderr)


class Page(Files):
    def test_the_worked_example_of_the_page_prints_what_the_page_says(self):
        page = os.path.join(PLANTS, "..", "..", "docs", "use", "columns.md")
        with open(page, encoding="utf-8") as file:
            text = file.read()
        example = text[text.index("## A worked example"):text.index("## The file")]
        plant = json.loads(re.search(r"```json\n(.*?)```", example, re.S)[1])
        printed = re.findall(r"`((?:manipulated|measurement),[^`]*)`", example)
        done = sim("--steady", "--plant", self.write(plant))
        self.assertEqual(len(printed), 3)
        for line in printed:
            self.assertIn(line, done.stdout.splitlines())


class Units(Files):
    def same(self, base, change, names, factors=()):
        was, now = self.steady(base), self.steady(base, change)
        for name in names:
            wanted = was[name] * dict(factors).get(name, 1)
            self.assertAlmostEqual(now[name], wanted, delta=1e-8 * abs(wanted), msg=name)

    def scaled(self, i, unit, factor, key="inputs"):
        """Channel i in another unit, all its numbers with it."""
        def change(plant):
            c = plant[key][i]
            c["unit"] = unit
            for k in ("lo", "hi", "nominal", "safe", "slew"):
                if k in c:
                    c[k] *= factor
        return change

    def test_an_input_means_the_same_in_every_unit(self):
        temperatures = ["T1", "T7", "T10", "TB", "D", "B"]
        for i, units in ((0, {"l/min": 1 / 60, "l/s": 1 / 3600, "m3/s": 1e-3 / 3600, "m3/h": 1e-3}),
                         (1, {"W": 1e3, "MW": 1e-3, "kJ/h": 3600, "MJ/h": 3.6, "GJ/h": 3.6e-3, "kcal/h": 3600 / 4.184,
                              "Mcal/h": 3.6 / 4.184, "Gcal/h": 3.6e-3 / 4.184})):
            for unit, factor in units.items():
                with self.subTest(unit=unit):
                    self.same(PILOT, self.scaled(i, unit, factor), temperatures)
        for unit, factor in {"Pa": 133.322, "kPa": 0.133322, "bar": 1.33322e-3, "mbar": 1.33322,
                             "atm": 133.322 / 101325}.items():
            with self.subTest(unit=unit):
                self.same(PILOT, self.scaled(5, unit, factor, "disturbances"), temperatures)
        self.same(PILOT, self.scaled(4, "W", 1e3, "disturbances"), temperatures)
        for unit, factor in {"mol/min": 60, "mol/h": 3600, "kmol/s": 1e-3, "kmol/min": 0.06, "kmol/h": 3.6}.items():
            with self.subTest(unit=unit):
                self.same(STILL, self.scaled(0, unit, factor, "disturbances"), ["T", "D", "B"])

    def test_masses_moles_and_volumes_of_a_stream_fit_together(self):
        mass = [c["molar_mass"] for c in PILOT["components"]]
        more = [{"name": f"{stream}_{k}", "is": stream, "unit": unit, "lo": 0, "hi": 1e6}
                for stream in ("distillate", "bottoms", "reflux")
                for k, unit in enumerate(("mol/h", "kg/h", "l/h", "kmol/s", "t/h", "m3/s"))]
        more += [{"name": name, "is": "fraction", "of": "TCE", "stage": stage, "unit": "-", "lo": 0, "hi": 1}
                 for name, stage in (("d", 12), ("b", 1))]
        v = self.steady(PILOT, lambda p: p["truths"].extend(more))
        for stream, x, litres in (("distillate", v["d"], v["D"]), ("bottoms", v["b"], v["B"]),
                                  ("reflux", v["d"], v["Lr_eff"])):
            mol, kg, l, kmol_s, t, m3_s = (v[f"{stream}_{k}"] for k in range(6))
            self.assertAlmostEqual(kg, mol * (x * mass[0] + (1 - x) * mass[1]), delta=1e-8 * kg)
            self.assertAlmostEqual(kmol_s * 3.6e6, mol, delta=1e-8 * mol)
            self.assertAlmostEqual(t * 1e3, kg, delta=1e-8 * kg)
            self.assertAlmostEqual(l, litres, delta=1e-8 * l)
            self.assertAlmostEqual(m3_s * 3.6e6, l, delta=1e-8 * l)

    def test_a_feed_is_the_same_by_mass_by_moles_and_with_all_its_fractions(self):
        w = 0.36 / PILOT["components"][0]["molar_mass"], 0.64 / PILOT["components"][1]["molar_mass"]
        x = w[0] / (w[0] + w[1])
        names = ["T1", "T7", "T10", "TB", "D", "B"]
        self.same(PILOT, both(put("disturbances", 1, "unit", "%"), put("disturbances", 1, "nominal", 100 * x)), names)
        self.same(PILOT, both(put("disturbances", 1, "unit", "ppm"), put("disturbances", 1, "hi", 1e6),
                              put("disturbances", 1, "nominal", 1e6 * x)), names)
        # of both, half of what they should add up to; one of them a constant in another unit
        self.same(PILOT, both(both(put("disturbances", 1, "unit", "%"), put("disturbances", 1, "nominal", 50 * x)),
                              put("constants", {"feed_fraction": [{"of": "PCE", "value": 0.5 * (1 - x), "unit": "-"}]})),
                  names)

    def test_fractions_that_change_together_count_together_whatever_their_order(self):
        """One of light and middle becomes more and the other less; in one order they are more than all for a moment."""
        three = (put("components", 2, {"name": "middle", "relative_volatility": 1.5}), put("steady_state", []),
                 put("disturbances", 1, {"name": "zl", "is": "feed_fraction", "of": "light", "lo": 0, "hi": 1, "nominal": 0.1}),
                 put("disturbances", 2, {"name": "zm", "is": "feed_fraction", "of": "middle", "lo": 0, "hi": 1, "nominal": 0.8}))
        found = [self.steady(STILL, *three, settings=("--set", a, "--set", b))
                 for a, b in (("zl=0.8", "zm=0.1"), ("zm=0.1", "zl=0.8"))]
        self.assertEqual((found[0]["zl"], found[0]["zm"]), (0.8, 0.1))
        self.assertEqual(found[0], found[1])
        # All there is: no step upwards, no slope upwards, and nothing said about it but which way was taken.
        path = self.write(STILL, *three)
        done = sim("--step", "--plant", path, "--set", "zl=0.2", "--duration", "100")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("# step of zl: -0.05 - from 0.2\n# step of zm: -0.05 - from 0.8\n", done.stdout)
        done = sim("--linearise", "--plant", path, "--set", "zl=0.2")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("zl is at an end of its range", done.stdout)
        done = sim("--steady", "--plant", path, "--set", "zl=0.8", "--set", "zm=0.3")
        self.assertEqual((done.returncode, done.stderr),
                         (2, "reflux-sim: still: zl = 0.8 leaves less than nothing for the component of the feed that has "
                          "the rest\n"))

    def test_a_relative_volatility_is_a_vapour_pressure_with_its_logarithm(self):
        plain = both(put("reference_vapour_pressure", KeyError),
                     put("components", [{"name": "light", "vapour_pressure": [20.9066 + math.log(2.4), 3096.5, -53.67]},
                                        {"name": "heavy", "vapour_pressure": [20.9066, 3096.5, -53.67]}]))
        self.same(STILL, plain, ["T", "xD", "xB", "L", "V"])


class Views(Files):
    def test_what_is_seen_fits_the_profile(self):
        more = [{"name": "mean", "is": "temperature", "stages": [2, 3, 7], "unit": "K", "lo": 0, "hi": 500},
                {"name": "dT", "is": "temperature_difference", "stages": [3, 9], "unit": "K", "lo": 0, "hi": 500},
                {"name": "x35", "is": "fraction", "of": "PCE", "stages": [3, 5], "unit": "ppm", "lo": 0, "hi": 1e6},
                {"name": "both", "is": "fraction", "of": ["PCE", "TCE"], "stage": 3, "unit": "%w", "lo": 0, "hi": 100},
                {"name": "log", "is": "log_fraction", "of": "TCE", "stages": [3, 5], "lo": -30, "hi": 30},
                {"name": "y3", "is": "vapour_fraction", "of": "TCE", "stage": 3, "unit": "%", "lo": 0, "hi": 100},
                {"name": "M3", "is": "level", "stage": 3, "unit": "kmol", "lo": 0, "hi": 1},
                {"name": "L3", "is": "liquid_flow", "stage": 3, "unit": "mol/s", "lo": 0, "hi": 1},
                {"name": "V3", "is": "vapour_flow", "stage": 3, "unit": "mol/s", "lo": 0, "hi": 1},
                {"name": "heat", "is": "heat", "unit": "W", "lo": 0, "hi": 1e4}]
        path = self.write(PILOT, lambda p: p["truths"].extend(more))
        done = sim("--profile", "--plant", path, "--set", "Lr=5")
        stage = [None] + [{k: float(x or "nan") for k, x in row.items()}
                          for row in csv.DictReader(done.stdout.splitlines())]
        v = self.steady(PILOT, lambda p: p["truths"].extend(more), settings=("--set", "Lr=5"))
        self.assertEqual(len(stage), 13)
        x = (stage[3]["x.PCE"] + stage[5]["x.PCE"]) / 2
        for name, wanted in (("mean", (stage[2]["T[K]"] + stage[3]["T[K]"] + stage[7]["T[K]"]) / 3),
                             ("dT", stage[3]["T[K]"] - stage[9]["T[K]"]), ("x35", 1e6 * x), ("both", 100),
                             ("log", math.log((1 - x) / x)), ("y3", 100 * stage[3]["y.TCE"]),
                             ("M3", 1e-3 * stage[3]["holdup[mol]"]), ("L3", stage[3]["liquid[mol/s]"]),
                             ("V3", stage[3]["vapour[mol/s]"]), ("heat", 650), ("TB", stage[1]["T[K]"] - 273.15)):
            self.assertAlmostEqual(v[name], wanted, delta=1e-9 * abs(wanted), msg=name)
        for s in range(1, 13):
            self.assertAlmostEqual(stage[s]["x.TCE"] + stage[s]["x.PCE"], 1, delta=1e-11)
            if s > 1:
                self.assertAlmostEqual(stage[s]["dT[K]"], stage[s]["T[K]"] - stage[s - 1]["T[K]"], delta=1e-9)

    def test_a_pressure_is_seen_as_it_is_driven_in_any_of_its_units(self):
        seen = [{"name": "PT", "is": "pressure", "unit": "mmHg", "lo": 600, "hi": 900},
                {"name": "PK", "is": "pressure", "unit": "kPa", "lo": 60, "hi": 200}]
        for file, pascal in ((STILL, 101325.0), (PILOT, 760 * 133.322)):
            v = self.steady(file, lambda p: p["outputs"].append(seen[0]), lambda p: p["truths"].append(seen[1]))
            self.assertAlmostEqual(v["PT"], pascal / 133.322, delta=1e-6)
            self.assertAlmostEqual(v["PK"], pascal / 1e3, delta=1e-8)

    def test_a_profile_is_the_same_in_both_formats(self):
        path = self.write(STILL)
        table = list(csv.DictReader(sim("--profile", "--plant", path).stdout.splitlines()))
        data = json.loads(sim("--profile", "--plant", path, "--format", "json").stdout)
        self.assertEqual((data["plant"], data["components"], data["feed_stage"]), ("still", ["light", "heavy"], 6))
        self.assertEqual(len(data["stages"]), len(table))
        for row, stage in zip(table, data["stages"]):
            self.assertAlmostEqual(float(row["T[K]"]), stage["T"], delta=1e-8)
            self.assertAlmostEqual(float(row["x.light"]), stage["x"][0], delta=1e-10)
        self.assertNotIn("y", data["stages"][-1])

    def test_plants_without_stages_have_no_profile(self):
        for name in ("wood-berry", "pilot-cold"):
            done = sim("--profile", "--plant", name)
            self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (2, "", 1))
            self.assertIn(f"--profile: {name} is not a column", done.stderr)

    def test_an_analyser_is_listed_and_must_fit_the_tick(self):
        path = self.write(STILL, put("outputs", 1, "every_s", 300), put("outputs", 1, "delay_s", 120))
        self.assertIn("analyser: every 300 s, sampled 120 s before", sim("--list", "--plant", path).stdout)
        done = sim("--plant", path, "--port", "pty:/nowhere", "--tick", "7")
        self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1))
        self.assertIn("plant still: xD has a new value every 300 s, sampled 120 s before; both must be whole ticks of 7 s",
                      done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
