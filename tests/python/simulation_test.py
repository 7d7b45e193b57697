"""Step by step: frames, arrays that stay what they are, one thread at a time."""

import gc
import threading
import unittest

import numpy
import throng
from expectations import SOURCES, Case, command_hash

DRIVEN = """name: driven robot
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

    def test_are_as_many_as_the_scene_lasts(self):
        self.assertEqual([frame.number for frame in throng.Simulation("corridor", seconds=0.1)], list(range(6)))

    def test_give_places_in_their_shapes(self):
        simulation = throng.Simulation("corridor", avatars=40)
        frame = simulation.step()
        self.assertEqual(frame.positions_m.shape, (40, 3))
        self.assertEqual(frame.positions_m.dtype, numpy.float64)
        self.assertEqual(frame.rotations_xyzw.shape, (40, 4))
        self.assertEqual(frame.present.dtype, bool)
        numpy.testing.assert_allclose(numpy.linalg.norm(frame.rotations_xyzw, axis=1), 1, atol=1e-5)
        heading = 2 * numpy.arctan2(frame.rotations_xyzw[:, 2], frame.rotations_xyzw[:, 3])
        numpy.testing.assert_allclose(numpy.cos(heading - frame.headings_rad), 1, atol=1e-5)
        self.assertEqual(len(frame.postures), simulation.posture_offsets[-1])

    def test_tell_where_everything_that_touches_does(self):
        options = dict(avatars=80, seconds=0.5, exact=True)
        rows, plain = 0, throng.Simulation("plaza", **options)
        for frame in throng.Simulation("plaza", contact_points=True, **options):
            self.assertEqual(frame.hash, plain.step().hash)
            for name in ("a", "b", "part_a", "part_b"):
                numpy.testing.assert_array_equal(frame.contact_points[name], frame.pairs[name])
            self.assertTrue((frame.contact_points["depth_m"] >= 0).all())
            self.assertTrue(numpy.isfinite(frame.contact_points["point_m"]).all())
            rows += len(frame.contact_points)
        self.assertGreater(rows, 0)
        with self.assertRaises(throng.InputError):
            throng.Simulation("plaza", contact_points=True)

    def test_pose_the_parts_as_kinematics_does(self):
        simulation = throng.Simulation("corridor", avatars=40)
        model = throng.Model("adult")
        frame = [simulation.step() for _ in range(20)][-1]
        joints = frame.postures.reshape(40, model.joint_count)
        expected = model.poses(joints, frame.positions_m, frame.rotations_xyzw, simulation.people["scale"])
        numpy.testing.assert_allclose(frame.part_poses(range(40)), expected, atol=1e-5)

    def test_go_on_where_another_was_saved(self):
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

    def test_drive_a_robot_where_it_is_told_to_be(self):
        scene = self.folder / "robot.yaml"
        scene.write_text(DRIVEN.format(model=SOURCES / "examples/picker.urdf"))
        simulation = throng.Simulation(scene)
        joints = throng.Model(SOURCES / "examples/picker.urdf").joint_count
        simulation.step()
        for x in (1.0, 1.5, 2.0):
            clamped = simulation.drive(0, (x, 0.5, 0), joints=[0.3] * joints, velocity_mps=(1, 0))
            self.assertEqual(clamped, 0)
            frame = simulation.step()
            numpy.testing.assert_allclose(frame.positions_m[0], (x, 0.5, 0), atol=1e-6)
            numpy.testing.assert_allclose(frame.postures[:joints], 0.3, atol=1e-6)
        self.assertGreater(simulation.drive(0, (100, 0, 0)), 0)  # off the ground of the scene
        with self.assertRaises(throng.InputError):
            simulation.drive(0, (1, 0, 0), joints=[0.1] * (joints + 1))

    def test_drive_nobody_who_walks(self):
        simulation = throng.Simulation("corridor")
        with self.assertRaises(throng.InputError):
            simulation.drive(0, (0, 0, 0))

    def test_drive_nowhere_that_is_no_place(self):
        scene = self.folder / "robot.yaml"
        scene.write_text(DRIVEN.format(model=SOURCES / "examples/picker.urdf"))
        simulation = throng.Simulation(scene)
        before = simulation.step().positions_m.copy()
        nan, inf = float("nan"), float("inf")
        joints = throng.Model(SOURCES / "examples/picker.urdf").joint_count
        for where, given in [
            ("position_m", {"position_m": (nan, 0, 0)}),
            ("position_m", {"position_m": (0, inf, 0)}),
            ("position_m", {"position_m": (0, 0)}),
            ("position_m", {"position_m": "abc"}),
            ("rotation_xyzw", {"rotation_xyzw": (0, 0, 0, 0)}),
            ("rotation_xyzw", {"rotation_xyzw": (0, 0, 1e-9, 0)}),
            ("rotation_xyzw", {"rotation_xyzw": (0, 0, nan, 1)}),
            ("rotation_xyzw", {"rotation_xyzw": (0, 0, -inf, 1)}),
            ("rotation_xyzw", {"rotation_xyzw": (0, 0, 1)}),
            ("joints", {"joints": [nan] * joints}),
            ("joints", {"joints": [0.1] * (joints + 1)}),
            ("joints", {"joints": ["a"] * joints}),
            ("velocity_mps", {"velocity_mps": (nan, 0)}),
            ("velocity_mps", {"velocity_mps": (0, 0, 0)}),
            ("velocity_mps", {"velocity_mps": (1j, 0)}),
            ("avatar", {"avatar": -1}),
            ("avatar", {"avatar": 1}),
            ("avatar", {"avatar": 0.5}),
            ("avatar", {"avatar": "robot"}),
        ]:
            with self.subTest(given=given), self.assertRaisesRegex(throng.InputError, f"^{where}: expected .*found "):
                simulation.drive(**{"avatar": 0, "position_m": (0, 0, 0), **given})
        numpy.testing.assert_array_equal(simulation.step().positions_m, before)
        self.assertEqual(simulation.drive(0, (1, 0, 0), (0, 0, 1e300, 1e300)), 0)
        rotation = simulation.step().rotations_xyzw[0]
        numpy.testing.assert_allclose(rotation, (0, 0, 0.5**0.5, 0.5**0.5), atol=1e-6)

    def test_do_not_go_on_where_another_run_was_saved(self):
        options = dict(avatars=60, seed=3, steering="speed", part_volume="ordop18", exact=False)
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
            {"between": "people: obstacles"},
            {"parts": "hands: head"},
            {"near": 0.1},
            {"person_near": 0.1},
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
        for same in ({"threads": 2}, {"pair_search": "sweep"}, {"simd": "scalar"}, {"postures": False}, {"seconds": 99}):
            simulation = throng.Simulation("plaza", **{**options, **same})
            simulation.resume(bytearray(state))
            self.assertEqual(simulation.next_frame, 3)

    def test_resume_no_state_beyond_their_end(self):
        options = dict(avatars=10, seed=3)
        longer = throng.Simulation("plaza", seconds=2, **options)
        for _ in range(13):
            longer.step()
        state = longer.save()
        expected = "^state: expected one of a run of 12 frames, found one of which 13 are done; ask for more seconds$"
        with self.assertRaisesRegex(throng.InputError, expected):
            throng.Simulation("plaza", seconds=0.2, **options).resume(state)
        whole = throng.Simulation("plaza", seconds=13 / 60, **options)
        whole.resume(state)
        self.assertEqual((whole.next_frame, list(whole)), (13, []))

    def test_save_what_the_command_resumes(self):
        simulation = throng.Simulation("corridor", seed=5)
        for _ in range(6):
            simulation.step()
        (self.folder / "six.checkpoint").write_bytes(simulation.save())
        words = ["--seed", 5, "--seconds", 0.2, "--resume", "six.checkpoint"]
        self.assertEqual(command_hash("corridor", *words, folder=self.folder), command_hash("corridor", *words[:4], folder=self.folder))

    def test_have_no_table_of_what_they_do_not_look_for(self):
        frame = throng.Simulation("corridor", exact=True).step()
        for name, option in (("near", "near=M"), ("closest_parts", "person_near=M"), ("contact_points", "contact_points=True")):
            with self.subTest(name=name), self.assertRaisesRegex(RuntimeError, option):
                getattr(frame, name)
        near = throng.Simulation("corridor", near=0.2).step()
        self.assertGreaterEqual(len(near.near), 0)
        with self.assertRaisesRegex(RuntimeError, "person_near"):
            near.closest_parts

    def test_take_no_file_to_write(self):
        for option in ({"log": "a.lcmlog"}, {"html": "a.html"}, {"trajectory": "a.csv"}, {"states_hz": 3}):
            with self.subTest(option=option), self.assertRaisesRegex(throng.InputError, f"^{list(option)[0]}: expected "):
                throng.Simulation("corridor", **option)

    def test_pose_nobody_who_is_not_there(self):
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
    def test_stay_as_they_are_when_the_simulation_goes_on(self):
        simulation = throng.Simulation("corridor")
        kept, copies = [], []
        for _ in range(30):
            frame = simulation.step()
            kept.append((frame.positions_m, frame.headings_rad[3:], frame.present, frame.pairs, frame.events, frame.postures))
            copies.append([array.copy() for array in kept[-1]])
        for arrays, expected in zip(kept, copies):
            for array, copy in zip(arrays, expected):
                numpy.testing.assert_array_equal(array, copy)
        self.assertTrue((kept[0][0] != kept[-1][0]).any())

    def test_stay_when_the_simulation_is_gone(self):
        simulation = throng.Simulation("corridor")
        part = simulation.step().positions_m[5:7, :2]
        copy = part.copy()
        del simulation
        gc.collect()
        blocks = [numpy.zeros(100_000) for _ in range(20)]  # would take what had been freed
        numpy.testing.assert_array_equal(part, copy)
        del blocks

    def test_are_used_again_once_nobody_holds_them(self):
        simulation = throng.Simulation("corridor")
        places = set()
        for _ in range(10):
            places.add(simulation.step().positions_m.__array_interface__["data"][0])
        self.assertEqual(len(places), 1)

    def test_cannot_be_written_to(self):
        frame = throng.Simulation("corridor").step()
        with self.assertRaises(ValueError):
            frame.positions_m[0] = 0

    def test_of_a_frame_that_is_over_are_refused(self):
        simulation = throng.Simulation("corridor")
        frame = simulation.step()
        frame.positions_m
        simulation.step()
        for ask in ("positions_m", "pairs", "events", "speeds_mps", "hash"):
            with self.subTest(ask=ask), self.assertRaisesRegex(RuntimeError, "frame 0 is over"):
                getattr(frame, ask)
        with self.assertRaisesRegex(RuntimeError, "frame 0 is over"):
            frame.part_poses([0])

    def test_of_a_frame_outlive_the_run_s_end(self):
        simulation = throng.Simulation("corridor", seconds=0.5)
        for frame in simulation:
            pairs = frame.pairs
        ends = simulation.finish()
        self.assertEqual(len(ends), len(pairs))
        with self.assertRaisesRegex(RuntimeError, "finished"):
            simulation.step()
        with self.assertRaises(RuntimeError):
            frame.pairs

    def test_of_nobody_s_joints_are_refused(self):
        frame = throng.Simulation("corridor", postures=False).step()
        with self.assertRaisesRegex(RuntimeError, "postures=False"):
            frame.postures


class Threads(Case):
    def test_that_step_at_once_are_refused_and_nothing_is_lost(self):
        simulation = throng.Simulation("plaza", avatars=3000, threads=1)
        numbers, refused = [], []

        def step():
            for _ in range(15):
                try:
                    numbers.append(simulation.step().number)
                except RuntimeError as error:
                    refused.append(str(error))

        threads = [threading.Thread(target=step) for _ in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(sorted(numbers), list(range(len(numbers))))
        self.assertEqual(len(numbers) + len(refused), 45)
        self.assertTrue(all("thread" in why or "over" in why for why in refused))

    def test_may_look_at_arrays_while_another_steps(self):
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
