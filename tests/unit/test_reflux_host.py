#!/usr/bin/python3
"""reflux-host as a program: a usage error ends it with one line and exit code 2, a failure with 1.

usage: test_reflux_host.py REFLUX_HOST
"""
import os, pathlib, stat, subprocess, sys, tempfile, unittest

HOST = sys.argv.pop(1)


class Options(unittest.TestCase):
    def ends(self, code, because, *arguments):
        done = subprocess.run([HOST, *arguments], capture_output=True, text=True, stdin=subprocess.DEVNULL, timeout=900)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertIn(because, done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertEqual(done.stdout, "")

    def test_lines_of_no_known_form_are_refused(self):
        for line in ("", "tty", "ptyx", "pty:", "socket", "socket:", "/dev/ttyUSB0", "stdio:", "PTY"):
            for option in ("--console", "--link"):
                self.ends(2, f"'{line}' is not a line: use pty, pty:LINK, socket:PATH or stdio", option, line)

    def test_other_options_are_refused(self):
        for because, *arguments in (("unknown option --frob", "--frob", "1"), ("--link wants a value", "--link"),
                                    ("--boot-id -1", "--boot-id", "-1"), ("--watchdog maybe", "--watchdog", "maybe"),
                                    ("cannot both be stdio", "--console", "stdio", "--link", "stdio"),
                                    ("cannot both be pty:x", "--console", "pty:x", "--link", "pty:x")):
            self.ends(2, because, *arguments)

    def test_what_cannot_be_opened_is_a_failure(self):
        with tempfile.TemporaryDirectory() as folder:
            self.ends(1, "cannot listen on socket", "--console", "stdio", "--link", f"socket:{folder}/no/where")
            self.ends(1, "cannot listen on socket", "--console", "stdio", "--link", "socket:" + folder + "/" + 120 * "x")


class Neighbours(unittest.TestCase):
    """Several hosts on one computer, one of which may have been killed."""

    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))

    def start(self, *arguments):
        """A host that has opened its lines and its flash."""
        host = subprocess.Popen([HOST, *arguments], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        self.addCleanup(host.communicate)
        self.addCleanup(host.kill)
        host.stdin.write(b"version\n")
        host.stdin.flush()
        self.assertTrue(host.stdout.readline())
        return host

    def refused(self, *arguments):
        done = subprocess.run([HOST, *arguments], capture_output=True, text=True, stdin=subprocess.DEVNULL, timeout=60)
        self.assertEqual(done.returncode, 1, done.stderr)
        return done.stderr.splitlines()[-1]

    def test_the_second_host_on_one_flash_file_says_who_has_it(self):
        flash = str(self.folder / "flash")
        first = self.start("--nvm", flash)
        self.assertIn(f"{flash} is the flash of process {first.pid} (reflux-host)", self.refused("--nvm", flash))
        first.kill()
        first.wait()
        self.start("--nvm", flash)

    def test_only_its_owner_may_read_a_new_flash_file(self):
        os.umask(0o022)
        self.start("--nvm", str(self.folder / "flash"))
        self.assertEqual(stat.S_IMODE((self.folder / "flash").stat().st_mode), 0o600)

    def test_the_link_of_a_killed_host_is_replaced_though_its_terminal_has_another_owner(self):
        link = self.folder / "link"
        killed = self.start("--link", f"pty:{link}")
        killed.kill()
        killed.wait()
        stale = os.readlink(link)
        self.start("--link", f"pty:{link}")  # the kernel may give it the number that has become free
        link.unlink()
        master, terminal = os.openpty()  # a terminal of somebody else, at the end of a link that a host has left
        self.addCleanup(os.close, master)
        self.addCleanup(os.close, terminal)
        link.symlink_to(os.ttyname(terminal))
        self.start("--link", f"pty:{link}")
        self.assertTrue(stale.startswith("/dev/pts/"))
        self.assertNotEqual(os.readlink(link), os.ttyname(terminal))

    def test_the_link_of_a_host_that_runs_stays(self):
        link = self.folder / "link"
        first = self.start("--link", f"pty:{link}")
        there = os.readlink(link)
        self.assertIn(f"{link} is the link of process {first.pid} (reflux-host)", self.refused("--link", f"pty:{link}"))
        self.assertEqual(os.readlink(link), there)

    def test_a_link_that_leads_elsewhere_stays(self):
        link = self.folder / "link"
        for target in ("/dev/null", str(self.folder / "nowhere")):
            link.symlink_to(target)
            self.assertIn(f"{link} leads to {target}", self.refused("--link", f"pty:{link}"))
            self.assertEqual(os.readlink(link), target)
            link.unlink()


if __name__ == "__main__":
    unittest.main()
