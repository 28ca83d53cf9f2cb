"""Reading, joining and comparing logs."""

import unittest

from support import FolderTest, call

from reflux_tools import compare, logs, runner
from reflux_tools.errors import RunFailed, UserError

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
