"""Faults of what is at the board's own pins, in states of the firmware, with the pilot column: the list, a run, and what must hold in each.

The measurement T1 is behind each kind of device in turn, T10 behind a MAX31865 of its own, and the outputs are pulse widths, which the plant gets
as they are commanded. Faults of loads have a heater of each kind. A sample comes each second. Times are the plant's, s.
"""

from __future__ import annotations

import re
import subprocess
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import Callable

from board import PATIENCE_S, ROOT
from reflux import build

ENTER_S, FAULT_S, LASTS_S, AFTER_S = 10, 100, 60, 40
LOAD_LASTS_S = 900               # a column takes its time to show that its heater is another one
TEST_STEP_S = 450                # the first step of a start-up is under way
HOLD_S, FROZEN_S = 5, 10         # meas1.hold; meas1.frozen where a chip stands still
SAMPLES = 2.0                    # a fault that a chip reports is told within so many samples
BACK_S = 6.0                     # and what is taken back is told so soon
LIMITS = {"Lr": (1.0, 9.0, 4.5), "Qrb": (0.4, 1.25, 0.0)}
MANUAL = {"Lr": 4.5, "Qrb": 0.8}
STEP = {"Lr": 0.03, "Qrb": 0.004}  # a pulse width counted in ms of 1 s, twice

# ---- devices ----------------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Fault:
    """events: NAME=VALUE, set and taken back with back. says: the words one of which is told; none: the chip cannot tell. why: it cannot."""

    name: str
    events: tuple[str, ...]
    says: tuple[str, ...] = ()
    back: tuple[str, ...] = ()
    why: str = ""
    within_s: float = SAMPLES
    readings: str = "good ones are right"  # or "stand still", "wrong": nobody can tell
    both: bool = False                     # T10 has it as well
    sometimes: bool = False                # noise: it may be told or not
    settings: tuple[str, ...] = ()
    told_as: str = "SENSOR_FAULT"
    lasts_s: float = LASTS_S

    def taken_back(self) -> tuple[str, ...]:
        return self.back or tuple(f"{event.split('=')[0]}=0" for event in self.events)


@dataclass(frozen=True)
class Device:
    """wiring: the line of T1; rows: settings of chan1. A temperature t reads as zero + t * slope, within near."""

    name: str
    bus: str
    wiring: str
    rows: tuple[str, ...]
    unit: str = "degC"
    zero: float = 0.0
    slope: float = 1.0
    near: float = 0.4
    faults: tuple[Fault, ...] = ()
    beside: str = ""             # line of a switch beside T1, which has the faults
    more: tuple[str, ...] = ()   # its settings


NO_CHIP, WRONG, CHECK, OPEN, SHORT = "no chip answers", "another chip", "checksum wrong", "sensor or wire open", "sensor shorted"
VOLTAGE, RANGE, COLD, POWER, BUS = "voltage outside", "out of range", "cold junction", "lost power", "bus failed"
GONE = (NO_CHIP, BUS, WRONG)
ANY = (*GONE, CHECK, OPEN, SHORT, VOLTAGE, RANGE, COLD, POWER)
STANDS = "the chip says that it has converted; told by meas.frozen"


def of_all_chips(wrong: bool = True) -> tuple[Fault, ...]:
    out = [Fault("missing chip", ("T1.missing=1",), GONE), Fault("dead chip", ("T1.dead=1",), GONE)]
    return (*out, Fault("wrong chip", ("T1.wrong=1",), (WRONG, NO_CHIP, CHECK))) if wrong else tuple(out)


def of_bus(bus: str, shared: bool) -> tuple[Fault, ...]:
    out = [Fault("bus stuck low", (f"{bus}.stuck=1",), ANY, both=shared),
           Fault("bus noise 1e-3", (f"{bus}.noise=1e-3",), ANY, both=shared, sometimes=True),
           Fault("bus noise 1e-2", (f"{bus}.noise=1e-2",), ANY, both=shared, sometimes=True)]
    if bus.startswith("spi"):
        out.append(Fault("missing chip, bus floats low", ("T1.missing=1", f"{bus}.floats_low=1"), GONE))
    return tuple(out)


