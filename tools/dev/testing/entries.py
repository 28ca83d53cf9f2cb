"""Every test there is: its command, its labels, and the programs that must be built before it runs.

Nothing is built here. The build trees that a label needs are configured, because their entries stand in CMake's files.
"""

from __future__ import annotations

import re
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

from reflux import boards, build, launch
from reflux import scenario as scenarios
from reflux.errors import RunFailed
from reflux.paths import CAMPAIGNS, ROOT, SCENARIOS, every
from dev.testing import ctest_files

LABELS = ("unit", "loop", "fuzz", "target", "style", "tools", "campaign")
SANITIZED = ("asan", "asan-fixed")
AGAIN = "again"  # label of a test that tests/run_once.txt names, in the fixed-point tree
HANG_S = 1800.0  # Stops a test that hangs; far longer than any test takes on a busy machine.
LONG_S = 86400.0  # The same, of campaigns that the full tier runs whole.
COPIED = ("TIMEOUT", "WORKING_DIRECTORY", "RUN_SERIAL", "PROCESSORS", "RESOURCE_LOCK", "SKIP_RETURN_CODE")
LISTS = ("ENVIRONMENT", "FIXTURES_SETUP", "FIXTURES_CLEANUP", "FIXTURES_REQUIRED")
HOST = ("reflux-sim", "reflux-sim-memory", "reflux-plant", "reflux-host", "libreflux")
LIBRARIES = ("libreflux", "libreflux_board", "libreflux_lab")
CAMPAIGN_SHARE = 0.05
WITH_BLOCKS = ("stm32f405", "stm32f405-fixed")
ON_THE_FLASHED_BOARD = ("test_board_faults", "test_board_flips", "test_board_pins", "test_board_both", "test_board_watchdog", "test_pins_faults",
                        "test_io_check_board")
EVERYWHERE = ("smoke", "demo")  # scenarios that fit every image; the STM32F100 holds no other
# Unsupervised, because the tick in which a proposal is adopted depends on the speed of the main loop.
UNSUPERVISED = {f"self-tuning-{name}": ("begin", "set block1.supervise off", "apply") for name in ("one", "pair", "wood-berry")}
KALMAN = ("begin", "set block3.method ekf", "set block3.noise 0.2", "set block3.feed_z 0.02")

Needs = frozenset[tuple[str, str]]


@dataclass
class Test:
    """One entry of the tree that tools/test writes. needs: presets with a target each; "" means the whole preset."""

    name: str
    command: list[str]
    labels: list[str]
    needs: Needs = frozenset()
    properties: dict[str, object] = field(default_factory=dict)


def needs(preset: str, *targets: str) -> Needs:
    """Targets of one preset; without a target the whole preset."""
    return frozenset((preset, target) for target in targets or ("",))


def needs_of_firmware(*kinds: str) -> Needs:
    """Programs that scenarios on these firmwares run."""
    return frozenset().union(*(needs(preset, *targets) for kind in kinds for preset, targets in launch.programs_of(kind)))


def collect(labels: set[str]) -> list[Test]:
    """The tests of these labels, of both tiers."""
    tests: list[Test] = []
    if labels & {"unit", "loop", "fuzz"}:
        for preset in SANITIZED:
            tests += tree_tests(preset, labels)
    if "loop" in labels:
        tests += loop_tests()
    if "target" in labels:
        tests += target_tests()
    if "style" in labels:
        tests += style_tests()
    if "tools" in labels:
        tests += [*tree_tests("host", {"tools"}), *script_tests("tools"), *page_tests(), reach_test()]
    if "campaign" in labels:
        tests += campaign_tests()
    names = [test.name for test in tests]
    doubled = sorted({name for name in names if names.count(name) > 1})
    if doubled:
        raise RunFailed(f"two tests are called {doubled[0]}")
    return tests


def tree_tests(preset: str, labels: set[str]) -> list[Test]:
    """Tests that CMake knows in one build tree, with the preset before their names."""
    tree = build.configure(preset)
    out = []
    for entry in ctest_files.entries(tree):
        mine = entry.items("LABELS")
        if not labels & set(mine):
            continue
        properties: dict[str, object] = {key: entry.properties[key] for key in COPIED if key in entry.properties}
        for key in LISTS:
            if items := entry.items(key):
                properties[key] = [f"{preset}.{item}" for item in items] if key.startswith("FIXTURES") else items
        targets = [str(Path(program).relative_to(tree)) for program in entry.programs(tree)]
        out.append(Test(f"{preset}.{entry.name}", list(entry.command), mine, needs(preset, *targets) if targets else frozenset(),
                        properties))
    return out


