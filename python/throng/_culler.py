"""Own bodies and own poses, without any scene."""

import os

import numpy

from . import _core
from ._model import Model
from ._table import Table


class Body:
    """A kind of body: rigid parts, each a mesh in its own frame.

    Args:
        parts: one a part: a mesh file (.tri, .ply, .stl, ...), a pair (vertices V x 3 in metres, triangles
            T x 3), or vertices alone, whose hull counts. At most 255.
        names: of the parts.
        static: True for what never moves; two such bodies are never tested against each other.
    """

    def __init__(self, parts, names=None, static=False):
        meshes = [_mesh(part) for part in parts]
        names = [f"part {i}" for i in range(len(meshes))] if names is None else list(names)
        if len(names) != len(meshes):
            raise ValueError(f"names: expected one a part, {len(meshes)}, found {len(names)}")
        self._body = _core.body_of_parts(meshes, names, static)

    part_names = property(lambda self: self._body.part_names)
    part_count = property(lambda self: self._body.part_count)


def _mesh(part):
    if isinstance(part, (str, os.PathLike)):
        vertices, triangles = _core.read_mesh(os.fspath(part))
        return vertices, triangles if len(triangles) else None
    if isinstance(part, tuple) and len(part) == 2:
        return part
    return part, None


class Culler:
    """Finds which part of which body overlaps which part of which other body, step after step.

    Args:
        bodies: a Model or Body, or a list of them: the kinds of bodies.
        exact: triangles decide; otherwise a part is its volume, and pairs that nearly touch are reported, too.
        part_volume: "ordop26", "obb", "aabb", ... pair_search: "grid", "sweep" or "brute". threads: [all].
        step_s: from step to step, for begin_s and end_s of contacts, and for closing speeds.
        near: every pair of parts of two bodies within so many metres is listed in `near`. body_near: of each two
            bodies within so many metres the nearest parts, in `near_bodies`.
        contact_points: where parts touch and how deep, in `contact_points`; needs exact=True.

    A pair whose triangles intersect is always reported, however bodies are posed.
    """

    def __init__(self, bodies, exact=False, part_volume="ordop26", pair_search="grid", threads=None, step_s=1.0,
                 near=0.0, body_near=0.0, contact_points=False):
        kinds = list(bodies) if isinstance(bodies, (list, tuple)) else [bodies]
        made = [_core.body_of_model(k._model) if isinstance(k, Model) else k._body for k in kinds]
        self.step_s = step_s
        self._part_names = [body.part_names for body in made]
        self._counts = numpy.array([body.part_count for body in made])
        self._culler = _core.Culler(made, part_volume, exact, pair_search, threads, near, body_near,
                                    contact_points, step_s)
        self._type_of_id = {}

    def step(self, poses, types=None, ids=None, scales=None):
        """Takes where everybody is now; returns what begins and ceases to touch (Table, see Run.events).

        Args:
            poses: N x P x 4 x 4 (or 3 x 4), world_from_part; of bodies with different numbers of parts a list
                of N arrays P x 4 x 4. Rotations without scale.
            types: N, index into the kinds of bodies [0]. ids: N ascending numbers [0, 1, ...]; a body that is
                not there any more touches nothing. scales: N, how large bodies are [1].
        """
        if isinstance(poses, (list, tuple)):
            count = len(poses)
            matrices = numpy.concatenate([_matrices(body) for body in poses]) if count else numpy.zeros((0, 4, 4))
        else:
            poses = numpy.asarray(poses)
            count = len(poses)
            matrices = _matrices(poses)
        ids = numpy.arange(count) if ids is None else numpy.asarray(ids)
        types = numpy.zeros(count, dtype=int) if types is None else numpy.asarray(types)
        scales = numpy.ones(count) if scales is None else numpy.asarray(scales)
        events = self._culler.step(matrices, ids, types, scales)
        if len(self._part_names) > 1:
            self._type_of_id.update(zip(ids.tolist(), types.tolist()))
        return Table(events, self._names)

    def finish(self):
        """Ends all that still touches; returns these ends."""
        return Table(self._culler.finish(), self._names)

    #: Table: a, b, part_a, part_b of all that touches after the last step
    pairs = property(lambda self: Table(self._culler.pairs(), self._names))
    #: Table: how near parts are after the last step, see Frame.near
    near = property(lambda self: Table(self._culler.near(), self._names))
    #: Table: of each two bodies the nearest parts, see Frame.near
    near_bodies = property(lambda self: Table(self._culler.near_bodies(), self._names))
    #: Table: where parts touch after the last step, see Frame.contact_points
    contact_points = property(lambda self: Table(self._culler.contact_points(), self._names))
    #: Table: of all steps so far, see Run.events
    events = property(lambda self: Table(self._culler.events(), self._names))
    #: Table: of all steps so far, see Run.contacts; end_s is nan while it lasts
    contacts = property(lambda self: Table(self._culler.contacts(self.step_s), self._names))
    frame = property(lambda self: self._culler.frame)
    hash = property(lambda self: self._culler.hash)

    def _names(self, table):
        def name(body, part):
            names = self._part_names[self._type_of_id.get(body, 0)]
            return names[part] if part < len(names) else "whole body"

        return {
            f"part_{side}_name": numpy.array(
                [name(*pair) for pair in zip(table[side].tolist(), table[f"part_{side}"].tolist())], dtype=object
            )
            for side in "ab"
        }


def _matrices(poses):
    poses = numpy.asarray(poses, dtype=float)
    if poses.ndim < 3 or poses.shape[-1] != 4 or poses.shape[-2] not in (3, 4):
        raise ValueError(f"poses: expected matrices of 3 or 4 rows and 4 columns, found an array {poses.shape}")
    return poses.reshape((-1, *poses.shape[-2:]))
