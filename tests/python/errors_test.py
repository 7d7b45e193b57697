"""Invalid input raises exceptions that name the place and the expected value."""

import os
import pickle
import subprocess
import unittest

import numpy
import throng
from expectations import Case

BAD_SCENE = """description: one
ground: {size_m: [10, 10]}
groups:
  - name: walkers
    count: -3
"""


class FileErrors(Case):
    def test_name_the_line(self):
        file = self.folder / "bad.yaml"
        file.write_text(BAD_SCENE)
        with self.assertRaises(throng.InputError) as raised:
            throng.run(file)
        self.assertEqual(raised.exception.file, str(file))
        self.assertIsInstance(raised.exception.line, int)
        self.assertRegex(str(raised.exception), f"{file}:{raised.exception.line}: expected .*, found ")

    def test_name_robots_and_meshes(self):
        urdf = self.folder / "robot.urdf"
        urdf.write_text('<robot name="r">\n  <link name="a"/>\n  <link name="a"/>\n</robot>\n')
        with self.assertRaises(throng.InputError) as raised:
            throng.Model(urdf)
        self.assertEqual(raised.exception.file, str(urdf))
        self.assertEqual(raised.exception.line, 3)
        mesh = self.folder / "bad.tri"
        mesh.write_text("not a mesh")
        with self.assertRaises(throng.InputError) as raised:
            throng.Body([mesh])
        self.assertEqual(raised.exception.file, str(mesh))

    def test_are_raised_for_missing_files(self):
        for read in (throng.read_log, throng.check, throng.view, lambda file: throng.render(file, 0), throng.Recording):
            with self.subTest(read=read), self.assertRaises(throng.InputError) as raised:
                read("nowhere.lcmlog")
            self.assertEqual(raised.exception.file, "nowhere.lcmlog")
            self.assertIsNone(raised.exception.line)

    def test_protect_existing_files(self):
        log = self.folder / "a.lcmlog"
        throng.run("corridor", seconds=0.1, log=log)
        before = log.read_bytes()
        with self.assertRaises(throng.InputError):
            throng.run(log, log=log)
        self.assertEqual(log.read_bytes(), before)


class OptionErrors(Case):
    def test_use_the_names_of_python(self):
        for options, where in [
            ({"avatars": 0}, "avatars"),
            ({"seconds": -1}, "seconds"),
            ({"seconds": float("nan")}, "seconds"),
            ({"seed": -1}, "seed"),
            ({"seed": 2**63}, "seed"),
            ({"seed": -(2**70)}, "seed"),
            ({"seed": 10**5000}, "seed"),
            ({"seed": numpy.uint64(2**63)}, "seed"),
            ({"avatars": 2**64}, "avatars"),
            ({"seconds": 10**400}, "seconds"),
            ({"threads": 0}, "threads"),
            ({"part_volume": "ordop25"}, "part_volume"),
            ({"steering": "orka"}, "steering"),
            ({"strategy": "two-pass", "budget_ms": 3}, "strategy"),
            ({"fps": 25}, "fps"),
            ({"states_hz": 1000, "log": "x.lcmlog"}, "states_hz"),
            ({"trajectory": "x.txt"}, "trajectory"),
            ({"trajectory_area": "2nd"}, "trajectory_area"),
        ]:
            with self.subTest(options=options), self.assertRaises(throng.InputError) as raised:
                throng.run("plaza", **options)
            self.assertEqual(raised.exception.where, where)
            self.assertIsNone(raised.exception.file)
            self.assertRegex(str(raised.exception), f"^{where}: expected .*, found ")

    def test_suggest_similar_names(self):
        with self.assertRaisesRegex(throng.InputError, "did you mean 'plaza'"):
            throng.run("plazza")
        with self.assertRaisesRegex(TypeError, "did you mean 'seed'"):
            throng.Simulation("plaza", sede=1)

    def test_are_type_errors_for_another_type(self):
        with self.assertRaisesRegex(TypeError, "seconds: expected a number"):
            throng.run("plaza", seconds="long")


