"""`throng monitor` in a pseudo terminal: what the screen shows, keys, sizes, and its state afterwards.

Usage: monitor_terminal_test.py THRONG
"""
import codecs
import fcntl
import os
import pty
import re
import select
import signal
import struct
import subprocess
import sys
import termios
import time
import unittest

THRONG = sys.argv[1]
SKIPPED = 77  # SKIP_RETURN_CODE of ctest
LIMIT_S = 60  # a busy machine


class Screen:
    """The part of a terminal that throng monitor uses. Any other escape sequence is an error."""

    SEQUENCE = re.compile(r"\x1b\[(\??)([0-9;]*)([A-Za-z])")

    def __init__(self, columns, rows):
        self.is_alternate = False
        self.has_cursor = True
        self.normal = ""  # text outside the alternate screen
        self.resize(columns, rows)

    def resize(self, columns, rows):
        self.columns, self.rows = columns, rows
        self.cells = [[" "] * columns for _ in range(rows)]
        self.x = self.y = 0

    def feed(self, text):
        at = 0
        while at < len(text):
            found = self.SEQUENCE.match(text, at)
            if found:
                self.obey(*found.groups())
                at = found.end()
                continue
            if text[at] == "\x1b":
                raise AssertionError(f"unknown sequence {text[at:at + 8]!r}")
            self.put(text[at])
            at += 1

    def obey(self, private, numbers, command):
        if private:
            is_set = command == "h"
            if numbers == "1049":
                self.is_alternate = is_set
            elif numbers == "25":
                self.has_cursor = is_set
            else:
                raise AssertionError(f"unknown mode {numbers}")
        elif command == "H" and not numbers:
            self.x = self.y = 0
        elif command == "J":
            first = 0 if numbers == "2" else self.y + 1
            for y in range(first, self.rows):
                self.cells[y] = [" "] * self.columns
        elif command == "K" and numbers == "2":
            self.cells[self.y] = [" "] * self.columns
        else:
            raise AssertionError(f"unknown sequence {numbers}{command}")

    def put(self, character):
        if not self.is_alternate:
            self.normal += character
        elif character == "\r":
            self.x = 0
        elif character == "\n":
            assert self.y + 1 < self.rows, "the picture scrolls"
            self.y += 1
        else:
            assert self.x < self.columns, "a line is wider than the screen"
            self.cells[self.y][self.x] = character
            self.x += 1

    @property
    def lines(self):
        return ["".join(cells).rstrip() for cells in self.cells]


class Monitored:
    """throng monitor in a terminal, or a shell with job control that starts it."""

    def __init__(self, columns=80, rows=24, *options, shell=None):
        self.screen = Screen(columns, rows)
        self.outside, self.terminal = pty.openpty()
        self.set_size(columns, rows)
        self.before = termios.tcgetattr(self.terminal)

        def take_terminal():
            os.setsid()
            fcntl.ioctl(0, termios.TIOCSCTTY, 0)

        self.process = subprocess.Popen(
            ["sh", "-mc", shell, THRONG] if shell else [THRONG, "monitor", *options], stdin=self.terminal, stdout=self.terminal, stderr=self.terminal,
            preexec_fn=take_terminal)
        self.decoder = codecs.getincrementaldecoder("utf-8")()
        self.text = ""

    def set_size(self, columns, rows):
        fcntl.ioctl(self.outside, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))

    def resize(self, columns, rows):
        self.screen.resize(columns, rows)
        self.set_size(columns, rows)

    def read(self, wait_s=0.05):
        while select.select([self.outside], [], [], wait_s)[0]:
            try:
                received = os.read(self.outside, 65536)
            except OSError:  # the terminal is closed
                return
            text = self.text + self.decoder.decode(received)
            # A sequence may arrive in pieces.
            whole = len(text) - len(re.search(r"(\x1b(\[[?0-9;]*)?)?$", text)[0])
            self.text = text[whole:]
            self.screen.feed(text[:whole])

    def until(self, condition, what):
        end = time.monotonic() + LIMIT_S
        while True:
            self.read()
            if condition(self.screen.lines):
                return self.screen.lines
            if time.monotonic() > end:
                raise AssertionError(f"{what}, the screen is\n" + "\n".join(self.screen.lines))

    def press(self, keys):
        os.write(self.outside, keys.encode())

    def end(self):
        """Waits for the end and returns the exit code."""
        end = time.monotonic() + LIMIT_S
        while self.process.poll() is None and time.monotonic() < end:
            self.read()
        self.read(0)
        return self.process.wait(1)

    def is_restored(self):
        return (termios.tcgetattr(self.terminal) == self.before and self.screen.has_cursor
                and not self.screen.is_alternate)

    def close(self):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        os.close(self.outside)
        os.close(self.terminal)


