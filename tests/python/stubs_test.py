"""The type stubs equal the module, and all public names have docstrings."""

import ast
import inspect
import os
import pathlib
import shutil
import subprocess
import unittest

import throng
from expectations import SOURCES, Case

STUBS = ast.parse((SOURCES / "python/throng/__init__.pyi").read_text())
# The classes of scene keys have their types in their own source.
NAMES = [name for name in throng.__all__ if getattr(throng, name).__module__ != "throng._scene_keys"]
MESSAGES = ast.parse(pathlib.Path(throng.__file__).with_name("_messages.pyi").read_text())


def parameters(function):
    named = function.args.posonlyargs + function.args.args + function.args.kwonlyargs
    return [arg.arg for arg in named] + [arg.arg for arg in (function.args.vararg, function.args.kwarg) if arg]


class Stubs(Case):
    def setUp(self):
        super().setUp()
        self.named = {node.name: node for node in STUBS.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}

    def test_name_all_public_names(self):
        self.assertLessEqual(set(NAMES), set(self.named))

    def test_have_the_parameters_of_the_functions(self):
        for name in NAMES:
            node, real = self.named[name], getattr(throng, name)
            functions = [(name, node, real)] if isinstance(node, ast.FunctionDef) else [
                (f"{name}.{member.name}", member, getattr(real, member.name))
                for member in node.body
                if isinstance(member, ast.FunctionDef) and not member.decorator_list
            ]
            for called, stub, function in functions:
                with self.subTest(function=called):
                    self.assertEqual(parameters(stub), list(inspect.signature(function).parameters))

    def test_have_every_option_of_a_run(self):
        start = next(each for each in self.named["Simulation"].body if getattr(each, "name", "") == "__init__")
        self.check_options(self.named["run"].args, throng.run)
        self.check_options(start.args, throng.Simulation.__init__)

    def check_options(self, stub, function):
        annotations = {arg.arg: ast.unparse(arg.annotation) for arg in stub.kwonlyargs}
        defaults = {arg.arg: ast.unparse(value) for arg, value in zip(stub.kwonlyargs, stub.kw_defaults)}
        types = {"flag": "bool", "whole": "Optional[int]", "number": "Optional[float]", "word": "Optional[str]",
                 "text": "Optional[str]"}
        for option in throng._core.run_options():
            name = option["name"]
            with self.subTest(option=name):
                default = False if option["kind"] == "flag" else None
                kind = "Union[None, str, Mapping[str, str]]" if name == "part_volume" else types[option["kind"]]
                self.assertIs(inspect.signature(function).parameters[name].default, default)
                self.assertEqual((annotations[name], defaults[name]), (kind, str(default)))
                self.assertRegex(inspect.getdoc(throng.run), rf"\b{name}\b")

    def test_name_every_public_member(self):
        for name in NAMES:
            node, real = self.named[name], getattr(throng, name)
            if not isinstance(node, ast.ClassDef) or name in ("Table", "LogReport"):
                continue
            stubbed = {member.name for member in node.body if isinstance(member, ast.FunctionDef)}
            stubbed |= {member.target.id for member in node.body if isinstance(member, ast.AnnAssign)}
            public = {member for member in vars(real) if not member.startswith("_")}
            self.assertLessEqual(public, stubbed, name)

    def test_name_the_classes_of_messages(self):
        classes = {name for name in vars(throng) if name.endswith("_t")}
        self.assertIn("events_t", classes)
        stubbed = {
            alias.asname: (node.module, node.level, alias.name)
            for node in MESSAGES.body if isinstance(node, ast.ImportFrom) and node.level for alias in node.names
        }
        # In a stub `import name as name` exports the class, not the module of that name.
        self.assertEqual(stubbed, {name: (name, 1, name) for name in classes})
        self.assertTrue(all(inspect.isclass(getattr(throng, name)) for name in classes))
        self.assertNotIn("__getattr__", self.named)  # which would take any name, misspelt or not

    @unittest.skipUnless(shutil.which("mypy"), "no mypy here")
    def test_type_the_examples(self):
        package = pathlib.Path(throng.__file__).parent
        done = subprocess.run(
            ["mypy", "--strict", "--ignore-missing-imports", "--cache-dir", self.folder, *(SOURCES / "examples").glob("*.py")],
            env={**os.environ, "MYPYPATH": str(package.parent)}, cwd=self.folder, capture_output=True, text=True,
        )
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_have_docstrings(self):
        for name in throng.__all__:
            self.assertTrue(inspect.getdoc(getattr(throng, name)), name)


class Messages(Case):
    def test_do_not_need_the_compiled_module(self):
        import subprocess
        import sys

        code = "from throng import events_t, run_chunk_t; import sys; events_t._get_packed_fingerprint(); assert 'numpy' not in sys.modules"
        subprocess.run([sys.executable, "-c", code], check=True)

    def test_do_not_replace_numpy(self):
        import subprocess
        import sys

        code = "import sys; sys.modules['numpy'] = None; import throng"
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
        self.assertNotEqual(done.returncode, 0)
        self.assertRegex(done.stderr.splitlines()[-1], "^ImportError: throng needs numpy")


if __name__ == "__main__":
    unittest.main()
