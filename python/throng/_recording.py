"""Recordings of people, and comparisons of two crowds."""

import inspect
import os
import tempfile

import numpy

from . import _core
from ._validation import numbers, path_of
from ._run import Run, options_of, progress_of, run
from ._scene import errors_of
from ._table import Table


class Recording:
    """Trajectories of people from an experiment or another simulator, in any supported file format.

    Args:
        file: path of the recording.
        fps, unit, heading_unit, columns, separator, tracked_point, strict: properties that the file does not state, as
            in run().

    Attributes:
        people: Table, one row per person. Columns: id, samples (number of), first_s, last_s, height_m (nan: unknown).
        samples: Table, one row per recorded position, sorted by person and time. Columns: id, time_s, x_m, y_m, z_m,
            heading_rad (nan: unknown).
        facts: dict of properties of the file: kind, tracked_point, fps, frames, duration_s, samples, shift_m
            (subtracted from its positions), wkt (its walkable area), and anomalies, a list of (kind, count, first
            occurrence).
        summary: dict: mean_people, max_people and max_people_at_s; speed_mps, density_per_m2 and height_m, each as
            (5 % quantile, median, 95 % quantile).
    """

    def __init__(
        self,
        file,
        *,
        fps=None,
        unit=None,
        heading_unit=None,
        columns=None,
        separator=None,
        tracked_point=None,
        strict=False,
    ):
        given = {name: value for name, value in locals().items() if name not in ("self", "file")}
        self._options = {name: value for name, value in given.items() if value not in (None, False)}
        self._file = path_of("file", file)
        self._recording = _core.Recording(options_of(file, self._options))

    def __reduce__(self):
        return _opened, (os.path.abspath(self._file), self._options)

    people = property(lambda self: Table(self._recording.people()))
    samples = property(lambda self: Table(self._recording.samples()))
    facts = property(lambda self: self._recording.facts())
    summary = property(lambda self: self._recording.summary())

    def run(self, **options):
        """Retarget bodies onto the tracks and find their contacts: run() with this file; return a Run."""
        return run(self._file, **{**self._options, **options})


_options = list(inspect.signature(run).parameters.values())[1:]
Recording.run.__signature__ = inspect.Signature(
    [inspect.Parameter("self", inspect.Parameter.POSITIONAL_OR_KEYWORD), *_options]
)


def _opened(file, options):
    return Recording(file, **options)


class Comparison:
    """Measures of two crowds, a and b, side by side. print() shows all measures; a notebook also shows the figures.

    Attributes:
        a, b: dicts of the two runs: name, people, seconds, person_s (sum of the times of all people).
        tables: dict from measure (speed_density, spacing, flow, contacts, depth, ...) to Table. Columns: at (range or
            place of the row, as text), from, to (bounds of the range; nan: none), which (subset, or ""), what
            (statistic), unit (of a and b), a, b (values; nan: none).
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
        """Return a dict from figure to (title, SVG text), drawn by gnuplot. With a folder, also write them there."""
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
    """Run two scenes, recordings or logs with exact=True and measure both, as `throng compare` does.

    Args:
        a, b: sources, as in run(). A Run is repeated with its options.
        seconds: simulated time of each in seconds [the scene's, or that of the Run].
        line: line across which the flow is measured, (x, y, x, y) in metres [the narrowest place].
        threads: number of threads [all cores].
        progress: as in run().

    Returns:
        Comparison
    """
    given = {"seconds": seconds, "threads": threads, "exact": True}
    if line is not None:
        line = numbers("line", line, "two points: x, y, x, y", (None,)).tolist()
    with errors_of(a, b):
        found = _core.compare(_request_of(a, given), _request_of(b, given), line, progress_of(progress))
    return Comparison(found)


def _request_of(source, given):
    if isinstance(source, Run):
        return {**source._request, **{name: value for name, value in given.items() if value is not None}}
    return options_of(source, given)
