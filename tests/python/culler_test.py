"""Own bodies in own poses: nothing that touches is missed, whoever poses it."""

import itertools
import pickle
import threading
import unittest

import numpy
import throng
from expectations import SLOWNESS, Case

BOX = numpy.array(list(itertools.product((-0.5, 0.5), repeat=3)))
# Of each face the two triangles, counter-clockwise from outside.
BOX_TRIANGLES = numpy.array(
    [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1),
     (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
)


def at(*places):
    poses = numpy.tile(numpy.eye(4), (len(places), 1, 1, 1))
    poses[:, 0, :3, 3] = places
    return poses


def key(table):
    return sorted(zip(*(table[name].tolist() for name in ("a", "b", "part_a", "part_b"))))


class Boxes(Case):
    def culler(self, **options):
        return throng.Culler(throng.Body([(BOX, BOX_TRIANGLES)]), **options)

    def test_tell_how_near_they_are_and_when_they_meet(self):
        culler = self.culler(exact=True, step_s=0.5, near=1.5, body_near=3)
        for x in (3, 2.5, 2.25):
            culler.step(at((0, 0, 0), (x, 0, 0)))
        (row,) = culler.near
        self.assertAlmostEqual(float(row["lo_m"]), 1.25, delta=1e-3)
        self.assertAlmostEqual(float(row["hi_m"]), 1.25, delta=1e-3)
        self.assertAlmostEqual(float(row["closing_speed_mps"]), 0.5, delta=1e-3)
        self.assertAlmostEqual(float(row["time_to_contact_s"]), 2.5, delta=1e-2)
        self.assertAlmostEqual(float(row["normal"][0]), 1, delta=1e-3)
        self.assertEqual(key(culler.near), key(culler.closest_parts))
        self.assertEqual(len(culler.pairs), 0)
        with self.assertRaises(throng.InputError):
            self.culler(near=-1)

    def test_tell_where_they_touch_and_how_deep(self):
        culler = self.culler(exact=True, contact_points=True)
        culler.step(at((0, 0, 0), (0.75, 0.1, 0.2), (9, 9, 9)))
        (row,) = culler.contact_points
        self.assertEqual(key(culler.contact_points), key(culler.pairs))
        self.assertAlmostEqual(float(row["depth_m"]), 0.25, delta=1e-3)
        numpy.testing.assert_allclose(row["direction"], (1, 0, 0), atol=1e-3)
        for centre in ((0, 0, 0), (0.75, 0.1, 0.2)):
            self.assertLessEqual(numpy.abs(row["point_m"] - centre).max(), 0.5 + 1e-6)
        with self.assertRaises(throng.InputError):
            self.culler(contact_points=True)

    def test_have_no_table_of_what_they_do_not_look_for(self):
        options = {"near": ("near=M", 1), "closest_parts": ("body_near=M", 1), "contact_points": ("contact_points=True", True)}
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

    def test_touch_when_they_overlap_and_leave_when_they_do_not(self):
        culler = self.culler(exact=True, step_s=0.5)
        for x in (3, 2, 0.9, 0.5, 0.9, 1.5, 3):
            events = culler.step(at((0, 0, 0), (x, 0.1, 0.2)))
            self.assertEqual(len(culler.pairs), int(x < 1))
            self.assertEqual(len(events), int(culler.frame in (3, 6)))
        (contact,) = culler.contacts
        self.assertEqual((contact["a"], contact["b"], contact["begin_frame"], contact["end_frame"]), (0, 1, 2, 5))
        self.assertEqual((contact["begin_s"], contact["end_s"], contact["ended"]), (1, 2.5, 1))

    def test_are_all_found_wherever_they_fly(self):
        random = numpy.random.default_rng(3)
        for exact, offset in itertools.product((False, True), (0, 1e6)):
            culler = self.culler(exact=exact)
            for scale in (3.0, 6.0, 60.0):  # the sphere around a body of one part stays
                places = random.uniform(0, scale, (40, 3)) + offset
                culler.step(at(*places))
                apart = numpy.abs(places[:, None] - places[None])
                expected = [(a, b, 0, 0) for a, b in itertools.combinations(range(40), 2) if (apart[a, b] < 1).all()]
                self.assertEqual(key(culler.pairs), expected)

    def test_that_reach_farther_than_ever_before_are_not_missed(self):
        body = throng.Body([(BOX, BOX_TRIANGLES)] * 2, names=["near", "far"])
        for pair_search in ("grid", "sweep", "brute"):
            culler = throng.Culler(body, exact=True, pair_search=pair_search)
            for reach in (1.1, 3, 40, 400, 2):
                poses = numpy.concatenate([at((0, 0, 0), (reach, 0, 0)), at((2 * reach + 0.8, 0, 0), (reach + 0.8, 0, 0))])
                culler.step(poses.reshape(2, 2, 4, 4))
                self.assertIn((0, 1, 1, 1), key(culler.pairs))
            self.assertEqual(key(culler.contacts)[-1], (0, 1, 1, 1))
            self.assertEqual(len(culler.contacts[culler.contacts["part_a"] == 1]), 1)  # one contact, never let go
            self.assertEqual(culler.contacts.to_pandas().part_a_name.iloc[-1], "far")

    def test_come_and_go_by_their_ids(self):
        culler = self.culler()
        culler.step(at((0, 0, 0), (0.5, 0, 0)), ids=[3, 7])
        self.assertEqual(key(culler.pairs), [(3, 7, 0, 0)])
        culler.step(at((0, 0, 0)), ids=[3])
        self.assertEqual(len(culler.pairs), 0)
        self.assertEqual(len(culler.events), 2)

    def test_of_several_kinds_and_sizes_meet(self):
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

    def test_are_refused_where_they_are_no_bodies(self):
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

    def test_are_refused_where_they_are_beyond_all_bounds(self):
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

    def test_are_refused_in_words_whatever_is_given_for_them(self):
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
            ("near", {"near": "a"}),
            ("body_near", {"body_near": "a"}),
            ("body_near", {"body_near": -1}),
            ("body_near", {"body_near": numpy.nan}),
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
        with self.assertRaisesRegex(throng.InputError, "^names: expected a name a part, 1, found"):
            throng.Body([BOX], names=["a", "b"])

    def test_may_have_another_volume_for_each_part(self):
        corners = numpy.array([(x, y, z) for x in (-1, 1) for y in (-0.1, 0.1) for z in (-0.1, 0.1)])
        body = throng.Body([corners, corners], names=["left_hand", "trunk"])
        places = at((0, 0, 0), (50, 0, 0), (-0.6, 0.6, 0), (49.4, 0.6, 0))
        places[:, 0, :2, :2] = numpy.array([(1, -1), (1, 1)]) / 2**0.5  # so that their upright boxes overlap
        places = places.reshape(2, 2, 4, 4)
        for volume, parts in [("sphere", {0, 1}), ("obb", set()), ("hand: obb, default: sphere", {1}),
                              ("hand: sphere, trunk: obb", {0})]:
            with self.subTest(volume=volume):
                culler = throng.Culler(body, part_volume=volume)
                culler.step(places)
                self.assertEqual({pair[2] for pair in key(culler.pairs)}, parts)
                self.assertEqual({pair[3] for pair in key(culler.pairs)}, parts)
        self.assertIsNotNone(throng.Culler(throng.Model("adult"), part_volume="hand: obb, default: sphere"))

    def test_and_their_tables_can_be_pickled(self):
        body = pickle.loads(pickle.dumps(throng.Body([(BOX, BOX_TRIANGLES)], names=["cube"])))
        culler = throng.Culler(body, exact=True, near=3)
        culler.step(at((0, 0, 0), (0.5, 0, 0), (2, 0, 0)))
        for table in (culler.pairs, culler.events, culler.contacts, culler.near):
            again = pickle.loads(pickle.dumps(table))
            self.assertSameTable(again, table)
            self.assertEqual(again.to_pandas().part_a_name[0], "cube")

    def test_become_data_frames_of_the_columns_that_are_selected(self):
        culler = throng.Culler(throng.Body([(BOX, BOX_TRIANGLES)], names=["cube"]))
        culler.step(at((0, 0, 0), (0.5, 0, 0)))
        for columns, names in [(["a", "b"], []), (["part_a"], []), (["part_b", "b"], ["part_b_name"])]:
            with self.subTest(columns=columns):
                frame = culler.contacts[columns].to_pandas()
                self.assertEqual(list(frame.columns), columns + names)
                self.assertTrue((frame[names] == "cube").all(axis=None))

    def test_become_data_frames_with_their_points(self):
        culler = self.culler(exact=True, near=3, body_near=3)
        culler.step(at((0, 0, 0), (2, 0, 0)))
        for table in (culler.near, culler.closest_parts):
            frame = table.to_pandas()
            self.assertEqual(len(frame), 1)
            for name in ("point_a_x_m", "point_a_y_m", "point_a_z_m", "point_b_x_m", "normal_x", "normal_y", "normal_z", "lo_m", "part_a_name"):
                self.assertIn(name, frame.columns)
            self.assertEqual(frame.point_b_x_m[0], table["b_m"][0, 0])
        culler = self.culler(exact=True, contact_points=True)
        culler.step(at((0, 0, 0), (0.75, 0, 0)))
        frame = culler.contact_points.to_pandas()
        numpy.testing.assert_array_equal(frame[["point_x_m", "point_y_m", "point_z_m"]], culler.contact_points["point_m"])
        numpy.testing.assert_array_equal(frame[["normal_x", "normal_y", "normal_z"]], culler.contact_points["direction"])

    def test_may_be_culled_while_others_run_python(self):
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


class People(Case):
    def test_posed_by_hand_touch_whom_they_touch_in_the_scene(self):
        simulation = throng.Simulation("plaza", avatars=1500, seconds=1 if SLOWNESS == 1 else 0.3, exact=True)
        people = len(simulation.people)
        culler = throng.Culler(throng.Model("adult"), exact=True)
        seen = 0
        for frame in itertools.islice(simulation, 0, None, 6):
            expected = frame.pairs[frame.pairs["b"] < people]
            who = numpy.flatnonzero(frame.present)
            culler.step(frame.part_poses(who), ids=who, scales=simulation.people["scale"][who])
            self.assertEqual(key(culler.pairs), key(expected))
            seen += len(expected)
        self.assertGreater(seen, 20)


if __name__ == "__main__":
    unittest.main()
