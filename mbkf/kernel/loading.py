"""Loads the compiled kernel, unless it was not built or the variable ``MBKF_KERNEL`` asks for the reference."""

from __future__ import annotations

import importlib
import os
from functools import cache
from pathlib import Path
from typing import Protocol

from mbkf.errors import InvalidInput
from mbkf.kernel.body_functions import BodyFunctions
from mbkf.kernel.contact_functions import ContactFunctions
from mbkf.kernel.declaration import fingerprint
from mbkf.kernel.force_functions import ForceFunctions
from mbkf.kernel.inertial_functions import InertialFunctions
from mbkf.kernel.smoothing_functions import SmoothingFunctions
from mbkf.kernel.state_functions import StateFunctions
from mbkf.kernel.text_functions import TextFunctions
from mbkf.kernel.tracking_functions import TrackingFunctions

SWITCH = "MBKF_KERNEL"
"""Environment variable: ``compiled`` asks for the kernel, ``reference`` for numpy and Pinocchio."""

COMPILED, REFERENCE = "compiled", "reference"


class Library(
    BodyFunctions,
    ContactFunctions,
    ForceFunctions,
    InertialFunctions,
    SmoothingFunctions,
    StateFunctions,
    TextFunctions,
    TrackingFunctions,
    Protocol,
):
    """The functions of the compiled kernel."""


@cache
def library() -> Library | None:
    """The compiled kernel; None if it was not built, or if the environment asks for the reference.

    Raises:
        InvalidInput: ``MBKF_KERNEL`` is neither, or asks for a kernel that was not built; or the kernel was built from
            other declarations than this tree's.
    """
    wanted = os.environ.get(SWITCH, "")
    if wanted not in {"", COMPILED, REFERENCE}:
        raise InvalidInput(f"{SWITCH}={wanted} is unknown; set {COMPILED} or {REFERENCE}, or unset it")
    if wanted == REFERENCE:
        return None
    try:
        return _connected()
    except ImportError as error:
        if wanted == COMPILED:
            raise InvalidInput(
                f"mbkf was installed without its compiled kernel ({error}); install it again with a C compiler, "
                f"or unset {SWITCH}"
            ) from error
        return None


def kernel_name() -> str:
    """The kernel in use, for people: ``compiled kernel (512-bit vectors)``, ``reference kernel (numpy)``."""
    found = library()
    if found is None:
        return f"{REFERENCE} kernel (numpy)"
    bits = found.vector_bits()
    return f"{COMPILED} kernel ({f'{bits}-bit vectors' if bits else 'BLAS'})"


def _connected() -> Library:
    """The kernel with SciPy's BLAS and LAPACK.

    Raises:
        ImportError: It was not built, or SciPy offers other routines.
        InvalidInput: It was built from other declarations.
    """
    from scipy.linalg import cython_blas, cython_lapack

    module = importlib.import_module("mbkf.kernel._kernel")
    if getattr(module, "fingerprint", None) != fingerprint(Path(__file__).parent):
        raise InvalidInput(
            f"the compiled kernel {module.__file__} does not match its declaration, because mbkf changed since it was "
            f"compiled; install mbkf again, or set {SWITCH}={REFERENCE} to run without it"
        )
    module.connect({**cython_blas.__pyx_capi__, **cython_lapack.__pyx_capi__})
    return module
