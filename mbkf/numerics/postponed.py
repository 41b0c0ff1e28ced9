"""Loads parts of NumPy that no command uses only when something in them is accessed.

``scipy.linalg`` goes through all of NumPy's names as it is imported, and so loads its Fortran compiler's front end, its
test tools and its masked arrays, which takes as long as NumPy itself.
"""

from __future__ import annotations

import importlib.util
import sys

NUMPY = "numpy"
UNUSED = ("f2py", "testing", "ma", "polynomial", "ctypeslib")
"""Modules of NumPy that load others, and that NumPy imports at their first use."""


def postpone() -> None:
    """Replaces the modules by ones that load themselves at the first access, if NumPy is imported."""
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
