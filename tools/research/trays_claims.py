"""Compares the source's statements on tray temperature control of its splitter, a fresh reading of it with other property data, and our
results. Written by the campaign of tray temperatures."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from reflux import gradients, table
from research import trays
from reflux.paths import ROOT

Find = Callable[..., dict[str, Any]]  # one line of the campaign: law and structure, scenario, slopes, state, saturation
KEYS = ("C3", "iC4")


@dataclass(frozen=True)
class Claim:
    number: str  # of the digest of the source that the project keeps
    words: str
    source: str
    reading: str
    ours: str
    holds: bool
    remark: str = ""
    in_part: bool = False


def diagram(state: str) -> gradients.Diagram:
    plant = json.loads((ROOT / "host_sim" / "plants" / "splitter.json").read_text(encoding="utf-8"))
    at = trays.steady(state)
    return gradients.diagram(at.temperature, at.x, at.names, gradients.liquid_of(plant, at.names))


def steepest(of: gradients.Diagram, first: int, last: int) -> tuple[int, float]:
    """Stage and gradient, of stages first to last."""
    stage = min(range(first, last + 1), key=lambda s: of.gradient[s - 1])
    return stage, of.gradient[stage - 1]


def settled_h(state: str, mv: str, part: float, stage: int) -> float:
    """After a step: from when on the temperature is within 2 % of all that it moves in a day."""
    log = trays.open_loop(state, mv, part, (stage,), 24.0)
    t, y = log.numbers("time"), log.numbers(f"T{stage}.true")
    away = [abs(v - y[-1]) > 0.02 * abs(y[-1] - y[0]) for v in y]
    return (t[max(k for k, a in enumerate(away) if a)] - trays.STEP_AT_S) / trays.HOUR


def of_profiles() -> list[Claim]:
    claims = []
    ss1, ss2 = diagram("SS1"), diagram("SS2")
    for number, state in (("7", "SS1"), ("8", "SS2")):
        at = trays.steady(state)
        d, b = at.x[-1][at.names.index("iC4")], at.x[0][at.names.index("C3")]
        wanted = "iC4 in the distillate 0.02, C3 in the bottoms " + ("about 1e-5" if state == "SS1" else "0.02")
        claims.append(
            Claim(
                number,
                f"impurities at {state}",
                wanted,
                "the same after trimming the inputs by up to 7.3 %",
                f"{d:.5f}, {b:.2g}",
                abs(d - 0.02) < 1e-4 and (b < 1e-4 if state == "SS1" else abs(b - 0.02) < 1e-4),
                "inputs trimmed by up to 7.7 % (docs/methods/column-model.md)",
            )
        )
    stage, peak = steepest(ss1, 20, 35)
    claims.append(
        Claim(
            "9",
            "steepest gradient at SS1",
            "about stage 30",
            "stage 30, -3.95 K",
            f"stage {stage}, {peak:.2f} K",
            28 <= stage <= 32,
        )
    )
    low, high = steepest(ss2, 2, 17), steepest(ss2, 20, 35)
    claims.append(
        Claim(
            "10",
            "gradients at SS2: stripping, enriching, and how much less than at SS1",
            "about 5, about 30, about 1 K",
            "5 to 6 (-2.18 K), 29 to 30 (-2.46 K), 1.5 K",
            f"{low[0]} ({low[1]:.2f} K), {high[0]} ({high[1]:.2f} K), {high[1] - peak:.1f} K",
            4 <= low[0] <= 7 and 28 <= high[0] <= 32 and 0.5 < high[1] - peak < 2.0,
        )
    )
    c3, nc4, ic4 = (ss1.names.index(name) for name in ("C3", "nC4", "iC4"))
    steep = [s for s in range(20, 35) if abs(ss1.gradient[s - 1]) > 0.5 * abs(peak)]
    signs = all(ss1.share[s - 1][c3] < 0 < ss1.share[s - 1][nc4] for s in steep)
    turns = [s for s in range(2, 36) if ss1.share[s - 1][ic4] * ss1.share[s - 2][ic4] < 0]
    claims.append(
        Claim(
            "11",
            "signs of the shares at SS1: C3 with the gradient, nC4 against it; iC4 turns at the feed and within the sections",
            "so",
            "so",
            f"C3 and nC4 {'so' if signs else 'not so'} where it is steep; iC4 turns at {', '.join(map(str, turns))}",
            signs and any(abs(s - 19) <= 2 for s in turns) and len(turns) >= 2,
        )
    )
    worst = max(abs(sum(share) - g) for of in (ss1, ss2) for share, g in zip(of.share, of.gradient))
    claims.append(
        Claim("12", "shares add up to the gradient", "about", "within 0.15 K", f"within {worst:.2f} K", worst < 0.2)
    )
    return claims


def of_steps() -> list[Claim]:
    rows = range(26, 34)
    moved = {}
    for mv in ("Q", "R"):
        up, down = (
            trays.column_slopes.steady("splitter", {**trays.STATES["SS1"], mv: f * trays.STATES["SS1"][mv]})
            for f in (1.001, 0.999)
        )
        moved[mv] = [(abs(up.temperature[s - 1] - down.temperature[s - 1]) / 2) for s in rows]
    span = {mv: f"{min(m):.2f} to {max(m):.2f} K" for mv, m in moved.items()}
    claims = [
        Claim(
            "13",
            "0.1 % of Q or R at SS1 moves stages 26 to 33 by (mean of up and down)",
            "over 1 K each, Q more",
            "Q 0.8 to 2.8 K, R 0.55 to 1.8 K",
            f"Q {span['Q']}, R {span['R']}",
            min(a / b for a, b in zip(moved["Q"], moved["R"])) > 1,
            "Q moves more on each of them; not all by over 1 K",
            min(min(m) for m in moved.values()) < 1,
        )
    ]
    settled = {
        name: [settled_h(state, mv, sign * part, stage) for mv in ("Q", "R") for sign in (1, -1)]
        for name, state, part, stage in (
            ("SS1", "SS1", 0.001, 31),
            ("stripping", "SS2", 0.01, 5),
            ("enriching", "SS2", 0.01, 31),
        )
    }
    told = ", ".join(f"{name} {min(v):.1f} to {max(v):.1f} h" for name, v in settled.items())
    claims.append(
        Claim(
            "14",
            "temperatures are within 2 % after (0.1 % steps at SS1, 1 % at SS2)",
            "SS1 4 h; SS2 stripping 2 h, enriching 4 h",
            "5.7 to 7.6 h, 1.8 to 2.7 h, 2.7 to 4.3 h",
            told,
            2.5 < sum(settled["SS1"]) / 4 < 7.6,
            "the holdups are ours",
        )
    )
    return claims


def milli(x: float) -> str:
    return f"{1000 * x:.1f}"


def of_runs(find: Find) -> list[Claim]:
    def impurity(line: str, key: str, name: str = "iC4_D", **where: Any) -> float:
        return float(find(line, **where)["impurity"][name][key])

    def both(line: str, key: str, name: str = "iC4_D", **where: Any) -> tuple[float, float]:
        return impurity(line, key, name, slopes="printed", **where), impurity(
            line, key, name, slopes="consistent", **where
        )

    def told(values: tuple[float, float]) -> str:
        return f"{milli(values[0])} and {milli(values[1])}"

    claims = []
    finals = {s: both(f"conventional sC[Q,{s}]", "final") for s in (17, 23, 27, 31, 33)}
    order = [abs(finals[s][0] - 0.02) for s in (17, 23, 27, 31, 33)]
    claims.append(
        Claim(
            "21",
            "final iC4 under SC1 by stage 17, 23, 27, 31, 33",
            "17 by far worst, 33 best",
            "10.0, 24.7, 23.7, 21.4, 20.4",
            ", ".join(told(finals[s]) for s in finals),
            order[0] > 2 * max(order[1:]) and order[-1] == min(order),
        )
    )
    for number, scenario, reading in (("22", "SC1", "49.5 (Q), 47.7 (R)"), ("22b", "SC2", "126 (Q), 140 (R)")):
        q, r = (both(f"conventional sC[{mv},33]", "iae", scenario=scenario) for mv in ("Q", "R"))
        claims.append(
            Claim(
                number,
                f"Q or R for stage 33, IAE under {scenario}",
                "nearly equal" + (", R slightly better" if scenario == "SC2" else ""),
                reading,
                f"{told(q)} (Q), {told(r)} (R)",
                0.75 < r[1] / q[1] < 1.33,
                "" if scenario == "SC1" else "near-equal with consistent slopes; that R is better is not reproduced",
                scenario == "SC2",
            )
        )
    for number, scenario, reading in (("23", "SC1", "61.1 beside 49.5"), ("23b", "SC2", "312 beside 126")):
        with_ratio, without = (
            both("conventional sC[Q,33]_{R/F}", "iae", scenario=scenario),
            both("conventional sC[Q,33]", "iae", scenario=scenario),
        )
        claims.append(
            Claim(
                number,
                f"R/F held, IAE under {scenario} beside R held",
                "worse",
                reading,
                f"{told(with_ratio)} beside {told(without)}",
                with_ratio[0] > without[0],
                "" if with_ratio[1] > without[1] else "worse with the printed slopes, better with the consistent ones",
                with_ratio[1] <= without[1],
            )
        )
    where = {"state": "SS2"}
    c3 = both("conventional sC[Q,33]", "final", "C3_B", **where)
    claims.append(
        Claim(
            "24",
            "SS2, SC1, one end by [Q,33]: final C3 in the bottoms",
            "about 35",
            "33.7",
            told(c3),
            0.030 < c3[0] < 0.040,
        )
    )
    for stage in (3, 5):
        d = both(f"conventional sC[Q,{stage}]", "final", **where)
        peak = both(f"conventional sC[Q,{stage}]", "peak", **where)
        claims.append(
            Claim(
                "25",
                f"by [Q,{stage}]: final iC4 in the distillate",
                "about 45",
                "41 to 42, peak 46",
                f"{told(d)}, peak {told(peak)}",
                0.038 < d[0] < 0.047,
            )
        )
    ratio = both("conventional sC[Q,33]_{R/F}", "final", "C3_B", **where)
    claims.append(Claim("26", "by [Q,33] with R/F held: final C3", "13", "13.0", told(ratio), 0.011 < ratio[0] < 0.015))
    dual = "conventional sC[Q,5][R,33]"
    for number, scenario, source, reading in (
        ("27", "SC1", "both about 20", "19.7 and 20.9"),
        ("28", "SC2", "both within 20 +- 5", "20.5 and 17.3"),
    ):
        d, b = both(dual, "final", scenario=scenario, **where), both(dual, "final", "C3_B", scenario=scenario, **where)
        claims.append(
            Claim(
                number,
                f"both ends by [Q,5][R,33] under {scenario}: final iC4 and C3",
                source,
                reading,
                f"{told(d)}; {told(b)}",
                all(0.015 < x < 0.025 for x in (*d, *b)),
            )
        )
    for number, scenario, reading in (("29", "SC1", "44 to 46 beside 49.5"), ("29b", "SC2", "70 to 78 beside 126")):
        conv = both("conventional sC[Q,33]", "iae", scenario=scenario)
        stages = (17, 23, 31, 34)
        cascade = [both(f"cascade sC[Q,33,{s}]", "iae", scenario=scenario) for s in stages]
        better = all(c[0] < conv[0] for c in cascade)
        spread = [max(c[i] for c in cascade) / min(c[i] for c in cascade) for i in (0, 1)]
        claims.append(
            Claim(
                number,
                f"cascade at SS1 under {scenario}, secondary at 17, 23, 31, 34: IAE",
                "better than conventional wherever the secondary is",
                reading,
                "; ".join(told(c) for c in cascade) + f" beside {told(conv)}",
                better and spread[0] < 1.15,
                "" if all(c[1] < conv[1] for c in cascade) else "with consistent slopes not with the secondary at 17",
                not all(c[1] < conv[1] for c in cascade),
            )
        )
    for number, scenario, source, reading in (
        ("30", "SC1", "C3 better, iC4 slightly worse", "22 beside 49; 21.4 beside 20.5"),
        ("30b", "SC2", "the same", "both better: iC4 49 beside 84"),
    ):
        line = "cascade sC[Q,5,7][R,33,34]"
        b, b0 = (
            both(line, "iae", "C3_B", scenario=scenario, **where),
            both(dual, "iae", "C3_B", scenario=scenario, **where),
        )
        d, d0 = both(line, "iae", scenario=scenario, **where), both(dual, "iae", scenario=scenario, **where)
        worse = d[0] > d0[0]
        claims.append(
            Claim(
                number,
                f"cascade at SS2 under {scenario}, IAE of C3 and of iC4 beside conventional",
                source,
                reading,
                f"{told(b)} beside {told(b0)}; {told(d)} beside {told(d0)}",
                b[0] < b0[0] and worse,
                "" if worse else "both are better here, as in the fresh reading",
            )
        )
    for number, scenario, reading in (
        ("31", "SC1", "45.2, 41.5, 43.2, 41.1"),
        ("31b", "SC2", "72.6, 36.5, 61.2, 41.2"),
    ):
        clf = {s: both(f"clf sC[Q,33,{s}]", "iae", scenario=scenario) for s in (17, 23, 30, 34)}
        cascade = both("cascade sC[Q,33,34]", "iae", scenario=scenario)
        best = sorted(clf, key=lambda s: clf[s][0])[:2]
        claims.append(
            Claim(
                number,
                f"CLF at SS1 under {scenario}, secondary at 17, 23, 30, 34: IAE",
                "23 and 34 best, better than cascade",
                reading,
                ", ".join(told(v) for v in clf.values()) + f"; cascade with 34 {told(cascade)}",
                set(best) == {23, 34} and clf[34][0] < cascade[0],
            )
        )
    for number, scenario, source, reading in (
        ("32", "SC1", "best in both", "iC4 16.9 to 17.9"),
        ("32b", "SC2", "best in iC4", "iC4 25.2 beside 48.5"),
    ):
        clf_line, others = "clf sC[Q,5,7][R,33,34]", (dual, "cascade sC[Q,5,7][R,33,34]")
        d, b = (
            both(clf_line, "iae", scenario=scenario, **where),
            both(clf_line, "iae", "C3_B", scenario=scenario, **where),
        )
        best_d = all(d[0] < both(o, "iae", scenario=scenario, **where)[0] for o in others)
        best_b = all(b[0] < both(o, "iae", "C3_B", scenario=scenario, **where)[0] for o in others)
        now = [both(o, "iae", "C3_B", scenario=scenario, **where)[1] for o in others]
        claims.append(
            Claim(
                number,
                f"CLF at SS2 under {scenario}, IAE of iC4 and C3",
                source,
                reading,
                f"{told(d)}; {told(b)}",
                best_d and (best_b or scenario == "SC2"),
                "" if b[1] < min(now) else "with consistent slopes cascade has the lower IAE of C3",
                scenario == "SC1" and b[1] >= min(now),
            )
        )
    leaves = {
        law: [
            find(f"{law} {s}", scenario="SC2", saturation=True, slopes=slopes)["leaves_h"]
            for slopes in ("printed", "consistent")
        ]
        for law, s in (("conventional", "sC[Q,33]"), ("cascade", "sC[Q,33,34]"), ("clf", "sC[Q,33,34]"))
    }
    claims.append(
        Claim(
            "33",
            "saturation test at SS1: Q is off its limit for good at (the feed is nominal again at 6 h)",
            "soon after 6 h",
            "6.02, 6.06, 6.16 h",
            ", ".join(f"{a:.2f} and {b:.2f} h" for a, b in leaves.values()),
            all(x < 6.3 for v in leaves.values() for x in v),
        )
    )
    return claims


def page(title: str, find: Find) -> str:
    claims = [*of_profiles(), *of_steps(), *of_runs(find)]
    rows = [
        [
            c.number,
            c.words,
            c.source,
            c.reading,
            c.ours,
            (
                "**not as the source has it**"
                if not c.holds
                else "in part as the source has it"
                if c.in_part
                else "as the source has it"
            )
            + (f"; {c.remark}" if c.remark else ""),
        ]
        for c in claims
    ]
    text = (
        f"# {title}: what the source says, and what comes out\n\nWritten by `tools/campaign trays`. The source is A. Frau's thesis (docs/methods/inferential.md), whose plots carry no numbers: "
        "what her text says is put beside a fresh reading of it with other property data (other vapour pressures, pressure and holdups; no firmware, no thermometers), and beside the "
        "firmware on the splitter of this project, whose property data, pressure and holdups are ours. Of two figures of ours the first is with her printed slopes, the second with consistent "
        "ones. Fractions and IAE in 1e-3 (mole fraction, and times h).\n\n"
    )
    return text + table.markdown(["", "claim", "source", "fresh reading", "ours", "verdict"], rows) + "\n"
