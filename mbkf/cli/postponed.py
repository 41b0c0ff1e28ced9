"""Parts of NumPy that SciPy asks for by name and no command uses are loaded when something in them is.

``scipy.linalg`` goes through all of NumPy's names as it is imported, and with them through its Fortran compiler's
front end, its test tools and its masked arrays: as long as it takes to import NumPy itself.
"""

from __future__ import annotations

import importlib.util
import sys

NUMPY = "numpy"
UNUSED = ("f2py", "testing", "ma", "polynomial", "ctypeslib")
"""Modules of NumPy that load others, and that it imports when they are first asked for."""


def postpone() -> None:
    """Puts modules in their places that are loaded at the first access to something in them, if NumPy is there."""
    numpy = sys.modules.get(NUMPY)
    for name in UNUSED if numpy is not None else ():
        whole = f"{NUMPY}.{name}"
        spec = None if whole in sys.modules else importlib.util.find_spec(whole)
        if spec is None or spec.loader is None:
            continue
        spec.loader = importlib.util.LazyLoader(spec.loader)
        module = importlib.util.module_from_spec(spec)
        sys.modules[whole] = module
        spec.loader.exec_module(module)
        setattr(numpy, name, module)
