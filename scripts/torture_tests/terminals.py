"""`talcum watch` in odd terminals, with odd keys, that are closed or send signals: it ends, and does not panic."""

from __future__ import annotations

import fcntl
import os
import pty
import select
import signal
import struct
import termios
import time

from .damage import half_a_run
from .program import TIMES, Broken, Context, environment

# It checks ten times a second whether it must end.
PATIENCE = 10.0
TERMS = ["xterm-256color", "xterm", "vt100", "dumb", "linux", "", "no-such-terminal", None]
SIZES = [(24, 80), (0, 0), (1, 1), (2, 500), (500, 2), (65535, 1), (24, 7), (1000, 1000)]
KEYS = [b"\x1b[", b"\x1b[A", b"\x1b]0;x", b"\x1b[<0;1;1M", b"\x1b[200~", b"\x00", b"\xff\xfe", b"\t", b"jkhl?", b"\r\n", b"\x1bO"]
ENDS = {"q": b"q", "Ctrl-C": b"\x03", "SIGTERM": signal.SIGTERM, "SIGHUP": signal.SIGHUP, "SIGINT": signal.SIGINT, "closed": None}


def start_in_terminal(context: Context, size: tuple[int, int]) -> tuple[int, int]:
    """Starts the program in a new terminal of a size; returns its process and the other side of the terminal."""
    term = context.random.choice(TERMS)
    settings = {name: value for name, value in environment({}).items() if name != "TERM"}
    settings |= {} if term is None else {"TERM": term}
    process, terminal = pty.fork()
    if process == 0:
        fcntl.ioctl(0, termios.TIOCSWINSZ, struct.pack("HHHH", *size, 0, 0))
        os.execve(context.program, [str(context.program), "watch", str(half_a_run(context))], settings)
    return process, terminal


def drain(terminal: int, seconds: float, seen: bytearray) -> None:
    """Reads what is drawn for a while."""
    end = time.monotonic() + seconds
    while (left := end - time.monotonic()) > 0.0:
        if select.select([terminal], [], [], left)[0]:
            try:
                seen += os.read(terminal, 1 << 16)
            except OSError:
                return
            del seen[:-20_000]


def play(context: Context, terminal: int, seen: bytearray) -> list[str]:
    """Types keys and changes the size for a while; returns what was done."""
    done = []
    for _ in range(context.random.randint(0, 4)):
        if context.random.random() < 0.6:
            keys = b"".join(context.random.choices(KEYS, k=context.random.choice([1, 3, 200])))
            os.write(terminal, keys[:1000])
            done.append(f"{keys[:20]!r}")
        else:
            size = context.random.choice(SIZES)
            fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", *size, 0, 0))
            done.append(f"{size}")
        drain(terminal, context.random.choice([0.0, 0.02, 0.1]), seen)
    return done


def exit_code(process: int) -> int | None:
    """The exit code of a process that ends in time; otherwise nothing, and it is killed."""
    end = time.monotonic() + PATIENCE * TIMES[0]
    while time.monotonic() < end:
        done, status = os.waitpid(process, os.WNOHANG)
        if done:
            return os.waitstatus_to_exitcode(status)
        time.sleep(0.01)
    os.kill(process, signal.SIGKILL)
    os.waitpid(process, 0)
    return None


def terminals(context: Context) -> dict[str, int]:
    """One terminal, from its start to its end."""
    half_a_run(context)
    size, seen = context.random.choice(SIZES), bytearray()
    process, terminal = start_in_terminal(context, size)
    drain(terminal, context.random.choice([0.0, 0.05, 0.2]), seen)
    done = [f"{size}"]
    how, end = context.random.choice(list(ENDS.items()))
    try:
        done += play(context, terminal, seen)
        if how == "closed":
            os.close(terminal)
            terminal = -1
        elif isinstance(end, bytes):
            os.write(terminal, end)
            drain(terminal, 0.3, seen)
            # A sequence that was begun may have swallowed the key, or the start, which discards what was typed.
            os.close(terminal)
            terminal = -1
        else:
            os.kill(process, end)
    except (OSError, ProcessLookupError):
        done.append("it had ended")
    if terminal >= 0:
        drain(terminal, 0.3, seen)
    code = exit_code(process)
    if terminal >= 0:
        drain(terminal, 0.01, seen)
        os.close(terminal)
    # A signal that comes before the program has its handlers ends it as the system does.
    if code is None or code not in (0, 1, -signal.SIGTERM, -signal.SIGHUP, -signal.SIGINT) or b"panicked" in seen:
        raise Broken(f"a terminal: {'; '.join(done)}; ended by {how}: code {code}: {bytes(seen[-1000:])!r}")
    return {f"terminals, ended by {how}": 1}
