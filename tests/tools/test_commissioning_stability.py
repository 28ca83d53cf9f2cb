"""Stability of the accepted loops, in a campaign of start-ups."""

import unittest

import support  # noqa: F401 - finds the tools

from research import commissioning_stability as stability

# Settings from a start-up of wood-berry: xD by R and xB by S, in spans.
SETTINGS = {"loop1.name": "xD", "loop1.pv": "xD", "loop1.out": "R", "loop1.gain": "2.3", "loop1.ti": "1000",
            "loop2.name": "xB", "loop2.pv": "xB", "loop2.out": "S", "loop2.gain": "0.9", "loop2.ti": "870",
            "loop2.action": "direct"}


def said(changes: dict[str, str]) -> str:
    lines = [f"10.000 < set {name} {value}" for name, value in {**SETTINGS, **changes}.items()]
    return "\n".join(["10.000 > commission edit", "10.000 < ok", "10.000 > diff", *lines, "10.000 < ok",
                      "10.000 > commission accept", "10.000 < ok", ""])


def radius(**changes: str) -> float:
    return stability.radius(said({name.replace("_", ".", 1): value for name, value in changes.items()}), "wood-berry")


class Stability(unittest.TestCase):
    def test_settings_as_designed_are_stable(self):
        self.assertTrue(0.9 < radius() < 1.0)

    def test_ten_times_the_gain_is_not(self):
        self.assertGreater(radius(loop1_gain="23", loop2_gain="9"), 1.0)

    def test_a_loop_with_the_wrong_sign_is_not(self):
        self.assertGreater(radius(loop2_action="reverse"), 1.0)

    def test_the_decoupler_counts(self):
        self.assertNotAlmostEqual(radius(), radius(decouple1_d2="0.8", decouple2_d1="0.3"), places=4)
        self.assertGreater(radius(decouple1_d2="8", decouple2_d1="3"), 1.0)

    def test_what_was_not_proposed_has_no_stability(self):
        self.assertIsNone(stability.radius("10.000 > commission edit\n10.000 < err STATE commission\n", "wood-berry"))


if __name__ == "__main__":
    unittest.main()
