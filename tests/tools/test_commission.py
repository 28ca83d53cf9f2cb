"""tools/commission without a board: what is refused before one is looked for, what the board's lines mean, and the report
of a folder. tests/loop/test_commission_tool.py has the rest."""

import contextlib
import io
import math
import os
import unittest
from pathlib import Path
from types import SimpleNamespace
from unittest import mock

from support import FolderTest, call

from reflux import cmd_commission, session
from reflux.commission import answers, answers_board, answers_file, board, dialogue, figures, next_steps, progress, record, results, results_text, startup
from reflux.commission.answers import Room, Wrong
from reflux.errors import RunFailed, UserError
from reflux.session import Refused

PLANT = ["plant tick s 60 name oven", "measurement T unit degC lo 0 hi 200", "measurement x unit - lo 0 hi 1",
         "output h unit kW lo 0 hi 4 safe 0", "output c unit l/h lo 0 hi 10 safe 5"]
PARAMETERS = {"test.guard": "model", "test.blank": "0", "test.noise": "20", "test.window": "30", "test.longest": "0",
              "test.confidence": "0.975", "test.rounds": "4", "test.pairs": "found",
              "test.probe": "1.5"}
ROOM = Room(16, 4, {"blank": (0, 1e5), "noise": (2, 1000), "window": (10, 1000), "longest": (0, 1e6),
                    "confidence": (0.5, 0.9999), "rounds": (1, 16), "probe": (0, 2)})
SAFE = board.State(True, "ready", 0.0, False, False, {}, {})

MODEL = ["input h held 1 amplitude 0.2 kW half 600 s rounds 1 worst 0.25",
         "input c held 5 amplitude 0 l/h half 0 s rounds 0 worst 0 skipped",
         "output T noise 0.05 degC",
         "element T h gain 20 sd 0.1 degC/kW T 100 sd 2 s L 0 sd 1 s flags -",
         "moments T h gain 19 T 90 L 3 plateau 20 flags negative_L short"]
LISTINGS = {
    "model": MODEL,
    "gains": ["rank 1 exact 1 condition 1 scaled 1", "singular 0.4", "rga h", "rga T 1"],
    "pairing": ["pairing determined probability 1 niederlinski 1", "pair T h lambda 1 share 1"],
    "structure": ["structure parts 1 blocks 1", "block number 1 part 1 pairs 1 worst_lambda 1 driven_by -",
                  "member T h block 1 single_loop yes"],
    "proposal": ["settings SIMC, slowed by 1 log_modulus_dB 2 blocks 1 parts 1", "decoupler none: single loops are enough",
                 "loop T h gain 2 ti 100 td 0 reverse step 10 iae 500 overshoot 0.1 settles 400"],
    "trial": ["trial T h step -10 iae 520 predicted 500 overshoot 0.08 predicted 0.1"],
}


def oven() -> answers.Answers:
    plant = board.plant_of(PLANT)
    assert plant is not None
    return answers_board.defaults(plant, PARAMETERS, SAFE, {"h": 1.0, "c": 5.0}, ROOM)


class Commands(FolderTest):
    def test_what_is_asked_for_wrongly_gets_one_line(self) -> None:
        (self.folder / "empty").mkdir()
        for arguments, told in (
            ([], "which board? PORT, or --plant NAME"),
            (["/dev/ttyUSB9", "--plant", "pilot"], "which board?"),
            (["/dev/ttyUSB9", "--speed", "3"], "--speed goes with --plant"),
            (["/dev/ttyUSB9", "--yes", "--file", "x.toml"], "--file has the answers, --yes takes the defaults"),
            (["--plant", "pilot", "--speed", "0"], '--speed is "0"'),
            (["--plant", "pilot", "--tick", "nan"], "--tick is nan"),
            (["--plant", "pilot", "--noise", "-1"], "--noise is -1.0; it must be 0 or more"),
            (["--plant", "none.json", "--no-build"], "none.json: No such file"),
            (["--plant", "pilot", "--file", str(self.folder / "none.toml")], "cannot be read"),
            (["/nonexistent", "--yes"], "there is no /nonexistent"),
            (["--report", str(self.folder)], "holds no transcript.txt; is it the --out of a start-up?"),
            (["--report", str(self.folder), "--plant", "pilot"], "it does not go with --plant"),
        ):
            with self.subTest(arguments):
                out = [] if "--report" in arguments else ["--out", str(self.folder / "out")]
                status, _out, err = call("commission", *arguments, *out)
                self.assertEqual(status, 2, err)
                self.assertIn(told, err)
                self.assertEqual(err.count("\n"), 1)


