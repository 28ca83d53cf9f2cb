"""Reading, joining and comparing logs."""

import re
import unittest
from unittest import mock

from support import FolderTest, call

from reflux import compare, logs, runner
from reflux.errors import RunFailed, UserError

SIM = "# made up\nnumber,time[s],T1.true[degC],Lr.applied[l/h]\n0,0,87.1,4.5\n1,30,87.2,4.6\n2,60,87.3,4.7\n"
TEL = ("H,1,number,time[s],T1[degC],stat.tick\nT,1,0,0.000,87.1,10\n"
       "H,1,number,time[s],T1[degC],top.sp[degC],stat.tick\nT,1,1,30.000,87.2,88,11\nT,1,2,60.000,87.3,88,12\n")


class Logs(FolderTest):
    def joined(self, sim: str = SIM, tel: str = TEL) -> logs.Log:
        return logs.join(logs.read_csv(self.file("s.csv", sim)), logs.read_telemetry(self.file("t.csv", tel)))

    def test_join(self) -> None:
        log = self.joined()
        self.assertEqual(log.columns[4:], ["fw.time[s]", "fw.T1[degC]", "fw.stat.tick", "fw.top.sp[degC]"])
        self.assertEqual(log.text("fw.top.sp"), ["", "88", "88"])
        path = self.folder / "log.csv"
        logs.write_csv(log, path)
        self.assertEqual(logs.read_csv(path).rows, log.rows)

    def test_telemetry_of_a_board_that_sampled_before_plant_time_joins_from_its_first_row(self) -> None:
        late = re.sub(r"(?m)^T,1,(\d),", lambda row: f"T,1,{int(row[1]) + 61},", TEL)
        whole = logs.join(*logs.at_pins(logs.read_csv(self.file("s.csv", SIM)), logs.read_telemetry(self.file("t.csv", late))))
        self.assertEqual(whole.rows, self.joined().rows)
        with self.assertRaisesRegex(RunFailed, "no telemetry row"):
            self.joined(tel=late)

    def test_a_board_whose_base_tick_is_three_ticks_of_the_plant_has_the_means_of_its_outputs(self) -> None:
        rows = "".join(f"{k},{10 * k},{k},{k % 3},{k % 3}\n" for k in range(7))
        simulated = logs.read_csv(self.file("s.csv", f"number,time[s],T1.true[degC],Lr.cmd[l/h],Lr.applied[l/h]\n{rows}"))
        telemetry = "H,1,number,time[s],T1[degC]\n" + "".join(f"T,1,{5 + k},{60 + 30 * k},0\n" for k in range(3))
        whole = logs.join(*logs.at_pins(simulated, logs.read_telemetry(self.file("t.csv", telemetry))))
        self.assertEqual(whole.text("time"), ["0", "30", "60"])
        self.assertEqual(whole.numbers("T1.true"), [0.0, 3.0, 6.0])
        self.assertEqual(whole.numbers("Lr.cmd"), [1.0, 1.0, 0.0])  # of the last row there is one tick
        self.assertEqual(whole.numbers("Lr.applied"), [0.0, 1.0, 1.0])

    def test_no_row_may_be_missing(self) -> None:
        with self.assertRaisesRegex(RunFailed, "no telemetry row for sample 1, 1 of 3 samples"):
            self.joined(tel=TEL.replace("T,1,1,30.000,87.2,88,11\n", ""))
        with self.assertRaisesRegex(RunFailed, "two telemetry rows for sample 2"):
            self.joined(tel=TEL + "T,1,2,60.000,87.3,88,12\n")
        with self.assertRaisesRegex(RunFailed, "telemetry rows for sample 3"):
            self.joined(tel=TEL + "T,1,3,90.000,87.3,88,12\n")

    def test_bad_files(self) -> None:
        for text, expected in ((SIM + "3,90\n", "s.csv:6: 2 fields, the header has 4"), ("", "empty"),
                               ("a,b\n1,2\n", "must begin with number")):
            with self.assertRaisesRegex(UserError, expected):
                logs.read_csv(self.file("s.csv", text))
        for text, expected in (("T,1,0\n", "before any header"), ("H,2,number\n", "telemetry of version 2"),
                               ("H,1,number,a\nT,1,0\n", "2 fields, the header has 3"), ("", "no telemetry header")):
            with self.assertRaisesRegex(RunFailed, expected):
                logs.read_telemetry(self.file("t.csv", text))

    # Rebuilt from public reports: a session of tools/console, in which ESC [ K wipes the prompt, and one that was copied from a screen.
    SESSIONS = {"session.log": "log on 1\n\x1b[KH,1,number,time[s],state,T1[degC],T1.q,Q1.cmd[%],Q1.app[%]\nok\n"
                               "> \x1b[KT,1,7,7.000,1,41.5,0,30,30\n> get T1\r\x1b[KT,1,8,8.000,1,41.6,0,30,30\n> \x1b[KT,1,9,9.0\n",
                "screen.txt": "> log on 1\n[KH,1,number,time[s],state,T1[degC],T1.q,Q1.cmd[%],Q1.app[%]\n> [KT,1,7,7.000,1,41.5,0,30,30\n"
                              "> [KT,1,8,8.000,1,41.6,0,30,30\n> [KT,1,9,9.000,1\n",
                "transcript.txt": "0.000 > log on\n0.000 < H,1,number,time[s],state,T1[degC],T1.q,Q1.cmd[%],Q1.app[%]\n0.000 < ok\n"
                                  "7.000 < T,1,7,7.000,1,41.5,0,30,30\n8.000 < T,1,8,8.000,1,41.6,0,30,30\n8.0 < T,1,9\n",
                "telemetry.csv": "T,1,6,6.000,1,41.4,0,30,30\nH,1,number,time[s],state,T1[degC],T1.q,Q1.cmd[%],Q1.app[%]\n"
                                 "T,1,7,7.000,1,41.5,0,30,30\nT,1,8,8.000,1,41.6,0,30,30\n"}

    def test_every_log_with_telemetry_is_read_and_rows_that_lost_something_are_counted(self) -> None:
        for name, text in self.SESSIONS.items():
            with self.subTest(name):
                log = logs.read(self.file(name, text))
                self.assertEqual((log.text("number"), log.text("Q1.app")), (["7", "8"], ["30", "30"]))
                self.assertEqual(log.left_out, 1)

    def test_every_log_is_plotted_and_written_as_one_table(self) -> None:
        for name, text in {**self.SESSIONS, "log.csv": SIM}.items():
            with self.subTest(name):
                path, table, picture = self.file(name, text), self.folder / "table.csv", self.folder / "plot.png"
                self.assertEqual(call("plot", str(path), "-o", str(picture))[0], 0)
                self.assertTrue(picture.read_bytes().startswith(b"\x89PNG"))
                self.assertEqual(call("plot", str(path), "--csv", str(table))[0], 0)
                lines = [line for line in table.read_text().splitlines() if not line.startswith("#")]
                self.assertTrue(lines[0].startswith("number,time[s],"))
                self.assertEqual({line.count(",") for line in lines}, {lines[0].count(",")})
                self.assertEqual(logs.read(table).rows, logs.read(path).rows)

    def test_what_is_held_is_drawn_as_steps_and_each_unit_has_a_frame(self) -> None:
        from reflux import plots
        styles = {name: plots.curve_style(name).get("drawstyle", "line")
                  for name in ("T1.meas", "T1.true", "fw.T1", "fw.top.sp", "fw.top.mode", "Lr.cmd", "fw.Lr.app", "Lr.applied", "fw.T1.q")}
        self.assertEqual(styles, {"T1.meas": "line", "T1.true": "line", "fw.T1": "line", "fw.top.sp": "steps-post", "fw.top.mode": "steps-post",
                                  "Lr.cmd": "steps-post", "fw.Lr.app": "steps-post", "Lr.applied": "steps-pre", "fw.T1.q": "steps-post"})
        log = logs.read(self.file("s.csv", SIM))
        with mock.patch.object(plots, "finish", lambda figure, *_: figure):
            figure = plots.column_plot(log, ["T1.true", "Lr.applied"], "title")
        self.assertEqual([axes.get_ylabel() for axes in figure.axes], ["[degC]", "[l/h]"])
        self.assertEqual([axes.lines[0].get_drawstyle() for axes in figure.axes], ["default", "steps-pre"])
        plots.plt.close(figure)

    def test_a_thing_has_one_name_whoever_wrote_the_column(self) -> None:
        simulator, board = logs.Log(["number", "time[s]", "T1.true[degC]", "T1.meas[degC]", "Lr.applied[l/h]", "fw.T1[degC]", "fw.top.sp[degC]"], []), \
            logs.Log(["number", "time[s]", "T1[degC]", "T1.q", "Lr.app[l/h]", "top.sp[degC]"], [])
        for asked, joined, telemetry in (("T1", "T1.meas", "T1"), ("T1.meas[degC]", "T1.meas", "T1"), ("fw.T1", "fw.T1", "T1"), ("Lr.app", "Lr.applied", "Lr.app"),
                                         ("Lr.applied", "Lr.applied", "Lr.app"), ("top.sp", "fw.top.sp", "top.sp"), ("fw.top.sp", "fw.top.sp", "top.sp"),
                                         ("T1.quality", "T1.quality", "T1.q"), ("nothing", "nothing", "nothing")):
            self.assertEqual((simulator.named(asked), board.named(asked)), (joined, telemetry), asked)
        self.assertEqual([logs.label(name) for name in ("T1.meas", "fw.T1", "Lr.app", "Lr.applied", "Lr.cmd", "fw.top.sp", "T1.true", "F")],
                         ["T1", "T1", "Lr", "Lr", "Lr commanded", "top setpoint", "T1 true", "F"])

    def test_identify_takes_the_telemetry_of_a_console(self) -> None:
        rows = "".join(f"> \x1b[KT,1,{k},{k}.000,{20 + (k // 5) % 3 + 0.1 * (k % 7)},{30 + 10 * (k // 5 % 2)}\n" for k in range(120))
        path = self.file("session.log", "\x1b[KH,1,number,time[s],T1[degC],Q1.app[%]\n" + rows)
        _status, out, err = call("identify", str(path), "--inputs", "Q1.app", "--outputs", "T1", "--orders", "1,1", "--format", "json")
        self.assertIn('"period_s": 1.0', out, err)

    def test_what_is_no_log_is_refused_in_one_line(self) -> None:
        status, _, err = call("plot", str(self.file("words.txt", "hello\n")))
        self.assertEqual((status, err.count("\n")), (2, 1))
        self.assertIn("not a log: neither a header line that begins with number nor telemetry", err)

    def test_transcript(self) -> None:
        path = self.file("t.txt", "0.000 > version\n0.000 < ! 0.000 info LINK_UP pilot 30 plant connected\n"
                         "0.000 < reflux 1 on host\n0.000 < board\n0.000 < ok\n0.000 > begin\n0.000 < ok\n")
        self.assertEqual(runner.replies_in(path, "version"), ["reflux 1 on host", "board"])
        self.assertEqual(runner.events_in(path), [(0.0, "info", "LINK_UP", "pilot 30 plant connected")])


