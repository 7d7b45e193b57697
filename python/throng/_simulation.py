"""Runs frame by frame."""

import inspect

from . import _core
from ._distance import Distance, part_choice
from ._validation import abbreviated, input_error, integer, integers, numbers
from ._run import Names, options_of, run
from ._scene import errors_of
from ._table import Table

_MAX_ID = 2**32 - 1

# Options of run() that write files.
_OF_RUNS = ("log", "states_hz", "publish_part_poses", "html", "trajectory", "trajectory_fps", "contacts", "separation",
            "trace_hash")


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
        speeds_mps (N, float32): ground speed.
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

        Raises InputError for bodies that are unknown or not in the scene, and for unknown parts.

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

    source and options are those of run(), without the options that write files. Two options are added: culling=False
    moves avatars without finding contacts, and joint_positions=False omits joint positions and part poses.

    One thread at a time may step a simulation; other Python threads run meanwhile. Ctrl-C raises KeyboardInterrupt at
    once; a started step still completes.

    Attributes:
        scene, seed, run_id, step_s, people, names: see Run.
        frames: number of frames in the scene's duration; a loop over the simulation ends after them.
        next_frame: number of the frame that the next step returns.
        notes: notes and warnings, one line each.
        hash: hash of all events so far, 16 hexadecimal digits.
        step_ms: wall time of the last step in the library, in milliseconds.
        joint_offsets (N + 1, int64): frame.joint_positions[joint_offsets[i]:joint_offsets[i + 1]] are the joint
            positions of avatar i, in the order of Model.joint_names.
    """

    def __init__(self, source, **options):
        for name in _OF_RUNS:
            if options.get(name) not in (None, False):
                raise input_error(name, "an option that shapes frames; run() writes and keeps", abbreviated(options[name]))
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
        """End all current contacts and return these end events as a Table (see Run.events). No step may follow."""
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
            raise StopIteration
        return self.step()

    def set_pose(self, avatar, position_m, rotation_xyzw=(0, 0, 0, 1), joint_positions=(), velocity_mps=(0, 0)):
        """Set the pose of an externally controlled avatar from the next step on.

        Positions outside the ground and joint positions outside their limits are clamped. Returns the number of
        clamped values. Raises InputError for an avatar whose group has no `control_channel`.

        Args:
            avatar: id of the avatar.
            position_m: x, y, z of its root in the world frame.
            rotation_xyzw: world_from_root, a quaternion of any length above 0.
            joint_positions: one value per joint, rad or m, in the order of Model.joint_names; empty: unchanged.
            velocity_mps: x, y of its velocity in the world frame, which agents use to avoid it.
        """
        return self._run.set_pose(
            integer("avatar", avatar, 0, len(self.people) - 1),
            numbers("position_m", position_m, "3 numbers x, y, z", (3,)),
            numbers("rotation_xyzw", rotation_xyzw, "a quaternion of 4 numbers x, y, z, w", (4,)),
            numbers("joint_positions", joint_positions, "the joint positions in one row", (None,)),
            numbers("velocity_mps", velocity_mps, "2 numbers x, y", (2,)),
        )

    frames = property(lambda self: self._run.frames)
    next_frame = property(lambda self: self._run.next_frame)
    notes = property(lambda self: self._run.notes)
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
        if each.kind == keyword and each.name not in (*_OF_RUNS, "trajectories", "trajectory_area", "view", "progress")
    ]
    names = [inspect.Parameter(name, inspect.Parameter.POSITIONAL_OR_KEYWORD) for name in ("self", "source")]
    own = [inspect.Parameter(name, keyword, default=None) for name in ("culling", "joint_positions")]
    return inspect.Signature(names + options + own)


Simulation.__init__.__signature__ = _signature()
