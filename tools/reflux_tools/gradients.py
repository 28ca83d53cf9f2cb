"""What each component does to the temperature profile of a column at a steady state: the gradient diagram (docs/gradients.md)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Sequence

from reflux_tools.errors import UserError


@dataclass(frozen=True)
class Diagram:
    """Stage i stands for the step from stage i to the one above it; the last stage has none."""

    gradient: list[float]  # K, Frau (3.11)
    share: list[list[float]]  # [stage][component], K; they add up to about the gradient
    names: list[str]

    def kappa(self, stage: int, keys: Sequence[str]) -> float:
        """Part of the shares' sizes that comes of these components; 0 where nothing changes."""
        sizes = [abs(s) for s in self.share[stage - 1]]
        return sum(s for s, name in zip(sizes, self.names) if name in keys) / sum(sizes) if sum(sizes) else 0.0


def vapour_pressure(constants: Sequence[float], t: float) -> tuple[float, float]:
    """P and dP/dT, Pa and Pa/K, of ln P = A - B/(C + T) + D T + E ln T + F T^G; what is left out is 0."""
    a, b, c, d, e, f, g = [*constants, 0.0, 0.0, 0.0, 0.0, 0.0][:7]
    p = math.exp(a - b / (c + t) + d * t + e * math.log(t) + f * t**g)
    return p, p * (b / (c + t) ** 2 + d + e / t + (f * g * t ** (g - 1) if f else 0.0))


def diagram(temperature: Sequence[float], x: Sequence[Sequence[float]], names: Sequence[str],
            constants: Sequence[Sequence[float]]) -> Diagram:
    """T in K and mole fractions of every stage from the reboiler up. The share of component j is -P_j/(sum x_k P_k') times its
    step: the derivative of the bubble point by x_j alone, so that the closing component has its share too."""
    if len(temperature) != len(x) or len(temperature) < 3:
        raise UserError("a profile needs the temperature and the fractions of three stages or more")
    gradient, share = [], []
    for i in range(len(temperature) - 1):
        both = [vapour_pressure(c, temperature[i]) for c in constants]
        slope = sum(xj * dp for xj, (_, dp) in zip(x[i], both))
        gradient.append(temperature[i + 1] - temperature[i])
        share.append([-(p / slope) * (above - below) for (p, _), below, above in zip(both, x[i], x[i + 1])])
    return Diagram(gradient, share, list(names))
