"""tools/image: proofs on the linked image, and where its memory goes."""

from __future__ import annotations

import argparse

from dev import image_check
from reflux import build, packages, table
from dev.elf_image import tool
from reflux.errors import UserError
from dev.image_check import Report
from reflux.paths import build_dir, shown


def main(arguments: list[str]) -> int:
    p = argparse.ArgumentParser(
        prog="tools/image",
        description="Proves on the linked image: no heap, no double precision, no streams, no setjmp, no recursion; "
        "worst-case stack with all interrupts on top fits; memory of each layer is within tests/target/budget.toml; only the "
        "workspace lies in core-coupled memory. "
        "Calls through pointers are listed in tests/target/indirect_calls.txt.")
    p.add_argument("presets", nargs="*", metavar="PRESET", help=f"images to check (default: {' '.join(image_check.presets())})")
    p.add_argument("--biggest", type=int, default=0, metavar="N", help="list the N biggest functions and objects as well")
    p.add_argument("--path", action="store_true", help="list the calls on the way to the deepest stack as well")
    p.add_argument("--no-build", action="store_true", help="do not build; use the images that are there")
    options = p.parse_args(arguments)
    if options.biggest < 0:
        raise UserError("--biggest must be 0 or more")
    for preset in options.presets:
        if preset not in image_check.presets():
            raise UserError(f'"{preset}" is not a preset of an image; there are {", ".join(image_check.presets())}')
    if not options.no_build:
        packages.need("host", "target")
    reports = []
    for preset in options.presets or image_check.presets():
        if not options.no_build:
            build.build(preset, (f"reflux-{preset.partition('-')[0]}",))
        report = image_check.check(build_dir(preset))
        reports.append(report)
        show(preset, report, options)
    findings = [line for report in reports for line in report.findings]
    if not options.presets:
        lost = image_check.unused_lines(reports)
        findings += lost
        print("".join(f"FAILED {line}\n" for line in lost), end="")
    print(f"\nimage: {len(reports)} checked, {len(findings)} findings")
    return 1 if findings else 0


def show(preset: str, report: Report, options: argparse.Namespace) -> None:
    print(f"\n{preset}: {report.name}\n")
    layers = sorted(report.layers.items(), key=lambda item: -item[1].flash() - item[1].ram())
    kinds = ["text", "data", "bss", *(["ccm"] if report.ccm() else [])]
    rows = [[name, *(str(getattr(s, kind)) for kind in kinds)] for name, s in layers]
    sums = [str(sum(getattr(s, kind) for _, s in layers)) for kind in kinds]
    print(table.columns(["layer", *kinds], [*rows, ["all", *sums]]))
    budget = report.budget
    print(f"\nimage {preset}: flash {report.flash()} of {budget['flash']} (aim {budget.get('aim_flash', '-')}), RAM owned for "
          f"ever, without stack, {report.ram()} of {budget['ram']}, without arena {report.ram() - report.arena} "
          f"(aim {budget.get('aim_ram', '-')})")
    if promised := budget.get("families"):
        print(f"families to come, {preset}: "
              + ", ".join(f"{name} {size}" for name, size in promised.items())
              + f"; {budget['flash'] - report.flash() - sum(promised.values())} are nobody's")
    print(f"sram {preset}: {report.sram_free()} of {report.sram()} bytes free, at least {budget['sram_free']} wanted")
    if report.workspace():
        print(f"workspace {preset}: {report.workspace()}, at least {budget['workspace']} wanted; {report.ccm()} of {budget['ccm']} "
              "bytes of the core-coupled memory are taken")
    print()
    print(f"flash {preset}: " + ", ".join(f"{name} {s.flash()}" for name, s in layers if s.flash()))
    print(f"ram {preset}: {ram_by_owner(report)}\n")
    rows = [[" / ".join(dict.fromkeys(c.entries)), str(c.deepest), str(c.frame)] for c in report.contexts]
    print(table.columns(["context", "stack", "exception frame"], rows))
    print(f"\nstack {preset}: {report.stack_needed} of {report.stack_reserved} bytes in the worst case, "
          f"{report.stack_reserved - report.stack_needed} left")
    print(f"calls {preset}: {report.functions} functions, {report.pointer_calls} calls through pointers, all listed: "
          f"{'no' if any(f.startswith('pointer') for f in report.findings) else 'yes'}; frames of "
          f"{report.frames_agree} functions agree with the compiler's")
    if options.path:
        for context in report.contexts:
            print(f"\n{' / '.join(context.entries)}:")
            print("\n".join(f"  {size:6d}  {name}" for name, size in context.path))
    if options.biggest:
        biggest(preset, report, options.biggest)
    print("".join(f"FAILED {line}\n" for line in report.findings), end="")


def ram_by_owner(report: Report) -> str:
    """Lists the RAM without arena, stack and workspace: the parts of struct app, then what the port keeps."""
    size = report.image.struct_bytes()
    startup = "commission" in report.layers
    link = ["plant_link"] if "link" in report.layers else []  # else the struct is declared, and nobody has one
    owners = ["supervisor", "service", *link, "console", "storage", *(["commission"] if startup else [])]
    parts = [(n.replace("_", " "), size[n] - (report.arena if n == "supervisor" else 0)) for n in owners]
    parts.append(("rest of app", size["app"] - sum(size[n] for n in owners)))
    parts.append(("port and libraries", report.ram() - report.arena - sum(n for _, n in parts)))
    leased = (f"; start-up leases {size['commission_work']}, tests {size['experiment']} and analysis "
              f"{size['analysis']} by turns") if startup else ""
    return ", ".join(f"{name} {n}" for name, n in parts) + f"; a plan is {size['plan']} of service{leased}"


def biggest(preset: str, report: Report, count: int) -> None:
    rows = []
    for line in tool("nm", "-S", "--size-sort", "-r", str(report.image.path)).splitlines():
        parts = line.split()
        if len(parts) == 4:
            rows.append([parts[3], str(int(parts[1], 16)), "RAM" if parts[2].lower() in "bd" else "flash"])
    for where in ("flash", "RAM"):
        print(f"\nbiggest in {where} of {preset}:")
        print(table.columns(["name", "bytes", "where"], [row for row in rows if row[2] == where][:count]))
    print(f"(the map: {shown(report.image.path.with_suffix('.map'))})")
