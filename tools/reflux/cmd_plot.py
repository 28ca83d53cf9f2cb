"""tools/plot: chosen columns of a log, as a picture."""

from __future__ import annotations

import argparse
import sys

from reflux.compare import log_of
from reflux.errors import UserError
from reflux.logs import read, write_csv
from reflux.paths import named, shown, tool


def main(arguments: list[str]) -> int:
    p = argparse.ArgumentParser(prog=tool("plot"), description="Plots columns of a log into a PNG file (docs/use/logs.md).")
    p.add_argument("log", type=named, metavar="LOG", help="a log of any tool, or a folder that holds one")
    p.add_argument("columns", nargs="*", metavar="COLUMN",
                   help="columns by their names without unit, such as T1 or T1.true (default: measurements, setpoints, outputs)")
    p.add_argument("-o", "--out", type=named, metavar="PNG", help="file of the picture (default: plot.png beside the log)")
    p.add_argument("--list", action="store_true", help="print the columns of the log and stop")
    p.add_argument("--csv", type=named, metavar="FILE", help="write the log as one table instead of a picture")
    options = p.parse_args(arguments)
    path = log_of(options.log)
    log = read(path)
    if log.left_out:
        print(f"note: {log.left_out} rows of telemetry are left out: damaged, or without a header before them", file=sys.stderr)
    if options.list:
        print("\n".join(log.columns))
        return 0
    if options.csv:
        try:
            write_csv(log, options.csv)
        except OSError as error:
            raise UserError(f"{shown(options.csv)} cannot be written: {error.strerror}") from None
        print(shown(options.csv))
        return 0
    from reflux import plots  # matplotlib takes a second to load
    names = [log.named(c) for c in options.columns] or plots.default_columns(log)
    for name in names:
        log.place(name)
    out = options.out or path.parent / "plot.png"
    try:
        out.write_bytes(plots.column_plot(log, names, shown(path)).png)
    except OSError as error:
        raise UserError(f"{shown(out)} cannot be written: {error.strerror}") from None
    print(shown(out))
    return 0
