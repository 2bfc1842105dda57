# Renders a scene of bench/path.sh with Cycles: blender -b --factory-startup -P cycles.py -- SCENE FOLDER DEPTH RUN...
# A run is NAME:SPP:SEED:ROULETTE; its picture goes to FOLDER/NAME.exr, and "NAME SPP processor seconds, wall seconds"
# to standard output after the word "cycles". FOLDER holds meshes.obj, sky.hdr and smoke.vdb (bench/path.sh makes
# them). One thread, box filter, all caustics; no clamps, no adaptive sampling, no denoiser, no threshold for lights. Depth counts
# scattering events as gray does. ROULETTE 0: paths end only where their weight is 0.
import math
import os
import sys
import time

import bpy
from mathutils import Matrix, Vector

scene_name, folder, depth = sys.argv[sys.argv.index('--') + 1:][:3]
runs = sys.argv[sys.argv.index('--') + 4:]
folder, depth = os.path.abspath(folder), int(depth)
root = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.engine = 'CYCLES'


# Gray's axis y points up, Blender's z.
def point(p):
    return Vector((p[0], -p[2], p[1]))


# --- materials ---

def material(name, build):
    m = bpy.data.materials.new(name)
    m.use_nodes = True
    nodes, links = m.node_tree.nodes, m.node_tree.links
    nodes.clear()
    out = nodes.new('ShaderNodeOutputMaterial')
    links.new(build(nodes, links).outputs[0], out.inputs['Surface'])
    return m


def with_values(node, **values):
    for name, value in values.items():
        node.inputs[name.replace('_', ' ')].default_value = value
    return node


def added(nodes, links, a, b):
    add = nodes.new('ShaderNodeAddShader')
    links.new(a.outputs[0], add.inputs[0])
    links.new(b.outputs[0], add.inputs[1])
    return add


def diffuse(r, g, b):
    return material('diffuse', lambda nodes, links: with_values(nodes.new('ShaderNodeBsdfDiffuse'), Color=(r, g, b, 1)))


def textured(file, tiles):
    def build(nodes, links):
        image = nodes.new('ShaderNodeTexImage')
        image.image = bpy.data.images.load(os.path.join(root, 'textures', file))
        scale = with_values(nodes.new('ShaderNodeMapping'), Scale=(*tiles, 1))
        links.new(nodes.new('ShaderNodeTexCoord').outputs['UV'], scale.inputs['Vector'])
        links.new(scale.outputs[0], image.inputs[0])
        node = nodes.new('ShaderNodeBsdfDiffuse')
        links.new(image.outputs[0], node.inputs['Color'])
        return node
    return material(file, build)


def glowing(colour, emission):
    return material('glowing', lambda nodes, links: added(
        nodes, links, with_values(nodes.new('ShaderNodeBsdfDiffuse'), Color=(*colour, 1)),
        with_values(nodes.new('ShaderNodeEmission'), Color=(*emission, 1), Strength=1)))


def glossy(colour, roughness, under=None):
    def build(nodes, links):
        node = with_values(nodes.new('ShaderNodeBsdfGlossy'), Color=(*colour, 1), Roughness=roughness)
        node.distribution = 'GGX' if roughness > 0 else 'SHARP'
        if under is None:
            return node
        return added(nodes, links, node, with_values(nodes.new('ShaderNodeBsdfDiffuse'), Color=(*under, 1)))
    return material('glossy', build)


def glass(index=1.5):
    def build(nodes, links):
        node = with_values(nodes.new('ShaderNodeBsdfGlass'), Color=(1, 1, 1, 1), Roughness=0, IOR=index)
        node.distribution = 'SHARP'
        return node
    return material('glass', build)