class Compare(FolderTest):
    HEAD = "number,time[s],T1.true[degC],fw.T1[degC],fw.stat.tick\n"

    def pair(self, a: str, b: str) -> tuple[int, str, str]:
        return call("run", "--compare", str(self.file("a.csv", self.HEAD + a)), str(self.file("b.csv", self.HEAD + b)))

    def test_same(self) -> None:
        row = "0,0,87.1,87.0999985,5\n"
        for other in (row, row.replace(",5", ",6"), row.replace("87.0999985", "87.09999847"), row.replace("87.1", "87.10")):
            self.assertEqual(self.pair(row, other)[0], 0, other)

    def test_one_bit(self) -> None:
        for a, b in (("0,0,87.1,87.1,5\n", "0,0,87.1,87.1000061,5\n"), ("0,0,87.1,0,5\n", "0,0,87.1,-0,5\n"),
                     ("0,0,87.1,1,5\n", "0,0,87.10000000000001,1,5\n"), ("0,0,87.1,nan,5\n", "0,0,87.1,0,5\n")):
            status, out, _ = self.pair(a, b)
            self.assertEqual(status, 1, b)
            self.assertIn("first in sample 0", out)

    def test_missing_row(self) -> None:
        status, out, _ = self.pair("0,0,1,1,1\n", "0,0,1,1,1\n1,30,1,1,1\n")
        self.assertEqual(status, 1)
        self.assertIn("has 1 rows", out)

    def test_other_columns(self) -> None:
        a = logs.Log(["number", "x"], [])
        with self.assertRaisesRegex(UserError, "do not have the same columns: x, y"):
            compare.compare(a, logs.Log(["number", "y"], []))


if __name__ == "__main__":
    unittest.main()
