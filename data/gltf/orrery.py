# Opens what gray wrote, gives the outer planet a moon and a tint, and writes the animation again.
# blender -b --python orrery.py -- orrery.glb orrery-back.glb
import sys

import bpy
import numpy

for name, kind in (('bool', bool), ('float', float), ('int', int), ('object', object)):
    if name not in numpy.__dict__:
        setattr(numpy, name, kind)  # the importer of Blender 3.4 asks for them

source, target = sys.argv[sys.argv.index('--') + 1:][:2]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=source)

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

bpy.ops.export_scene.gltf(filepath=target, export_format='GLB', export_cameras=True, export_lights=True)
