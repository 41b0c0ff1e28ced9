"""Settings that the thesis names, and whether a preset file and a command reach them; wrong ones and their refusal."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from itertools import product
from pathlib import Path
from typing import NamedTuple

from mbkf.cli.main import build_parser, main
from mbkf.cli.options import with_chosen
from mbkf.errors import MbkfError
from mbkf.filters.settings import flat
from mbkf.io.preset import Preset, Value, read_preset, shipped_presets, write_preset
from mbkf.trial.preparation.presets import with_preset
from mbkf.trial.preparation.settings import ReconstructSettings

COMMANDS: Mapping[str, tuple[str, ...]] = {
    "reconstruct": ("trial.c3d", "--subject", "subject.toml", "--out", "out"),
    "batch": ("folder", "--out", "out"),
    "live": ("--from", "file:trial.c3d", "--out", "out"),
}
"""Commands that run any filter, with the words that each needs."""

INFINITE = float("inf")
INDEPENDENT = {"noise": "independent"}
TORQUES = {"force_state": "torque"}


@dataclass(frozen=True)
class Asked:
    """A setting of the thesis.

    Attributes:
        name: Its name here.
        values: Values that the thesis uses or names.
        place: Where.
        filter: The filter that has it.
        beside: Settings that it needs.
    """

    name: str
    values: tuple[Value, ...]
    place: str
    filter: str = "torque"
    beside: Mapping[str, Value] = field(default_factory=dict)


ASKED = (
    Asked("integrator", ("FE", "HE", "TF", "TN"), "thesis eqs. 3.32 to 3.35, Table A.2"),
    Asked("propagation", ("first", "second", "exponential"), "thesis eqs. 3.51, 3.52, 2.39"),
    Asked("covariance", ("series", "van_loan"), "thesis eqs. 2.45, 2.43"),
    Asked("complete", (True, False), "thesis eqs. 3.40, 4.15, Table A.3"),
    Asked("mean_slope", (True, False), "mbkf's own"),
    Asked("substeps", (1.0, 2.0), "mbkf's own"),
    Asked("plates", ("sensors", "inputs"), "thesis 3.2.3"),
    Asked("force_state", ("torque",), "thesis eq. 3.36"),
    Asked("wrench_frame", ("thesis",), "thesis 4.1.4.1"),
    Asked("noise", ("independent",), "thesis 3.2.3"),
    Asked("per_frame", (True, False), "Table 4.3 as thesis eq. 2.47 or as densities", beside=INDEPENDENT),
    Asked("residual_spread_force_n", (INFINITE,), "thesis 3.1.3, a random walk alone", beside=TORQUES),
    Asked("residual_spread_moment_nm", (INFINITE,), "thesis 3.1.3, a random walk alone", beside=TORQUES),
    Asked("residual_force_n", (10.0, 0.0), "thesis 4.1.4.1 (1), Table 4.3; small or zero, 3.3.1"),
    Asked("residual_vertical_force_n", (10.0, 0.0), "thesis 4.1.4.1 (2), Table 4.3"),
    Asked("residual_moment_nm", (5.0, 0.0), "thesis 4.1.4.1 (3), Table 4.3"),
    Asked("load_force_n", (20.0,), "thesis 4.1.4.1 (4), Table 4.3"),
    Asked("load_vertical_force_n", (20.0,), "thesis 4.1.4.1 (5), Table 4.3"),
    Asked("load_moment_nm", (20.0,), "thesis 4.1.4.1 (6), Table 4.3"),
    Asked("upper_torque_nm", (5.0,), "thesis Table 4.3", beside=INDEPENDENT),
    Asked("lower_torque_nm", (20.0,), "thesis Table 4.3", beside=INDEPENDENT),
    Asked("toe_acceleration", (10.0,), "thesis Table 4.3"),
    Asked("marker_noise_m", (0.005,), "thesis 4.1.4.1 (7), Table 4.3"),
    Asked("plate_force_n", (20.0,), "thesis 4.1.4.1 (8), Table 4.3"),
    Asked("plate_vertical_force_n", (20.0,), "thesis 4.1.4.1 (8)"),
    Asked("plate_moment_nm", (20.0,), "thesis 4.1.4.1 (8), Table 4.3"),
    Asked("acceleration_scale", (0.5, 2.0), "thesis eq. 3.3, factor on the body's table", "kinematic"),
    Asked("marker_noise_m", (0.005,), "thesis 3.1.2", "kinematic"),
    Asked("gate_radius_m", (0.05,), "thesis 4.1.3", "kinematic"),
)
"""Settings of the thesis's filters, with their values."""

REFUSED = (
    "integrater = 'FE'",
    "integrator = 'Heun'",
    "integrator = 1",
    "complete = 'yes'",
    "per_frame = true",
    "plate_force_n = 0",
    "load_force_n = -20",
    "substeps = 1.5",
    "residual_spread_force_n = inf",
    "plates = 'inputs'\nplate_force_n = 20",
    "noise = 'independent'\njerk_scale = 2",
    "lower_torque_nm = 20",
    "gate = nan",
)
"""Values of a preset of the torque filter with an unknown, impossible or contradictory setting."""


class Reach(NamedTuple):
    """Ways that reach a setting with all its values: preset files, and every command."""

    by_preset: bool
    by_command: bool


def reached(folder: Path) -> list[Reach]:
    """The reach of each of :data:`ASKED`; files go to ``folder``."""
    return [Reach(_by_preset(one, folder / "asked.toml"), _by_command(one)) for one in ASKED]


def _by_preset(asked: Asked, path: Path) -> bool:
    return all(_holds(asked, value, partial(_of_file, asked, value, path)) for value in asked.values)


def _of_file(asked: Asked, value: Value, path: Path) -> ReconstructSettings:
    write_preset(Preset("asked", asked.filter, {**asked.beside, asked.name: value}), path)
    return with_preset(ReconstructSettings(), str(path))


def _by_command(asked: Asked) -> bool:
    cases = product(COMMANDS, asked.values)
    return all(_holds(asked, value, partial(_of_command, asked, value, command)) for command, value in cases)


def _of_command(asked: Asked, value: Value, command: str) -> ReconstructSettings:
    given = {**asked.beside, asked.name: value}
    options = [word for name, one in given.items() for word in ("--set", f"{name}={_written(one)}")]
    words = [command, *COMMANDS[command], "--filter", asked.filter, *options]
    args = build_parser((command,)).parse_args(words)
    return with_chosen(ReconstructSettings(filter=args.filter), args)


def _holds(asked: Asked, value: Value, settings: Callable[[], ReconstructSettings]) -> bool:
    try:
        found = settings()
    except MbkfError:
        return False
    return found.filter == asked.filter and flat(getattr(found, asked.filter))[asked.name] == value


def _written(value: Value) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


def refused(folder: Path) -> list[bool]:
    """Whether each of :data:`REFUSED` ends in one line and exit 2."""
    path, found = folder / "refused.toml", []
    for values in REFUSED:
        path.write_text(f"filter = 'torque'\n[values]\n{values}\n", encoding="utf-8")
        said = io.StringIO()
        with contextlib.redirect_stderr(said), contextlib.redirect_stdout(io.StringIO()):
            code = main(["presets", str(path)])
        found.append(code == 2 and said.getvalue().count("\n") == 1)
    path.unlink()
    return found


def shipped_in_order() -> list[bool]:
    """Whether each preset that comes with mbkf can be used and has a note and a source."""
    found = []
    for name, path in shipped_presets().items():
        with_preset(ReconstructSettings(), name)
        preset = read_preset(path)
        found.append(bool(preset.note and preset.source))
    return found
