#!/usr/bin/python3
"""Bias and scatter of difference models against noise of the measurements, by method: the figure of docs/methods/difference-models.md
and the table of tests/campaign/results/arx-bias.md.

    cmake --preset host && cmake --build --preset host --target libreflux
    tools/figures/arx_bias.py                 100 seeds, writes the table and the figure; half a minute
    tools/figures/arx_bias.py --seeds 2 --print    prints the table and writes nothing

The column of Kotyk and Machacek (1995), both inputs excited at once. Noise, amplitude and lengths are ours. Seeds count from 0; the same
seeds give the same table.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from reflux import identification, libreflux, paths, table  # noqa: E402

PAGE = ROOT / "tests" / "campaign" / "results" / "arx-bias.md"
A = np.array([[-0.80338, 0.02616], [-1.06726, 0.14709]])
B = np.array([[[0.03851, -0.00386], [-0.01062, -0.00192]], [[0.01262, 0.00316], [-0.01990, 0.00157]]])
GAIN = B.sum(axis=2) / (1 + A.sum(axis=1))[:, None]
NOISE = (0.002, 0.005, 0.01, 0.02)
LENGTHS = (511, 1022, 4088)  # 1, 2, 8 periods of nine bits
NAMES = ("least squares", "instruments", "extended")
BEGIN, END = "<!-- bias: made by tools/figures/arx_bias.py -->", "<!-- end of bias -->"


@dataclass(frozen=True)
class Errors:
    """Errors of the seeds whose record was not refused: the first coefficient of A2 less its own, the larger relative error of the gains of y2."""

    of_a: np.ndarray
    of_gain: np.ndarray
    refused: int

    def cells(self) -> list[str]:
        if not len(self.of_a):
            return ["all refused", "-"]
        return [f"{self.of_a.mean():+.3f} ± {self.of_a.std():.3f}" + (f" ({self.refused} refused)" if self.refused else ""), f"{self.rms():.1f}"]

    def rms(self) -> float:
        return float(100 * np.sqrt(np.mean(self.of_gain**2)))


def outputs(u: np.ndarray) -> np.ndarray:
    y = np.zeros((len(u), 2))
    for k in range(2, len(u)):
        for i in range(2):
            y[k, i] = -A[i] @ y[[k - 1, k - 2], i] + sum(B[i, j] @ u[[k - 1, k - 2], j] for j in range(2))
    return y


def errors(method: str, u: np.ndarray, y: np.ndarray, noise: float, seeds: int) -> Errors:
    orders = identification.Orders(2, ((1, 2), (1, 2)), 2 if method == "els" else 0)
    of_a, of_gain, refused = [], [], 0
    for seed in range(seeds):
        record = identification.Record(u, y + noise * np.random.default_rng(seed).standard_normal(y.shape))
        try:
            model = identification.fit(record, 1, orders, method)
        except libreflux.Refused:
            refused += 1
            continue
        of_a.append(model.a()[0] - A[1, 0])
        gain = np.array([sum(row) for row in model.b()]) / (1 + sum(model.a()))
        of_gain.append((gain / GAIN[1] - 1)[np.argmax(abs(gain / GAIN[1] - 1))])
    return Errors(np.array(of_a), np.array(of_gain), refused)


def campaign(seeds: int) -> dict[tuple[int, float, str], Errors]:
    found = {}
    for length in LENGTHS:
        u = identification.prbs(2, length, 1.0, bits=9)[0]
        y = outputs(u)
        for noise in NOISE:
            for method in identification.METHODS:
                found[length, noise, method] = errors(method, u, y, noise, seeds)
            print(f"{length} samples, noise {noise:g} V", file=sys.stderr)
    return found


def markdown(found: dict[tuple[int, float, str], Errors], seeds: int) -> str:
    rows = [[str(length), f"{noise:g}", *(cell for method in identification.METHODS for cell in found[length, noise, method].cells())]
            for length in LENGTHS for noise in NOISE]
    return (f"{seeds} seeds:\n\n"
            + table.markdown(["samples", "noise, V", *(word for name in NAMES for word in (f"{name}: first of A2", "gains, %"))], rows))


def draw(found: dict[tuple[int, float, str], Errors], seeds: int, place: Path) -> None:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    from reflux.plots import BLUE, GREEN, ORANGE, STYLE

    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(1, 2, figsize=(9.6, 3.2))
        length = LENGTHS[-1]
        for method, name, colour, aside in zip(identification.METHODS, NAMES, (ORANGE, BLUE, GREEN), (0.97, 1.0, 1.03)):
            all_of = [found[length, noise, method] for noise in NOISE]
            known = [(noise, one) for noise, one in zip(NOISE, all_of) if len(one.of_a)]
            x = np.array([noise * aside for noise, _ in known])
            axes[0].errorbar(x, [one.of_a.mean() for _, one in known], [one.of_a.std() for _, one in known], color=colour, marker="o", markersize=3.5,
                             linewidth=1.2, capsize=2.5, label=name)
            axes[1].plot([noise for noise, _ in known], [one.rms() for _, one in known], color=colour, marker="o", markersize=3.5, linewidth=1.2, label=name)
        axes[0].axhline(0, color="black", linewidth=0.8)
        axes[0].set(ylabel="error of the first coefficient of A2", title="mean and standard deviation")
        axes[1].set(ylabel="error of the gains of y2, %", title="rms, the larger of the two", yscale="log")
        axes[1].yaxis.set_major_formatter(lambda value, _: f"{value:g}")
        for ax in axes:
            ax.set(xlabel=f"noise, V ({length} samples, {seeds} seeds)", xscale="log")
            ax.set_xticks(NOISE, [f"{noise:g}" for noise in NOISE])
            ax.xaxis.set_minor_locator(matplotlib.ticker.NullLocator())
            ax.legend(fontsize=8)
        figure.savefig(place, dpi=80, metadata={"Software": None})
        plt.close(figure)


def main() -> int:
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--seeds", type=int, default=100)
    p.add_argument("--library", type=Path, help="libreflux.so (default: that of the host preset)")
    p.add_argument("--print", action="store_true", help="print the table and write nothing")
    options = p.parse_args()
    if options.seeds < 1:
        p.error("--seeds must be 1 or more")
    libreflux.load(options.library)
    found = campaign(options.seeds)
    text = markdown(found, options.seeds)
    print(text)
    if options.print:
        return 0
    page = PAGE.read_text(encoding="utf-8")
    head, rest = page.split(BEGIN)
    PAGE.write_text(head + BEGIN + "\n" + text + "\n" + END + rest.split(END)[1], encoding="utf-8")
    draw(found, options.seeds, paths.figures() / "arx-bias.png")
    return 0


if __name__ == "__main__":
    sys.exit(main())
