-- A scene as the JSON of a glTF file (docs/export.md says what becomes what). gray gives numbers and adds arrays to the
-- buffer; here are the nodes, their poses and keys, materials, lights, the camera and the lists of the file.
--
-- A node of the scene is a node of the file, with the mesh of its primitive; further placements of a node are further
-- nodes with the same mesh. A node of a file has a translation, a rotation and a scale: other maps are two nodes, by the
-- singular value decomposition (one-sided Jacobi: Golub and Van Loan, "Matrix Computations", 8.6.3). Maps are the 12
-- numbers of three rows.
local abs, sqrt, pi, max, min, floor = math.abs, math.sqrt, math.pi, math.max, math.min, math.floor
local concat, sort, unpack = table.concat, table.sort, table.unpack
local format, pack, rep, sub = string.format, string.pack, string.rep, string.sub

-- Files have lumens where the scene has light: 683 of them count for a watt, as in files of Blender, and a white surface
-- that faces a light of colour 1 has the radiance 1 (script/gr_model.c reads lights so).
local LUMENS = 683 * pi
local IDENTITY = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}
local IDENTITY_POSE = {translation = {0, 0, 0}, rotation = {0, 0, 0, 1}, scale = {1, 1, 1}}
local DIFFERS = {} -- raised where a moment has other nodes than the first one

local nodes, roots, cursor = {}, {}, 1 -- cursor: the node of the next place in a later moment
local lists, numbers, extensions = {}, {}, {} -- of the file: texts, their numbers by text, names
local lacks, channels = {}, {}
local meshes = {} -- by the keys of their primitives; false: left out
local moments, moment = 0, nil

