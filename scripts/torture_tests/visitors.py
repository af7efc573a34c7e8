"""Hostile visitors of `talcum watch --serve`: it answers, refuses or leaves them, and serves the next one."""

from __future__ import annotations

import atexit
import resource
import socket
import subprocess
import time
from pathlib import Path
from random import Random

from .damage import half_a_run
from .program import Broken, Context, environment

# Connections that the server can have open at once, and the memory that it may take.
DESCRIPTORS, MOST_MEMORY_KB = 64, 100_000
# An honest visitor is served within this time, in seconds: silent ones are left after two.
PATIENCE = 20.0
PATHS = ["/", "/state.json", "/series.json", "/profile.json", "/bed.json", "/../../etc/passwd", "/%2e%2e/case.toml", "//", "*",
         "", "/state.json?" + "q" * 3000, "/\x00", "/\xff", "http://localhost/state.json", "/case.toml"]  # fmt: skip
METHODS = ["GET", "GET", "POST", "PUT", "HEAD", "OPTIONS", "CONNECT", "get", "", "G" * 5000]
HOSTS = ["localhost", "127.0.0.1", "[::1]", "page.example.org", "", "localhost:x", "a" * 20000, "\x00"]
HEADERS = ["Content-Length: 99999999999999", "Content-Length: -1", "Content-Length: x", "Transfer-Encoding: chunked",
           "Expect: 100-continue", "Connection: keep-alive", "Upgrade: websocket", "A" * 20000 + ": b", "no colon", ": no name",
           "Range: bytes=0-18446744073709551616", "Host: localhost", "a:" + " " * 1000]  # fmt: skip


class Server:
    """The program that serves the results of half a run, with few descriptors."""

    def __init__(self, context: Context) -> None:
        def limit() -> None:
            resource.setrlimit(resource.RLIMIT_NOFILE, (DESCRIPTORS, DESCRIPTORS))
        words = [str(context.program), "watch", str(half_a_run(context)), "--serve", "0"]
        self.errors = context.folder / "served.errors"
        with self.errors.open("wb") as errors:
            self.process = subprocess.Popen(words, env=environment({}), preexec_fn=limit, stdin=subprocess.DEVNULL,
                                            stdout=subprocess.PIPE, stderr=errors)  # fmt: skip
        atexit.register(self.process.kill)
        line = self.process.stdout.readline().decode()
        self.port = int(line.rsplit(":", 1)[1].split("/")[0])

    def connect(self) -> socket.socket:
        """A connection, on this machine."""
        return socket.create_connection(("127.0.0.1", self.port), timeout=PATIENCE)

    def require_service(self, what: str) -> None:
        """An honest visitor must be served, by a program that has not grown."""
        begin = time.monotonic()
        while True:
            if self.process.poll() is not None:
                raise Broken(f"the server ended with code {self.process.returncode} after {what}: {self.errors.read_text()}")
            try:
                with self.connect() as visitor:
                    visitor.sendall(b"GET /state.json HTTP/1.1\r\nHost: localhost\r\n\r\n")
                    if visitor.recv(64).startswith(b"HTTP/1.1 200 "):
                        break
            except OSError:
                pass
            if time.monotonic() - begin > PATIENCE:
                raise Broken(f"an honest visitor is not served within {PATIENCE} s after {what}")
            time.sleep(0.02)
        status = Path(f"/proc/{self.process.pid}/status").read_text(encoding="utf-8")
        memory = int(status.split("VmHWM:")[1].split()[0])
        if memory > MOST_MEMORY_KB:
            raise Broken(f"the server has taken {memory} kB after {what}")
        if b"panicked" in self.errors.read_bytes():
            raise Broken(f"a panic after {what}: {self.errors.read_text()}")


def request(random: Random) -> bytes:
    """A request with something wrong in each of its parts at times, or no request at all."""
    if random.random() < 0.15:
        return random.randbytes(random.choice([0, 1, 100, 5000]))
    lines = [f"{random.choice(METHODS)} {random.choice(PATHS)} {random.choice(['HTTP/1.1', 'HTTP/1.0', 'HTTP/9', ''])}"]
    if random.random() < 0.8:
        lines.append(f"Host: {random.choice(HOSTS)}")
    lines += random.choices(HEADERS, k=random.choice([0, 0, 1, 2, 200]))
    text = random.choice(["\r\n", "\r\n", "\n"]).join([*lines, "", ""]).encode("latin-1")
    if random.random() < 0.2:
        text = text[: random.randrange(len(text) + 1)]
    if random.random() < 0.2:
        text += random.randbytes(random.choice([1, 1000, 100_000]))
    return text


def visit(server: Server, random: Random) -> tuple[str, socket.socket | None]:
    """One visitor: sends a request and reads the answer, or a part of it, or nothing; or stays."""
    manner = random.choice(["reads", "reads", "reads a part", "leaves at once", "stays"])
    try:
        visitor = server.connect()
        visitor.settimeout(0.5)
        visitor.sendall(request(random))
        if manner == "stays":
            return manner, visitor
        if manner == "reads a part":
            visitor.recv(random.choice([1, 100]))
        elif manner == "reads" and random.random() < 0.5:
            visitor.shutdown(socket.SHUT_WR)
            while visitor.recv(1 << 16):
                pass
        elif manner == "reads":
            visitor.recv(1 << 16)
    except OSError:
        return "was turned away, or had no answer in half a second", None
    visitor.close()
    return manner, None


def requests(context: Context) -> dict[str, int]:
    """Fifty visitors, of whom some stay until the end, and then an honest one."""
    server = context.server
    if not isinstance(server, Server) or server.process.poll() is not None:
        server = context.server = Server(context)
    counts: dict[str, int] = {}
    staying = []
    for _ in range(50):
        how, visitor = visit(server, context.random)
        name = f"requests: the visitor {how}"
        counts[name] = counts.get(name, 0) + 1
        staying += [visitor] if visitor else []
    try:
        server.require_service("50 visitors")
    except Broken:
        server.process.kill()
        raise
    finally:
        for visitor in staying:
            visitor.close()
    return counts