def script(name: str, path: Path, label: str, wanted: Needs, *arguments: str) -> Test:
    """A Python test as a program of its own."""
    return Test(name, [sys.executable, str(path), *arguments], [label], wanted,
                {"TIMEOUT": LONG_S if path.stem == "test_board_campaign" else HANG_S})


def script_tests(label: str) -> list[Test]:
    """Every test_*.py of tests/LABEL. Images of the default tier, and host-fixed, are needed where the script names them."""
    files = sorted((ROOT / "tests" / label).glob("test_*.py"))
    if not files:
        raise RunFailed(f"tests/{label} has no test_*.py")
    always = needs("host", *HOST, *(LIBRARIES if label == "tools" else ()))
    out = []
    for path in files:
        if path.stem == "test_commands":  # page_tests()
            continue
        text = path.read_text(encoding="utf-8")
        known = ("host-fixed", *boards.BUILT_BY_DEFAULT, *(f"board-{kind}" for kind in boards.BUILT_BY_DEFAULT))
        named = [kind for kind in known if re.search(rf'"{re.escape(kind)}"', text)]
        wanted = always | needs_of_firmware(*(boards.BUILT_BY_DEFAULT if path.stem == "test_image" else named))
        if path.stem == "test_reference":
            wanted |= needs("host", "reference_tables", "plant_tables", "pin_tables")
        if path.stem in ("test_virtual_board", "test_watchdog", *ON_THE_FLASHED_BOARD):
            wanted |= needs("host", "reflux-board")
        if path.stem == "test_small_board_pins":
            wanted |= needs("host", "reflux-board") | needs("host-fixed", "reflux-sim", "reflux-sim-memory") | needs("stm32f100-pins")
        if path.stem == "test_board_campaign":
            wanted |= needs("host", "board-campaign")
        if path.stem == "test_board_io":
            wanted |= needs("host", "board-io") | needs("stm32f405")
        if path.stem in ON_THE_FLASHED_BOARD:
            wanted |= needs("stm32f405")
        if path.stem in ("test_self_checks", "test_virtual_board"):
            wanted |= needs("host", "board-self-checks") | needs("stm32f405")
        if path.stem == "test_run_once":
            wanted = needs("asan") | needs("asan-fixed")
        out.append(script(f"{label}.{path.stem.removeprefix('test_')}", path, label, wanted))
    return out


def page_tests() -> list[Test]:
    """The commands of README, CONTRIBUTING and of each page of docs/."""
    path = ROOT / "tests" / "tools" / "test_commands.py"
    answer = subprocess.run([sys.executable, str(path), "--list"], capture_output=True, text=True, check=False)
    pages = answer.stdout.split()
    if answer.returncode != 0 or not pages:
        raise RunFailed(f"tests/tools/test_commands.py --list: {answer.stderr.strip() or 'no page has a command'}")
    wanted = needs("host", *HOST, *LIBRARIES)
    quick = script("tools.commands-README-quick", path, "tools", wanted | needs("stm32f405"), "README.md", "--quick")
    return [quick, *(script(f"tools.commands-{Path(page).stem}", path, "tools", wanted, page) for page in pages)]


def reach_test() -> Test:
    """Test that tests/reach.txt has every source that each test runs."""
    return Test("tools.reach", [str(ROOT / "tools" / "coverage"), "--reach", "--check"], ["tools"], frozenset(),
                {"TIMEOUT": HANG_S, "PROCESSORS": 2})


def loop_tests() -> list[Test]:
    """The same scenario inside one process and over a socket gives one log; and whole-firmware tests."""
    return [same_log("loop.smoke-memory-and-host", "smoke", "memory", "host"), *script_tests("loop")]


def target_tests() -> list[Test]:
    """Tests of the images in the emulator and on the virtual board."""
    return [*target_logs(), *script_tests("target")]


