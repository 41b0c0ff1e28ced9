"""List presets, or show the settings of one.

A preset holds settings of a filter under a name. Some come with mbkf; those that 'mbkf tune' or you wrote lie in
~/.config/mbkf/presets, or in the folder MBKF_PRESETS. Use them with --preset, and change single settings with --set.

With a name, its settings and their source are shown. With --settings, every setting of a filter is listed with its
default and the values that it may have.

Examples:
  mbkf presets
  mbkf presets FDMC-literal
  mbkf presets --settings torque
  mbkf reconstruct walk.c3d --subject subject.toml --preset FD --set integrator=HE --out result
"""

from __future__ import annotations

import argparse
import json
import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mbkf.io.preset import Preset


def options(parser: argparse.ArgumentParser) -> None:
    """Adds the options."""
    shown = parser.add_mutually_exclusive_group()
    shown.add_argument("preset", metavar="NAME|FILE", nargs="?", help="preset to show")
    shown.add_argument(
        "--settings",
        choices=("kinematic", "torque", "dynamic"),
        help="list the settings of this filter",
    )
    parser.add_argument("--json", action="store_true", help="print everything as JSON")


def run(args: argparse.Namespace) -> int:
    """Prints the presets, one preset or the settings of a filter."""
    if args.settings is not None:
        rows = settings_of(args.settings)
        return _printed(args, rows, f"Settings of the {args.settings} filter")
    if args.preset is None:
        return _printed(args, listed(), "Presets")
    preset = _read(args.preset)
    if args.json:
        print(json.dumps(_plain(preset), indent=2, ensure_ascii=False))
        return 0
    _show(preset)
    return 0


def listed() -> list[dict[str, str]]:
    """A row for each preset: name, filter, origin, remark."""
    from mbkf.errors import MbkfError
    from mbkf.io.preset import read_preset, saved_presets, shipped_presets

    rows = []
    shipped, own = shipped_presets(), saved_presets()
    files = {**shipped, **{name: path for name, path in own.items() if name not in shipped}}
    for name, path in files.items():
        origin = "mbkf" if name in shipped else str(path)
        try:
            found = read_preset(path)
        except MbkfError as error:
            rows.append({"name": name, "filter": "", "origin": origin, "remark": str(error)})
            continue
        remark = found.note or (f"tuned on {', '.join(found.tuned_on)}" if found.tuned_on else "")
        rows.append({"name": name, "filter": found.filter, "origin": origin, "remark": remark})
    return rows


def settings_of(name: str) -> list[dict[str, str]]:
    """A row for each setting of a filter: name, default, possible values."""
    from mbkf.filters.given_settings import plain, possible
    from mbkf.filters.settings import flat, leaf_fields
    from mbkf.trial.preparation.settings import ReconstructSettings

    defaults = getattr(ReconstructSettings(), name)
    values = flat(defaults)
    return [
        {"setting": key, "default": _text(plain(one, values[key])), "values": possible(one, values[key])}
        for key, one in leaf_fields(defaults).items()
    ]


def _read(name: str) -> Preset:
    """A preset whose settings all exist and are possible."""
    from mbkf.io.preset import read_preset
    from mbkf.trial.preparation.presets import preset_path, with_preset
    from mbkf.trial.preparation.settings import ReconstructSettings

    with_preset(ReconstructSettings(), name)
    return read_preset(preset_path(name))


def _plain(preset: Preset) -> dict[str, object]:
    keys = ("name", "filter", "note", "source", "version", "tuned_on", "held_out")
    finite = {name: "inf" if value == math.inf else value for name, value in preset.values.items()}
    return {**{key: getattr(preset, key) for key in keys}, "values": finite}


def _show(preset: Preset) -> None:
    from mbkf.cli.tables import table, terminal

    console = terminal()
    shown = table(f"{preset.name} ({preset.filter} filter)", "setting", "value")
    for name, value in preset.values.items():
        shown.add_row(name, _text(value))
    console.print(shown)
    tuned = ", ".join(preset.tuned_on)
    for title, text in (("note", preset.note), ("source", preset.source), ("tuned on", tuned)):
        if text:
            console.print(f"{title}: {text}", soft_wrap=True)


def _printed(args: argparse.Namespace, rows: list[dict[str, str]], title: str) -> int:
    """Prints rows as a table or as JSON."""
    from rich.table import Table

    from mbkf.cli.tables import terminal

    if args.json:
        print(json.dumps(rows, indent=2, ensure_ascii=False))
        return 0
    shown = Table(title=title, title_justify="left")
    for heading in rows[0]:
        widest = max(len(row[heading]) for row in rows)
        shown.add_column(heading, min_width=widest if heading in ("name", "setting") else None)
    for row in rows:
        shown.add_row(*row.values())
    terminal().print(shown)
    return 0


def _text(value: object) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, tuple):
        return f"[{', '.join(f'{one:g}' for one in value)}]"
    return str(value)
