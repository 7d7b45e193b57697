"""Simulation: frames, arrays that keep their values, one thread at a time."""

import gc
import threading
import unittest

import numpy
import throng
from expectations import SOURCES, Case, command, command_hash

CONTROLLED = """name: controlled robot
ground: {{min_m: [-8, -8], max_m: [8, 8]}}
groups:
  - name: robot
    model: {model}
    count: 1
    control_channel: ROBOT_DRIVE
    radius_m: 0.35
    spawn: {{min_m: [2.5, -0.5], max_m: [3.5, 0.5]}}
"""


class Steps(Case):
    def test_give_the_run_of_the_same_scene(self):
        run = throng.run("corridor", seconds=1, seed=5)
        simulation = throng.Simulation("corridor", seconds=1, seed=5)
        events = [frame.events.copy() for frame in simulation]
        events.append(simulation.finish())
        self.assertSameTable(numpy.concatenate(events), run.events)
        self.assertEqual(simulation.hash, run.hash)
        self.assertEqual(simulation.run_id, run.run_id)

    def test_match_the_duration_of_the_scene(self):
        self.assertEqual([frame.number for frame in throng.Simulation("corridor", seconds=0.1)], list(range(6)))

    def test_give_arrays_of_the_documented_shapes(self):
        simulation = throng.Simulation("corridor", avatars=40)
        frame = simulation.step()
        self.assertEqual(frame.positions_m.shape, (40, 3))
        self.assertEqual(frame.positions_m.dtype, numpy.float64)
        self.assertEqual(frame.rotations_xyzw.shape, (40, 4))
        self.assertEqual(frame.present.dtype, bool)
        numpy.testing.assert_allclose(numpy.linalg.norm(frame.rotations_xyzw, axis=1), 1, atol=1e-5)
        heading = 2 * numpy.arctan2(frame.rotations_xyzw[:, 2], frame.rotations_xyzw[:, 3])
        numpy.testing.assert_allclose(numpy.cos(heading - frame.headings_rad), 1, atol=1e-5)
        self.assertEqual(len(frame.joint_positions), simulation.joint_offsets[-1])

    def test_give_a_point_for_each_touching_pair(self):
        options = dict(avatars=80, seconds=0.5, exact=True)
        rows, plain = 0, throng.Simulation("plaza", **options)
        for frame in throng.Simulation("plaza", contact_points=True, **options):
            self.assertEqual(frame.hash, plain.step().hash)
            for name in ("body_a", "body_b", "part_a", "part_b"):
                numpy.testing.assert_array_equal(frame.contact_points[name], frame.pairs[name])
            self.assertTrue((frame.contact_points["depth_m"] >= 0).all())
            self.assertTrue(numpy.isfinite(frame.contact_points["point_m"]).all())
            rows += len(frame.contact_points)
        self.assertGreater(rows, 0)
        with self.assertRaises(throng.InputError):
            throng.Simulation("plaza", contact_points=True)

    def test_measure_distances_as_their_tables(self):
        simulation = throng.Simulation("robot_in_crowd", seconds=1, exact=True, proximity=0.3, closest_parts=0.6)
        plain, rows = throng.Simulation("robot_in_crowd", seconds=1), 0
        for frame in simulation:
            other = plain.step()
            for row in [*frame.proximity[:5], *frame.closest_parts[:5]] if frame.number % 10 == 0 else []:
                a, part_a, b, part_b = (row[name] for name in ("body_a", "part_a", "body_b", "part_b"))
                found = frame.distance(a, part_a, b, part_b)
                self.assertAlmostEqual(found.lo_m, float(row["distance_lo_m"]), delta=1e-3)  # the row: of all parts
                self.assertEqual(found.hi_m, row["distance_hi_m"])
                numpy.testing.assert_array_equal(found.point_a_m, row["point_a_m"])
                numpy.testing.assert_array_equal(found.normal, row["normal"])
                self.assertEqual(found.hi_m, other.distance(a, part_a, b, part_b).hi_m)
                rows += 1
        self.assertGreater(rows, 30)

    def test_measure_distances_by_name(self):
        simulation = throng.Simulation("robot_in_crowd", seconds=1)
        frame = simulation.step()
        tree = len(simulation.people) + simulation.names.obstacles.index("tree 1")
        hands = frame.distance(5, "hand", 6, "head")
        sides = [frame.distance(5, name, 6, "head") for name in ("leftHand", "right_hand")]
        self.assertEqual(hands.hi_m, min(side.hi_m for side in sides))
        self.assertIn(hands.part_a_name, ("leftHand", "RightHand"))
        self.assertEqual(hands.part_b_name, "head")
        whole = frame.distance(5, None, tree, "")
        self.assertEqual((whole.part_b, whole.part_b_name), (0, "tree 1"))
        self.assertLess(0, whole.lo_m)
        simulation.step()
        with self.assertRaisesRegex(RuntimeError, "not the latest frame"):
            frame.distance(5, None, 6, None)

    def test_reject_distances_of_unknown_bodies_and_parts(self):
        simulation = throng.Simulation("robot_in_crowd", seconds=1)
        frame = simulation.step()
        bodies = len(simulation.people) + len(simulation.names.obstacles)
        for arguments, message in {
            (0, None, bodies, None): f"b: expected a body number from 0 to {bodies - 1}, found {bodies}",
            (-1, None, 1, None): "a: expected a whole number from 0",
            (3, None, 3, None): "b: expected another body than a, found 3",
            (0, "mats", 5, None): r"part_a: .*body, lid, mast.* found 'mats' \(did you mean 'mast'\?\)",
            (0, None, 5, "hamd"): r"part_b: .*leftHand.* found 'hamd' \(did you mean 'hand'\?\)",
        }.items():
            with self.subTest(arguments=arguments), self.assertRaisesRegex(throng.InputError, message):
                frame.distance(*arguments)

    def test_pose_parts_like_the_kinematics(self):
        simulation = throng.Simulation("corridor", avatars=40)
        model = throng.Model("adult")
        frame = [simulation.step() for _ in range(20)][-1]
        joints = frame.joint_positions.reshape(40, model.joint_count)
        expected = model.poses(joints, frame.positions_m, frame.rotations_xyzw, simulation.people["scale"])
        numpy.testing.assert_allclose(frame.part_poses(range(40)), expected, atol=1e-5)

    def test_continue_from_a_saved_state(self):
        first, second = (throng.Simulation("plaza", avatars=200, threads=n) for n in (1, 2))
        for _ in range(30):
            first.step()
        second.resume(first.save())
        for _ in range(30):
            self.assertEqual(first.step().hash, second.step().hash)
        self.assertEqual(second.next_frame, 60)
        with self.assertRaisesRegex(RuntimeError, "before its first step"):
            second.resume(first.save())
        with self.assertRaises(throng.InputError):
            throng.Simulation("plaza", avatars=200).resume(b"nothing")

    def test_apply_commanded_poses(self):
        scene = self.folder / "robot.yaml"
        scene.write_text(CONTROLLED.format(model=SOURCES / "examples/picker.urdf"))
        simulation = throng.Simulation(scene)
        joints = throng.Model(SOURCES / "examples/picker.urdf").joint_count
        simulation.step()
        for x in (1.0, 1.5, 2.0):
            clamped = simulation.set_pose(0, (x, 0.5, 0), joint_positions=[0.3] * joints, velocities_mps=(1, 0))
            self.assertEqual(clamped, 0)
            frame = simulation.step()
            numpy.testing.assert_allclose(frame.positions_m[0], (x, 0.5, 0), atol=1e-6)
            numpy.testing.assert_allclose(frame.joint_positions[:joints], 0.3, atol=1e-6)
        self.assertGreater(simulation.set_pose(0, (100, 0, 0)), 0)  # outside the ground of the scene
        with self.assertRaises(throng.InputError):
            simulation.set_pose(0, (1, 0, 0), joint_positions=[0.1] * (joints + 1))

    def test_reject_poses_of_simulated_people(self):
        simulation = throng.Simulation("corridor")
        with self.assertRaises(throng.InputError):
            simulation.set_pose(0, (0, 0, 0))

    def test_reject_invalid_poses(self):
        scene = self.folder / "robot.yaml"
        scene.write_text(CONTROLLED.format(model=SOURCES / "examples/picker.urdf"))
        simulation = throng.Simulation(scene)
        before = simulation.step().positions_m.copy()
        nan, inf = float("nan"), float("inf")
        joints = throng.Model(SOURCES / "examples/picker.urdf").joint_count
        for where, given in [
            ("positions_m", {"positions_m": (nan, 0, 0)}),
            ("positions_m", {"positions_m": (0, inf, 0)}),
            ("positions_m", {"positions_m": (0, 0)}),
            ("positions_m", {"positions_m": "abc"}),
            ("rotations_xyzw", {"rotations_xyzw": (0, 0, 0, 0)}),
            ("rotations_xyzw", {"rotations_xyzw": (0, 0, 1e-9, 0)}),
            ("rotations_xyzw", {"rotations_xyzw": (0, 0, nan, 1)}),
            ("rotations_xyzw", {"rotations_xyzw": (0, 0, -inf, 1)}),
            ("rotations_xyzw", {"rotations_xyzw": (0, 0, 1)}),
            ("joint_positions", {"joint_positions": [nan] * joints}),
            ("joint_positions", {"joint_positions": [0.1] * (joints + 1)}),
            ("joint_positions", {"joint_positions": ["a"] * joints}),
            ("velocities_mps", {"velocities_mps": (nan, 0)}),
            ("velocities_mps", {"velocities_mps": (0, 0, 0)}),
            ("velocities_mps", {"velocities_mps": (1j, 0)}),
            ("ids", {"ids": -1}),
            ("ids", {"ids": 1}),
            ("ids", {"ids": 0.5}),
            ("ids", {"ids": "robot"}),
        ]:
            with self.subTest(given=given), self.assertRaisesRegex(throng.InputError, f"^{where}(\\[0\\])?: expected .*found "):
                simulation.set_pose(**{"ids": 0, "positions_m": (0, 0, 0), **given})
        numpy.testing.assert_array_equal(simulation.step().positions_m, before)
        self.assertEqual(simulation.set_pose(0, (1, 0, 0), (0, 0, 1e300, 1e300)), 0)
        rotation = simulation.step().rotations_xyzw[0]
        numpy.testing.assert_allclose(rotation, (0, 0, 0.5**0.5, 0.5**0.5), atol=1e-6)

    def crowd(self, **options):
        """A room with people to add, and five who are moved from outside."""
        room = throng.Area(min_m=[-10, -10], max_m=[10, 10])
        people = throng.Group(name="people", count=20, spare=30, spawn=room, goals=[room])
        guided = throng.Group(name="guided", count=5, spawn=room, externally_controlled=True)
        pillar = throng.Obstacle(name="pillar", kind="box", position_m=[0, 0], size_m=[1, 1, 2])
        scene = throng.Scene(name="room", ground=room, groups=[people, guided], obstacles=[pillar])
        return throng.Simulation(scene, **options)

    def test_add_redirect_and_remove_people(self):
        simulation = self.crowd(exact=True)
        self.assertEqual(simulation.step().present.sum(), 25)
        alone = simulation.add("people", (3, 4))
        self.assertIsInstance(alone, int)
        ids = simulation.add("people", [[5, 5], [6, 5]], headings_rad=[0, 1], speeds_mps=1)
        numpy.testing.assert_array_equal(ids, [alone + 1, alone + 2])
        frame = simulation.step()
        self.assertTrue(frame.present[[alone, *ids]].all())
        numpy.testing.assert_allclose(frame.positions_m[ids[0]], (5 + simulation.step_s, 5, 0), atol=1e-9)
        numpy.testing.assert_allclose(frame.headings_rad[ids], (0, 1), atol=1e-6)
        corner = throng.Area(min_m=[-9, -9], max_m=[-8, -8])
        simulation.set_goal(ids, corner)
        simulation.set_desired_speed(ids, [2, 2])
        before = numpy.linalg.norm(frame.positions_m[ids] - (-8.5, -8.5, 0), axis=1)
        for _ in range(240):
            frame = simulation.step()
        after = numpy.linalg.norm(frame.positions_m[ids] - (-8.5, -8.5, 0), axis=1)
        self.assertTrue((before - after > 4).all())
        simulation.remove(ids)
        self.assertTrue(frame.present[ids].all(), "the latest frame stays as it is")
        self.assertFalse(simulation.step().present[ids].any())
        self.assertEqual(simulation.add("people", (3, 4)), ids[-1] + 1, "ids are never reused")

    def test_people_in_contact_that_are_removed_end_their_contacts(self):
        simulation = self.crowd(exact=True)
        a, b = simulation.add("people", [[5, 5], [5.25, 5]], headings_rad=[0, 1.5])
        contacts = simulation.step().pairs
        self.assertGreater(((contacts["body_a"] == a) & (contacts["body_b"] == b)).sum(), 0)
        simulation.remove(a)
        events = simulation.step().events
        ended = (events["body_a"] == a) & (events["kind"] == 1)
        self.assertEqual(ended.sum(), ((contacts["body_a"] == a) | (contacts["body_b"] == a)).sum())

    def test_reject_changes_without_effect(self):
        simulation = self.crowd()
        frame = simulation.step()
        there = frame.present.copy()
        guided = len(simulation.people) - 1
        for where, change in [
            ("positions_m\\[1\\]", lambda: simulation.add("people", [[5, 5], [0, 0]])),
            ("positions_m\\[0\\]", lambda: simulation.add("people", (11, 0))),
            ("positions_m\\[0\\]", lambda: simulation.add("people", (float("nan"), 0))),
            ("positions_m", lambda: simulation.add("people", (1, 2, 3))),
            ("headings_rad", lambda: simulation.add("people", [[5, 5], [4, 4]], headings_rad=[1, 2, 3])),
            ("speeds_mps\\[0\\]", lambda: simulation.add("people", (5, 5), speeds_mps=-1)),
            ("group", lambda: simulation.add("peopel", (5, 5))),
            ("group 'people'", lambda: simulation.add("people", numpy.full((31, 2), 5.0))),
            ("ids\\[1\\]", lambda: simulation.remove([0, 25])),
            ("ids\\[0\\]", lambda: simulation.remove(-1)),
            ("ids", lambda: simulation.remove([3, 3])),
            ("ids\\[0\\]", lambda: simulation.set_goal(guided, throng.Area(min_m=[1, 1], max_m=[2, 2]))),
            ("goal:1", lambda: simulation.set_goal(0, throng.Area(min_m=[20, 1], max_m=[22, 2]))),
            ("goal", lambda: simulation.set_goal(0, throng.Goal(min_m=[1, 1], max_m=[2, 2], capacity=1))),
            ("mps\\[0\\]", lambda: simulation.set_desired_speed(0, 9)),
            ("ids\\[0\\]", lambda: simulation.set_desired_speed(guided, 1)),
            ("ids\\[0\\]", lambda: simulation.set_pose(30, (1, 1))),
            ("positions_m\\[1\\]", lambda: simulation.add("people", [[5, 5], [5.1, 5]])),
            ("positions_m\\[0\\]", lambda: simulation.add("people", frame.positions_m[3, :2])),
            ("headings_rad\\[0\\]", lambda: simulation.add("people", (5, 5), headings_rad=90)),
            ("mps", lambda: simulation.set_desired_speed([0, 1], [1, 1, 1])),
        ]:
            with self.assertRaisesRegex(throng.InputError, f"^{where}: expected .*found "):
                change()
        numpy.testing.assert_array_equal(simulation.step().present, there)
        with self.assertRaisesRegex(throng.InputError, "a scene with a crowd"):
            throng.Simulation("paper_350").remove(0)

    def test_same_changes_give_the_same_hash_and_a_saved_run_goes_on(self):
        def change(simulation):
            if simulation.next_frame == 10:
                simulation.add("people", [[4, 4], [4.3, 4.1]])
            if simulation.next_frame == 30:
                simulation.set_goal(range(10), throng.Area(min_m=[3, 3], max_m=[5, 5]))
            if simulation.next_frame == 60:
                simulation.remove([1, 3])

        hashes, state = [], None
        for threads in (1, 3):
            simulation = self.crowd(threads=threads, exact=True)
            for number in range(120):
                change(simulation)
                if number == 60:
                    state = simulation.save()
                frame = simulation.step()
            hashes.append(frame.hash)
        rest = self.crowd(exact=True).resume(state)
        while rest.next_frame < 120:
            frame = rest.step()
        self.assertEqual({*hashes, frame.hash}, {hashes[0]})

    def test_guided_people_walk_on_the_given_path(self):
        simulation = self.crowd()
        frame = simulation.step()
        ids = numpy.arange(len(simulation.people) - 5, len(simulation.people))
        at = numpy.column_stack([numpy.linspace(-8, -4, 5), numpy.linspace(3, 8, 5)])
        joints = []
        for _ in range(90):
            at[:, 0] += 1.2 * simulation.step_s
            self.assertEqual(simulation.set_pose(ids, at), 0)
            frame = simulation.step()
            joints.append(frame.joint_positions[simulation.joint_offsets[ids[0]] : simulation.joint_offsets[ids[0] + 1]])
        numpy.testing.assert_allclose(frame.positions_m[ids, :2], at, atol=1e-9)
        numpy.testing.assert_allclose(frame.speeds_mps[ids], 1.2, atol=1e-3)
        self.assertGreater(numpy.ptp(joints, axis=0).max(), 0.5, "legs swing")
        self.assertEqual(simulation.step().speeds_mps[ids].max(), 0, "they stand without a call")
        for _ in range(60):  # a quarter turn, by a quaternion of another length
            simulation.set_pose(ids, at, rotations_xyzw=(0, 0, 2, 2))
            frame = simulation.step()
        numpy.testing.assert_allclose(frame.headings_rad[ids], numpy.pi / 2, atol=0.5)  # trunks adapt
        simulation.set_pose(ids, numpy.column_stack([at, numpy.zeros(5)]), gait=False)
        numpy.testing.assert_allclose(simulation.step().positions_m[ids, :2], at, atol=1e-9)

    def test_reject_the_state_of_another_run(self):
        options = dict(avatars=60, seed=3, steering="collision_free_speed", part_volume="ordop18", exact=False)
        saved = throng.Simulation("plaza", **options)
        for _ in range(3):
            saved.step()
        state = saved.save()
        for other in (
            {"seed": 4},
            {"avatars": 61},
            {"steering": "orca"},
            {"part_volume": "obb"},
            {"part_volume": "hands: sphere, default: ordop18"},
            {"exact": True},
            {"filter_groups": "people: obstacles"},
            {"filter_parts": "hands: head"},
            {"proximity": 0.1},
            {"closest_parts": 0.1},
            {"budget_tests": 1000},
            {"strategy": "two-pass"},
            {"culling": False},
        ):
            with self.subTest(other=other), self.assertRaisesRegex(throng.InputError, "^state: expected .* this run"):
                throng.Simulation("plaza", **{**options, **other}).resume(state)
        with self.assertRaisesRegex(throng.InputError, "this run"):
            throng.Simulation("corridor").resume(state)
        for damaged in (state[:-1], state[:100], state[:200] + bytes([state[200] ^ 1]) + state[201:], b"", None, "a"):
            with self.subTest(damaged=damaged and len(damaged)), self.assertRaisesRegex(throng.InputError, "^state: "):
                throng.Simulation("plaza", **options).resume(damaged)
        for same in ({"threads": 2}, {"pair_search": "sweep"}, {"simd": "scalar"}, {"joint_positions": False}, {"seconds": 99}):
            simulation = throng.Simulation("plaza", **{**options, **same})
            simulation.resume(bytearray(state))
            self.assertEqual(simulation.next_frame, 3)

    def test_reject_a_state_beyond_their_end(self):
        options = dict(avatars=10, seed=3)
        longer = throng.Simulation("plaza", seconds=2, **options)
        for _ in range(13):
            longer.step()
        state = longer.save()
        expected = "^state: expected a state of a run of 12 frames, found one after 13 frames; increase seconds$"
        with self.assertRaisesRegex(throng.InputError, expected):
            throng.Simulation("plaza", seconds=0.2, **options).resume(state)
        whole = throng.Simulation("plaza", seconds=13 / 60, **options)
        whole.resume(state)
        self.assertEqual((whole.next_frame, list(whole)), (13, []))

    def test_save_checkpoints_of_the_command(self):
        simulation = throng.Simulation("corridor", seed=5)
        for _ in range(6):
            simulation.step()
        (self.folder / "six.checkpoint").write_bytes(simulation.save())
        words = ["--seed", 5, "--seconds", 0.2, "--resume", "six.checkpoint"]
        self.assertEqual(command_hash("corridor", *words, folder=self.folder), command_hash("corridor", *words[:4], folder=self.folder))

    def test_raise_without_a_requested_table(self):
        frame = throng.Simulation("corridor", exact=True).step()
        for name, option in (("proximity", "proximity=M"), ("closest_parts", "closest_parts=M"), ("contact_points", "contact_points=True")):
            with self.subTest(name=name), self.assertRaisesRegex(RuntimeError, option):
                getattr(frame, name)
        near = throng.Simulation("corridor", proximity=0.2).step()
        self.assertGreaterEqual(len(near.proximity), 0)
        with self.assertRaisesRegex(RuntimeError, "closest_parts=M"):
            near.closest_parts

    def test_write_a_log_that_holds_the_changes_and_is_culled_again(self):
        log, rows = self.folder / "changes.lcmlog", self.folder / "changes.csv"
        simulation = self.crowd(seconds=1, log=log, exact=True)
        for frame in simulation:
            if frame.number == 9:
                ids = simulation.add("people", [[5, 5], [6, 6]])
            if frame.number == 20:
                simulation.set_goal(ids, throng.Area(min_m=[1, 1], max_m=[2, 2]))
            if frame.number == 30:
                simulation.remove(ids)
        self.assertIn("sound", command("check", log, folder=self.folder))
        command("export", log, "--csv", "changes", "--out", rows, folder=self.folder)
        lines = rows.read_text().splitlines()
        self.assertEqual(len(lines), 7, "two agents each")
        changes = throng.export(log, "changes")
        self.assertEqual(list(changes["group"]), ["people", "people", "", "", "", ""])
        self.assertEqual(list(changes["avatar"][:2]), list(ids))
        self.assertEqual(len(throng.run(log).people), len(simulation.people))

    def test_reject_options_of_complete_runs(self):
        for option in ({"view": True}, {"progress": True}):
            with self.subTest(option=option), self.assertRaisesRegex(throng.InputError, f"^{list(option)[0]}: expected "):
                throng.Simulation("corridor", **option)

    def test_reject_unknown_people(self):
        frame = throng.Simulation("corridor", avatars=10).step()
        for people in ([-1], [0.5], ["a"], [[1]], [numpy.nan], [2**70]):
            with self.subTest(people=people), self.assertRaisesRegex(throng.InputError, "^people"):
                frame.part_poses(people)
        for person in (10, 2**62):
            with self.assertRaisesRegex(throng.InputError, rf"^people\[1\]: expected an id from 0 to 9, found {person}$"):
                frame.part_poses([3, person])
        self.assertEqual(frame.part_poses(numpy.array([3.0, 4])).shape[0], 2)
        self.assertEqual(frame.part_poses(i for i in (1, 2)).shape[0], 2)


