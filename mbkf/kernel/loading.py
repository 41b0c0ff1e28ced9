"""Whether the compiled kernel is used: where it was built, unless the variable ``MBKF_KERNEL`` says ``reference``."""

from __future__ import annotations

import importlib
import os
from functools import cache
from typing import Protocol

from mbkf.errors import InvalidInput
from mbkf.kernel.contact_functions import ContactFunctions
from mbkf.kernel.covariance_functions import CovarianceFunctions
from mbkf.kernel.orientation_functions import OrientationFunctions
from mbkf.kernel.readings_functions import ReadingFunctions
from mbkf.kernel.tree_functions import TreeFunctions

SWITCH = "MBKF_KERNEL"
"""Environment variable: ``compiled`` asks for the kernel, ``reference`` for numpy and Pinocchio."""

COMPILED, REFERENCE = "compiled", "reference"


class Library(
    CovarianceFunctions, TreeFunctions, ReadingFunctions, ContactFunctions, OrientationFunctions, Protocol
):
    """The functions of ``mbkf/kernel/module.c``."""


@cache
def library() -> Library | None:
    """The compiled kernel; None where it was not built, or is not wanted.

    Raises:
        InvalidInput: ``MBKF_KERNEL`` is neither, or asks for a kernel that is not there.
    """
    wanted = os.environ.get(SWITCH, "")
    if wanted not in {"", COMPILED, REFERENCE}:
        raise InvalidInput(f"{SWITCH}={wanted} is not known; it is {COMPILED}, {REFERENCE} or not set")
    if wanted == REFERENCE:
        return None
    try:
        return _connected()
    except ImportError as error:
        if wanted == COMPILED:
            raise InvalidInput(
                f"there is no compiled kernel ({error}); install mbkf where a C compiler is, or unset {SWITCH}"
            ) from error
        return None


def told() -> str:
    """Which arithmetic is used, for people: ``compiled kernel (512-bit vectors)``, ``reference kernel (numpy)``."""
    found = library()
    if found is None:
        return f"{REFERENCE} kernel (numpy)"
    bits = found.vectors()
    return f"{COMPILED} kernel ({f'{bits}-bit vectors' if bits else 'BLAS'})"


def _connected() -> Library:
    """The kernel with SciPy's BLAS and LAPACK.

    Raises:
        ImportError: It was not built, or SciPy offers other routines.
    """
    from scipy.linalg import cython_blas, cython_lapack

    module = importlib.import_module("mbkf.kernel._kernel")
    module.connect({**cython_blas.__pyx_capi__, **cython_lapack.__pyx_capi__})
    return module