def on_i2c() -> tuple[Fault, ...]:
    return (Fault("no byte is acknowledged", ("T1.nack=1",), (NO_CHIP, BUS)),
            Fault("frozen chip", ("T1.frozen=1",), ("frozen", "out of range", "flagged bad"), why=STANDS, within_s=FROZEN_S + SAMPLES,
                  readings="stand still", settings=(f"set meas1.frozen {FROZEN_S}",), told_as="MEASUREMENT_BAD"))


# A brown-out takes the thresholds of a MAX31865 and the fault mask of a MAX31856 with it.
BROWN_OPEN = Fault("open after a brown-out", ("T1.brownout=1", "T1.open=1"), (OPEN, WRONG, POWER), within_s=3.0)
BROWN = Fault("brown-out", ("T1.brownout=1",), (WRONG, POWER, VOLTAGE, CHECK, OPEN, BUS), sometimes=True)
MAX31865 = (
    *of_all_chips(), Fault("open", ("T1.open=1",), (OPEN,)), Fault("wire of the current open", ("T1.force_open=1",), (OPEN,)),
    Fault("short", ("T1.short=1",), (SHORT,)), Fault("RTDIN- at ground", ("T1.ground=1",), (SHORT, VOLTAGE, OPEN)),
    Fault("overvoltage", ("T1.overvoltage=1",), (VOLTAGE,)), BROWN,
    BROWN_OPEN, Fault("2 ohm in each lead", ("T1.lead=2",), why="three wires compensate it"))
MAX31856 = (
    *of_all_chips(), Fault("open", ("T1.open=1",), (OPEN,), within_s=3.0), Fault("overvoltage", ("T1.overvoltage=1",), (VOLTAGE,)), BROWN,
    BROWN_OPEN, Fault("short", ("T1.short=1",), why="a shorted thermocouple is one at the temperature of its terminals", readings="wrong"),
    Fault("terminals at 60 degC", ("T1.cold=60",), back=("T1.cold=20",), why="the chip compensates it"),
    Fault("terminals at 140 degC", ("T1.cold=140",), (COLD,), back=("T1.cold=20",)))
DS18B20 = (
    *of_all_chips(wrong=False), Fault("power lost", ("T1.power_loss=1",), (POWER, NO_CHIP)),
    Fault("checksum", ("T1.crc=1",), (CHECK, NO_CHIP)), Fault("short", ("T1.short=1",), ANY))
VOLTS = (*of_all_chips(), *on_i2c())
FROZEN = Fault("frozen", ("T1.frozen=1",), ("frozen", "out of range"), why="a voltage like any other; told by meas.frozen", within_s=FROZEN_S + SAMPLES,
               readings="stand still", settings=(f"set meas1.frozen {FROZEN_S}",), told_as="MEASUREMENT_BAD")
BELOW, ABOVE = "a value like any other; below meas1.lo", "a value like any other; above meas1.hi"
ANALOG = (
    Fault("wire broken", ("T1.open=1",), ("out of range",), told_as="MEASUREMENT_BAD", why=BELOW),
    Fault("wire at ground", ("T1.short_low=1",), ("out of range",), told_as="MEASUREMENT_BAD", why=BELOW),
    Fault("wire at the supply", ("T1.short_high=1",), (RANGE,)), FROZEN,
    Fault("noise of 20 mV", ("T1.pickup=0.02",), readings="wrong", why="the mean of 16 conversions leaves a quarter of it"))
FLOW = (
    Fault("no pulses", ("T1.stopped=1",), ("out of range",), told_as="MEASUREMENT_BAD", why="no pulses are no flow; below meas1.lo"),
    Fault("each pulse comes as three", ("T1.bounce=1",), ("out of range",), told_as="MEASUREMENT_BAD", why=ABOVE),
    Fault("50 pulses a second from the wire", ("T1.pickup=50",), readings="wrong", why="they are as good as others"),
    Fault("3,000 pulses a second from the wire", ("T1.pickup=3000",), (RANGE,)))
