"""Body models of robots and people: parts, joints, kinematics."""

import os

from . import _core
from ._validation import integer, numbers, path_of


class Model:
    """A body model: a URDF and its meshes. "adult" is the bundled person.

    Attributes:
        name, height_m, is_person.
        reach_m: distance from the root to the farthest point, over all postures.
        joint_names (J), joint_lower and joint_upper (J, rad or m): the independently moving joints.
        part_names (P): links with geometry.
        notes: how incomplete entries of the URDF are interpreted, one line each.
    """

    def __init__(self, urdf):
        self._urdf = path_of("urdf", urdf, "a URDF file, or 'adult'")
        self._model = _core.Model(self._urdf)

    def __reduce__(self):
        return Model, (self._urdf if self._urdf == "adult" else os.path.abspath(self._urdf),)

    name = property(lambda self: self._model.name)
    height_m = property(lambda self: self._model.height_m)
    reach_m = property(lambda self: self._model.reach_m)
    is_person = property(lambda self: self._model.is_person)
    joint_names = property(lambda self: self._model.joint_names)
    joint_lower = property(lambda self: self._model.joint_lower)
    joint_upper = property(lambda self: self._model.joint_upper)
    part_names = property(lambda self: self._model.part_names)
    notes = property(lambda self: self._model.notes)
    joint_count = property(lambda self: len(self._model.joint_names))
    part_count = property(lambda self: len(self._model.part_names))

    def poses(self, joint_positions, positions_m=None, rotations_xyzw=None, scales=None):
        """Return world_from_part of many postures at once.

        Args:
            joint_positions: N x J, or J for a single posture; radians, or metres of the unscaled model.
            positions_m: N x 3 positions of the roots [0].
            rotations_xyzw: N x 4 rotations of the roots [world axes].
            scales: N sizes of the bodies [1].

        Returns:
            N x P x 4 x 4 matrices, float64. A point p of a part lies at R (scale p) + t.
        """
        given = {"positions_m": positions_m, "rotations_xyzw": rotations_xyzw, "scales": scales}
        rows = {name: None if value is None else numbers(name, value) for name, value in given.items()}
        return self._model.poses(numbers("joint_positions", joint_positions), **rows)

    def vertices_m(self, part):
        """Return the vertices of part number `part` in its own frame: V x 3, float32."""
        return self._model.vertices_m(self._part(part))

    def triangles(self, part):
        """Return indices into vertices_m(part): T x 3, int32, counter-clockwise from outside; empty for a point cloud."""
        return self._model.triangles(self._part(part))

    def _part(self, part):
        return integer("part", part, 0, self.part_count - 1)

    def __repr__(self):
        return f"<throng.Model {self.name}: {self.part_count} parts, {self.joint_count} joints>"
