"""What tools/console --watch shows, and the line that is typed below it."""

import os
import time
import unittest
from unittest import mock

import support  # noqa: F401  puts tools/ on the path

from reflux import session
from reflux.line_editor import LineEditor
from reflux.watch import Watch, event_words
from reflux.watch_state import BoardState

HEADER = "H,1,number,time[s],state,ev,T1[degC],T1.q,T2[degC],T2.q,top.mode,top.sp[degC],Lr.cmd[l/h],Lr.app[l/h],Qrb.cmd[kW],Qrb.app[kW],stat.tick"
ROW = "T,1,7,3725.000,1,4,87.123456,0,88.2,2,1,87.8,4.51,4.4987654,0.8,0.75,10"
LIST = ["meas1.name = T1", "loop1.name = top", "loop1.pv = T1", "loop1.out = Lr", "loop2.name = -"]


def state() -> BoardState:
    found = BoardState()
    found.telemetry(HEADER)
    found.telemetry(ROW)
    found.configuration(LIST)
    return found


class State(unittest.TestCase):
    def test_loops_come_first_then_the_rest_then_alarms_in_four_digits(self) -> None:
        found = state()
        found.alarms = ["T2.bad raised"]
        self.assertEqual(found.lines(80), ["plant time 1:02:05, run",
                                           "loop  mode  PV / SP               output",
                                           "top   auto  T1 87.12 / 87.8 degC  Lr 4.499 l/h",
                                           "T2 88.2 degC (bad), Qrb 0.75 kW",
                                           "ALARM  T2.bad raised"])
        self.assertEqual(max(map(len, found.lines(20))), 20)

    def test_the_safe_state_and_a_missing_plant_are_said(self) -> None:
        self.assertIn("no telemetry yet", BoardState().lines(80)[0])
        found = state()
        found.telemetry(ROW.replace(",1,4,", ",0,4,"))
        self.assertIn("SAFE STATE", found.lines(80)[0])

    def test_a_board_that_has_restarted_shows_no_row_of_before(self) -> None:
        watch = Watch(Talk(), Said())  # type: ignore[arg-type]
        watch.state = state()
        watch.line("! 0.000 info started in the safe state: requested (STARTED)")
        self.assertIn("no telemetry yet", watch.state.lines(80)[0])
        self.assertIn(" log on", watch.waiting)

    def test_a_damaged_row_changes_nothing(self) -> None:
        found = state()
        for row in ("T,1,8,3726", ROW.replace("87.123456", "87.1x")):
            found.telemetry(row)
        self.assertEqual(found.lines(80), state().lines(80))

    def test_numbers_of_an_event_have_four_digits_and_its_words_stay(self) -> None:
        self.assertEqual(event_words("60.000", "warning", "NOT_FOLLOWING Qrb 0.75733340 output 1.23456"), "60 s  warning  NOT_FOLLOWING Qrb 0.7573 output 1.235")
        self.assertEqual(event_words("60.000", "info", "MODE top 1 loop is in auto"), "60 s  info  MODE top 1 loop is in auto")


class Talk:
    def __init__(self) -> None:
        self.sent: list[str] = []

    def write(self, text: str) -> None:
        self.sent.append(text)


class Said:
    def __init__(self) -> None:
        self.lines: list[str] = []

    def say(self, line: str) -> None:
        self.lines.append(line)


class Replies(unittest.TestCase):
    def setUp(self) -> None:
        self.talk, self.said = Talk(), Said()
        self.watch = Watch(self.talk, self.said)  # type: ignore[arg-type]

    def test_what_the_person_asked_is_shown_and_what_the_tool_asked_is_not(self) -> None:
        self.watch.ask("list")
        self.watch.typed("get tick.base")
        for line in (*LIST, "ok", "tick.base = 30 s", "ok"):
            self.watch.line(line)
        self.assertEqual(self.said.lines, ["> get tick.base", "tick.base = 30 s", "ok"])
        self.assertEqual(self.watch.state.loops, [("top", "T1", "Lr")])

    def test_prompts_echoes_and_cleared_lines_of_human_mode_are_left_out(self) -> None:
        self.watch.ask("list")
        self.watch.typed("status")
        for line in ("> list", *LIST, "ok", "> sta\r\x1b[K! 480.000 info bottom setpoint 108 degC", "> status", f"\r\x1b[K{HEADER}", f"\x1b[K{ROW}", "state run", "ok"):
            self.watch.line(line)
        self.assertEqual(self.said.lines, ["> status", "480 s  info  bottom setpoint 108 degC", "state run", "ok"])
        self.assertEqual(self.watch.state.loops, [("top", "T1", "Lr")])
        self.assertIn("T1 87.12", self.watch.state.lines(80)[2])

    def test_an_echo_without_a_prompt_is_left_out(self) -> None:
        self.watch.typed("save")
        self.watch.typed("status")
        for line in ("> save", "status", "ok", "state run", "ok"):
            self.watch.line(line)
        self.assertEqual(self.said.lines, ["> save", "> status", "ok", "state run", "ok"])

    def test_a_new_configuration_is_read_in_either_mode(self) -> None:
        for line in ("! 0.000 info CONFIG_APPLIED - 10 configuration applied; base tick, s", "! 0.000 info configuration applied, base tick 10 s"):
            watch = Watch(talk := Talk(), Said())  # type: ignore[arg-type]
            watch.line(line)
            self.assertIn("list", talk.sent)

    def test_an_event_is_shown_and_the_alarms_are_asked_for_once(self) -> None:
        for _ in range(2):
            self.watch.line("! 10.000 alarm INTERLOCK_ON Qrb 121.5 interlock holds its output")
        self.assertEqual(self.talk.sent, ["alarm"])
        self.watch.line("T10.hi active")
        self.watch.line("ok")
        self.assertEqual(self.watch.state.alarms, ["T10.hi active"])
        self.assertEqual(len(self.said.lines), 2)

    def test_a_key_is_not_shown(self) -> None:
        self.watch.typed("unlock secret")
        self.assertEqual((self.said.lines, self.talk.sent), (["> unlock ***"], ["unlock secret"]))


