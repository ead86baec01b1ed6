"""Acts in a child process, which may end in any way."""

import json
import os
import signal

SECONDS = 20  # until it counts as a hang


def forked(act):
    """What `act` returns, two texts, or how a fork of this process that called it ended without: 'signal' and
    its name, 'hang', 'exit' and its number.
    """
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        signal.alarm(SECONDS)
        os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
        os.write(writer, json.dumps(act()).encode()[:60000])
        os._exit(0)
    os.close(writer)
    told = b""
    while part := os.read(reader, 65536):
        told += part
    os.close(reader)
    _, status = os.waitpid(child, 0)
    if os.WIFSIGNALED(status):
        number = os.WTERMSIG(status)
        return ("hang", "") if number == signal.SIGALRM else ("signal", signal.Signals(number).name)
    if os.WEXITSTATUS(status):
        return "exit", str(os.WEXITSTATUS(status))
    return tuple(json.loads(told))
