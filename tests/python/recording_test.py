"""Recordings, and comparisons of two crowds."""

import json
import pickle
import unittest

import numpy
import throng
from expectations import Case, command


class Recordings(Case):
    def setUp(self):
        super().setUp()
        self.file = self.folder / "walkers.txt"
        rows = [
            (person, frame, 100 * (0.05 * frame * (1 - 2 * (person % 2))), 60.0 * person)
            for person in range(6)
            for frame in range(80)
        ]
        self.rows = numpy.array(rows)
        text = "".join("%d %d %.4f %.4f 170\n" % row for row in rows)
        self.file.write_text(f"# id frame x/cm y/cm z/cm\n# framerate: 25\n{text}")
        self.options = {"fps": 25, "unit": "cm"}

    def test_are_tables_of_people_and_samples(self):
        recording = throng.Recording(self.file, **self.options)
        self.assertEqual(len(recording.people), 6)
        samples = recording.samples
        self.assertEqual(len(samples), len(self.rows))
        numpy.testing.assert_array_equal(samples["id"], self.rows[:, 0])
        numpy.testing.assert_allclose(samples["x_m"], self.rows[:, 2] / 100, atol=1e-6)
        numpy.testing.assert_allclose(samples["time_s"], self.rows[:, 1] / 25, atol=1e-9)
        self.assertAlmostEqual(recording.summary["speed_mps"][1], 1.25, places=2)
        self.assertEqual(recording.facts["fps"], 25)

    def test_are_retargeted_and_culled_like_the_command(self):
        run = throng.Recording(self.file, **self.options).run(exact=True)
        command("run", self.file, "--fps", 25, "--unit", "cm", "--exact", "--lcm", "off", "--log", "off",
                "--json", "a.json", folder=self.folder)
        self.assertEqual(run.hash, json.loads((self.folder / "a.json").read_text())["hash"])
        self.assertEqual(len(run.people), 6)

    def test_have_the_stated_or_given_units(self):
        table = self.folder / "headings.csv"
        table.write_text("id,t [ms],x [cm],y [m],heading\n1,0,100,2,90\n1,40,105,2,90\n")
        with self.assertRaisesRegex(throng.InputError, "headings.csv:2: .*; state their unit with heading_unit deg"):
            throng.Recording(table)
        samples = throng.Recording(table, heading_unit="deg").samples
        numpy.testing.assert_allclose(samples["heading_rad"], numpy.pi / 2, rtol=1e-6)
        numpy.testing.assert_allclose(samples["x_m"], [1, 1.05])
        numpy.testing.assert_allclose(samples["y_m"], 2)
        numpy.testing.assert_allclose(samples["time_s"], [0, 0.04])
        with self.assertRaisesRegex(throng.InputError, "^heading_unit: expected one of rad, deg"):
            throng.Recording(table, heading_unit="turns")

    def test_reject_options_of_scenes(self):
        with self.assertRaisesRegex(throng.InputError, "^steering: expected a scene"):
            throng.run(self.file, steering="orca", **self.options)


class Comparisons(Case):
    def test_have_the_rows_of_the_command(self):
        found = throng.compare("corridor", "crossing", seconds=2)
        text = command("compare", "corridor", "crossing", "--seconds", 2, "--json", "a.json", folder=self.folder)
        expected = json.loads((self.folder / "a.json").read_text())
        self.assertEqual(str(found), text)
        self.assertEqual(found.a["name"], "corridor")
        for measure, table in found.tables.items():
            self.assertEqual(len(table), len(expected[measure]), measure)
            for row, other in zip(table, expected[measure]):
                for side in "ab":
                    self.assertTrue(numpy.isnan(row[side]) if other[side] is None else row[side] == other[side])

    def test_repeat_runs_with_their_options(self):
        log = self.folder / "a.lcmlog"
        run = throng.run("corridor", seconds=1, seed=2, avatars=60, log=log)
        other = throng.run("corridor", seconds=1, seed=3, avatars=60, steering="orca")
        log.unlink()
        found = throng.compare(run, other)
        self.assertFalse(log.exists())
        self.assertEqual((found.a["people"], found.a["seconds"], found.b["seconds"]), (60, 1, 1))
        self.assertTrue(any((table["a"] != table["b"]).any() for table in found.tables.values()))
        for table in throng.compare(run, pickle.loads(pickle.dumps(run))).tables.values():
            numpy.testing.assert_array_equal(table["a"], table["b"])
        self.assertEqual(throng.compare(run, "corridor", seconds=0.5).a["seconds"], 0.5)

    def test_take_runs_of_logs(self):
        log = self.folder / "a.lcmlog"
        run = throng.run("corridor", seconds=1, log=log)
        contacts = throng.compare(throng.read_log(log), run).tables["contacts"]
        numpy.testing.assert_array_equal(contacts["a"], contacts["b"])

    def test_have_figures(self):
        found = throng.compare("corridor", "crossing", seconds=2)
        try:
            figures = found.figures(self.folder / "plots")
        except throng.EnvironmentFault as error:
            self.skipTest(str(error))
        self.assertIn("speed_density", figures)
        for name, (title, svg) in figures.items():
            self.assertTrue(title)
            self.assertIn("<svg", svg)
            self.assertTrue((self.folder / "plots" / f"{name}.svg").exists())
        self.assertEqual(found._repr_html_().count("<svg"), len(figures))

    def test_reject_a_line_without_length(self):
        with self.assertRaisesRegex(throng.InputError, "line: expected two points"):
            throng.compare("corridor", "crossing", seconds=1, line=(1, 1, 1, 1))

    def test_reject_an_invalid_line(self):
        nan, inf = float("nan"), float("inf")
        for line in ((nan, 0, 1, 1), (0, 0, 1, inf), (-1e300, 0, 1, 1), (0, 0, 1), (), "ab", 5, ((0, 0), (1, 1)), [None] * 4):
            with self.subTest(line=line), self.assertRaisesRegex(throng.InputError, "^line: expected two points"):
                throng.compare("corridor", "crossing", seconds=1, line=line)


if __name__ == "__main__":
    unittest.main()
