"""The guard of everything that is written: files that were read stay, and so do those that mbkf did not write.

mbkf recognises its own files and their formats by their content: :data:`MARK` in their heading or in the format's place
for the program's name. Formats without such a place, and files of earlier versions, are recognised by headings that no
other program writes.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from mbkf.errors import ProtectedFile
from mbkf.io.files_read import files_read, kind_of

MARK = "written by mbkf"
"""Text in the files that mbkf writes."""

BVH_BLANKS = "  \t"
"""End of the first line of a BVH file: the format has no comments, and its readers skip blanks."""

OVERWRITE_VARIABLE = "MBKF_OVERWRITE"
"""Environment variable that permits replacing files of other programs, here and in the processes started from here."""

_HEAD_BYTES, _TAIL_BYTES = 1 << 20, 1 << 18
"""A film names its program after its table of pictures, a Parquet table in its last block."""

_MARK = MARK.encode()

_HEADED = rb"(?:#[^\n]*\n){0,3}#[^\n]*" + _MARK

PAGE, SETTINGS, TABLE, DATA = "a page (HTML)", "settings (TOML)", "a table (CSV)", "data (JSON)"

_FORMS: Mapping[str, tuple[bytes, ...]] = {
    SETTINGS: (
        rb"(?=(?:#[^\n]*\n|[ \t\r]*\n)*(?:\[|[\w\"'-]+ = ))" + _HEADED,
        rb"# (?:Settings of a filter of mbkf;|Reference bands of a laboratory\.\n|Inertial sensors on a body; )",
    ),
    TABLE: (
        _HEADED,
        rb"# orientation: sensor -> ",
        rb"time_s,tracked,valid,measured,",
        rb"trial,protocol,filter,version,mass_kg,frames,",
        rb"trial,key,value\n[^\n]*,",
        rb"foot,(?:stride,start_s,end_s|time_s,x_m,y_m),",
        rb'"session","kind","trial","side","start_s","duration_s","toe_off_percent",',
        rb'"subject","session","trial","(?:capture","status","reason|side","cycle)"',
    ),
    "markers (TRC)": (
        rb"PathFileType[^\n]*\t" + _MARK,
        rb"PathFileType\t4\t\(X/Y/Z\)\tmarkers\.trc\n[^\n]*\n([\d.]+)\t\1\t\d+\t\d+\tmm\t\1\t1\t\d+\n"
        rb"[^\n]*\n[^\n]*\n\n1\t\d+\.\d{8}\t(?:-?\d+\.\d{6}|NaN)\t",
    ),
    "curves (MOT)": (
        rb"[^\n]*\nversion=1\nnRows=\d+\n(?:[^\n=]*=[^\n]*\n){0,40}?(?:Run=[0-9a-f]{32}|Source="
        + _MARK
        + rb")\n",
        rb"Source=" + _MARK + rb"\nDataRate=",
    ),
    DATA: (
        rb"\{?\s*\}?\s*\Z",  # the room reserved for live.json, or cut short at once
        rb'\{"format": "mbkf ',
        rb'\{\s*"run_id": "[0-9a-f]{32}"',
        rb'\{\s*"trial": [^\n]*\s*"protocol": [^\n]*\s*"filter": ',
        rb'\{\s*"version": [^\n]*\s*"method": [^\n]*\s*"method_meaning": ',
        rb'\{\s*"method": [^\n]*\s*"compared_with": ',
        rb'\{\s*"filter": [^\n]*\s*"samples": \d+,\s*"range_deg": ',
        rb'\{\s*"frames": \d+,\s*"markers": \d+,\s*"assigned_fraction": ',
        rb'\{\s*"files": \{.*"settings": \{.*"version": ',
        rb'\{\s*"state": "[^\n]*\s*"source": ',
        rb'\{\s*"sensors": \[\s*\{\s*"name": [^\n]*\s*"procedure": ',
        rb'\{\s*"[^\n]*": \{\s*"state": "(?:waiting|running|finished|cancelled|failed)"',
    ),
    "arrays (HDF5)": (
        rb"mbkf: \d+ bytes after this block",
        rb"\0*\x89HDF.*mbkf (?:reconstruction|truth)",
    ),
    "a capture (C3D)": (rb".P.*MANUFACTURER.*" + _MARK,),
    "a motion (BVH)": (rb"HIERARCHY" + BVH_BLANKS.encode() + rb"\r?\n",),
    "a scene (glTF)": (rb'glTF.{16}.{0,200}"generator": ?"mbkf ',),
    "a shortcut": (rb"(?:\[Desktop Entry\]|#!/bin/sh|@echo off\r)\n(?:#|rem) " + _MARK,),
    "a model (XML)": (rb"<\?xml[^\n]*\n<!-- " + _MARK,),
    PAGE: (
        rb'<!DOCTYPE html>.*(?:<meta name="generator" content="mbkf|<title>mbkf</title>|<nav><b>mbkf</b>)',
    ),
    "a picture or film": (rb"(?:GIF8|.{4}ftyp|\x89PNG|%PDF|<\?xml[^\n]*\n<!DOCTYPE svg).*" + _MARK,),
    "a table (Parquet)": (rb"PAR1.*(?:" + _MARK + rb"|toe_off_percent|peak_memory_mb)",),
}
"""Formats, and the headings of mbkf's files in each; a file has the first format with a heading that fits."""

