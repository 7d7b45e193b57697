"""Runs frame by frame."""

from . import _core
from ._validation import abbreviated, input_error, integer, integers, numbers
from ._run import Names, options_of
from ._table import Table

# Options of run() that write files.
_OF_RUNS = ("log", "states_hz", "publish_part_poses", "html", "trajectory", "trajectory_fps", "contacts", "separation",
            "trace_hash")


class Frame:
    """One frame of a simulation, valid while it is the latest.

    Arrays are read-only. Each keeps its values while a variable holds it, also after later steps. Requesting another
    array of an earlier frame raises RuntimeError.

    Attributes:
        number, time_s, hash (of all events so far).
        positions_m (N x 3, float64): roots of the bodies; those of people lie on the ground between the feet.
        rotations_xyzw (N x 4, float32): world_from_root.
        headings_rad, speeds_mps (N, float32).
        present (N, bool): False for a person outside the scene, whose position is the last one.
        joint_positions (float32): rad or m, one avatar after another, see Simulation.joint_offsets.
        pairs (Table): body_a, body_b, part_a, part_b of each pair that touches in this frame, sorted.
        events (Table): begin and end events of this frame, see Run.events.
        proximity (Table): with proximity=M, each pair of parts within M metres: body_a, body_b, part_a, part_b, level
            (2 volumes, 3 triangles), distance_lo_m and distance_hi_m (bounds of the distance). With exact=True also
            the nearest points point_a_m and point_b_m (3, world), normal (3, from a to b), depth_m,
            closing_speed_mps, time_to_contact_s; otherwise these are nan.
        closest_parts (Table): with closest_parts=M, the nearest parts of each two people within M metres.
        contact_points (Table): with exact=True, contact_points=True, one row per row of pairs: body_a, body_b,
            part_a, part_b, point_m (3, world; shared by both parts), normal (3, unit; direction of least
            penetration), depth_m (penetration depth).
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
        """Return world_from_part of people of one model (K ids): K x P x 4 x 4, float64.

        A point p of a part of a person of scale s lies at R (s p) + t.
        """
        return self._frame.part_poses(integers("people", people if hasattr(people, "__array__") else list(people)))

    def __repr__(self):
        return f"<throng.Frame {self.number}>"


class Simulation:
    """A scene, a recording or a log, frame by frame: ``for frame in Simulation("plaza", seed=3): ...``

    Takes the options of run() that shape frames. culling=False moves people without culling them;
    joint_positions=False saves the joint positions if they are not needed. One thread at a time may step it; other
    Python threads run meanwhile. Ctrl-C raises KeyboardInterrupt at once; a started step completes by itself, and
    the next one follows it.
    """

    def __init__(self, source, **options):
        for name in _OF_RUNS:
            if options.get(name) not in (None, False):
                raise input_error(name, "an option that shapes frames; run() writes and keeps", abbreviated(options[name]))
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
        """Advance one frame and return it. The first call returns frame 0, where people start."""
        return Frame(self._run.step(), self.names)

    def finish(self):
        """End all contacts that still exist and return these events as a Table. No step may follow."""
        return Table(self._run.finish(), self.names.of_pairs)

    def save(self):
        """Return all state that later frames depend on, as the bytes of a `throng run` checkpoint."""
        return self._run.save()

    def resume(self, state):
        """Continue from save() of a simulation of the same source and options; call it before the first step.

        Later frames, their events and the hash are equal bit for bit. A state of another run is an InputError.
        """
        if not isinstance(state, (bytes, bytearray, memoryview)):
            raise input_error("state", "bytes returned by save()", abbreviated(state))
        self._run.resume(bytes(state))

    def __iter__(self):
        return self

    def __next__(self):
        if self._run.next_frame >= self._run.frames:
            raise StopIteration
        return self.step()

    def set_pose(self, avatar, position_m, rotation_xyzw=(0, 0, 0, 1), joint_positions=(), velocity_mps=(0, 0)):
        """Set the pose of an externally controlled avatar from the next step on.

        joint_positions are in rad or m; if empty, the joints keep their positions. Values outside the ground or the
        limits are clamped. Returns the number of clamped values.
        """
        return self._run.set_pose(
            integer("avatar", avatar, 0, len(self.people) - 1),
            numbers("position_m", position_m, "3 numbers x, y, z", (3,)),
            numbers("rotation_xyzw", rotation_xyzw, "a quaternion of 4 numbers x, y, z, w", (4,)),
            numbers("joint_positions", joint_positions, "the joint positions in one row", (None,)),
            numbers("velocity_mps", velocity_mps, "2 numbers x, y", (2,)),
        )

    #: number of frames in the scene's duration
    frames = property(lambda self: self._run.frames)
    next_frame = property(lambda self: self._run.next_frame)
    notes = property(lambda self: self._run.notes)
    #: wall time of the last step in the library, in ms
    step_ms = property(lambda self: self._run.step_ms)
    #: hash of all events so far
    hash = property(lambda self: self._run.hash)
    #: (N + 1): joint_positions[offsets[i]:offsets[i + 1]] are the joints of avatar i
    joint_offsets = property(lambda self: self._run.joint_offsets)

    def __repr__(self):
        try:
            where = f"next frame {self.next_frame}"
        except RuntimeError:
            where = "stepping"
        return f"<throng.Simulation {self.scene}: {len(self.people)} people, {where}>"
