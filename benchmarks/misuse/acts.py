"""Acts with files: a command whose output stands where an input, a foreign file or an earlier output is."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Literal

from benchmarks.misuse.cases import Case
from benchmarks.misuse.world import INPUTS

IN, OTHER, DOOR = "in", "other", "door"
"""Folders of an act: inputs, links to them, and a link to the inputs' folder."""

NEW = "new"
FOREIGN: Mapping[str, bytes] = {
    "a photo": b"\xff\xd8\xff\xe0\x00\x10JFIF\x00\x01" + bytes(64),
    "notes": b"measured on Monday; knee brace on the left\n",
    "a table": b"time;Fx;Fy\n0;1;2\n",
    "a page": b"<!DOCTYPE html><title>Our laboratory</title>",
}
"""Contents of files that mbkf did not write."""

Must = Literal["refused", "done", "kept"]
"""The end that an act must have: a refusal, success, or either; see :class:`Act`."""

Aliased = Callable[[Path, Path, str], Path]
"""From an act's folder, an input and a suffix to another path of the input with that suffix, if it is a link."""


@dataclass(frozen=True)
class Scene:
    """The folder of an act.

    Attributes:
        folder: The folder.
        inputs: Paths of the inputs in it, by their names.
    """

    folder: Path
    inputs: dict[str, Path]


Set = tuple[Mapping[str, Path], Path]
"""Inputs that are given by other paths, and the path of the output."""


@dataclass(frozen=True)
class Act:
    """A command and the file that is in its way.

    Attributes:
        case: The command.
        kind: The kind of the act, for counts.
        title: The act in words.
        setting: Makes links or files in the act's folder; returns paths of inputs that moved, and that of the output.
        must: "refused" in one sentence, "done" with exit code 0, or "kept": either, but all that was there stays.
        more: Words at the end of the command.
        earlier: Words at the end of commands that run before it.
    """

    case: Case
    kind: str
    title: str
    setting: Callable[[Scene], Set]
    must: Must = "refused"
    more: tuple[str, ...] = ()
    earlier: tuple[tuple[str, ...], ...] = ()

    def prepare(self, world: Path, place: Path) -> list[str]:
        """Makes the act's folder from the laboratory; returns the words of the command."""
        (place / IN).mkdir()
        (place / OTHER).mkdir()
        inputs = {}
        for name in self.case.inputs:
            source, inputs[name] = world / INPUTS[name], place / IN / INPUTS[name]
            if source.is_dir():
                shutil.copytree(source, inputs[name])
            else:
                shutil.copy(source, inputs[name])
        for beside in {"list", "listed"} & set(inputs):  # lists name captures beside them
            for name in ("trial.c3d", "static.c3d"):
                shutil.copy(world / name, inputs[beside].parent)
        given, out = self.setting(Scene(place, inputs))
        return self.case.call({name: str(path) for name, path in {**inputs, **given}.items()}, str(out))

    def must_stay(self, place: Path, name: str) -> bool:
        """True for a file that must stay as it is: where the command may overwrite, an input."""
        return self.must != "done" or (place / name).is_relative_to(place / IN)


def acts_of(case: Case, world: Path, outputs: Sequence[str]) -> Iterator[Act]:
    """All acts of a case.

    Args:
        case: The case.
        world: The laboratory.
        outputs: Files that the case writes into a folder, relative to it.
    """
    if case.kind == "file":
        yield from _file_over_inputs(case, world)
        yield from _file_over_foreign(case)
    elif case.kind == "folder":
        yield from _folder_over_inputs(case, world, outputs)
        yield from _folder_over_foreign(case, outputs)
    if case.kind and case.runs and not case.slow:
        yield Act(
            case,
            "own output",
            f"{case.command}: its own output again",
            partial(_free, name=case.out),
            "done",
            earlier=((),),
        )


def _free(scene: Scene, name: str) -> Set:
    return {}, scene.folder / name


def _file_over_inputs(case: Case, world: Path) -> Iterator[Act]:
    """An output file at every path of every input, or of every file of an input folder."""
    suffix = Path(case.out).suffix

    def over(scene: Scene, name: str, file: str, alias: Aliased) -> Set:
        return {}, alias(scene.folder, scene.inputs[name] / file, suffix)

    def beside(scene: Scene, name: str, side: str, link: bool) -> Set:
        target = scene.inputs[name]
        if link:
            target = _linked(scene.folder, target, side)
        return {}, target.with_name(target.name.removesuffix(side) + suffix)

    for name in case.guarded:
        source = world / INPUTS[name]
        files = sorted(str(path.relative_to(source)) for path in source.rglob("*") if path.is_file()) or [""]
        for k, file in enumerate(file for file in files if file not in case.rewrites):
            for way, alias in WAYS.items() if k == 0 else [("itself", _itself)]:
                title = f"{case.command}: output over {name} {file}, {way}"
                yield Act(
                    case, "output over an input", title, partial(over, name=name, file=file, alias=alias)
                )
        for side in case.sides:
            for link in (False, True) if source.suffix == side else (True,):
                title = f"{case.command}: {side} beside the output over {name}{', linked' * link}"
                yield Act(
                    case, "output over an input", title, partial(beside, name=name, side=side, link=link)
                )