class Board:
    """Its line editor, as firmware/console has it: echo, and a tab that completes a few words or shows the choices."""

    WORDS = ("mode ", "measure ", "set loop2.gain ", "set loop2.gate ", "set meas1.name ")

    def __init__(self) -> None:
        self.typed, self.came, self.sent = "", b"> ", b""

    def write(self, data: bytes) -> bytes:
        self.sent += data
        for key in data.decode():
            if key == "\t":
                found = [word for word in self.WORDS if word.startswith(self.typed)]
                agreed = os.path.commonprefix(found) or self.typed
                if len(found) > 1 and agreed == self.typed:
                    self.came += f"\r\n{'  '.join(word.split()[-1] for word in found)}  \r\n> {agreed}".encode()
                self.came += agreed[len(self.typed):].encode()
                self.typed = agreed
            elif key == "\x15":
                self.came += b"\b" * len(self.typed) + b"\x1b[K"
                self.typed = ""
            else:
                self.typed += key
                self.came += key.encode()
        return b""

    def read(self, _patience_s: float = 0.0) -> bytes:
        came, self.came = self.came, b""
        time.sleep(0.01)
        return came


class Tab(unittest.TestCase):
    def setUp(self) -> None:
        self.board, self.said = Board(), Said()
        with mock.patch.object(session.Session, "machine_mode"):
            self.talk = session.Session(self.board)  # type: ignore[arg-type]
        self.watch = Watch(self.talk, self.said)  # type: ignore[arg-type]

    def after(self, keys: bytes) -> str:
        self.watch.editor.feed(b"\x15" + keys)
        return self.watch.editor.text

    def test_the_board_completes_and_its_line_is_taken_back(self) -> None:
        self.assertEqual(self.after(b"mo\t"), "mode ")
        self.assertEqual((self.board.sent, self.board.typed, self.said.lines), (b"mo\t\x15", "", []))
        self.assertEqual(self.after(b"set lo\t"), "set loop2.ga")

    def test_choices_are_shown_once_and_are_no_part_of_a_reply(self) -> None:
        self.assertEqual(self.after(b"m\t"), "m")
        self.assertEqual(self.said.lines, ["mode  measure  "])
        self.assertEqual(self.watch.reply, [])
        for _ in range(2):  # the echo of the second one has no prompt before it
            self.assertEqual(self.after(b"set loop2.ga\t"), "set loop2.ga")
        self.assertEqual(self.said.lines[1:], ["loop2.gain  loop2.gate  "] * 2)

    def test_what_the_tool_asks_meanwhile_waits_for_the_line_to_be_taken_back(self) -> None:
        self.board.came = b"! 10.000 alarm INTERLOCK_ON Qrb 121.5 interlock holds its output\r\n> "
        self.assertEqual(self.after(b"mo\t"), "mode ")
        self.assertEqual(self.board.sent, b"mo\t\x15alarm\n")
        self.assertEqual(self.said.lines, ["10 s  alarm  INTERLOCK_ON Qrb 121.5 interlock holds its output"])

    def test_a_key_is_not_sent_and_a_board_that_does_not_answer_changes_nothing(self) -> None:
        self.assertEqual(self.after(b"unlock secret\t"), "unlock secret")
        self.assertEqual(self.board.sent, b"")
        with mock.patch.object(self.board, "read", lambda _patience_s: b""), mock.patch("reflux.watch_completion.PATIENCE_S", 0.3):
            self.assertEqual(self.after(b"mo\t"), "mo")


class Typing(unittest.TestCase):
    def test_keys_make_lines(self) -> None:
        for keys, lines, left in ((b"status\r", ["status"], ""), (b"statsu\x7f\x7fus\n", ["status"], ""), (b"abc def \x17x", [], "abc x"),
                                  (b"abc\x15d", [], "d"), (b"\r\r", [], ""), (b"a\x1b[Cb\xff", [], "ab")):
            with self.subTest(keys):
                editor = LineEditor()
                self.assertEqual((editor.feed(keys), editor.text, editor.left), (lines, left, False))

    def test_the_arrow_keys_bring_back_lines_even_where_their_code_comes_in_parts(self) -> None:
        editor = LineEditor()
        editor.feed(b"one\rtwo\rtwo\r")
        editor.feed(b"\x1b")
        editor.feed(b"[A")
        self.assertEqual(editor.text, "two")
        editor.feed(b"\x1b[A\x1b[A")
        self.assertEqual(editor.text, "one")
        editor.feed(b"\x1b[B\x1b[B")
        self.assertEqual(editor.text, "")

    def test_three_keys_leave(self) -> None:
        for key in (b"\x03", b"\x04", b"\x1d"):
            editor = LineEditor()
            editor.feed(b"half" + key + b"more\r")
            self.assertTrue(editor.left)


if __name__ == "__main__":
    unittest.main()
