#!/usr/bin/python3
"""Moments against least squares against scipy on the same noisy records: the tables of
tests/campaign/results/identification.md, whose method docs/methods/identification.md has.

    cmake --preset host && cmake --build --preset host --target identify_records
    tools/figures/identification_table.py                 200 seeds, writes the tables; a few minutes
    tools/figures/identification_table.py --seeds 10 --check    judges instead of writing: what the test runs
    tools/figures/identification_table.py --figure        draws docs/figures/identification.png and prints its numbers

Every first-order element of seven plants (host_sim/plants) under a double step of five times the longest L + T of its
input's column. The step is such that the strongest output of the column answers with 5 % of its span. To the exact
response come noise of 0.5 % of span, a drift of 1 % of span per slowest time constant of the plant, and 12 bits.
The firmware's own code identifies (float32); scipy's curve_fit gets every sample and begins at the true values, so it
says what can be had, not what would be had. Same seed, same records.
"""
import argparse
import math
import pathlib
import subprocess
import sys

import numpy as np
import scipy.optimize

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/reference"))
import identify_reference as reference  # noqa: E402

sys.path.insert(0, str(ROOT / "tools"))
from reflux import paths  # noqa: E402

PAGE = ROOT / "tests/campaign/results/identification.md"
NOISE, DRIFT, ANSWER, COUNT = 0.005, 0.01, 0.05, 1.0 / 4096
WINDOW_BLOCKS, POINTS = 16, 128
HEAD = np.dtype([("samples", "u4"), ("before", "u4"), ("half", "u4"), ("window", "u4"),
                 ("h_s", "f8"), ("amplitude", "f8"), ("noise_floor", "f8")])
METHODS = ("moments", "least squares", "scipy")
NO_GAIN = 1


class Element:
    """One element with its experiment; times in samples."""

    def __init__(self, plant, rows, row, slowest):
        self.plant = plant
        self.i, self.j, self.gain, self.T, self.L = row
        self.half = reference.column_half(rows, self.j)
        strongest = max(abs(g) for _, j, g, _, _ in rows if j == self.j)
        self.amplitude = ANSWER / strongest
        self.window = max(32, WINDOW_BLOCKS * math.ceil(slowest / WINDOW_BLOCKS))
        self.before = self.window
        self.samples = self.before + 3 * self.half + self.window
        self.drift = DRIFT / slowest
        # samples of the step response, time 0 at the instant the step begins
        self.k = np.arange(self.samples) - (self.before - 1)

    def response(self, K, T, L):
        """To the double step, at every sample; exact."""
        total = np.zeros(self.samples)
        for at, change in ((0, 1.0), (self.half, -2.0), (2 * self.half, 1.0)):
            t = self.k - at - L
            total += change * np.where(t > 0, -np.expm1(-np.maximum(t, 0) / T), 0.0)
        return K * self.amplitude * total

    def line(self, seed):
        """Returns the drift's part, and the source of randomness behind it."""
        random = np.random.default_rng([seed, reference.NAMES.index(self.plant), self.i, self.j])
        return self.drift * random.choice((-1.0, 1.0)) * self.k, random

    def record(self, seed):
        drift, random = self.line(seed)
        y = 0.5 + drift + self.response(self.gain, self.T, self.L) + NOISE * random.standard_normal(self.samples)
        return np.round(y / COUNT) * COUNT

    def head(self):
        return np.array([(self.samples, self.before, self.half, self.window, 1.0, self.amplitude,
                          COUNT / math.sqrt(12.0))], HEAD).tobytes()

    def scipy(self, y):
        scale = self.T + self.L
        slope = self.k / self.samples

        def model(_, K, T, L, c, d):
            return self.response(K * self.gain, T * scale, L * scale) + c + d * slope

        try:
            best, _ = scipy.optimize.curve_fit(
                model, self.k, y, p0=(1.0, self.T / scale, self.L / scale, 0.5, 0.0),
                bounds=((-np.inf, 1e-4, 0.0, -np.inf, -np.inf), (np.inf, 50.0, 3.0, np.inf, np.inf)), xtol=1e-6)
        except RuntimeError:  # no convergence
            return None
        return best[0], best[1], best[2]  # in units of the truth


def all_elements(names):
    for name in names:
        rows = list(reference.elements(name))
        slowest = max(T for _, _, _, T, _ in rows)
        for row in rows:
            yield Element(name, rows, row, slowest)


def run_firmware(program, element, records):
    head = element.head()
    data = b"".join(head + np.asarray(y, "f8").tobytes() for y in records)
    text = subprocess.run([program], input=data, check=True, capture_output=True).stdout.decode()
    return np.array([[float(v) for v in line.split()] for line in text.splitlines()])


