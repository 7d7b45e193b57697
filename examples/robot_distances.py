"""robot_distances.py: how near the hands of the nearest person come to a robot in a shopping street."""
import numpy as np
import throng

simulation = throng.Simulation("robot_in_crowd", seconds=5)
group = simulation.people["group"]
robot, people = (group == 0).argmax(), np.flatnonzero(group > 0)
for frame in simulation:
    apart_m = np.linalg.norm(frame.positions_m[people] - frame.positions_m[robot], axis=1)
    person = people[apart_m.argmin()]
    hand = frame.distance(robot, None, person, "hand")  # all parts of the robot; the nearer hand
    if frame.number % 30 == 0:
        print(f"{frame.time_s:.1f} s: {hand.part_b_name} of {person} is {hand.lo_m:.3f} m from {hand.part_a_name}")
