"""Tables of studies and of logs."""

import csv
import io
import os
import re
import warnings
from collections.abc import Mapping

import numpy

from . import _core
from ._errors import InputError
from ._run import progress_of, volumes_text
from ._scene import SceneText, plain, text_and_places
from ._table import Table
from ._validation import abbreviated, input_error, integer, numbers, path_of

# Name of a study built in code in messages of the library.
_NAME = "study"
# Form of the cells of a column, by its kind.
_FORMS = {"integer": r"[+-]?\d{1,18}", "number": r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", "text": r"(?s).*"}
# Arguments of study() that are no keys of a study file.
_OF_STUDIES = ("scenes", "threads", "out", "progress")
# Columns of text in tables of logs.
_TEXTS = ("kind", "name", "name_a", "name_b", "part_a", "part_b", "region", "group", "goal")


class Study(Table):
    """Table with one row per run of a study. Columns: run, runs, study, scene, seed, a column per option and parameter,
    then the measures that `throng study --columns` lists; nan where there is nothing to measure.

    Attributes:
        times: Table, one row per run. Columns: run, runs, study, setup_s, wall_s, cpu_s, realtime_factor, peak_rss_mb.
        notes: notes on the scenes, one line each.
    """

    def __new__(cls, found):
        table = _rows(**found["table"]).view(cls)
        table._found = found
        return table

    def __array_finalize__(self, other):
        super().__array_finalize__(other)
        self._found = getattr(other, "_found", None)

    def __reduce__(self):
        return Study, (self._found,)

    def __getitem__(self, key):
        part = super().__getitem__(key)
        return part.view(Table) if isinstance(part, Study) else part

    times = property(lambda self: Table(_rows(**self._found["times"])))
    notes = property(lambda self: self._found["notes"])

    def save(self, file):
        """Write the table of all runs as .csv or .sqlite, byte for byte as `throng study --out` does."""
        _core.write_table(path_of("file", file), self._found["table"]["columns"], self._found["table"]["rows"])


def _rows(columns, rows, kinds):
    """Return rows of text as a structured array. kinds: one per column, see _column()."""
    cells = list(zip(*rows)) or [()] * len(columns)
    values = [_column(cells, kind) for cells, kind in zip(cells, kinds)]
    out = numpy.empty(len(rows), [(name, array.dtype) for name, array in zip(columns, values)])
    for name, array in zip(columns, values):
        out[name] = array
    return out


def _column(cells, kind):
    """Return the cells of a column. kind: "integer", "number", "text", or "" to decide by the cells."""
    if kind == "":
        kind = next(kind for kind, form in _FORMS.items() if all(re.fullmatch(form, cell) for cell in cells))
    if kind == "text":
        return numpy.array(cells, dtype=object)
    if kind == "integer" and "" not in cells:
        return numpy.array([int(cell) for cell in cells], dtype=numpy.int64)
    return numpy.array([float(cell or "nan") for cell in cells])


class _errors_in:
    """Context in which an InputError names the place in code, not the line of a text: "parameters.avatars"."""

    def __init__(self, places):
        self._places = places

    def __enter__(self):
        return self

    def __exit__(self, kind, error, trace):
        if not isinstance(error, InputError):
            return
        message, where = str(error), error.where
        for name, places in self._places.items():
            line = re.compile(rf"(?<![\w/]){re.escape(name)}:(\d+)(?!\d)")
            place = lambda at: places[min(int(at[1]), len(places)) - 1]  # noqa: E731 - used at once
            message, where = line.sub(place, message), line.sub(place, where)
        if message != str(error):
            raise InputError(message, where) from None


def _scenes_of(scenes):
    """Return the names of scenes, (name, file, text) of those built in code, and by file the places of lines."""
    names, texts, places = [], [], {}
    for i, scene in enumerate(scenes):
        if not isinstance(scene, SceneText):
            names.append(path_of(f"scenes[{i}]", scene, "a Scene, the name of a scene, or a path"))
            continue
        file = "scene" if i == 0 else f"scene {i + 1}"
        text, lines = text_and_places(scene.to_dict())
        names.append(scene.name or file)
        texts.append((names[-1], file, text))
        places[file] = [f"scenes[{i}].{line}" for line in lines]
    return names, texts, places


def _is_study_file(source):
    """Return whether a source is a file that holds a study; a bare word is the name of a scene."""
    if not isinstance(source, (str, os.PathLike)):
        return False
    path = path_of("scenes", source)
    return bool(re.search(r"[./]", path)) and _core.is_study(path)


def study(
    scenes,
    *,
    seeds=None,
    parameters=None,
    avatars=None,
    seconds=None,
    steering=None,
    part_volume=None,
    exact=None,
    budget_tests=None,
    strategy=None,
    simd=None,
    pair_search=None,
    threads=None,
    out=None,
    progress=None,
):
    """Run scenes x seeds x parameters, as `throng study` does; return a Study with one row per run.

    Other Python threads run meanwhile. Ctrl-C raises KeyboardInterrupt.

    Args:
        scenes: a scene or a list of them, each a Scene, a scene file or the name of a bundled scene. A study file takes
            no arguments but threads, out and progress.
        seeds: seed of a run, a list or range of them, or {"from": 1, "to": 200, "step": 1} [the scene's].
        parameters: dict of what varies; the study runs every combination. Keys are the options below, paths of scene
            keys as in "groups.walkers.desired_speed_mps.mean" ("*": all items of a list), and "latin_hypercube".
            Values are lists, arrays, or ranges {"from": 1.0, "to": 1.6, "step": 0.3}.
        avatars, seconds, steering, part_volume, exact, budget_tests, strategy, simd, pair_search: options of all runs,
            as in run().
        threads: number of threads, 1 to 256 [all cores]. Each executes one run at a time.
        out: table .csv or .sqlite to write, and its .times.csv [none]. Finished runs are stored next to it until it is
            complete: repeat the call to resume a stopped study.
        progress: True shows a bar on stderr; a function is called with (runs done, all runs).

    Returns:
        Study

    Raises:
        InputError: invalid study, scene or value; names the argument or the file and line.
        EnvironmentFault: full disk, missing folder.
        KeyboardInterrupt: Ctrl-C.
    """
    given = {name: value for name, value in locals().items() if name not in _OF_STUDIES and value is not None}
    threads = None if threads is None else integer("threads", threads, 1, 256)
    out = "" if out is None else path_of("out", out)
    if _is_study_file(scenes):
        for name, value in given.items():
            raise input_error(name, "a key of the study file instead", abbreviated(value))
        return Study(_core.study(path_of("scenes", scenes), None, [], out, threads, progress_of(progress)))
    is_one = isinstance(scenes, (SceneText, str, os.PathLike))
    if not is_one and not hasattr(scenes, "__iter__"):
        raise input_error("scenes", "a scene, a list of scenes or a study file", abbreviated(scenes))
    names, texts, places = _scenes_of([scenes] if is_one else scenes)
    if "seeds" in given and not isinstance(seeds, Mapping):
        given["seeds"] = [seeds] if hasattr(seeds, "__index__") else list(seeds)
    if "parameters" in given:
        if not isinstance(parameters, Mapping):
            raise input_error("parameters", "a dict of lists or ranges", abbreviated(parameters))
        given["parameters"] = {
            name: list(values) if isinstance(values, range) else values for name, values in parameters.items()
        }
    if "part_volume" in given:
        given["part_volume"] = volumes_text(part_volume)
    text, places[_NAME] = text_and_places(plain({"scenes": names, **given}))
    with _errors_in(places):
        return Study(_core.study(_NAME, text, texts, out, threads, progress_of(progress)))


def export(log, channel=None, *, out=None, mcap=None, poses_hz=None, progress=None):
    """Convert a log, as `throng export` does: to the Table of a channel, to a CSV file, or to an MCAP file.

    Missing parts of the log are a UserWarning. Ctrl-C raises KeyboardInterrupt.

    Args:
        log: path of the log.
        channel: "events", "states", "touching", "proximity", "contact_points", "separation", "changes" or "frame_stats". Columns
            have the names of the messages; bodies and parts also have names.
        out: CSV file to write in place of a Table [none].
        mcap: MCAP file to write [none].
        poses_hz: poses per simulated second in the MCAP file [10].
        progress: True shows a bar on stderr; a function is called with (per mille read, 1000).

    Returns:
        Table, or None if a file is written.
    """
    if (channel is None) == (mcap is None):
        raise input_error("channel, mcap", "a channel or an MCAP file", "neither" if mcap is None else "both")
    if out is not None and channel is None:
        raise input_error("out", "a channel with it", "none")
    rate = "a number of poses per second above 0"
    if poses_hz is not None and not 0 < numbers("poses_hz", poses_hz, rate, ()) <= 1e4:
        raise input_error("poses_hz", rate, abbreviated(poses_hz))
    file = next((path_of(name, value) for name, value in (("out", out), ("mcap", mcap)) if value is not None), "")
    text, missing = _core.export(path_of("log", log), channel or "", file, poses_hz, progress_of(progress))
    if missing:
        warnings.warn(f"{path_of('log', log)}: {missing} The recorded part is exported.", stacklevel=2)
    if file:
        return None
    columns, *rows = csv.reader(io.StringIO(text, newline=""))
    return Table(_rows(columns, rows, [_kind_of(name) for name in columns]))


def _kind_of(column):
    """Return the kind of a column in a table of a log."""
    if column in _TEXTS:
        return "text"
    return "number" if re.search(r"_(m|s|mps|rad)$|^normal_", column) else "integer"
