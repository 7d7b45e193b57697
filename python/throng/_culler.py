"""Contacts of custom bodies in custom poses."""

import os
import warnings

import numpy

from . import _core
from ._errors import InputError
from ._distance import Distance, part_choice
from ._validation import abbreviated, input_error, integer, integers, numbers, path_of
from ._model import Model
from ._table import Table, has_columns


_MAX_ID = 2**24 - 1


class Body:
    """A kind of body: rigid parts, each a mesh in its own part frame.

    Args:
        parts: 1 to 255 entries. Each is a mesh file (.tri, .ply, .stl, ...), a tuple (vertices V x 3, triangles
            T x 3), or vertices alone. Vertices alone stand for their convex hull and exclude exact=True. Coordinates
            are in metres, at most 1e6; triangles are indices of vertices.
        names: names of the parts ["part 0", "part 1", ...].
        static: True for a body that never moves; static bodies are not tested against each other.

    Attributes:
        part_count, part_names: number and names of the parts.
    """

    def __init__(self, parts, names=None, static=False):
        if isinstance(parts, (str, bytes, os.PathLike)) or not hasattr(parts, "__iter__"):
            raise input_error("parts", "a list of parts", abbreviated(parts))
        meshes = [_mesh(f"parts[{i}]", part) for i, part in enumerate(parts)]
        names = [f"part {i}" for i in range(len(meshes))] if names is None else list(names)
        if len(names) != len(meshes) or not all(isinstance(name, str) for name in names):
            raise input_error("names", f"one name per part, {len(meshes)}", abbreviated(names))
        self._made_of = (meshes, names, bool(static))
        self._body = _core.body_of_parts(*self._made_of)

    def __reduce__(self):
        return Body, self._made_of

    part_names = property(lambda self: self._body.part_names)
    part_count = property(lambda self: self._body.part_count)


def _mesh(where, part):
    """Return vertices and triangles, or None instead of triangles."""
    if isinstance(part, (str, bytes, os.PathLike)):
        vertices, triangles, notes = _core.read_mesh(path_of(where, part))
        for note in notes:
            warnings.warn(note, stacklevel=4)
        return vertices, triangles if len(triangles) else None
    vertices, triangles = part if isinstance(part, tuple) and len(part) == 2 else (part, None)
    points = numbers(where, vertices, "N x 3 coordinates in metres, N at least 1", (None, 3))
    if triangles is None:
        return points, None
    corners = numbers(where, triangles, "M x 3 indices of points", (None, 3) if numpy.size(triangles) else None)
    return points, integers(where, corners.reshape(-1), "indices of points").reshape(-1, 3)


class _BodyNames:
    """Maps body and part numbers in the tables of a culler to names."""

    def __init__(self, part_names):
        self.part_names = part_names
        self.type_of_id = {}

    def __call__(self, table):
        return {
            f"part_{side}_name": numpy.array(
                [self._name(*pair) for pair in zip(table[f"body_{side}"].tolist(), table[f"part_{side}"].tolist())], dtype=object
            )
            for side in "ab"
            if has_columns(table, f"body_{side}", f"part_{side}")
        }

    def _name(self, body, part):
        names = self.part_names[self.type_of_id.get(body, 0)]
        return names[part] if part < len(names) else "whole body"