class Folders(FolderTest):
    def test_the_files_of_a_start_up_that_began_are_kept_once_another_comes(self) -> None:
        for begun, plots in (("! 60 COMMISSION_BEGUN", 2), ("nobody said yes", 1), ("! 90 COMMISSION_BEGUN", 1)):
            (self.folder / "transcript.txt").write_text(begun, encoding="utf-8")
            for n in range(plots):
                (self.folder / f"plot-{n}.png").write_text(begun, encoding="utf-8")
            cmd_commission.set_aside(self.folder)
            self.assertEqual([f.name for f in self.folder.iterdir()], ["before"])
            kept = {f.name: f.read_text(encoding="utf-8") for f in (self.folder / "before").iterdir()}
            if "90" in begun:
                self.assertEqual(kept, {"transcript.txt": begun, "plot-0.png": begun})
            else:
                first = "! 60 COMMISSION_BEGUN"
                self.assertEqual(kept, {"transcript.txt": first, "plot-0.png": first, "plot-1.png": first})


class Lines(unittest.TestCase):
    def test_the_plant_as_announced(self) -> None:
        plant = board.plant_of(PLANT)
        self.assertEqual((plant.name, plant.tick_s), ("oven", 60.0))
        self.assertEqual([c.name for c in plant.measurements], ["T", "x"])
        self.assertEqual(plant.inputs[1], board.Channel("c", "l/h", 0.0, 10.0, 5.0))
        self.assertIsNone(board.plant_of(["no plant is connected"]))

    def test_older_records_call_measurements_outputs_and_outputs_inputs(self) -> None:
        old = [line.replace("output", "input").replace("measurement", "output") for line in PLANT]
        self.assertEqual(old[1:4:2], ["output T unit degC lo 0 hi 200", "input h unit kW lo 0 hi 4 safe 0"])
        self.assertEqual(board.plant_of(old), board.plant_of(PLANT))

    def test_status(self) -> None:
        state = board.state_of(["state run, plant link ready oven, plant time 240.000 s, base tick 60 s ticks 5, "
                                "transaction open, storage empty", "T = 20.5 degC good", "x = nan - missing", "h = 1 kW"])
        self.assertEqual((state.safe, state.link, state.plant_s, state.open_transaction), (False, "ready", 240.0, True))
        self.assertEqual((state.values["h"], state.good["T"], state.good["x"]), (1.0, True, False))

    def test_a_plant_at_the_pins_of_the_board_is_there(self) -> None:
        for link in ("", "plant link down, ", "plant link ready oven, "):
            state = board.state_of([f"state run, plant at the board's pins, {link}plant time 7.000 s, base tick 1 s ticks 5, storage ok"])
            self.assertEqual((state.safe, state.link, state.plant_s), (False, "ready", 7.0))

    def test_progress(self) -> None:
        p = board.progress_of(["phase testing, outputs 2, inputs 2, plant time s 1140.000",
                               "input h (1 of 2), round 1: back, waits for rest, amplitude 0.2 kW, worst T at 0.25 of "
                               "its limit"])
        self.assertEqual((p.phase, p.plant_s, p.input, p.number, p.total, p.round), ("testing", 1140.0, "h", 1, 2, 1))
        self.assertEqual((p.stage, p.amplitude, p.worst), ("back, waits for rest", "0.2 kW", ("T", 0.25)))
        self.assertEqual(board.progress_of(["phase idle"]).phase, "idle")
        with self.assertRaises(RunFailed):
            board.progress_of(["something else"])

    def test_how_long_it_may_still_take_is_told_in_words(self) -> None:
        p = board.progress_of(["phase fitting, outputs 2, inputs 2, plant time s 1140.000",
                               "left about 5400 s of this round, 90000 s if all rounds are needed"])
        self.assertEqual(progress.status_words(p), "19 min  fitting; left about 90 min of this round, 25 h 00 min if all rounds "
                         "are needed")

    def test_a_first_step_and_the_most_that_the_next_test_may_reach_are_not_taken_for_each_other(self) -> None:
        """firmware/commission: a test begins with the amplitude of TEST_STEP and grows; TEST_SMALLER names the most of the test that follows."""
        self.assertEqual([progress.in_words(board.Event(60.0, "info", code, "h", share, ""), oven()) for code, share in
                          (("TEST_STEP", 0.02), ("TEST_SMALLER", 0.1))],
                         ["h: at rest; step of 0.08 kW to begin with", "h: the steps grew too large; testing again with steps up to about 0.4 kW"])

    def test_listings(self) -> None:
        m = results.model_of(MODEL)
        e = m.elements["T", "h"]
        self.assertEqual((e.gain, e.gain_sd, e.time_s, e.time_sd_s, e.dead_s, e.dead_sd_s, e.unit),
                         (20.0, 0.1, 100.0, 2.0, 0.0, 1.0, "degC/kW"))
        self.assertEqual((e.moments, e.plateau, e.moments_flags), ((19.0, 90.0, 3.0), 20.0, ["negative_L", "short"]))
        self.assertEqual((m.tested(), m.inputs[1].remarks, m.noise), (["h"], "skipped", {"T": (0.05, "degC")}))
        g = results.gains_of(["rank 1 exact 2 condition 900 scaled 800", "singular 1 0.001", "null inputs a 0.7 b -0.7",
                              "null outputs y 1 z 0.01", "rga none: the gains have no inverse"])
        self.assertEqual((g.rank, g.rank_exact, g.null_inputs, g.rga), (1, 2, {"a": 0.7, "b": -0.7}, {}))
        self.assertIn("a 0.70, b -0.70", results_text.gains_words(g)[1])
        p = results.pairing_of(["pairing not determined: within error, inputs act alike probability 0.4 niederlinski 0",
                                "open y share 0.4 rival b"])
        self.assertEqual((p.verdict, p.probability, p.open), ("not determined: within error, inputs act alike", 0.4,
                                                              [("y", 0.4, "b")]))
        self.assertFalse(p.determined)
        p = results.pairing_of(["doubt element y b flags oscillatory",
                                "doubt element y a half 400 s needs 9600 s flags short not_settled"])
        self.assertEqual(p.doubts, ["y by b is oscillatory: no loop is made of it",
                                    "y by a is short, not_settled: half a double step of a took 7 min, and must take 2 h 40 min "
                                    "or more (`time`, `longest`)"])
        s = results.structure_of(["structure parts 1 blocks 2", "block number 1 part 1 pairs 1 worst_lambda 1 driven_by -",
                                  "block number 2 part 1 pairs 1 worst_lambda 1 driven_by 1",
                                  "member y a block 1 single_loop yes",
                                  "member z b block 2 single_loop no",
                                  "way from y a to z b gain -0.5 lead 100 lag 50 dead 3 late 0"])
        words = " ".join(results_text.structure_words(s))
        for told in ("block 2: z by b", "single loops will not serve z well", "disturbed by block 1",
                     "feedforward from a to b would be -0.5"):
            self.assertIn(told, words)
        self.assertEqual(results.trial_of(LISTINGS["trial"]), [results.TrialLoop("T", "h", -10.0, 520.0, 500.0, 0.08, 0.1)])


