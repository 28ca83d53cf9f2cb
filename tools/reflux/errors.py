"""Two ways to stop: the user asked for something wrong (exit 2), or a run went wrong (exit 1).

The text is one line: what is wrong, where, and what would be right.
"""

from __future__ import annotations


class UserError(Exception):
    """A file, option or value that is wrong."""


class RunFailed(Exception):
    """Everything was asked for correctly, and it failed all the same."""
