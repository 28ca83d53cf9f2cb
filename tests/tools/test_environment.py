"""The environment of tests does not depend on what a person has set."""

import os
import subprocess
import sys
import unittest
from pathlib import Path

from support import FolderTest

from reflux.environment import DROPPED, clean

THEIRS = {**{name: "theirs" for name in DROPPED}, "MPLBACKEND": "theirs", "MPLCONFIGDIR": "/theirs", "LANG": "de_DE.UTF-8"}


class Clean(FolderTest):
    def test_what_a_person_has_set_is_dropped_or_replaced(self) -> None:
        made = clean({**THEIRS, "PATH": "/bin", "REFLUX_BUILD_ROOT": "/trees"})
        self.assertEqual({k for k, v in made.items() if "theirs" in v}, set())
        self.assertEqual((made["PATH"], made["REFLUX_BUILD_ROOT"]), ("/bin", "/trees"))
        self.assertEqual((made["MPLBACKEND"], made["LC_ALL"]), ("Agg", "C.UTF-8"))
        self.assertEqual(clean(made), made)

    def test_only_a_temporary_folder_that_is_too_long_for_sockets_is_dropped(self) -> None:
        self.assertEqual(clean({"TMPDIR": "/fast"})["TMPDIR"], "/fast")
        self.assertNotIn("TMPDIR", clean({"TMPDIR": "/" + 80 * "long"}))

    def test_the_tests_of_the_tools_have_it(self) -> None:
        self.assertEqual(dict(os.environ), clean(os.environ))

    def test_a_picture_is_drawn_whatever_is_set_and_nothing_is_written_at_home(self) -> None:
        home = self.folder / "home"
        home.mkdir()
        log = self.file("log.csv", "number,time[s],a[K]\n0,0,1\n1,10,2\n")
        program = (f"import sys; sys.path.insert(0, {str(Path(__file__).parent)!r}); from support import call; "
                   f"print(call('plot', {str(log)!r}, 'a'))")
        answer = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False,
                                env={**os.environ, **THEIRS, "PYTHONWARNINGS": "default", "HOME": str(home)})
        self.assertEqual(answer.returncode, 0, answer.stderr)
        self.assertTrue(answer.stdout.startswith("(0, "), answer.stdout)
        self.assertEqual(list(home.iterdir()), [])


if __name__ == "__main__":
    unittest.main()
