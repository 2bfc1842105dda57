# Opens what gray wrote, gives the outer planet a moon and a tint, and writes the animation again.
# blender -b --python orrery.py -- orrery.glb orrery-back.glb
import os
import sys

import bpy

sys.path.append(os.path.dirname(os.path.abspath(__file__)))
from blender import open_glb, save_glb  # noqa: E402

source, target = sys.argv[sys.argv.index('--') + 1:][:2]
open_glb(source)

planet = bpy.data.objects['outer']
paint = planet.data.materials[0].copy()
paint.name = 'green'
paint.node_tree.nodes['Principled BSDF'].inputs['Base Color'].default_value = (0.1, 0.45, 0.15, 1)
planet.material_slots[0].link = 'OBJECT'
planet.material_slots[0].material = paint

bpy.ops.mesh.primitive_uv_sphere_add(radius=0.5)  # the planet has the radius 1 in its own space
moon = bpy.context.object
moon.name = 'moon'
moon.parent = planet
moon.location = (1.7, 0, 0.6)
moon.data.materials.append(paint)
bpy.ops.object.shade_smooth()

save_glb(target)
