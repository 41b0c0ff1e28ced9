"""Without pyarrow the commands that make tables say which library is missing, before they start."""

import subprocess
import sys

import pytest

WITHOUT = "import sys\nsys.modules['pyarrow'] = None\n"


def run_without_pyarrow(code, *words):
    return subprocess.run(
        [sys.executable, "-c", WITHOUT + code, *map(str, words)], capture_output=True, text=True, check=False
    )


@pytest.mark.parametrize(
    "words",
    [
        ["batch", "study", "--out", "results"],
        ["app", "sessions", "--no-browser"],
        ["report", "a", "b", "--curves", "c.csv"],
    ],
    ids=lambda words: words[0],
)
def test_commands_name_the_missing_library_and_write_nothing(words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = run_without_pyarrow("from mbkf.cli.main import main\nsys.exit(main(sys.argv[1:]))", *words)
    assert (done.returncode, done.stdout) == (2, "")
    assert "pyarrow" in done.stderr and "study" in done.stderr and "Traceback" not in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_public_name_raises_the_packages_own_error():
    code = "import mbkf\ntry:\n    mbkf.batch\nexcept mbkf.MbkfError as e:\n    print(e.package, e.extra)"
    assert run_without_pyarrow(code).stdout.split() == ["pyarrow", "study"]
