"""Tests of `talcum watch` where people look at it: the page in headless Chromium, the screen in a pseudo-terminal.

They need a program that was built, and the page `chromium`; where one is missing they are skipped. With
TALCUM_KEEP_PICTURES=FOLDER the page is kept there as an image, to be looked at.
"""

from __future__ import annotations

import fcntl
import os
import pty
import re
import select
import shutil
import signal
import struct
import subprocess
import tempfile
import termios
import threading
import time
import unittest
import urllib.request
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Callable

import numpy as np

from made_up_results import ScriptTest, bed, write_profiles, write_series
from talcum_results import ResultsError, program

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
# How long a program may take on a machine with other work, in seconds.
PATIENCE = 120.0
TIMES = np.arange(0.0, 60.5, 0.5)


def make_results(folder: Path) -> None:
    """A bed through which waves climb, and the series of its run."""
    height = np.arange(0.0, 100.5, 1.5)
    phi = bed(TIMES, height, 40.0, lambda z, t: 0.05 * np.sin(0.3 * z - 0.8 * t))
    write_profiles(folder, TIMES, height, phi)
    write_series(folder, {"time": TIMES, "grid_pressure_drop": 1.0 - np.exp(-TIMES), "bed_top": 40.0 + np.sin(TIMES)})


def talcum() -> str:
    """The program that was built; skips the test without one."""
    try:
        return program()
    except ResultsError as error:
        raise unittest.SkipTest(f"talcum is not built: {error}") from error


class WatchTest(ScriptTest):
    """A results folder, and programs that end with the test."""

    def start(self, *arguments: str) -> subprocess.Popen:
        """Starts the program on the folder, with its output in a pipe."""
        command = [talcum(), "watch", str(self.folder), *arguments]
        started = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        self.addCleanup(started.wait)
        self.addCleanup(started.stdout.close)
        self.addCleanup(started.kill)
        return started

    def serve(self) -> str:
        """Serves the folder; returns the address of the page."""
        line = self.start("--serve", "0").stdout.readline()
        return line.split()[0]


class Relay(BaseHTTPRequestHandler):
    """Stands between browser and server, counts how often the page looks, and does something at its third look."""

    target = ""
    looks: list[str] = []
    at_third_look: Callable[[], None]

    def do_GET(self) -> None:
        """Passes a request on."""
        if self.path == "/state.json":
            Relay.looks.append(self.path)
            if len(Relay.looks) == 3:
                Relay.at_third_look()
        with urllib.request.urlopen(Relay.target + self.path) as answer:
            body = answer.read()
            self.send_response(answer.status)
            self.send_header("Content-Type", answer.headers["Content-Type"])
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, *_: object) -> None:
        """Says nothing."""


