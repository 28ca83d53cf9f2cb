"""Every key of a scenario file, once: what its reader takes (scenario.py), and what docs/reference/scenario-files.md says of it."""

from __future__ import annotations

from reflux import boards
from reflux.schema import Key

FIRMWARES = ("host", "host-fixed", *boards.FIRMWARES, *boards.VIRTUAL, "memory", "serial")
WITH_PINS = ("memory", *boards.VIRTUAL)

TOP = {key.name: key for key in (
    Key("name", "text", about="letters, digits, `-`, `_`, at most 40; names the output folder `out/NAME`"),
    Key("title", "text", None, default_words="the name", about="heading of the report"),
    Key("plant", "text", about="a plant of `reflux-sim --list`, or the path of a plant file, `.json`, from the scenario's folder ([plant-files.md](plant-files.md))"),
    Key("duration_s", "number", unit="s", above=0, about="plant time of the last sample"),
    Key("tick_s", "number", None, unit="s", above=0, high_words="`duration_s`", default_words="the plant's", about="interval of samples"),
    Key("measure", "texts", (), default_words="none", about="truths of the plant that become measurements, without lag and noise: an analyser, a thermometer on another tray"),
    Key("start", "table", None, unit="of the input", default_words="the nominal ones",
        about="inputs of the plant at whose steady state the run begins: `start = { R = 32.28, Q = 2804.5 }`. The valves stand there. Tell the "
              "firmware by `[[line]]`s at 0 s, `send = \"out R 32.28\"`, or its safe values move them"),
    Key("seed", "whole number", 1, low=0, about="the sequence of the sensors' noise"),
    Key("noise", "number", 1.0, low=0, about="a factor on every sensor's own noise"),
    Key("speed", "text", "max", unit="times real time", about='`"max"`: as fast as it goes; or a number as text'),
    Key("firmware", "text", "host", choices=FIRMWARES, about="what runs the loops ([firmwares](../use/scenarios.md#firmwares))"),
    Key("timeout_s", "number", 30.0, unit="s", above=0, about="longest wait for one answer of the firmware, wall clock"),
    Key("console", "texts", (), default_words="none", about="files of console lines that are sent before sample 0, one a line; `#` starts a comment. Paths start at the scenario's folder"),
    Key("wiring", "text", None, default_words="the plant link",
        about="file that says what is at the board's own pins ([pins.md](pins.md#wiring-files)), from the scenario's folder. The plant is there, and not at the "
              "link. `firmware` must be `memory` or a virtual board. A `[[line]]` is sent after the sample of its time, and those of 0 s before "
              "plant time begins"),
    Key("line", "tables", about="console lines, below"),
    Key("event", "tables", about="what is done to the plant, below"),
    Key("loop", "tables", about="loops that are judged, below"),
    Key("limit", "tables", about="what a loop may cost at most, below"),
)}

LINE = {key.name: key for key in (
    Key("at_s", "number", unit="s", low=0, high_words="`duration_s`", about="plant time; the line is sent before that sample, which waits for the reply"),
    Key("send", "text", about="the console line, at most 120 characters ([commands](commands.md))"),
    Key("allow_err", "true or false", False, about="the firmware may refuse it"),
)}

EVENT = {key.name: key for key in (
    Key("at_s", "number", unit="s", low=0, high_words="`duration_s`", about="plant time; at 0 s it makes an instrument what it is, as an [analyser](../use/analysers.md)"),
    Key("set", "table", unit="of the name",
        about="`{ NAME = number, ... }`. NAME is a disturbance, or an option of a channel: `Qrb.hi`, `T1.bias`, `F.swing` (`reflux-sim --help` lists them). "
              '`"F.swing" = 10` has F swing by 10 about its value from then on, a sine, sampled with the plant; `"F.period" = 1200` is its period in s (1200 '
              "where none is given), a swing of 0 ends it, and a new F moves its middle"),
)}

LOOP = {key.name: key for key in (
    Key("name", "text", about="as in the firmware's configuration"),
    Key("pv", "text", about="measurement"),
    Key("mv", "text", about="manipulated variable"),
    Key("band", "number", 0.0, unit="of the measurement", low=0, about="distance from the setpoint that counts as settled; 0: 5 % of the step"),
)}

METRICS = {key.name: key for key in (
    Key("iae", "number", None, unit="of the measurement times s", low=0, about="integral of the absolute error"),
    Key("overshoot_percent", "number", None, unit="%", low=0, about="overshoot of the setpoint step"),
    Key("settling_s", "number", None, unit="s", low=0, about="settling time; a window that never settles misses any limit"),
    Key("tv", "number", None, unit="of the output", low=0, about="total variation of the output"),
    Key("max_error", "number", None, unit="of the measurement", low=0, about="largest error"),
)}

LIMIT = {key.name: key for key in (
    Key("loop", "text", about="one of the judged loops"),
    Key("at_s", "number", None, unit="s", default_words="the whole run", about="begin of the window; one begins with every `sp`, `out` and `mode` line and every event"),
    *METRICS.values(),
)}

TABLES = {"": TOP, "line": LINE, "event": EVENT, "loop": LOOP, "limit": LIMIT}