FORM_OF_SUFFIX = {".html": PAGE, ".toml": SETTINGS, ".csv": TABLE, ".json": DATA}
"""Formats of the files that a command always writes in the same one."""


_OTHER_PLACE = (
    "name another file or folder, or replace it with --overwrite (in Python: with mbkf.overwriting())"
)


def form_of(path: str | Path) -> str | None:
    """The format of a file of mbkf; "" for an empty file, None for one whose content does not show that mbkf wrote it.

    Raises:
        OSError: It cannot be read.
    """
    with Path(path).open("rb") as file:
        head = file.read(_HEAD_BYTES)
        size = file.seek(0, os.SEEK_END)
        if size > _HEAD_BYTES:
            file.seek(max(size - _TAIL_BYTES, _HEAD_BYTES))
            head += file.read(_TAIL_BYTES)
    if not head:
        return ""
    fits = (form for form, headings in _FORMS.items() if any(_fits(one, head) for one in headings))
    return next(fits, None)


def _fits(heading: bytes, head: bytes) -> bool:
    return re.match(heading, head, re.DOTALL) is not None


def check_replaceable(path: str | Path, *, edits: bool = False, form: str | None = None) -> None:
    """Makes sure that nothing of value is lost when a file is written; a path without a file passes.

    Args:
        path: The file to write.
        edits: The file is one of the user's that this change is meant for: it may have been read, and need not be
            mbkf's own.
        form: The format of the file that takes its place, as :func:`form_of` names it, where it is known.

    Raises:
        ProtectedFile: This task read the file; or :func:`overwriting` is off, and mbkf did not write the file, or wrote
            it in another format.
        OSError: It cannot be looked at.
    """
    target = Path(path)
    try:
        mode = target.stat().st_mode
    except (FileNotFoundError, NotADirectoryError):
        return
    kind = kind_of(mode)
    if kind:
        raise ProtectedFile(target, f"is {kind}; name a file to write")
    if edits:
        return
    read = files_read().name_of(target)
    if read is not None:
        same = "is an input" if read == str(target) else f"is the same file as the input {read}"
        raise ProtectedFile(
            target, f"{same}, and inputs are never replaced; name another file or folder to write"
        )
    if overwrite_permitted() or files_read().is_own(target):
        return
    was = form_of(target)
    if was is None:
        raise ProtectedFile(target, f"exists and was not written by mbkf; {_OTHER_PLACE}")
    if was and form and was != form:
        raise ProtectedFile(target, f"holds {was} that mbkf wrote, not {form}; {_OTHER_PLACE}")


def check_absent(path: str | Path) -> None:
    """Makes sure that a measurement, which cannot be made again, takes the place of no file, not even one of mbkf.

    Raises:
        ProtectedFile: The file exists, and :func:`overwriting` is off.
    """
    if os.path.lexists(path) and not overwrite_permitted():
        raise ProtectedFile(path, f"exists, and a recording replaces no other one; {_OTHER_PLACE}")


def overwrite_permitted() -> bool:
    """True while files of other programs may be replaced."""
    return bool(os.environ.get(OVERWRITE_VARIABLE))


@contextmanager
def overwriting(permitted: bool = True) -> Iterator[None]:
    """Permits replacing files that mbkf did not write; files that were read stay protected.

    It holds for all threads, and for processes that are started in the block.

    Args:
        permitted: False changes nothing.
    """
    before = os.environ.get(OVERWRITE_VARIABLE)
    if permitted:
        os.environ[OVERWRITE_VARIABLE] = "1"
    try:
        yield
    finally:
        if permitted and before is None:
            os.environ.pop(OVERWRITE_VARIABLE, None)
