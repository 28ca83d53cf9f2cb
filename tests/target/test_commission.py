#!/usr/bin/python3
"""Automatic start-up on the image that is flashed, in the emulator and on the virtual board, over the bytes of both its lines: the same
model as the host's firmware finds, and what a plant of 16 x 16 costs in the emulator. Instructions are counted by the processor's own
timer, one instruction being one count (-icount shift=0)."""

import contextlib
import re
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import board  # noqa: E402
import sample  # noqa: E402
from commissioning import Plant, plant, whole  # noqa: E402
from sram_guard import Guard  # noqa: E402

from reflux import launch  # noqa: E402

SIXTEEN = Path(__file__).resolve().parents[1] / "loop" / "data" / "sixteen.json"
RESULTS = ("commission model", "commission gains", "commission pairing", "commission structure", "commission proposal")
ICOUNT = ("-icount", "shift=0")
CLOCK_MHZ = 168

TICK_BUDGET = 120_000   # instructions of the longest tick of a 16 x 16 start-up: 0.7 ms at one a cycle
WORK_BUDGET = 500_000   # of the longest piece of background work, which ticks interrupt
STACK_LEFT = 1024       # bytes never used


def said(kind: str, of: Plant, script: list, *options: str, extra: tuple[str, ...] = ()) -> list[str]:
    """Everything on the console of a run with that firmware; on the emulator nothing may be written where no variable lies."""
    with contextlib.ExitStack() as stack:
        folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="reflux-"))
        guard = Guard(Path(folder), kind) if kind.startswith("stm32") else None
        firmware = stack.enter_context(launch.start(kind, extra=(*extra, *guard.options()) if guard else extra))
        lines, transcript = Path(folder) / "script", Path(folder) / "said"
        lines.write_text("".join(f"{t:g} {line}\n" for t, line in script))
        done = subprocess.run(board.simulator(firmware, "--plant", str(of.path), "--console", firmware.console, "--script",
                                              str(lines), "--transcript", str(transcript), "--duration", "1e8",
                                              "--timeout", "600", *options), capture_output=True, text=True, timeout=900)
        if done.returncode != 0:
            raise AssertionError(f"{kind}: {done.stderr.strip()[-300:]}")
        if guard and (touched := guard.touched()):
            raise AssertionError(f"{kind}: written where no variable lies: {', '.join(map(hex, touched[:8]))}")
        return transcript.read_text().splitlines()


def reply(lines: list[str], command: str) -> list[str]:
    """Payload of the last time this was asked."""
    begins = max(n for n, line in enumerate(lines) if line.endswith(f"> {command}"))
    found = []
    for line in lines[begins + 1:]:
        text = line.split(" < ", 1)[1]
        if text == "ok":
            return found
        if not text.startswith("! "):
            found.append(text)
    raise AssertionError(f"{command} was not answered")


def events(lines: list[str], words: str) -> list[str]:
    """Those whose code has one of the words, with their plant time."""
    told = [line.split("! ", 1)[1] for line in lines if "< ! " in line]
    return [event for event in told if re.search(words, event.split()[2])]


def place(x: str) -> int:
    """Index of a float among all floats in order: neighbours are 1 apart. What the console prints reads back as the same float."""
    bits = struct.unpack("<i", struct.pack("<f", float(x)))[0]
    return bits if bits >= 0 else -(bits & 0x7FFFFFFF)


def numbers(lines: list[str]) -> dict[tuple[str, str, str], list[str]]:
    """Gain, T, L and their deviations of each element, and the results of moments and plateaus."""
    return {(m[1], m[2], m[3]): re.findall(r"(?<= )-?\d[\d.e+-]*(?= |$)", m[4])
            for line in reply(lines, "commission model") if (m := re.match(r"(element|moments) (\S+) (\S+) (.*)", line))}


def stats(lines: list[str], name: str, what: str) -> int:
    for line in reply(lines, "stats"):
        words = line.split()
        if words[0] == name and what in words:
            return int(words[words.index(what) + 1])
    raise AssertionError(f"stats say nothing of {name} {what}")