# Adds a medium: nodes of a material or of the world, coefficients per unit of length, mean cosine.
def fill(nodes, links, scattering, absorption, g, density=None):
    def part(kind, coefficient, **values):
        node = with_values(nodes.new(kind), Color=(*coefficient, 1), Density=1, **values)
        # Colours above 1 are clamped, densities are not.
        scale = max(coefficient)
        if scale > 0:
            with_values(node, Color=(*(c / scale for c in coefficient), 1), Density=scale)
        if density:
            times = nodes.new('ShaderNodeMath')
            times.operation = 'MULTIPLY'
            links.new(density.outputs['Fac'], times.inputs[0])
            times.inputs[1].default_value = scale
            links.new(times.outputs[0], node.inputs['Density'])
        return node
    scatter = part('ShaderNodeVolumeScatter', scattering, Anisotropy=g)
    # The node of absorption takes 1 - colour.
    scale = max(absorption)
    absorb = part('ShaderNodeVolumeAbsorption', absorption)
    with_values(absorb, Color=(*(1 - c / scale for c in absorption), 1))
    out = next(node for node in nodes if node.type in ('OUTPUT_MATERIAL', 'OUTPUT_WORLD'))
    links.new(added(nodes, links, scatter, absorb).outputs[0], out.inputs['Volume'])


# --- shapes ---

def mesh(name, verts, faces, look, uvs=None, smooth=False):
    data = bpy.data.meshes.new(name)
    data.from_pydata([point(v) for v in verts], [], faces)
    if uvs:
        layer = data.uv_layers.new()
        for loop in data.loops:
            layer.data[loop.index].uv = uvs[loop.vertex_index]
    for polygon in data.polygons:
        polygon.use_smooth = smooth
    data.materials.append(look)
    scene.collection.objects.link(bpy.data.objects.new(name, data))


def rectangle(look, corner, along, up):
    c, a, u = Vector(corner), Vector(along), Vector(up)
    mesh('rectangle', [c, c + a, c + a + u, c + u], [(0, 1, 2, 3)], look, [(0, 0), (1, 0), (1, 1), (0, 1)])