LOCK = "lock2"
# A switch that is closed as long as all is well, with an interlock on it.
SWITCH = "S level PC8 quantity=T9 limit=80 hysteresis=1"
LOCKED = ("chan3.name S", "chan3.unit -", "chan3.device level", "chan3.select PC8", "meas3.name S", "meas3.unit -", "meas3.lo 0", "meas3.hi 1",
          "meas3.test off",
          "lock2.meas S", "lock2.mv Qrb", "lock2.side below", "lock2.limit 0.5", "lock2.hysteresis 0.1", "lock2.value 0")
LEVEL = (
    Fault("it is low", ("T9.stuck=20",), (LOCK,), back=("T9.free=1",), told_as="INTERLOCK_ON", why="no fault: the interlock acts"),
    Fault("wire broken", ("S.open=1",), (LOCK,), told_as="INTERLOCK_ON", why="reads as danger, as the switch is wired"),
    Fault("wires touch", ("S.short=1",), why="reads as the contact that is closed"),
    Fault("wires touch, it is low", ("S.short=1", "T9.stuck=20"), back=("S.short=0", "T9.free=1"), why="reads as a closed contact: danger is hidden"),
    Fault("jammed, it is low", ("S.jammed=1", "T9.stuck=20"), back=("S.jammed=0", "T9.free=1"), why="nobody can know: danger is hidden"),
    Fault("chatters each 5 ms", ("S.chatter=5",), (LOCK,), sometimes=True, told_as="INTERLOCK_ON", why="what it shows for 20 ms counts"),
    Fault("chatters each 0.1 s", ("S.chatter=100",), (LOCK,), sometimes=True, told_as="INTERLOCK_ON", why="a contact that closes and opens"))

DEVICES = (
    Device("max31865", "spi1", "spi1 PA4 reference=430 wires=3", ("device max31865", "bus spi1", "select PA4"),
           faults=MAX31865 + of_bus("spi1", True)),
    Device("max31856", "spi1", "spi1 PA4 type=K", ("device max31856", "bus spi1", "select PA4", "type K"), faults=MAX31856 + of_bus("spi1", True)),
    Device("ds18b20", "wire1", "wire1 rom=28-000005e2fdc3", ("device ds18b20", "bus wire1", "select 28000005e2fdc3"),
           faults=DS18B20 + of_bus("wire1", False)),
    Device("ads1115, 4-20 mA", "i2c1", "i2c1 0x48 2 lo=0 hi=200 lo_in=0.4 hi_in=2",
           ("device ads1115", "bus i2c1", "select 0x48", "input 2", "type 4-20mA", "lo 0", "hi 200"),
           faults=(*VOLTS, Fault("wire broken, 0 mA", ("T1.open=1",), ("out of range",), told_as="MEASUREMENT_BAD",
                         why="below meas1.lo, which tells before NAMUR NE 43 does"),
                   Fault("transmitter at 22.4 mA", ("T1.stuck=230",), ("out of range",), back=("T1.free=1",), told_as="MEASUREMENT_BAD",
                         why="above meas1.hi, which tells before NAMUR NE 43 does"), *of_bus("i2c1", False))),
    Device("ads1115, 0-10 V", "i2c1", "i2c1 0x48 2 lo=0 hi=200 lo_in=0 hi_in=2.5",
           ("device ads1115", "bus i2c1", "select 0x48", "input 2", "type 0-10V", "lo 0", "hi 200"),
           faults=(*VOLTS, Fault("wire broken, 0 V", ("T1.open=1",), ("out of range",), told_as="MEASUREMENT_BAD",
                         why="0 V is a value; below meas1.lo"), *of_bus("i2c1", False))),
    Device("bme280", "i2c1", "i2c1 0x76 pressure lo=0 hi=200 lo_in=30000 hi_in=110000", ("device bme280", "bus i2c1", "select 0x76"), "Pa",
           30000, 400, faults=(*of_all_chips(), *on_i2c(), *of_bus("i2c1", False))),
    Device("bme280_temperature", "i2c1", "i2c1 0x76 temperature lo=0 hi=200 lo_in=-40 hi_in=85",
           ("device bme280_temperature", "bus i2c1", "select 0x76"), zero=-40, slope=0.625,
           faults=(*of_all_chips(), *on_i2c(), *of_bus("i2c1", False))),
    Device("xgzp6897", "i2c1", "i2c1 0x6d lo=0 hi=200 lo_in=0 hi_in=1000", ("device xgzp6897", "bus i2c1", "select 0x6d", "reference 1"), "Pa", 0, 5,
           near=1.0, faults=(*of_all_chips(wrong=False),
                             Fault("wrong chip", ("T1.wrong=1",), readings="wrong", why="the chip has no identity"),
                             *on_i2c(), *of_bus("i2c1", False))),
    Device("analog, 4-20 mA", "pin", "PC0 lo=0 hi=200 lo_in=0.4 hi_in=2", ("device analog", "select PC0", "type 4-20mA", "lo 0", "hi 200"),
           faults=(*ANALOG, Fault("transmitter at 22.4 mA", ("T1.stuck=230",), ("out of range",), back=("T1.free=1",), told_as="MEASUREMENT_BAD",
                                  why="above meas1.hi, which tells before NAMUR NE 43 does"))),
    Device("analog, 0-10 V", "pin", "PC0 lo=0 hi=200 lo_in=0 hi_in=2.5", ("device analog", "select PC0", "type 0-10V", "lo 0", "hi 200"), faults=ANALOG),
    # A result is of half a second, so that a pulse more is 0.5 degC, and a millisecond of the fault up to 2 degC.
    Device("flow", "pin", "PC9 lo=0 hi=200 lo_in=0 hi_in=800", ("device flow", "select PC9"), "1/s", 0, 4, near=2.6, faults=FLOW),
    Device("level", "pin", "spi1 PA4 reference=430 wires=3", ("device max31865", "bus spi1", "select PA4"), faults=LEVEL, beside=SWITCH, more=LOCKED),
)
CHIP_OF = {"bme280_temperature": "bme280", "level": "max31865"}