def _file_over_foreign(case: Case) -> Iterator[Act]:
    """An output file over files that mbkf did not write, with and without leave."""

    def over(scene: Scene, suffix: str, content: bytes) -> Set:
        out = scene.folder / NEW / case.out
        out.parent.mkdir()
        out.with_name(out.stem + suffix).write_bytes(content)
        return {}, out

    own = Path(case.out).suffix
    for suffix in (own, *case.sides):
        for word, content in FOREIGN.items():
            title = f"{case.command}: {suffix} over {word}"
            setting = partial(over, suffix=suffix, content=content)
            yield Act(case, "output over a foreign file", title, setting)
        if case.runs and not case.slow:
            yield Act(case, "foreign file, --overwrite", title, setting, "done", ("--overwrite",))


def _folder_over_inputs(case: Case, world: Path, outputs: Sequence[str]) -> Iterator[Act]:
    """An output folder in which an input has the name of an output, and folders that are or hold inputs."""

    def named(scene: Scene, name: str, output: str, how: str) -> Set:
        at = scene.folder / NEW / output
        at.parent.mkdir(parents=True)
        if how == "itself":
            scene.inputs[name].rename(at)
            return {name: at}, scene.folder / NEW
        if how == "symbolic link":
            at.symlink_to(scene.inputs[name])
        else:
            os.link(scene.inputs[name], at)
        return {}, scene.folder / NEW

    def at_input(scene: Scene, name: str) -> Set:
        return {}, scene.inputs[name]

    def around(scene: Scene) -> Set:
        return {}, scene.folder / IN

    for k, name in enumerate(case.guarded):
        source = world / INPUTS[name]
        whole: Must = "kept" if source.is_dir() else "refused"
        yield Act(
            case,
            "output over an input",
            f"{case.command}: folder at {name}",
            partial(at_input, name=name),
            whole,
        )
        if source.is_dir():
            continue
        for output in outputs:
            if Path(output).suffix == source.suffix:
                title = f"{case.command}: {name} is {output} of the folder"
                yield Act(
                    case,
                    "output over an input",
                    title,
                    partial(named, name=name, output=output, how="itself"),
                )
        for how in ("symbolic link", "hard link") if outputs else ():
            output = outputs[k % len(outputs)]
            title = f"{case.command}: {output} of the folder is a {how} to {name}"
            yield Act(case, "output over an input", title, partial(named, name=name, output=output, how=how))
    if case.inputs:
        yield Act(
            case, "inputs in the output folder", f"{case.command}: inputs in the folder", around, "kept"
        )


def _folder_over_foreign(case: Case, outputs: Sequence[str]) -> Iterator[Act]:
    """An output folder with foreign files under the names of outputs."""

    def over(scene: Scene, names: Sequence[str], content: bytes) -> Set:
        for name in names:
            at = scene.folder / NEW / name
            at.parent.mkdir(parents=True, exist_ok=True)
            at.write_bytes(content)
        return {}, scene.folder / NEW

    contents = list(FOREIGN.items())
    for k, output in enumerate(outputs):
        word, content = contents[k % len(contents)]
        setting = partial(over, names=(output,), content=content)
        yield Act(case, "output over a foreign file", f"{case.command}: {output} is {word}", setting)
    if outputs and case.runs and not case.slow:
        setting, title = partial(over, names=outputs, content=contents[0][1]), f"{case.command}: all foreign"
        yield Act(case, "foreign file, --overwrite", title, setting, "done", ("--overwrite",))


def _itself(_place: Path, path: Path, _suffix: str) -> Path:
    return path


def _relative(place: Path, path: Path, _suffix: str) -> Path:
    return Path(os.path.relpath(path, place))


def _around(place: Path, path: Path, _suffix: str) -> Path:
    return Path(f"{place}/{IN}/../{path.relative_to(place)}")


def _linked(place: Path, path: Path, suffix: str) -> Path:
    link = place / OTHER / f"link{suffix}"
    link.symlink_to(path)
    return link


def _twice_linked(place: Path, path: Path, suffix: str) -> Path:
    second = place / OTHER / f"second{suffix}"
    second.symlink_to(_linked(place, path, suffix).name)
    return second


def _hard_linked(place: Path, path: Path, suffix: str) -> Path:
    link = place / OTHER / f"hard{suffix}"
    os.link(path, link)
    return link


def _through_a_door(place: Path, path: Path, _suffix: str) -> Path:
    (place / DOOR).symlink_to(place / IN)
    return place / DOOR / path.relative_to(place / IN)


def _in_capitals(_place: Path, path: Path, _suffix: str) -> Path:
    other = path.with_name(path.name.upper())
    return other if other.exists() else path  # the same file where the system ignores the case


WAYS: Mapping[str, Aliased] = {
    "itself": _itself, "by a relative path": _relative, "by ..": _around, "by a symbolic link": _linked,
    "by two links": _twice_linked, "by a hard link": _hard_linked, "by a linked folder": _through_a_door,
    "in capitals": _in_capitals,
}  # fmt: skip
"""Ways to name a file that is already there."""
