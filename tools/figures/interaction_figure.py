#!/usr/bin/python3
"""The worked example of docs/methods/interaction.md and docs/methods/tuning.md: numbers on the terminal, docs/figures/interaction.png.

    cmake --preset host && cmake --build --preset host --target libreflux
    tools/figures/interaction_figure.py

Everything is computed by the firmware's own code (libreflux.so); the plants are host_sim/plants.
"""
import json
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
from reflux import libreflux, paths  # noqa: E402

COLOURS = ("#b2182b", "#2166ac", "#4d9221")
UNIT = {"s": 1.0, "min": 60.0, "h": 3600.0}
ERRORS = np.array([0.005, 0.01, 0.02, 0.03, 0.05, 0.07, 0.1, 0.15, 0.2])


def plant(name):
    """A plant of first-order elements with dead time, gains in spans, times in seconds."""
    j = json.loads((ROOT / "host_sim" / "plants" / f"{name}.json").read_text())
    unit, span = UNIT[j["time_unit"]], lambda c: c["hi"] - c["lo"]
    rows = [[e or {"gain": 0.0, "lags": 1.0} for e in row[:len(j["inputs"])]] for row in j["elements"]]
    scale = [[span(u) / span(y) for u in j["inputs"]] for y in j["outputs"]]
    return libreflux.Plant(np.array([[e["gain"] for e in r] for r in rows]) * scale,
                           [[e.get("dead_time", 0.0) * unit for e in r] for r in rows],
                           [[e["lags"] * unit for e in r] for r in rows]), j["tick_s"]


def say(title, value):
    print(f"{title:34s} {np.array2string(np.asarray(value), precision=4, suppress_small=True, separator=', ')}")


def analysis(p):
    found = libreflux.gains(p)
    say("relative gains", libreflux.rga(p).tolist())
    say("singular values", found["singular"])
    say("condition number, equilibrated", [found["condition"], found["condition_scaled"]])
    pairing = libreflux.pairing(p)
    print(f"{'pairing':34s} {', '.join(f'y{a + 1}-u{b + 1}' for a, b in pairing['pairs'])}: {pairing['verdict']}, "
          f"probability {pairing['probability']:.3f}, Niederlinski {pairing['niederlinski']:.4f}")
    m = libreflux.measure(p, pairing["pairs"])
    say("RNGA of the pairs", np.diag(m["phi"]))
    say("RARTA of the pairs", np.diag(m["gamma"]))
    return pairing["pairs"]


def designs(p, pairs, h):
    """SIMC alone, detuned, and detuned with a static decoupler."""
    loose = dict(db_per_loop=20.0, db_most=40.0, gain_margin=1.0)
    decoupler = libreflux.decoupler(p, pairs)
    say("static decoupler", decoupler["d"].tolist())
    for title, settings, d in (("SIMC", loose, None), ("detuned", {}, None), ("decoupler", {}, decoupler["d"])):
        loops, said = libreflux.detune(p, pairs, h, d, **settings)
        step = libreflux.trial(p, loops, 0, size=0.01, duration=6000.0)
        load = libreflux.trial(p, loops, 1, load_step=True, size=0.01, duration=6000.0)
        print(f"{title:10s} F {said['factor']:.2f}  log modulus {said['log_modulus_db']:.2f} dB  K {loops.gain.round(3)}  "
              f"Ti {loops.ti.round(0)} s  overshoot {100 * step['peak'][0]:.0f} %, other loop moved {step['peak'][1]:.2f} "
              f"of the step, settled {step['settled'].max():.0f} s, IAE {step['iae'].sum():.2f} s; "
              f"load on u2: IAE {load['iae'].sum():.2f} s")
        yield title, step


def main():
    if len(sys.argv) > 1:
        print(__doc__)
        return 0 if sys.argv[1] in ("--help", "-h") else 2
    wood, _ = plant("wood-berry")
    h = 15.0  # sample interval, s: a quarter of the plant file's
    print("Wood and Berry's column")
    pairs = analysis(wood)
    fig, axes = plt.subplots(1, 3, figsize=(11, 3.4))

    w = np.geomspace(1e-5, 0.03, 200)
    modulus, _ = libreflux.rga_at(wood, w)
    axes[0].semilogx(w, modulus[:, 0, 0], color=COLOURS[0], label="$|\\lambda_{11}|$ = $|\\lambda_{22}|$")
    axes[0].semilogx(w, modulus[:, 0, 1], color=COLOURS[1], label="$|\\lambda_{12}|$ = $|\\lambda_{21}|$")
    axes[0].set(xlabel="frequency, rad/s", title="dynamic RGA, Wood and Berry", ylim=(0, 2.5))

    print("\nprobability of the pairing when gains are known to", (100 * ERRORS).round(1), "%")
    for name, colour in zip(("wood-berry", "luyben-vinante", "packed-bed"), COLOURS):
        p, _ = plant(name)
        share = [libreflux.pairing(p, floor=e, draws=2000)["probability"] for e in ERRORS]
        say(name, share)
        axes[1].semilogx(100 * ERRORS, share, color=colour, marker=".", label=name)
    axes[1].axhline(0.95, color="0.6", linewidth=0.8)
    axes[1].set(xlabel="standard deviation of every gain, %", title="probability of the pairing", ylim=(0.4, 1.02))

    print("\nPI settings for Wood and Berry's column, setpoint step of 0.01 in loop 1")
    for (title, step), colour in zip(designs(wood, pairs, h), COLOURS):
        axes[2].plot(step["time"] / 60, step["y"][:, 0] / 0.01, color=colour, label=title)
        axes[2].plot(step["time"] / 60, step["y"][:, 1] / 0.01, color=colour, linestyle="--")
    axes[2].set(xlabel="time, min", title="step of loop 1 (dashed: loop 2)", xlim=(0, 100))

    for axis in axes:
        axis.legend(frameon=False, fontsize=8)
        axis.grid(color="0.9")
        axis.spines[["top", "right"]].set_visible(False)
        axis.title.set_size(10)
    fig.tight_layout()
    fig.savefig(paths.figures() / "interaction.png", dpi=80, metadata={"Software": None})

    print("\nrank, and length of the last direction in its standard deviations, of gains known to 0.5, 1, 2, 5 %")
    for name in ("wood-berry", "luyben-vinante", "packed-bed", "furnace", "shell-fractionator"):
        p, _ = plant(name)
        print(f"{name:20s}", ", ".join(f"{f['rank']} ({f['smallest_in_sd']:.1f})" for f in
                                       (libreflux.gains(p, floor=e) for e in (0.005, 0.01, 0.02, 0.05))))


if __name__ == "__main__":
    sys.exit(main())
