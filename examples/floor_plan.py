"""From a floor plan in shapely to a table of contacts."""

from shapely.geometry import Point, Polygon, box

import throng

hall = Polygon([(0, 0), (24, 0), (24, 8), (14, 8), (14, 14), (8, 14), (8, 8), (0, 8)])
ground = hall.difference(Point(12, 4).buffer(1.5))
walkers = [
    throng.Group(name="east", count=40, spawn=box(1, 1, 8, 7), goals=[box(21, 1, 23, 7)]),
    throng.Group(name="north", count=25, spawn=box(16, 1, 23, 7), goals=[box(9, 12, 13, 13.5)]),
]
run = throng.run(throng.Scene(name="hall", ground=ground, groups=walkers), seconds=20, exact=True)
print(run.contacts.to_pandas()[["body_a", "part_a_name", "body_b", "part_b_name", "begin_s", "end_s"]])
