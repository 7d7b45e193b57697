"""Logs, pictures and pages in Python."""

import unittest

import numpy
import throng
from expectations import Case, command


class Logs(Case):
    def setUp(self):
        super().setUp()
        self.log = self.folder / "plaza.lcmlog"
        self.run = throng.run("plaza", seconds=2, seed=3, log=self.log, trajectory_fps=60)

    def test_contain_the_run(self):
        read = throng.read_log(self.log)
        self.assertEqual((read.hash, read.run_id, read.scene, read.seed), (self.run.hash, self.run.run_id, "plaza", 3))
        self.assertSameTable(read.events, self.run.events)
        self.assertSameTable(read.contacts, self.run.contacts)
        self.assertSameTable(read.people, self.run.people)
        for name in self.run.counters.dtype.names[:-2]:  # a log has no clock times
            numpy.testing.assert_array_equal(read.counters[name], self.run.counters[name], err_msg=name)
        self.assertEqual(len(read.trajectories), len(self.run.trajectories))
        for axis in ("x_m", "y_m"):
            numpy.testing.assert_allclose(read.trajectories[axis], self.run.trajectories[axis], atol=2e-3)
        self.assertEqual(read.names.parts, self.run.names.parts)

    def test_give_positions_at_the_requested_rate(self):
        read = throng.read_log(self.log, trajectory_fps=10)
        self.assertEqual(sorted(set(read.trajectories["frame"])), list(range(0, 120, 6)))
        self.assertEqual(len(throng.read_log(self.log, trajectories=False).trajectories), 0)

    def test_of_the_command_are_readable(self):
        command("run", "plaza", "--seconds", 1, "--lcm", "off", "--log", "a.lcmlog", folder=self.folder)
        self.assertEqual(throng.read_log(self.folder / "a.lcmlog").hash, throng.run("plaza", seconds=1).hash)

    def test_are_exported_like_the_command(self):
        for channel, count in (("events", len(self.run.events)), ("states", 120 * len(self.run.people))):
            with self.subTest(channel=channel):
                text = command("export", self.log, "--csv", channel, folder=self.folder)
                self.assertIsNone(throng.export(self.log, channel, out=self.folder / "rows.csv"))
                self.assertEqual((self.folder / "rows.csv").read_text(), text)
                table = throng.export(self.log, channel)
                self.assertEqual(",".join(table.dtype.names), text.splitlines()[0])
                self.assertEqual(len(table), count)
        events = throng.export(self.log, "events")
        for column in ("frame", "body_a", "body_b", "level"):
            numpy.testing.assert_array_equal(events[column], self.run.events[column])
        throng.export(self.log, mcap=self.folder / "run.mcap", poses_hz=5)
        self.assertEqual((self.folder / "run.mcap").read_bytes()[1:5], b"MCAP")

    def test_export_their_recorded_part_with_a_warning(self):
        torn = self.folder / "torn.lcmlog"
        torn.write_bytes(self.log.read_bytes()[:-200_000])
        with self.assertWarnsRegex(UserWarning, "The recorded part is exported"):
            self.assertLess(len(throng.export(torn, "states")), 120 * len(self.run.people))

    def test_name_what_an_export_lacks(self):
        for options, where in [
            ({}, "channel, mcap"),
            ({"channel": "events", "mcap": "run.mcap"}, "channel, mcap"),
            ({"channel": "poses"}, "channel"),
            ({"mcap": "run.mcap", "out": "run.csv"}, "out"),
            ({"mcap": "run.mcap", "poses_hz": 0}, "poses_hz"),
            ({"channel": "events", "out": self.log}, str(self.log)),
        ]:
            with self.assertRaises(throng.InputError) as caught:
                throng.export(self.log, **options)
            self.assertEqual(caught.exception.where, where)

    def test_are_checked_like_the_command(self):
        report = throng.check(self.log)
        self.assertTrue(report)
        self.assertTrue(report["finished"])
        self.assertEqual(report["begins"], len(self.run.contacts))
        bytes_ = self.log.read_bytes()
        torn = self.folder / "torn.lcmlog"
        torn.write_bytes(bytes_[: len(bytes_) * 2 // 3])
        report = throng.check(torn)
        self.assertFalse(report)
        self.assertTrue(report["problems"])

    def test_give_their_sound_part_when_torn(self):
        bytes_ = self.log.read_bytes()
        torn = self.folder / "torn.lcmlog"
        torn.write_bytes(bytes_[: len(bytes_) * 2 // 3])
        read = throng.read_log(torn)
        self.assertIsNone(read.hash)
        self.assertFalse(read.summary["finished"])
        self.assertGreater(read.summary["left_out"], 0)
        cannot_be_read, breaks_off = read.notes
        self.assertRegex(cannot_be_read, r"^1 place of the log cannot be read and is left out; check\(\) ")
        self.assertIn(f"breaks off after {len(read.counters)} frames", breaks_off)
        self.assertEqual(throng.read_log(self.log).notes, [])
        self.assertSameTable(read.events, self.run.events[: len(read.events)])
        kinds = numpy.bincount(read.events["kind"], minlength=2)
        self.assertEqual(numpy.isnan(read.contacts["end_s"]).sum(), kinds[0] - kinds[1])

    def pieces(self, channel):
        """Returns begin and end of each message of a channel in the log."""
        found, at, bytes_ = [], 0, self.log.read_bytes()
        while at < len(bytes_):
            channel_bytes, data_bytes = (int.from_bytes(bytes_[at + i : at + i + 4], "big") for i in (20, 24))
            end = at + 28 + channel_bytes + data_bytes
            if bytes_[at + 28 : at + 28 + channel_bytes] == channel:
                found.append((at, end))
            at = end
        return bytes_, found

    def test_report_altered_and_missing_parts(self):
        for channel in (b"THRONG_FRAME_STATS", b"THRONG_STATES"):
            bytes_, found = self.pieces(channel)
            begin, end = found[50]
            altered = self.folder / "altered.lcmlog"
            altered.write_bytes(bytes_[: end - 1] + bytes([bytes_[end - 1] ^ 1]) + bytes_[end:])
            (note,) = throng.read_log(altered).notes
            self.assertRegex(note, "^The log is damaged: 1 stretch of messages is altered; `throng check` lists ")
            lacking = self.folder / "lacking.lcmlog"
            lacking.write_bytes(bytes_[:begin] + bytes_[end:])
            self.assertEqual(throng.read_log(lacking).notes[-1], "The log lacks 1 message of its run.")
            unreadable = self.folder / "unreadable.lcmlog"
            unreadable.write_bytes(bytes_[:begin] + b"X" + bytes_[begin + 1 :])
            notes = throng.read_log(unreadable).notes
            self.assertRegex(notes[0], "^The log is damaged: [0-9]+ bytes of it could not be read")
            self.assertTrue(any(note.startswith("1 place of the log") for note in notes), notes)

    def test_are_incomplete_when_cut_off(self):
        bytes_, found = self.pieces(b"THRONG_FRAME_STATS")
        cut = self.folder / "cut.lcmlog"
        cut.write_bytes(bytes_[: found[50][1]])
        report = throng.check(cut)
        self.assertFalse(report)
        self.assertEqual((report["sound"], report["finished"], report["problems"]), (True, False, []))
        self.assertRegex(report["cut_off"], "^The log is cut off: it ends after frame 50 ")
        self.assertEqual(throng.check(self.log)["cut_off"], "")
        (note,) = throng.read_log(cut).notes
        self.assertIn("breaks off after 51 frames", note)

    def test_are_rendered_like_the_command(self):
        picture = throng.render(self.log, 60, width=160, height=90)
        self.assertEqual((picture.shape, picture.dtype), ((90, 160, 3), numpy.uint8))
        command("render", self.log, "--frame", 60, "--width", 160, "--height", 90, "--out", "a.png", folder=self.folder)
        self.assertGreater(len(numpy.unique(picture.reshape(-1, 3), axis=0)), 100)
        near = throng.render(self.log, 60, 160, 90, eye_m=(4, -9, 3), target_m=(0, -5, 1))
        self.assertTrue((near != picture).any())
        try:
            import matplotlib.image
        except ImportError:
            return  # no PNG reader is installed
        png = matplotlib.image.imread(self.folder / "a.png")[:, :, :3]
        numpy.testing.assert_array_equal(numpy.round(png * 255).astype(numpy.uint8), picture)

    def test_reject_frames_that_they_do_not_contain(self):
        with self.assertRaisesRegex(throng.InputError, "frame 9999"):
            throng.render(self.log, 9999)
        with self.assertRaisesRegex(throng.InputError, "width"):
            throng.render(self.log, 0, width=1)
        for name, numbers in (("width", (15, 8193, 10**30)), ("height", (0, 10**5000)), ("frame", (-1, 2**63, 1.5))):
            for number in numbers:
                with self.subTest(name=name), self.assertRaisesRegex(throng.InputError, f"^{name}: expected a whole number"):
                    throng.render(self.log, **{"frame": 0, name: number})

    def test_reject_invalid_cameras(self):
        nan, inf = float("nan"), float("inf")
        for name in ("eye_m", "target_m"):
            for point in ((nan, 0, 1), (0, inf, 1), (0, 0, -1e300), (0, 2e6, 0), (0, 1), "abc", [None] * 3):
                with self.subTest(name=name, point=point), self.assertRaisesRegex(throng.InputError, f"^{name}: expected three"):
                    throng.render(self.log, 0, 32, 32, **{name: point})
        with self.assertRaisesRegex(throng.InputError, "^eye_m: expected another point than target_m, found the same$"):
            throng.render(self.log, 0, 32, 32, eye_m=(0, 0, 1), target_m=(0, 0, 1))

    def test_are_shown_as_the_page_of_the_command(self):
        page = throng.view(self.log)
        command("view", self.log, "--html", "page.html", folder=self.folder)
        self.assertEqual(page.html, (self.folder / "page.html").read_text())
        self.assertIn("<iframe srcdoc=", page._repr_html_())
        page.save(self.folder / "saved.html")
        self.assertEqual((self.folder / "saved.html").read_text(), page.html)

    def test_are_not_needed_to_view_a_run(self):
        run = throng.run("plaza", seconds=0.5, view=True)
        self.assertIn('id="recording"', run.view().html)
        self.assertIn('id="recording"', self.run.view().html)
        with self.assertRaisesRegex(ValueError, "view=True"):
            throng.run("plaza", seconds=0.1).view()


if __name__ == "__main__":
    unittest.main()
