"""Events of a transcript as sentences: the same as those that the firmware makes, which docs/reference/events.md shows."""

import re
import tomllib
import unittest

import support

from reflux.event_sentences import Names, names_of, sentence

PAGES = support.ROOT / "docs" / "reference"
ROW = re.compile(r"\| `(\w+)` \| (\w+) \| (.*?)<br>`(.*?)` \|")
# The board of the page: docs/reference/events.md says what it is. It has no alarm.
BOARD = Names({"T1": "degC"}, {"Lr": "l/h"}, {"top": ("T1", "Lr")}, {"Lr": ["T1"]})
WITH_REASON = {"PLANT_REFUSED", "MEASUREMENT_BAD", "BLOCK_EVENT", "BLOCK_ALARM", "PROPOSAL_REFUSED", "COMMISSION_ENDED", "NOT_DETERMINED", "TRIAL_FAILED",
               "WATCH_FAILED", "MANUAL_BY_BOARD", "INTERLOCK_ON", "INTERLOCK_OFF", "WATCH_SIGN", "SENSOR_FAULT", "SENSOR_POOR", "OUTPUT_FAULT", "OUTPUT_CONTRADICTED",
               "SEQUENCE_HELD", "SEQUENCE_ABORTED"}


class Sentences(unittest.TestCase):
    def test_every_event_reads_as_the_firmware_says_it(self) -> None:
        examples = {name: noted["example"].split() for name, noted in tomllib.loads((PAGES / "notes" / "events.toml").read_text())["event"].items()}
        reasons = set()
        rows = [row.groups() for row in map(ROW.match, (PAGES / "events.md").read_text().splitlines()) if row]
        self.assertGreater(len(rows), 90)
        for code, level, text, wanted in rows:
            if level == "action":  # the console keeps these to itself
                continue
            with self.subTest(code):
                subject, value, _detail = examples[code]
                board = Names() if code.startswith("ALARM_O") else BOARD
                wanted = wanted.replace("'", "`") if "`" in text else wanted
                mark = f" ({code})" if wanted.endswith(f" ({code})") else ""
                plain = sentence("info", code, f"{subject} {value} {text}", board).removesuffix(mark)
                reason = wanted.removesuffix(mark).removeprefix(plain)
                if reason:
                    reasons.add(code)
                    self.assertTrue(reason.startswith(": "), reason)
                self.assertEqual(sentence(level, code, f"{subject} {value} {text}{reason}", board), wanted)
        self.assertEqual(reasons, WITH_REASON)

    def test_a_reason_may_have_a_semicolon(self) -> None:
        self.assertEqual(sentence("alarm", "COMMISSION_ENDED", "- 0 automatic start-up given up: a sequence is under way; `seq` shows it", BOARD),
                         "automatic start-up given up: a sequence is under way; `seq` shows it (COMMISSION_ENDED)")

    def test_values_have_four_digits_and_the_unit_of_what_the_event_is_about(self) -> None:
        values = {"meas1.name": "T10", "meas1.unit": "degC", "meas2.name": "feed", "mv1.name": "heat", "mv1.unit": "kW", "loop1.name": "bottom",
                  "loop1.pv": "T10", "loop1.out": "heat", "loop2.name": "outer", "loop2.pv": "feed", "loop2.out": "bottom", "lock1.mv": "heat",
                  "lock1.meas": "T10", "lock2.mv": "heat", "lock2.meas": "feed"}
        names = names_of(values, {"feed": "l/h"}.get)
        for code, rest, wanted in (
            ("SETPOINT", "bottom 112.345673 new setpoint", "bottom setpoint 112.3 degC"), ("SETPOINT", "bottom 219720 new setpoint", "bottom setpoint 219700 degC"),
            ("OUTPUT", "heat 0.5 new manual output", "heat output 0.5 kW"), ("OUTPUT", "outer 110 new manual output", "outer output 110 degC"),
            ("OUTPUT", "gone 110 new manual output", "gone output 110"), ("MODE", "bottom 2 loop is in cascade", "bottom CASCADE"),
            ("INTERLOCK_OFF", "heat 3 interlock released; measurement", "interlock releases heat, measurement 3"),
            ("ALARM_OFF", "bottom.dev 2 alarm condition is over", "bottom.dev: 2 degC, the alarm is over"),
            ("ALARM_OFF", "feed.hi_hi 2 alarm condition is over", "feed.hi_hi: 2 l/h, the alarm is over"),
            ("SAMPLE_MISSING", "- 123456 samples missing", "123456 samples missing"), ("MEASUREMENT_GOOD", "T10 none measurement usable again", "T10 usable again, none degC"),
            ("NEW_CODE", "x", "NEW_CODE x"),
        ):
            with self.subTest(rest):
                self.assertEqual(sentence("info", code, rest, names), wanted)


if __name__ == "__main__":
    unittest.main()
