"""Adds, redirects and removes 1000 people while a run goes on."""

import numpy

import throng

east, north = throng.Area(min_m=[22, 1], max_m=[24, 19]), throng.Area(min_m=[10, 22], max_m=[20, 24])
crowd = throng.Group(name="crowd", spare=1000, goals=[east])
hall = throng.Scene(name="hall", ground=throng.Area(min_m=[0, 0], max_m=[25, 25]), groups=[crowd])
simulation = throng.Simulation(hall, seconds=60)
gates = numpy.column_stack([numpy.full(20, 1.0), numpy.linspace(0.5, 19.5, 20)])
for frame in simulation:
    if frame.number % 60 == 0 and frame.number < 3000:
        ids = simulation.add("crowd", gates, headings_rad=0, speeds_mps=1)
        simulation.set_goal(ids[10:], north)
    x, y, _ = frame.positions_m.T
    simulation.remove(frame.present & ((x > 22) | (y > 22)))
    if frame.number % 300 == 0:
        print(f"{frame.time_s:4.1f} s: {frame.present.sum()} people, {len(frame.pairs)} pairs of parts touch")
