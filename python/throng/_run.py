"""Complete runs."""

import os
import sys
import tempfile
from collections.abc import Mapping

import numpy

from . import _core
from ._validation import input_error, integers, path_of
from ._scene import SceneText, errors_of, source_options
from ._table import Table, has_columns

_LEVELS = numpy.array(["spheres", "boxes", "part volumes", "triangles"])
# Options of run() that name files to write.
_OUTPUTS = ("log", "html", "trajectory", "contacts", "separation", "trace_hash")
# Part number that stands for a whole body.
_WHOLE_BODY = 255


def volumes_text(part_volume):
    """Return the option as text: "hands: sphere, default: ordop26"."""
    if isinstance(part_volume, Mapping):
        return ", ".join(f"{words}: {volume}" for words, volume in part_volume.items())
    return part_volume


def options_of(source, given):
    """Return the options for the compiled module: source and all options that are not None."""
    options = {name: value for name, value in given.items() if value is not None}
    if "part_volume" in options:
        options["part_volume"] = volumes_text(options["part_volume"])
    for name in ("log", "html", "contacts", "separation", "trace_hash"):
        if name in options:
            options[name] = os.fspath(options[name])
    if "trajectory" in options:
        files = options["trajectory"]
        options["trajectory"] = [os.fspath(each) for each in ([files] if isinstance(files, (str, os.PathLike)) else files)]
    if "trajectory_area" in options:
        options["trajectory_area"] = str(options["trajectory_area"])
    if isinstance(source, SceneText):
        return {**options, **source_options(source)}
    options["source"] = path_of("source", source, "a Scene, the name of a scene, or a path")
    return options


class Names:
    """Names of the groups, models, parts and obstacles of a run, by number.

    Attributes:
        groups, models, obstacles: lists of names.
        parts: one list of part names per model.
    """

    def __init__(self, facts):
        self.groups = list(facts["groups"])
        self.models = list(facts["models"])
        self.parts = [list(names) for names in facts["part_names"]]
        self.obstacles = list(facts["obstacles"])
        self._model_of_person = facts["people"]["model"]
        self._group_of_person = facts["people"]["group"]
        # One row per model, one per obstacle, each with the name of the whole body. The last row is
        # for bodies that the run does not have.
        kinds = self.parts + [[name] for name in self.obstacles]
        self._part_counts = numpy.array([len(names) for names in kinds], dtype=numpy.int64)
        self._is_person_of_kind = numpy.array(list(facts["is_person"]) + [False] * (len(self.obstacles) + 1))
        self._body_names = None
        self._table = numpy.full((len(kinds) + 1, 256), "", dtype=object)
        for row, names in enumerate(kinds):
            self._table[row, : len(names)] = names
            self._table[row, _WHOLE_BODY] = "whole body" if row < len(self.parts) else names[0]

    def part(self, bodies, parts):
        """Return the names of parts (N, object), for N body numbers and N part numbers; part 255: "whole body"."""
        bodies, parts = integers("bodies", bodies), integers("parts", parts)
        if len(bodies) != len(parts):
            raise input_error("bodies, parts", "arrays of equal length", f"{len(bodies)} and {len(parts)}")
        count = len(self._model_of_person) + len(self.obstacles)
        for i in numpy.flatnonzero((bodies < 0) | (bodies >= count))[:1]:
            raise input_error(f"bodies[{i}]", f"a body number from 0 to {count - 1}", bodies[i])
        counts = self._part_counts[self._kinds(bodies)]
        for i in numpy.flatnonzero((parts != _WHOLE_BODY) & ((parts < 0) | (parts >= counts)))[:1]:
            raise input_error(f"parts[{i}]", f"a part number from 0 to {counts[i] - 1}, or {_WHOLE_BODY}", parts[i])
        return self._of_parts(bodies, parts)

    def _kinds(self, bodies):
        """Return the row of the table for each body."""
        people = len(self._model_of_person)
        kinds = numpy.minimum(len(self.parts) + bodies - people, len(self._table) - 1)
        is_person = bodies < people
        kinds[is_person] = self._model_of_person[bodies[is_person]]
        return kinds

    def _is_person(self, bodies):
        return self._is_person_of_kind[self._kinds(bodies.astype(numpy.int64))]

    def _of_parts(self, bodies, parts):
        return self._table[self._kinds(bodies.astype(numpy.int64)), parts]

    def bodies(self, bodies):
        """Return the names of N bodies (N, object): "walkers 12" for avatar 12 of the group walkers, or the obstacle's."""
        if self._body_names is None:
            groups = [self.groups[group] if group < len(self.groups) else "body" for group in self._group_of_person]
            names = [f"{group} {i}" for i, group in enumerate(groups)] + self.obstacles + [""]
            self._body_names = numpy.array(names, dtype=object)
        return self._body_names[numpy.minimum(integers("bodies", bodies), len(self._body_names) - 1)]

    def of_pairs(self, table):
        out = {}
        for side in "ab":
            if has_columns(table, f"body_{side}"):
                out[f"body_{side}_name"] = self.bodies(table[f"body_{side}"])
                out[f"body_{side}_is_person"] = self._is_person(table[f"body_{side}"])
            if has_columns(table, f"body_{side}", f"part_{side}"):
                out[f"part_{side}_name"] = self._of_parts(table[f"body_{side}"], table[f"part_{side}"])
        if has_columns(table, "level"):
            out["level_name"] = _LEVELS[table["level"]]
        return out

    def of_people(self, table):
        names = {"group": self.groups, "model": self.models}
        out = {
            f"{name}_name": numpy.array([*known, ""], dtype=object)[numpy.minimum(table[name], len(known))]
            for name, known in names.items()
            if has_columns(table, name)
        }
        if has_columns(table, "model"):
            out["is_person"] = self._is_person_of_kind[numpy.minimum(table["model"], len(self.models))]
        return out


