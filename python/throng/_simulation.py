"""A run step by step."""

from . import _core
from ._validation import abbreviated, input_error, integer, integers, numbers
from ._run import Names, options_of
from ._table import Table

# What run() takes for what it writes.
_OF_RUNS = ("log", "states_hz", "publish_part_poses", "html", "trajectory", "trajectory_fps", "contacts", "separation",
            "trace_hash")


class Frame:
    """One frame of a simulation, for as long as it is the latest.

    Each array shows this frame for as long as somebody holds it, also when the simulation has gone on or is
    gone; it cannot be written to. Asking a frame that is over for another array raises RuntimeError.

    Attributes:
        number, time_s, hash (of all events so far).
        positions_m (N x 3, float64): roots of bodies; people's lie on the ground between the feet.
        rotations_xyzw (N x 4, float32): world_from_root. headings_rad, speeds_mps (N, float32).
        present (N, bool): False where somebody is not in the scene now; places are then the last ones.
        postures (float32): joint values of everybody, one after another, see Simulation.posture_offsets.
        pairs (Table): a, b, part_a, part_b of all that touches now, sorted.
        events (Table): what began and ended in this frame, see Run.events.
        near (Table): of a simulation with near=M, each pair of parts within M metres: a, b, part_a, part_b, level
            (2 volumes, 3 triangles), lo_m and hi_m, which hold their distance; with exact=True the nearest points
            a_m and b_m (3, world), normal (3, from a to b), depth_m, closing_speed_mps, time_to_contact_s; nan otherwise.
        closest_parts (Table): of a simulation with person_near=M, of each two people within M the nearest parts.
        contact_points (Table): of a simulation with exact=True, contact_points=True, a row for each of pairs:
            a, b, part_a, part_b, point_m (3, world; both parts have it), direction (3, unit; along which b is out
            of a soonest) and depth_m, how far that is.
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
    postures = property(lambda self: self._frame.postures)
    pairs = property(lambda self: Table(self._frame.pairs, self._names.of_pairs))
    events = property(lambda self: Table(self._frame.events, self._names.of_pairs))
    near = property(lambda self: Table(self._frame.near, self._names.of_pairs))
    closest_parts = property(lambda self: Table(self._frame.closest_parts, self._names.of_pairs))
    contact_points = property(lambda self: Table(self._frame.contact_points, self._names.of_pairs))

    def part_poses(self, people):
        """world_from_part of some people of one model (K ids): K x P x 4 x 4, float64.

        A point p of a part of somebody of scale s lies at R (s p) + t.
        """
        return self._frame.part_poses(integers("people", people if hasattr(people, "__array__") else list(people)))

    def __repr__(self):
        return f"<throng.Frame {self.number}>"


class Simulation:
    """A scene, a recording or a log, frame by frame: ``for frame in Simulation("plaza", seed=3): ...``

    Takes what run() takes, as far as it shapes frames; culling=False lets people walk and culls nobody,
    postures=False saves joint angles that nobody asks for. One thread at a time may step it; Python runs on
    meanwhile. Ctrl-C raises KeyboardInterrupt at once; a step that was begun ends by itself, and the next follows it.
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
        """The next Frame; the first call gives frame 0, where people start."""
        return Frame(self._run.step(), self.names)

    def finish(self):
        """Ends all that still touches; returns these ends (Table). No step follows."""
        return Table(self._run.finish(), self.names.of_pairs)

    def save(self):
        """All that later frames depend on, as bytes: what a checkpoint file of `throng run` holds."""
        return self._run.save()

    def resume(self, state):
        """Goes on where save() was called in a simulation of the same source and options, before the first step.

        Later frames, their events and the hash are the same to the bit. A state of another run is an InputError.
        """
        if not isinstance(state, (bytes, bytearray, memoryview)):
            raise input_error("state", "the bytes that save() gave", abbreviated(state))
        self._run.resume(bytes(state))

    def __iter__(self):
        return self

    def __next__(self):
        if self._run.next_frame >= self._run.frames:
            raise StopIteration
        return self.step()

    def drive(self, avatar, position_m, rotation_xyzw=(0, 0, 0, 1), joints=(), velocity_mps=(0, 0)):
        """Moves an avatar of a driven group from the next step on (joints: rad or m, none: as they are).

        Returns how many numbers were brought within what the scene and the joints allow.
        """
        return self._run.drive(
            integer("avatar", avatar, 0, len(self.people) - 1),
            numbers("position_m", position_m, "3 numbers x, y, z", (3,)),
            numbers("rotation_xyzw", rotation_xyzw, "a quaternion of 4 numbers x, y, z, w", (4,)),
            numbers("joints", joints, "the joints in one row", (None,)),
            numbers("velocity_mps", velocity_mps, "2 numbers x, y", (2,)),
        )

    #: how many frames the scene's duration has
    frames = property(lambda self: self._run.frames)
    next_frame = property(lambda self: self._run.next_frame)
    notes = property(lambda self: self._run.notes)
    #: how long the library itself took for the last step
    step_ms = property(lambda self: self._run.step_ms)
    #: of all events so far
    hash = property(lambda self: self._run.hash)
    #: (N + 1): postures[offsets[i]:offsets[i + 1]] are the joints of avatar i
    posture_offsets = property(lambda self: self._run.posture_offsets)

    def __repr__(self):
        try:
            where = f"next frame {self.next_frame}"
        except RuntimeError:
            where = "stepping"
        return f"<throng.Simulation {self.scene}: {len(self.people)} people, {where}>"