# ---- loads ------------------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Load:
    """A heater, or the reflux, by a kind of output. faults: those of its chip, beside a load that is shorted or broken. off: the
    plant's value while the board lets that chip fall."""

    name: str
    wiring: tuple[str, ...]
    rows: tuple[str, ...]
    moved: str = "Qrb"
    faults: tuple[Fault, ...] = ()
    shorts: bool = True
    off: float | None = None


PULSES = ("Lr pwm PB0 lo=0 hi=12", "Qrb pwm PB1 lo=0 hi=1.5")
OUTPUT_ROWS = ("out1.name Lr", "out1.unit l/h", "out1.kind pwm", "out1.pin PB0", "out1.hi 12", "out2.name Qrb", "out2.unit kW", "out2.kind pwm",
               "out2.pin PB1", "out2.hi 1.5")
OUTPUT_GONE, NO_CURRENT, HOT = ("no chip answers",), ("no current flows",), ("chip too hot",)


def of_output_chip(name: str, current: bool) -> tuple[Fault, ...]:
    """Faults of the chip behind an output, which shares its bus with both thermometers."""
    def told(fault: str, event: str, says: tuple[str, ...], **more) -> Fault:
        return Fault(fault, (event,), says, told_as="OUTPUT_FAULT", **more)

    silent = "the chip knows of a current that does not flow, not of a voltage"
    return (told("open loop", f"{name}.open=1", NO_CURRENT) if current else told("open", f"{name}.open=1", (), why=silent),
            told("chip too hot", f"{name}.hot=1", HOT), told("missing chip", f"{name}.missing=1", OUTPUT_GONE),
            told("dead chip", f"{name}.dead=1", OUTPUT_GONE),
            told("brown-out", f"{name}.brownout=1", (), why="it gets its range and code again within a round"),
            told("bus stuck low", "spi1.stuck=1", OUTPUT_GONE, both=True),
            told("bus noise 1e-3", "spi1.noise=1e-3", OUTPUT_GONE, both=True, sometimes=True),
            told("bus noise 1e-2", "spi1.noise=1e-2", OUTPUT_GONE, both=True, sometimes=True))


