"""Reads an EXR of `haze render` in Blender's compositor, as the Python module bpy: each layer is a pass, and Alpha Over is exact.

Usage: blender.py IMAGE.exr
"""

import pathlib
import sys
import tempfile

import bpy
import numpy as np
import OpenEXR

# Channels of the layers that an image of a system that burns has. Blender has them as passes, values, vectors, or colors.
LAYERS = {
    "amount": ["amount.Y"],
    "normal": ["normal.X", "normal.Y", "normal.Z"],
    "depth": ["depth.Z"],
    "motion": ["motion.X", "motion.Y", "motion.Z"],
    "emission": ["emission.R", "emission.G", "emission.B"],
}
COLOR = ["R", "G", "B", "A"]
GRAY = 0.3

failures = 0


def check(what, is_right, seen):
    global failures
    print(f"{'ok    ' if is_right else 'FAILED'} {what}: {seen}")
    failures += not is_right


def read_channels(path):
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return {name: channel.pixels.astype(np.float32) for name, channel in file.channels().items()}


class Compositor:
    """Shows a socket of a node tree as the image of the render."""

    def __init__(self, image_path):
        self.scene = bpy.context.scene
        self.tree = bpy.data.node_groups.new("test", "CompositorNodeTree")
        self.scene.compositing_node_group = self.tree
        self.tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        self.output = self.tree.nodes.new("NodeGroupOutput")
        self.image = self.tree.nodes.new("CompositorNodeImage")
        self.image.image = bpy.data.images.load(str(image_path))
        render = self.scene.render
        render.use_compositing = True
        render.resolution_percentage = 100
        render.image_settings.file_format = "OPEN_EXR"
        render.image_settings.color_mode = "RGBA"
        render.image_settings.color_depth = "32"
        render.image_settings.exr_codec = "ZIP"
        self.scene.view_settings.view_transform = "Raw"

    def shown(self, socket, shape):
        self.scene.render.resolution_y, self.scene.render.resolution_x = shape
        self.tree.links.new(socket, self.output.inputs[0])
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "shown.exr"
            self.scene.render.filepath = str(path)
            bpy.ops.render.render(write_still=True)
            found = read_channels(path)
        return np.stack([found[name] for name in COLOR], axis=-1)


def main(path):
    print(f"Blender {bpy.app.version_string}")
    written = read_channels(path)
    shape = written["R"].shape
    names = sorted(sum(LAYERS.values(), COLOR))
    check("channels of the image", sorted(written) == names, ", ".join(sorted(written)))
    compositor = Compositor(path)
    passes = [socket.name for socket in compositor.image.outputs]
    check("Blender has each layer as a pass", sorted(passes) == sorted(["Combined", "Alpha", *LAYERS]), ", ".join(passes))

    for name, channels in {"Combined": COLOR, **LAYERS}.items():
        expected = np.stack([written[channel] for channel in channels], axis=-1)
        shown = compositor.shown(compositor.image.outputs[name], shape)[..., : expected.shape[-1]]
        most = np.abs(shown - expected).max()
        spread = np.ptp(expected.reshape(-1, expected.shape[-1]), axis=0)
        # motion.Z is 0. Other channels differ from pixel to pixel, so that exchanged ones are seen.
        is_seen = (spread[: 2 if name == "motion" else 4] > 0).all()
        check(f"pass {name}", most == 0 and is_seen, f"at most {most:g} from the file, whose values span {spread}")

    over = compositor.tree.nodes.new("CompositorNodeAlphaOver")
    over.inputs["Background"].default_value = (GRAY, GRAY, GRAY, 1)
    compositor.tree.links.new(compositor.image.outputs["Combined"], over.inputs["Foreground"])
    shown = compositor.shown(over.outputs[0], shape)
    alpha = written["A"][..., None]
    color = np.stack([written[name] for name in COLOR[:3]], axis=-1)
    most = np.abs(shown[..., :3] - (color + GRAY * (1 - alpha))).max()
    straight = np.abs(shown[..., :3] - (color * alpha + GRAY * (1 - alpha))).max()
    # The rounding of 32-bit floats.
    check("Alpha Over on gray", most < 1e-5 < straight, f"at most {most:g} from premultiplied over, {straight:.2f} from straight")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1])))