class Next(unittest.TestCase):
    """Advice of a start-up that has determined nothing."""

    def lines(self, said: list[str], known: list[tuple[str, str]] = [], **parameters: str) -> list[str]:
        have = {f"loop1.{name}": value for name, value in parameters.items()}
        return next_steps.lines(results.model_of(MODEL), results.pairing_of(said), known, have, 4)

    def test_longer_tests_are_asked_for_with_their_time(self) -> None:
        words = "\n".join(self.lines(["doubt element T h half 400 s needs 800 s flags short",
                                      "doubt element x h half 400 s needs 9600 s flags not_settled"]))
        self.assertIn("`[input.h]`, `time = 9600` (2 h 40 min) or more", words)
        self.assertNotIn("800", words)
        self.assertIn('`[known]`, `pairs = [["MEASUREMENT", "INPUT"]]`', words)

    def test_larger_steps_are_asked_for_where_rivals_are_open(self) -> None:
        self.assertIn("Make T surer: larger steps (`step`), more `rounds`",
                      "\n".join(self.lines(["pair T h lambda 0.5 share 0.6", "open T share 0.6 rival c"])))

    def test_a_relay_test_of_the_likeliest_pair_is_given_as_lines_of_the_console(self) -> None:
        said = self.lines(["pair T h lambda 0.5 share 0.6"], name="other", pv="x", out="c")
        self.assertEqual([line.strip() for line in said if line.startswith("    ")],
                         ["begin", "set loop2.name T", "set loop2.pv T", "set loop2.out h", "set loop2.action reverse", "apply",
                          "commission relay T", "commission accept"])

    def test_a_pair_that_was_stated_and_has_a_loop_keeps_it(self) -> None:
        said = self.lines([], [("T", "h")], name="top", pv="T", out="h")
        self.assertIn("    commission relay top", said)
        self.assertNotIn("    set loop1.pv T", said)
        self.assertFalse(any("[known]" in line for line in said))


