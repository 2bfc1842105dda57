# Opens what gray wrote, gives the plain vase a ring as a handle and a blue glaze, and writes it again.
# blender -b --python vases.py -- vases.glb vases-back.glb
import os
import sys

import bpy

sys.path.append(os.path.dirname(os.path.abspath(__file__)))
from blender import open_glb, save_glb  # noqa: E402

source, target = sys.argv[sys.argv.index('--') + 1:][:2]
open_glb(source)

vase = bpy.data.objects['plain']
glaze = vase.data.materials[0].copy()
glaze.name = 'glaze'
shader = glaze.node_tree.nodes['Principled BSDF']
shader.inputs['Base Color'].default_value = (0.05, 0.16, 0.5, 1)
shader.inputs['Roughness'].default_value = 0.15
vase.data.materials[0] = glaze

for side in (-1, 1):  # the vase stands along z here
    bpy.ops.mesh.primitive_torus_add(location=vase.matrix_world.translation, rotation=(1.5708, 0, 0), major_radius=0.32,
                                     minor_radius=0.06)
    handle = bpy.context.object
    handle.name = 'handle'
    handle.location.x += side * 0.62
    handle.location.z += 1.45
    handle.data.materials.append(glaze)
    bpy.ops.object.shade_smooth()

save_glb(target)
