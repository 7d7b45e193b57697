"""A run in Python equals that of the command."""

import copy
import json
import pickle
import sqlite3
import subprocess
import sys
import threading
import unittest

import numpy
import throng
from expectations import SLOWNESS, SOURCES, Case, command, command_hash


class Runs(Case):
    def test_have_the_hash_of_the_command(self):
        for scene, options, words in [
            ("plaza", {"seconds": 2, "seed": 3}, ["--seconds", "2", "--seed", "3"]),
            ("corridor", {"seconds": 1, "exact": True}, ["--seconds", "1", "--exact"]),
            (
                "crossing",
                {"seconds": 1, "avatars": 80, "steering": "orca", "part_volume": "obb"},
                ["--seconds", "1", "--avatars", "80", "--steering", "orca", "--part-volume", "obb"],
            ),
            ("plaza", {"seconds": 0.2, "budget_tests": 50}, ["--seconds", "0.2", "--budget-tests", "50"]),
            ("paper_50", {"seconds": 0.2, "strategy": "two-pass"}, ["--seconds", "0.2", "--strategy", "two-pass"]),
        ]:
            with self.subTest(scene=scene):
                self.assertEqual(throng.run(scene, **options).hash, command_hash(scene, *words, folder=self.folder))

    def test_are_independent_of_the_number_of_threads(self):
        one, three = (throng.run("corridor", seconds=1, threads=n) for n in (1, 3))
        self.assertEqual(one.hash, three.hash)
        self.assertSameTable(one.events, three.events)
        self.assertSameTable(one.trajectories, three.trajectories)

    def test_have_a_contact_for_each_begin_and_end(self):
        run = throng.run("plaza", seconds=4)
        begins = run.events[run.events["kind"] == 0]
        self.assertGreater(len(run.contacts), 20)
        self.assertEqual(len(run.contacts), len(begins))
        self.assertEqual(len(run.events), 2 * len(begins))
        for name in ("body_a", "body_b", "part_a", "part_b"):
            numpy.testing.assert_array_equal(run.contacts[name], begins[name])
        self.assertTrue((run.contacts["body_a"] < run.contacts["body_b"]).all())
        self.assertTrue((run.contacts["end_s"] > run.contacts["begin_s"]).all())
        lasting = run.contacts["ended"] == 0
        self.assertEqual(lasting.sum(), run.counters["touching"][-1])

    def test_count_events_and_contacts_per_frame(self):
        run = throng.run("plaza", seconds=1)
        frames = numpy.arange(len(run.counters))
        numpy.testing.assert_array_equal(run.counters["frame"], frames)
        for kind, column in ((0, "begins"), (1, "ends")):
            of_kind = run.events["frame"][run.events["kind"] == kind]
            numpy.testing.assert_array_equal(numpy.bincount(of_kind, minlength=len(frames) + 1)[:-1], run.counters[column])
        running = numpy.cumsum(run.counters["begins"] - run.counters["ends"])
        numpy.testing.assert_array_equal(run.counters["touching"], running)

    def test_report_separation_like_the_command(self):
        scene = self.folder / "cell.yaml"
        people = "{name: people, count: 6, spawn: {min_m: [-3, -2], max_m: [5, 2]}, goals: [{min_m: [-5, -2], max_m: [-4, 2]}]}"
        picker = (
            f"{{name: picker, model: {SOURCES}/examples/picker.urdf, count: 1, radius_m: 0.5, desired_speed_mps: 0.6,"
            " spawn: {min_m: [-4, -0.5], max_m: [-3, 0.5]}, goals: [{min_m: [4, -0.5], max_m: [5, 0.5]}]}"
        )
        scene.write_text(
            "name: cell\nstep_s: 1/30\nduration_s: 5\nproximity_m: 1.5\nculling: {exact: true}\n"
            f"ground: {{min_m: [-6, -3], max_m: [6, 3]}}\ngroups:\n  - {picker}\n  - {people}\n"
            "separation: {reaction_s: 0.1, stopping_s: 0.3, intrusion_m: 0.1, human_uncertainty_m: 0.05, robot_uncertainty_m: 0.02}\n"
        )
        written, reference = (self.folder / name for name in ("python", "command"))
        run = throng.run(scene, separation=written)
        found = run.separation
        self.assertIn("separation", run.notes[0])
        self.assertEqual(throng.Simulation(scene).notes, run.notes)
        words = ["run", str(scene), "--lcm", "off", "--log", "off", "--separation", str(reference), "--json", "-"]
        expected = json.loads(command(*words, folder=self.folder))["separation"]
        self.assertGreater(found["shortfalls"], 0)
        for name in ("robots", "shortfalls", "pairs", "undetermined", "beyond_margin"):
            self.assertEqual(found[name], expected[name], name)
        self.assertEqual(found["regions"].keys(), expected["regions"].keys())
        for name, region in expected["regions"].items():
            self.assertEqual(found["regions"][name]["shortfalls"], region["shortfalls"], name)
        for file in ("separation.csv", "shortfalls.csv"):
            self.assertEqual((written / file).read_bytes(), (reference / file).read_bytes(), file)
        self.assertIsNone(throng.run("plaza", seconds=0.1).separation)
        with self.assertRaisesRegex(throng.InputError, "separation.*expected a scene with a 'separation'"):
            throng.run("plaza", separation=written)

    def test_have_the_positions_of_a_trajectory_file(self):
        file = self.folder / "path.sqlite"
        run = throng.run("corridor", seconds=1, trajectory=file, trajectory_fps=20)
        with sqlite3.connect(file) as database:
            rows = database.execute("select frame, id, pos_x, pos_y from trajectory_data order by frame, id").fetchall()
        self.assertEqual(len(rows), len(run.trajectories))
        expected = numpy.array(rows)
        numpy.testing.assert_allclose(run.trajectories["x_m"], expected[:, 2], atol=1e-6)
        numpy.testing.assert_allclose(run.trajectories["y_m"], expected[:, 3], atol=1e-6)

    def test_write_the_chosen_piece_of_the_walkable_area(self):
        file = self.folder / "ring.sqlite"
        with self.assertRaisesRegex(throng.InputError, "^trajectory_area: expected .*, found 2 pieces"):
            throng.run("ring", seconds=0.1, trajectory=file)
        for piece in ("largest", 1, 2):
            throng.run("ring", seconds=0.1, trajectory=file, trajectory_area=piece)
            with sqlite3.connect(file) as database:
                ((wkt,),) = database.execute("select wkt from geometry").fetchall()
            self.assertRegex(wkt, r"^POLYGON \(\(")

    def test_write_the_files_of_the_command(self):
        throng.run("plaza", seconds=1, contacts=self.folder / "python", trace_hash=self.folder / "python.txt")
        command("run", "plaza", "--seconds", 1, "--lcm", "off", "--log", "off", "--contacts", "command",
                "--trace-hash", "command.txt", folder=self.folder)
        for name in ("contacts.csv", "part_contacts.csv"):
            reference = self.folder / "command" / name
            if reference.exists():
                self.assertEqual((self.folder / "python" / name).read_bytes(), reference.read_bytes())
        self.assertTrue((self.folder / "command" / "contacts.csv").exists())
        self.assertEqual((self.folder / "python.txt").read_bytes(), (self.folder / "command.txt").read_bytes())

    def test_name_bodies_parts_and_groups(self):
        run = throng.run("plaza", seconds=0.5)
        self.assertIn("rightFoot", run.names.parts[0])
        contact = run.contacts[run.contacts["body_b"] >= len(run.people)][:1]
        self.assertIn(run.names.part(contact["body_b"], contact["part_b"])[0], run.names.obstacles)
        self.assertEqual(len(run.names.groups), len(set(run.people["group"])))

    def test_reject_unknown_bodies_and_parts(self):
        run = throng.run("plaza", seconds=0.1)
        names, bodies, parts = run.names, len(run.people) + len(run.names.obstacles), len(run.names.parts[0])
        self.assertEqual(list(names.part([0, 0, bodies - 1, bodies - 1], [parts - 1, 255.0, 0, 255])),
                         [names.parts[0][-1], "whole body", names.obstacles[-1], names.obstacles[-1]])
        self.assertEqual(len(names.part([], [])), 0)
        for where, given in [
            (r"bodies\[1\]", ([0, -1], [0, 0])),
            (r"bodies\[0\]", ([bodies], [0])),
            (r"bodies\[0\]", ([0.5], [0])),
            (r"bodies\[0\]", ([numpy.nan], [0])),
            (r"bodies\[0\]", ([2**70], [0])),
            ("bodies", (["a"], [0])),
            ("bodies", (0, [0])),
            (r"parts\[1\]", ([0, 0], [0, -1])),
            (r"parts\[0\]", ([0], [parts])),
            (r"parts\[0\]", ([0], [256])),
            (r"parts\[0\]", ([bodies - 1], [1])),
            (r"parts\[0\]", ([0], [1.5])),
            ("parts", ([0], None)),
            ("bodies, parts", ([0, 1], [0])),
            ("bodies, parts", ([0, 1], [0, 1, 2])),
            ("bodies, parts", ([], [0])),
        ]:
            with self.subTest(given=given), self.assertRaisesRegex(throng.InputError, f"^{where}: expected .*, found "):
                names.part(*given)

    def test_convert_selected_columns_to_data_frames(self):
        run = throng.run("plaza", seconds=0.5)
        for table, columns, names in [
            (run.contacts, ["body_a", "body_b"], ["body_a_name", "body_a_is_person", "body_b_name", "body_b_is_person"]),
            (run.contacts, ["part_a", "part_b"], []),
            (run.contacts, ["body_a", "part_a", "begin_s"], ["body_a_name", "body_a_is_person", "part_a_name"]),
            (run.contacts, ["level"], ["level_name"]),
            (run.events, ["frame", "body_b", "part_b", "level"], ["body_b_name", "body_b_is_person", "part_b_name", "level_name"]),
            (run.people, ["id"], []),
            (run.people, ["id", "model"], ["model_name", "is_person"]),
            (run.people, ["group"], ["group_name"]),
        ]:
            with self.subTest(columns=columns):
                frame, whole = table[columns].to_pandas(), table.to_pandas()
                self.assertEqual(list(frame.columns), columns + names)
                for name in names:
                    self.assertEqual(list(frame[name]), list(whole[name]))

    def test_know_people_from_robots_and_obstacles(self):
        log = self.folder / "robots.lcmlog"
        run = throng.run("robot_in_crowd", seconds=2, exact=True, contact_points=True, log=log)
        robots = {i for i, name in enumerate(run.people.to_pandas().model_name) if name != "adult"}
        self.assertTrue(robots)
        for found in (run, throng.read_log(log)):
            self.assertEqual({i for i, is_person in enumerate(found.people.to_pandas().is_person) if not is_person}, robots)
            frame = found.contact_points.to_pandas()
            self.assertGreater(len(frame), 0)
            for side in "ab":
                bodies = frame[f"body_{side}"]
                expected = [body < len(run.people) and body not in robots for body in bodies]
                self.assertEqual(list(frame[f"body_{side}_is_person"]), expected)
            self.assertEqual(list(frame.columns[5:12]), ["point_x_m", "point_y_m", "point_z_m", "normal_x", "normal_y", "normal_z", "depth_m"])

    def test_hold_the_distances_of_all_frames(self):
        options = {"seconds": 0.5, "avatars": 80, "exact": True, "proximity": 0.2, "closest_parts": 0.5, "contact_points": True}
        file = self.folder / "plaza.lcmlog"
        run = throng.run("plaza", log=file, **options)
        log = throng.read_log(file)
        names = ("proximity", "closest_parts", "contact_points")
        rows = {name: [] for name in names}
        for frame in throng.Simulation("plaza", **options):
            for name in names:
                rows[name].append(numpy.array(getattr(frame, name)))
        for name in names:
            with self.subTest(table=name):
                whole = numpy.concatenate(rows[name])
                self.assertGreater(len(whole), 0)
                self.assertSameTable(getattr(run, name), whole)
                self.assertSameTable(getattr(log, name), whole)
        first = run.proximity.to_pandas().iloc[0]
        self.assertEqual(first.body_a_name, f"{run.people[first.body_a:first.body_a + 1].to_pandas().group_name[0]} {first.body_a}")
        self.assertEqual(len(throng.run("plaza", seconds=0.1, avatars=40).proximity), 0)

    def test_show_tables_in_notebooks(self):
        run = throng.run("corridor", seconds=1)
        shown = run.people._repr_html_()
        self.assertIn("<th>group_name</th>", shown)
        self.assertIn(f"<p>{len(run.people)} rows</p>", shown)
        self.assertLessEqual(shown.count("<tr>"), 22)
        self.assertIn("0 rows", run.proximity._repr_html_())

    def test_take_part_volumes_as_a_dictionary(self):
        options = {"seconds": 0.3, "avatars": 60}
        text = throng.run("plaza", part_volume="hands: sphere, default: obb", **options)
        self.assertEqual(throng.run("plaza", part_volume={"hands": "sphere", "default": "obb"}, **options).hash, text.hash)

    def test_convert_to_data_frames(self):
        try:
            import pandas
        except ImportError:
            self.skipTest("no pandas here")
        run = throng.run("plaza", seconds=0.5)
        frame = run.contacts.to_pandas()
        self.assertIsInstance(frame, pandas.DataFrame)
        self.assertEqual(len(frame), len(run.contacts))
        self.assertEqual(frame.part_a_name[0], run.names.parts[0][frame.part_a[0]])
        self.assertEqual(len(run.people.to_pandas()), 500)

    def test_can_be_pickled_with_names(self):
        run = throng.run("plaza", seconds=0.5)
        for again in (pickle.loads(pickle.dumps(run)), copy.deepcopy(run)):
            self.assertEqual((again.hash, again.run_id, again.summary, again.notes), (run.hash, run.run_id, run.summary, run.notes))
            for name in ("people", "events", "contacts", "trajectories", "counters"):
                self.assertSameTable(getattr(again, name), getattr(run, name))
            self.assertEqual(again.names.parts, run.names.parts)
            numpy.testing.assert_array_equal(
                again.names.part(again.contacts["body_a"], again.contacts["part_a"]),
                run.names.part(run.contacts["body_a"], run.contacts["part_a"]),
            )
            self.assertEqual(repr(again), repr(run))
        for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1):
            for table in (run.people, run.events[:10], run.contacts):
                again = pickle.loads(pickle.dumps(table, protocol))
                self.assertIsInstance(again, throng.Table)
                self.assertSameTable(again, table)
                self.assertEqual(list(again.to_pandas().columns), list(table.to_pandas().columns))
                self.assertTrue((again.to_pandas() == table.to_pandas()).all(axis=None) or table is run.contacts)

    def test_report_progress(self):
        calls = []
        run = throng.run("plaza", seconds=20 / SLOWNESS, progress=lambda done, frames: calls.append((done, frames)))
        self.assertTrue(calls)
        self.assertEqual(calls, sorted(set(calls)))
        self.assertTrue(all(0 <= done <= frames == len(run.counters) for done, frames in calls))

    def test_propagate_exceptions_of_progress(self):
        def enough(done, frames):
            raise LookupError("enough")

        with self.assertRaisesRegex(LookupError, "enough"):
            throng.run("plaza", seconds=3600, progress=enough)