class Culler:
    """Finds contacts between parts of different bodies, step after step. Parts of one body are not tested.

    A pair whose triangles intersect is always reported, in any pose. One thread at a time may use a culler.

    Args:
        bodies: the kinds of bodies: a Model or Body, or a list of them.
        exact: True decides contacts by triangles; False by part volumes, which also reports pairs that nearly touch.
        part_volume: bounding volume of the parts: "sphere", "aabb", "obb", "kdop14", "kdop18", "kdop26", "ordop14",
            "ordop18" or "ordop26". A map by words of part names is also possible: "hand: obb, default: sphere".
        pair_search: search for pairs of bodies: "grid", "sweep" or "brute"; it changes no result.
        threads: number of threads, 1 to 256 [all cores].
        step_s: duration of a step in seconds, for begin_s and end_s of contacts and for closing speeds.
        proximity: margin in metres, 0 to 100; 0: off. The table `proximity` lists pairs of parts within it.
        closest_parts: margin in metres, 0 to 100; 0: off. The table `closest_parts` lists the nearest parts of each
            two moving bodies within it.
        contact_points: True fills the table `contact_points`; requires exact=True.

    Attributes:
        pairs: Table, pairs of parts that touch after the last step. Columns: body_a, body_b, part_a, part_b.
        events: Table, events of all steps so far. Columns: see Run.events.
        contacts: Table, contacts of all steps so far. Columns: see Run.contacts; end_s is nan while a contact lasts.
        proximity, closest_parts: Tables of distances after the last step. Columns: see Frame.proximity.
        contact_points: Table, points of the touching pairs after the last step. Columns: see Frame.contact_points.
        frame: number of steps so far.
        hash: hash of all events so far, 16 hexadecimal digits.
        step_s: as given.

    A table that was not requested (proximity, closest_parts, contact_points) raises RuntimeError.
    """

    def __init__(self, bodies, exact=False, part_volume="ordop26", pair_search="grid", threads=None, step_s=1.0,
                 proximity=0.0, closest_parts=0.0, contact_points=False):
        kinds = list(bodies) if isinstance(bodies, (list, tuple)) else [bodies]
        made = [_body_of(kind) for kind in kinds]
        closest_parts = numbers("closest_parts", closest_parts, "a number of metres", ()).item()
        step_s = numbers("step_s", step_s, "a number of seconds above 0", ()).item()
        options = {"part_volume": part_volume, "exact": exact, "pair_search": pair_search, "threads": threads,
                   "proximity": proximity, "closest_parts": closest_parts, "contact_points": contact_points,
                   "step_s": step_s}
        self._culler = _core.Culler(made, options)
        # Requested tables, by the option that requests them.
        self._requested = {"proximity=M": proximity, "closest_parts=M": closest_parts,
                           "contact_points=True": contact_points}
        self.step_s = step_s
        self._names = _BodyNames([body.part_names for body in made])

    def step(self, poses, types=None, ids=None, scales=None):
        """Find the contacts of N bodies in new poses; return the begin and end events as a Table (see Run.events).

        Args:
            poses: N x P x 4 x 4 (or 3 x 4) matrices [R | t], world_from_part. For bodies with different numbers of
                parts: a list of N arrays P x 4 x 4. R is a rotation without scale; t is in metres, at most 1e9 per
                axis.
            types: N indices into `bodies` [0].
            ids: N strictly ascending body numbers, 0 to 16777215 [0, 1, ...]. The contacts of a body that is missing
                in a step end.
            scales: N sizes of the bodies, as factors from 1e-6 to 1e6 [1].
        """
        if isinstance(poses, (list, tuple)):
            bodies = [_matrices(f"poses[{i}]", body) for i, body in enumerate(poses)]
            count = len(bodies)
            if len({body.shape[1] for body in bodies}) > 1:  # both 3 x 4 and 4 x 4
                bodies = [body[:, :3] for body in bodies]
            matrices = numpy.concatenate(bodies) if count else numpy.zeros((0, 4, 4))
        else:
            matrices = _matrices("poses", poses)
            count = len(poses)
        ids = numpy.arange(count) if ids is None else integers("ids", ids)
        types = numpy.zeros(count, dtype=int) if types is None else integers("types", types)
        scales = numpy.ones(count) if scales is None else numbers("scales", scales, "one number per body", (None,))
        if not len(ids) == len(types) == len(scales) == count:
            raise input_error("ids, types, scales", f"one of each per body, {count}",
                          f"{len(ids)}, {len(types)} and {len(scales)}")
        try:
            events = self._culler.step(matrices, ids, types, scales)
        except InputError:
            raise  # the culler is unchanged
        except KeyboardInterrupt:
            self._remember(ids, types)  # the step completes in its thread
            raise
        self._remember(ids, types)
        return Table(events, self._names)

    def _remember(self, ids, types):
        if len(self._names.part_names) > 1:
            self._names.type_of_id.update(zip(ids.tolist(), types.tolist()))

    def _requested_table(self, option, rows):
        """Return a requested table; an empty one would mean that no pair was found."""
        if not self._requested[option]:
            raise RuntimeError(f"this culler was made without {option}: there is no table")
        return Table(rows(), self._names)

    def finish(self):
        """End all current contacts and return these end events as a Table (see Run.events)."""
        return Table(self._culler.finish(), self._names)

    def distance(self, a, part_a, b, part_b):
        """Return the Distance of two bodies of the last step, or of parts of them. It needs no margin.

        Raises InputError for bodies that the last step did not have, and for unknown parts.

        Args:
            a, b: ids of two bodies.
            part_a, part_b: a part number, a name, or words of names; "hand" stands for the nearest part with this
                word. None or "": the nearest of all parts.
        """
        a, b = integer("a", a, 0, _MAX_ID), integer("b", b, 0, _MAX_ID)
        *values, depth_m = self._culler.distance(a, part_choice("part_a", part_a), b, part_choice("part_b", part_b))
        names = [self._names._name(body, part) for body, part in zip((a, b), values[-2:])]
        return Distance(*values, *names, depth_m)

    pairs = property(lambda self: Table(self._culler.pairs(), self._names))
    proximity = property(lambda self: self._requested_table("proximity=M", self._culler.proximity))
    closest_parts = property(lambda self: self._requested_table("closest_parts=M", self._culler.closest_parts))
    contact_points = property(lambda self: self._requested_table("contact_points=True", self._culler.contact_points))
    events = property(lambda self: Table(self._culler.events(), self._names))
    contacts = property(lambda self: Table(self._culler.contacts(self.step_s), self._names))
    frame = property(lambda self: self._culler.frame)
    hash = property(lambda self: self._culler.hash)


def _body_of(kind):
    if isinstance(kind, Model):
        return _core.body_of_model(kind._model)
    if isinstance(kind, Body):
        return kind._body
    raise input_error("bodies", "a Model, a Body or a list of them; Model(FILE) reads a URDF", abbreviated(kind))


def _matrices(where, poses):
    matrices = numbers(where, poses, "matrices of 3 or 4 rows and 4 columns")
    if matrices.ndim < 3 or matrices.shape[-1] != 4 or matrices.shape[-2] not in (3, 4):
        raise input_error(where, "matrices of 3 or 4 rows and 4 columns", f"an array {matrices.shape}")
    return matrices.reshape((-1, *matrices.shape[-2:]))
