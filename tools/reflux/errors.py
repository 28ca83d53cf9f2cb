"""Ways to stop: the user asked for something wrong (exit 2), a run went wrong (exit 1), or a signal came (exit 128 and its number).

The text is one line: what is wrong, where, and what would be right.
"""

from __future__ import annotations


class UserError(Exception):
    """A file, option or value that is wrong."""


class RunFailed(Exception):
    """Everything was asked for correctly, and it failed all the same."""


class Ended(KeyboardInterrupt):
    """Somebody else ended this process by a signal. Whoever cleans up after Ctrl-C does so here, too."""

    def __init__(self, number: int):
        super().__init__(number)
        self.number = number
