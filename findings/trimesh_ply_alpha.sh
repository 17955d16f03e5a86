#!/bin/sh
# trimesh 5.2.0: a point cloud with colors of three channels, red, green and blue, is written as PLY with a fourth, `uchar alpha`,
# of 255 at every point. One expects the channels that were given: a reader that takes alpha for the opacity or the amount of a
# particle finds one that nobody set, and it is full.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/python"
"$folder/python/bin/pip" install --quiet numpy==2.3.5 trimesh==5.2.0
"$folder/python/bin/python" - <<'PYTHON'
import sys

import numpy
import trimesh

print("trimesh", trimesh.__version__)
colors = numpy.array([[255, 128, 0], [0, 128, 255]], dtype=numpy.uint8)
cloud = trimesh.PointCloud([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]], colors=colors)
text = trimesh.exchange.ply.export_ply(cloud, encoding="ascii").decode()
print(text)
properties = [line.split()[-1] for line in text.splitlines() if line.startswith("property uchar")]
alphas = [line.split()[-1] for line in text.split("end_header")[1].splitlines() if line.strip()]
if properties != ["red", "green", "blue", "alpha"] or alphas != ["255", "255"]:
    sys.exit("changed: trimesh writes the channels that it was given")
PYTHON
echo "as described"
