"""A column at a steady state, and how a tray's temperature answers there to reflux and heat (docs/methods/inferential.md, Slope)."""

from __future__ import annotations

import json
import subprocess
from dataclasses import dataclass
from typing import Any

from reflux import build
from reflux.errors import UserError

MOL_PER_S = 3.6  # kmol/h


@dataclass(frozen=True)
class Steady:
    """One steady state. Lists begin with stage 1, the reboiler; kmol, h, K."""

    plant: str
    inputs: dict[str, float]
    temperature: list[float]
    liquid: list[float]  # leaving the stage, downwards
    vapour: list[float]
    holdup: list[float]
    names: list[str]  # of the components
    x: list[list[float]]  # [stage][component]

    @property
    def stages(self) -> int:
        return len(self.temperature)

    def gradient(self, stage: int) -> float:
        """From the stage to the next one up, K; Frau (3.11)."""
        if not 1 <= stage < self.stages:
            raise UserError(f"stage {stage} has no stage above it; a gradient has stages 1 to {self.stages - 1}")
        return self.temperature[stage] - self.temperature[stage - 1]

    def liquid_to_vapour(self, stage: int) -> float:
        return self.liquid[stage - 1] / self.vapour[stage - 1]

    def flow(self, moves: str, value: float) -> float:
        """kmol per unit of an MV that is reflux or heat and stands at this value."""
        return (self.liquid[-1] if moves == "reflux" else self.vapour[0]) / value

    def slope(self, stage: int, moves: str, value: float, scaling: str = "consistent") -> float:
        """K/h per unit of the MV."""
        size = self.flow(moves, value) * self.gradient(stage) / self.holdup[stage - 1]
        size *= len(self.names) if scaling == "printed" else 1
        return size if moves == "reflux" else -size * self.liquid_to_vapour(stage)


def simulator(*arguments: str) -> str:
    program = build.find_program("host", "reflux-sim")
    done = subprocess.run([str(program), *arguments], capture_output=True, text=True, check=False)
    if done.returncode:
        raise UserError((done.stderr.strip().splitlines() or ["reflux-sim failed"])[-1])
    return done.stdout


def steady(plant: str, inputs: dict[str, float] | None = None) -> Steady:
    """The steady state of a plant's nominal inputs, or with some of them set."""
    sets = [word for name, value in (inputs or {}).items() for word in ("--set", f"{name}={value:.17g}")]
    told: Any = json.loads(simulator("--profile", "--plant", plant, "--format", "json", *sets))
    return read_profile(plant, inputs or {}, told)


def read_profile(plant: str, inputs: dict[str, float], told: Any) -> Steady:
    rows = told["stages"]
    return Steady(
        plant,
        dict(inputs),
        [r["T"] for r in rows],
        [r["liquid"] * MOL_PER_S for r in rows],
        [r["vapour"] * MOL_PER_S for r in rows],
        [r["holdup"] / 1000 for r in rows],
        told["components"],
        [r["x"] for r in rows],
    )
