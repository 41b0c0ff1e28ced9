"""Streaming libraries: a missing one is named, and a laboratory's own configuration is kept."""

import os
import sys

import pytest

from mbkf.errors import MissingDependency
from mbkf.stream import libraries
from mbkf.stream.libraries import library


def test_a_library_that_is_missing_is_named_with_the_remedy(monkeypatch):
    monkeypatch.setitem(sys.modules, "pylsl", None)
    with pytest.raises(MissingDependency, match=r"pip install pylsl \(in a clone"):
        library("pylsl", "Lab Streaming Layer", "lsl")


def test_a_laboratorys_own_configuration_goes_first(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.delenv("LSLAPICFG", raising=False)
    usual = os.path.exists("/etc/lsl_api/lsl_api.cfg")  # noqa: PTH110
    assert libraries._own_configuration() == usual
    (tmp_path / "lsl_api.cfg").touch()
    assert libraries._own_configuration()
