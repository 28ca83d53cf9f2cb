"""A Gymnasium environment: an agent operates the plant through the board (docs/use/python.md). Needs gymnasium, which nothing else does.

    env = reflux.ColumnEnv("pilot", targets={"T1": 87.0, "T10": 108.5})

An action goes to the board as a console line, so limits, rates and interlocks hold as they do for an operator: what the board refuses or
overrides, the agent does not get.
"""

from __future__ import annotations

from typing import Any, Mapping

import numpy as np

from reflux import given
from reflux.errors import UserError
from reflux.lab import SAMPLES_MAX, Lab
from reflux.plant import Plant
from reflux.scenario import Scenario
from reflux.session import Refused

try:
    import gymnasium
except ModuleNotFoundError:
    raise UserError("reflux.ColumnEnv needs gymnasium, which is not installed: pip install gymnasium") from None


class ColumnEnv(gymnasium.Env[np.ndarray, np.ndarray]):
    """Action: of each output its place between the board's limits, -1 lowest and 1 highest; or, with setpoints=True, of each loop's
    setpoint within its measurement's span, the loops in auto. Observation: measurements in engineering units. Reward: minus the sum of
    distances from the targets, in spans. An episode is truncated after `steps` steps of `ticks` samples; it never terminates.
    info: what the outputs applied, and what the board refused with its words.
    """

    metadata = {"render_modes": []}

    def __init__(self, what: str | Scenario | Plant = "pilot", *, targets: Mapping[str, float] | None = None, setpoints: bool = False,
                 steps: int = 240, ticks: int = 1, noise: float | None = None):
        self._noise, self._setpoints = noise, setpoints
        self._steps, self._ticks = given.whole(steps, "steps", SAMPLES_MAX), given.whole(ticks, "ticks", SAMPLES_MAX)
        self._lab = Lab(what, noise=noise)
        try:
            self._find(targets or {})
        except BaseException:
            self._lab.close()
            raise
        self._done = 0

    def _find(self, targets: Mapping[str, float]) -> None:
        channels = self._lab.channels
        self._measured = list(self._lab.measurements)
        self._places = self._loop_places() if self._setpoints else self._output_places()
        if not self._places:
            raise UserError("this board has no loops; setpoints=False moves its outputs" if self._setpoints else "this board has no outputs")
        self._span = {name: (channels[name].lo, channels[name].hi) for name in self._measured}
        if not isinstance(targets, Mapping):
            raise UserError(f'targets are a dictionary such as {{"T10": 108.5}}, not {given.shown(targets)}')
        if unknown := [name for name in targets if name not in self._measured]:
            raise UserError(f"targets: {unknown[0]} is no measurement of the board; there are {', '.join(self._measured)}")
        self._targets = {name: given.finite(target, f"the target of {name}") for name, target in targets.items()}
        low, high = (np.array([self._span[name][k] for name in self._measured], np.float32) for k in (0, 1))
        self.observation_space = gymnasium.spaces.Box(low, high, dtype=np.float32)
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (len(self._places),), np.float32)

    def _output_places(self) -> dict[str, tuple[str, float, float]]:
        """Console verb and ends of each output: its limits min and max."""
        return {name: ("out", float(self._lab.get(f"{name}.min")), float(self._lab.get(f"{name}.max"))) for name in self._lab.outputs}

    def _loop_places(self) -> dict[str, tuple[str, float, float]]:
        channels = self._lab.channels
        return {name: ("sp", channels[loop["pv"]].lo, channels[loop["pv"]].hi) for name, loop in self._lab.loops.items() if loop["pv"] in channels}

    def _observe(self) -> np.ndarray:
        space = self.observation_space
        seen = np.nan_to_num(np.array(list(self._lab.measurements.values()), np.float32))
        return np.clip(seen, space.low, space.high)  # type: ignore[attr-defined]

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[np.ndarray, dict[str, Any]]:
        """A board that has just been configured, and a plant at its operating point; seed: of the sensors' noise."""
        super().reset(seed=seed)
        self._lab.close()
        self._lab = Lab(self._lab.beginning, seed=int(self.np_random.integers(2**31)), noise=self._noise)
        self._done = 0
        if self._setpoints:
            for name in self._places:
                self._lab.mode(name, "auto")
        self._lab.step()
        return self._observe(), {"applied": self._lab.outputs, "refused": []}

    def _wanted(self, action: Any) -> np.ndarray:
        """Places from -1 to 1. What is not finite stays so, for the board to refuse."""
        try:
            places = np.asarray(action)
        except ValueError:  # rows of different lengths
            places = np.array(None)
        if places.shape != (len(self._places),) or places.dtype.kind not in "fiu":
            raise UserError(f"an action is {len(self._places)} numbers from -1 to 1, of {', '.join(self._places)}, not {given.shown(action)}")
        return np.where(np.isfinite(places), np.clip(places, -1.0, 1.0), places)

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        refused = []
        for (name, (verb, low, high)), place in zip(self._places.items(), self._wanted(action)):
            try:
                self._lab.command(f"{verb} {name} {low + (high - low) * (place + 1) / 2:.9g}")
            except Refused as error:
                refused.append(str(error))
        self._lab.step(self._ticks)
        self._done += 1
        seen = self._observe()
        reward = -sum(abs(float(seen[self._measured.index(name)]) - target) / (self._span[name][1] - self._span[name][0])
                      for name, target in self._targets.items())
        return seen, float(reward), False, self._done >= self._steps, {"applied": self._lab.outputs, "refused": refused}

    def close(self) -> None:
        self._lab.close()
