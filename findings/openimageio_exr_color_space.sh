#!/bin/sh
# OpenImageIO 3.2.2.0 (PyPI): an OpenEXR image of the color space ACEScg is written with the attribute colorInteropID alone, without
# chromaticities. OpenEXR's own documents say that the colors of a file without chromaticities are those of Rec.709: a reader that
# knows only these, as most do, shows the image too dull, without a word. The other way round, OpenImageIO names no color space for a
# file whose chromaticities are those of ACEScg. Expected: both attributes written, and either one read. haze reads both.
# Seen: "written: interop ID lin_ap1_scene, chromaticities none", "read: color space none".
set -eu
temporary=$(mktemp -d)
trap 'rm -rf "$temporary"' EXIT
python3 -m venv "$temporary/venv"
"$temporary/venv/bin/pip" install --quiet openimageio==3.2.2.0 openexr==3.5.3 numpy==2.4.6
"$temporary/venv/bin/python" - "$temporary" <<'PYTHON'
import os
import sys

import numpy
import OpenEXR
import OpenImageIO

os.chdir(sys.argv[1])


def write(name, attribute, *value):
    spec = OpenImageIO.ImageSpec(8, 4, 3, "half")
    spec.attribute(attribute, *value)
    output = OpenImageIO.ImageOutput.create(name)
    output.open(name, spec)
    output.write_image(numpy.full((4, 8, 3), 0.5, dtype=numpy.float32))
    output.close()


write("named.exr", "oiio:ColorSpace", "ACEScg")
header = OpenEXR.File("named.exr").header()
written = header.get("colorInteropID"), header.get("chromaticities")
print("written: interop ID %s, chromaticities %s" % (written[0], written[1] or "none"))

acescg = (0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767)
write("measured.exr", "chromaticities", "float[8]", acescg)
read = OpenImageIO.ImageInput.open("measured.exr").spec()
space = read.getattribute("oiio:ColorSpace")
print("read: color space %s" % (space or "none"))

if written != ("lin_ap1_scene", None) or space:
    sys.exit("the behavior has changed")
PYTHON
