"""Scenes built in code equal the files that they write, and errors name the key."""

import subprocess
import sys
import unittest

import numpy

import throng
from expectations import SOURCES, Case, command
from throng import Area, Door, Goal, Group, Obstacle, Scene, _scene_keys


def corridor(**keys):
    return Scene(
        name="corridor",
        duration_s=0.5,
        ground=Area(min_m=[0, 0], max_m=[20, 4]),
        groups=[
            Group(name="walkers", count=12, spawn=Area(min_m=[1, 0.5], max_m=[9, 3.5]),
                  goals=[Area(min_m=[18, 1], max_m=[19.5, 3])], on_arrival="leave"),
        ],
        obstacles=[Obstacle(name="pillar", kind="cylinder", position_m=(12, 2), diameter_m=0.5, height_m=2)],
        **keys,
    )


class Square:
    """Has the interface that shapely, geopandas and others share."""

    def __init__(self, low, high, hole=None, many=False):
        ring = lambda a, b: [(a, a), (b, a), (b, b), (a, b), (a, a)]  # noqa: E731
        rings = [ring(low, high)] + ([ring(*hole)] if hole else [])
        self.__geo_interface__ = (
            {"type": "MultiPolygon", "coordinates": [rings, [ring(high, high + 1)]]} if many
            else {"type": "Polygon", "coordinates": rings}
        )


