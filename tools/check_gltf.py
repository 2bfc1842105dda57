# Renders NAME.glb in Cycles and compares it with gray's NAME.exr and NAME-mask.exr, for each NAME after --.
# A pixel counts if a light shines evenly on the 3 x 3 around it. Exit status 1: more than 0.1 % of the picture is
# covered otherwise, or the colours differ by more than 2 % in the median.
import os
import sys

import bpy
import numpy

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), '../data/gltf'))
from blender import open_glb  # noqa: E402


def load(path):
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = 'Non-Color'
    return numpy.array(image.pixels[:]).reshape(image.size[1], image.size[0], 4)


def render(name):
    open_glb(name + '.glb')
    scene = bpy.context.scene
    scene.camera = [o for o in scene.objects if o.type == 'CAMERA'][0]
    scene.render.engine = 'CYCLES'
    scene.cycles.samples = 64
    scene.cycles.use_denoising = False
    scene.cycles.max_bounces = scene.cycles.diffuse_bounces = 16
    scene.cycles.pixel_filter_type = 'BOX'
    scene.view_settings.view_transform = 'Standard'
    scene.render.film_transparent = True
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 320, 240, 100
    scene.render.image_settings.file_format = 'OPEN_EXR'
    scene.render.image_settings.color_mode = 'RGBA'
    scene.render.image_settings.color_depth = '32'
    scene.render.filepath = name + '-blender.exr'
    bpy.ops.render.render(write_still=True)
    return load(scene.render.filepath)


failed = False
for name in sys.argv[sys.argv.index('--') + 1:]:
    blender, gray, mask = render(name), load(name + '.exr'), load(name + '-mask.exr')
    covered = abs(blender[:, :, 3] - mask[:, :, 0]).mean()
    a, b = blender[:, :, :3], gray[:, :, :3]
    nearby = [numpy.roll(b, (y, x), (0, 1)).max(2) for y in (-1, 0, 1) for x in (-1, 0, 1)]
    even = (numpy.min(nearby, 0) > 0.85 * numpy.max(nearby, 0)) & (b.max(2) > 0.1) & (mask[:, :, 0] == 1)
    ratio = (b[even] / numpy.maximum(a[even], 1e-3)).max(1)
    middle = numpy.median(ratio)
    wrong = covered > 0.001 or abs(middle - 1) > 0.02 or even.sum() < 500
    print('%s%s: %.3f %% of the picture is covered otherwise; %d pixels have %.4f times the colour in the median' %
          ('FAILED: ' if wrong else '', name, 100 * covered, even.sum(), middle))
    failed = failed or wrong
sys.exit(int(failed))