BOX = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def box(look, low, high, degrees=0, move=(0, 0, 0)):
    turn = Matrix.Rotation(math.radians(degrees), 3, 'Y')
    verts = [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    mesh('box', [turn @ Vector(v) + Vector(move) for v in verts], BOX, look)


# Cycles has no spheres of its own but triangles with interpolated normals.
def sphere(look, centre, radius, n=128):
    verts, faces = [], []
    for i in range(n + 1):
        for j in range(2 * n):
            a, b = math.pi * i / n, math.pi * j / n
            verts.append((centre[0] + radius * math.sin(a) * math.cos(b), centre[1] + radius * math.cos(a),
                          centre[2] + radius * math.sin(a) * math.sin(b)))
    for i in range(n):
        for j in range(2 * n):
            k = (j + 1) % (2 * n)
            quad = [i * 2 * n + j, i * 2 * n + k, (i + 1) * 2 * n + k, (i + 1) * 2 * n + j]
            faces.append(quad)
    mesh('sphere', verts, faces, look, smooth=True)


# A spherical lamp that is seen and sends this radiance.
def spherical_light(centre, radius, emission):
    light = bpy.data.lights.new("light", 'POINT')
    light.shadow_soft_size = radius
    light.color = emission
    light.energy = 4 * math.pi ** 2 * radius ** 2
    thing = bpy.data.objects.new('lamp', light)
    thing.location = point(centre)
    thing.visible_camera = thing.visible_glossy = thing.visible_transmission = True
    scene.collection.objects.link(thing)


# The objects of meshes.obj, in order.
def read_meshes(looks):
    verts, faces, name, first = [], [], None, 1

    def finish():
        if name:
            mesh(name, verts, faces, looks[name], smooth=True)
    with open(os.path.join(folder, 'meshes.obj')) as file:
        for line in file:
            words = line.split()
            if words and words[0] == 'o':
                finish()
                first += len(verts)
                verts, faces, name = [], [], words[1]
            elif words and words[0] == 'v':
                verts.append(tuple(map(float, words[1:4])))
            elif words and words[0] == 'f':
                faces.append(tuple(int(word) - first for word in words[1:]))
    finish()


# --- scenes: those of the Lua scripts, with the same numbers ---

def camera(eye, target, fov):
    data = bpy.data.cameras.new('camera')
    data.sensor_fit = 'VERTICAL'
    data.angle = math.radians(fov)
    data.clip_start = 1e-3
    thing = bpy.data.objects.new('camera', data)
    thing.location = point(eye)
    thing.rotation_euler = (point(target) - point(eye)).to_track_quat('-Z', 'Y').to_euler()
    scene.collection.objects.link(thing)
    scene.camera = thing


def cornell():
    white, red, green = diffuse(.73, .73, .73), diffuse(.63, .065, .05), diffuse(.14, .45, .091)
    rectangle(white, (0, 0, 0), (5.528, 0, 0), (0, 0, -5.592))
    rectangle(white, (0, 0, -5.592), (5.528, 0, 0), (0, 5.488, 0))
    rectangle(red, (0, 0, 0), (0, 0, -5.592), (0, 5.488, 0))
    rectangle(green, (5.528, 0, 0), (0, 0, -5.592), (0, 5.488, 0))
    rectangle(white, (0, 5.488, 0), (5.528, 0, 0), (0, 0, -2.27))
    rectangle(white, (0, 5.488, -3.32), (5.528, 0, 0), (0, 0, -2.272))
    rectangle(white, (0, 5.488, -2.27), (2.13, 0, 0), (0, 0, -1.05))
    rectangle(white, (3.43, 5.488, -2.27), (2.098, 0, 0), (0, 0, -1.05))
    rectangle(glowing((.78, .78, .78), (18.4, 15.6, 8)), (2.13, 5.488, -2.27), (1.3, 0, 0), (0, 0, -1.05))
    camera((2.78, 2.73, 8), (2.78, 2.73, 0), 39.3)
    return white


def blocks():
    white = cornell()
    box(white, (-.825, 0, -.825), (.825, 1.65, .825), -17, (3.68, 0, -1.69))
    box(white, (-.825, 0, -.825), (.825, 3.3, .825), 17, (1.86, 0, -3.51))


def spheres():
    cornell()
    sphere(glossy((.95, .95, .95), 0), (1.65, 1.1, -3.6), 1.1)
    sphere(glass(), (3.8, 1, -1.9), 1)


def room(white, floor, left, right):
    rectangle(floor, (-5, 0, 3), (10, 0, 0), (0, 0, -13))
    rectangle(white, (-5, 4, 3), (10, 0, 0), (0, 0, -13))
    rectangle(white, (-5, 0, -10), (10, 0, 0), (0, 4, 0))
    rectangle(left, (-5, 0, 3), (0, 0, -13), (0, 4, 0))
    rectangle(right, (5, 0, 3), (0, 0, -13), (0, 4, 0))
    rectangle(white, (-5, 0, 3), (10, 0, 0), (0, 4, 0))


def many_lights():
    white = diffuse(.72, .7, .66)
    room(white, textured('parquet.png', (5, 6)), diffuse(.6, .2, .15), diffuse(.2, .35, .6))
    for i in range(10):
        z = -1 - 2 * (i // 2)
        box(white, (i % 2 * 5 - 2.7, 0, z - .2), (i % 2 * 5 - 2.3, 4, z + .2))
    for i in range(200):
        hue = i * .618 % 1
        colour = (20 + 16 * math.cos(6.2832 * hue), 20, 20 - 16 * math.cos(6.2832 * hue))
        spherical_light((-4.5 + i % 10, 3.6, 2 - i // 10 * .6), .05, colour)
    camera((1.2, 1.7, 2.5), (-.4, 1.7, -5), 60)


def glossy_room():
    white = diffuse(.7, .7, .68)
    rectangle(glossy((.675, .648, .612), .4, (.1, .1, .1)), (-3, 0, 3), (6, 0, 0), (0, 0, -6))
    rectangle(white, (-3, 4, 3), (6, 0, 0), (0, 0, -6))
    rectangle(textured('tiles.png', (3, 2)), (-3, 0, -3), (6, 0, 0), (0, 4, 0))
    rectangle(diffuse(.6, .15, .12), (-3, 0, 3), (0, 0, -6), (0, 4, 0))
    rectangle(diffuse(.15, .45, .2), (3, 0, 3), (0, 0, -6), (0, 4, 0))
    rectangle(white, (-3, 0, 3), (6, 0, 0), (0, 4, 0))
    rectangle(glowing((.5, .5, .5), (9, 8.4, 7.5)), (-.8, 3.99, .8), (1.6, 0, 0), (0, 0, -1.6))
    sphere(glossy((.95, .8, .45), .25, (.02, .02, .02)), (-1.2, .9, -.9), .9)
    sphere(glass(), (1.2, .75, .1), .75)
    camera((0, 2, 2.9), (0, 1.5, -2), 75)


def mesh_sky():
    big = 1000
    mesh('plane', [(-big, 0, big), (big, 0, big), (big, 0, -big), (-big, 0, -big)], [(0, 1, 2, 3)],
         diffuse(.6, .58, .55))
    read_meshes({'knot': diffuse(.7, .25, .15), 'pot': diffuse(.2, .4, .65)})
    world = bpy.data.worlds.new('world')
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    sky = nodes.new('ShaderNodeTexEnvironment')
    sky.image = bpy.data.images.load(os.path.join(folder, 'sky.hdr'))
    # The middle of the map shows gray's -z, Blender's y; by itself that of Blender shows x.
    turn = with_values(nodes.new('ShaderNodeMapping'), Rotation=(0, 0, -math.pi / 2))
    links.new(nodes.new('ShaderNodeTexCoord').outputs['Generated'], turn.inputs['Vector'])
    links.new(turn.outputs[0], sky.inputs[0])
    links.new(sky.outputs[0], nodes['Background'].inputs['Color'])
    scene.world = world
    camera((0, 2.4, 5.2), (.05, .45, 0), 38)


def fog_hall():
    white = diffuse(.6, .58, .55)
    rectangle(diffuse(.35, .3, .25), (-4, 0, 4), (8, 0, 0), (0, 0, -12))
    rectangle(white, (-4, 5, 4), (8, 0, 0), (0, 0, -12))
    rectangle(white, (-4, 0, -8), (8, 0, 0), (0, 5, 0))
    rectangle(diffuse(.5, .2, .15), (-4, 0, 4), (0, 0, -12), (0, 5, 0))
    rectangle(diffuse(.15, .3, .5), (4, 0, 4), (0, 0, -12), (0, 5, 0))
    rectangle(white, (-4, 0, 4), (8, 0, 0), (0, 5, 0))
    for i in range(6):
        x, z = i % 2 * 4 - 2, -1 - 2.5 * (i // 2)
        box(white, (x - .3, 0, z - .3), (x + .3, 3.5, z + .3))
    spherical_light((-1, 2.6, -3), .1, (120, 96, 64))
    spot = bpy.data.lights.new('spot', 'SPOT')
    spot.shadow_soft_size, spot.spot_size, spot.spot_blend = 0, math.radians(24), 0
    # Gray's intensity is pi times less than that of watts per steradian; a point light of Blender has its energy / 4 pi.
    spot.energy = 4 * math.pi * math.pi * 160
    thing = bpy.data.objects.new('spot', spot)
    thing.location = point((3, 4.8, -5))
    thing.rotation_euler = (point((-1.2, 0, -1)) - point((3, 4.8, -5))).to_track_quat('-Z', 'Y').to_euler()
    scene.collection.objects.link(thing)
    world = bpy.data.worlds.new('world')
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    with_values(nodes['Background'], Color=(0, 0, 0, 1))
    fill(nodes, links, (.1, .1, .1), (.01, .01, .01), .5)
    scene.world = world
    camera((0, 2, 3.8), (0, 2.1, -4), 60)


def milk():
    rectangle(diffuse(.4, .25, .15), (-10, 0, 10), (20, 0, 0), (0, 0, -20))
    rectangle(glowing((0, 0, 0), (6, 6, 6)), (-2.5, 4, 1.5), (3, 0, 0), (0, 1.5, -3))
    rectangle(glowing((0, 0, 0), (.6, .7, .8)), (-10, 0, -4), (20, 0, 0), (0, 8, 0))
    box(glass(1.5), (-.6, .01, -.6), (.6, 2, .6))
    inside = glass(1.33 / 1.5)
    fill(inside.node_tree.nodes, inside.node_tree.links, (19.98, 19.9, 19.6), (.02, .1, .4), .6)
    box(inside, (-.5, .2, -.5), (.5, 1.9, .5))
    camera((2.4, 2.2, 4.2), (0, .95, 0), 34)


def smoke():
    rectangle(diffuse(.4, .4, .38), (-10, -1, 10), (20, 0, 0), (0, 0, -20))
    rectangle(glowing((0, 0, 0), (12, 11, 10)), (1.5, 3, 1), (1.5, -1.5, 0), (0, 0, -2))
    rectangle(glowing((0, 0, 0), (.2, .3, .5)), (-10, -1, -5), (20, 0, 0), (0, 10, 0))
    bpy.ops.object.volume_import(filepath=os.path.join(folder, 'smoke.vdb'))
    volume = bpy.data.materials.new('smoke')
    volume.use_nodes = True
    nodes, links = volume.node_tree.nodes, volume.node_tree.links
    nodes.clear()
    nodes.new('ShaderNodeOutputMaterial')
    density = nodes.new('ShaderNodeAttribute')
    density.attribute_name = 'density'
    fill(nodes, links, (11.4, 11.4, 11.4), (.6, .6, .6), 0, density)
    thing = bpy.context.object
    thing.location = thing.rotation_euler = (0, 0, 0)
    thing.data.materials.append(volume)
    camera((0, .4, 4.6), (0, .05, 0), 34)


{'fog': fog_hall, 'milk': milk, 'smoke': smoke, 'cornell': blocks, 'spheres': spheres, 'lamps': many_lights, 'glossy': glossy_room, 'mesh_sky': mesh_sky}[scene_name]()

# --- rendering ---

render, cycles = scene.render, scene.cycles
render.resolution_x = render.resolution_y = 128
render.resolution_percentage = 100
render.threads_mode, render.threads = 'FIXED', int(os.environ.get('THREADS', 1))
render.image_settings.file_format = 'OPEN_EXR'
render.image_settings.color_depth = '32'
render.image_settings.exr_codec = 'NONE'
render.image_settings.color_mode = 'RGB'
render.use_persistent_data = True
render.film_transparent = False
cycles.device = 'CPU'
cycles.use_adaptive_sampling = cycles.use_denoising = False
cycles.pixel_filter_type, cycles.filter_width = 'BOX', 1
cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = depth - 1
cycles.transmission_bounces = cycles.transparent_max_bounces = cycles.volume_bounces = depth - 1
cycles.caustics_reflective = cycles.caustics_refractive = True
cycles.blur_glossy = cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
cycles.light_sampling_threshold = 0
for run in runs:
    name, spp, seed, roulette = run.split(':')
    cycles.samples, cycles.seed = int(spp), int(seed)
    cycles.min_light_bounces = 0 if roulette == '1' else depth
    cycles.min_transparent_bounces = 0 if roulette == '1' else depth
    render.filepath = os.path.join(folder, name + '.exr')
    processor, wall = time.process_time(), time.monotonic()
    bpy.ops.render.render(write_still=True)
    print('cycles', name, spp, '%.3f %.3f' % (time.process_time() - processor, time.monotonic() - wall), flush=True)