CONTACT = re.compile(r"^ *(\d+\.\d+) s +(.+)$")


def contacts(lines):
    """(time, text) of each contact on the screen."""
    return [(float(found[1]), found[2]) for found in map(CONTACT.match, lines) if found]


def is_full(lines):
    return len(contacts(lines)) >= 10


class MonitorTerminal(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.crowd = cls.start("robot_in_crowd")

    @staticmethod
    def start(scene):
        return subprocess.Popen(
            [THRONG, "run", scene, "--pace", "1", "--seconds", "3600", "--log", "off"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    @classmethod
    def tearDownClass(cls):
        cls.crowd.kill()
        cls.crowd.wait()

    def monitor(self, *arguments, **options):
        monitored = Monitored(*arguments, **options)
        self.addCleanup(monitored.close)
        return monitored

    def test_shows_the_newest_contacts_first_on_80_by_24(self):
        seen = self.monitor(80, 24)
        lines = seen.until(is_full, "ten contacts")
        self.assertIn("robot_in_crowd", lines[0])
        self.assertEqual(lines[4], "newest contacts")
        times = [time_s for time_s, _ in contacts(lines[5:15])]
        self.assertEqual(len(times), 10)
        self.assertEqual(times, sorted(times, reverse=True))
        self.assertTrue(lines[-1].startswith("q quit  s sort: newest  f filter: all  / find"), lines[-1])

    def test_sorts_by_length_and_number(self):
        seen = self.monitor()
        seen.until(is_full, "contacts")
        seen.press("s")
        lines = seen.until(lambda lines: "s sort: longest" in lines[-1] and is_full(lines), "the longest")
        lengths = [float(re.search(r", (\d+\.\d) s$", text)[1]) for _, text in contacts(lines)]
        self.assertEqual(lengths, sorted(lengths, reverse=True))
        seen.press("s")
        lines = seen.until(lambda lines: "s sort: number" in lines[-1] and is_full(lines), "by number")
        numbers = [int(re.search(r" (\d+) ", text)[1]) for _, text in contacts(lines)]
        self.assertEqual(numbers, sorted(numbers))

    def test_filters_people_robots_and_obstacles(self):
        seen = self.monitor()
        seen.until(is_full, "contacts")
        for name in ("people", "robots", "obstacles"):
            seen.press("f")
            lines = seen.until(lambda lines: f"f filter: {name}" in lines[-1], name)
            self.assertTrue(lines[4].startswith(f"newest contacts, {name}"), lines[4])
            for _, text in contacts(lines):
                self.assertEqual("robot" in text, name == "robots", text)
        seen.press("f")
        seen.until(lambda lines: "f filter: all" in lines[-1] and is_full(lines), "all")

    def test_finds_parts_and_ids(self):
        seen = self.monitor()
        seen.until(is_full, "contacts")
        seen.press("/hand")
        seen.until(lambda lines: lines[-1].startswith("find: hand_"), "typed text")
        seen.press("\r")
        lines = seen.until(lambda lines: "/ find: hand" in lines[-1] and contacts(lines), "hands")
        self.assertEqual(lines[4], "newest contacts, with 'hand'")
        for _, text in contacts(lines):
            self.assertIn("hand", text)
        number = re.search(r" (\d+) ", contacts(lines)[0][1])[1]
        seen.press(f"\x1b/{number}\r")
        lines = seen.until(lambda lines: f"/ find: {number}" in lines[-1] and contacts(lines), "an id")
        for _, text in contacts(lines):
            self.assertRegex(text, rf" {number}\b")
        seen.press("\x1b")
        seen.until(lambda lines: lines[-1].endswith("/ find") and is_full(lines), "all")

    def test_chooses_one_of_several_runs(self):
        seen = self.monitor()
        seen.until(is_full, "contacts")
        other = self.start("corridor")
        self.addCleanup(lambda: (other.kill(), other.wait()))
        seen.until(lambda lines: lines[0].startswith("corridor"), "the run that starts")
        for scene in ("robot_in_crowd", "corridor", "robot_in_crowd"):
            self.assertIn("r next of 2 runs", seen.screen.lines[-1])
            seen.press("r")
            seen.until(lambda lines: lines[0].startswith(scene), scene)

    def test_fits_every_size(self):
        seen = self.monitor()
        seen.until(is_full, "contacts")
        for columns, rows in ((40, 12), (20, 6), (8, 3), (200, 60), (80, 24)):
            seen.resize(columns, rows)
            lines = seen.until(lambda lines: lines[-1].startswith("q quit"), f"{columns} by {rows}")
            self.assertLessEqual(max(map(len, lines)), columns)
            if rows >= 12:
                self.assertTrue(contacts(lines), lines)
            if rows == 60:
                self.assertIn("channel", "\n".join(lines))
                self.assertIn("N_u", "\n".join(lines))

    def test_restores_the_terminal_when_it_quits(self):
        seen = self.monitor()
        seen.until(is_full, "contacts")
        self.assertFalse(seen.is_restored())
        seen.press("q")
        self.assertEqual(seen.end(), 0)
        self.assertTrue(seen.is_restored())
        self.assertIn("newest contacts", seen.screen.normal)

    def test_restores_the_terminal_after_a_time_limit(self):
        seen = self.monitor(80, 24, "--seconds", "1")
        self.assertEqual(seen.end(), 0)
        self.assertTrue(seen.is_restored())

    def test_restores_the_terminal_after_signals(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT, signal.SIGABRT, signal.SIGSEGV):
            with self.subTest(signal=number.name):
                seen = self.monitor()
                seen.until(is_full, "contacts")
                seen.process.send_signal(number)
                seen.end()
                self.assertTrue(seen.is_restored())

    def test_restores_the_terminal_when_a_second_signal_ends_a_halted_monitor(self):
        seen = self.monitor()
        seen.until(is_full, "contacts")
        termios.tcflow(seen.terminal, termios.TCOOFF)  # Ctrl-S: the monitor waits for its terminal
        time.sleep(1)
        seen.process.send_signal(signal.SIGTERM)
        time.sleep(1)
        seen.process.send_signal(signal.SIGTERM)
        seen.end()
        self.assertTrue(seen.is_restored())

    def test_returns_the_terminal_while_it_is_stopped(self):
        seen = self.monitor(shell='"$0" monitor; echo stopped; read -r line; fg')
        seen.until(is_full, "contacts")
        seen.press("\x1a")  # Ctrl-Z
        seen.until(lambda _: "stopped" in seen.screen.normal, "the shell")
        self.assertTrue(seen.is_restored())
        seen.press("\n")
        seen.until(lambda _: seen.screen.is_alternate, "the picture again")
        seen.until(is_full, "contacts")
        self.assertFalse(seen.is_restored())
        seen.press("q")
        self.assertEqual(seen.end(), 0)
        self.assertTrue(seen.is_restored())

    def test_prints_lines_to_a_pipe(self):
        printed = subprocess.run([THRONG, "monitor", "--seconds", "3"], capture_output=True, text=True).stdout
        self.assertNotIn("\x1b", printed)
        self.assertRegex(printed, r"frame \d+, [\d.]+ s: [\d.]+ frames/s")


def in_network():
    """Runs this test again where multicast works; skips it where that is not allowed."""
    for flags in (["-n"], ["-rn"]):
        if subprocess.run(["unshare", *flags, "true"], stderr=subprocess.DEVNULL).returncode == 0:
            script = "ip link set lo up; ip link set lo multicast on; ip route add 224.0.0.0/4 dev lo; exec \"$@\""
            os.environ["THRONG_OWN_NETWORK"] = "1"
            os.execvp("unshare", ["unshare", *flags, "sh", "-c", script, "sh", sys.executable, *sys.argv])
    if subprocess.run(["ip", "route", "get", "239.255.76.67"], stdout=subprocess.DEVNULL).returncode != 0:
        print("skipped: neither network namespaces nor a multicast route", file=sys.stderr)
        sys.exit(SKIPPED)


if __name__ == "__main__":
    if "THRONG_OWN_NETWORK" not in os.environ:
        in_network()
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