INTERRUPTED = """
import signal, sys, time, threading, os
import numpy, throng
throng.run, throng.Simulation  # loads the compiled module
adult = throng.Model("adult")
def interrupt():
    time.sleep({after_s})
    print(time.monotonic(), flush=True)
    os.kill(os.getpid(), signal.SIGINT)
threading.Thread(target=interrupt, daemon=True).start()
try:
    {work}
except KeyboardInterrupt:
    print(time.monotonic(), flush=True)
"""


CROWDED = (
    "random = numpy.random.default_rng(1); points = random.normal(size=(60, 3));"
    "culler = throng.Culler(throng.Body([points]), threads=1); poses = numpy.tile(numpy.eye(4), (3000, 1, 1, 1))"
)


class CtrlC(Case):
    def seconds_to_stop(self, work, after_s):
        done = subprocess.run(
            [sys.executable, "-c", INTERRUPTED.format(work=work, after_s=after_s)],
            capture_output=True, text=True, cwd=self.folder, timeout=100 * SLOWNESS,
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        sent, raised = map(float, done.stdout.split())
        return raised - sent

    def test_raises_keyboard_interrupt_within_a_fraction_of_a_second(self):
        for work, after_s in [
            ("throng.run('plaza', seconds=36000)", 2.5 * SLOWNESS),
            ("for frame in throng.Simulation('plaza', seconds=36000): pass", 2.5 * SLOWNESS),
            ("throng.Simulation('city_square', avatars=100000)", 0.3),
            ("throng.compare('plaza', 'plaza', seconds=3600)", 2.5 * SLOWNESS),
            ("throng.study('plaza', seconds=3600, seeds=range(9))", 2.5 * SLOWNESS),
            # Steps of many seconds, which end by themselves or with the process.
            (CROWDED + "; [culler.step(poses) for _ in range(1000)]", 2.5 * SLOWNESS),
            ("[_ for _ in throng.Simulation('plaza', seconds=36000, exact=True, proximity=2, threads=1)]", 2.5 * SLOWNESS),
            ("joints = numpy.zeros((10**6, adult.joint_count)); [adult.poses(joints) for _ in range(100)]", 2.5 * SLOWNESS),
        ]:
            with self.subTest(work=work):
                self.assertLess(self.seconds_to_stop(work, after_s), 0.5 * SLOWNESS)

    def test_leaves_a_culler_busy_until_its_step_ends(self):
        code = CROWDED.replace("3000", "400") + """
import os, signal, threading, time
threading.Timer(0.05, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
try:
    culler.step(poses); time.sleep(1)
except KeyboardInterrupt:
    pass
while True:
    try:
        pairs = len(culler.pairs)
        break
    except RuntimeError as error:
        assert "interrupted" in str(error), error
        time.sleep(0.01)
print(culler.frame, pairs, len(culler.step(poses)))
"""
        done = subprocess.run([sys.executable, "-c", "import numpy, throng; " + code], capture_output=True, text=True)
        self.assertEqual(done.stdout.split(), ["1", str(400 * 399 // 2), "0"], done.stderr)

    def test_leaves_a_sound_log(self):
        self.seconds_to_stop("throng.run('plaza', seconds=36000, log='stopped.lcmlog')", 2.5 * SLOWNESS)
        self.assertTrue(throng.check(self.folder / "stopped.lcmlog"))


class Threads(Case):
    def test_run_python_during_a_run(self):
        counted = 0
        done = threading.Event()
        def work():
            throng.run("plaza", seconds=10 / SLOWNESS, threads=1)
            done.set()
        thread = threading.Thread(target=work)
        thread.start()
        while not done.wait(0.005):
            counted += 1
        thread.join()
        self.assertGreater(counted, 20)

    def test_may_each_run_a_scene(self):
        alone = throng.run("corridor", seconds=1).hash
        hashes = []
        threads = [threading.Thread(target=lambda: hashes.append(throng.run("corridor", seconds=1).hash)) for _ in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(hashes, [alone] * 3)


if __name__ == "__main__":
    unittest.main()