class Kept(FolderTest):
    def written(self, *notes: str) -> tuple[str, str]:
        transcript = board.Transcript(self.folder)
        for note in notes:
            transcript.write(note + "\n")
        transcript.close()
        return (self.folder / "transcript.txt").read_text(), (self.folder / "telemetry.csv").read_text()

    def test_the_key_is_not(self) -> None:
        transcript = board.Transcript(self.folder)
        with mock.patch.object(session.Session, "machine_mode"):
            talk = session.Session(mock.Mock(write=lambda data: b""), transcript)
        talk.write("unlock secret")
        transcript.close()
        self.assertEqual((self.folder / "transcript.txt").read_text(), "0.000 > unlock ***\n")

    def test_every_line_bears_the_plant_time(self) -> None:
        said, _rows = self.written("> log on", "< ! 90.000 info OUTPUT h 1 new manual output", "> status")
        self.assertEqual(said, "0.000 > log on\n90.000 < ! 90.000 info OUTPUT h 1 new manual output\n90.000 > status\n")

    def test_rows_that_came_damaged_are_not(self) -> None:
        header, row = "H,1,number,time[s],T[degC]", "T,1,7,70.000,20.5"
        _said, rows = self.written(f"< {row}", f"< {header}", f"< {row}", "< T,1,8,80.0", "< T,1,9,9x.000,20.5", "< T,", "< T,1,,,")
        self.assertEqual(rows, "number,time[s],T[degC]\n7,70.000,20.5\n")

    def test_telemetry_becomes_one_table_however_often_its_header_changes(self) -> None:
        _said, rows = self.written("< H,1,number,time[s],T[degC]", "< T,1,7,70.000,20.5", "< H,1,number,time[s],T[degC],h.cmd[kW]", "< T,1,8,80.000,21,3")
        self.assertEqual(rows, "number,time[s],T[degC],h.cmd[kW]\n7,70.000,20.5,\n8,80.000,21,3\n")