class RunOptions(Case):
    WRONG = {"whole": -1, "number": -1, "word": "no such word"}
    WRONG_TEXTS = {"part_volume": "ordop25", "filter_groups": "a: b: c", "filter_parts": "a: b: c", "separator": "ab"}

    def error_of_command(self, *arguments):
        done = subprocess.run([os.environ["THRONG_COMMAND"], *arguments], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, 2, done.stderr)
        return done.stderr

    def test_give_the_same_errors_everywhere(self):
        study = self.folder / "study.yaml"
        for option in throng._core.run_options():
            name = option["name"]
            wrong = self.WRONG.get(option["kind"], self.WRONG_TEXTS.get(name))
            if wrong is None:
                continue
            with self.subTest(option=name):
                with self.assertRaises(throng.InputError) as raised:
                    throng.run("plaza", **{name: wrong})
                self.assertEqual(raised.exception.where, name)
                words = str(raised.exception).removeprefix(f"{name}: ")
                self.assertRegex(words, "^expected .*, found ")
                argument = "--" + name.replace("_", "-")
                self.assertEqual(
                    self.error_of_command("run", "plaza", f"{argument}={wrong}"), f"throng run: {argument}: {words}\n"
                )
                if option["is_of_study"]:
                    study.write_text(f"scenes: [plaza]\n{name}: {wrong}\n")
                    self.assertEqual(
                        self.error_of_command("study", "study.yaml", "--out", "t.csv"), f"study.yaml:2: {words}\n"
                    )

    def test_name_unsuitable_options_like_the_command(self):
        for options, where in [
            ({"fps": 25}, "fps"),
            ({"sampling": "smooth"}, "sampling"),
            ({"strategy": "two-pass", "budget_tests": 3}, "strategy"),
            ({"states_hz": 1000}, "states_hz"),
        ]:
            with self.subTest(options=options):
                with self.assertRaises(throng.InputError) as raised:
                    throng.run("plaza", seconds=0.1, **options)
                words = str(raised.exception).removeprefix(f"{where}: ")
                arguments = [f"--{name.replace('_', '-')}={value}" for name, value in options.items()]
                expected = self.error_of_command("run", "plaza", "--seconds", "0.1", "--log", "off", "--lcm", "off", *arguments)
                self.assertEqual(expected, f"--{where.replace('_', '-')}: {words}\n")


class OverlongNames(Case):
    def test_are_rejected_as_missing_files(self):
        for length in (300, 5000):
            name = "y" * length
            for extension in ("", ".yaml", ".csv", ".urdf", ".lcmlog"):
                for use in (throng.run, throng.Simulation, throng.Recording, throng.Model, throng.read_log, throng.check,
                            lambda file: throng.compare(file, file), lambda file: throng.Body([file]),
                            lambda file: throng.render(file, 0)):
                    with self.subTest(length=length, extension=extension, use=use):
                        with self.assertRaisesRegex(throng.InputError, "^y+[^\n]*: expected [^\n]*, found [^\n]*$"):
                            use(name + extension)

    def test_are_rejected_before_any_output(self):
        for option in ("log", "html", "contacts", "trace_hash"):
            with self.subTest(option=option), self.assertRaisesRegex(throng.EnvironmentFault, "too long"):
                throng.run("plaza", seconds=0.1, avatars=5, **{option: self.folder / ("y" * 300)})

    def test_are_rejected_with_a_zero_byte(self):
        for use in (throng.run, throng.read_log, throng.Model):
            with self.assertRaisesRegex(throng.InputError, "found 'a"):
                use("a\0b")


class Exceptions(Case):
    def test_derive_from_standard_exceptions(self):
        self.assertTrue(issubclass(throng.InputError, ValueError))
        self.assertTrue(issubclass(throng.EnvironmentFault, OSError))
        self.assertTrue(issubclass(throng.InputError, throng.Error))

    def test_report_faults_of_the_environment(self):
        with self.assertRaisesRegex(throng.EnvironmentFault, "nowhere"):
            throng.run("corridor", seconds=0.1, log=self.folder / "nowhere" / "a.lcmlog")

    def test_can_be_pickled(self):
        error = pickle.loads(pickle.dumps(throng.InputError("a.yaml:3: expected x, found y", "a.yaml:3")))
        self.assertEqual((error.file, error.line, str(error)), ("a.yaml", 3, "a.yaml:3: expected x, found y"))


if __name__ == "__main__":
    unittest.main()
