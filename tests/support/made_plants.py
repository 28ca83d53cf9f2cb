"""Plants of two inputs and two outputs that a test makes up, written to a folder that goes with the test."""

from __future__ import annotations

import json
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from commissioning import Plant  # noqa: E402


def channel(name: str, **more: float) -> dict:
    return {"name": name, "unit": "%", "lo": 0, "hi": 100, "nominal": 50, **more}


def element(gain: float, lags, dead_time: float = 0.0, **more) -> dict:
    return {"gain": gain, "lags": lags, "dead_time": dead_time, **more}


FIRST, SECOND = element(0.4, 120, 20), element(1.5, 150, 20)


class MadePlants(unittest.TestCase):
    def setUp(self) -> None:
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def plant(self, name: str, model: str, **more) -> Plant:
        path = self.folder / f"{name}.json"
        path.write_text(json.dumps({
            "name": name, "title": name, "source": f"made up for {type(self).__module__}", "ours": "everything",
            "time_unit": "s", "tick_s": 10, "inputs": [channel("u1"), channel("u2")],
            "outputs": [channel(y, noise=0.1, resolution=0.01) for y in ("y1", "y2")], "model": model, **more}))
        return Plant(path)

    def beside(self, name: str, first: dict, **more) -> Plant:
        """The element as y1 by u1 of a plant that is well behaved otherwise."""
        return self.plant(name, "transfer", elements=[[first, element(0.3, 80)], [FIRST, SECOND]], **more)