class Run:
    """Results of a run, as arrays. Can be pickled with all its tables.

    Attributes:
        scene: name of the scene.
        seed: seed of all random numbers.
        run_id: hash of everything that determines the results, 16 hexadecimal digits.
        step_s: time from one frame to the next.
        hash: hash of all events, 16 hexadecimal digits, as printed by `throng run`; None for an incomplete log.
        people: Table, one row per avatar. Columns: id, group, model (index into names.groups, names.models), scale
            (1: size of the model), height_m.
        events: Table, one row per begin or end of a contact, sorted by frame and bodies. Columns: frame, body_a,
            body_b, part_a, part_b (255: the whole body), kind (0 begins, 1 ends), level. `level` is the last test
            passed: 0 spheres, 1 boxes, 2 part volumes, 3 triangles. body_a < body_b.
        contacts: Table, one row per contact, in order of begin. Columns: body_a, body_b, part_a, part_b, level, ended
            (0: lasted to the end of the run), begin_frame, end_frame, begin_s, end_s.
        trajectories: Table, one row per sampled frame and avatar in the scene. Columns: frame, time_s, id, x_m, y_m,
            z_m (root position), heading_rad (counter-clockwise from the x axis), speed_mps.
        proximity, closest_parts, contact_points: Table, one row per frame and pair of parts, with the options of these
            names; empty without them. Columns: see Frame.
        counters: Table, one row per frame. Columns: frame, time_s, touching, begins, ends, persisting, posed_bodies,
            frame_ms and cull_ms (wall times). Also updates, tests and passed of each culling stage: body_sphere,
            body_box, part_box, part_volume, triangles.
        summary: dict of totals.
        separation: dict of distances between robots and people, for a scene with the key `separation`; else None.
            Keys: robots, shortfalls, pairs, undetermined, beyond_margin and regions. `regions` maps a body region to
            a dict: shortfalls, shortfall_s, max_shortfall_m, min_distance_lo_m, min_distance_hi_m.
        notes: notes and warnings, one line each.
        names: lists .groups, .models, .obstacles, and .parts (one list per model); .part(bodies, parts) returns the
            names of parts.
        log: path of the written log, or None.
    """

    def __init__(self, facts, log=None, page=None, request=None):
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
        self.proximity = Table(facts["proximity"], self.names.of_pairs)
        self.closest_parts = Table(facts["closest_parts"], self.names.of_pairs)
        self.contact_points = Table(facts["contact_points"], self.names.of_pairs)
        self._find_contacts = facts["find_contacts"]
        self._contacts = None
        self._page = page
        self._request = request  # options of the compiled module that repeat the run

    @property
    def contacts(self):
        if self._contacts is None:
            self._contacts = Table(self._find_contacts(), self.names.of_pairs)
        return self._contacts

    def __getstate__(self):
        self.contacts  # computed now, because the function that finds them cannot be pickled
        return {**self.__dict__, "_find_contacts": None}

    def view(self):
        """Return the Page of this run. Raises ValueError without run(..., view=True) or a log."""
        from ._log import Page, view

        if self._page is not None:
            return Page(self._page)
        if self.log is not None:
            return view(self.log)
        raise ValueError("this run has no page; use run(..., view=True) or run(..., log=FILE)")

    def __repr__(self):
        return (
            f"<throng.Run {self.scene}: {len(self.people)} people, {len(self.counters)} frames, "
            f"{len(self.events)} events, hash {self.hash}>"
        )


