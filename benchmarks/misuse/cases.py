"""One or more calls of every command, with its inputs and its output; commands and options come from its parser.

An option that takes a value and stands in no case, nor among those that name no file, is uncovered; so a new command or
option fails the benchmark until it has a case.
"""

from __future__ import annotations

import argparse
import string
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Literal

from benchmarks.misuse.world import INPUTS
from mbkf.cli.main import build_parser
from mbkf.model.body_file import load_body

OUT = "OUT"
NO_FILES = {
    "acc=g,gyr=deg/s", "ADDRESS", "[ADDRESS:]PORT", "AXIS", "A,B", "A,B,C", "A,B@T0:T1", "CODE", "E",
    "FIRST:LAST:COUNT", "FRACTION", "FROM-TO", "HZ", "ID", "I/N", "IP", "KG", "KG|auto", "LABEL", "LIST", "M", "MS",
    "N", "NAME", "NAME=VALUE", "NAME[=FROM-TO]", "NAME|N", "PASSWORD", "PERSON", "S", "SD", "TEXT", "T0:T1", "UNIT",
    "WORD", "W,X,Y,Z|compared", "X", "X,Y,Z",
}  # fmt: skip
"""Values in help texts that name no file."""


@dataclass(frozen=True)
class Case:
    """A call of a command.

    Attributes:
        command: The command, of one or two words.
        words: What follows it: ``{name}`` is an input of :data:`benchmarks.misuse.world.INPUTS`, ``{OUT}`` the output.
        out: Name of an output that can be written, without suffix for a folder; "" for a command without output.
        sides: Ends of the names of files that are written beside an output file, after its name without suffix.
        again: Whether the same call takes the place of its own earlier output.
        slow: Whether it takes many seconds, so that it runs where it is refused only.
        runs: Whether it ends by itself, and well, where nothing is in the way.
        writes: Files that it would write into a folder, where it does not run.
        edits: Inputs that it may replace, since it is there to change them.
        serves: Whether it serves the laboratory's page until it is stopped.
        running: Files in the folder that tell of a run from its start on, so that they are of it also where it fails.
        rewrites: Files of an input folder that are its own output, which it wrote there without ``--out``.
    """

    command: str
    words: str
    out: str = ""
    sides: tuple[str, ...] = ()
    again: bool = True
    slow: bool = False
    runs: bool = True
    writes: tuple[str, ...] = ()
    edits: tuple[str, ...] = ()
    serves: bool = False
    running: tuple[str, ...] = ()
    rewrites: tuple[str, ...] = ()

    @cached_property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs, in the order of the words."""
        fields = (name for _, name, _, _ in string.Formatter().parse(self.words) if name and name != OUT)
        return tuple(dict.fromkeys(fields))

    @property
    def guarded(self) -> tuple[str, ...]:
        """Names of the inputs that it may not replace."""
        return tuple(name for name in self.inputs if name not in self.edits)

    @property
    def kind(self) -> Literal["file", "folder", ""]:
        """The kind of the output."""
        return "" if not self.out else "file" if Path(self.out).suffix else "folder"

    @property
    def name(self) -> str:
        """The command with the options that tell its cases apart."""
        return f"{self.command} {self.words}"

    def call(self, inputs: Mapping[str, str], out: str, *more: str) -> list[str]:
        """The words of the command.

        Args:
            inputs: Paths of inputs by their names; of others the usual ones.
            out: Path of the output.
            more: Words at the end.
        """
        paths = {**INPUTS, **inputs, OUT: out}
        return [*self.command.split(), *(word.format(**paths) for word in self.words.split()), *more]


DEMO = ("trial.c3d", "raw.c3d", "static.c3d", "subject.toml", "truth.h5", "result/motion.h5")
LIVE = ("motion.h5", "summary.json", "markers.trc", "live.json", "subject.toml", "mounts.toml")
ON_TRIAL = "--subject {subject} --forces {forces} --preset {preset}"
ON_IMUS = "{imus} --subject {subject}"
SURFACES = tuple(f"_{segment.name}.vtp" for segment in load_body("human18").segments)

CASES = (
    Case("demo", "--motion squat --seconds 1 --no-report --out {OUT}", "demo", slow=True, writes=DEMO),
    Case("synth", "--motion squat --seconds 1 --out {OUT}", "made"),
    Case("info", "{trc} --forces {forces}"),
    Case("info", "{qualisys}"),
    Case("info", "{motive}"),
    Case("scale", "{static} --trial {trial} --protocol {protocol} --body {body} --mass 70 --out {OUT}", "new.toml"),
    Case("scale", "--trial {trc} --forces {forces} --mass 70 --out {OUT}", "new.toml"),
    Case("label", "{raw} --subject {subject} --truth {trial} --out {OUT}", "new.c3d", (".json",)),
    Case("label", "{raw} --static {static} --protocol {protocol} --mass 70 --out {OUT}", "new.c3d", (".json", ".toml")),
    Case("reconstruct", "{trc} " + ON_TRIAL + " --out {OUT}", "new"),
    Case("reconstruct", "{trial} --subject {subject} --forces {forces} --emg {emg} --out {OUT}", "new"),
    Case("reconstruct", "{trial} --subject {subject} --imu {imus} --imu-mounts {mounts} --out {OUT}", "new"),
    Case("batch", "{study} --workers 1 --preset {preset} --filter dynamic --out {OUT}", "new"),
    Case("batch", "{list} --workers 1 --out {OUT}", "new"),
    Case("batch", "{listed} --workers 1 --out {OUT}", "new"),
    Case("replay", "{trc} --forces {forces} --to natnet --port 0 --wait 0.1 --speed 100", runs=False),
    Case("live", "--from file:{trc} --subject {subject} --forces {forces} --preset {preset} --speed 0 --out {OUT}",
         "new", running=("live.json",)),
    Case("live", "--from file:{trial} --mass 70 --protocol {protocol} --speed 0 --out {OUT}", "new", runs=False,
         writes=LIVE),
    Case("live", "--recover {result}", runs=False),
    Case("live", "--from file:{trc} --subject {subject} --speed 0 --out {OUT}-run --record {OUT}", "new.c3d",
         slow=True),
    Case("live", "--from file:{trial} --subject {subject} --plates {trial} --speed 0 --out {OUT}", "new", slow=True,
         writes=LIVE),
    Case("live", "--list --from udp", runs=False),
    Case("view", "{result} --html {OUT}", "new.html"),
    Case("report", "{result} --labels {labels} --out {OUT}", "new.html"),
    Case("report", "{session} --against {result} --norms {norms} --out {OUT}", "new.html", rewrites=("report.html",)),
    Case("report", "{session} --visits {earlier} --session {visit} --laboratory {laboratory} --out {OUT}", "new.html",
         rewrites=("report.html",)),
    Case("report", "{session} --curves {OUT}", "new.csv"),
    Case("report", "{session} --curves {OUT}", "new.parquet"),
    Case("norms build", "{session} --out {OUT}", "new.toml"),
    Case("norms import", "{bands} --age 20-40 --speed 1.1-1.4 --out {OUT}", "new.toml"),
    Case("norms export", "{norms} --out {OUT}", "new.csv"),
    Case("app", "{study} --no-browser", runs=False, serves=True),
    Case("tune", "{trc} {trial} --subject {subject} --forces {forces} --preset {preset} --hold-out {trial} --name new"
         " --runs 1 --out {OUT}", "new.toml", slow=True),
    Case("observability", "{protocol}"),
    Case("observability", "{protocol} --preset {preset}"),
    Case("presets", "{preset}"),
    Case("protocol list", ""),
    Case("protocol show", "{protocol} --no-browser --out {OUT}", "new.html"),
    Case("protocol guess", "{static} --trial {trial} --out {OUT}", "new.toml"),
    Case("protocol import", "{osim} --out {OUT}", "new.toml"),
    Case("protocol check", "{protocol} {static}"),
    Case("protocol edit", "{static} --protocol {protocol} --no-browser --out {OUT}", "new.toml", runs=False,
         edits=("protocol",)),
    Case("imu orient", "{imus} --frame NWU --out {OUT}", "new"),
    Case("imu orient", "{imus} --frame NWU --compare {still} --out {OUT}", "new"),
    Case("imu tune", "{still} --sensor pelvis --search --against smooth --frame NWU --out {OUT}", "new.json"),
    Case("imu tune", "{still} --sensor pelvis --search --against smooth --frame NWU --betas 0.01:0.1:2 --zetas 0:0.01:2"
         " --figure {OUT}", "new.png"),
    Case("imu synth", "{truth} --subject {subject} --mounts {mounts} --out {OUT}", "new.csv", (".toml",)),
    Case("imu angles", ON_IMUS + " --standing {imus} --posture {truth} --out {OUT}", "new"),
    Case("imu motion", ON_IMUS + " --standing {imus} --posture {truth} --out {OUT}", "new"),
    Case("imu live", "--from file:{still} --subject {subject} --posture {truth} --speed 0 --out {OUT}", "new",
         runs=False, writes=LIVE),
    Case("imu replay", "{imus} --wait 0.1 --speed 100", runs=False),
    Case("imu stride", "{imus} --sensor left_foot --out {OUT}", "new"),
    Case("export", "{subject} --to urdf --out {OUT}", "new.urdf", (".urdf.toml",)),
    Case("export", "{subject} --to mjcf --out {OUT}", "new.xml"),
    Case("export", "{subject} --to osim --out {OUT}", "new.osim", SURFACES),
    Case("export", "{result} --to c3d --out {OUT}", "new.c3d"),
    Case("export", "{result} --to c3d --trial {trial} --forces {forces} --out {OUT}", "new.c3d"),
    Case("export", "{result} --to csv --out {OUT}", "new.csv"),
    Case("export", "{result} --to summary --out {OUT}", "new.csv", ("_more.csv",)),
    Case("export", "{result} --to v3d --out {OUT}", "new.txt"),
    Case("export", "{result} --to mjcf --out {OUT}", "new.xml"),
    Case("export", "{result} --to bids --out {OUT}", "new"),
    Case("export", "{result} --to opensim --out {OUT}", "new"),
    Case("export", "{result} --onto {model} --out {OUT}", "new"),
    Case("export", "{result} --to bvh --out {OUT}", "new.bvh"),
    Case("export", "{result} --to glb --out {OUT}", "new.glb"),
    Case("export", "{result} --to mp4 --out {OUT}", "new.mp4", slow=True),
    Case("export", "{result} --to gif --out {OUT}", "new.gif", slow=True),
)  # fmt: skip


def commands_of(
    parser: argparse.ArgumentParser, words: tuple[str, ...] = ()
) -> Iterator[tuple[str, argparse.ArgumentParser]]:
    """Every command of a parser, groups left out, with its own parser."""
    groups = [action for action in parser._actions if isinstance(action, argparse._SubParsersAction)]
    if not groups:
        yield " ".join(words), parser
    for group in groups:
        for name, child in group.choices.items():
            yield from commands_of(child, (*words, name))


def uncovered(cases: tuple[Case, ...] = CASES, parser: argparse.ArgumentParser | None = None) -> list[str]:
    """Commands without a case, options that may name a file and stand in no case, and formats that are never asked for.

    Args:
        cases: The cases.
        parser: The parser whose commands they are; that of mbkf by default.
    """
    found = []
    for command, own in commands_of(parser or build_parser()):
        texts = [case.words.split() for case in cases if case.command == command]
        if not texts:
            found.append(command)
            continue
        given = {word for words in texts for word in words}
        for action in own._actions:
            if action.option_strings and _may_name_a_file(action) and not given & set(action.option_strings):
                found.append(f"{command} {action.option_strings[0]}")
            if command == "export" and action.dest == "to":
                found += [f"export --to {to}" for to in action.choices or () if to not in given]
    return found


def _may_name_a_file(action: argparse.Action) -> bool:
    takes_a_value = action.nargs != 0 and action.choices is None and action.type is not float
    return takes_a_value and action.metavar not in NO_FILES


def without_overwrite() -> list[str]:
    """Commands with an output and without ``--overwrite``."""
    writing = {case.command for case in CASES if case.kind}
    return [
        command
        for command, own in commands_of(build_parser())
        if command in writing and "--overwrite" not in own._option_string_actions
    ]