def errors(element, program, seeds):
    """Per method: errors of K, T, L in %, of K or of L + T; and how many said that there is no gain."""
    records = [element.record(seed) for seed in seeds]
    found = run_firmware(program, element, records)
    time = element.T + element.L
    result = {}
    for name, at in (("moments", 0), ("least squares", 4)):
        kept = found[(found[:, at + 3].astype(int) & NO_GAIN) == 0]
        result[name] = (100 * np.column_stack([kept[:, at] / element.gain - 1, (kept[:, at + 1] - element.T) / time,
                                               (kept[:, at + 2] - element.L) / time]), len(found) - len(kept))
    fits = [element.scipy(y) for y in records]
    kept = np.array([f for f in fits if f])
    result["scipy"] = (100 * np.column_stack([kept[:, 0] - 1, kept[:, 1] - element.T / time,
                                              kept[:, 2] - element.L / time]), len(fits) - len(kept))
    kept = found[(found[:, 7].astype(int) & NO_GAIN) == 0]
    truth = np.array([element.gain, element.T, element.L])
    inside = np.abs(kept[:, 4:7] - truth) < 2 * kept[:, 8:11]
    return result, inside


def middle(values):
    """Median and half the width of the middle 68 %."""
    if len(values) == 0:
        return math.nan, math.nan
    low, mid, high = np.percentile(values, (15.9, 50.0, 84.1), axis=0)
    return mid, (high - low) / 2


def number(bias, deviation):
    if np.isnan(bias):
        return "-"
    digits = 1 if deviation < 9.95 else 0
    return f"{bias:+.{digits}f} ± {deviation:.{digits}f}"


def tables(results, seeds):
    lines = [f"Error in %, median ± half the width of the middle 68 % of {len(seeds)} records (seeds {seeds[0]} to {seeds[-1]}): "
             "K of K, T and L of L + T. R: height of the response over the noise (standard deviation) of one sample; "
             "lost: records in which moments / least squares say that there is no gain to be told from noise.", "",
             "| element | R | K moments | K LS | K scipy | T moments | T LS | T scipy | L moments | L LS | L scipy | lost |",
             "|---|---|---|---|---|---|---|---|---|---|---|---|"]
    small = [e for e in results if sum(1 for f in results if f.plant == e.plant) <= 4]
    for e in small:
        r = results[e][0]
        cells = [number(*[v[k] for v in middle(r[m][0])]) if len(r[m][0]) else "-" for k in range(3) for m in METHODS]
        lost = f"{r['moments'][1]} / {r['least squares'][1]}"
        ratio = abs(e.gain) * e.amplitude / NOISE
        lines.append(f"| {e.plant} {e.i + 1}{e.j + 1} | {ratio:.1f} | " + " | ".join(cells) + f" | {lost} |")
    for plant in sorted({e.plant for e in results} - {e.plant for e in small}, key=reference.NAMES.index):
        group = [e for e in results if e.plant == plant]
        for label, part in (("R ≥ 3", [e for e in group if abs(e.gain) * e.amplitude >= 3 * NOISE]),
                            ("R < 3", [e for e in group if abs(e.gain) * e.amplitude < 3 * NOISE])):
            if not part:
                continue
            cells = []
            for k in range(3):
                for m in METHODS:
                    values = np.concatenate([results[e][0][m][0][:, k] for e in part])
                    cells.append(number(*middle(values)))
            lost = " / ".join(str(sum(results[e][0][m][1] for e in part)) for m in METHODS[:2])
            lines.append(f"| {plant}, {len(part)} elements, {label} | | " + " | ".join(cells) + f" | {lost} |")
    inside = np.concatenate([r[1] for r in results.values()])
    share = 100 * inside.mean(axis=0)
    lines += ["", f"Within two of the standard deviations that least squares states: K {share[0]:.0f} %, T {share[1]:.0f} %, "
              f"L {share[2]:.0f} % of {len(inside)} (95 % would be exact)."]
    return lines


def memory(program):
    """Bytes of one experiment, by the compiler of the host (4-byte floats, as on the boards)."""
    text = subprocess.run([program, "--memory"], check=True, capture_output=True, text=True).stdout
    size = {line.rsplit(" ", 1)[0]: int(line.rsplit(" ", 1)[1]) for line in text.splitlines()}
    n = size["outputs"]
    rows = [(f"moments, {n} outputs x {size['alphas']} alphas x 3 compensated sums", size["moments"]),
            (f"record, {n} outputs x {size['points']} points", size["record"]),
            ("steady-state test", size["steady"]),
            ("line guard", size["guard"]),
            ("least squares, one element at a time", size["fit"])]
    total = sum(b for _, b in rows)
    rows += [("**running, whatever the number of inputs**", total),
             (f"results, {n} x {n} elements of {size['element']} bytes", n * n * size["element"]),
             (f"**{n} x {n} in all**", total + n * n * size["element"])]
    return ["| what | bytes |", "|---|---|"] + [f"| {name} | {b} |" for name, b in rows]