def with_chip(row: int, more: str) -> tuple[str, ...]:
    return tuple(f"out{row}.{word}" for word in ("kind ad5422", "pin PC5", "pin2 PC4", "bus spi1", more))


CROSSINGS = "no zero crossings"
MAINS = (
    Fault("mains lost", ("mains.lost=1",), (CROSSINGS,), told_as="OUTPUT_FAULT", why="groups go on by time"),
    Fault("mains of 40 Hz", ("mains.shift=-10",), (CROSSINGS,), told_as="OUTPUT_FAULT", why="groups go on by time"),
    Fault("mains of 47 Hz", ("mains.shift=-3",), why="groups follow the mains"),
    Fault("30 pulses a second from the wire", ("mains.pickup=30",), sometimes=True, why="one that is too early does not count"))
LOADS = (
    Load("window", (PULSES[0], "Qrb ssr PB1 lo=0 hi=1.5"), ("out2.kind window",)),
    Load("burst", (PULSES[0], "Qrb ssr PB1 lo=0 hi=1.5"), ("out2.kind burst",)),
    Load("relay", (PULSES[0], "Qrb relay PB1 lo=0 hi=1.5"), ("out2.kind relay",)),
    Load("pwm", PULSES, ()),
    Load("analog", PULSES, ("out2.kind analog",)),
    Load("motor_valve", ("Lr valve PB0 PC2 lo=0 hi=12 travel=60", PULSES[1]), ("out1.kind motor_valve", "out1.pin2 PC2", "out1.travel 60"), "Lr", shorts=False),
    Load("stepper", ("Lr stepper PB0 PC2 steps=120 hi=12", PULSES[1]),
         ("out1.kind stepper", "out1.pin2 PC2", "out1.flow 12", "out1.steps 120", "out1.ramp 2000"), "Lr", shorts=False),
    Load("ad5422, 4-20 mA", ("Lr ad5422 spi1 PC4 clear=PC5 lo=0 hi=12", PULSES[1]), (*with_chip(1, "range 4-20mA"), "out1.safe 0.375"), "Lr",
         of_output_chip("Lr", True), off=0.0),
    Load("ad5422, 0-10 V", (PULSES[0], "Qrb ad5422 spi1 PC4 clear=PC5 signal=voltage lo=0 hi=1.5"), with_chip(2, "range 0-10V"),
         faults=of_output_chip("Qrb", False), off=0.0),
    Load("burst, zero crossings", (PULSES[0], "Qrb ssr PB1 lo=0 hi=1.5", "mains mains PC7"), ("out2.kind burst", "out2.zero_cross PC7"), faults=MAINS),
)
LOAD_WHY = "no pin reads what the load does; below, out.proof tells by what it does"
SHORTED, BROKEN = "shorted", "broken"
NOT_SHOWN = {
    "pulses": "the same pin and pulses as of flow, and a count leaves no range",
    "enable": "a wiring file has no contactor in series with the heaters",
}

# ---- states -----------------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class State:
    """settings: within the first transaction. lines: at the time that the state is entered."""

    name: str
    lines: tuple[str, ...] = ()
    settings: tuple[str, ...] = ()
    fault_s: float = FAULT_S
    falls_back: str = ""  # what T1's loop does, or what has the plant
    flickers: bool = False  # the fault is there in each other second


AUTO = ("mode top auto", "mode bottom auto")
ROWS = ("step1.seq start", "step1.do auto", "step1.what bottom", "step2.seq start", "step2.do auto", "step2.what top", "step2.until above",
        "step2.meas T1", "step2.limit {far}", "step2.timeout 5000")
