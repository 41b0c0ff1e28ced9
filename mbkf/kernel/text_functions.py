"""Functions of the compiled kernel that write numbers as text (grammar: ``declaration.py``)."""

from __future__ import annotations

from typing import Annotated as In
from typing import Annotated as Made
from typing import Annotated as Out
from typing import Protocol

from mbkf.conventions import Array, BoolArray, Int32Array
from mbkf.kernel.declaration import requires, unlocked


class TextFunctions(Protocol):
    """Numbers as text."""

    @requires("begin >= 0")
    @unlocked
    def number_rows(
        self,
        values: In[Array, "rows columns"],
        digits: In[Int32Array, "columns"],
        begin: int,
        text: Out[BoolArray, "size"],
        /,
    ) -> tuple[int, Made[int, "written"]]:
        """The first row that is not written, and the bytes of those before it (:mod:`mbkf.io.number_text`).

        Args:
            values: The numbers.
            digits: Significant digits of a column, as ``%g`` has them; decimals of ``%f``, negative.
            begin: The first row to write.
            text: Memory for the text; a row is written if 24 bytes are free for each of its numbers.
        """
