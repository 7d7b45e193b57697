"""Runs frame by frame."""

import inspect

import numpy

from . import _core
from ._distance import Distance, part_choice
from ._validation import abbreviated, input_error, integer, integers, numbers
from ._run import Names, options_of, run
from ._scene import errors_of, goal_text
from ._table import Table

_MAX_ID = 2**32 - 1

# Options of run() for what it keeps and shows.
_OF_RUNS = ("trajectories", "view", "progress")


def _ids(value, count):
    """Return one id, several, or those of a mask of `count` avatars as an array."""
    if isinstance(value, numpy.ndarray) and value.dtype == bool and value.shape == (count,):
        return numpy.flatnonzero(value)
    return integers("ids", [value] if hasattr(value, "__index__") and not hasattr(value, "__len__") else value)


def _rows(where, value, count, width):
    """Return `count` rows of numbers as one row; a single one for all, none for None."""
    if value is None:
        return numbers(where, ())
    array = numbers(where, value)
    if array.size == width and array.ndim == (width > 1):
        array = numpy.tile(array.reshape(-1), count)
    if array.size != count * width:
        expected = f"{count} numbers" if width == 1 else f"{count} rows of {width} numbers"
        raise input_error(where, expected, f"an array {array.shape}")
    return array.reshape(-1)


class Frame:
    """State and contacts of all N avatars in one frame, returned by Simulation.step().

    A frame is valid until the next step; after it, requesting an array raises RuntimeError. Arrays requested before
    keep their values. All arrays are read-only. Row i belongs to avatar i.

    Attributes:
        number: number of the frame, from 0.
        time_s: simulated time.
        hash: hash of all events so far, 16 hexadecimal digits.
        positions_m (N x 3, float64): root positions in the world frame. The root of a person is the point on the
            ground between the feet; that of a robot is its root link.
        rotations_xyzw (N x 4, float32): world_from_root, quaternions.
        headings_rad (N, float32): heading, counter-clockwise from the world's x axis.
        speeds_mps (N, float32): ground speed, 0 while absent.
        present (N, bool): False while an avatar is outside the scene; its position is then the last one.
        joint_positions (float32): joint values of all avatars in one array, rad or m. Simulation.joint_offsets states
            where those of each avatar begin.
        pairs (Table): pairs of parts that touch in this frame, sorted. Columns: body_a, body_b, part_a, part_b.
        events (Table): begin and end events of this frame. Columns: see Run.events.
        proximity (Table): with proximity=M, all pairs of parts of two bodies within M metres. Columns: frame, body_a,
            body_b, part_a, part_b, level (2 part volumes, 3 triangles), distance_lo_m and distance_hi_m (bounds of the
            distance). Known with exact=True, otherwise nan or 0: point_a_m and point_b_m (3, nearest points, world
            frame), normal (3, unit, from a to b), depth_m, closing_speed_mps, time_to_contact_s.
        closest_parts (Table): with closest_parts=M, the nearest parts of each two avatars within M metres. Columns as
            in proximity.
        contact_points (Table): with exact=True and contact_points=True, one row per row of pairs. Columns: frame,
            body_a, body_b, part_a, part_b, point_m (3, world frame, on both parts), normal (3, unit, direction of least
            penetration for b), depth_m (penetration depth of the convex hulls).

    A table that was not requested raises RuntimeError.
    """

    def __init__(self, frame, names):
        self._frame = frame
        self._names = names

    number = property(lambda self: self._frame.number)
    time_s = property(lambda self: self._frame.time_s)
    hash = property(lambda self: self._frame.hash)
    positions_m = property(lambda self: self._frame.positions_m)
    rotations_xyzw = property(lambda self: self._frame.rotations_xyzw)
    headings_rad = property(lambda self: self._frame.headings_rad)
    speeds_mps = property(lambda self: self._frame.speeds_mps)
    present = property(lambda self: self._frame.present)
    joint_positions = property(lambda self: self._frame.joint_positions)
    pairs = property(lambda self: Table(self._frame.pairs, self._names.of_pairs))
    events = property(lambda self: Table(self._frame.events, self._names.of_pairs))
    proximity = property(lambda self: Table(self._frame.proximity, self._names.of_pairs))
    closest_parts = property(lambda self: Table(self._frame.closest_parts, self._names.of_pairs))
    contact_points = property(lambda self: Table(self._frame.contact_points, self._names.of_pairs))

    def part_poses(self, people):
        """Return world_from_part of all P parts of K avatars: K x P x 4 x 4, float64.

        people: K avatar ids, all of one model. Point p of a part of an avatar of scale s (Run.people) lies at
        R (s p) + t in the world frame, for a matrix [R | t].
        """
        return self._frame.part_poses(integers("people", people if hasattr(people, "__array__") else list(people)))

    def distance(self, a, part_a, b, part_b):
        """Return the Distance of two bodies, or of parts of them, by triangles. It needs no margin and ignores filters.

        Raises InputError for bodies that are unknown or not in the scene, and for unknown parts. With
        joint_positions=False ask before set_pose(), which already changes joints.

        Args:
            a, b: ids of two avatars or obstacles.
            part_a, part_b: a part number, a name, or words of names; "hand" stands for the nearest part with this
                word. None or "": the nearest of all parts. An obstacle is a single part.
        """
        a, b = integer("a", a, 0, _MAX_ID), integer("b", b, 0, _MAX_ID)
        *values, depth_m = self._frame.distance(a, part_choice("part_a", part_a), b, part_choice("part_b", part_b))
        return Distance(*values, *self._names.part([a, b], values[-2:]), depth_m)

    def __repr__(self):
        return f"<throng.Frame {self.number}>"


