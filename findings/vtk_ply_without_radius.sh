#!/bin/sh
# VTK 9.7.2, vtkPLYWriter: of a point cloud, positions are written, and the one array that SetArrayName calls colors. A point array
# `radius` is left out; Write() returns 1 and the error code is 0. vtkPLYReader reads a file that has `radius` without it, too.
# One expects a property of that name, which the format allows, or an error: particles lose their radius on the way through VTK.
# CSV and VTK's own formats keep all arrays.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/python"
"$folder/python/bin/pip" install --quiet vtk==9.7.2
cd "$folder"
cat >read.ply <<'PLY'
ply
format ascii 1.0
element vertex 2
property float x
property float y
property float z
property float radius
end_header
0 0 0 0.1
1 0 0 0.2
PLY
python/bin/python - <<'PYTHON'
import sys

import vtk

print("VTK", vtk.vtkVersion.GetVTKVersion())
points = vtk.vtkPoints()
radius = vtk.vtkFloatArray()
radius.SetName("radius")
for index in range(2):
    points.InsertNextPoint(index, 0, 0)
    radius.InsertNextValue(0.1 * (index + 1))
cloud = vtk.vtkPolyData()
cloud.SetPoints(points)
cloud.GetPointData().AddArray(radius)
writer = vtk.vtkPLYWriter()
writer.SetInputData(cloud)
writer.SetFileName("written.ply")
writer.SetFileTypeToASCII()
succeeded = writer.Write() == 1 and writer.GetErrorCode() == 0
with open("written.ply") as file:
    properties = [line.split()[-1] for line in file if line.startswith("property float")]
print("written with success:", succeeded, "- properties:", ", ".join(properties))

reader = vtk.vtkPLYReader()
reader.SetFileName("read.ply")
reader.Update()
data = reader.GetOutput().GetPointData()
arrays = [data.GetArrayName(index) for index in range(data.GetNumberOfArrays())]
print("points read:", reader.GetOutput().GetNumberOfPoints(), "- arrays:", arrays)
if not succeeded or properties != ["x", "y", "z"] or arrays:
    sys.exit("changed: VTK keeps the radius of particles in PLY, or says that it does not")
PYTHON
echo "as described"