def figure(program, path):
    """Wood-Berry, second output to first input, seed 4: record, both models, the truth."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    element = next(e for e in all_elements(["wood-berry"]) if (e.i, e.j) == (1, 0))
    y = element.record(4)
    found = run_firmware(program, element, [y])[0]
    fig, axis = plt.subplots(figsize=(7, 3.4))
    t, drift = element.k, 100 * element.line(4)[0]  # samples of one minute
    axis.plot(t, 100 * (y - 0.5), ".", markersize=2.5, color="0.6", label="measured (noise, drift, 12 bits)")
    truth = f"true: K {element.gain:.3f}, T {element.T:.1f}, L {element.L:.1f} min"
    axis.plot(t, drift + 100 * element.response(element.gain, element.T, element.L), color="0.2", linewidth=1, label=truth)
    for name, at, colour in (("moments", 0, "#b2182b"), ("least squares", 4, "#2166ac")):
        K, T, L = found[at:at + 3]
        print(f"{name}: K {K:.4f}, T {T:.2f} min, L {L:.2f} min, flags {int(found[at + 3])}")
        axis.plot(t, drift + 100 * element.response(K, max(T, 1e-3), L), color=colour, linewidth=1.2,
                  label=f"{name}: K {K:.3f}, T {T:.1f}, L {L:.1f} min")
    print(f"least squares, standard deviations: K {found[8]:.4f}, T {found[9]:.2f}, L {found[10]:.2f} min; "
          f"plateau gain {found[11]:.4f} +- {found[12]:.4f}; noise {100 * found[13]:.3f} % of span")
    print(truth)
    axis.set_xlabel("time since the step, min")
    axis.set_ylabel("deviation, % of span")
    axis.legend(frameon=False, fontsize=8)
    axis.grid(color="0.9")
    axis.spines[["top", "right"]].set_visible(False)
    fig.tight_layout()
    fig.savefig(path, dpi=80, metadata={"Software": None})
    plt.close(fig)


def replace(text, name, lines):
    begin, end = f"<!-- {name}: made by tools/figures/identification_table.py -->", f"<!-- end of {name} -->"
    head, rest = text.split(begin)
    return head + begin + "\n" + "\n".join(lines) + "\n" + end + rest.split(end)[1]


def check(results):
    """Bounds a tenth of the campaign must keep; wide enough for ten seeds, narrow enough for a broken estimator."""
    wrong = []
    for e, (r, _) in results.items():
        name, ratio = f"{e.plant} {e.i + 1}{e.j + 1}", abs(e.gain) * e.amplitude / NOISE
        if ratio < 3:
            continue
        ours, theirs = r["least squares"][0], r["scipy"][0]
        if r["least squares"][1]:
            wrong.append(f"{name}: least squares lost {r['least squares'][1]}")
        block = 2 ** max(0, math.ceil(math.log2(e.samples / POINTS)))  # what lies within a point is averaged away
        for k in range(3):
            bound = 1.5 * np.sqrt(np.mean(theirs[:, k] ** 2)) + 1.0 + (15.0 * block / (e.T + e.L) if k else 0.0)
            rms = np.sqrt(np.mean(ours[:, k] ** 2))
            if not rms <= bound:
                wrong.append(f"{name} {'KTL'[k]}: rms {rms:.1f} %, scipy allows {bound:.1f} %")
    return wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=paths.build_dir("host") / "tests/unit/identify_records", type=pathlib.Path,
                        help="the built identify_records (default: that of the host preset)")
    parser.add_argument("--seeds", type=int, default=200)
    parser.add_argument("--check", action="store_true", help="write nothing, exit status 1 when a bound is broken")
    parser.add_argument("--figure", action="store_true", help="draw the figure and do nothing else")
    parser.add_argument("--plants", nargs="*", default=list(reference.NAMES), choices=reference.NAMES)
    options = parser.parse_args()
    if not options.program.exists():
        print(f"{options.program} does not exist: build the target identify_records first (--help)", file=sys.stderr)
        return 1
    if options.figure:
        figure(options.program, paths.figures() / "identification.png")
        return 0
    seeds = range(1, options.seeds + 1)
    results = {}
    for element in all_elements(options.plants):
        results[element] = errors(element, options.program, seeds)
    lines = tables(results, seeds)
    print("\n".join(lines))
    if options.check:
        wrong = check(results)
        print("\n".join(wrong) if wrong else f"seeds 1 to {options.seeds}: all bounds kept")
        return 1 if wrong else 0
    if options.plants != list(reference.NAMES):
        return 0  # a look at some plants is no page
    text = replace(PAGE.read_text(), "errors", lines)
    PAGE.write_text(replace(text, "memory", memory(options.program)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
