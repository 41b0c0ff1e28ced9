"""A search of this computer alone that ends with the first answer."""

import socket

from mbkf.stream.asking import Answer

HERE = "127.0.0.1"


def first_answer(question, port, local, wait_s):
    """The first answer to a question, in place of all that come in time."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.settimeout(wait_s)
        one.bind((HERE, 0))
        one.sendto(question(one.getsockname()[1]), (HERE, port))
        data, (sender, _) = one.recvfrom(65536)
    return [Answer(sender, HERE, data)]
