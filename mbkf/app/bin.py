"""Moves of the user's files that are undone as a whole: what is deleted lies in a bin, and nothing is ever replaced.

Each set of moves stands in a folder of its own in the bin, with a journal that is written before the first file moves,
so that a crash half-way is undone like any other set. Paths are relative to the page's folder.
"""

from __future__ import annotations

import errno
import json
import os
import secrets
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

from mbkf.app.failures import CONFLICT, NOT_FOUND, Refused
from mbkf.io.atomic import replacing, write_text
from mbkf.io.files_read import read_state, read_state_bytes
from mbkf.io.leftovers import locked

BIN = ".bin"
"""Folder of the bin in the page's folder; hidden ones hold no sessions."""

JOURNAL = "journal.json"

Move = tuple[str, str]
"""From where to where."""

_moving = threading.RLock()


@dataclass(frozen=True)
class Rewritten:
    """A session file before and after a change of its text that belongs to a set of moves; None: no file."""

    file: str
    before: str | None
    after: str | None


@dataclass(frozen=True)
class Moved:
    """A set of moves.

    Attributes:
        key: Name of its folder in the bin.
        act: "delete" or "move".
        session, trial: Their names before; ``trial`` is empty for a whole session.
        to_session, to_trial: Their names after; empty for what lies in the bin.
        at_s: Time of the system, s.
        moves: The moves, in order.
        rewritten: Session files with another text.
        state: State of the run that belongs to what moved; None without.
        undone: True once it has been undone.
    """

    key: str
    act: str
    session: str
    trial: str = ""
    to_session: str = ""
    to_trial: str = ""
    at_s: float = 0.0
    moves: tuple[Move, ...] = ()
    rewritten: tuple[Rewritten, ...] = ()
    state: Mapping[str, object] | None = field(default=None)
    undone: bool = False


