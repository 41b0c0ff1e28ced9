"""Shortcuts of every system hold the words that start the page."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from mbkf.cli.main import main
from mbkf.cli.shortcut import linux_text, macos_text, windows_text
from mbkf.io.written import MARK

WORDS = ("/opt/a b/python", "-m", "mbkf", "app", "/home/Ana/50 % \"é\" `$HOME` \\n 'x'")


def words_of(line):
    """Words of a command line as the shell of POSIX reads them."""
    return subprocess.run(
        ["sh", "-c", f"printf '%s\\0' {line}"], capture_output=True, text=True, check=True
    ).stdout.split("\0")[:-1]


def test_the_menu_s_entry_quotes_every_word_as_the_specification_says():
    lines = dict(one.split("=", 1) for one in linux_text(WORDS).splitlines() if "=" in one)
    value = lines["Exec"].replace("\\\\", "\\")
    assert words_of(value.replace("%%", "%")) == list(WORDS)
    assert (
        "%" not in value.replace("%%", "") and lines["Terminal"] == "true" and Path(lines["Icon"]).is_file()
    )
    assert linux_text(WORDS).startswith("[Desktop Entry]\n")


def test_the_script_of_macos_runs_the_words():
    head, mark, line = macos_text(WORDS).splitlines()
    assert head == "#!/bin/sh" and MARK in mark
    assert words_of(line.removeprefix("exec ")) == list(WORDS)


def test_the_batch_file_starts_the_words_in_the_distribution():
    text = windows_text(("/opt/a b/python", "-m", "mbkf", "app", "/home/Ana/50 %"), "Ubuntu")
    assert '\r\nwsl.exe -d Ubuntu --cd ~ --exec "/opt/a b/python" -m mbkf app "/home/Ana/50 %%"\r\n' in text
    assert text.count("\n") == text.count("\r\n")
    assert '\r\n"C:\\a b\\python.exe" -m mbkf\r\n' in windows_text(
        ("C:\\a b\\python.exe", "-m", "mbkf"), None
    )
    assert ' app "D:\\\\"\r\n' in windows_text(("python.exe", "app", "D:\\"), None)


@pytest.mark.skipif(sys.platform != "linux", reason="the menu of Linux")
def test_the_command_writes_its_options_into_the_menu_and_again(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    monkeypatch.delenv("WSL_DISTRO_NAME", raising=False)
    for port in ("8123", "8124"):
        assert main(["app", str(tmp_path / "lab"), "--port", port, "--shortcut"]) == 0
    file = tmp_path / "applications" / "mbkf.desktop"
    assert capsys.readouterr().out.splitlines() == [str(file)] * 2
    text = file.read_text(encoding="utf-8")
    assert f'"app" "{tmp_path / "lab"}" "--port" "8124" "--convention" "clinical"' in text
    assert os.access(file, os.X_OK) and "shortcut" not in text
    file.write_text("[Desktop Entry]\nName=mine\n", encoding="utf-8")
    assert main(["app", str(tmp_path / "lab"), "--shortcut"]) == 2, "another program's file stays"


def test_under_wsl_the_shortcut_lies_on_the_desktop_of_windows(wsl, capsys):
    assert main(["app", str(wsl / "lab"), "--shortcut"]) == 0
    assert capsys.readouterr().out.strip() == str(wsl / "Desktop" / "mbkf.cmd")
    assert f" -m mbkf app {wsl / 'lab'} " in (wsl / "Desktop" / "mbkf.cmd").read_bytes().decode("utf-8")


def test_without_an_answer_of_windows_the_command_says_what_to_permit(wsl, capsys):
    (wsl / "bin" / "powershell.exe").write_text("#!/bin/sh\nexit 1\n", encoding="utf-8")
    assert main(["app", str(wsl / "lab"), "--shortcut"]) == 2
    assert "/etc/wsl.conf" in capsys.readouterr().err
