#!/usr/bin/python3
"""The cold pilot column at the board's own pins for weeks, with every output proved that has a channel for it: does anything alarm falsely?

Started by its sequence, run for 4 to 16 hours with random setpoints, feeds and losses, stopped by its sequence, and started again warm or cold. Noise
is that of the plant's instruments. Nothing is ever broken, so each alarm is false but those that the script causes: the interlock of the cooling water
while that is off, and the end of a stop that takes longer than the pause.
"""

import argparse
import collections
import random
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SCENARIOS = ROOT / "host_sim" / "scenarios"
SIMULATOR = ROOT / "build" / "host" / "reflux-sim-memory"
HOUR_S = 3600
CAUSED = {("INTERLOCK_ON", "Qrb"), ("SEQUENCE_ABORTED", "-"), ("SAFE_STATE", "sequence")}
ALARM = re.compile(r"< ! [\d.]+ (alarm|warning) (\w+) (\S+)")
PROOFS = (
    "begin", "set out2.heater on", "set out2.proof warms", "set out2.proof_at chan3", "set out2.proof_change 5", "set out2.proof_on 240",
    "set out2.proof_off 1500", "set out2.proof_below 70",
    "set out5.proof flows", "set out5.proof_at chan10", "set out5.proof_change 1", "set out5.proof_on 60", "set out5.proof_off 60",
    "set out6.proof flows", "set out6.proof_at chan7", "set out6.proof_change 10", "set out6.proof_on 60", "set out6.proof_off 60",
    *(f"set meas{number}.frozen 300" for number in (1, 2, 3, 4, 6)), "apply")


def plan(seconds: int, chance: random.Random) -> tuple[list[tuple[float, str]], list[tuple[float, str]]]:
    """Console lines and events, each with its plant time in s."""
    lines: list[tuple[float, str]] = []
    events: list[tuple[float, str]] = []
    for name in ("pilot-cold", "pilot-cold-sequences", "pilot-cold-pins"):
        text = (SCENARIOS / f"{name}.conf").read_text(encoding="utf-8")
        lines += [(0, line) for line in text.splitlines() if line and line[0] != "#"]
    lines += [(0, line) for line in PROOFS]
    start = 30.0
    while start < seconds:
        lines += [(start - 20, "?seq abort"), (start, "seq start"), *((start + after, "?seq confirm") for after in range(300, 2700, 60))]
        stop, at = start + chance.uniform(4, 16) * HOUR_S, start + 4500
        while at < stop - 600:
            what = chance.randrange(4)
            if what == 3:
                events.append((at, f"loss={chance.uniform(0.8, 1.3):.2f}"))
            else:
                line = (f"sp top {chance.uniform(86.9, 87.8):.2f}", f"sp bottom {chance.uniform(104.5, 107.5):.2f}", f"out vF {chance.uniform(42, 58):.1f}")
                lines.append((at, f"?{line[what]}"))
            at += chance.uniform(900, 3600)
        lines.append((stop, "seq stop"))
        start = stop + chance.uniform(0.2, 5) * HOUR_S
    return sorted((row for row in lines if row[0] < seconds), key=lambda row: row[0]), [row for row in events if row[0] < seconds]


def run(hours: int, seed: int, out: Path) -> collections.Counter:
    """How often each alarm and warning came, by its code and subject."""
    lines, events = plan(hours * HOUR_S, random.Random(seed))
    script, transcript = out / f"{seed}.txt", out / f"{seed}-transcript.txt"
    script.write_text("".join(f"{at:.0f} {line}\n" for at, line in lines), encoding="utf-8")
    command = [str(SIMULATOR), "--plant", "pilot-cold", "--port", "memory", "--console", "memory", "--wiring", str(SCENARIOS / "pilot-cold-pins.wiring"),
               "--tick", "1", "--duration", str(hours * HOUR_S), "--script", str(script), "--transcript", str(transcript), "--seed", str(seed), "--noise", "1"]
    for at, event in events:
        command += ["--event", f"{at:.0f}:{event}"]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    said = transcript.read_text(encoding="utf-8", errors="replace")
    return collections.Counter((found[2], found[3]) for found in ALARM.finditer(said))


def main() -> int:
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--hours", type=int, default=168, metavar="N", help="of plant time in each run (default 168: ten minutes of processor time)")
    p.add_argument("--seeds", type=int, default=6, metavar="N", help="runs (default 6)")
    p.add_argument("--first", type=int, default=11, metavar="SEED", help="seed of the first run (default 11)")
    p.add_argument("--out", type=Path, default=ROOT / "out" / "pins-weeks", metavar="FOLDER", help="scripts and transcripts (default out/pins-weeks)")
    options = p.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    wrong = 0
    for seed in range(options.first, options.first + options.seeds):
        found = run(options.hours, seed, options.out)
        false = {what: n for what, n in found.items() if what not in CAUSED}
        wrong += sum(false.values())
        print(f"seed {seed}, {options.hours} h: " + ", ".join(f"{code} {subject} {n}" for (code, subject), n in sorted(found.items())) +
              f"; false: {sum(false.values())}", flush=True)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
