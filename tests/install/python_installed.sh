#!/usr/bin/env bash
# The Python module as a package installs it, next to the command: the same hash, custom bodies, and data frames if
# pandas is installed.
set -euo pipefail
examples=$(cd "$(dirname "$0")/../../examples" && pwd)
cd "$(mktemp -d)"
cp "$examples/picker.urdf" .
hash=$(throng run plaza --seconds 1 --lcm off --log off | awk '$1 == "hash" {print $2}')
/usr/bin/python3 - "$hash" <<'PYTHON'
import sys, numpy as np, throng

run = throng.run("plaza", seconds=1)
assert run.hash == sys.argv[1], f"expected the command's hash {sys.argv[1]}, found {run.hash}"
robot = throng.Model("picker.urdf")
culler = throng.Culler(robot, exact=True, step_s=0.1)
culler.step(robot.poses(np.zeros((2, robot.joint_count)), positions_m=[[0, 0, 0], [0.05, 0, 0]]))
assert len(culler.pairs) > 0, "expected two robots at nearly the same position to touch"
try:
    import pandas
except ImportError:
    sys.exit()
assert len(run.people.to_pandas()) == len(run.people)
PYTHON
