"""A study in Python has the rows of the command."""

import os
import pickle
import subprocess
import sys
import threading
import unittest

import numpy
import throng
from expectations import SLOWNESS, Case, command

TEXT = """scenes: [corridor, bottleneck]
seeds: [1, 2]
seconds: 0.4
parameters:
  avatars: [20, 30]
"""


def small(**options):
    return throng.study(["corridor", "bottleneck"], seeds=[1, 2], seconds=0.4, parameters={"avatars": [20, 30]}, **options)


def hall(**keys):
    goal = throng.Area(min_m=[17, 1], max_m=[19, 7])
    walkers = throng.Group(name="walkers", count=12, spawn=[[1, 1], [8, 1], [8, 7], [1, 7]], goals=[goal])
    return throng.Scene(ground=[[0, 0], [20, 0], [20, 8], [0, 8]], groups=[walkers], **keys)


class Studies(Case):
    def setUp(self):
        super().setUp()
        before = os.getcwd()
        os.chdir(self.folder)
        self.addCleanup(os.chdir, before)
        (self.folder / "study.yaml").write_text(TEXT)

    def table_of_the_command(self, name="command.csv"):
        command("study", "study.yaml", "--out", name, folder=self.folder)
        return (self.folder / name).read_bytes()

    def test_have_the_table_of_the_command(self):
        expected = self.table_of_the_command()
        for study in (small(), small(threads=1), throng.study("study.yaml")):
            study.save("saved.csv")
            self.assertEqual((self.folder / "saved.csv").read_bytes(), expected)
        small(out="written.csv")
        self.assertEqual((self.folder / "written.csv").read_bytes(), expected)
        self.assertTrue((self.folder / "written.csv.times.csv").exists())
        self.assertFalse((self.folder / "written.csv.journal").exists())

    def test_are_tables_with_typed_columns(self):
        study = small()
        self.assertEqual(list(study["avatars"]), [20, 20, 30, 30] * 2)
        self.assertEqual(list(study["scene"]), ["corridor"] * 4 + ["bottleneck"] * 4)
        self.assertEqual(study["seed"].dtype, numpy.int64)
        self.assertEqual(study["mean_speed_mps"].dtype, float)
        self.assertTrue(numpy.isnan(study["mean_stay_s"]).all())  # no agent left
        self.assertIn("<td>bottleneck</td>", study._repr_html_())
        self.assertIs(type(study[:3]), throng.Table)
        self.assertEqual(len(study.times), len(study))
        copy = pickle.loads(pickle.dumps(study))
        self.assertSameTable(copy, study)
        self.assertEqual(copy.notes, study.notes)

    def test_take_scenes_and_arrays(self):
        study = throng.study(hall(), seconds=0.2, parameters={"groups.walkers.count": numpy.array([4, 6])})
        self.assertEqual(list(study["people"]), [4, 6])
        (row,) = throng.study(hall(), seconds=1)
        self.assertEqual(row["run_id"], throng.run(hall(), seconds=1).run_id)
        both = throng.study([hall(), hall(name="hall"), "corridor"], seconds=0.1, parameters={"steering.model": ["orca"]})
        self.assertEqual(list(both["scene"]), ["scene", "hall", "corridor"])
        rng = throng.study("corridor", seconds=0.1, seeds={"from": 1, "to": 5, "step": 2})
        self.assertEqual(list(rng["seed"]), [1, 3, 5])

    def test_report_runs(self):
        seen = []
        small(progress=lambda done, runs: seen.append((done, runs)))
        self.assertEqual(seen[-1], (8, 8))

    def test_let_other_threads_run(self):
        worker = threading.Thread(target=throng.study, args=("plaza",), kwargs={"seconds": 1})
        worker.start()
        turns = 0
        while worker.is_alive():
            worker.join(0.001)
            turns += 1
        self.assertGreater(turns, 20)

    def test_name_the_argument_or_the_line_of_an_error(self):
        invalid = throng.Scene(ground=[[0, 0], [9, 0], [9, 9]], groups=[throng.Group(count=-3)])
        for work, where in [
            (lambda: throng.study("plaza", parameters={"groups.1.count": [1, -1]}), "parameters.groups.1.count"),
            (lambda: throng.study(hall(), parameters={"groups.x.count": [1]}), "parameters.groups.x.count"),
            (lambda: throng.study(["plaza", "plazza"]), "scenes"),
            (lambda: throng.study([hall(), invalid]), "scenes[1].groups[0].count"),
            (lambda: throng.study(3), "scenes"),
            (lambda: throng.study("plaza", parameters=[1]), "parameters"),
            (lambda: throng.study("plaza", seeds=["a"]), "seeds"),
            (lambda: throng.study("plaza", seconds=-1), "seconds"),
            (lambda: throng.study("study.yaml", seconds=1), "seconds"),
            (lambda: throng.study("plaza", threads=0), "threads"),
            (lambda: throng.study("plaza", out="table.txt"), "out"),
        ]:
            with self.assertRaises(throng.InputError) as caught:
                work()
            self.assertEqual(caught.exception.where, where, caught.exception)
        (self.folder / "study.yaml").write_text("scenes: [corridor]\nspeed: 3\n")
        with self.assertRaises(throng.InputError) as caught:
            throng.study("study.yaml")
        self.assertEqual((caught.exception.file, caught.exception.line), ("study.yaml", 2))

    def test_resume_after_ctrl_c(self):
        (self.folder / "study.yaml").write_text("scenes: [corridor]\nseeds: {from: 1, to: 40, step: 1}\nseconds: 1\n")
        code = """
import os, signal, throng
def stop(done, runs):
    if done >= 3:
        os.kill(os.getpid(), signal.SIGINT)
try:
    throng.study("study.yaml", out="table.csv", threads=1, progress=stop)
except KeyboardInterrupt:
    print("stopped")
"""
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=100 * SLOWNESS)
        self.assertEqual(done.stdout, "stopped\n", done.stderr)
        self.assertFalse((self.folder / "table.csv").exists())
        seen = []
        throng.study("study.yaml", out="table.csv", progress=lambda done, runs: seen.append(runs))
        self.assertLess(max(seen), 38)
        self.assertEqual((self.folder / "table.csv").read_bytes(), self.table_of_the_command())


if __name__ == "__main__":
    unittest.main()
