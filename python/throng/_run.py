"""A run as a whole."""

import os
import sys
import tempfile

import numpy

from . import _core
from ._validation import input_error, integers, path_of
from ._table import Table, has_columns

_LEVELS = numpy.array(["spheres", "boxes", "part volumes", "triangles"])
# What stands for all parts of a body.
_WHOLE_BODY = 255


def options_of(source, given):
    """What the compiled half takes: names as given, without what is None."""
    options = {name: value for name, value in given.items() if value is not None}
    options["source"] = path_of("source", source, "the name of a scene, or a path")
    return options


class Names:
    """What the numbers of bodies, parts and groups stand for."""

    def __init__(self, facts):
        self.groups = list(facts["groups"])
        self.models = list(facts["models"])
        self.parts = [list(names) for names in facts["part_names"]]
        self.obstacles = list(facts["obstacles"])
        self._model_of_person = facts["people"]["model"]
        # One row a model, one for each obstacle, and what stands for a whole body at the end of each. The last row
        # is of bodies that the run does not have.
        kinds = self.parts + [[name] for name in self.obstacles]
        self._part_counts = numpy.array([len(names) for names in kinds], dtype=numpy.int64)
        self._table = numpy.full((len(kinds) + 1, 256), "", dtype=object)
        for row, names in enumerate(kinds):
            self._table[row, : len(names)] = names
            self._table[row, _WHOLE_BODY] = "whole body" if row < len(self.parts) else names[0]

    def part(self, bodies, parts):
        """Names of parts, one for each pair of a body's and a part's number; 255 is the whole body."""
        bodies, parts = integers("bodies", bodies), integers("parts", parts)
        if len(bodies) != len(parts):
            raise input_error("bodies, parts", "as many of one as of the other", f"{len(bodies)} and {len(parts)}")
        count = len(self._model_of_person) + len(self.obstacles)
        for i in numpy.flatnonzero((bodies < 0) | (bodies >= count))[:1]:
            raise input_error(f"bodies[{i}]", f"a body's number from 0, below {count}", bodies[i])
        counts = self._part_counts[self._kinds(bodies)]
        for i in numpy.flatnonzero((parts != _WHOLE_BODY) & ((parts < 0) | (parts >= counts)))[:1]:
            raise input_error(f"parts[{i}]", f"a part's number from 0, below {counts[i]}, or {_WHOLE_BODY}", parts[i])
        return self._of_parts(bodies, parts)

    def _kinds(self, bodies):
        """Rows of the table."""
        people = len(self._model_of_person)
        kinds = numpy.minimum(len(self.parts) + bodies - people, len(self._table) - 1)
        is_person = bodies < people
        kinds[is_person] = self._model_of_person[bodies[is_person]]
        return kinds

    def _of_parts(self, bodies, parts):
        return self._table[self._kinds(bodies.astype(numpy.int64)), parts]

    def of_pairs(self, table):
        out = {
            f"part_{side}_name": self._of_parts(table[side], table[f"part_{side}"])
            for side in "ab"
            if has_columns(table, side, f"part_{side}")
        }
        if has_columns(table, "level"):
            out["level_name"] = _LEVELS[table["level"]]
        return out

    def of_people(self, table):
        names = {"group": self.groups, "model": self.models}
        return {
            f"{name}_name": numpy.array([*known, ""], dtype=object)[numpy.minimum(table[name], len(known))]
            for name, known in names.items()
            if has_columns(table, name)
        }


class Run:
    """What a run was, in arrays.

    It can be pickled, with all its tables.

    Attributes:
        scene: its name; seed, run_id, step_s as well.
        hash: of all events, 16 hexadecimal digits, as `throng run` prints it; None of a log that is cut off.
        people: Table (people): id, group, model, scale, height_m.
        events: Table (events): frame, a, b, part_a, part_b, kind (0 begins, 1 ends), level (0 spheres, 1 boxes,
            2 part volumes, 3 triangles); a < b are bodies, people first, then obstacles.
        contacts: Table (contacts): a, b, part_a, part_b, level, ended (0: it lasted to the end of the run),
            begin_frame, end_frame, begin_s, end_s; in the order in which they begin.
        trajectories: Table (rows): frame, time_s, id, x_m, y_m, z_m, heading_rad, speed_mps; a row for everybody
            who is there.
        counters: Table (frames): time_s, touching, begins, ends, persisting, and updates, tests and passed of
            each stage of culling (avatar, body_box, part_box, part, exact), frame_ms, cull_ms.
        summary: a dict of totals.
        separation: None, or of a scene with a `separation`: a dict of robots, shortfalls, pairs, undetermined,
            beyond_margin and regions: name -> a dict of shortfalls, shortfall_s, max_shortfall_m, min_distance_lo_m, min_distance_hi_m.
        notes: what the user should know, a line each.
        names: .groups, .models, .parts (a list a model), .obstacles; .part(bodies, parts) gives names.
        log: the log that was written, or None.
    """

    def __init__(self, facts, log=None, page=None):
        self.scene = facts["scene"]
        self.seed = facts["seed"]
        self.run_id = facts["run_id"]
        self.step_s = facts["step_s"]
        self.hash = facts["hash"]
        self.summary = facts["summary"]
        self.separation = facts.get("separation")
        self.notes = facts["notes"]
        self.log = log
        self.names = Names(facts)
        self.people = Table(facts["people"], self.names.of_people)
        self.events = Table(facts["events"], self.names.of_pairs)
        self.trajectories = Table(facts["trajectories"])
        self.counters = Table(facts["counters"])
        self._find_contacts = facts["find_contacts"]
        self._contacts = None
        self._page = page

    @property
    def contacts(self):
        if self._contacts is None:
            self._contacts = Table(self._find_contacts(), self.names.of_pairs)
        return self._contacts

    def __getstate__(self):
        self.contacts  # what finds them stays here
        return {**self.__dict__, "_find_contacts": None}

    def view(self):
        """The page with this run in it, shown in a notebook. Needs run(..., view=True) or a log."""
        from ._log import Page, view

        if self._page is not None:
            return Page(self._page)
        if self.log is not None:
            return view(self.log)
        raise ValueError("this run was not kept to be viewed: run(..., view=True) or run(..., log=FILE) does")

    def __repr__(self):
        return (
            f"<throng.Run {self.scene}: {len(self.people)} people, {len(self.counters)} frames, "
            f"{len(self.events)} events, hash {self.hash}>"
        )


