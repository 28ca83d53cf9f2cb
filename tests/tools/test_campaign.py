"""tools/campaign: where its tables go, and whether the committed ones come out again."""

import csv
import os
import unittest
from pathlib import Path
from unittest import mock

from support import ROOT, FolderTest, call

from research import cmd_campaign

KEPT = ROOT / "tests" / "campaign" / "results" / "pilot-noise.csv"
TINY = f"""name = "tiny"
scenario = "{ROOT / 'host_sim' / 'scenarios' / 'smoke.toml'}"
seeds = 2
"""


class Tables(FolderTest):
    def setUp(self) -> None:
        super().setUp()
        self.file("tiny.toml", TINY)
        out, build = str(self.folder / "out"), Path(self.folder / "build")
        self.enterContext(mock.patch.dict(os.environ, {"REFLUX_OUT": out}))
        self.enterContext(mock.patch.object(cmd_campaign, "CAMPAIGNS", self.folder))
        self.enterContext(mock.patch.object(cmd_campaign, "build_root", lambda: build))

    def campaign(self, *more: str) -> list[str]:
        """Runs it; returns the tables there are, by their paths in the folder."""
        status, _, err = call("campaign", "tiny", "--no-build", "--jobs", "1", *more)
        self.assertEqual((status, err), (0, ""))
        return sorted(str(path.relative_to(self.folder)) for path in self.folder.rglob("tiny.[cm][sd]*"))

    def test_tables_go_to_out_and_not_among_the_committed_ones(self) -> None:
        self.assertEqual(self.campaign(), ["out/campaign/tiny.csv", "out/campaign/tiny.md"])

    def test_keep_writes_the_committed_ones(self) -> None:
        self.assertEqual(self.campaign("--keep"), ["results/tiny.csv", "results/tiny.md"])

    def test_check_writes_none(self) -> None:
        self.assertEqual(self.campaign("--check"), [])

    def test_a_part_is_not_kept(self) -> None:
        status, _, err = call("campaign", "tiny", "--keep", "--fraction", "0.5")
        self.assertEqual(status, 2)
        self.assertIn("--keep keeps a whole campaign", err)


class Kept(unittest.TestCase):
    def test_the_first_rows_of_the_demonstrations_campaign_come_out_again(self) -> None:
        """Within a part in a thousand: the last digit of the page's figures may owe to rounding. Else: tools/campaign pilot-noise --keep."""
        campaign = cmd_campaign.load("pilot-noise")
        with KEPT.open(encoding="utf-8") as file:
            rows = list(csv.DictReader(file))[:5]
        for row in rows:
            found = cmd_campaign.run_one(campaign.scenario, {"seed": float(row["seed"]), "noise": float(row["noise"])})
            self.assertEqual("; ".join(found["failures"]), row["failure"])
            for loop, metrics in found["loops"].items():
                for metric, value in metrics.items():
                    with self.subTest(seed=row["seed"], loop=loop, metric=metric):
                        self.assertAlmostEqual(value, float(row[f"{loop}.{metric}"]), delta=1e-3 * abs(value))


if __name__ == "__main__":
    unittest.main()
