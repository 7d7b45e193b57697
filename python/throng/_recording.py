"""Recordings of people, and two crowds side by side."""

import os
import tempfile

import numpy

from . import _core
from ._validation import numbers, path_of
from ._run import options_of, progress_of, run
from ._table import Table


class Recording:
    """Where people of an experiment or of another simulator were, whatever the format of the file.

    Takes what the file does not say: fps, unit, heading_unit, columns, separator, tracks, strict, as run() does.

    Attributes:
        people: Table: id, samples, first_s, last_s, height_m (nan: none).
        samples: Table: id, time_s, x_m, y_m, z_m, heading_rad (nan: none), person after person.
        facts: a dict: kind, tracks, fps, frames, duration_s, odd (what is odd: what, how often, where first), ...
        summary: a dict: mean_people, most_people; speed_mps, density_per_m2, height_m as (5 %, median, 95 %).
    """

    def __init__(self, file, **options):
        self._file = path_of("file", file)
        self._options = options
        self._recording = _core.Recording(options_of(file, options))

    def __reduce__(self):
        return _opened, (os.path.abspath(self._file), self._options)

    people = property(lambda self: Table(self._recording.people()))
    samples = property(lambda self: Table(self._recording.samples()))
    facts = property(lambda self: self._recording.facts())
    summary = property(lambda self: self._recording.summary())

    def run(self, **options):
        """Dresses its people in bodies and culls them: run() with this file."""
        return run(self._file, **{**self._options, **options})


def _opened(file, options):
    return Recording(file, **options)


class Comparison:
    """Two crowds, measure by measure. print() shows all of it; a notebook shows the figures, too.

    Attributes:
        a, b: dicts of what was run: name, people, seconds, person_s.
        tables: a dict by measure (speed_density, spacing, flow, contacts, depth, ...) of Tables: at, from, to,
            which, what, unit, a, b; nan where one of them has nothing.
    """

    _ROW = numpy.dtype(
        [("at", object), ("from", float), ("to", float), ("which", object), ("what", object), ("unit", object)]
        + [("a", float), ("b", float)]
    )

    def __init__(self, found):
        self._found = found
        self.a, self.b = found.a(), found.b()
        self.tables = {
            measure: Table(numpy.array([_without_none(row) for row in rows], dtype=self._ROW))
            for measure, rows in found.tables().items()
        }

    def __str__(self):
        return self._found.text()

    def figures(self, folder=None):
        """A dict by figure of (title, SVG), drawn by gnuplot; with a folder they are written there, too."""
        if folder is not None:
            os.makedirs(folder, exist_ok=True)
            return self._found.figures(os.fspath(folder))
        with tempfile.TemporaryDirectory() as scratch:
            return self._found.figures(scratch)

    def _repr_html_(self):
        return "".join(f"<h4>{title}</h4>{svg}" for title, svg in self.figures().values())


def _without_none(row):
    return tuple(float("nan") if value is None else value for value in row)


def compare(a, b, seconds=None, line=None, threads=None, progress=None):
    """Runs two scenes, recordings or logs with triangles and measures both, as `throng compare` does.

    line: where the flow is measured, (x, y, x, y) [the narrowest place]. Returns a Comparison.
    """
    given = {"seconds": seconds, "threads": threads, "exact": True}
    if line is not None:
        line = numbers("line", line, "two points: x, y, x, y", (None,)).tolist()
    found = _core.compare(options_of(a, given), options_of(b, given), line, progress_of(progress))
    return Comparison(found)
