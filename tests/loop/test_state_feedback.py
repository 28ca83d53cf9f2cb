#!/usr/bin/python3
"""tools/state-feedback, and what it prints on the whole firmware with the pilot column: the scenario pilot-state."""

import subprocess
import sys
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from reflux import runner, scenario  # noqa: E402
from reflux.logs import Log  # noqa: E402

WANTED = ["pilot", "--outputs", "T1,T10", "--inputs", "Lr,Qrb", "--poles=-0.03,-0.03", "--period", "30", "--ti", "600", "--left", "0.02",
          "--loop-names", "top,bottom"]


def told(*arguments: str) -> subprocess.CompletedProcess:
    return subprocess.run([str(ROOT / "tools" / "state-feedback"), *arguments, "--no-build"], capture_output=True, text=True, check=False)


def changed(**what: str) -> list[str]:
    """WANTED with other values."""
    out = list(WANTED)
    for name, value in what.items():
        at = next(k for k, word in enumerate(out) if word.startswith(f"--{name}"))
        if "=" in out[at]:
            out[at] = f"--{name}={value}"
        else:
            out[at + 1] = value
    return out


class Tool(unittest.TestCase):
    def test_the_scenario_has_what_it_prints(self) -> None:
        kept = (ROOT / "host_sim" / "scenarios" / "pilot-state.conf").read_text(encoding="utf-8").splitlines()
        printed = told(*WANTED).stdout.splitlines()
        self.assertEqual([line for line in kept if line.startswith("set block1")], [line for line in printed if line.startswith("set block1")])

    def test_all_flows_go_with_the_feed(self) -> None:
        lines = told(*changed(left="0.05"), "--disturbances", "F").stdout.splitlines()
        f = {line.split()[1]: [float(x) for x in line.split()[2].split(",")] for line in lines if line.startswith("set block1.f")}
        # Spans per span: 4.5 l/h of 12 and 0.8 kW of 1.5 to 5 l/h of 10.
        self.assertAlmostEqual(f["block1.f.1"][7], 4.5 / 12 / 0.5, delta=0.01)

    def refused(self, arguments: list[str], *words: str) -> None:
        answer = told(*arguments)
        self.assertIn(answer.returncode, (1, 2))
        self.assertNotIn("Traceback", answer.stderr)
        for word in words:
            self.assertIn(word, answer.stderr)

    def test_what_cannot_be_is_refused_with_the_reason(self) -> None:
        self.refused([*WANTED, "--states", "T1,T10"], "stand for too little")
        self.refused(changed(outputs="T1,T99"), "T99", "there are")
        self.refused(changed(inputs="Lr,Q"), "Q is not an input")
        self.refused(changed(outputs="T1"), "1 and 2")
        self.refused(changed(poles="0.03,-0.03"), "below 0")
        self.refused(changed(poles="fast,-0.03"), "numbers")
        self.refused(changed(poles="-0.03"), "has 1")
        self.refused(changed(period="0"), "--period")
        self.refused(changed(outputs="T1,T1"), "none twice")
        self.refused(["kotyk-column", *WANTED[1:]], "kotyk-column")
        self.refused(["nowhere", *WANTED[1:]], "nowhere")
        self.refused([*WANTED, "--key", "x"], "--to")
        self.refused([*WANTED, "--out", "/none/there"], "cannot be written")

    def test_a_file_is_one_transaction(self) -> None:
        with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
            place = Path(folder) / "state.conf"
            printed = told(*WANTED, "--out", str(place)).stdout.splitlines()
            self.assertEqual(place.read_text(encoding="utf-8").splitlines(), ["begin", *(line for line in printed if line.startswith("set ")), "apply"])


class Column(unittest.TestCase):
    def run_with(self, files: int) -> Log:
        played = scenario.load(ROOT / "host_sim" / "scenarios" / "pilot-state.toml")
        lines = scenario.read_console_files(played.console[:files])
        with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
            return runner.run(replace(played, firmware="memory", config=tuple(lines), console=played.console[:files]),
                              runner.Options(Path(folder) / "out", quiet=True)).log

    def test_near_its_nominal_point_the_column_is_held_and_the_top_moves_less_than_under_pis(self) -> None:
        law, pis = self.run_with(2), self.run_with(1)
        for log in (law, pis):
            for pv, loop in (("T1", "top"), ("T10", "bottom")):
                self.assertAlmostEqual(log.numbers(f"{pv}.true")[-1], log.numbers(f"fw.{loop}.sp")[-1], delta=0.05)

        def moved(log: Log) -> float:
            return max(abs(y - sp) for t, y, sp in zip(log.numbers("time"), log.numbers("T1.true"), log.numbers("fw.top.sp")) if t > 3600)

        self.assertLess(moved(law), moved(pis) / 2)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