class Answers(FolderTest):
    def test_defaults_follow_what_is_announced(self) -> None:
        a = oven()
        self.assertEqual((a.channel("T").values["limit"], a.channel("h").values["max"], a.channel("h").values["at"]),
                         (40.0, 4.0, 1.0))
        a.channel("T").change({"hi": 100.0})
        a.channel("h").change({"hi": 3.0})
        self.assertEqual((a.channel("T").values["limit"], a.channel("h").values["max"]), (20.0, 3.0))
        a.channel("T").change({"limit": 5.0})
        a.channel("T").change({"hi": 300.0})
        self.assertEqual(a.channel("T").values["limit"], 5.0)  # what was given stays

    def test_the_first_step_is_told_as_the_board_makes_it(self) -> None:
        """firmware/commission/expected.c: 0.5 % of the input's span, or a hundredth of the smallest limit, in spans."""
        found = oven()
        self.assertEqual([line.split(",")[0] for line in dialogue.expectations(found)[:2]], ["h: +/-0.008 kW around 1", "c: +/-0.02 l/h around 5"])
        for channel in ("T", "x"):
            values = found.channel(channel).values
            values["limit"] = values["hi"] - values["lo"]
        self.assertEqual(dialogue.expectations(found)[0], "h: +/-0.02 kW around 1, growing to +/-1 at most")
        found.channel("x").values.update(limit=0.4, critical=True)
        self.assertEqual(dialogue.expectations(found)[1].split(",")[0], "c: +/-0.02 l/h around 5")

    def test_what_cannot_be_is_refused_and_changes_nothing(self) -> None:
        a = oven()
        for name, given, told in (
            ("T", {"limit": math.nan}, "a finite one"), ("T", {"limit": 0.0}, "more than 0"),
            ("T", {"lo": 200.0}, "lo must be below hi"),
            ("T", {"hi": 1e10}, "-1e+09 .. 1e+09"), ("T", {"tested": "perhaps"}, "yes or no"),
            ("h", {"at": 4.0}, "leaves no room to step both ways"), ("h", {"step": 1.5}, "up to 1 kW"),
            ("h", {"min": -1.0}, "0 .. 4 kW"), ("h", {"time": 0.0}, "more than 0"),
            ("h", {"time": True}, "a number in s or auto"),
            ("h", {"max": 3.0, "min": 3.0}, "min must be below max"), ("h", {"safe": 9}, "it must be 0 .. 4 kW"),
            ("h", {"limit": 1}, "h has no limit"), ("x", {"limit": 2}, "up to its span, 1 -"),
        ):
            with self.subTest(name=name, given=given):
                before = dict(a.channel(name).values)
                with self.assertRaises(Wrong) as raised:
                    a.channel(name).change(given)
                self.assertIn(told, str(raised.exception))
                self.assertEqual(a.channel(name).values, before)

    def test_what_is_known_has_so_much_room(self) -> None:
        a = oven()
        for m, i in (("T", "h"), ("T", "c"), ("x", "h"), ("x", "c")):
            a.add_known(m, i, 10.0)
        a.add_known("T", "h", 20.0)
        self.assertEqual(len(a.known), 4)
        a.known_room = 3
        with self.assertRaisesRegex(Wrong, "the board keeps 3 of these"):
            a.add_known("x", "c", 5.0)
        a.add_known("T", "h", 0.0, 0.0)
        self.assertEqual(len(a.known), 3)

    def test_only_what_differs_is_set(self) -> None:
        a = oven()
        a.channel("x").change({"tested": False})
        a.change_test("rounds", "2")
        lines = answers_board.set_lines(a, PARAMETERS, 16)
        self.assertIn("set meas1.name T", lines)
        self.assertIn("set mv2.safe 5", lines)
        self.assertIn("set test.rounds 2", lines)
        self.assertFalse(any("meas2" in line or "test.guard" in line or "pair" in line for line in lines))
        self.assertEqual(lines.count("set mv1.test_step 0"), 1)

    def test_known_pairs_are_set_on_the_board(self) -> None:
        for text in ('[known]\npairs = [["T", "h"]]\n', '[[known]]\nmeasurement = "T"\ninput = "h"\npair = true\n'):
            a = oven()
            a.channel("c").change({"at": 5})
            answers_file.read(self.file("pairs.toml", text), a)
            self.assertEqual(a.known_pairs(), [("T", "h")])
            lines = answers_board.set_lines(a, PARAMETERS, 16)
            self.assertIn("set pair1.meas T", lines)
            self.assertIn("set pair1.mv h", lines)
            self.assertIn("set test.pairs given", lines)

    def test_pairs_that_cannot_be_are_told_with_their_key(self) -> None:
        known = '[[known]]\nmeasurement = "T"\ninput = "h"\n'
        for text, told in (('[known]\npairs = [["T", "h"], ["x", "h"]]\n', "known.pairs: x h is not a pair: T h is one already"),
                           ('[known]\npairs = ["T", "h"]\n', 'known.pairs: give pairs, such as [["T", "h"]]'),
                           ('[known]\npairs = [["h", "T"]]\n', "known.pairs: h is not a measurement"),
                           ('[known]\npair = 1\n', "known.pairs: give pairs"),
                           (f'{known}time_s = 9\n{known.replace("T", "x")}pair = true\n', "T h is known, and is not a pair")):
            with self.assertRaises(UserError) as caught:
                a = oven()
                a.channel("c").change({"at": 5})
                answers_file.read(self.file("pairs.toml", text), a)
            self.assertIn(told, str(caught.exception))

    def test_a_file_gives_the_same_answers_again(self) -> None:
        a, b = oven(), oven()
        a.channel("T").change({"limit": 5.0, "critical": True})
        a.channel("h").change({"step": 0.3, "min": 0.25})
        a.add_known("T", "c", 30.0, -2.0, True)
        a.change_test("guard", "line")
        a.edits["loop1.gain"] = "0.5"
        answers_file.read(self.file("answers.toml", answers_file.text(a)), b)
        self.assertEqual(answers_file.text(b), answers_file.text(a))