def target_logs() -> list[Test]:
    """The same scenario on the host and on the image gives one log: in the emulator, and on the virtual board, which has the whole chip."""
    whole = [image for image in boards.RUNS if image.preset in WITH_BLOCKS]
    # Plants at the board's own pins are in target.board_pins.
    others = [path.stem for path in every(SCENARIOS, "*.toml") if path.stem not in EVERYWHERE and scenarios.load(path).wiring is None]
    return [*(same_log(f"target.{scenario}-{image.test}", scenario, *image.kinds) for scenario in EVERYWHERE for image in boards.RUNS
              if (scenario, image.test) != ("demo", "assert")),
            *(same_log(f"target.scenario-{scenario}-{image.test}", scenario, *image.kinds, lines=UNSUPERVISED.get(scenario, ()),
                       hang_s=4 * HANG_S)
              for scenario in others for image in whole if scenario not in image.too_large),
            # Parts of scenarios, in the emulator alone.
            *(same_log(f"target.self-tuning-{image.test}", "self-tuning-pair", *image.emulated, lines=UNSUPERVISED["self-tuning-pair"])
              for image in whole),
            *(same_log(f"target.decoupled-{image.test}", "kotyk-decoupled", *image.emulated) for image in whole),
            *(same_log(f"target.state-{image.test}", "pilot-state", *image.emulated, until=10800) for image in whole),
            *(same_log(f"target.ahead-{image.test}", "pilot-ahead", *image.emulated, until=3600) for image in whole),
            # Until it proposes.
            *(same_log(f"target.experiment-{image.test}", "kotyk-experiment", *image.emulated, until=135600) for image in whole),
            same_log("target.estimate-float", "methanol-estimate", "host", "stm32f405"),
            # Until the feed has changed: three components, and two with a linear model.
            *(same_log(f"target.kalman-{covariance}-{image.test}", "splitter-estimate", *image.emulated, until=5400,
                       lines=(*KALMAN, f"set block3.covariance {covariance}", "apply"))
              for covariance in ("full", "band") for image in whole),
            same_log("target.kalman-linear-float", "pilot-kalman", "host", "stm32f405", until=7200,
                     lines=("begin", "set block2.method kalman", "set block2.covariance band", "apply"))]


def same_log(name: str, scenario: str, *firmwares: str, lines: tuple[str, ...] = (), until: int | None = None,
             hang_s: float = HANG_S) -> Test:
    """One scenario on several firmwares, whose logs must be the same to the last bit."""
    ends = [] if until is None else ["--until", str(until)]
    test = script(name, ROOT / "tests" / "loop" / "same_log.py", name.split(".")[0], needs_of_firmware(*firmwares), *ends,
                  *(f"--line={line}" for line in lines), scenario, *firmwares)
    test.properties["TIMEOUT"] = hang_s
    return test


def style_tests() -> list[Test]:
    """Each check of tools/style; clang-analyzer looks at changed files, or at all of them in the full tier."""
    command = [str(ROOT / "tools" / "style")]
    checks = {"clang-format": ("clang-format",), "clang-tidy": ("clang-tidy",), "clang-analyzer": ("clang-analyzer", "--changed"),
              "clang-analyzer-all": ("clang-analyzer",)}
    return [Test(f"style.{name}", [*command, *words], ["style"], frozenset(), {"TIMEOUT": HANG_S, "PROCESSORS": 2})
            for name, words in checks.items()]


def campaign_tests() -> list[Test]:
    """A twentieth of each campaign's seeds, one run at a time."""
    files = sorted(CAMPAIGNS.glob("*.toml"))
    if not files:
        raise RunFailed("tests/campaign has no campaign")
    both = ("endurance", "self_tuner", "feedforward_tuner")
    wanted = (needs("host", *HOST, *LIBRARIES, *both, "endurance_kalman", "composition_campaign")
              | needs("host-fixed", *both, "libreflux_board"))
    return [Test(f"campaign.{path.stem}", [str(ROOT / "tools" / "campaign"), path.stem, "--fraction", f"{CAMPAIGN_SHARE:g}", "--check",
                                           "--no-build", "--jobs", "1"], ["campaign"], wanted, {"TIMEOUT": HANG_S}) for path in files]