class Simulation:
    """A scene, a recording or a log, frame by frame: ``for frame in Simulation("plaza", seed=3): ...``

    source and options are those of run(); files like log= begin with the first step and are complete after finish().
    Two options are added: culling=False moves avatars without finding contacts, and joint_positions=False omits joint
    positions and part poses.

    One thread at a time may step a simulation; other Python threads run meanwhile. Ctrl-C raises KeyboardInterrupt at
    once; a started step still completes.

    Attributes:
        scene, seed, run_id, step_s, people, names: see Run.
        frames: number of frames in the scene's duration; a loop over the simulation ends after them.
        next_frame: number of the frame that the next step returns.
        notes: notes and warnings, one line each.
        stranded: number of people who have no path to their goal now.
        hash: hash of all events so far, 16 hexadecimal digits.
        step_ms: wall time of the last step in the library, in milliseconds.
        joint_offsets (N + 1, int64): frame.joint_positions[joint_offsets[i]:joint_offsets[i + 1]] are the joint
            positions of avatar i, in the order of Model.joint_names.
    """

    def __init__(self, source, **options):
        for name in _OF_RUNS:
            if options.get(name) not in (None, False):
                raise input_error(name, "an option of frames or files; run() keeps and shows", abbreviated(options[name]))
        with errors_of(source):
            self._run = _core.Simulation(options_of(source, options))
        facts = self._run.facts
        self.names = Names(facts)
        #: Table, see Run.people
        self.people = Table(facts["people"], self.names.of_people)
        self.scene = facts["scene"]
        self.seed = facts["seed"]
        self.run_id = facts["run_id"]
        self.step_s = facts["step_s"]

    def step(self):
        """Advance one step and return its Frame. The first call returns frame 0, the initial state."""
        return Frame(self._run.step(), self.names)

    def finish(self):
        """End all current contacts and return these end events as a Table (see Run.events). No step may follow.

        Completes the files of log=, trajectory=, ...; a loop over the simulation and its deletion do so, too.
        """
        return Table(self._run.finish(), self.names.of_pairs)

    def save(self):
        """Return all state that later frames depend on, as the bytes of a `throng run` checkpoint."""
        return self._run.save()

    def resume(self, state):
        """Continue from save() of a simulation with the same source and options. Call it before the first step.

        Later frames, events and the hash equal those of the saved simulation bit for bit. Raises InputError if the
        state belongs to another run. Returns this simulation.
        """
        if not isinstance(state, (bytes, bytearray, memoryview)):
            raise input_error("state", "bytes returned by save()", abbreviated(state))
        self._run.resume(bytes(state))
        return self

    def __iter__(self):
        return self

    def __next__(self):
        if self._run.next_frame >= self._run.frames:
            if self._run.writes_files:
                self._run.finish()
            raise StopIteration
        return self.step()

    def set_pose(
        self, ids, positions_m, rotations_xyzw=None, joint_positions=None, velocities_mps=None, gait=True
    ):
        """Set the poses of externally controlled avatars in the next frame.

        With gait=True, people without joint positions walk to their places: their feet stay planted, and their trunks
        turn away from others. They stand in frames without a call. The path is known up to the present only, so that
        they turn and stop without anticipation. Other avatars take the pose as given and keep it until the next call.
        Values outside the ground or the limits of joints are clamped; returns their number. A jump has no speed. Raises
        InputError without effect for an avatar that is absent or whose group is not externally controlled.

        Args:
            ids: id of an avatar, K ids, or a mask of all avatars.
            positions_m: x, y, z of the roots in the world frame, 3 or K x 3; x, y suffice for people who walk.
            rotations_xyzw: world_from_root, quaternions of any length above 0, 4 or K x 4. None: people who walk face
                where they go, others along x.
            joint_positions: all joints of the avatars, one avatar after another, rad or m, in the order of
                Model.joint_names. None: unchanged.
            velocities_mps: x, y of the velocities that others see, 2 or K x 2. None: those of the path for people who
                walk, otherwise 0.
            gait: False: people also take the pose as given.
        """
        ids = _ids(ids, len(self.people))
        count = len(ids)
        positions = numbers("positions_m", positions_m, "numbers x, y, z")
        if positions.size not in (2 * count, 3 * count) or positions.ndim > 2:
            raise input_error("positions_m", f"x, y, z of {count} avatars", f"an array {positions.shape}")
        joints = numbers("joint_positions", () if joint_positions is None else joint_positions, "joint positions")
        return self._run.set_pose(
            ids,
            positions.reshape(-1),
            _rows("rotations_xyzw", rotations_xyzw, count, 4),
            joints.reshape(-1),
            _rows("velocities_mps", velocities_mps, count, 2),
            bool(gait),
        )

    def add(self, group, positions_m, headings_rad=None, speeds_mps=0.0):
        """Add people or robots to a group for the next frame, and return their ids.

        They are spare agents, which the scene key `spare` of the group reserves. Ids are never reused.

        Args:
            group: name of the group.
            positions_m: x, y of one agent, or K x 2.
            headings_rad: headings, counter-clockwise from the x axis, one or K. None: along their paths.
            speeds_mps: speeds along the heading at first, one or K.

        Returns:
            The id for one position, otherwise an array of K ids (int64).

        Raises InputError without effect if too few spare agents are left, for an unknown group, and for a position off
        the ground, within half a radius of a wall, or so near another agent that discs overlap by more than half.
        """
        positions = numbers("positions_m", positions_m, "numbers x, y")
        if positions.size == 0:
            return numpy.zeros(0, dtype=numpy.int64)
        if positions.shape[-1:] != (2,) or positions.ndim > 2:
            raise input_error("positions_m", "x, y of one agent, or one row per agent", f"an array {positions.shape}")
        count = positions.size // 2
        ids = self._run.add(
            str(group),
            positions.reshape(-1),
            _rows("headings_rad", headings_rad, count, 1),
            _rows("speeds_mps", speeds_mps, count, 1),
        )
        return int(ids[0]) if positions.ndim == 1 else ids

    def remove(self, ids):
        """Remove agents, one id, several or a mask of all avatars: their contacts end in the next frame.

        Raises InputError without effect for an agent that is not in the scene.
        """
        self._run.remove(_ids(ids, len(self.people)))

    def set_goal(self, ids, goal):
        """Send agents to a goal, at once: from now on it is the only goal of their route.

        There they do as the `on_arrival` of their group says. People choose between the doorways of goals of the scene
        and walk around crowds on the way to them; to other places they take the shortest path.

        Args:
            ids: one id, several, or a mask of all avatars.
            goal: Goal, Area, a shapely polygon, an array of corners, or a dictionary as in a scene file, without queue.
                Of a list, the nearest counts.

        Raises InputError without effect for an agent that is not in the scene, or a goal that is not on the ground.
        """
        self._run.set_goal(_ids(ids, len(self.people)), goal_text(goal))

    def set_desired_speed(self, ids, mps):
        """Set the speeds at which agents walk when nothing hinders them, 0.1 to 4 m/s; one for all or one each."""
        ids = _ids(ids, len(self.people))
        self._run.set_desired_speed(ids, _rows("mps", mps, len(ids), 1))

    frames = property(lambda self: self._run.frames)
    next_frame = property(lambda self: self._run.next_frame)
    notes = property(lambda self: self._run.notes)
    stranded = property(lambda self: self._run.stranded)
    step_ms = property(lambda self: self._run.step_ms)
    hash = property(lambda self: self._run.hash)
    joint_offsets = property(lambda self: self._run.joint_offsets)

    def __repr__(self):
        try:
            where = f"next frame {self.next_frame}"
        except RuntimeError:
            where = "stepping"
        return f"<throng.Simulation {self.scene}: {len(self.people)} people, {where}>"


def _signature():
    """Return the options of run() that shape frames, and those of a Simulation alone."""
    keyword = inspect.Parameter.KEYWORD_ONLY
    options = [
        each
        for each in inspect.signature(run).parameters.values()
        if each.kind == keyword and each.name not in _OF_RUNS
    ]
    names = [inspect.Parameter(name, inspect.Parameter.POSITIONAL_OR_KEYWORD) for name in ("self", "source")]
    own = [inspect.Parameter(name, keyword, default=None) for name in ("culling", "joint_positions")]
    return inspect.Signature(names + options + own)


Simulation.__init__.__signature__ = _signature()
