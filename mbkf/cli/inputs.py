"""Files named on the command line: inputs are protected, and outputs looked at, before a command begins its work.

Of a folder of results all parts are inputs of a command that makes one file of it, also those that it does not read.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from mbkf.cli.options import OUTPUTS, Output
from mbkf.io.atomic import check_file
from mbkf.io.files_read import files_read, own_files_read
from mbkf.io.written import FORM_OF_SUFFIX, overwriting

OTHER_PARTS = (
    "batch.json", "labels.json", "live.json", "subject.json", "subject.toml", "mounts.toml",
    "curves.csv", "curves.parquet", "summary.csv", "summary.parquet",
)  # fmt: skip
"""Names of files that batches, live runs and inertial commands write into folders, besides those of every result."""


@contextmanager
def inputs_protected(args: argparse.Namespace) -> Iterator[None]:
    """Protects the files that the options name as inputs, and permits replacing others with ``--overwrite``.

    Raises:
        ProtectedFile: An output is an input.
    """
    outputs = {one.dest for one in outputs_of(args)}
    to_folder = any(one.folder for one in outputs_of(args))
    makes_a_file = any(
        not one.folder and not (to_folder and getattr(args, one.dest) is None) for one in outputs_of(args)
    )
    with own_files_read(everywhere=True), overwriting(getattr(args, "overwrite", False)):
        for name, value in vars(args).items():
            if name not in outputs:
                for path in (*_files(value), *(_in_folders(value) if makes_a_file else ())):
                    files_read().add(path)
        yield


def check_outputs(args: argparse.Namespace) -> None:
    """Looks at the files that a command is to write; those in a folder are looked at by the command.

    Raises:
        ProtectedFile: One was read, mbkf did not write it, or it holds another format.
        FileFormatError: A file stands in the place of its folder.
        PermissionError: Its folder may not be written to.
    """
    for one in outputs_of(args):
        path = getattr(args, one.dest)
        if path is not None and not one.folder and not (one.either and Path(path).is_dir()):
            check_file(path, edits=edits_own_file(args, one), form=FORM_OF_SUFFIX.get(one.suffix))


def outputs_of(args: argparse.Namespace) -> tuple[Output, ...]:
    """The options of the command that name a file or folder to write."""
    return tuple(getattr(args, OUTPUTS, ()))


def edits_own_file(args: argparse.Namespace, output: Output) -> bool:
    """True where a command is to write the file that it edits."""
    out, edited = getattr(args, output.dest), getattr(args, output.edits, None)
    return out is not None and edited is not None and Path(out).exists() and _is_same(Path(out), Path(edited))


def _is_same(first: Path, second: Path) -> bool:
    return second.exists() and first.samefile(second)


def _files(value: object) -> Iterator[Path]:
    """The files that a value names, with "file:" before it or not."""
    for one in value if isinstance(value, list | tuple) else [value]:
        if isinstance(one, str):
            for text in (one, one.removeprefix("file:")):
                with suppress(OSError, ValueError):  # a text that cannot be a name
                    if Path(text).is_file():
                        yield Path(text)


def _in_folders(value: object) -> Iterator[Path]:
    """The parts of results in the folders that a value names."""
    from mbkf.io.results_folder import RESULT_FILES

    parts = {*RESULT_FILES, *OTHER_PARTS}
    for one in value if isinstance(value, list | tuple) else [value]:
        if isinstance(one, str) and one:
            with suppress(OSError, ValueError):
                yield from (path for path in Path(one).rglob("*") if path.name in parts)
