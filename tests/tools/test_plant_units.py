"""Units as people write them in a plant's file. Rebuilt from public reports: "°C", "m³/h" and "deg C"."""

import json
import unittest
import unittest.mock

from support import FolderTest, call

from reflux import plant_file, simulator
from reflux.commission import board
from reflux.errors import UserError

HEATER = {"name": "heater", "title": "a heater", "source": "made up", "tick_s": 5,
          "inputs": [{"name": "Q", "unit": "%", "lo": 0, "hi": 100, "nominal": 30, "safe": 0}],
          "outputs": [{"name": "T", "unit": "degC", "lo": 0, "hi": 100, "nominal": 45}],
          "model": "transfer", "elements": [[{"gain": 0.6, "lags": [150], "dead_time": 5}]]}
COLUMN_UNIT = '"unit": "degC", "lo": 70, "hi": 130'
WRITTEN = {"°C": "degC", "º C": "degC", "deg C": "degC", "℃": "degC", "°F": "degF", "m³/h": "m3/h", "m³ / h": "m3/h", "mol %": "mol%",
           "µS/cm": "uS/cm", "μm": "um", "W/m²": "W/m2", "kg·s⁻¹": "kg.s-1", "kΩ": "kohm", "l\u00a0/ h": "l/h", " kW ": "kW", "%": "%"}
REFUSED = ["kg h", "€/h", "a,b", "l\t/h", " ", "°C per minute", "温度"]


class Units(FolderTest):
    def plant(self, unit: str) -> str:
        outputs = [HEATER["outputs"][0] | {"unit": unit}]
        return str(self.file("heater.json", json.dumps(HEATER | {"outputs": outputs}, ensure_ascii=False)))

    def test_signs_are_transliterated_alike_by_the_simulator_and_the_tools(self) -> None:
        for written, unit in WRITTEN.items():
            with self.subTest(written):
                path = self.plant(written)
                self.assertRegex(simulator.ask("--list", path), rf"measurement  T +{unit} ")
                self.assertEqual(plant_file.load(path)[0]["outputs"][0]["unit"], unit)

    def test_another_unit_is_refused_with_its_place_by_the_simulator_and_the_tools(self) -> None:
        for written in REFUSED:
            with self.subTest(written):
                path = self.plant(written)
                with self.assertRaisesRegex(UserError, r"\$\.outputs\[0\]\.unit: "):
                    simulator.ask("--list", path)
                with self.assertRaisesRegex(UserError, r"\$\.outputs\[0\]\.unit: "):
                    plant_file.load(path)

    def test_a_columns_units_are_transliterated_too(self) -> None:
        text = (plant_file.PLANTS / "pilot.json").read_text(encoding="utf-8")
        self.assertIn(COLUMN_UNIT, text)
        path = str(self.file("pilot.json", text.replace('"degC"', '"°C"')))
        self.assertIn(" degC ", simulator.ask("--list", path))

    def test_every_tool_that_starts_a_plant_refuses_the_unit_before_anything_starts(self) -> None:
        path = self.plant("€/h")
        trial = str(self.file("trial.toml", f'name = "trial"\nplant = "{path}"\nduration_s = 600\n'))
        for arguments in (["run", trial, "--firmware", "memory", "--no-build"], ["console", "--host", "--plant", path, "--no-build", "--spark", "T"],
                          ["commission", "--plant", path, "--yes", "--no-build"], ["commission", "--plant", path, "--tick", "5", "--yes", "--no-build"],
                          ["ina", path, "--no-build"], ["decouple", path, "--no-build"], ["state-feedback", path, "--outputs", "T", "--inputs", "Q", "--poles", "0.5", "--period", "5", "--no-build"]):
            with self.subTest(arguments), unittest.mock.patch("reflux.launch.spawn", side_effect=AssertionError("a firmware was started")):
                status, _, err = call(*arguments)
                self.assertEqual(status, 2, err)
                self.assertIn("$.outputs[0].unit: ", err)

    def test_a_unit_with_a_blank_from_a_board_is_shown_as_it_is(self) -> None:
        found = board.plant_of(["plant tick s 5 name heater", "measurement T unit deg C lo 0 hi 100", "output Q unit % lo 0 hi 100 safe 10"])
        assert found is not None
        self.assertEqual([(c.name, c.unit, c.lo, c.hi, c.safe) for c in (*found.measurements, *found.inputs)],
                         [("T", "deg C", 0, 100, 0), ("Q", "%", 0, 100, 10)])


if __name__ == "__main__":
    unittest.main()
