"""Names of right and left segments and landmarks."""


def mirrored(name: str) -> str:
    """The other side's name of a ``right_``/``left_`` name; midline names stay."""
    if name.startswith("right_"):
        return "left_" + name.removeprefix("right_")
    if name.startswith("left_"):
        return "right_" + name.removeprefix("left_")
    return name
