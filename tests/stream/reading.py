"""A source's stream and frames, waited for until they have come."""

from tests.waiting import until


def connected(source):
    """The description of a source's stream, once there is one."""
    return until(lambda: source.connect(0.5))


def read(source, count):
    """The next frames of a source, as many as are asked for."""
    frames = []

    def enough():
        while len(frames) < count and (frame := source.read(0.1)) is not None:
            frames.append(frame)
        return len(frames) == count

    until(enough, lambda: f"{len(frames)} of {count} frames have come")
    return frames


def events(source, *kinds):
    """What a source tells, once it has told of every kind; no frame may come before."""
    news = []

    def told():
        assert source.read(0.05) is None
        news.extend(source.news())
        return set(kinds) <= {kind for kind, _ in news}

    until(told, lambda: f"{news}")
    return news
