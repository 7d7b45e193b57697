"""Own bodies in own poses: nothing that touches is missed, whoever poses it."""

import itertools
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
        self.assertAlmostEqual(float(row["closing_mps"]), 0.5, delta=1e-3)
        self.assertAlmostEqual(float(row["contact_in_s"]), 2.5, delta=1e-2)
        self.assertAlmostEqual(float(row["normal"][0]), 1, delta=1e-3)
        self.assertEqual(key(culler.near), key(culler.near_bodies))
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
        self.assertEqual(len(culler.near), 0)
        with self.assertRaises(throng.InputError):
            self.culler(contact_points=True)

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
