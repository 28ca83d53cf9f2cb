"""tools/bootstrap and tools/fetch-unity, with a package manager that only pretends: no network and no root are needed."""

import contextlib
import fcntl
import os
import shutil
import subprocess
import tarfile
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from support import ROOT, FolderTest, call

from reflux import packages

FRONTEND = "/var/lib/dpkg/lock-frontend"
# Each time it is called it does what the next line of the script says, and goes on with the last line for ever.
# "ok" succeeds, and of `install` the packages are then there.
APT_GET = """#!/bin/sh
echo "apt-get $*" >> calls
line=$(head -n 1 script)
[ "$(wc -l < script)" -le 1 ] || sed -i 1d script
case $line in
    ok) case "$*" in *" install "*) touch installed ;; esac ;;
    other) touch installed; echo 'E: Could not get lock /var/lib/dpkg/lock. It is held by process 11 (dpkg)' >&2; exit 100 ;;
    *) echo "$line" >&2; exit 100 ;;
esac
"""
DPKG_QUERY = """#!/bin/sh
[ -e installed ] || exit 1
shift 3
for package in "$@"; do echo "$package ii "; done
"""
CLOCK = """#!/bin/sh
[ "$1" != +%s ] || { echo tick >> clock; echo $((60 * $(wc -l < clock))); }
"""
OTHERS = {"apt-get": APT_GET, "dpkg-query": DPKG_QUERY, "date": CLOCK, "sleep": "#!/bin/sh\n", "id": "#!/bin/sh\necho 0\n"}


class FakeSystem(FolderTest):
    """Programs of this folder come first in PATH, and the tools start in it."""

    def setUp(self) -> None:
        super().setUp()
        for name, text in OTHERS.items():
            self.program(name, text)

    def program(self, name: str, text: str) -> None:
        """Puts a program first in PATH."""
        path = self.folder / "bin" / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")
        path.chmod(0o755)

    def environment(self) -> dict[str, str]:
        return {**os.environ, "PATH": f"{self.folder / 'bin'}{os.pathsep}{os.environ['PATH']}", "TMPDIR": str(self.folder)}

    def tool(self, name: str, *arguments: str) -> subprocess.CompletedProcess:
        return subprocess.run([str(ROOT / "tools" / name), *arguments], cwd=self.folder, env=self.environment(),
                              stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)