class Bin:
    """The sets of moves of a page's folder.

    Args:
        root: The folder.
        restore: Takes a change of a session file back where the file was changed since.
    """

    def __init__(self, root: Path, restore: Callable[[Rewritten], None]) -> None:
        self._root, self._place, self._restore = root, root / BIN, restore

    @contextmanager
    def held(self) -> Iterator[None]:
        """Lets one set of moves happen at a time, among the servers of this folder, too.

        Raises:
            OSError: The bin cannot be made.
        """
        self._place.mkdir(parents=True, exist_ok=True)
        with _moving, locked(self._place, wait=True):
            yield

    def key(self) -> str:
        """A new name of a set of moves."""
        return f"{time.strftime('%Y-%m-%d-%H%M%S')}-{secrets.token_hex(4)}"

    def into(self, key: str, path: Path) -> Move:
        """The move of a file or folder into the bin."""
        inside = path.relative_to(self._root).as_posix()
        return inside, f"{BIN}/{key}/{inside}"

    def carry_out(self, wanted: Moved, rewriting: Iterable[Rewritten] = ()) -> Moved:
        """Carries out a set of moves, whole or not at all.

        Args:
            wanted: The set.
            rewriting: Changes session files one by one after the moves, and yields each change once it is made.

        Raises:
            Refused: A file is in the way.
            OSError: A file cannot be moved.
            FileFormatError: A session file cannot be changed.
        """
        made = replace(wanted, at_s=time.time())
        self._free(made.moves)
        self._write(made)
        try:
            self._move(made.moves)
            for one in rewriting:
                made = replace(made, rewritten=(*made.rewritten, one))
                self._write(made)
        except BaseException:
            self._move(_back(made.moves))
            self._give_all_back(made)
            self._write(replace(made, undone=True))
            raise
        return made

    def undo(self, key: str, aside: Iterable[Path] = ()) -> Moved:
        """Moves everything of a set back.

        Args:
            key: Of the set.
            aside: Files or folders of what the set moved that came into being since; they go into the bin.

        Raises:
            Refused: There is no such set, or a file is in the way.
            OSError: A file cannot be moved.
            FileFormatError: A session file cannot be changed.
        """
        found = self._read(key)
        if found is None or found.undone:
            raise Refused(NOT_FOUND, "this has been undone already; load the page again", "undone_already")
        moves = [one for one in _back(found.moves) if os.path.lexists(self._root / one[0])]
        if not moves:
            raise _gone(found)
        self._free(moves)
        moves += [self._undone(key, one.relative_to(self._root).as_posix()) for one in aside]
        self._move(moves)
        try:
            self._give_all_back(found)
        except BaseException:
            self._move(_back(moves))
            raise
        done = replace(found, undone=True)
        self._write(done)
        return done

    def listed(self) -> list[Moved]:
        """The sets that can be undone, the newest first."""
        with suppress(OSError):
            found = [self._read(place.name) for place in self._place.iterdir()]
            kept = [one for one in found if one is not None and not one.undone]
            return sorted(kept, key=lambda one: one.at_s, reverse=True)
        return []

    def text(self, file: str) -> str | None:
        """The text of a session file; None without it."""
        with suppress(FileNotFoundError):
            return read_state_bytes(self._root / file).decode("utf-8", "surrogateescape")
        return None

    def _give_all_back(self, found: Moved) -> None:
        for one in reversed(found.rewritten):
            self._give_back(found.key, one)

    def _give_back(self, key: str, one: Rewritten) -> None:
        """The text before a change, byte for byte where nobody changed the file since."""
        if self.text(one.file) != one.after:
            self._restore(one)
        elif one.before is not None:
            with replacing(self._root / one.file, edits=True) as partial:
                partial.write_bytes(one.before.encode("utf-8", "surrogateescape"))
        elif one.after is not None:
            self._move([self._undone(key, one.file)])

    def _undone(self, key: str, inside: str) -> Move:
        """The move of a file that came into being since a set of moves, into the bin."""
        return inside, f"{BIN}/{key}/undone/{inside}"

    def _free(self, moves: Sequence[Move]) -> None:
        """Refuses moves onto files that are there.

        Raises:
            Refused: A file is in the way.
        """
        for _, to in moves:
            if os.path.lexists(self._root / to):
                raise Refused(CONFLICT, f"'{to}' is there already; choose another name", "in_the_way", to)

    def _move(self, moves: Sequence[Move]) -> None:
        """Carries out moves; those before one that fails are taken back.

        Raises:
            OSError: A file cannot be moved.
        """
        for count, (source, to) in enumerate(moves):
            try:
                if not os.path.lexists(self._root / source):
                    continue
                (self._root / to).parent.mkdir(parents=True, exist_ok=True)
                if os.path.lexists(self._root / to):
                    raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), to)
                (self._root / source).rename(self._root / to)
            except OSError:
                self._move(_back(moves[:count]))
                raise

    def _write(self, one: Moved) -> None:
        write_text(self._place / one.key / JOURNAL, json.dumps(asdict(one), indent=1), edits=True)

    def _read(self, key: str) -> Moved | None:
        """A set; None for a damaged journal or none at all."""
        if not key or Path(key).name != key or key.startswith("."):
            return None
        try:
            plain = json.loads(read_state(self._place / key / JOURNAL))
            moves = tuple((str(source), str(to)) for source, to in plain.pop("moves"))
            rewritten = tuple(Rewritten(**one) for one in plain.pop("rewritten"))
            return Moved(**plain, moves=moves, rewritten=rewritten)
        except (OSError, ValueError, TypeError, AttributeError, KeyError):
            return None


def _gone(found: Moved) -> Refused:
    """The refusal to undo a set whose files are at their new places no more."""
    if found.to_session:
        return Refused(
            NOT_FOUND,
            f"the files are no longer in '{found.to_session}'; undo the later change first",
            "moved_on",
            found.to_session,
        )
    place = f"{BIN}/{found.key}"
    return Refused(NOT_FOUND, f"the files are no longer in '{place}'", "bin_emptied", place)


def _back(moves: Sequence[Move]) -> list[Move]:
    """Moves that take others back."""
    return [(to, source) for source, to in reversed(moves)]
