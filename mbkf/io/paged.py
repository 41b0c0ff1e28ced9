"""Arrays that are larger than memory: rows in a file, of which a few pages are in memory."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypeAlias, overload

import numpy as np
from numpy.typing import NDArray

PAGES = 3
"""Pages in memory: work that goes forward looks back a little, and ahead."""


Columns: TypeAlias = tuple[slice, Sequence[int] | NDArray[np.intp]]
"""A colon and numbers of columns."""


class PagedArray:
    """(T, …) rows in a file.

    A row, and a slice within a page, is a view: what is written into it stays, until :meth:`close_writing`. Other
    slices are copies.

    Attributes:
        shape: Shape of the whole array.
        dtype: Type of its numbers or records.
    """

    def __init__(
        self, path: Path, blank: Callable[[int, int], NDArray], rows: int, page: int, pages: int = PAGES
    ) -> None:
        """Makes an array of rows that are blank until they are written.

        Args:
            path: The file, which is made or emptied.
            blank: Makes the rows from one number to the one before another.
            rows: Number of rows T.
            page: Rows of a page.
            pages: Pages that are kept in memory.
        """
        one = blank(0, 0)
        self.shape, self.dtype = (rows, *one.shape[1:]), one.dtype
        self._path, self._blank, self._page, self._most = path, blank, page, pages
        self._held: OrderedDict[int, NDArray] = OrderedDict()
        self._stored: set[int] = set()
        self._writable = True
        path.write_bytes(b"")

    @classmethod
    def unknown(cls, path: Path, shape: tuple[int, ...], page: int, pages: int = PAGES) -> PagedArray:
        """An array of numbers, NaN until they are written.

        Args:
            path: The file.
            shape: Shape of the whole array.
            page: Rows of a page.
            pages: Pages that are kept in memory.
        """
        return cls(
            path, lambda first, after: np.full((after - first, *shape[1:]), np.nan), shape[0], page, pages
        )

    def __len__(self) -> int:
        return self.shape[0]

    @overload
    def __getitem__(self, key: int | slice) -> NDArray: ...

    @overload
    def __getitem__(self, key: Columns) -> PagedColumns: ...

    def __getitem__(self, key: int | slice | Columns) -> NDArray | PagedColumns:
        """A row by its number, rows of a slice, or, with a colon first, a view of some columns."""
        if isinstance(key, tuple):
            return PagedColumns(self, key[1])
        if not isinstance(key, slice):
            number = range(len(self))[int(key)]
            row: NDArray = self._at(number // self._page)[number % self._page]
            return row
        first, after, step = key.indices(len(self))
        if step != 1:
            raise IndexError(f"every {step}")
        parts = [self._at(page)[part] for page, part in self._parts(first, after)]
        return parts[0] if len(parts) == 1 else np.concatenate([self._blank(0, 0), *parts])

    def __setitem__(self, key: int | slice, values: NDArray) -> None:
        if not isinstance(key, slice):
            self[key][...] = values
            return
        first, after, _ = key.indices(len(self))
        done = 0
        for page, part in self._parts(first, after):
            held = self._at(page)[part]
            held[:] = values[done : done + len(held)]
            done += len(held)

    def close_writing(self) -> None:
        """Stores what was written; later, rows are read only."""
        for page, rows in self._held.items():
            self._store(page, rows)
        self._held.clear()
        self._writable = False

    def _parts(self, first: int, after: int) -> list[tuple[int, slice]]:
        """Pages of rows, and which of theirs."""
        size = self._page
        return [
            (page, slice(max(first - page * size, 0), min(after - page * size, size)))
            for page in range(first // size, -(-after // size) if after > first else first // size)
        ]

    def _at(self, page: int) -> NDArray:
        """The rows of a page, from memory or the file."""
        if page in self._held:
            self._held.move_to_end(page)
            return self._held[page]
        first = page * self._page
        after = min(first + self._page, len(self))
        if page in self._stored:
            count = (after - first) * int(np.prod(self.shape[1:], dtype=int))
            offset = first * self._row_bytes
            rows = np.fromfile(self._path, self.dtype, count, offset=offset).reshape(-1, *self.shape[1:])
        else:
            rows = self._blank(first, after)
        while len(self._held) >= self._most:
            self._store(*self._held.popitem(last=False))
        self._held[page] = rows
        return rows

    @property
    def _row_bytes(self) -> int:
        return self.dtype.itemsize * int(np.prod(self.shape[1:], dtype=int))

    def _store(self, page: int, rows: NDArray) -> None:
        if not self._writable:
            return
        with self._path.open("r+b") as file:
            file.seek(page * self._page * self._row_bytes)
            file.write(np.ascontiguousarray(rows).view(np.uint8).data)
        self._stored.add(page)


class PagedColumns:
    """Columns of a paged array, to be read."""

    def __init__(self, rows: PagedArray, columns: Sequence[int] | NDArray[np.intp]) -> None:
        """Args: the array, and numbers of its columns."""
        self._rows, self._columns = rows, columns

    def __len__(self) -> int:
        return len(self._rows)

    def __getitem__(self, key: int | slice) -> NDArray:
        found = self._rows[key]
        return np.asarray(found[:, self._columns] if isinstance(key, slice) else found[self._columns])
