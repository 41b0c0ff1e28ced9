"""Labels of points made unambiguous: no subject's name before all of them, no label twice."""

from __future__ import annotations

from collections.abc import Sequence

_MOST_NAMED = 6


def without_subject(labels: Sequence[str]) -> list[str]:
    """Labels without the subject's name that stands before them ("Anna:LASI"), if two or more share it and no other."""
    subjects = [label.partition(":")[0] for label in labels if ":" in label]
    if len(subjects) < 2 or len(set(subjects)) > 1:
        return list(labels)
    prefix = f"{subjects[0]}:"
    return [label.removeprefix(prefix) or label for label in labels]


def unique_labels(labels: Sequence[str], notes: list[str]) -> list[str]:
    """Labels of which repeated ones carry a number: LASI, LASI_2; ``notes`` receives the renamed ones."""
    taken = set(labels)
    seen: set[str] = set()
    result, renamed = [], []
    for label in labels:
        name, number = label, 2
        while name in seen or (name != label and name in taken):
            name, number = f"{label}_{number}", number + 1
        if name != label:
            renamed.append(f"{label} → {name}")
        seen.add(name)
        result.append(name)
    if renamed:
        listed = ", ".join(renamed[:_MOST_NAMED])
        notes.append(f"labels that occur more than once were renamed: {listed}")
    return result
