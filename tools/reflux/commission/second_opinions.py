"""What moments and plateaus say of the gains of a start-up beside the fit, and why they differ."""

from __future__ import annotations

from reflux import table
from reflux.commission.results import Element, Model

AGREE = 0.1  # gains within this share count as the same


def second_opinion_rows(m: Model) -> tuple[list[str], list[list[str]]]:
    """Gains by moments and by plateaus beside the fit's, and why they differ. The moments' times are left out where a flag says that they
    mean nothing."""
    header = ["measurement", "input", "gain by fit", "by moments", "by plateau", "T + L by fit [s]", "by moments [s]", "what it says"]
    rows = []
    for e in m.elements.values():
        if e.moments and e.has_gain:
            f = table.figure
            spoilt = [flag for flag in e.moments_flags if flag in MOMENTS_SPOILT]
            fitted = e.residence[0] if e.residence else e.time_s + e.dead_s - e.zero_s
            rows.append([e.measurement, e.input, f(e.gain), f(e.moments[0]), f(e.plateau) if e.plateau else "-", f(fitted),
                         "-" if spoilt else f(e.moments[1] + e.moments[2]), second_opinion(e, spoilt)])
    return header, rows


MOMENTS_SPOILT = {"negative_T": "a negative time constant came out", "negative_radicand": "no lag was to be seen", "negative_L": "a negative dead time came out",
                  "no_gain": "no gain was to be seen"}
MOMENTS_DOUBTED = {"short": "the last test was short", "not_settled": "the last test ended before rest", "integrating": "it looks like an integrator"}


def second_opinion(e: Element, spoilt: list[str]) -> str:
    """Words for one row of second_opinion_rows()."""
    others = [("moments", e.moments[0] if e.moments else 0.0)] + ([("plateau", e.plateau)] if e.plateau else [])
    far = [f"{name} {100 * abs(x / e.gain - 1):.0f} %" for name, x in others if e.gain and abs(x / e.gain - 1) > AGREE]
    words = f"gains agree within {100 * AGREE:.0f} %" if not far else f"gain differs: {', '.join(far)}"
    why = [MOMENTS_SPOILT[flag] + ", so its times mean nothing" for flag in spoilt]
    why += [MOMENTS_DOUBTED[flag] for flag in e.moments_flags if flag in MOMENTS_DOUBTED]
    if far and not why:
        why = ["one round alone, with its noise and drift"]
    return words + (f"; moments: {', '.join(why)}" if why else "")
