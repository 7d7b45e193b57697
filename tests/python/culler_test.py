"""Culler finds every contact of custom bodies in custom poses."""

import itertools
import pickle
import threading
import unittest

import numpy
import throng
from expectations import SLOWNESS, Case

BOX = numpy.array(list(itertools.product((-0.5, 0.5), repeat=3)))
# Two triangles per face, counter-clockwise from outside.
BOX_TRIANGLES = numpy.array(
    [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1),
     (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
)


def at(*places):
    poses = numpy.tile(numpy.eye(4), (len(places), 1, 1, 1))
    poses[:, 0, :3, 3] = places
    return poses


def key(table):
    return sorted(zip(*(table[name].tolist() for name in ("body_a", "body_b", "part_a", "part_b"))))


class CullerOfBoxes(Case):
    def culler(self, **options):
        return throng.Culler(throng.Body([(BOX, BOX_TRIANGLES)]), **options)

    def test_reports_distances_and_time_to_contact(self):
        culler = self.culler(exact=True, step_s=0.5, proximity=1.5, closest_parts=3)
        for x in (3, 2.5, 2.25):
            culler.step(at((0, 0, 0), (x, 0, 0)))
        (row,) = culler.proximity
        self.assertAlmostEqual(float(row["distance_lo_m"]), 1.25, delta=1e-3)
        self.assertAlmostEqual(float(row["distance_hi_m"]), 1.25, delta=1e-3)
        self.assertAlmostEqual(float(row["closing_speed_mps"]), 0.5, delta=1e-3)
        self.assertAlmostEqual(float(row["time_to_contact_s"]), 2.5, delta=1e-2)
        self.assertAlmostEqual(float(row["normal"][0]), 1, delta=1e-3)
        self.assertEqual(key(culler.proximity), key(culler.closest_parts))
        self.assertEqual(len(culler.pairs), 0)
        with self.assertRaises(throng.InputError):
            self.culler(proximity=-1)

    def test_reports_contact_points_and_penetration_depths(self):
        culler = self.culler(exact=True, contact_points=True)
        culler.step(at((0, 0, 0), (0.75, 0.1, 0.2), (9, 9, 9)))
        (row,) = culler.contact_points
        self.assertEqual(key(culler.contact_points), key(culler.pairs))
        self.assertAlmostEqual(float(row["depth_m"]), 0.25, delta=1e-3)
        numpy.testing.assert_allclose(row["normal"], (1, 0, 0), atol=1e-3)
        for centre in ((0, 0, 0), (0.75, 0.1, 0.2)):
            self.assertLessEqual(numpy.abs(row["point_m"] - centre).max(), 0.5 + 1e-6)
        with self.assertRaises(throng.InputError):
            self.culler(contact_points=True)

    def test_measures_distances_by_name_without_a_margin(self):
        ROBOT = throng.Body([(BOX, BOX_TRIANGLES)] * 3, names=["base", "left_hand", "right_hand"])
        poses = numpy.tile(numpy.eye(4), (2, 3, 1, 1))
        poses[0, :, :3, 3] = (0, 0, 0), (0, 5, 0), (0, -5, 0)
        poses[1, :, :3, 3] = (7, 0, 0), (9, 5, 0), (2.5, -5.2, 0.1)
        culler = throng.Culler(ROBOT)
        with self.assertRaisesRegex(throng.InputError, "^a: expected the id of a body of the last step, found 4"):
            culler.distance(4, None, 9, None)
        culler.step(poses, ids=[4, 9])
        hands = culler.distance(4, "hand", 9, "hand")
        self.assertEqual((hands.part_a_name, hands.part_b_name), ("right_hand", "right_hand"))
        self.assertEqual((hands.part_a, hands.part_b, hands.depth_m), (2, 2, 0))
        self.assertLessEqual(hands.lo_m, 1.5)
        self.assertAlmostEqual(hands.hi_m, 1.5, delta=1e-3)
        numpy.testing.assert_allclose(hands.normal, (1, 0, 0), atol=0.05)
        self.assertAlmostEqual(hands.point_a_m[0], 0.5, delta=1e-6)
        self.assertAlmostEqual(hands.point_b_m[0], 2, delta=1e-6)
        self.assertAlmostEqual(culler.distance(4, "base", 9, 0).lo_m, 6, delta=1e-3)
        back = culler.distance(9, "", 4, None)
        self.assertEqual((back.hi_m, back.part_a, back.part_b), (hands.hi_m, 2, 2))
        numpy.testing.assert_array_equal(back.point_a_m, hands.point_b_m)
        lo_m, hi_m, *_ = culler.distance(4, "LeftHands", 9, numpy.int8(1))
        self.assertLessEqual(lo_m, 8)
        self.assertGreaterEqual(hi_m, 8)
        with self.assertRaises(throng.InputError):
            culler.step(poses * numpy.nan, ids=[4, 9])
        self.assertEqual(culler.distance(4, "hand", 9, "hand").hi_m, hands.hi_m)  # of the last step
        poses[1, 2, :3, 3] = (0.75, -5, 0)
        culler.step(poses, ids=[5, 9])
        touching = culler.distance(5, "hand", 9, "hand")
        self.assertEqual((touching.lo_m, touching.hi_m), (0, 0))
        self.assertAlmostEqual(touching.depth_m, 0.25, delta=1e-3)
        numpy.testing.assert_array_equal(touching.point_a_m, touching.point_b_m)

    def test_rejects_distances_of_unknown_bodies_and_parts(self):
        culler = throng.Culler(throng.Body([(BOX, BOX_TRIANGLES)] * 2, names=["base", "gripper"]))
        culler.step(numpy.tile(numpy.eye(4), (2, 2, 1, 1)))
        for arguments, message in {
            (0, None, 2, None): "b: expected the id of a body of the last step, found 2",
            (1, None, 1, None): "b: expected another body than a, found 1",
            (-1, None, 1, None): "a: expected a whole number from 0 to 16777215, found -1",
            (0, "griper", 1, None): r"part_a: expected a part number up to 1, or words of a part: base, gripper, found "
                                    r"'griper' \(did you mean 'gripper'\?\)",
            (0, None, 1, 2): "part_b: expected a part number up to 1, or words of a part: base, gripper, found '2'",
            (0, None, 1, -7): "part_b: .* found '-1'",
            (0, None, 1, 1.5): "part_b: expected a part number, a name or None, found 1.5",
        }.items():
            with self.subTest(arguments=arguments), self.assertRaisesRegex(throng.InputError, f"^{message}"):
                culler.distance(*arguments)

    def test_measures_points_by_their_hulls(self):
        culler = throng.Culler(throng.Body([BOX]))
        culler.step(at((0, 0, 0), (2, 0, 0)))
        found = culler.distance(0, None, 1, None)
        self.assertLessEqual(found.lo_m, 1)
        self.assertGreaterEqual(found.hi_m, 1)
        self.assertTrue(numpy.isnan(found.point_a_m).all())

    def test_raises_without_a_requested_table(self):
        options = {"proximity": ("proximity=M", 1), "closest_parts": ("closest_parts=M", 1), "contact_points": ("contact_points=True", True)}
        for asked, (option, value) in options.items():
            culler = self.culler(exact=True, **{option.split("=")[0]: value})
            culler.step(at((0, 0, 0), (9, 0, 0)))
            for name, (other, _) in options.items():
                with self.subTest(asked=asked, name=name):
                    if name == asked:
                        self.assertEqual(len(getattr(culler, name)), 0)
                        continue
                    with self.assertRaisesRegex(RuntimeError, f"without {other}: there is no table"):
                        getattr(culler, name)

    def test_reports_begins_and_ends_of_contacts(self):
        culler = self.culler(exact=True, step_s=0.5)
        for x in (3, 2, 0.9, 0.5, 0.9, 1.5, 3):
            events = culler.step(at((0, 0, 0), (x, 0.1, 0.2)))
            self.assertEqual(len(culler.pairs), int(x < 1))
            self.assertEqual(len(events), int(culler.frame in (3, 6)))
        (contact,) = culler.contacts
        self.assertEqual((contact["body_a"], contact["body_b"], contact["begin_frame"], contact["end_frame"]), (0, 1, 2, 5))
        self.assertEqual((contact["begin_s"], contact["end_s"], contact["ended"]), (1, 2.5, 1))

    def test_finds_all_contacts_of_moving_boxes(self):
        random = numpy.random.default_rng(3)
        for exact, offset in itertools.product((False, True), (0, 1e6)):
            culler = self.culler(exact=exact)
            for scale in (3.0, 6.0, 60.0):  # the radius of a body with one part stays
                places = random.uniform(0, scale, (40, 3)) + offset
                culler.step(at(*places))
                apart = numpy.abs(places[:, None] - places[None])
                expected = [(a, b, 0, 0) for a, b in itertools.combinations(range(40), 2) if (apart[a, b] < 1).all()]
                self.assertEqual(key(culler.pairs), expected)

    def test_finds_bodies_that_reach_farther_than_before(self):
        body = throng.Body([(BOX, BOX_TRIANGLES)] * 2, names=["near", "far"])
        for pair_search in ("grid", "sweep", "brute"):
            culler = throng.Culler(body, exact=True, pair_search=pair_search)
            for reach in (1.1, 3, 40, 400, 2):
                poses = numpy.concatenate([at((0, 0, 0), (reach, 0, 0)), at((2 * reach + 0.8, 0, 0), (reach + 0.8, 0, 0))])
                culler.step(poses.reshape(2, 2, 4, 4))
                self.assertIn((0, 1, 1, 1), key(culler.pairs))
            self.assertEqual(key(culler.contacts)[-1], (0, 1, 1, 1))
            self.assertEqual(len(culler.contacts[culler.contacts["part_a"] == 1]), 1)  # one uninterrupted contact
            self.assertEqual(culler.contacts.to_pandas().part_a_name.iloc[-1], "far")

    def test_lets_bodies_enter_and_leave_by_id(self):
        culler = self.culler()
        culler.step(at((0, 0, 0), (0.5, 0, 0)), ids=[3, 7])
        self.assertEqual(key(culler.pairs), [(3, 7, 0, 0)])
        culler.step(at((0, 0, 0)), ids=[3])
        self.assertEqual(len(culler.pairs), 0)
        self.assertEqual(len(culler.events), 2)

    def test_culls_several_kinds_and_sizes(self):
        wall = throng.Body([BOX * (10, 0.2, 2)], static=True)
        pillar = throng.Body([BOX], static=True)
        person = throng.Body([BOX * 0.4, BOX * 0.2])
        culler = throng.Culler([wall, pillar, person])
        one = numpy.concatenate([at((0, 0.25, 0))[0], at((0, 0.25, 1))[0]])
        poses = [at((0, 0, 0))[0], at((0, 0.3, 0))[0], one]
        culler.step(poses, types=[0, 1, 2])
        self.assertEqual(key(culler.pairs), [(0, 2, 0, 0), (1, 2, 0, 0)])  # wall and pillar stand still
        culler.step(poses, types=[0, 1, 2], scales=[1, 1, 5])
        self.assertIn((0, 2, 0, 1), key(culler.pairs))

    def test_rejects_invalid_bodies(self):
        culler = self.culler()
        stretched, mirrored, lost = at((0, 0, 0)), at((0, 0, 0)), at((0, 0, numpy.nan))
        stretched[0, 0, 0, 0] = 2
        mirrored[0, 0, 0, 0] = -1
        for poses, options, where in [
            (stretched, {}, r"poses\[0, 0\]"),
            (mirrored, {}, r"poses\[0, 0\]"),
            (lost, {}, r"poses\[0, 0\]"),
            (numpy.zeros((2, 3, 4, 4)), {}, "poses"),
            (at((0, 0, 0), (1, 1, 1)), {"ids": [1, 1]}, r"ids\[1\]"),
            (at((0, 0, 0)), {"types": [1]}, r"types\[0\]"),
            (at((0, 0, 0)), {"scales": [0]}, r"scales\[0\]"),
            (at((0, 0, 0)), {"scales": [1, 1]}, "ids, types, scales"),
        ]:
            with self.subTest(where=where), self.assertRaisesRegex(throng.InputError, f"^{where}: expected "):
                culler.step(poses, **options)
        for parts in ([], [numpy.zeros((0, 3))], [(BOX, [[0, 1, 8]])], [numpy.full((3, 3), numpy.inf)]):
            with self.subTest(parts=parts), self.assertRaises(throng.InputError):
                throng.Body(parts)
        with self.assertRaises(throng.InputError):
            throng.Culler(throng.Body([BOX]), exact=True)  # points have no triangles

    def test_rejects_coordinates_out_of_range(self):
        culler = self.culler()
        for far in (1.1e9, -1e12, 1e39, -1e300):
            for axis in range(3):
                place = numpy.zeros(3)
                place[axis] = far
                with self.subTest(place=place), self.assertRaisesRegex(
                    throng.InputError, r"^poses\[1, 0\]: expected a position within 1e\+09 m of the origin, found "
                ):
                    culler.step(at((0, 0, 0), place))
        self.assertEqual(culler.frame, 0)
        culler.step(at((-1e9, 0, 0), (1e9, 1e9, 0), (1e9, 1e9, 0.5)))
        self.assertEqual(key(culler.pairs), [(1, 2, 0, 0)])
        for far in (1.1e6, -1e39, numpy.inf, numpy.nan):
            points = BOX.copy()
            points[3, 1] = far
            with self.subTest(far=far), self.assertRaisesRegex(
                throng.InputError, r"^parts\[1\]: expected coordinates of at most 1e\+06 m, found .* at point 3$"
            ):
                throng.Body([BOX, points])
        throng.Body([BOX * 2e6])

    def test_rejects_invalid_arguments_with_a_message(self):
        for bodies in ("adult", None, 3, ["adult"], [throng.Body([BOX]), None], throng.Body):
            with self.subTest(bodies=bodies), self.assertRaisesRegex(throng.InputError, "^bodies: expected a Model, a Body"):
                throng.Culler(bodies)
        with self.assertRaisesRegex(throng.InputError, "^bodies: expected at least one"):
            throng.Culler([])
        culler = self.culler()
        for where, given in [
            (r"ids\[0\]", {"ids": [-1]}),
            (r"ids\[0\]", {"ids": [0.5]}),
            (r"ids\[0\]", {"ids": [numpy.nan]}),
            (r"ids\[0\]", {"ids": [2**40]}),
            ("ids", {"ids": ["a"]}),
            ("ids", {"ids": [[0]]}),
            ("ids", {"ids": 0}),
            ("ids", {"ids": [True]}),
            (r"types\[0\]", {"types": [-1]}),
            (r"types\[0\]", {"types": [0.5]}),
            ("types", {"types": "a"}),
            (r"scales\[0\]", {"scales": [-1]}),
            (r"scales\[0\]", {"scales": [numpy.nan]}),
            (r"scales\[0\]", {"scales": [1e-50]}),
            (r"scales\[0\]", {"scales": [1e-37]}),
            (r"scales\[0\]", {"scales": [9.9e-7]}),
            (r"scales\[0\]", {"scales": [1.01e6]}),
            (r"scales\[0\]", {"scales": [numpy.inf]}),
            ("scales", {"scales": [1j]}),
            ("scales", {"scales": [[1]]}),
            ("poses", {"poses": None}),
            ("poses", {"poses": "abc"}),
            ("poses", {"poses": numpy.eye(4)}),
            ("poses", {"poses": at((0, 0, 0)).astype(complex)}),
            (r"poses\[0\]", {"poses": [[1, 2]]}),
            (r"poses\[0\]", {"poses": [[[1, 2], [3]]]}),
            (r"poses\[0\]", {"poses": ["a"]}),
        ]:
            with self.subTest(given=given), self.assertRaisesRegex(throng.InputError, f"^{where}: expected .*found "):
                culler.step(**{"poses": at((0, 0, 0)), **given})
        self.assertEqual(culler.frame, 0)
        culler.step(at((0, 0, 0)), ids=[3.0], types=numpy.array([0], dtype=numpy.uint8), scales=[True])
        for where, options in [
            ("proximity", {"proximity": "a"}),
            ("closest_parts", {"closest_parts": "a"}),
            ("closest_parts", {"closest_parts": -1}),
            ("closest_parts", {"closest_parts": numpy.nan}),
            ("step_s", {"step_s": 0}),
            ("step_s", {"step_s": numpy.inf}),
            ("threads", {"threads": 0}),
            ("part_volume", {"part_volume": "ordop25"}),
            ("part_volume", {"part_volume": "hand: obb"}),
            ("part_volume", {"part_volume": "part: ordop25"}),
            ("pair_search", {"pair_search": "tree"}),
        ]:
            with self.subTest(options=options), self.assertRaisesRegex((throng.InputError, TypeError), f"^{where}: expected .*found "):
                self.culler(**options)
        for parts, where in [
            ("mesh.tri", "parts"),
            (3, "parts"),
            ([3], r"parts\[0\]"),
            ([[[0, 0]]], r"parts\[0\]"),
            ([[["a", "b", "c"]]], r"parts\[0\]"),
            ([(BOX, [[0, 1, 2.5]])], r"parts\[0\]"),
            ([(BOX, [[0, 1]])], r"parts\[0\]"),
            ([(BOX, [[0, 1, -1]])], r"parts\[0\]"),
            ([BOX * 1e300], r"parts\[0\]"),
        ]:
            with self.subTest(parts=parts), self.assertRaisesRegex(throng.InputError, f"^{where}.*: expected .*found "):
                throng.Body(parts)
        with self.assertRaisesRegex(throng.InputError, "^names: expected one name per part, 1, found"):
            throng.Body([BOX], names=["a", "b"])

    def test_accepts_a_volume_per_part(self):
        corners = numpy.array([(x, y, z) for x in (-1, 1) for y in (-0.1, 0.1) for z in (-0.1, 0.1)])
        body = throng.Body([corners, corners], names=["left_hand", "trunk"])
        places = at((0, 0, 0), (50, 0, 0), (-0.6, 0.6, 0), (49.4, 0.6, 0))
        places[:, 0, :2, :2] = numpy.array([(1, -1), (1, 1)]) / 2**0.5  # makes their axis-aligned boxes overlap
        places = places.reshape(2, 2, 4, 4)
        for volume, parts in [("sphere", {0, 1}), ("obb", set()), ("hand: obb, default: sphere", {1}),
                              ("hand: sphere, trunk: obb", {0})]:
            with self.subTest(volume=volume):
                culler = throng.Culler(body, part_volume=volume)
                culler.step(places)
                self.assertEqual({pair[2] for pair in key(culler.pairs)}, parts)
                self.assertEqual({pair[3] for pair in key(culler.pairs)}, parts)
        self.assertIsNotNone(throng.Culler(throng.Model("adult"), part_volume="hand: obb, default: sphere"))

    def test_has_tables_that_can_be_pickled(self):
        body = pickle.loads(pickle.dumps(throng.Body([(BOX, BOX_TRIANGLES)], names=["cube"])))
        culler = throng.Culler(body, exact=True, proximity=3)
        culler.step(at((0, 0, 0), (0.5, 0, 0), (2, 0, 0)))
        for table in (culler.pairs, culler.events, culler.contacts, culler.proximity):
            again = pickle.loads(pickle.dumps(table))
            self.assertSameTable(again, table)
            self.assertEqual(again.to_pandas().part_a_name[0], "cube")

    def test_converts_selected_columns_to_data_frames(self):
        culler = throng.Culler(throng.Body([(BOX, BOX_TRIANGLES)], names=["cube"]))
        culler.step(at((0, 0, 0), (0.5, 0, 0)))
        for columns, names in [(["body_a", "body_b"], []), (["part_a"], []), (["part_b", "body_b"], ["part_b_name"])]:
            with self.subTest(columns=columns):
                frame = culler.contacts[columns].to_pandas()
                self.assertEqual(list(frame.columns), columns + names)
                self.assertTrue((frame[names] == "cube").all(axis=None))

    def test_converts_points_to_columns(self):
        culler = self.culler(exact=True, proximity=3, closest_parts=3)
        culler.step(at((0, 0, 0), (2, 0, 0)))
        for table in (culler.proximity, culler.closest_parts):
            frame = table.to_pandas()
            self.assertEqual(len(frame), 1)
            for name in ("point_a_x_m", "point_a_y_m", "point_a_z_m", "point_b_x_m", "normal_x", "normal_y", "normal_z", "distance_lo_m", "part_a_name"):
                self.assertIn(name, frame.columns)
            self.assertEqual(frame.point_b_x_m[0], table["point_b_m"][0, 0])
        culler = self.culler(exact=True, contact_points=True)
        culler.step(at((0, 0, 0), (0.75, 0, 0)))
        frame = culler.contact_points.to_pandas()
        numpy.testing.assert_array_equal(frame[["point_x_m", "point_y_m", "point_z_m"]], culler.contact_points["point_m"])
        numpy.testing.assert_array_equal(frame[["normal_x", "normal_y", "normal_z"]], culler.contact_points["normal"])

    def test_releases_the_interpreter_lock(self):
        culler = self.culler()
        places = numpy.random.default_rng(1).uniform(0, 30, (1000, 3))
        failures = []

        def step():
            for _ in range(5):
                try:
                    culler.step(at(*places))
                except RuntimeError as error:
                    failures.append(str(error))

        threads = [threading.Thread(target=step) for _ in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(culler.frame + len(failures), 15)


class CullerOfPeople(Case):
    def test_finds_the_contacts_of_the_scene(self):
        simulation = throng.Simulation("plaza", avatars=1500, seconds=1 if SLOWNESS == 1 else 0.3, exact=True)
        people = len(simulation.people)
        culler = throng.Culler(throng.Model("adult"), exact=True)
        seen = 0
        for frame in itertools.islice(simulation, 0, None, 6):
            expected = frame.pairs[frame.pairs["body_b"] < people]
            who = numpy.flatnonzero(frame.present)
            culler.step(frame.part_poses(who), ids=who, scales=simulation.people["scale"][who])
            self.assertEqual(key(culler.pairs), key(expected))
            seen += len(expected)
        self.assertGreater(seen, 20)


if __name__ == "__main__":
    unittest.main()