class StartUpOnTheBoard(unittest.TestCase):
    def same_as_on_the_host(self, host: list[str], emulator: list[str], results: tuple[str, ...]) -> str:
        """Every line, and so every bit of every number."""
        ours, theirs = numbers(emulator), numbers(host)
        count = sum(kind == "element" for kind, _, _ in theirs)
        self.assertGreater(count, 0)
        self.assertEqual(ours.keys(), theirs.keys())
        apart = [abs(place(x) - place(y)) for key in theirs for x, y in zip(ours[key], theirs[key], strict=True)]
        self.assertEqual(max(apart), 0, "in units of the last place")
        for command in results:
            self.assertTrue(reply(host, command))
            self.assertEqual(reply(host, command), reply(emulator, command), command)
        self.assertGreaterEqual(len(apart), 6 * count)
        return f"{count} elements, {len(apart)} numbers, at most {max(apart)} units of the last place apart"

    def whole_start_up(self, on_host: str, *kinds: str) -> None:
        of = plant("wood-berry")
        # By the clock: a line that waits for an event is sent a sample sooner or later.
        waiting = whole(of)
        script = [(t, line) for t, line in waiting[:waiting.index((300.0, "commission begin")) + 1]]
        script += [(60000.0, "commission accept"), (120000.0, "commission")]
        results = (*RESULTS, "commission trial")
        script += [(120000.0, command) for command in results] + [(120000.0, "~end")]
        host, *runs = (said(kind, of, script, "--noise", "1", "--seed", "3") for kind in (on_host, *kinds))
        told = events(host, "TEST|PROPOSAL|TRIAL")
        self.assertTrue(any("TRIAL_KEPT" in event for event in told))
        for kind, lines in zip(kinds, runs, strict=True):
            model = self.same_as_on_the_host(host, lines, ("commission", *results))
            self.assertEqual(events(lines, "TEST|PROPOSAL|TRIAL"), told)
            print(f"commission wood-berry on {kind}, from test to trial: {model}; {len(told)} events at the same samples")

    def test_the_model_of_a_whole_start_up_is_the_hosts_to_the_last_bit(self):
        self.whole_start_up("host", "stm32f405", *(["board-stm32f405"] if sample.EVERY else []))

    @unittest.skipUnless(sample.EVERY, "the fixed-point image of this board: with the argument `all`")
    def test_so_it_is_in_fixed_point(self):
        self.whole_start_up("host-fixed", "stm32f405-fixed", "board-stm32f405-fixed")

    def print_work(self, name: str, emulator: list[str]) -> None:
        longest, thousands = stats(emulator, "work", "max"), stats(emulator, "work", "thousands")
        self.assertLess(longest, WORK_BUDGET)
        print(f"{name}, background: {stats(emulator, 'work', 'n')} pieces, longest {longest} instructions of {WORK_BUDGET}, all "
              f"together {thousands / 1000:.0f} million ({thousands / 1000 / CLOCK_MHZ:.1f} s of {CLOCK_MHZ} MHz at one a cycle)")

    @unittest.skipUnless(sample.EVERY, "half a minute: with the argument `all`")
    def test_the_work_of_four_by_four_is_counted(self):
        emulator = said("stm32f405", plant("luyben-4x4"), whole(plant("luyben-4x4"), accept=False, after=["stats"]), "--noise", "1",
                        extra=ICOUNT)
        self.assertEqual(len(events(emulator, "PROPOSAL")), 1)
        self.print_work("commission 4 x 4", emulator)

    @unittest.skipUnless(sample.EVERY, "half a minute: with the argument `all`")
    def test_sixteen_by_sixteen_is_the_hosts_too_and_fits(self):
        of = Plant(SIXTEEN)
        short = ["set test.window 16", *(f"set mv{k}.test_time 128" for k in range(1, 17)),
                 *(f"set mv{k}.test_step 4" for k in range(1, 17))]
        # To the end of the tests, and into the trial: its first ticks put 16 loops into automatic.
        in_acceptance = ["commission structure", "commission accept", "~until TRIAL_BEGUN", *["commission"] * 10, "stats",
                    "commission abort", "~until TRIAL_FAILED"]
        script = whole(of, settings=short, accept=False, after=in_acceptance)
        host = said("host", of, script, "--noise", "1")
        emulator = said("stm32f405", of, script, "--noise", "1", extra=ICOUNT)
        model = self.same_as_on_the_host(host, emulator, RESULTS)
        self.assertEqual(*(events(lines, "TEST|PROPOSAL") for lines in (host, emulator)))
        tested = {event.split()[3] for event in events(emulator, "TEST_DONE")}
        self.assertEqual(tested, {f"u{k}" for k in range(1, 17)})
        proposal = reply(emulator, "commission proposal")
        self.assertEqual(sum(line.startswith("loop ") for line in proposal), 16)
        self.assertIn("decoupler none: too many loops for a decoupler", proposal)
        print(f"commission 16 x 16, model: {model}")

        worst, mean = stats(emulator, "tick", "max"), stats(emulator, "tick", "mean")
        unused = stats(emulator, "memory", "stack_unused")
        self.assertEqual(stats(emulator, "console", "events_lost"), 0)
        self.assertLess(worst, TICK_BUDGET)
        self.assertGreater(unused, STACK_LEFT)
        print(f"commission 16 x 16, ticks: {stats(emulator, 'tick', 'n')}, {mean} instructions on average, worst {worst} "
              f"({worst / CLOCK_MHZ / 1000:.2f} ms of {CLOCK_MHZ} MHz at one a cycle) of {TICK_BUDGET}")
        self.print_work("commission 16 x 16", emulator)
        print(f"commission 16 x 16, stack: {unused} of {stats(emulator, 'memory', 'stack_bytes')} bytes never used")


if __name__ == "__main__":
    unittest.main()
