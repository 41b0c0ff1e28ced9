"""A frame as plain data: unknown numbers are null, and the verdict is a word once it is known."""

import json

import numpy as np

from mbkf.stream.results.message import frame_message
from tests.stream.results.test_websocket import MODEL, shown_frame


def test_unknown_numbers_are_null():
    plain = json.loads(json.dumps(frame_message(shown_frame(MODEL, 4), np.array([1.5, np.nan, np.inf]))))
    assert plain["values"] == [1.5, None, None]
    assert (plain["frame"], plain["time_s"], plain["verdict"], plain["valid"]) == (4, 0.04, None, False)