-- What the file does not have, once for each kind.
local function lack(what, name)
    if not lacks[what] then
        lacks[#lacks + 1] = what
        lacks[what] = {name = name or '', count = 0}
    end
    lacks[what].count = lacks[what].count + 1
end

-- --- JSON ---

-- The shortest that is read as the same number.
local function number_text(x)
    local text = format('%.15g', x)
    if tonumber(text) ~= x then text = format('%.16g', x) end
    return tonumber(text) == x and text or format('%.17g', x)
end

local function json(value)
    local kind = type(value)
    if kind == 'number' then return number_text(value) end
    if kind == 'string' then return (quote(value)) end
    if kind == 'boolean' then return tostring(value) end
    local parts, keys = {}, {}
    for k, entry in ipairs(value) do parts[k] = json(entry) end
    if #parts > 0 then return '[' .. concat(parts, ',') .. ']' end
    for key in pairs(value) do keys[#keys + 1] = key end
    sort(keys)
    for k, key in ipairs(keys) do parts[k] = '"' .. key .. '":' .. json(value[key]) end
    return '{' .. concat(parts, ',') .. '}'
end

-- Adds an element to a list of the file, or finds the equal one; its number.
local function add(list, element)
    local text = json(element)
    lists[list], numbers[list] = lists[list] or {}, numbers[list] or {}
    if not numbers[list][text] then
        numbers[list][text] = #lists[list]
        lists[list][#lists[list] + 1] = text
    end
    return numbers[list][text]
end

local function add_accessor(accessor, view)
    accessor.bufferView = add('bufferViews', view)
    return add('accessors', accessor)
end

local function extend(element, name, member, value)
    element.extensions = element.extensions or {}
    local own = element.extensions[name] or {}
    if member then own[member] = value end
    element.extensions[name], extensions[name] = own, true
end

-- --- poses ---

local function dot(a, b)
    return a[1] * b[1] + a[2] * b[2] + a[3] * b[3]
end

local function cross(a, b)
    return {a[2] * b[3] - a[3] * b[2], a[3] * b[1] - a[1] * b[3], a[1] * b[2] - a[2] * b[1]}
end

-- a + b s
local function add_scaled(a, b, s)
    return {a[1] + b[1] * s, a[2] + b[2] * s, a[3] + b[3] * s}
end

local function scaled(a, s)
    return {a[1] * s, a[2] * s, a[3] * s}
end

local function length(a)
    return sqrt(dot(a, a))
end

local function normalized(a)
    return scaled(a, 1 / length(a))
end

-- The map of a node that looks along -z, with y upwards.
local function looking(from, along, up)
    local z = normalized(scaled(along, -1.0))
    local x = cross(normalized(up), z)
    if length(x) <= 1e-9 then x = cross(abs(z[1]) < .7 and {1, 0, 0} or {0, 1, 0}, z) end
    x = normalized(x)
    local y = cross(z, x)
    return {x[1], y[1], z[1], from[1], x[2], y[2], z[2], from[2], x[3], y[3], z[3], from[3]}
end

local function compose(outer, inner)
    local out = {}
    for row = 0, 8, 4 do
        for k = 1, 4 do
            out[row + k] = outer[row + 1] * inner[k] + outer[row + 2] * inner[4 + k] + outer[row + 3] * inner[8 + k] +
                (k == 4 and outer[row + 4] or 0)
        end
    end
    return out
end

-- x y z w of a rotation by its columns: the largest of the four is computed first.
local function quaternion(c)
    local trace, q, k = c[1][1] + c[2][2] + c[3][3], {}, 4
    local largest = trace
    for i = 1, 3 do
        if c[i][i] > largest then k, largest = i, c[i][i] end
    end
    if k == 4 then
        q = {c[2][3] - c[3][2], c[3][1] - c[1][3], c[1][2] - c[2][1], 1 + trace}
    else
        local a, b = k % 3 + 1, (k + 1) % 3 + 1
        q[k], q[a], q[b] = 1 + c[k][k] - c[a][a] - c[b][b], c[k][a] + c[a][k], c[k][b] + c[b][k]
        q[4] = c[a][b] - c[b][a]
    end
    local size = sqrt(q[1] * q[1] + q[2] * q[2] + q[3] * q[3] + q[4] * q[4])
    for i = 1, 4 do q[i] = q[i] / size + 0.0 end
    return q
end

-- Turns the columns of `left` until they are at right angles; `right` is turned with them.
local function jacobi(left, right)
    for step = 0, 59 do
        local i, k = step % 3 + 1, (step + 1) % 3 + 1
        local a, b, c = dot(left[i], left[i]), dot(left[k], left[k]), dot(left[i], left[k])
        if abs(c) > 1e-15 * sqrt(a * b) then
            local zeta = (b - a) / (2 * c)
            local t = (zeta < 0 and -1 or 1) / (abs(zeta) + sqrt(1 + zeta * zeta))
            local cosine = 1 / sqrt(1 + t * t)
            local sine = cosine * t
            for _, side in ipairs {left, right} do
                local x, y = side[i], side[k]
                side[i] = add_scaled(scaled(x, cosine), y, -sine)
                side[k] = add_scaled(scaled(y, cosine), x, sine)
            end
        end
    end
end

-- The map as outer after inner, which is the identity unless the map shears; whether it does not.
local function poses_of(map)
    local left, right = {}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}
    for k = 1, 3 do left[k] = {map[k], map[4 + k], map[8 + k]} end
    local is_plain, flips = true, dot(map, cross({map[5], map[6], map[7]}, {map[9], map[10], map[11]})) < 0
    for i = 1, 3 do
        local a, b = left[i], left[i % 3 + 1]
        is_plain = is_plain and abs(dot(a, b)) <= 1e-12 * sqrt(dot(a, a) * dot(b, b))
    end
    if not is_plain then jacobi(left, right) end
    local outer = {translation = {map[4] + 0.0, map[8] + 0.0, map[12] + 0.0}, scale = {}}
    for i = 1, 3 do
        local size = length(left[i])
        outer.scale[i] = i == 1 and flips and -size or size
        left[i] = scaled(left[i], 1 / outer.scale[i])
    end
    outer.rotation = quaternion(left)
    if is_plain then return outer, IDENTITY_POSE, true end
    local back = quaternion(right)
    back[4] = 0.0 - back[4]
    return outer, {translation = {0, 0, 0}, rotation = back, scale = {1, 1, 1}}, false
end

-- The numbers as bytes, to compare them.
local function bits(list)
    return pack(rep('d', #list), unpack(list))
end

local function is_same(a, b)
    return bits(a.translation) == bits(b.translation) and bits(a.rotation) == bits(b.rotation) and bits(a.scale) == bits(b.scale)
end

-- Poses between keys are linear: a node that stands still has no keys, or those before and after.
local function add_key(node, time, pose)
    local last, along, keys = node.last, 0, node.keys
    for i = 1, 4 do along = along + last.pose.rotation[i] * pose.rotation[i] end
    if along < 0 then -- the same turn, along the shorter arc
        local turn = pose.rotation
        pose = {translation = pose.translation, rotation = {-turn[1], -turn[2], -turn[3], -turn[4]}, scale = pose.scale}
    end
    node.last = {time = time, pose = pose}
    if is_same(last.pose, pose) then return end
    if #keys == 0 or keys[#keys].time < last.time then keys[#keys + 1] = last end
    keys[#keys + 1] = node.last
end

local function new_node(parent, name, pose)
    local node = {number = #nodes, name = name, pose = pose, children = {}, keys = {}, mesh_nodes = 0}
    local siblings = parent and parent.children or roots
    node.last = {time = moment.time, pose = pose}
    nodes[#nodes + 1], siblings[#siblings + 1] = node, node.number
    return node
end

-- The next node below another one, in a later moment the same, and the node below that map.
local function node_for(parent, name, map)
    local outer, inner, is_plain = poses_of(map)
    if moments == 0 then
        local node = new_node(parent, name, outer)
        if not is_plain then node.sheared = new_node(node, name, inner) end
        return node, node.sheared or node
    end
    local node = nodes[cursor]
    if not node or node.name ~= name then error(DIFFERS) end
    add_key(node, moment.time, outer)
    if node.sheared then
        add_key(node.sheared, moment.time, inner)
    elseif not is_plain then
        lack('it is sheared in the animation, which is left out', name)
    end
    cursor = cursor + (node.sheared and 2 or 1)
    return node, node.sheared or node
end

-- A motion within a still scene: from time 0 to time 1.
local function add_motion(about, outer, inner, spun)
    for i = 1, about.steps do
        local pose, sheared = poses_of(node_map(i / about.steps))
        add_key(outer, i / about.steps, pose)
        if inner ~= outer then add_key(inner, i / about.steps, sheared) end
    end
    local turns = about.degrees ~= 0 and 1 + floor(min(abs(about.degrees) / 90, 10000)) or 0
    for i = 1, turns do
        add_key(spun, i / turns, (poses_of(node_spin(i / turns))))
    end
end

-- --- materials ---

local function largest(colour)
    return max(abs(colour[1]), abs(colour[2]), abs(colour[3]))
end

-- A texture with a picture that gray has put into the buffer; `how`: as a picture is used that was copied.
local WRAPS = {clamp = 33071, ['repeat'] = 10497, mirror = 33648}
local function add_texture(picture, how)
    local nearest = how and how.nearest
    local sampler = {
        magFilter = nearest and 9728 or 9729,
        minFilter = nearest and 9728 or how and 9987 or 9729, -- beside a baked texel are others
        wrapS = WRAPS[how and how.wrap_u or 'clamp'], wrapT = WRAPS[how and how.wrap_v or 'clamp']
    }
    local image = add('images', {bufferView = add('bufferViews', picture), mimeType = 'image/png'})
    return add('textures', {source = image, sampler = add('samplers', sampler)})
end

-- The inverse of read_map of formats/gltf_material.c.
local function texture_of(number, how, strength)
    if not number then return nil end
    local out, map = {index = number, scale = strength ~= 1 and strength or nil}, how and how.map
    if map then
        local a, d, b, c = map[1], map[2], -map[3], -map[4]
        local size, offset = {sqrt(a * a + c * c), sqrt(b * b + d * d)}, {map[5] - b, 1 - d - map[6]}
        local turn = size[1] > 0 and atan2(-c, a) or 0
        if turn ~= 0 or size[1] ~= 1 or size[2] ~= 1 or offset[1] ~= 0 or offset[2] ~= 0 then
            extend(out, 'KHR_texture_transform', 'offset', offset)
            extend(out, 'KHR_texture_transform', 'rotation', turn)
            extend(out, 'KHR_texture_transform', 'scale', size)
        end
    end
    return out
end

-- The extensions of a material. Members with their default value are left out.
local function extend_material(out, m, strength)
    local lit = not m.unlit
    local coat, sheen, film = lit and m.coat > 0, lit and largest(m.sheen) > 0, lit and m.film > 0
    local clear = lit and m.transmission > 0
    local solid = clear and m.is_solid
    local rows = { -- extension, whether it is there, member, value, default
        {'emissive_strength', true, 'emissiveStrength', strength, 1},
        {'unlit', m.unlit},
        {'ior', lit, 'ior', m.ior, 1.5},
        {'specular', lit, 'specularFactor', m.specular_weight, 1},
        {'specular', lit, 'specularColorFactor', m.specular, {1, 1, 1}},
        {'transmission', clear, 'transmissionFactor', m.transmission, 0},
        {'volume', solid, 'thicknessFactor', 1, 0},
        {'volume', solid, 'attenuationDistance', m.distance, 0},
        {'volume', solid and m.distance > 0, 'attenuationColor', m.attenuation, {1, 1, 1}},
        {'dispersion', solid, 'dispersion', m.dispersion, 0},
        {'clearcoat', coat, 'clearcoatFactor', m.coat, 0},
        {'clearcoat', coat, 'clearcoatRoughnessFactor', m.coat_roughness, 0},
        {'sheen', sheen, 'sheenColorFactor', m.sheen, {0, 0, 0}},
        {'sheen', sheen, 'sheenRoughnessFactor', m.sheen_roughness, 0},
        {'iridescence', film, 'iridescenceFactor', m.film, 0},
        {'iridescence', film, 'iridescenceIor', m.film_ior, 1.3},
        {'iridescence', film, 'iridescenceThicknessMinimum', m.film_thickness, 100},
        {'iridescence', film, 'iridescenceThicknessMaximum', m.film_thickness, 400}
    }
    for _, row in ipairs(rows) do
        local name, is_there, member, value, default = unpack(row)
        if is_there and (not member or json(value) ~= json(default)) then extend(out, 'KHR_materials_' .. name, member, value) end
    end
end

-- A material of the world on a surface: its number, and which attributes of vertices it needs. `baked`: the textures.
local function add_material(index, surface, baked)
    local m = material_of(index)
    local base, normal, rough, emission
    if m.scatters then lack('light that is scattered under the surface is a colour of the surface', m.name) end
    if m.is_brushed then lack('the highlight has no direction', m.name) end
    if m.is_filled then lack('the medium inside is left out', m.name) end
    if m.is_baked then
        base, rough, emission, normal = baked.base, baked.rough, baked.emission, baked.normal
        if base or surface.by_vertex then m.base = {1, 1, 1} end
        if emission then m.emission = {surface.strongest, surface.strongest, surface.strongest} end
        if rough then m.metallic, m.roughness = 1, 1 end
        if base then m.alpha = 1 end
    else
        base = m.base_copy and add_texture(m.base_copy.picture, m.base_copy)
        normal = m.normal_copy and add_texture(m.normal_copy.picture, m.normal_copy)
    end
    local blends = m.alpha < 1
    if m.is_baked and base then blends = surface.has_veils end
    local masks = m.is_baked and base and surface.has_holes and not blends
    local strength = max(largest(m.emission), 1)
    local out = {
        name = m.name ~= '' and m.name or nil,
        pbrMetallicRoughness = {
            baseColorFactor = {m.base[1], m.base[2], m.base[3], m.alpha},
            metallicFactor = min(max(m.metallic, 0), 1), roughnessFactor = min(max(m.roughness, 0), 1),
            baseColorTexture = texture_of(base, m.base_copy, 1), metallicRoughnessTexture = texture_of(rough, nil, 1)
        },
        normalTexture = texture_of(normal, m.normal_copy, m.height),
        emissiveFactor = largest(m.emission) > 0 and scaled(m.emission, 1 / strength) or nil,
        emissiveTexture = texture_of(emission, nil, 1),
        alphaMode = blends and 'BLEND' or masks and 'MASK' or nil,
        doubleSided = not m.is_solid and (surface.is_open or m.two_sided) or nil
    }
    extend_material(out, m, strength)
    return add('materials', out), {
        NORMAL = surface.has_normals or normal, TANGENT = normal, TEXCOORD_0 = base or rough or emission or normal,
        COLOR_0 = m.is_baked and surface.by_vertex or not m.is_baked and m.has_vertex_colours
    }
end

-- --- meshes ---

-- The number of the mesh of a primitive, or false: it is left out; and where one of unit size is, or nil.
local function mesh_of(primitive)
    local key, unit = mesh_key(primitive)
    if meshes[key] ~= nil then return meshes[key], unit end
    local surface, baked, primitives = surface_of(primitive), {}, {}
    if surface.why then lack(surface.why, surface.name) end
    for _, kind in ipairs {'base', 'rough', 'emission', 'normal'} do
        baked[kind] = surface[kind] and add_texture(surface[kind])
    end
    local done = {}
    for _, index in ipairs(surface.materials) do
        if not done[index] then
            done[index] = true
            local material, uses = add_material(index, surface, baked)
            local attributes = {POSITION = add_accessor(attribute 'POSITION')}
            for _, kind in ipairs {'NORMAL', 'TEXCOORD_0', 'TANGENT', 'COLOR_0'} do
                attributes[kind] = uses[kind] and add_accessor(attribute(kind)) or nil
            end
            primitives[#primitives + 1] = {attributes = attributes, indices = add_accessor(indices(index)), material = material}
        end
    end
    meshes[key] = #primitives > 0 and add('meshes', {name = surface.name, primitives = primitives})
    return meshes[key], unit
end

-- --- the tree ---

-- The node of the file that has what is below the node of the scene; and the outermost one for it.
local function enter_node(parent, about, below)
    local map = node_map()
    if below then map = compose(map, below) end
    local outer, inner = node_for(parent, about.name, map)
    local spun = inner
    if about.degrees ~= 0 then spun = node_for(inner, about.name, node_spin(moment.is_frame and moment.time or 0)) end
    if about.moves and moments == 0 and not moment.is_frame then add_motion(about, outer, inner, spun) end
    return spun, outer
end

-- A node with its primitives: the mesh of one stands in the node itself, if it is in its space.
local function enter(parent, about)
    if moments > 0 then
        local node = enter_node(parent, about, (nodes[cursor] or {}).below)
        cursor = cursor + node.mesh_nodes
        return node
    end
    local is_leaf = about.is_childless and not about.moves and about.count == 1
    local node, outer
    for i = about.first, about.first + about.count - 1 do
        local mesh, unit = mesh_of(i)
        if not node then node, outer = enter_node(parent, about, is_leaf and unit) end
        local holder, before = node, #nodes
        if is_leaf then
            outer.below = unit
        elseif mesh and (unit or about.count > 1) then
            _, holder = node_for(node, about.name, unit or IDENTITY)
        end
        holder.mesh = mesh or nil
        node.mesh_nodes = node.mesh_nodes + #nodes - before
    end
    return node or (enter_node(parent, about))
end

local function visit_tree(root)
    local of_node, of_children = {[0] = root}, {[0] = root} -- by depth: where operands are, and children
    for event, depth, about in visit do
        if event == 'enter' then
            of_node[depth] = enter((about.is_operand and of_node or of_children)[depth - 1], about)
            of_children[depth] = of_node[depth]
        else
            of_children[depth] = of_node[depth]
            if about.placement > 0 then
                local name = format('%s [%d]', sub(about.name, 1, 120), about.placement)
                _, of_children[depth] = node_for(of_node[depth], name, about.map)
            end
        end
    end
end

-- --- the camera and the lights ---

local function add_camera(camera)
    local bounds = moment.bounds
    local far = length {bounds[4] - camera.eye[1], bounds[5] - camera.eye[2], bounds[6] - camera.eye[3]} +
        length {bounds[4] - bounds[1], bounds[5] - bounds[2], bounds[6] - bounds[3]}
    if moment.is_empty then far = 1 end
    if camera.projection ~= 'perspective' and camera.projection ~= 'orthographic' then
        lack 'the camera has a perspective projection, not that of the scene'
    end
    if camera.is_special then lack 'the camera is a pinhole, without depth of field, shift, stereo and light field' end
    if camera.projection == 'orthographic' then
        local half = camera.view_height / 2
        local view = {xmag = half * camera.aspect, ymag = half, zfar = 2 * far, znear = 0}
        return add('cameras', {type = 'orthographic', orthographic = view})
    end
    return add('cameras', {type = 'perspective',
        perspective = {aspectRatio = camera.aspect, yfov = camera.fov * (pi / 180), znear = far / 10000}})
end

-- Light that does not fall off with the square of the distance has the strength that it has in the middle of the scene.
local function strength_of(light)
    local c, d, bounds, to = light.falloff, 1, moment.bounds, {}
    for k = 1, 3 do to[k] = (bounds[k] + bounds[3 + k]) * 0.5 - light.middle[k] end
    if not moment.is_empty then d = length(to) end
    if light.attenuation == 'square' then return light.intensity end
    if light.attenuation == 'coefficients' and c[1] == 0 and c[2] == 0 and c[3] > 0 then return 1 / c[3] end
    lack 'a light falls off with the square of the distance; in the middle of the scene it is as before'
    if light.attenuation == 'range' then return d * d * max(1 - d / light.range, 0) end
    local sum = c[1] + d * (c[2] + d * c[3])
    return d * d / (sum > 0 and sum or 1)
end

-- As the file has it: kind, strength and direction; nil: it is left out.
local function punctual_of(light)
    local kind, across = light.kind, cross(light.edge1, light.edge2)
    if kind == 'mesh light' then
        lack 'the light of a mesh is left out; its surface emits it'
    elseif kind == 'sky light' then
        lack 'the light of the sky is left out'
    elseif kind == 'point light' then
        return 'point', strength_of(light), {0, -1, 0}
    elseif kind == 'directional light' then
        return 'directional', 1, light.direction
    elseif kind == 'spot light' then
        light.outer = min(light.outer, pi / 2)
        light.inner = min(light.inner, 0.9999 * light.outer)
        return 'spot', strength_of(light), light.direction
    else
        local area = kind == 'area light' and length(across) / pi or light.radius * light.radius
        if light.emissive and area == 0 then return nil end -- it emits nothing
        lack 'a light with an extent is a point in its middle'
        if not light.emissive then return 'point', strength_of(light), {0, -1, 0} end
        light.inner, light.outer = 0, pi / 2
        local is_spot = light.one_sided and kind ~= 'spherical light'
        local along = kind == 'spherical light' and {0, -1, 0} or kind == 'disc light' and light.direction or across
        return is_spot and 'spot' or 'point', area, along
    end
end

local function add_light(light, kind, strength)
    local spot = kind == 'spot' and {innerConeAngle = light.inner, outerConeAngle = light.outer} or nil
    return add('lights', {color = light.shown, intensity = LUMENS * largest(light.colour) * strength, type = kind, spot = spot})
end

local function add_lights(root)
    for light in next_light do
        local kind, strength, along = punctual_of(light)
        if kind and largest(light.colour) > 0 then
            if light.has_profile then lack 'the profile of a light is left out' end
            if light.leaves_out then lack 'a light that leaves out nodes lights them, too' end
            local from = kind == 'directional' and {0, 0, 0} or light.middle
            local node = node_for(root, 'light', looking(from, along, {0, 1, 0}))
            if moments == 0 then
                node.light = add_light(light, kind, strength)
                extensions.KHR_lights_punctual = true
            end
        end
    end
end

local function add_scene()
    local camera, root = moment.camera, nil
    if camera and abs(camera.up[3]) > abs(camera.up[2]) then -- in a file y is up
        local side = camera.up[3] > 0 and 1.0 or -1.0
        root = node_for(nil, 'upright', {1, 0, 0, 0, 0, 0, side, 0, 0, -side, 0, 0})
    end
    if camera then
        local node = node_for(root, 'camera', looking(camera.eye, camera.view, camera.up))
        if moments == 0 then node.camera = add_camera(camera) end
    end
    add_lights(root)
    visit_tree(root)
end

-- --- the file ---

local function add_channel(node, path, input)
    local values, moves = {}, false
    for _, key in ipairs(node.keys) do
        for _, x in ipairs(key.pose[path]) do values[#values + 1] = x end
        moves = moves or bits(key.pose[path]) ~= bits(node.pose[path])
    end
    if moves then
        local output = add_accessor(floats(values, #node.pose[path]))
        local sampler = add('animation', {input = input, interpolation = 'LINEAR', output = output})
        channels[#channels + 1] = json {sampler = sampler, target = {node = node.number, path = path}}
    end
end

-- Equal nodes are several places.
local function node_text(node)
    local out = {name = node.name ~= '' and node.name or nil, mesh = node.mesh, camera = node.camera}
    for path, rest in pairs(IDENTITY_POSE) do
        if bits(node.pose[path]) ~= bits(rest) then out[path] = node.pose[path] end
    end
    if #node.children > 0 then out.children = node.children end
    if node.light then out.extensions = {KHR_lights_punctual = {light = node.light}} end
    return json(out)
end

local function list_text(texts)
    return texts and '[' .. concat(texts, ',') .. ']'
end

return {
    add = function(at)
        moment, cursor = at, 1
        local ok, caught = pcall(add_scene)
        if not ok and caught ~= DIFFERS then error(caught, 0) end
        if not ok then lack 'a frame shows other nodes than the first one: from there on nothing moves' end
        moments = moments + 1
    end,
    -- Warns, and returns the text without its first member, by which gray knows its files.
    write = function()
        local texts, names, out = {}, {}, {}
        for _, what in ipairs(lacks) do
            local name, count = lacks[what].name, lacks[what].count
            local more = count > 1 and format(' and %d more', count - 1) or ''
            warn_of((name == '' and '' or format("'%s'%s: ", sub(name, 1, 100), more)) .. what)
        end
        for k, node in ipairs(nodes) do
            texts[k] = node_text(node)
            if #node.keys > 0 then
                local times = {}
                for i, key in ipairs(node.keys) do times[i] = key.time end
                local input = add_accessor(floats(times, 1))
                for _, path in ipairs {'translation', 'rotation', 'scale'} do add_channel(node, path, input) end
            end
        end
        for name in pairs(extensions) do names[#names + 1] = name end
        sort(names)
        local bytes = buffer()
        local members = {
            animations = #channels > 0 and
                format('[{"channels":%s,"samplers":%s}]', list_text(channels), list_text(lists.animation)),
            buffers = bytes and json {bytes},
            extensions = lists.lights and format('{"KHR_lights_punctual":{"lights":%s}}', list_text(lists.lights)),
            extensionsUsed = #names > 0 and json(names),
            nodes = #nodes > 0 and list_text(texts),
            scene = '0',
            scenes = json {{nodes = #roots > 0 and roots or nil}}
        }
        for _, name in ipairs {'accessors', 'bufferViews', 'cameras', 'images', 'materials', 'meshes', 'samplers', 'textures'} do
            members[name] = list_text(lists[name])
        end
        names = {}
        for name, text in pairs(members) do names[#names + 1] = text and name or nil end
        sort(names)
        for k, name in ipairs(names) do out[k] = ',"' .. name .. '":' .. members[name] end
        return concat(out) .. '}'
    end
}
