"""Between a Reflux board and my column: two thermometers, a reflux valve and a heater."""
import itertools
import math
import signal
import sys
import time

sys.path.insert(0, "tests/support")
import python_plant as link

link.NAME = "still"
link.TICK_MS = 5000
#                 name     unit    lo   hi      safe
link.MEASURED = [("Ttop", "degC", 0.0, 120.0, 0.0), ("Tbot", "degC", 0.0, 120.0, 0.0)]
link.DRIVEN = [("reflux", "%", 0.0, 100.0, 0.0), ("heater", "W", 0.0, 2000.0, 0.0)]
SAFE = [row[4] for row in link.DRIVEN]
kettle = [20.0, 20.0]  # pretends to be a column; goes when yours comes

def read():
    """One number for each thermometer, math.nan for one that does not answer. Replace all of it."""
    return list(kettle)

def drive(values):
    """Sets the real outputs, in the order of DRIVEN. Replace all of it."""
    kettle[1] += 0.002 * values[1] - 0.03 * (kettle[1] - 20)
    kettle[0] += 0.1 * (kettle[1] - kettle[0])

class Column(link.Plant):
    def lost(self):  # the board is silent or has started anew
        super().lost()
        drive(SAFE)

    def advance(self):
        drive(self.u)
        due = time.monotonic() + link.TICK_MS / 1000
        while time.monotonic() < due:
            self.exchange(0.05)  # keeps the line alive; time.sleep would not
        self.y = read()

for ending in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):  # Ctrl-C, kill, a closed window
    signal.signal(ending, lambda *_: sys.exit())
column = Column(link.Link(sys.argv[1]))
column.y = read()
column.greet()
try:
    for number in itertools.count():
        column.sample(number, number * link.TICK_MS)
        column.advance()
        print(*column.y, *column.u, flush=True)
finally:
    drive(SAFE)
    print("ended: the outputs are at their safe values", file=sys.stderr)
