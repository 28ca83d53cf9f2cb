#!/usr/bin/python3
"""`commission advice`: whoever types its lines gets further with the next start-up, for every kind of line; and what it says where
there is nothing to advise, or nothing left to advise from.

usage: test_commission_advice.py      (needs reflux-sim-memory of the host build; nothing is built here)
"""

import json
import re
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from commissioning import OUTCOMES, Plant, Run, whole  # noqa: E402
from made_plants import FIRST, SECOND, MadePlants, channel, element  # noqa: E402

SIXTEEN = Path(__file__).resolve().parent / "data" / "sixteen.json"
LINE_MOST = 240  # characters of an ordinary line of output


def changes(lines: list[str], of: str = "") -> list[str]:
    """The lines to type; all, or those of one setting."""
    return [m[1] for line in lines if (m := re.match(r"`(set [^`]+)`", line)) and of in m[1]]


class Advice(MadePlants):
    def advised(self, of: Plant, settings: list[str], **more) -> tuple[Run, list[str]]:
        """A start-up, and what the board advises after it."""
        script = whole(of, accept=False, settings=settings)
        at = script[-1][0]
        run = Run(of, [*script[:-1], (at, "commission advice"), (at, "~end")], **{"noise": 1.0, **more})
        run.end = run.first("PROPOSAL", "NOT_DETERMINED", "COMMISSION_ENDED")
        lines = run.reply("commission advice")
        print(f"advice {of.path.stem} {settings}: {run.end.code}, {lines}")
        return run, lines

    def followed(self, of: Plant, settings: list[str], kind: str = "", times: int = 1, **more) -> Run:
        """The lines taken literally, so often; one of that setting is among them."""
        for _ in range(times):
            run, lines = self.advised(of, settings, **more)
            self.assertNotEqual(run.end.code, "PROPOSAL")
            self.assertTrue(changes(lines, kind), lines)
            settings = [*settings, *changes(lines)]
        return self.advised(of, settings, **more)[0]

    def succeeds(self, of: Plant, settings: list[str], kind: str, **more) -> None:
        self.assertEqual(self.followed(of, settings, kind, **more).end.code, "PROPOSAL")

    def alike(self, cross: float, lag: float = 180, dead_time: float = 20, resolution: float = 0.01) -> Plant:
        """Both inputs act on both outputs, nearly alike where `cross` is near to 1.5."""
        return self.plant("alike", "transfer",
                          elements=[[element(1.5, 150, 20), element(cross, lag, dead_time)],
                                    [element(cross, 160, dead_time), element(1.5, 150, 20)]],
                          outputs=[channel(y, noise=0.1, resolution=resolution) for y in ("y1", "y2")])

    @staticmethod
    def noisy(of: Plant, sd: float) -> list[str]:
        return [f"0:{y['name']}.noise={sd}" for y in of.outputs]

    # ---- kinds ----

    def test_a_length_that_is_too_short_is_answered_with_the_right_one(self):
        for binding in ("test.longest 5000", "mv1.test_time 5000"):
            with self.subTest(binding=binding):
                run = self.followed(self.beside("slow", element(2.0, 20000, 50)), [f"set {binding}"])
                found = run.elements()["y1", "u1"]
                self.assertLess(abs(found["gain"] / 2.0 - 1.0), 0.2)
                self.assertFalse(found["flags"] & {"short", "integrating"})

    def test_a_step_past_a_limit_is_answered_with_a_smaller_one(self):
        self.succeeds(self.beside("large", element(20.0, 300)), ["set mv1.test_step 20"], "mv1.test_step")
        inverse = self.beside("inverse", element(5.0, [150, 150], 10, zero=-300))
        self.succeeds(inverse, ["set mv1.test_step 3"], "mv1.test_step")

    def test_a_step_that_is_given_and_drowns_is_answered_with_larger_ones(self):
        small = ["set mv1.test_step 0.5", "set mv2.test_step 0.5"]
        for seed in (1, 2, 3):
            self.succeeds(self.alike(1.2, resolution=2), small, "mv2.test_step", seed=seed)

    def test_a_coarse_sensor_is_answered_with_steps_that_it_shows(self):
        of = self.alike(1.2, resolution=2)
        _, lines = self.advised(of, ["set mv1.test_step 0.5"])
        self.assertTrue(any("mv2" in line and "coarse" in line for line in lines), lines)
        self.succeeds(of, ["set mv1.test_step 0.5"], "mv2.test_step")

    def test_a_step_that_both_noise_and_a_coarse_sensor_hide_is_advised_once(self):
        _, lines = self.advised(self.alike(1.2, resolution=2), ["set mv1.test_step 1", "set mv2.test_step 0.5"])
        self.assertTrue(any("set mv1.test_step" in line and "coarse" in line for line in lines), lines)
        names = [line.split()[1] for line in changes(lines)]
        self.assertEqual(len(names), len(set(names)), lines)

    def test_noise_is_answered_with_a_larger_multiple_of_it(self):
        of = self.alike(1.48, 180, 30)
        for seed in (1, 2, 3):
            self.succeeds(of, ["set test.rounds 1"], "test.noise", events=self.noisy(of, 0.05), seed=seed)

    def test_the_multiple_of_noise_alone_helps_as_well(self):
        of = self.alike(1.48, 180, 30)
        _, lines = self.advised(of, ["set test.rounds 1"], events=self.noisy(of, 0.05))
        run, _ = self.advised(of, ["set test.rounds 1", *changes(lines, "test.noise")], events=self.noisy(of, 0.05))
        self.assertEqual(run.end.code, "PROPOSAL")

    def test_no_larger_multiple_of_noise_is_advised_where_the_steps_fill_the_range_of_the_inputs(self):
        of = self.alike(1.2)
        ends = [f"set mv{k}.{end} {value}" for k in (1, 2) for end, value in (("min", 49.4), ("max", 50.6))]
        for seed in (1, 2, 3):
            run, lines = self.advised(of, ["set test.rounds 1", *ends], events=self.noisy(of, 2), seed=seed)
            self.assertNotEqual(run.end.code, "PROPOSAL")
            self.assertFalse(changes(lines, "test.noise"), lines)

    def test_no_larger_multiple_of_noise_is_advised_where_every_step_is_given(self):
        _, lines = self.advised(self.alike(1.2, resolution=2), ["set mv1.test_step 0.5", "set mv2.test_step 0.5"])
        self.assertFalse(changes(lines, "test.noise"), lines)

    def test_too_few_tests_are_answered_with_more(self):
        of = self.alike(1.2)
        for seed in (1, 2, 3):
            self.succeeds(of, ["set test.rounds 1"], "test.rounds", events=self.noisy(of, 2), seed=seed)

    def test_slow_waves_are_answered_with_a_longer_window(self):
        waves = ["0:y1.hum=0.3", "0:y1.hum_period=600"]
        for seed in (1, 2, 3):
            self.succeeds(self.beside("waves", element(1.5, 150, 20)), [], "test.window", events=waves, seed=seed)

    def test_an_input_that_does_not_settle_within_the_limits_is_left_out(self):
        of = self.beside("integrator", {"gain": 5e-3, "integrator": True})
        for seed in (1, 2, 3):
            self.succeeds(of, ["set mv1.test_step 5"], "mv1.test off", seed=seed)

    def test_the_only_input_is_not_to_be_left_out(self):
        of = self.beside("integrator", {"gain": 5e-3, "integrator": True})
        run, lines = self.advised(of, ["set mv1.test_step 5", "set mv2.test off"])
        self.assertEqual((run.end.code, changes(lines)), ("COMMISSION_ENDED", []))

    def by_relay(self, of: Plant, settings: list[str], until: str, after: list[str] = (), **more) -> Run:
        """A relay test of loop L1."""
        script = whole(of, accept=False, settings=settings)
        begin = next(n for n, (_, line) in enumerate(script) if line == "commission begin")
        at = script[begin][0]
        lines = ["commission relay L1", f"~until {until}", *after, "~end"]
        return Run(of, [*script[:begin], *((at, line) for line in lines)], **{"noise": 1.0, **more})

    def test_a_pair_that_is_not_sure_can_be_set_by_relay(self):
        of = self.alike(1.2)
        events = self.noisy(of, 2)
        _, lines = self.advised(of, ["set test.rounds 1"], events=events)
        pair = next(m for line in lines if (m := re.match(r"set (\S+) by (\S+) by relay: `commission relay LOOP`", line)))
        loop = ["set loop1.name L1", f"set loop1.pv {pair[1]}", f"set loop1.out {pair[2]}"]
        run = self.by_relay(of, loop, "RELAY_DONE|COMMISSION_ENDED",
                            ["commission accept", "~until TRIAL_KEPT|TRIAL_FAILED 1000000"], events=events)
        self.assertIsNotNone(run.first("TRIAL_KEPT"), run.events[-3:])

    def test_a_relay_past_a_limit_is_answered_with_a_smaller_one(self):
        of = self.beside("large", element(20.0, 300, 30))
        settings = ["set loop1.name L1", "set loop1.pv y1", "set loop1.out u1", "set mv1.test_step 20"]
        for ending in ("COMMISSION_ENDED", "RELAY_DONE"):
            run = self.by_relay(of, settings, "RELAY_DONE|COMMISSION_ENDED", ["commission advice"])
            self.assertEqual(run.events[-1].code, ending)
            settings += changes(run.reply("commission advice"), "mv1.test_step")

    # ---- pairs without settings ----

    def test_a_pairing_without_settings_ends_without_a_proposal_and_says_why(self):
        of = self.alike(1.2)
        settings, events = ["set test.rounds 2"], self.noisy(of, 3)
        script = whole(of, accept=False, settings=settings)
        at = script[-1][0]
        lines = ["commission", "commission proposal", "?commission accept", "~end"]
        run = Run(of, [*script[:-1], *((at, line) for line in lines)], noise=1.0, events=events)
        self.assertIsNone(run.first("PROPOSAL"))
        self.assertIn("no settings are slow enough to be stable", run.first("NOT_DETERMINED").text)
        self.assertIn("determined", run.reply("commission pairing")[0])
        self.assertIn("no settings are slow enough to be stable", run.reply("commission proposal")[0])
        self.assertTrue(any("there is no proposal; `commission proposal` says why" in line for line in run.said))
        self.succeeds(of, settings, "test.rounds", events=events)

    # ---- sensors ----

    def told(self, of: Plant, **more) -> list[tuple[str, str]]:
        """Measurement and fault of each event about a sensor."""
        run, _ = self.advised(of, **{"settings": [], **more})
        if told := run.all("SENSOR_POOR"):
            first_round = [e.time_s for e in run.all("TEST_DONE")][len(of.inputs) - 1]
            self.assertGreaterEqual(min(e.time_s for e in told), first_round)
        return [(e.subject, e.text.split(": ")[-1]) for e in told]

    def test_an_event_tells_of_a_poor_sensor_once(self):
        of = self.alike(1.2, resolution=2)
        coarse = [(y, "it reads in coarse steps") for y in ("y1", "y2")]
        self.assertEqual(self.told(of), coarse)
        small = ["set mv1.test_step 0.5", "set mv2.test_step 0.5", "set test.rounds 16"]
        self.assertLessEqual(set(self.told(of, settings=small)), set(coarse))  # over all rounds
        fine = self.alike(1.2)
        self.assertEqual(self.told(fine, events=["0:y2.every=10"]), [("y2", "it is renewed rarely")])
        self.assertEqual(self.told(fine), [])
        data = json.loads(fine.path.read_text())
        data["outputs"][0].update(lo=-49950, hi=50050)
        fine.path.write_text(json.dumps(data))
        self.assertEqual(self.told(Plant(fine.path)), [("y1", "its span is too wide")])

    def test_a_coarse_sensor_and_a_span_that_is_too_wide_are_said_with_the_right_number(self):
        of = self.beside("coarse", element(1.2, 900, 50))
        for step, least in ((0.2, 1.0), (0.4, 2.0)):
            data = json.loads(of.path.read_text())
            data["outputs"][0]["resolution"] = step
            of.path.write_text(json.dumps(data))
            _, lines = self.advised(Plant(of.path), [])
            said = next(m for line in lines if (m := re.search(r"y1 reads in steps of (\S+) % of its span: test_step of u1 "
                                                               r"at least (\S+) %", line)))
            self.assertAlmostEqual(float(said[1]), step, delta=0.01 * step)
            self.assertAlmostEqual(float(said[2]), least, delta=0.1 * least)
        data["outputs"][0].update(resolution=0.01, lo=-49950, hi=50050)
        of.path.write_text(json.dumps(data))
        _, lines = self.advised(Plant(of.path), [])
        self.assertTrue(any(re.match(r"y1 moved by at most \S+ % of its span: span of \S+ % instead of 100000", line)
                            for line in lines), lines)

    def test_a_span_is_not_blamed_where_nothing_moved(self):
        for of in (self.beside("still", element(0.0, 900)), self.alike(1.2, resolution=2)):
            for seed in (1, 2):
                _, lines = self.advised(of, ["set mv1.test_step 0.5", "set mv2.test_step 0.5"], seed=seed)
                self.assertFalse([line for line in lines if "moved by at most" in line], lines)

    # ---- what may be wrong ----

    def test_every_line_is_taken_at_the_longest_names_and_all_channels(self):
        """... of 15 characters."""
        data = json.loads(SIXTEEN.read_text())
        for kind in ("outputs", "inputs"):
            for k, c in enumerate(data[kind], 1):
                c.update(name=f"{kind[:1]}_channel_n_{k:03d}")
        for c in data["outputs"]:
            c["resolution"] = 0.02 * (c["hi"] - c["lo"])
        path = self.folder / "sixteen.json"
        path.write_text(json.dumps(data))
        of = Plant(path)
        steps = [f"set mv{k}.test_step 0.3" for k in range(1, 17)]
        run, lines = self.advised(of, ["set test.rounds 1", *steps], events=self.noisy(of, 1.0))
        self.assertEqual(run.end.code, "NOT_DETERMINED")
        self.assertTrue(changes(lines), lines)
        self.assertTrue(any("reads in steps" in line for line in lines), lines)
        self.assertLess(max(map(len, lines)), LINE_MOST)
        self.taken(of, changes(lines))

    def taken(self, of: Plant, lines: list[str]) -> None:
        """The board takes what it has advised: a line that it refuses ends the run with an error."""
        script = [(t, line) for t, line in whole(of, accept=False, settings=lines) if not line.startswith(("~until", "commission"))]
        Run(of, script)

    def test_a_length_beyond_the_range_of_its_setting_is_left_to_the_board(self):
        of = self.beside("slow", element(2.0, 500000, 50), tick_s=100)
        _, lines = self.advised(of, ["set test.longest 100000"])
        self.assertEqual(changes(lines, "test.longest"), ["set test.longest 0"], lines)
        self.taken(of, changes(lines))

    def test_no_change_is_advised_after_an_abort_or_a_lost_reading(self):
        of = self.beside("fine", element(1.5, 150, 20))
        script = whole(of, accept=False)
        begin = next(n for n, (_, line) in enumerate(script) if line == "commission begin")
        at, later = script[begin][0], 2000.0
        for abort, events in (["commission abort"], []), ([], [f"{later:g}:y1.nan=1"]):
            lines = [(at, "commission begin"), *((later, line) for line in abort), (later, f"~until {OUTCOMES}"),
                     (later, "commission advice"), (later, "~end")]
            run = Run(of, [*script[:begin], *lines], noise=1.0, events=events)
            self.assertIsNotNone(run.first("COMMISSION_ENDED"))
            self.assertEqual(run.reply("commission advice"), [])

    def test_it_has_nothing_to_say_after_a_reset(self):
        of = self.beside("slow", element(2.0, 20000, 50))
        script = whole(of, accept=False, settings=["set test.longest 5000"])
        at = script[-1][0]
        run = Run(of, [*script[:-1], (at, "?reboot"), (at + 100, "commission advice"), (at + 100, "~end")], noise=1.0)
        self.assertEqual(run.reply("commission advice"), [])


if __name__ == "__main__":
    unittest.main()