class Reports(FolderTest):
    """A test of 20 samples before, 30 up, 30 down, 60 after, then a trial, of an element of 20 degC/kW and 100 s."""

    def setUp(self) -> None:
        super().setUp()
        self.enterContext(mock.patch.dict(os.environ, {"REFLUX_BUILD_ROOT": str(self.folder / "nothing")}))

    def record(self, *events: str, phase: str = "kept") -> None:
        rows = ["H,1,number,time[s],state,ev,T[degC],T.q,T.mode,T.sp[degC],h.cmd[kW],h.app[kW],stat.tick"]
        y, u = 20.0, 1.0
        for k in range(180):
            u = 1.2 if 20 <= k < 50 else 0.8 if 50 <= k < 80 else 1.0
            rows.append(f"T,1,{k},{10 * k}.000,1,0,{y:.6f},0,0,20,{u},{u},0")
            y += (20.0 + 20.0 * (u - 1.0) - y) * (1 - math.exp(-0.1))
        (self.folder / "telemetry.csv").write_text("\n".join(rows) + "\n")
        lines = ["0.000 > list", "0.000 < meas1.name = T", "0.000 < meas1.unit = degC", "0.000 < meas1.lo = 0 EU",
                 "0.000 < meas1.hi = 200 EU", "0.000 < meas1.test_limit = 8 EU", "0.000 < mv1.name = h",
                 "0.000 < mv1.unit = kW",
                 "0.000 < mv1.lo = 0 EU", "0.000 < mv1.hi = 4 EU", "0.000 < ok",
                 "0.000 > commission plant", *(f"0.000 < {line}" for line in PLANT), "0.000 < ok"]
        lines += [f"{event.split()[1]} < {event}" for event in events]
        for name, listing in LISTINGS.items():
            lines += [f"9 > commission {name}", *(f"9 < {line}" for line in listing), "9 < ok"]
        lines += ["9 > commission", f"9 < phase {phase}, outputs 1, inputs 1, plant time s 1000.000", "9 < ok"]
        (self.folder / "transcript.txt").write_text("\n".join(lines) + "\n")

    STEPPED = ("! 0.000 info COMMISSION_BEGUN - 1 begun", "! 200.000 info TEST_STEP h 0.05 test of this input",
               "! 500.000 info TEST_CUT T 0.05 test cut short")
    TESTED = (*STEPPED, "! 1400.000 info TEST_DONE h 300 input tested", "! 1410.000 info PROPOSAL - 1 pairing determined")
    KEPT = (*TESTED, "! 1420.000 info TRIAL_BEGUN - 1 on trial", "! 1790.000 info TRIAL_KEPT - 1 did as predicted")

    def test_a_test_and_its_model_lie_on_each_other(self) -> None:
        self.record(*self.KEPT)
        r = record.load(self.folder)
        (e,) = r.experiments
        self.assertEqual((e.input, e.first, e.step, e.last, e.done), ("h", 0, 20, 140, True))
        self.assertEqual(e.remarks, ["turned round: T would have gone 10 degC from rest"])
        self.assertEqual((r.channels["T"].limit, r.kept, r.outcome), (8.0, True, "1 loop kept: it matched the prediction"))
        import numpy as np
        t, u = np.array(r.time), np.array(r.column("h.cmd"))
        model = 20.0 + figures.response(t, u, r.model.elements["T", "h"])
        self.assertLess(float(np.max(np.abs(model - np.array(r.column("T"))))), 1e-4)

    def test_the_page_has_every_part_and_says_what_it_cannot_draw(self) -> None:
        self.record(*self.KEPT)
        status, _out, err = call("commission", "--report", str(self.folder))
        self.assertEqual((status, err), (0, ""))
        page = (self.folder / "report.html").read_text()
        for part in ("Start-up of oven", "loops kept", "<h2>Tests</h2>", "<h2>Model</h2>", "<h2>Interaction</h2>",
                     "T by h: when the other loops close", "0.04 kW per degC", "<h2>Trial</h2>", "a negative dead time came out, so its times mean nothing",
                     "gain margin",
                     "libreflux is not built"):
            self.assertIn(part, page)
        self.assertEqual(page.count("<figure>"), 4)  # all tests, this test, singular values, trial
        self.assertEqual(page.count("data:image/svg+xml;base64,"), 8)  # each of them wide and narrow
        self.assertIn('alt="Test of h, round 1: h from ', page)
        self.assertTrue((self.folder / "plot-test-h-1.png").is_file())

    def test_how_it_ended(self) -> None:
        for events, phase, kept, told in (
            (self.KEPT, "kept", True, "1 loop kept"),
            (self.TESTED, "idle", False, "the proposal was rejected"),
            (self.TESTED, "ready", False, "the proposal was not accepted"),
            ((*self.TESTED, "! 1420.000 alarm TRIAL_FAILED T 0.5 loops are taken back: overshot"), "returned", False,
             "rolled back: T overshot"),
            ((*self.STEPPED, "! 700.000 alarm COMMISSION_ENDED - 0 given up, inputs as before: asked for"), "ended", False,
             "ended: asked for"),
            (("! 0.000 info COMMISSION_BEGUN - 1 begun",), "testing", False, "it went no further than: testing"),
        ):
            with self.subTest(told):
                self.record(*events, phase=phase)
                r = record.load(self.folder)
                self.assertEqual(r.kept, kept)
                self.assertIn(told, r.outcome)
                figures.plots(r)

    def test_a_test_of_all_inputs_together_is_drawn_with_its_inputs(self) -> None:
        self.record(*(event.replace("TEST_STEP h", "TEST_STEP direction").replace("TEST_DONE h", "TEST_DONE direction") for event in self.KEPT))
        status, _out, err = call("commission", "--report", str(self.folder))
        self.assertEqual((status, err), (0, ""))
        page = (self.folder / "report.html").read_text()
        self.assertIn("Test of all inputs together, round 1: measured", page)
        self.assertIn('alt="Test of all inputs together, round 1: h from 0.8 to 1.2 kW; T from ', page)
        self.assertIn("1, of 1 input", page)
        self.assertTrue((self.folder / "plot-test-direction-1.png").is_file())

    def test_no_telemetry(self) -> None:
        self.record(*self.KEPT)
        (self.folder / "telemetry.csv").write_text("")
        status, _out, err = call("commission", "--report", str(self.folder))
        self.assertEqual((status, err.count("\n")), (1, 1))
        self.assertIn("no telemetry header", err)


