"""Helpers for tests of the module: a folder, the command, comparison of tables."""

import os
import pathlib
import subprocess
import tempfile
import unittest

import numpy

SOURCES = pathlib.Path(os.environ["THRONG_SOURCE_DIR"])
SLOWNESS = float(os.environ.get("THRONG_SLOWNESS", "1"))


class Case(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)

    def assertSameTable(self, found, expected):
        self.assertEqual(found.dtype.names, expected.dtype.names)
        self.assertEqual(len(found), len(expected))
        for name in found.dtype.names:
            numpy.testing.assert_array_equal(found[name], expected[name], err_msg=name)


def command(*arguments, folder):
    """Returns the output of the command."""
    done = subprocess.run(
        [os.environ["THRONG_COMMAND"], *map(str, arguments)], cwd=folder, capture_output=True, text=True
    )
    if done.returncode != 0:
        raise AssertionError(done.stderr)
    return done.stdout


def command_hash(*arguments, folder):
    lines = command("run", *arguments, "--lcm", "off", "--log", "off", folder=folder).splitlines()
    return next(line.split()[1] for line in lines if line.startswith("hash"))
