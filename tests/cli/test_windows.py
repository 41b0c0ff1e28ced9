"""Under WSL, files are opened by Windows; elsewhere, and where Windows fails, by the system's browser."""

import pytest

from mbkf.cli.opening import open_file
from mbkf.cli.windows import windows_desktop, windows_path


@pytest.fixture
def no_browser(monkeypatch):
    opened = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    return opened


def test_under_wsl_a_page_is_opened_by_windows(wsl, no_browser):
    page = wsl / "page ä.html"
    open_file(page)
    assert (wsl / "opened").read_text(encoding="utf-8") == "\\\\wsl.localhost\\Ubuntu" + str(page).replace(
        "/", "\\"
    )
    assert no_browser == []


@pytest.mark.parametrize("missing", ["explorer.exe", "wslpath"])
def test_where_windows_opens_nothing_the_system_s_browser_does(wsl, no_browser, missing):
    (wsl / "bin" / missing).unlink()
    open_file(wsl / "page.html")
    assert no_browser == [(wsl / "page.html").as_uri()] and not (wsl / "opened").exists()


def test_without_wsl_nothing_is_asked(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    assert windows_path(tmp_path) is None and windows_desktop() is None


def test_windows_itself_names_its_desktop_without_wsl(wsl, monkeypatch):
    monkeypatch.setattr("mbkf.cli.windows.NATIVE", True)
    assert str(windows_desktop()) == "C:\\Users\\Ána\\OneDrive\\Desktop"
