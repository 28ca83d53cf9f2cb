"""The model along the frequency, for pictures."""

from __future__ import annotations

import numpy as np

from reflux import libreflux
from reflux.commission.record import Record
from reflux.commission.results import Element
from reflux.errors import RunFailed

POINTS = 240


def frequencies(r: Record) -> np.ndarray:
    """From a tenth of the slowest element's corner to ten times the fastest's, no higher than half the sampling."""
    times = [e.time_s + e.dead_s for e in r.model.elements.values() if e.has_gain and e.time_s + e.dead_s > 0]
    tick = float(np.median(np.diff(r.time))) if len(r.time) > 2 else 1.0
    slow, fast = (max(times), min(times)) if times else (100 * tick, 10 * tick)
    return np.geomspace(0.1 / slow, max(min(10 / fast, np.pi / tick), 1 / slow), POINTS)


def matrices(r: Record, omega: np.ndarray) -> np.ndarray:
    """G(i omega) in spans: len(omega) x outputs x inputs, in the order of the analysis."""
    outputs, inputs = r.model.measurements(), r.model.tested()
    g = np.zeros((len(omega), len(outputs), len(inputs)), complex)
    for (m, i), e in r.model.elements.items():
        if m in outputs and i in inputs:
            g[:, outputs.index(m), inputs.index(i)] = in_spans(r, e) * shape(e, 1j * omega)
    return g


def in_spans(r: Record, e: Element) -> float:
    return e.gain * r.channels[e.input].span / r.channels[e.measurement].span


def shape(e: Element, s: np.ndarray) -> np.ndarray:
    """An element of gain 1 at s. One whose gain cannot be seen has no times."""
    if not e.has_gain:
        return np.ones_like(s)
    return (e.zero_s * s + 1) * np.exp(-s * e.dead_s) / (e.square_s2 * s**2 + e.time_s * s + 1)


def singular_values(r: Record) -> tuple[np.ndarray, np.ndarray]:
    omega = frequencies(r)
    return omega, np.linalg.svd(matrices(r, omega), compute_uv=False)


def relative_gains(r: Record) -> tuple[np.ndarray, list[str], list[str], np.ndarray] | None:
    """By the firmware's own code: frequencies, outputs, inputs, and moduli len(omega) x outputs x inputs. Of a plant that
    is not square, the part that is paired. None: libreflux is not built, or there are none."""
    outputs, inputs = r.model.measurements(), r.model.tested()
    if len(outputs) != len(inputs) and r.pairing.pairs:
        outputs, inputs = [m for m, _, _, _ in r.pairing.pairs], [i for _, i, _, _ in r.pairing.pairs]
    omega = frequencies(r)
    table = [[r.model.elements[m, i] for i in inputs] for m in outputs]
    spans = [[r.channels[i].span / r.channels[m].span for i in inputs] for m in outputs]
    try:
        plant = libreflux.Plant(np.array([[e.gain for e in row] for row in table]) * spans,
                                [[e.dead_s if e.has_gain else 0.0 for e in row] for row in table],
                                [[e.time_s if e.has_gain else 0.0 for e in row] for row in table])
        return omega, outputs, inputs, libreflux.rga_at(plant, omega)[0]
    except RunFailed:
        return None
