"""Samples of cases. A long test tries a sample by default, and every case with the argument `all`, which the full tier gives."""

from __future__ import annotations

import itertools
import sys
from typing import Sequence

EVERY = "all" in sys.argv[1:]
if EVERY:
    sys.argv.remove("all")  # unittest would take it for the name of a test


def combinations(*lists: Sequence, stride: int) -> list[tuple]:
    """Every combination of one item of each list, or those whose places add up to a multiple of stride: a share of 1/stride.

    Where no list is shorter than stride, every item of every list is in the sample.
    """
    out = []
    for chosen in itertools.product(*(enumerate(items) for items in lists)):
        if EVERY or sum(place for place, _ in chosen) % stride == 0:
            out.append(tuple(item for _, item in chosen))
    return out