@unittest.skipUnless(CHROMIUM, "chromium is not installed: the page of talcum watch is not tested")
class TestPage(WatchTest):
    """The page, as a browser shows it."""

    def browse(self, address: str, *more: str) -> str:
        """Opens a page, waits some seconds of its time, and returns what stands in it then."""
        profile = tempfile.mkdtemp(prefix="talcum-chromium-")
        self.addCleanup(shutil.rmtree, profile, ignore_errors=True)
        command = [CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"]
        command += [f"--user-data-dir={profile}", "--hide-scrollbars", "--window-size=1240,1180"]
        command += ["--virtual-time-budget=8000", *more, address]
        browser = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=True)
        return browser.stdout

    def drawn(self, page: str) -> dict[str, int]:
        """What the page says that it has drawn."""
        status = re.search(r'<p[^>]*id="status"[^>]*>', page).group()
        count = lambda name: int(re.search(f'data-{name}="(\\d+)"', status).group(1))
        return {name: count(name) for name in ("curves", "profile", "particles")}

    def test_curves_and_profiles_are_drawn(self) -> None:
        make_results(self.folder)
        address = self.serve()
        page = self.browse(address, "--dump-dom")
        self.assertEqual(self.drawn(page), {"curves": 2, "profile": len(TIMES), "particles": 0})
        self.assertIn("stopped before its end", page)
        self.assertIn("time 60 of 1000 sqrt(d/g), 6 %", page)
        # No particles, no place for them.
        self.assertRegex(page, r'<div[^>]*id="bed-panel"[^>]*hidden')
        self.assertNotRegex(page, r'<div[^>]*id="profile-panel"[^>]*hidden')
        self.browse(address, f"--screenshot={self.folder / 'page.png'}")
        self.assert_picture("page.png")
        self.assertGreater((self.folder / "page.png").stat().st_size, 30_000)

    def test_an_empty_folder_draws_nothing_and_waits(self) -> None:
        page = self.browse(self.serve(), "--dump-dom")
        self.assertEqual(self.drawn(page), {"curves": 0, "profile": 0, "particles": 0})
        self.assertIn("waiting: nothing has been written yet", page)

    def test_the_page_renews_itself(self) -> None:
        looks = Relay.looks = []
        Relay.target = self.serve().rstrip("/")
        # Written when the page, which was opened on an empty folder, looks for the third time.
        Relay.at_third_look = lambda: make_results(self.folder)
        with ThreadingHTTPServer(("127.0.0.1", 0), Relay) as relay:
            threading.Thread(target=relay.serve_forever, daemon=True).start()
            page = self.browse(f"http://127.0.0.1:{relay.server_port}/", "--dump-dom")
            relay.shutdown()
        self.assertGreater(len(looks), 3)
        self.assertEqual(self.drawn(page)["curves"], 2)

    def test_a_title_is_text_not_markup(self) -> None:
        make_results(self.folder)
        case = (self.folder / "case.toml").read_text(encoding="utf-8")
        title = "<img src=x onerror=document.body.remove()>"
        (self.folder / "case.toml").write_text(case.replace('"made up"', f'"{title}"', 1), encoding="utf-8")
        page = self.browse(self.serve(), "--dump-dom")
        self.assertIn("&lt;img src=x", page)
        self.assertEqual(self.drawn(page)["curves"], 2)

    def test_a_run_with_particles_shows_its_bed(self) -> None:
        case = Path(__file__).resolve().parent.parent / "cases/smoke/fluidised.toml"
        command = [talcum(), "run", str(case), "--output", str(self.folder), "--until", "5e-4"]
        subprocess.run(command, check=True, capture_output=True, timeout=PATIENCE)
        page = self.browse(self.serve(), "--dump-dom")
        self.assertEqual(self.drawn(page)["particles"], 900)
        self.assertIn("complete, digest", page)


class TestTerminal(WatchTest):
    """The screen, in a pseudo-terminal."""

    def look(self, end: bytes | int) -> tuple[str, int]:
        """Shows the folder, ends by a key or a signal once all stands there; returns the text and the exit code."""
        command = [talcum(), "watch", str(self.folder)]
        process, terminal = pty.fork()
        if process == 0:
            os.environ["TERM"] = "xterm-256color"
            fcntl.ioctl(0, termios.TIOCSWINSZ, struct.pack("HHHH", 36, 120, 0, 0))  # rows and columns
            os.execv(command[0], command)
        text, has_asked, deadline = b"", False, time.monotonic() + PATIENCE
        while time.monotonic() < deadline:
            if select.select([terminal], [], [], 0.1)[0]:
                try:
                    text += os.read(terminal, 65536)
                except OSError:
                    break
            if not has_asked and b"leave" in text:
                has_asked = True
                if isinstance(end, bytes):
                    os.write(terminal, end)
                else:
                    os.kill(process, end)
        else:
            os.kill(process, signal.SIGKILL)
        status = os.waitpid(process, 0)[1]
        os.close(terminal)
        return text.decode("utf-8", "replace"), os.waitstatus_to_exitcode(status)

    def test_plots_are_drawn_and_the_terminal_is_left_as_it_was(self) -> None:
        make_results(self.folder)
        for end in (b"q", b"\x03", signal.SIGTERM):
            text, code = self.look(end)
            self.assertEqual(code, 0, text)
            self.assertIn("made up", text)
            self.assertIn("bed_top", text)
            dots = sum("\u2801" <= character <= "\u28ff" for character in text)
            self.assertGreater(dots, 50)
            entered, left = text.find("\x1b[?1049h"), text.rfind("\x1b[?1049l")
            self.assertTrue(0 <= entered < left, "the alternate screen is left")
            self.assertGreater(text.rfind("\x1b[?25h"), entered, "the cursor is shown again")

    def test_an_error_before_the_screen_leaves_the_terminal_alone(self) -> None:
        (self.folder / "notes.txt").write_text("", encoding="utf-8")
        text, code = self.look(b"q")
        self.assertEqual(code, 1)
        self.assertIn("holds no case.toml", text)
        self.assertNotIn("\x1b[?1049h", text)


if __name__ == "__main__":
    unittest.main()
