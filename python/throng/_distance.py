"""Distances of bodies and parts, on request."""

from typing import NamedTuple

import numpy

from ._validation import abbreviated, input_error


class Distance(NamedTuple):
    """Distance of the nearest two parts of two bodies, returned by Frame.distance() and Culler.distance().

    Attributes:
        lo_m, hi_m: proven bounds of the distance in metres; with triangles at most 1 mm apart up to 100 m. Both are 0
            if parts touch.
        point_a_m, point_b_m (3, float64): nearest points on a and b, hi_m apart, in the world frame. The same point if
            the parts touch.
        normal (3, float32): unit vector from point_a_m to point_b_m. If the parts touch: the direction in which the
            least translation of b separates their convex hulls.
        part_a, part_b: numbers of the nearest parts.
        part_a_name, part_b_name: their names.
        depth_m: penetration depth of the convex hulls along the normal; 0 if the parts are apart.

    If a body has no triangles, lo_m and hi_m are bounds by convex hulls, and points and normal are nan.
    """

    lo_m: float
    hi_m: float
    point_a_m: numpy.ndarray
    point_b_m: numpy.ndarray
    normal: numpy.ndarray
    part_a: int
    part_b: int
    part_a_name: str
    part_b_name: str
    depth_m: float


def part_choice(where, part):
    """Return a part number or a name for the compiled module."""
    if part is None or isinstance(part, str):
        return part or ""
    try:
        number = part.__index__()
    except (AttributeError, TypeError):
        raise input_error(where, "a part number, a name or None", abbreviated(part)) from None
    # Larger numbers are no parts either.
    return max(-1, min(number, 10**9))
