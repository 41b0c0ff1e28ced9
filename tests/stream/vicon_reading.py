"""A simulated DataStream server and the source that follows it, for tests."""

from benchmarks.streams.vicon_server import ViconServer
from mbkf.stream.played import played
from mbkf.stream.vicon.source import ViconSource
from tests.stream.reading import connected, read
from tests.waiting import until

HERE = "127.0.0.1"


class Laboratory:
    """A server that plays a capture, and a source that has asked for frames."""

    def __init__(self, capture, unlabelled=False, convention=None, changes=(), **options):
        self.played = played(capture, unlabelled)
        self.server = ViconServer(self.played, convention=convention)
        for name, value in dict(changes).items():
            setattr(self.server, name, value)
        self.source = ViconSource(HERE, self.server.port, **options)
        self.stream = connected(self.source)
        self.ask()

    def ask(self):
        """Lets the source ask for frames."""
        until(lambda: self.source.read(0.01) or self.server.listening())

    def frames(self, *numbers, **changes):
        """Sends some frames and returns those that arrive."""
        found = []
        for frame in self.played.frames():
            if frame.number in numbers:
                self.ask()
                self.server.send_frame(frame, **changes)
                found += read(self.source, 1)
        return found

    def event(self, kind):
        """The sentence of an event, once it has come."""
        found = {}

        def come():
            self.source.read(0.01)
            found.update(self.source.news())
            return found.get(kind)

        return until(come, lambda: f"{found}")

    def close(self):
        self.source.close()
        self.server.close()
