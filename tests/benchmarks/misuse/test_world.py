"""Sums of files tell when one is changed or gone, links included."""

from benchmarks.misuse.leftovers import leftovers
from benchmarks.misuse.world import changed, digests


def test_changed_and_lost_files_are_named(tmp_path):
    for name in ("kept", "changed", "lost"):
        (tmp_path / name).write_text(name)
    (tmp_path / "link").symlink_to(tmp_path / "changed")
    before = digests(tmp_path)
    assert changed(before, tmp_path) == []
    (tmp_path / "changed").write_text("x")
    (tmp_path / "lost").unlink()
    (tmp_path / "new").write_text("x")
    assert sorted(changed(before, tmp_path)) == ["changed", "link", "lost"]


def test_unfinished_files_are_found(tmp_path):
    (tmp_path / "a").mkdir()
    (tmp_path / "a" / f".result-{'0f' * 16}.h5").touch()
    (tmp_path / ".hidden").touch()
    assert list(leftovers(tmp_path)) == [f"a/.result-{'0f' * 16}.h5"]
