# Reads and writes GLB files in Blender, for vases.py, orrery.py and tools/check_gltf.py.
import bpy
import numpy

for name, kind in (('bool', bool), ('float', float), ('int', int), ('object', object)):
    if name not in numpy.__dict__:
        setattr(numpy, name, kind)  # the importer of Blender 3.4 asks for them; newer versions do not have them


def open_glb(path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=path)


def save_glb(path):
    bpy.ops.export_scene.gltf(filepath=path, export_format='GLB', export_cameras=True, export_lights=True)