class Arrays(Case):
    def test_keep_their_values_after_later_steps(self):
        simulation = throng.Simulation("corridor")
        kept, copies = [], []
        for _ in range(30):
            frame = simulation.step()
            kept.append((frame.positions_m, frame.headings_rad[3:], frame.present, frame.pairs, frame.events, frame.joint_positions))
            copies.append([array.copy() for array in kept[-1]])
        for arrays, expected in zip(kept, copies):
            for array, copy in zip(arrays, expected):
                numpy.testing.assert_array_equal(array, copy)
        self.assertTrue((kept[0][0] != kept[-1][0]).any())

    def test_outlive_the_simulation(self):
        simulation = throng.Simulation("corridor")
        part = simulation.step().positions_m[5:7, :2]
        copy = part.copy()
        del simulation
        gc.collect()
        blocks = [numpy.zeros(100_000) for _ in range(20)]  # would reuse freed memory
        numpy.testing.assert_array_equal(part, copy)
        del blocks

    def test_reuse_unreferenced_buffers(self):
        simulation = throng.Simulation("corridor")
        places = set()
        for _ in range(10):
            places.add(simulation.step().positions_m.__array_interface__["data"][0])
        self.assertEqual(len(places), 1)

    def test_are_read_only(self):
        frame = throng.Simulation("corridor").step()
        with self.assertRaises(ValueError):
            frame.positions_m[0] = 0

    def test_of_an_earlier_frame_are_rejected(self):
        simulation = throng.Simulation("corridor")
        frame = simulation.step()
        frame.positions_m
        simulation.step()
        for ask in ("positions_m", "pairs", "events", "speeds_mps", "hash"):
            with self.subTest(ask=ask), self.assertRaisesRegex(RuntimeError, "frame 0 is not the latest frame"):
                getattr(frame, ask)
        with self.assertRaisesRegex(RuntimeError, "frame 0 is not the latest frame"):
            frame.part_poses([0])

    def test_of_the_last_frame_outlive_the_end_of_the_run(self):
        simulation = throng.Simulation("corridor", seconds=0.5)
        for frame in simulation:
            pairs = frame.pairs
        ends = simulation.finish()
        self.assertEqual(len(ends), len(pairs))
        with self.assertRaisesRegex(RuntimeError, "finished"):
            simulation.step()
        with self.assertRaises(RuntimeError):
            frame.pairs

    def test_of_missing_joint_positions_are_rejected(self):
        frame = throng.Simulation("corridor", joint_positions=False).step()
        with self.assertRaisesRegex(RuntimeError, "joint_positions=False"):
            frame.joint_positions


class Threads(Case):
    def test_that_step_concurrently_are_rejected_without_loss(self):
        simulation = throng.Simulation("plaza", avatars=3000, threads=1)
        numbers, rejected = [], []

        def step():
            for _ in range(15):
                try:
                    numbers.append(simulation.step().number)
                except RuntimeError as error:
                    rejected.append(str(error))

        threads = [threading.Thread(target=step) for _ in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(sorted(numbers), list(range(len(numbers))))
        self.assertEqual(len(numbers) + len(rejected), 45)
        self.assertTrue(all("thread" in why or "over" in why for why in rejected))

    def test_may_read_arrays_while_another_steps(self):
        simulation = throng.Simulation("plaza", threads=2)
        array = simulation.step().positions_m
        expected = array.copy()
        thread = threading.Thread(target=lambda: [simulation.step() for _ in range(50)])
        thread.start()
        while thread.is_alive():
            numpy.testing.assert_array_equal(array, expected)
        thread.join()


if __name__ == "__main__":
    unittest.main()
