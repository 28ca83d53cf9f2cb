#!/usr/bin/python3
"""A proposal spoilt before it is accepted, under the noise and drift of the campaign of start-ups: the action of a loop turned
round, gains that are unstable on the plant itself. The trial has to take it back; and it keeps what was not spoilt.

usage: test_commission_spoilt.py [SEEDS]      (1; needs reflux-sim-memory of the host build; nothing is built here)
"""

import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
sys.dont_write_bytecode = True

from research import cmd_campaign, commissioning, commissioning_stability  # noqa: E402

SEEDS = 1
GAIN_MOST = 100.0  # that a loop takes
PLANTS = ("furnace", "air-compressor", "wood-berry", "luyben-vinante", "luyben-4x4", "packed-bed", "lime-kiln",
          "shell-fractionator")


def gains(loops: dict, times: float, only: int | None = None) -> list[str]:
    return [f"loop{n}.gain {min(GAIN_MOST, times * float(loop['gain'])):.6g}" for n, loop in loops.items()
            if only in (None, n)]


def turned(loops: dict, n: int) -> list[str]:
    return [f"loop{n}.action {'reverse' if loops[n].get('action') == 'direct' else 'direct'}"]


class Spoilt(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.start = cmd_campaign.load("commissioning")
        cls.proposals = {}
        for name in PLANTS:
            for seed in range(1, SEEDS + 1):
                result, said = commissioning.start_up(cls.start, {"plant": name, "seed": seed}, [])
                if result["verdict"] == "right":
                    cls.proposals[name, seed] = result, said

    def spoilt(self, what: str, changes) -> None:
        unstable, kept = 0, []
        for (name, seed), (_, said) in self.proposals.items():
            changed = changes(name, said)
            result, said = commissioning.start_up(self.start, {"plant": name, "seed": seed}, changed)
            if commissioning_stability.radius(said, name, changes=changed) < 1.0:
                continue
            unstable += 1
            self.assertNotEqual(result["trial"], "-", (name, seed))
            if result["trial"] == "kept":
                kept.append((name, seed))
        print(f"commission spoilt: {what}: {unstable} unstable of {len(self.proposals)}, kept {kept or 'none'}")
        self.assertGreaterEqual(unstable, len(self.proposals) // 2)
        self.assertEqual(kept, [])

    def loops(self, said: str) -> dict:
        return commissioning_stability.settings(said)[0]

    def edge(self, name: str, said: str) -> float:
        """Times the gains of all loops can be, nearly, before they are unstable."""
        times = 1.0
        while times < 1e4 and commissioning_stability.radius(said, name, times) < 1.0:
            times *= 1.15
        return times

    def test_what_is_not_spoilt_is_kept(self):
        kept = [key for key, (result, _) in self.proposals.items() if result["trial"] == "kept"]
        print(f"commission not spoilt: kept {len(kept)} of {len(self.proposals)}")
        self.assertGreaterEqual(len(kept), 0.9 * len(self.proposals))
        self.assertGreaterEqual(len(self.proposals), 0.75 * SEEDS * len(PLANTS))

    def test_a_first_loop_that_acts_the_wrong_way_is_taken_back(self):
        self.spoilt("first loop turned round", lambda name, said: turned(self.loops(said), min(self.loops(said))))

    def test_a_last_loop_that_acts_the_wrong_way_is_taken_back(self):
        self.spoilt("last loop turned round", lambda name, said: turned(self.loops(said), max(self.loops(said))))

    def test_all_gains_twice_as_large_as_is_stable_are_taken_back(self):
        self.spoilt("all gains twice as large as is stable",
                    lambda name, said: gains(self.loops(said), 2.0 * self.edge(name, said)))

    def test_one_gain_ten_times_is_taken_back_where_it_is_unstable(self):
        self.spoilt("one gain ten times", lambda name, said: gains(self.loops(said), 10.0, min(self.loops(said))))

    def test_gains_a_fifth_larger_than_is_stable_are_taken_back(self):
        """A slow growth is seen by its half cycles, which do not decay."""
        self.spoilt("all gains a fifth larger than is stable",
                    lambda name, said: gains(self.loops(said), 1.2 * self.edge(name, said)))


if __name__ == "__main__":
    if len(sys.argv) > 1 and sys.argv[1].isdigit():
        SEEDS = int(sys.argv.pop(1))
    unittest.main()