def progress_of(progress):
    """None, or what is called with (done, all): a bar on stderr for True."""
    if progress is None or progress is False:
        return None
    if progress is not True:
        return progress

    def show(done, total):
        filled = 30 * done // max(total, 1)
        end = "\n" if done >= total else ""
        sys.stderr.write(f"\r[{'#' * filled}{'.' * (30 - filled)}] {done}/{total}{end}")
        sys.stderr.flush()

    return show


def run(
    source,
    *,
    seconds=None,
    avatars=None,
    seed=None,
    steering=None,
    part_volume=None,
    exact=False,
    near=None,
    person_near=None,
    contact_points=False,
    between=None,
    parts=None,
    threads=None,
    budget_ms=None,
    budget_tests=None,
    strategy=None,
    simd=None,
    pair_search=None,
    fps=None,
    unit=None,
    heading_unit=None,
    columns=None,
    separator=None,
    tracks=None,
    strict=False,
    step=None,
    trajectories=True,
    trajectory_fps=None,
    log=None,
    states_hz=None,
    publish_part_poses=False,
    html=None,
    trajectory=None,
    trajectory_area=None,
    contacts=None,
    separation=None,
    trace_hash=None,
    view=False,
    progress=None,
):
    """Runs a scene, a recording or a log to its end: who touches whom, frame by frame.

    The options are those of `throng run`, with the same names and defaults, and give the same hash; but nothing
    is published or written unless asked for. Others may run Python meanwhile. Ctrl-C ends the run after the
    frame that it is in, with files complete, and raises KeyboardInterrupt.

    Args:
        source: a scene file, the name of a bundled scene (see scenes()), a recording, or a log.
        seconds, avatars, seed, steering, part_volume, exact: as the command's.
        near, person_near: margins in metres, as the command's: rows go to the log, and to Frame.near of a Simulation.
        contact_points: where parts touch and how deep, with exact=True: to the log, and to Frame.contact_points.
        between, parts: the pairs that are asked for, as the command's: "robots: people", "hands: head".
        threads, budget_ms, budget_tests, strategy, simd, pair_search: as the command's.
        fps, unit, heading_unit, columns, separator, tracks, strict, step: of a recording, as the command's.
        trajectories, trajectory_fps: whether places are kept, and how many a second [10, or a recording's].
        log, states_hz, publish_part_poses: a log to write.
        html: a page to write, with the run in it. trajectory: a file .sqlite or .csv, or a list of them.
        trajectory_area: of a walkable area in pieces the one in FILE.sqlite: "largest", or its number by size, from 1.
        contacts: a folder for contact statistics. separation: a folder for how near robots came to people.
        trace_hash: a file for a hash a stage and frame.
        view: True keeps the page, for Run.view().
        progress: True for a bar on stderr, or a function that is called with (frames done, all frames).

    Returns:
        Run

    Raises:
        InputError: with .file and .line where a file is at fault. EnvironmentFault. KeyboardInterrupt.
    """
    given = {name: value for name, value in locals().items() if name not in ("source", "view", "progress")}
    for name in ("log", "html", "contacts", "separation", "trace_hash"):
        if given[name] is not None:
            given[name] = os.fspath(given[name])
    if trajectory is not None:
        files = [trajectory] if isinstance(trajectory, (str, os.PathLike)) else trajectory
        given["trajectory"] = [os.fspath(file) for file in files]
    if trajectory_area is not None:
        given["trajectory_area"] = str(trajectory_area)
    page = None
    with tempfile.TemporaryDirectory() as folder:
        kept = given["html"]
        if view and kept is None:
            kept = given["html"] = os.path.join(folder, "page.html")
        facts = _core.run(options_of(source, given), progress_of(progress))
        if view:
            with open(kept, encoding="utf-8") as file:
                page = file.read()
    return Run(facts, log=given["log"], page=page)


def scenes():
    """The bundled scenes: a dict of their names and what they are."""
    return dict(_core.scenes())