STATES = {s.name: s for s in (
    State("manual"),
    State("auto", AUTO, falls_back="manual after hold"),
    State("auto, manual at once", AUTO, ("meas1.fallback manual",), falls_back="manual at once"),
    State("auto, substitute", AUTO, ("meas1.fallback substitute", "meas1.substitute {usual}"), falls_back="substitute"),
    State("auto, safe", AUTO, ("meas1.fallback safe",), falls_back="safe"),
    State("auto, each other second", AUTO, falls_back="flickers", flickers=True),
    State("from power-on", ("?mode top auto",), fault_s=0, falls_back="refused"),
    State("start-up", ("commission begin",), fault_s=TEST_STEP_S, falls_back="start-up ended"),
    State("sequence", ("seq start",), ROWS, falls_back="sequence held"),
)}
STATES_OF_LOADS = ("manual", "auto", "start-up", "sequence")


def settings(device: Device, load: Load, state: State, fault_settings: tuple[str, ...]) -> list[str]:
    """Console lines."""
    def eu(celsius: float) -> float:
        return device.zero + device.slope * celsius

    rows = ["io.source board", "tick.base 1", "chan1.name T1", f"chan1.unit {device.unit}", *(f"chan1.{row}" for row in device.rows)]
    rows += ["chan2.name T10", "chan2.unit degC", "chan2.device max31865", "chan2.bus spi1", "chan2.select PB12", *OUTPUT_ROWS, *load.rows]
    rows += ["meas1.name T1", f"meas1.unit {device.unit}", f"meas1.lo {eu(70):g}", f"meas1.hi {eu(130):g}", f"meas1.hold {HOLD_S}",
             "meas2.name T10", "meas2.unit degC", "meas2.lo 70", "meas2.hi 130", f"meas2.hold {HOLD_S}"]
    pilot = (ROOT / "host_sim" / "scenarios" / "pilot-pins.conf").read_text(encoding="utf-8").splitlines()
    rows += [line.removeprefix("set ") for line in pilot if re.match(r"set (mv|loop|lock)", line)]
    rows += [*device.more, *(row.format(far=eu(129), usual=eu(87.2)) for row in state.settings)]
    return ["begin", *(f"set {row}" for row in rows), *fault_settings, "apply", "log on"]


# ---- a run ------------------------------------------------------------------------------------------------------------------------


@dataclass
class Run:
    """said: (plant time, code, subject, the rest). rows: telemetry by the plant's time. log: the simulator's."""

    said: list[tuple[float, str, str, str]]
    rows: dict[float, dict[str, str]]
    log: list[dict[str, str]]
    transcript: str
    failed: str = ""
    warned: str = ""  # of rules of a data sheet that the firmware has broken


@dataclass(frozen=True)
class Job:
    """A cell. device: name of a device or of a load."""

    device: str
    fault: str
    state: str

    def __str__(self) -> str:
        return f"{self.device} | {self.fault} | {self.state}"


@dataclass
class Cell:
    """What came of it. wrong: against the oracle, else empty."""

    words: str
    wrong: list[str] = field(default_factory=list)


def load_faults(load: Load) -> tuple[Fault, ...]:
    names = (SHORTED, BROKEN) if load.shorts else (BROKEN,)
    return (*(Fault(name, (f"{load.moved}.{name}=1",), why=LOAD_WHY, lasts_s=LOAD_LASTS_S) for name in names), *load.faults)


def find(job: Job) -> tuple[Device, Load, Fault]:
    for device in DEVICES:
        for fault in device.faults:
            if (device.name, fault.name) == (job.device, job.fault):
                return device, LOADS[3], fault
    load = next(load for load in LOADS if load.name == job.device)
    return DEVICES[0], load, next(fault for fault in load_faults(load) if fault.name == job.fault)


def jobs() -> list[Job]:
    """Every cell."""
    out = [Job(device.name, fault.name, state) for device in DEVICES for fault in device.faults for state in STATES]
    return out + [Job(load.name, fault.name, state) for load in LOADS for fault in load_faults(load) for state in STATES_OF_LOADS]


def by_name(line: str) -> list[str]:
    return [re.sub(r"\[.*", "", name) for name in line.split(",")]