class Workspace(unittest.TestCase):
    """An estimator of --conf has the workspace when the start-up is to begin."""

    def begin(self, conf: Path | None, kind: str = "composition") -> list[str]:
        asked: list[str] = []

        def ask(command: str) -> list[str]:
            asked.append(command)
            if command == "commission begin" and "block 2 free" not in asked[:-2]:  # freed at the next sample
                raise Refused("err BUSY workspace: composition has it; `block N free` frees it")
            return []

        fake = SimpleNamespace(ask=ask, events=[board.Event(1.0, "info", "COMMISSION_BEGUN", "-", 0.0, "")], new_events=list, listen=lambda _: None,
                               state=lambda: SimpleNamespace(plant_s=0.0), parameters=lambda: {"block1.kind": "column", "block2.kind": kind})
        run = startup.Startup(fake, startup.Options(None, True, None, Path("."), conf is not None, conf), {}, lambda: None)  # type: ignore[arg-type]
        with contextlib.redirect_stdout(io.StringIO()):
            run.begin()
        self.assertTrue(run.begun)
        return asked

    def test_it_gives_it_up_in_a_rehearsal_and_on_a_real_board_the_operator_decides(self) -> None:
        self.assertEqual(self.begin(Path("mine.conf")), ["commission begin", "block 2 free", "commission begin", "commission begin"])
        for conf, kind in ((None, "composition"), (Path("mine.conf"), "decoupler")):
            with self.assertRaisesRegex(RunFailed, "the board will not begin: err BUSY workspace: composition has it"):
                self.begin(conf, kind)


if __name__ == "__main__":
    unittest.main()
