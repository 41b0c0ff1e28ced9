"""Grammar in which the files ``*_functions.py`` declare the functions of the compiled kernel.

A declaration is a method of a protocol; mypy checks calls against it, and ``.ci/kernel_binding.py`` makes from it the C
prototype that the function's body has to match, the checks of its arguments, and the module's table of functions.

    In[Array, "m N"]                    (m, N) float64 in C order; read
    In[Int32Array, "M in 0:joints"]       (M,) int32, each within 0 … joints − 1; BoolArray likewise
    In[Array, "6 nv fortran"]           (6, nv) in Fortran order
    In[Array, "N N symmetric"]          (N, N) in either order
    In[Array, "*n 6"]                   any number of dimensions before the last; n is their product
    In[Array, "n"] | None               may be left out; C sees NULL
    Out[Array, "N N symmetric"]         memory of the caller; written
    -> Made[Array, "step: N"]           a new array, which C fills; several ones in a tuple
    -> Made[int, "known"]               a new number, likewise

A size is a number, a name or an expression of names: the first array, handle or integer argument that has the name sets
it, and all others must agree. A record (``NamedTuple``) crosses field by field, by name. A result without ``Made`` is
the C function's own. In C, the sizes that arrays set come first, in the order in which they appear.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

FILES = (
    "body_functions.py",
    "contact_functions.py",
    "force_functions.py",
    "inertial_functions.py",
    "smoothing_functions.py",
    "state_functions.py",
    "text_functions.py",
    "tracking_functions.py",
)
"""The declarations, in the kernel's folder, in the order in which they use one another."""

Declared = TypeVar("Declared", bound=Callable[..., object])


class Handle:
    """Base of types whose objects only compiled code looks into; annotated integers are sizes that a handle sets."""


def requires(*conditions: str) -> Callable[[Declared], Declared]:
    """Conditions on sizes and integer arguments, checked at each call."""
    del conditions
    return lambda function: function


def unlocked(function: Declared) -> Declared:
    """Calls take tens of microseconds, so that they let go of the interpreter's lock."""
    return function


def fingerprint(folder: Path) -> str:
    """Digest of the declarations in a folder, by which a kernel that was compiled from others is recognised."""
    return hashlib.sha256(b"".join((folder / name).read_bytes() for name in FILES)).hexdigest()
