"""Mixed folders: settings were chosen on no person of the others, and each kind of mistake fails its row."""

from pathlib import Path

import pytest

from benchmarks.strangers.mixed_folders import (
    CHOSEN_FOLDERS,
    CHOSEN_ON,
    OTHER_FOLDERS,
    OTHERS,
    Folder,
    Judged,
    compared,
)

FOLDER = Folder(("Anna", "Ben"), "anew")
A, B, AGAIN = Path("a.c3d"), Path("b.c3d"), Path("again.c3d")
OWNERS = {A: "Anna", B: "Ben", AGAIN: "Anna anew"}
RIGHT = {A: ("P-a", {"Anna"}), B: ("P-b", {"Ben"}), AGAIN: ("P-a", {"Anna anew"})}


def found(changes, failed=None):
    """The numbers of mistakes: persons in one, persons in two, wrong bodies, refused trials."""
    failed = failed or {}
    done = {path: one for path, one in (RIGHT | changes).items() if path not in failed}
    judged = compared(FOLDER, OWNERS, done, failed, {"Anna", "Anna anew"})
    assert judged.done == len(done)
    assert len(list(judged.remarks())) == sum(map(len, mistakes(judged)))
    return tuple(map(len, mistakes(judged)))


def mistakes(judged: Judged):
    return judged.joined, judged.split, judged.wrong, judged.refused


def test_folders_are_of_the_persons_of_their_half():
    assert not set(CHOSEN_ON) & set(OTHERS)
    for folders, persons in ((CHOSEN_FOLDERS, CHOSEN_ON), (OTHER_FOLDERS, OTHERS)):
        assert all(set(folder.persons) <= set(persons) for folder in folders)
        assert len(set(folders)) == len(folders)
    sizes = [len(folder.persons) for folder in OTHER_FOLDERS if len(folder.persons) > 1]
    assert len(sizes) >= 20 and (min(sizes), max(sizes)) == (2, 6)


@pytest.mark.parametrize(
    "changes, failed, expected",
    [
        ({}, {}, (0, 0, 0, 0)),
        ({B: ("P-a", {"Ben"})}, {}, (1, 0, 0, 0)),
        ({AGAIN: ("P-c", {"Anna anew"})}, {}, (0, 1, 0, 0)),
        ({AGAIN: ("P-a", {"Anna"})}, {}, (0, 0, 0, 0)),
        ({AGAIN: ("P-a", {"Ben"})}, {}, (0, 0, 1, 0)),
        ({B: ("P-b", {"Ben", "Anna"})}, {}, (0, 0, 1, 0)),
        ({}, {A: "another person"}, (0, 0, 0, 1)),
        ({}, {B: "another person"}, (0, 0, 0, 0)),
    ],
)
def test_each_mistake_is_counted(changes, failed, expected):
    assert found(changes, failed) == expected
