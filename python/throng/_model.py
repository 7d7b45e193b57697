"""Body models of robots and people: parts, joints, kinematics."""

import os

from . import _core
from ._validation import integer, numbers, path_of


class Model:
    """A body model with J joints and P parts: a URDF and its meshes, at scale 1.

    Args:
        urdf: path of a URDF file, or "adult" for the bundled person.

    Attributes:
        name: name of the model.
        height_m: height of the body.
        is_person: True if the model has the joints of human legs, and so walks with the gait.
        reach_m: distance from the root to the farthest point, over all postures.
        joint_count, joint_names: J and the names of the independently moving joints.
        joint_lower, joint_upper (J, float64): limits of the joints, rad or m.
        part_count, part_names: P and the names of the links with geometry.
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
        """Return world_from_part of all parts in N postures.

        Args:
            joint_positions: N x J, or J for a single posture; rad, or m of the unscaled model.
            positions_m: N x 3 root positions in the world frame [0].
            rotations_xyzw: N x 4 quaternions world_from_root [identity].
            scales: N sizes of the body, as factors [1].

        Returns:
            N x P x 4 x 4 matrices [R | t], float64. Point p of a part lies at R (scale p) + t in the world frame.
        """
        given = {"positions_m": positions_m, "rotations_xyzw": rotations_xyzw, "scales": scales}
        rows = {name: None if value is None else numbers(name, value) for name, value in given.items()}
        return self._model.poses(numbers("joint_positions", joint_positions), **rows)

    def vertices_m(self, part):
        """Return the vertices of part number `part` (0 to P - 1), in metres in the part frame: V x 3, float32."""
        return self._model.vertices_m(self._part(part))

    def triangles(self, part):
        """Return indices into vertices_m(part): T x 3, int32, counter-clockwise from outside.

        The array is empty for a point cloud.
        """
        return self._model.triangles(self._part(part))

    def _part(self, part):
        return integer("part", part, 0, self.part_count - 1)

    def __repr__(self):
        return f"<throng.Model {self.name}: {self.part_count} parts, {self.joint_count} joints>"
