"""A command ends when its input closes, and not before; a signal ends it even where its error is lost."""

import os
import signal
import subprocess
import sys
import threading
from types import SimpleNamespace

import pytest

from mbkf.cli import stopping
from mbkf.cli.stopping import (
    EXIT_INTERRUPTED,
    Terminated,
    ended_by_signal,
    stop_with_input,
    stopped_by_signal,
)
from tests.waiting import PATIENCE_S, until


def test_a_closed_input_sets_the_event_and_what_is_typed_does_not(monkeypatch):
    read, write = os.pipe()
    monkeypatch.setattr(stopping.sys, "stdin", SimpleNamespace(fileno=lambda: read))
    stop = threading.Event()
    stop_with_input(stop)
    os.write(write, b"typed\n")
    assert not stop.wait(0.2)
    os.close(write)
    assert stop.wait(PATIENCE_S)
    os.close(read)


COMMAND = """
import signal, sys, threading
from pathlib import Path
signal.signal(signal.SIGINT, signal.default_int_handler)  # the shell may have them ignored
signal.signal(signal.SIGHUP, signal.SIG_DFL)
from mbkf.cli import main, stopping
from mbkf.io.leftovers import unfinished

def lost(args):
    with unfinished(Path(sys.argv[1]) / "result"):
        while True:
            try:
                print("ready", flush=True)
                threading.Event().wait()
            except KeyboardInterrupt:  # as in a callback of a library
                continue

def computing(args):
    with unfinished(Path(sys.argv[1]) / "result"):
        print("ready", flush=True)
        threading.Event().wait()

def lingering(args):
    threading.Thread(target=threading.Event().wait).start()
    with unfinished(Path(sys.argv[1]) / "result"):
        print("ready", flush=True)
        stopping.end_within(0.1)
        threading.Event().wait()

import mbkf.cli.info
mbkf.cli.info.run = globals()[sys.argv[2]]
sys.exit(main.main(["info", "walk.c3d"]))
"""


@pytest.mark.skipif(os.name != "posix", reason="signals are POSIX's")
@pytest.mark.parametrize(
    ("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 143)]
)
@pytest.mark.parametrize("kind", ["computing", "lost"])
def test_a_signal_ends_a_command_without_leftovers(tmp_path, kind, number, code):
    words = [sys.executable, "-c", COMMAND, str(tmp_path), kind]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "ready\n" and len(list(tmp_path.iterdir())) == 1
        process.send_signal(number)
        _, errors = process.communicate(timeout=PATIENCE_S)
    assert (process.returncode, errors) == (code, "mbkf: error: interrupted\n")
    assert list(tmp_path.iterdir()) == []


def test_a_command_ends_although_its_threads_do_not(tmp_path):
    words = [sys.executable, "-c", COMMAND, str(tmp_path), "lingering"]
    done = subprocess.run(words, capture_output=True, text=True, timeout=PATIENCE_S, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "ready\n", "")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(os.name != "posix", reason="signals are POSIX's")
def test_handlers_of_a_host_program_stay():
    taken = []
    before = signal.signal(signal.SIGTERM, lambda *_: taken.append(1))
    broken_off = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with ended_by_signal():
            signal.raise_signal(signal.SIGTERM)
            with pytest.raises(KeyboardInterrupt):
                signal.raise_signal(signal.SIGINT)
    finally:
        signal.signal(signal.SIGTERM, before)
        signal.signal(signal.SIGINT, broken_off)
    assert taken == [1] and signal.set_wakeup_fd(-1) == -1


@pytest.mark.skipif(os.name != "posix", reason="signals are POSIX's")
def test_a_command_that_ends_by_itself_is_not_broken_off(monkeypatch):
    monkeypatch.setattr(stopping, "_end", lambda code: pytest.fail(f"ended with {code}"))
    monkeypatch.setattr(stopping, "END_S", 0.0)
    with ended_by_signal():
        with stopped_by_signal() as stop:
            signal.raise_signal(signal.SIGTERM)
            assert stop.is_set()
        ended = []
        monkeypatch.setattr(stopping, "_end", ended.append)
        with pytest.raises(Terminated):
            signal.raise_signal(signal.SIGTERM)
        until(lambda: ended)
    assert ended == [143]


INTERRUPTED_AT = """
import signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)

class Interrupts:
    def find_spec(self, name, *_):
        if name == NAME:
            signal.raise_signal(signal.SIGINT)

sys.meta_path.insert(0, Interrupts())
from mbkf.__main__ import main
sys.argv[1:] = ["protocol", "list"]
sys.exit(main())
"""


@pytest.mark.skipif(os.name != "posix", reason="needs POSIX signals")
@pytest.mark.parametrize(
    ("module", "code"), [("mbkf.cli.main", -signal.SIGINT), ("mbkf.cli.protocol_list", None)]
)
def test_an_interruption_while_libraries_load_is_no_traceback(module, code):
    words = [sys.executable, "-c", INTERRUPTED_AT.replace("NAME", repr(module))]
    ended = subprocess.run(words, capture_output=True, text=True, check=False)
    assert "Traceback" not in ended.stderr and ended.stdout == ""
    assert ended.returncode == code if code else ended.returncode in {EXIT_INTERRUPTED, -signal.SIGINT}
