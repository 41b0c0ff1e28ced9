"""Norms of other tools from a file that the page sends: looked at, then written beside the sessions."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory

from mbkf.app.failures import CONFLICT, Refused
from mbkf.app.workspace import Workspace
from mbkf.errors import InvalidInput
from mbkf.io.atomic import replacing
from mbkf.io.norm_files.raw import RawNorms
from mbkf.io.norm_files.read import SUFFIXES, read_foreign_norms
from mbkf.io.norms import Span, write_norms
from mbkf.study.batch.plan import folder_name
from mbkf.study.session.norm_import import Statements, completed, imported, missing_facts, span_of

FILE = "norms-{name}.toml"
"""File of imported norms; its beginning keeps it apart from the files of a session and of the laboratory."""

Plain = dict[str, object]


def import_norms(workspace: Workspace, said: Mapping[str, str], content: bytes) -> Plain:
    """Looks at a file of norms, and writes its norms to the page's folder once all facts are stated.

    Args:
        workspace: The sessions.
        said: ``file``, its name; ``do``, "write" to write; and the facts by their names in :class:`Statements`, with
            ``group`` for the group of the file.
        content: The file.

    Returns:
        ``facts`` that are known, ``groups`` to choose from, the names of the ``missing`` facts; of written norms their
        file (``norms``), the number of ``curves``, and the curves that were ``turned`` and ``left_out``.

    Raises:
        FileFormatError: The file is damaged or holds no bands.
        InvalidInput: A fact is not possible, or no curve is left.
        Refused: A file of this name is there already.
        OSError: The norms cannot be written.
    """
    raw = _read(said["file"], content)
    facts = completed(raw, _stated(said))
    lacks_group = len(raw.groups) > 1 and facts.groups is None
    missing = [*missing_facts(facts), *(["group"] if lacks_group else [])]
    found: Plain = {
        "facts": {
            "name": facts.name,
            "source": facts.source,
            "convention": facts.convention,
            "moments": facts.moments,
            "persons": str(facts.persons or ""),
            "ages": _shown(facts.ages),
            "speeds": _shown(facts.speeds),
        },
        "groups": list(raw.groups) if len(raw.groups) > 1 else [],
        "missing": missing,
    }
    if missing or said["do"] != "write":
        return found
    made = imported(raw, facts)
    file = workspace.root / FILE.format(name=folder_name(said["name"] or Path(said["file"]).stem))
    if file.exists():
        raise Refused(
            CONFLICT, f"'{file.name}' is there already; choose another name", "norms_there", file.name
        )
    write_norms(made.norms, file)
    curves = len(made.norms.curves) + sum(len(one) for one in made.norms.by_speed.values())
    return {
        **found,
        "norms": file.name,
        "curves": curves,
        "turned": list(made.turned),
        "left_out": list(made.left_out),
    }


def _read(name: str, content: bytes) -> RawNorms:
    """The norms of a file by its name, which its kind and its messages need."""
    plain = Path(name.replace("\\", "/")).name
    if Path(plain).suffix.lower() not in SUFFIXES:
        raise InvalidInput(
            f"norms cannot be read from a file named '{plain[:80]}'; choose a file that ends in {', '.join(SUFFIXES)}"
        )
    with TemporaryDirectory() as folder:
        path = Path(folder, plain)
        with replacing(path) as partial:
            partial.write_bytes(content)
        return read_foreign_norms(path)


def _stated(said: Mapping[str, str]) -> Statements:
    persons = said["persons"].strip()
    if persons and not (persons.isascii() and persons.isdecimal() and len(persons) < 7 and int(persons)):
        raise InvalidInput(f"'{persons[:80]}' is not a number of persons; write one such as 30")
    return Statements(
        name=said["name"],
        source=said["source"],
        convention=said["convention"],
        moments=said["moments"],
        persons=int(persons or 0),
        ages=span_of(said["ages"]) if said["ages"] else None,
        speeds=span_of(said["speeds"]) if said["speeds"] else None,
        groups={said["group"]: None} if said["group"] else None,
    )


def _shown(span: Span | None) -> str:
    return "" if span is None else f"{span[0]:g}-{span[1]:g}"