class Scenes(Case):
    def test_run_like_the_files_they_write(self):
        scene, file = corridor(), self.folder / "corridor.yaml"
        scene.save(file)
        from_code, from_file = throng.run(scene, exact=True), throng.run(file, exact=True)
        self.assertEqual(from_code.hash, from_file.hash)
        self.assertSameTable(from_code.events, from_file.events)
        self.assertEqual(from_code.scene, "corridor")
        stepped = throng.Simulation(scene, exact=True)
        for _ in stepped:
            pass
        stepped.finish()
        self.assertEqual(stepped.hash, from_file.hash)
        self.assertIn("corridor", str(throng.compare(scene, file)))
        self.assertIn(from_file.hash, command("run", file, "--exact", "--lcm", "off", folder=self.folder))

    def test_survive_text_and_dictionaries(self):
        scene = corridor(doors=[Door(name="door", from_m=[10, 0], to_m=[10, 4], opens=[{"delay_s": 0.1}])])
        self.assertEqual(Scene.from_yaml(scene.to_yaml()), scene)
        self.assertEqual(Scene.from_dict(scene.to_dict()), scene)
        self.assertIsInstance(Scene.from_yaml(scene.to_yaml()).groups[0], Group)
        self.assertEqual(Scene.from_yaml("name: '12'").name, "12")
        self.assertEqual(Scene.from_yaml("step_s: 1/60").to_yaml(), "step_s: 1/60\n")

    def test_equal_all_bundled_scenes_after_a_round_trip(self):
        for file in sorted((SOURCES / "scenes/bundled").glob("*.yaml")):
            with self.subTest(scene=file.stem):
                scene = Scene.from_yaml(file.read_text())
                self.assertEqual(Scene.from_yaml(scene.to_yaml()), scene)
                if file.stem in ("bottleneck", "museum", "paper_50"):
                    options = {"seconds": 0.05, "trajectories": False}
                    self.assertEqual(throng.run(scene, **options).hash, throng.run(file.stem, **options).hash)

    def test_take_shapes_and_arrays(self):
        corners = numpy.array([[0, 0], [20, 0], [20, 4], [0, 4]])
        scene = corridor()
        scene.ground = corners
        self.assertEqual(scene.ground.polygon, corners.tolist())
        self.assertEqual(throng.run(scene).hash, throng.run(corridor()).hash)  # a polygon that is a rectangle
        scene.ground = Square(0, 20, hole=(5, 6))
        self.assertEqual(len(scene.ground.holes), 1)
        scene.groups[0].goals = [Square(15, 17), Goal(any_of=[Square(1, 2), corners[:3]])]
        self.assertEqual(scene.groups[0].goals[0].polygon[2], [17.0, 17.0])
        self.assertEqual(len(throng.run(scene).people), 12)
        scene.groups[0].goals.append(Square(10, 12, hole=(10.5, 11)))
        self.assertEqual(len(scene.to_dict()["groups"][0]["goals"][2]["holes"]), 1)
        self.assertIn("MULTIPOLYGON", Group(spawn=Square(0, 1, many=True)).spawn.wkt)
        self.assertEqual(Obstacle(polygon=Square(0, 1)).polygon[0], [0.0, 0.0])

    def test_start_at_given_places(self):
        rng = numpy.random.default_rng(1)
        places = numpy.stack(numpy.meshgrid(numpy.arange(1, 9), [0.7, 2, 3.3]), -1).reshape(-1, 2) + rng.uniform(-0.2, 0.2, (24, 2))
        headings, speeds = rng.uniform(-3, 3, 24), rng.uniform(0, 1.5, 24)

        def scene(positions, **keys):
            scene = corridor()
            scene.groups[0] = Group(name="walkers", goals=[Area(min_m=[18, 1], max_m=[19.5, 3])], positions_m=positions, **keys)
            return scene

        listed = scene(places.tolist(), headings_rad=headings.tolist(), speeds_mps=speeds.tolist())
        arrays = scene(places, headings_rad=headings, speeds_mps=speeds)
        rows = "".join(f"{x!r},{y!r},{h!r},{v!r}\n" for (x, y), h, v in zip(places.tolist(), headings.tolist(), speeds.tolist()))
        (self.folder / "starts.csv").write_text("x_m,y_m,heading_rad,speed_mps\n" + rows)
        filed = scene({"file": str(self.folder / "starts.csv")})
        runs = [throng.run(each) for each in (listed, arrays, filed)]
        self.assertEqual(len({(run.run_id, run.hash) for run in runs}), 1)
        simulation = throng.Simulation(arrays)
        frame = simulation.step()
        numpy.testing.assert_array_equal(frame.positions_m[:, :2], places)
        numpy.testing.assert_allclose(frame.headings_rad, headings, atol=1e-6)
        numpy.testing.assert_allclose(frame.speeds_mps, speeds, atol=1e-6)
        for _ in range(9):
            simulation.step()
        resumed = throng.Simulation(arrays).resume(simulation.save())
        for going in (simulation, resumed):
            for _ in going:
                pass
            going.finish()
            self.assertEqual(going.hash, runs[0].hash)
        places[5] = places[4] + 0.05
        with self.assertRaisesRegex(throng.InputError, r"^groups\[0\].positions_m: expected position 6 of group 'walkers'"):
            throng.run(scene(places))
        with self.assertRaisesRegex(throng.InputError, "^avatars: .*positions_m"):
            throng.run(listed, avatars=50)

    def test_take_meshes_as_arrays(self):
        corners = numpy.array([[x, y, z] for x in (-0.5, 0.5) for y in (-1, 1) for z in (0, 1.5)])
        sides = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4],
                 [1, 5, 7], [1, 7, 3]]
        (self.folder / "box.obj").write_text(
            "".join(f"v {x} {y} {z}\n" for x, y, z in corners) + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in sides)
        )
        runs = []
        for keys in ({"vertices": corners, "triangles": numpy.array(sides)}, {"file": str(self.folder / "box.obj")}):
            scene = corridor()
            scene.groups[0].spawn = Area(min_m=[8, 0.5], max_m=[11, 3.5])
            scene.duration_s = 3
            scene.obstacles = [Obstacle(name="box", kind="mesh", position_m=(12, 2), **keys)]
            runs.append(throng.run(scene, exact=True))
        self.assertGreater(len(runs[0].events), 0)
        self.assertEqual(runs[0].hash, runs[1].hash)

    def test_name_the_key_of_an_error(self):
        scene = corridor()
        scene.groups[0].count = -1
        with self.assertRaisesRegex(throng.InputError, r"^groups\[0\].count: expected .* found '-1'$") as caught:
            throng.run(scene)
        self.assertEqual(caught.exception.where, "groups[0].count")
        scene = corridor()
        scene.groups[0].goals.append(Area(min_m=[100, 0], max_m=[101, 1]))
        with self.assertRaisesRegex(throng.InputError, r"^groups\[0\].goals\[1\]"):
            throng.Simulation(scene)
        with self.assertRaisesRegex(TypeError, "colour"):
            Group(colour="red")
        with self.assertRaisesRegex(AttributeError, "did you mean 'count'"):
            scene.groups[0].coun = 3
        with self.assertRaisesRegex(throng.InputError, r"Scene.groups\[0\]: .*'cuont'; did you mean 'count'"):
            Scene.from_dict({"groups": [{"cuont": 3}]})
        with self.assertRaisesRegex(throng.InputError, r"^groups\[0\].count"):
            throng.run(Scene(groups=[Group(count=float("nan"))]))

    def test_have_a_class_for_every_map_of_scene_files(self):
        printed = subprocess.run([sys.executable, SOURCES / "scripts/scene_classes.py"], capture_output=True, text=True)
        self.assertEqual(printed.stdout, (SOURCES / "python/throng/_scene_keys.py").read_text(), "scripts/docs.sh --update")
        public = {name for name in throng.__all__ if getattr(throng, name).__module__ == "throng._scene_keys"}
        self.assertEqual(public, {kind.__name__ for kind in _scene_keys.MAPS.values()})


if __name__ == "__main__":
    unittest.main()
