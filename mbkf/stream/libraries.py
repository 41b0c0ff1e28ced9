"""Streaming libraries, imported when they are needed, with a hint where they are missing."""

from __future__ import annotations

import importlib
import os
from pathlib import Path
from types import ModuleType

from mbkf.errors import MissingDependency

LSL_CONFIG = "[lab]\nKnownPeers = {127.0.0.1}\n[log]\nlevel = -3\n"
"""Configuration of liblsl: streams of this computer are found without a network, too; liblsl itself logs nothing."""

LSL_CONFIG_VARIABLE = "LSLAPICFG"

_configured = False


def library(name: str, needed_for: str, extra: str) -> ModuleType:
    """A module that an extra of mbkf installs.

    Args:
        name: Name of the module.
        needed_for: The capability that needs it, for the error message.
        extra: The extra of mbkf that installs it.

    Raises:
        MissingDependency: It is not installed, or cannot be loaded here.
    """
    try:
        return importlib.import_module(name)
    except (ImportError, OSError, RuntimeError) as error:
        raise MissingDependency(name, needed_for, extra) from error


def lsl() -> ModuleType:
    """pylsl, set up to find streams on this computer; a laboratory's own lsl_api.cfg goes before.

    Raises:
        MissingDependency: It is not installed.
    """
    global _configured  # noqa: PLW0603 — liblsl reads its configuration once per process
    pylsl = library("pylsl", "Lab Streaming Layer", "lsl")
    if not _configured:
        _configured = True
        if not _own_configuration() and hasattr(pylsl.util, "set_config_content"):
            pylsl.util.set_config_content(LSL_CONFIG)
    return pylsl


def _own_configuration() -> bool:
    """True where a configuration of liblsl lies in one of the places that it searches."""
    places = (Path("lsl_api.cfg"), Path.home() / "lsl_api" / "lsl_api.cfg", Path("/etc/lsl_api/lsl_api.cfg"))
    return LSL_CONFIG_VARIABLE in os.environ or any(place.is_file() for place in places)
