"""Every input of every command replaced by a folder, pipe, device, socket, dangling link, empty or endless file.

A command then ends with a sentence, in bounded time and memory. The laboratory's page, which goes on until it is
stopped, answers all questions about its sessions instead, and ends when it is asked to.
"""

from __future__ import annotations

import os
import shutil
import socket
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from benchmarks.checks import Check, Context, information
from benchmarks.misuse.calls import Call, Commands, Ending, commands
from benchmarks.misuse.cases import CASES, Case
from benchmarks.misuse.world import INPUTS, made_world

BOUND_S, BOUND_MB = 20.0, 600.0
"""Longest time and most memory of a command that meets such an input; ordinary refusals take a third of a second."""

HANGS_S = 40.0
ENDLESS_BYTES = 40 * 2**30
"""Size of a file without end; it takes no place on the disk."""

QUICK = 40
SHOWN = 25
OF_A_RESULT = ("motion.h5", "summary.json")
IN_FOLDERS = {
    "result": OF_A_RESULT,
    "session": ("P1/trial/motion.h5", "P1/trial/summary.json"),
    "study": ("P1/static.c3d",),
}
"""Files of folders that are replaced besides the folders themselves."""


@dataclass(frozen=True)
class Strange:
    """A command and what stands in the place of one input.

    Attributes:
        case: The command.
        name: The input.
        file: The file of an input folder; "" for the input itself.
        kind: What stands there.
    """

    case: Case
    name: str
    file: str
    kind: str

    @property
    def title(self) -> str:
        """The command and its input in words."""
        return f"{self.case.command}: {self.name}{' ' * bool(self.file)}{self.file} is {self.kind}"


def rows(context: Context) -> list[Check]:
    """All rows of strange inputs."""
    world = made_world(context.out / "laboratory")
    strange = list(strange_inputs(CASES))
    if context.quick:
        strange = strange[:: max(1, len(strange) // QUICK)]
    with commands(context.out / "servers") as run, ThreadPoolExecutor(run.workers) as pool:
        ends = list(
            pool.map(lambda pair: met(run, pair[1], world, context.out / f"{pair[0]}"), enumerate(strange))
        )
    return end_rows(strange, ends)


def strange_inputs(cases: Sequence[Case]) -> Iterator[Strange]:
    """Every input of every command once, by every kind; films, which read what other exports read, left out.

    Args:
        cases: Cases of the commands.
    """
    seen = set()
    for case in cases:
        for name in case.inputs:
            if (case.command, name) in seen or case.slow:
                continue
            seen.add((case.command, name))
            for file in ("", *IN_FOLDERS.get(name, ())):
                for kind in KINDS:
                    yield Strange(case, name, file, kind)


def met(run: Commands, strange: Strange, world: Path, place: Path) -> Ending:
    """Runs a command whose input is replaced.

    Args:
        run: Runs commands.
        strange: The command and the replaced input.
        world: The laboratory.
        place: Folder of copies of the inputs, to be made and removed.
    """
    place.mkdir()
    inputs = {}
    for name in strange.case.inputs:
        source = world / INPUTS[name]
        inputs[name] = place / INPUTS[name]
        (shutil.copytree if source.is_dir() else shutil.copy)(source, inputs[name])
    path = inputs[strange.name] / strange.file
    (shutil.rmtree if path.is_dir() else os.unlink)(path)
    held = KINDS[strange.kind](path)
    place.chmod(0o777)
    words = strange.case.call({name: str(one) for name, one in inputs.items()}, str(place / strange.case.out))
    try:
        return run.run(
            Call(
                words,
                place,
                seconds=HANGS_S,
                memory_mb=4 * BOUND_MB,
                unprivileged=held == SECRET,
                serves=strange.case.serves,
            )
        )
    finally:
        if isinstance(held, socket.socket):
            held.close()
        shutil.rmtree(place)


def end_rows(strange: Sequence[Strange], ends: Sequence[Ending]) -> list[Check]:
    """Rows of how commands ended that met strange inputs.

    Args:
        strange: Commands and inputs.
        ends: Their ends.
    """
    wrong = [
        f"{one.title}: {fault}"
        for one, end in zip(strange, ends, strict=True)
        if (fault := wrong_end(one, end))
    ]
    slow = max(ends, key=lambda end: end.seconds)
    large = max(ends, key=lambda end: end.memory_mb)
    return [
        Check(f"{len(ends)} inputs, ended without a sentence", len(wrong), 0, "<="),
        Check(f"slowest ({strange[ends.index(slow)].title})", slow.seconds, BOUND_S, "<=", "s"),
        Check(f"most memory ({strange[ends.index(large)].title})", large.memory_mb, BOUND_MB, "<=", "MB"),
        *(information(line, 1.0) for line in wrong[:SHOWN]),
    ]


def wrong_end(strange: Strange, end: Ending) -> str:
    """The reason why a command did not end as it must; "" where it did.

    Folders and empty files may be taken where they have a meaning. A batch ends with 1 where some trials fail, and so
    does the check of a marker set.

    Args:
        strange: The command and its input.
        end: Its end.
    """
    if end.code == 1 and strange.case.command in {"batch", "protocol check"} and "Traceback" not in end.err:
        return ""
    if end.code == 0 and strange.kind not in MAY_BE_TAKEN and not strange.file:
        return "taken"
    return end.unclean


SECRET = "secret"


def _folder(path: Path) -> None:
    path.mkdir()
    (path / "note.txt").write_text("x", "utf-8")


def _socket(path: Path) -> socket.socket | None:
    listening = socket.socket(socket.AF_UNIX)
    with suppress(OSError):  # its path may be too long; then the file is missing
        listening.bind(str(path))
        return listening
    listening.close()
    return None


def _secret(path: Path) -> str:
    path.write_text("x", "utf-8")
    path.chmod(0o000)
    return SECRET


def _endless(path: Path) -> None:
    with path.open("wb") as file:
        file.truncate(ENDLESS_BYTES)


KINDS: Mapping[str, Callable[[Path], object]] = {
    "a folder": _folder,
    "a pipe": os.mkfifo,
    "/dev/zero": lambda path: path.symlink_to("/dev/zero"),
    "/dev/null": lambda path: path.symlink_to("/dev/null"),
    "a terminal": lambda path: path.symlink_to("/dev/tty"),
    "a socket": _socket,
    "unreadable": _secret,
    "a dangling link": lambda path: path.symlink_to("nowhere"),
    "a link to itself": lambda path: path.symlink_to(path.name),
    "an empty file": lambda path: path.write_bytes(b""),
    "without end": _endless,
}  # fmt: skip
"""Makers of the things that take the place of an input file, by name."""

MAY_BE_TAKEN = {"a folder", "an empty file"}