def telemetry(text: str, begin_s: float) -> dict[float, dict[str, str]]:
    """By plant time: a board's sample at its time begin_s is the plant's at 0."""
    names: list[str] = []
    rows = {}
    for line in text.splitlines():
        if line.startswith("H,"):
            names = by_name(line)
        else:
            row = dict(zip(names, line.split(",")))
            rows[float(row["time"]) - begin_s] = row
    return rows


def events(transcript: str) -> list[tuple[float, str, str, str]]:
    return [(float(at), code, subject, rest) for at, code, subject, rest in
            re.findall(r"^([\d.]+) < ! [\d.]+ \w+ ([A-Z_]+) (\S+) ?(.*)$", transcript, re.MULTILINE)]


def simulate(job: Job, place: Path | None = None, wire: Callable[[Path], str] | None = None) -> Run:
    """The run of a cell, on the host; with `wire` on the virtual board: a function that gives the port of one with this wiring file."""
    device, load, fault = find(job)
    state = STATES[job.state]
    kind = device.name.split(",")[0]
    wiring = [f"T1 {CHIP_OF.get(kind, kind)} {device.wiring}", "T10 max31865 spi1 PB12 reference=430 wires=3", *load.wiring,
              *filter(None, [device.beside])]
    end_s = state.fault_s + fault.lasts_s
    lines = [f"0 {line}" for line in settings(device, load, state, fault.settings)]
    lines += [f"3 out {name} {value:g}" for name, value in MANUAL.items()] + [f"{ENTER_S} {line}" for line in state.lines]
    changes = [(state.fault_s + at, fault.taken_back() if at % 2 else fault.events) for at in range(int(fault.lasts_s) if state.flickers else 1)]
    timed = [f"{at:g}:{name}" for at, names in (*changes, (end_s, fault.taken_back())) for name in names]
    return run(wiring, lines, timed, end_s + AFTER_S, place, wire)


def run(wiring: list[str], lines: list[str], timed: list[str], end_s: float, place: Path | None = None,
        wire: Callable[[Path], str] | None = None, plant: str = "pilot") -> Run:
    """A run of the pilot column, wired so, with console lines and events."""
    with tempfile.TemporaryDirectory(prefix="reflux-") as folder:
        out = place or Path(folder)
        (out / "wiring").write_text("\n".join(wiring) + "\n")
        (out / "script").write_text("\n".join([*lines, f"{end_s:g} ?status"]) + "\n")
        port = wire(out / "wiring") if wire else "memory"
        done = subprocess.run(
            [str(build.find_program("host", "reflux-sim" if wire else "reflux-sim-memory")), "--plant", plant, "--port", port, "--console", port,
             "--wiring", str(out / "wiring"), "--tick", "1", "--duration", f"{end_s:g}", "--script", str(out / "script"), "--log", str(out / "log"),
             "--telemetry", str(out / "telemetry"), "--transcript", str(out / "transcript"), "--timeout", str(PATIENCE_S),
             *(word for event in timed for word in ("--event", event))],
            capture_output=True, text=True, timeout=PATIENCE_S, check=False)
        said = (out / "transcript").read_text(errors="replace") if (out / "transcript").exists() else ""
        if done.returncode:
            return Run([], {}, [], said, done.stderr.strip()[-300:])
        log = [line for line in (out / "log").read_text().splitlines() if not line.startswith("#")]
        names = by_name(log[0])
        rows = [dict(zip(names, line.split(","))) for line in log[1:]]
        warned = "".join(re.findall(r"rules of data sheets broken: .*", done.stderr))
        return Run(events(said), telemetry((out / "telemetry").read_text(), begin_of(said)), rows, said, warned=warned)


def begin_of(transcript: str) -> float:
    """The board's time at the plant's 0, s: an event's line comes in the sample after it."""
    at, board = next((float(a), float(b)) for a, b in re.findall(r"^([\d.]+) < ! ([\d.]+) info OUTPUT ", transcript, re.MULTILINE))
    return board - at