def progress_of(progress):
    """Return a function of (done, total), or None; True stands for a progress bar on stderr."""
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
    proximity=None,
    closest_parts=None,
    contact_points=False,
    filter_groups=None,
    filter_parts=None,
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
    tracked_point=None,
    strict=False,
    sampling=None,
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
    """Run a scene, a recording or a log to its end and return all contacts.

    Options that `throng run` also has mean the same as there, and the hash is equal. Nothing is published over LCM, and
    only files named by an argument are written. Other Python threads run meanwhile. Ctrl-C ends the run after the
    current frame, completes the files and raises KeyboardInterrupt.

    Args:
        source: a Scene, a scene file, the name of a bundled scene (see scenes()), a recording, or a log.
        seconds: simulated time in seconds, above 0 [the scene's].
        avatars: total number of agents; scales all groups [the scene's].
        seed: seed of all random numbers, from 0 [the scene's].
        steering: steering model: "heuristic", "orca" or "collision_free_speed" [the scene's].
        part_volume: bounding volume of body parts: "ordop26", "obb", ..., or a dict by words of part names, {"hands":
            "sphere", "default": "ordop26"} [the scene's].
        exact: True decides contacts and distances by triangle tests; False by part volumes.
        proximity: margin in metres, 0 to 100. Lists pairs of parts within it, with distances, in Run.proximity,
            Frame.proximity and the log.
        closest_parts: margin in metres, 0 to 100. Lists the closest parts of each two avatars within it, in
            Run.closest_parts, Frame.closest_parts and the log.
        contact_points: True lists points and penetration depths in Run.contact_points, Frame.contact_points and the
            log; requires exact=True.
        filter_groups, filter_parts: pairs to report [all], as in "robots: people" and "hands: head".
        threads: number of threads, 1 to 256 [all cores].
        budget_ms, budget_tests: limit per frame for contact detection, in milliseconds or tests [none]. Remaining
            pairs are reported at the level they reached.
        strategy, simd, pair_search: strategy of the paper, SIMD instruction set, search for pairs of bodies
            ["pipeline", "best", "grid"]. `throng run --help` lists the values.
        fps: frames per second of a recording, as its file numbers them [the file's].
        unit, heading_unit: units of a recording: "m", "cm", ...; "rad" or "deg" [the file's].
        columns, separator: columns of a recorded table, as in "id=1,t=2,x=3,y=4", and the character between them.
        tracked_point: body point that a recording tracks: "head" or "centre" [by kind of file].
        strict: True treats anomalies in a recording as errors.
        sampling: frames of a recording: "smooth" (steps of at most 1/60 s) or "recorded" ["smooth"].
        trajectories: False leaves Run.trajectories empty.
        trajectory_fps: positions per second [10, or the rate of the recording].
        log: log to write [none].
        states_hz: states (poses of all avatars) per simulated second in the log [every frame].
        publish_part_poses: True adds the pose of every part to these states.
        html: 3-D web page to write [none].
        trajectory: file .sqlite or .csv to write, or a list of them [none].
        trajectory_area: piece of a walkable area in several pieces, for FILE.sqlite: "largest", or its rank by size,
            from 1.
        contacts: folder for contact statistics (CSV and figures) [none].
        separation: folder for distances and shortfalls between robots and people [none].
        trace_hash: file for one hash per stage and frame, to locate where two runs diverge [none].
        view: True keeps the 3-D page for Run.view().
        progress: True shows a bar on stderr; a function is called with (frames done, all frames).

    Returns:
        Run

    Raises:
        InputError: invalid file, option or array; .file and .line name the place in a file.
        EnvironmentFault: full disk, missing folder, missing program.
        KeyboardInterrupt: Ctrl-C.
    """
    given = {name: value for name, value in locals().items() if name not in ("source", "view", "progress")}
    page = None
    with tempfile.TemporaryDirectory() as folder:
        kept = html
        if view and kept is None:
            kept = given["html"] = os.path.join(folder, "page.html")
        request = options_of(source, given)
        with errors_of(source):
            facts = _core.run(request, progress_of(progress))
        if view:
            with open(kept, encoding="utf-8") as file:
                page = file.read()
    request = {name: value for name, value in request.items() if name not in _OUTPUTS}
    return Run(facts, log=log if log is None else os.fspath(log), page=page, request=request)


def scenes():
    """Return the bundled scenes: a dict from name to description. Each name is a source for run()."""
    return dict(_core.scenes())
