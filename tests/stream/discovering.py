"""A search of this computer alone that ends with the first answer."""

import socket
import threading
from contextlib import contextmanager, suppress

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


@contextmanager
def answering(data):
    """The port of a server that says the same to every client and then nothing."""
    with socket.create_server((HERE, 0)) as server:

        def answer():
            with suppress(OSError):
                while True:
                    connection, _ = server.accept()
                    with connection:
                        connection.sendall(data)
                        connection.recv(1)

        thread = threading.Thread(target=answer, daemon=True)
        thread.start()
        yield server.getsockname()[1]
        server.shutdown(socket.SHUT_RDWR)
    thread.join()
