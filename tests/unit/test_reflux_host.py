#!/usr/bin/python3
"""reflux-host as a program: what is asked for wrongly ends it with one line and exit code 2, what fails with 1.

usage: test_reflux_host.py REFLUX_HOST
"""
import subprocess, sys, tempfile, unittest

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
                self.ends(2, f"'{line}' is no line: pty, pty:LINK, socket:PATH or stdio is wanted", option, line)

    def test_other_options_are_refused(self):
        for because, *arguments in (("unknown option --frob", "--frob", "1"), ("--link wants a value", "--link"),
                                    ("--boot-id -1", "--boot-id", "-1"), ("--watchdog maybe", "--watchdog", "maybe"),
                                    ("cannot both be stdio", "--console", "stdio", "--link", "stdio")):
            self.ends(2, because, *arguments)

    def test_what_cannot_be_opened_is_a_failure(self):
        with tempfile.TemporaryDirectory() as folder:
            self.ends(1, "cannot listen on socket", "--console", "stdio", "--link", f"socket:{folder}/no/where")
            self.ends(1, "cannot listen on socket", "--console", "stdio", "--link", "socket:" + folder + "/" + 120 * "x")


if __name__ == "__main__":
    unittest.main()