class Bootstrap(FakeSystem):
    def bootstrap(self, *script: str) -> subprocess.CompletedProcess:
        """Runs it while apt-get answers as the script says."""
        self.file("script", "".join(f"{line}\n" for line in script))
        return self.tool("bootstrap", "host")

    def calls(self) -> list[str]:
        """Requests to apt-get, in order."""
        return ["update" if line.endswith(" update") else "install" for line in self.lines("calls")]

    def lines(self, name: str) -> list[str]:
        path = self.folder / name
        return path.read_text(encoding="utf-8").splitlines() if path.exists() else []

    def assert_ends(self, answer: subprocess.CompletedProcess, *last: str) -> None:
        self.assertEqual((answer.returncode, answer.stderr), (0, ""))
        self.assertEqual(tuple(answer.stdout.splitlines()[-len(last):]), last)

    def test_it_waits_for_each_lock_and_says_once_for_what(self) -> None:
        locks = ("/var/lib/apt/lists/lock", FRONTEND, "/var/lib/dpkg/lock", "/var/cache/apt/archives/lock")
        for lock in locks:
            with self.subTest(lock):
                for name in ("calls", "installed", "clock"):
                    (self.folder / name).unlink(missing_ok=True)
                met = f"E: Could not get lock {lock}. It is held by process 4711 (apt-get)"
                first = () if "lists" in lock else ("ok",)
                answer = self.bootstrap(*first, met, met, met, "ok")
                self.assert_ends(answer, "Installing them ...",
                                 f"Waiting for the package manager: process 4711 (apt-get) holds {lock} ...", "Installed.")
                self.assertEqual(self.calls().count("update"), 4 if "lists" in lock else 1)
                self.assertEqual(self.calls()[-1], "install")

    def test_dpkg_says_in_other_words_that_it_is_locked(self) -> None:
        answer = self.bootstrap("ok", "dpkg: error: dpkg frontend lock was locked by another process with pid 12", "ok")
        self.assertEqual(answer.returncode, 0, answer.stderr)
        self.assertIn(f"holds {FRONTEND} ...", answer.stdout)

    def test_what_another_process_has_installed_meanwhile_is_not_installed_again(self) -> None:
        answer = self.bootstrap("ok", "other", "nobody may ask again")
        self.assert_ends(answer, "Waiting for the package manager: process 11 (dpkg) holds /var/lib/dpkg/lock ...",
                         "Another process has installed them.")
        self.assertEqual(self.calls(), ["update", "install"])

    def test_it_gives_up_after_fifteen_minutes_and_says_who_holds_the_lock(self) -> None:
        answer = self.bootstrap("ok", f"E: Could not get lock {FRONTEND}. It is held by process 4711 (apt-get)")
        self.assertEqual(answer.returncode, 1)
        self.assertEqual(answer.stderr, f"bootstrap: gave up after 15 minutes: process 4711 (apt-get) holds {FRONTEND}\n")
        self.assertEqual(len(self.lines("clock")), 16)  # a minute each; the first look begins the time

    def test_it_finds_a_holder_that_apt_does_not_name(self) -> None:
        lock = Path(self.enterContext(tempfile.TemporaryDirectory(dir="/tmp"))) / "lock"  # apt's locks have no blanks either
        lock.touch()
        with lock.open("r+") as held:
            fcntl.lockf(held, fcntl.LOCK_EX)
            answer = self.bootstrap("ok", f"E: Could not get lock {lock} - open (11: Resource temporarily unavailable)", "ok")
            visible = f":{lock.stat().st_ino} " in Path("/proc/locks").read_text(encoding="utf-8")
        self.assertEqual(answer.returncode, 0, answer.stderr)
        if visible:  # some containers hide locks
            self.assertIn(f"process {os.getpid()} (", answer.stdout)
        self.assertIn(f"holds {lock} ...", answer.stdout)

    def test_any_other_failure_ends_it_at_once(self) -> None:
        answer = self.bootstrap("ok", "E: Unable to locate package ninja-build")
        self.assertEqual(answer.returncode, 1)
        self.assertEqual(answer.stderr.splitlines()[0], "E: Unable to locate package ninja-build")
        self.assertIn("apt-get could not install the packages", answer.stderr)
        self.assertEqual(self.calls(), ["update", "install"])

    def test_nothing_happens_when_nothing_is_missing(self) -> None:
        self.file("installed", "")
        answer = self.bootstrap("nobody may ask")
        self.assertEqual((answer.returncode, answer.stdout, answer.stderr, self.calls()), (0, "", "", []))

    def test_where_nobody_can_be_asked_ask_installs_nothing_and_set_up_installs(self) -> None:
        self.file("script", "ok\n")
        answer = self.tool("bootstrap", "--ask", "host", "fuzz")
        self.assertEqual((answer.returncode, self.calls()), (1, []))
        self.assertIn("tools/bootstrap host fuzz", answer.stderr)
        answer = self.tool("bootstrap", "--set-up", "host")
        self.assertEqual((answer.returncode, self.calls()), (0, ["update", "install"]), answer.stderr)

    def drained(self, terminal: int) -> str:
        """Text written to the other side of a terminal that is closed there; closes this side, too."""
        said = b""
        with contextlib.suppress(OSError), open(terminal, "rb", buffering=0) as file:
            while part := file.read(4096):
                said += part
        return said.decode()

    def test_on_a_terminal_it_asks_first_unless_it_is_continuous_integration(self) -> None:
        for action, answer, ci, status, calls in (("--ask", "n", "", 1, []), ("--set-up", "", "", 1, []), ("--ask", "y", "", 0, ["update", "install"]),
                                                  ("--set-up", "y", "", 0, ["update", "install"]), ("--set-up", "", "true", 0, ["update", "install"])):
            with self.subTest(action=action, answer=answer, ci=ci):
                for name in ("calls", "installed"):
                    (self.folder / name).unlink(missing_ok=True)
                self.file("script", "ok\n")
                here, there = os.openpty()
                os.write(here, f"{answer}\n".encode())
                process = subprocess.run([str(ROOT / "tools" / "bootstrap"), action, "host"], cwd=self.folder, env={**self.environment(), "CI": ci},
                                         stdin=there, stderr=there, stdout=subprocess.PIPE, check=False)
                os.close(there)
                said = self.drained(here)
                self.assertEqual((process.returncode, self.calls()), (status, calls), said)
                self.assertEqual("Install them now?" in said, not ci, said)

    def test_a_tool_judges_its_arguments_before_it_installs(self) -> None:
        for wrong in (["fuzz", "nope"], ["fuzz", "--runs", "0"], ["coverage", "--check"], ["evidence", "nope"], ["image", "nope"], ["mutate", "--jobs", "0"],
                      ["mutate", "nope.c"], ["prove", "--timeout", "x"], ["site", "--out", ""], ["wheel", "--out", ""], ["test", "units"], ["test", "-R", "("], ["demo", "--out", ""],
                      ["demo", "--firmware", "serial"], ["demo", "--board", "--firmware", "stm32f405"]):
            with self.subTest(wrong):
                answer = self.tool(*wrong)
                self.assertEqual((answer.returncode, answer.stdout, self.calls()), (2, "", []), answer.stderr)

    def test_a_tool_asks_for_what_it_needs_and_no_more(self) -> None:
        for words, wanted in ((["fuzz", "frame"], ["--ask", "host", "fuzz"]), (["coverage"], ["--ask", "host", "coverage"]), (["prove"], ["--ask", "host", "prove"]),
                              (["site"], ["--ask", "site"]), (["wheel"], ["--ask", "host", "wheel"]),
                              (["coverage", "--reach"], ["--ask", "host"]), (["mutate", "--random", "1"], ["--ask", "host"]),
                              (["image"], ["--ask", "host", "target"]), (["test", "unit"], ["--set-up", "host"]),
                              (["test", "target"], ["--set-up", "host", "target"]), (["test"], ["--set-up", "host", "target", "test", "wheel"]),
                              (["demo"], ["--set-up", "host", "target"]), (["demo", "--firmware", "host"], ["--set-up", "host"]),
                              (["demo", "--board"], ["--set-up", "host", "target"]), (["demo", "--board", "--firmware", "memory"], ["--set-up", "host"]),
                              (["evidence"], ["--ask", "host", "target", "test", "evidence"])):
            with self.subTest(words), mock.patch.object(packages.subprocess, "run", return_value=mock.Mock(returncode=1)) as run:
                status, _, err = call(*words)
                self.assertEqual((status, err.count("\n")), (1, 1))
                self.assertEqual(run.call_args.args[0][1:], wanted)

    def test_groups_of_one_tool_are_parts_of_the_evidence(self) -> None:
        listed = {group: self.tool("bootstrap", "--list", group).stdout.split() for group in ("fuzz", "coverage", "prove", "evidence", "python", "host")}
        self.assertEqual(listed["fuzz"] + listed["coverage"] + listed["prove"], listed["evidence"])
        self.assertLessEqual(set(listed["python"]), set(listed["host"]))


