"""Moves 200 people by a steering model of one's own; they walk with planted feet, and their contacts are found."""

import numpy
import throng

area = throng.Area(min_m=[-15, -15], max_m=[15, 15])
people = throng.Group(name="people", count=200, spawn=area, externally_controlled=True)
simulation = throng.Simulation(throng.Scene(name="own model", ground=area, groups=[people]), seconds=10, exact=True)
frame = simulation.step()
at, velocity = frame.positions_m[:, :2].copy(), numpy.zeros((200, 2))
goals = -at  # each to the opposite side
for frame in simulation:
    away = at[:, None] - at[None]
    apart = numpy.linalg.norm(away, axis=2) + 10 * numpy.eye(200)
    push = (away / apart[..., None] * (2 * numpy.exp((0.5 - apart) / 0.15))[..., None]).sum(axis=1)
    towards = (goals - at) / numpy.maximum(numpy.linalg.norm(goals - at, axis=1, keepdims=True), 0.5)
    velocity += (2 * (1.2 * towards - velocity) + push.clip(-4, 4)) * simulation.step_s
    at = (at + velocity * simulation.step_s).clip(-15, 15)
    simulation.set_pose(range(200), at, velocities_mps=velocity)
    if frame.number % 60 == 0:
        print(f"{frame.time_s:4.1f} s: mean speed {frame.speeds_mps.mean():.2f} m/s, {len(frame.pairs)} pairs touch")
