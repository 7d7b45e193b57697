"""The notebooks and Python programs of examples/ and the code of docs/python.md run."""

import contextlib
import io
import json
import os
import re
import shutil
import unittest

from expectations import SOURCES, Case


def code_of(notebook):
    cells = json.loads(notebook.read_text())["cells"]
    return ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]


def shown(code, names):
    """Runs a cell and returns the value of its last line, as a notebook does."""
    import ast

    tree = ast.parse(code)
    last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, "cell", "exec"), names)
    return eval(compile(ast.Expression(last.value), "cell", "eval"), names) if last else None


class Examples(Case):
    def setUp(self):
        super().setUp()
        before = os.getcwd()
        os.chdir(self.folder)
        self.addCleanup(os.chdir, before)

    def needs(self, *modules):
        for module in modules:
            try:
                __import__(module)
            except ImportError:
                self.skipTest(f"no {module} here")

    def lines(self, code):
        return [line for line in code.splitlines() if line.strip()]

    def test_custom_poses_notebook_gives_a_table_in_ten_lines(self):
        self.needs("pandas")
        shutil.copy(SOURCES / "examples/picker.urdf", self.folder)
        (code,) = code_of(SOURCES / "examples/custom_poses.ipynb")
        self.assertLessEqual(len(self.lines(code)), 10)
        table = shown(code, {})
        self.assertGreater(len(table), 10)
        self.assertLessEqual(set(table.part_a_name), {"base", "arm", "gripper"})

    def test_a_floor_plan_gives_a_table_in_ten_lines(self):
        self.needs("pandas", "shapely")
        code = (SOURCES / "examples/floor_plan.py").read_text()
        self.assertLessEqual(len(self.lines(code.split('"""')[2])), 14)
        names = {}
        shown(code, names)
        self.assertGreater(len(names["run"].contacts), 50)

    def test_people_are_added_and_removed_in_few_lines(self):
        code = (SOURCES / "examples/changing_crowd.py").read_text()
        self.assertLessEqual(len(self.lines(code.split('"""')[2])), 17)
        names = {}
        shown(code, names)
        present = names["frame"].present
        self.assertEqual(len(present), 1000)
        self.assertGreater(names["ids"].max(), 950)
        self.assertLess(present.sum(), 250)

    def test_people_walk_by_another_steering_model_in_few_lines(self):
        code = (SOURCES / "examples/own_model.py").read_text()
        self.assertLessEqual(len(self.lines(code.split('"""')[2])), 20)
        names = {}
        shown(code, names)
        self.assertGreater(names["frame"].speeds_mps.mean(), 0.2)

    def test_a_robot_asks_for_distances_in_ten_lines(self):
        code = (SOURCES / "examples/robot_distances.py").read_text()
        self.assertLessEqual(len(self.lines(code.split('"""')[2])), 12)
        with contextlib.redirect_stdout(io.StringIO()) as printed:
            shown(code, {})
        lines = printed.getvalue().splitlines()
        self.assertEqual(len(lines), 10)
        for line in lines:
            self.assertRegex(line, r"^\d\.\d s: (left|Right)Hand of \d+ is \d+\.\d{3} m from \w+$")

    def test_a_study_gives_a_plot_in_ten_lines(self):
        self.needs("pandas", "matplotlib")
        code = (SOURCES / "examples/study_plot.py").read_text()
        self.assertLessEqual(len(self.lines(code.split('"""')[2])), 10)
        names = {}
        shown(code, names)
        self.assertEqual(len(names["study"]), 24)
        self.assertGreater((self.folder / "study_plot.png").stat().st_size, 5000)

    def test_contacts_by_part_notebook_gives_a_plot_in_ten_lines(self):
        self.needs("pandas", "matplotlib")
        (code,) = code_of(SOURCES / "examples/contacts_by_part.ipynb")
        self.assertLessEqual(len(self.lines(code)), 10)
        names = {}
        shown(code, names)
        self.assertGreater(names["counts"].sum(), 50)
        self.assertGreater((self.folder / "contacts_by_part.png").stat().st_size, 5000)

    def test_notebooks_are_stored_without_outputs(self):
        notebooks = list((SOURCES / "examples").glob("*.ipynb"))
        self.assertGreaterEqual(len(notebooks), 2)
        for notebook in notebooks:
            for cell in json.loads(notebook.read_text())["cells"]:
                self.assertFalse(cell.get("outputs"), notebook.name)

    def test_code_of_the_documentation_runs(self):
        self.needs("pandas")
        shutil.copy(SOURCES / "examples/picker.urdf", self.folder)
        text = (SOURCES / "docs/python.md").read_text()
        blocks = re.findall(r"^```python\n(.*?)^```", text, re.M | re.S)
        self.assertGreater(len(blocks), 8)
        names = {}
        for block in blocks:  # in sequence, with shared names
            with self.subTest(block=block):
                exec(compile(block, "docs/python.md", "exec"), names)


if __name__ == "__main__":
    unittest.main()
