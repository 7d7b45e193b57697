"""Batch kinematics equal the chain of joints."""

import pickle
import unittest
import xml.etree.ElementTree

import numpy
import throng
from expectations import SOURCES, Case

ARM = """<robot name="arm">
  <link name="base"><collision><geometry><box size="0.2 0.2 0.4"/></geometry></collision></link>
  <link name="upper"><collision><geometry><cylinder radius="0.05" length="0.5"/></geometry></collision></link>
  <link name="hand"><collision><geometry><sphere radius="0.07"/></geometry></collision></link>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/>
    <origin xyz="0.1 0 0.2" rpy="0 0.3 0"/><axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
  <joint name="slide" type="prismatic"><parent link="upper"/><child link="hand"/>
    <origin xyz="0 0 0.5"/><axis xyz="0 1 0"/><limit lower="0" upper="0.4" effort="1" velocity="1"/></joint>
</robot>
"""


def moved(x=0, y=0, z=0):
    out = numpy.eye(4)
    out[:3, 3] = x, y, z
    return out


def turned(axis, angle):
    i, j = [(1, 2), (2, 0), (0, 1)][axis]
    out = numpy.eye(4)
    out[i, i] = out[j, j] = numpy.cos(angle)
    out[i, j], out[j, i] = -numpy.sin(angle), numpy.sin(angle)
    return out


class Kinematics(Case):
    def setUp(self):
        super().setUp()
        file = self.folder / "arm.urdf"
        file.write_text(ARM)
        self.arm = throng.Model(file)
        self.random = numpy.random.default_rng(1)

    def test_follows_the_chain_of_joints(self):
        joints = self.random.uniform(self.arm.joint_lower, self.arm.joint_upper, (50, 2))
        places = self.random.uniform(-1000, 1000, (50, 3))
        found = self.arm.poses(joints, positions_m=places)
        self.assertEqual(found.shape, (50, 3, 4, 4))
        for row, (turn, slide) in enumerate(joints):
            base = moved(*places[row])
            upper = base @ moved(0.1, 0, 0.2) @ turned(1, 0.3) @ turned(2, turn)
            hand = upper @ moved(0, 0, 0.5) @ moved(0, slide, 0)
            numpy.testing.assert_allclose(found[row], [base, upper, hand], atol=1e-6)

    def test_rotates_and_scales_about_the_root(self):
        joints = self.random.uniform(self.arm.joint_lower, self.arm.joint_upper, (20, 2))
        angles = self.random.uniform(-3, 3, 20)
        rotations = numpy.stack([0 * angles, 0 * angles, numpy.sin(angles / 2), numpy.cos(angles / 2)], axis=1)
        plain = self.arm.poses(joints)
        found = self.arm.poses(joints, rotations_xyzw=rotations, scales=numpy.full(20, 2.0))
        plain[:, :, :3, 3] *= 2
        for row, angle in enumerate(angles):
            numpy.testing.assert_allclose(found[row], turned(2, angle) @ plain[row], atol=1e-6)

    def test_gives_the_same_poses_one_at_a_time(self):
        adult = throng.Model("adult")
        joints = self.random.uniform(adult.joint_lower, adult.joint_upper, (37, adult.joint_count))
        together = adult.poses(joints)
        for row in range(37):
            numpy.testing.assert_array_equal(together[row], adult.poses(joints[row])[0])

    def test_rejects_invalid_postures(self):
        for joints, options, where in [
            (numpy.zeros((3, 5)), {}, "joint_positions"),
            (numpy.zeros(0), {}, "joint_positions"),
            (numpy.full((1, 2), numpy.nan), {}, "joint_positions"),
            (numpy.zeros((3, 2)), {"positions_m": numpy.zeros((2, 3))}, "positions_m"),
            (numpy.zeros((3, 2)), {"rotations_xyzw": numpy.zeros((3, 4))}, r"rotations_xyzw\[0\]"),
            (numpy.zeros((3, 2)), {"scales": [1, 1, -1]}, r"scales\[2\]"),
        ]:
            with self.subTest(where=where), self.assertRaisesRegex(throng.InputError, f"^{where}: expected "):
                self.arm.poses(joints, **options)


    def test_rejects_invalid_numbers_with_a_message(self):
        for joints, options, where in [
            ("abc", {}, "joint_positions"),
            (None, {}, "joint_positions"),
            ([[1], [1, 2]], {}, "joint_positions"),
            (numpy.zeros((1, 2), dtype=complex), {}, "joint_positions"),
            (numpy.full((1, 2), 1e300), {}, "joint_positions"),
            (numpy.zeros((1, 2, 1)), {}, "joint_positions"),
            (numpy.zeros((1, 2)), {"positions_m": "a"}, "positions_m"),
            (numpy.zeros((1, 2)), {"rotations_xyzw": [0, 0, 0, 1]}, "rotations_xyzw"),
            (numpy.zeros((1, 2)), {"scales": ["large"]}, "scales"),
            (numpy.zeros((1, 2)), {"scales": 1}, "scales"),
        ]:
            with self.subTest(joints=joints, **options), self.assertRaisesRegex(throng.InputError, f"^{where}: expected "):
                self.arm.poses(joints, **options)
        for part in (-1, 0.5, "hand", None):
            with self.subTest(part=part), self.assertRaisesRegex(throng.InputError, "^part: expected a whole number"):
                self.arm.vertices_m(part)

    def test_can_be_pickled(self):
        again = pickle.loads(pickle.dumps(self.arm))
        self.assertEqual((again.name, again.joint_names, again.part_names), ("arm", ["shoulder", "slide"], self.arm.part_names))
        self.assertEqual(pickle.loads(pickle.dumps(throng.Model("adult"))).name, throng.Model("adult").name)


class Models(Case):
    def test_report_how_an_incomplete_urdf_is_read(self):
        file = self.folder / "robot_description.xml"
        file.write_text(ARM.replace('<limit lower="-2" upper="2" effort="1" velocity="1"/>', "").replace('name="arm"', 'name=""'))
        model = throng.Model(file)
        self.assertEqual(model.name, "robot_description")
        self.assertRegex("".join(model.notes), "revolute joints without <limit>.*'shoulder'")
        self.assertEqual(throng.Model("adult").notes, [])
        for urdf in (3, None, b"nowhere.urdf", ""):
            with self.subTest(urdf=urdf), self.assertRaises(throng.InputError):
                throng.Model(urdf)

    def test_have_the_joints_parts_and_meshes_of_the_urdf(self):
        adult = throng.Model("adult")
        tree = xml.etree.ElementTree.parse(SOURCES / "avatars/models/adult/adult.urdf").getroot()
        moving = [joint.get("name") for joint in tree.findall("joint") if joint.get("type") != "fixed"]
        self.assertEqual(sorted(adult.joint_names), sorted(moving))
        self.assertTrue(adult.is_person)
        self.assertTrue((adult.joint_lower <= adult.joint_upper).all())
        for part in range(adult.part_count):
            vertices, triangles = adult.vertices_m(part), adult.triangles(part)
            self.assertEqual(vertices.shape[1:], (3,))
            self.assertLess(triangles.max(), len(vertices))
        for part in (adult.part_count, 10**30, -1):
            with self.assertRaisesRegex(throng.InputError, "^part: expected a whole number from 0 to 14, found "):
                adult.vertices_m(part)


if __name__ == "__main__":
    unittest.main()
