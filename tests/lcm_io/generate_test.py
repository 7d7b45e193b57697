"""Tests of lcmtypes/generate.py: generated code, and errors with file and line. generate_test.py SOURCE"""

import pathlib
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(sys.argv.pop())
HEADER = "".join((SOURCE / "lcmtypes/end_t.lcm").read_text().partition("{\n")[2].partition("  int64_t frames;")[:1])


class Generate(unittest.TestCase):
    def generated(self, text, name="a_t"):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, name + ".lcm")
            file.write_text(text)
            done = subprocess.run([sys.executable, SOURCE / "lcmtypes/generate.py", folder, file, SOURCE / "lcmtypes/end_t.lcm"],
                                  capture_output=True, text=True)
            layouts = pathlib.Path(folder, "throng/layouts.hpp")
            return done.stderr.replace(str(file), "FILE").strip(), layouts.read_text() if layouts.exists() else ""

    def rejected(self, fields, message, above=""):
        self.assertEqual(self.generated(f"package throng;\n{above}struct a_t {{\n{fields}}}\n")[0], message)

    def test_rejects_invalid_files(self):
        self.rejected("  int32_t n\n", "FILE:3: expected a field 'TYPE NAME;' or 'TYPE NAME[LENGTH];', found 'int32_t n'")
        self.rejected("  int32_t a[n];\n", "FILE:3: expected a length that is a number or a field above, found 'n'")
        self.rejected("  word a;\n", "FILE:1: expected types of LCM or of a .lcm file, found 'word a'")
        self.rejected("  int32_t a;\n  //! a < b\n", "FILE:4: expected fields of a_t, found 'b'")
        self.rejected("  int32_t n;\n  int32_t a[n];\n  int32_t b[2];\n  //! a < b\n",
                     "FILE:6: expected a rule of fields that have one length, found 'a < b'")
        self.rejected("  double a[2];\n  //! each left\n",
                     "FILE:4: expected one name per item of the field above, found 'each left'")
        self.rejected("  int32_t a;\n", "FILE:1: expected the fields that every message of a run begins with, found 'a_t'",
                     "//! channel THRONG_A\n")

    def test_generates_chained_rules_and_tables(self):
        error, layouts = self.generated("package throng;\n//! channel THRONG_A\n//! csv\nstruct a_t {\n" + HEADER +
                                   "  int32_t n;\n  int32_t a[n];\n  //! 0 <= a < frame\n  double b[2];\n  //! each left, right\n}\n")
        self.assertEqual(error, "")
        self.assertIn("if (!(0 <= m.a[i] && m.a[i] < m.frame)) return", layouts)
        self.assertIn('return "a,left_b,right_b";', layouts)


if __name__ == "__main__":
    unittest.main()