def has_debian_source() -> bool:
    """True if fetch-unity finds a package source of Debian here."""
    files = [*Path("/etc/apt").glob("sources.list"), *Path("/etc/apt/sources.list.d").glob("*")]
    return shutil.which("apt-get") is not None and any("debian" in f.read_text(encoding="utf-8") for f in files if f.is_file())


@unittest.skipUnless(has_debian_source(), "no package source of Debian: fetch-unity does not start here")
class FetchUnity(FakeSystem):
    FILES = ("unity.c", "unity.h", "unity_internals.h")

    def setUp(self) -> None:
        super().setUp()
        archive = self.folder / "made.tar.xz"
        with tarfile.open(archive, "w:xz") as tar:
            for name in self.FILES:
                tar.add(self.file(name, f"/* {name} */\n"), f"ntpsec-1.2.2/tests/unity/{name}")
        self.program("apt-get", f'#!/bin/sh\ncase "$*" in *" source "*) cp "{archive}" ntpsec_1.2.2+dfsg1.orig.tar.xz ;; esac\n')
        self.program("sha256sum", "#!/bin/sh\ncat\n")
        self.unity = self.folder / "build" / "unity"

    def assert_whole(self) -> None:
        self.assertEqual(sorted(f.name for f in self.unity.iterdir()), list(self.FILES))
        self.assertEqual([f.name for f in self.unity.parent.iterdir()], ["unity"])  # no temporary folder is left

    def test_it_makes_the_folder_and_mends_one_that_is_not_whole(self) -> None:
        for left in ((), ("unity.c", "unity.h")):
            with self.subTest(left=left):
                shutil.rmtree(self.unity, ignore_errors=True)
                for name in left:
                    self.unity.mkdir(parents=True, exist_ok=True)
                    (self.unity / name).write_text("")
                answer = self.tool("fetch-unity", str(self.unity))
                self.assertEqual(answer.returncode, 0, answer.stderr)
                self.assert_whole()
                self.assertEqual((self.unity / "unity.c").read_text(), "/* unity.c */\n")

    def test_one_that_comes_too_late_keeps_what_is_there(self) -> None:
        self.unity.mkdir(parents=True)
        for name in self.FILES:
            (self.unity / name).write_text("first\n")
        self.assertEqual(self.tool("fetch-unity", "build/unity").returncode, 0)
        self.assert_whole()
        self.assertEqual((self.unity / "unity.c").read_text(), "first\n")

    def test_several_at_once_all_succeed(self) -> None:
        several = [subprocess.Popen([str(ROOT / "tools" / "fetch-unity"), str(self.unity)], env=self.environment(),
                                    stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
                   for _ in range(4)]
        for process in several:
            said, _ = process.communicate()
            self.assertEqual(process.returncode, 0, said)
        self.assert_whole()


if __name__ == "__main__":
    unittest.main()
