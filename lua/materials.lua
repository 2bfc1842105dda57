-- materials: forty finished materials by name: woods, stones, metals, paints, ceramics, fabrics, liquids, glasses.
-- They are layered materials (gr.openpbr_material) whose patterns are functions of the point of the object, so they fit
-- any shape without texture coordinates. Colours are linear: with Whitted's integrator use colour = 'linear'.
-- The patterns are made for objects about two units large; `scale` fits them to others.
-- Invariant: no material reflects more light than arrives; the same name and options make the same material.
-- Source: D. Ebert, F. K. Musgrave, D. Peachey, K. Perlin, S. Worley, "Texturing and Modeling", 3rd edition, 2003 (rings of
-- wood, veins by bent noise, cells).
--
--   local materials = require 'materials'
--   local table_top = gr.cylinder {material = materials.named 'walnut', from = {0, 0, 0}, to = {0, 0.1, 0}}
--   local vase = gr.sphere {material = materials.named('celadon', {scale = 3})}
--   for _, name in ipairs(materials.names()) do print(name, materials.families[name]) end

local check = require 'check'
local patterns = require 'patterns'

local M = {}

local floor, abs, sqrt, sin = math.floor, math.abs, math.sqrt, math.sin
local vec, mix, noise, smooth, clamp = gr.vec, gr.mix, gr.noise, gr.smoothstep, gr.clamp
local clouds, turbulence = patterns.clouds, patterns.turbulence

--- The light of a colour as a screen shows it.
local function c(text) return gr.linear(text) end

--- Noise in threads: fine across, long along x.
local function threads(p, fine, long) return noise(p.x * long + 0.3, p.y * fine + 0.7, p.z * fine + 0.1) end

--- Thin veins where noise changes its sign, bent by larger noise: 1 in their middle.
local function veins(p, width, bend)
    local q = p + bend * vec(noise(1.7 * p + 0.3), noise(1.7 * p + 5.2), noise(1.7 * p + 9.1))
    local n = abs(noise(q) + 0.45 * noise(2.1 * q + 3.7) + 0.2 * noise(4.3 * q + 1.1))
    return 1 - smooth(0, width, n)
end

--- A pattern in two dimensions on the side of the object that faces along each axis, blended.
local function triplanar(p, normal, f)
    local x, y, z = normal.x ^ 4, normal.y ^ 4, normal.z ^ 4
    return (x * f(p.z, p.y) + y * f(p.x, p.z) + z * f(p.x, p.y)) / (x + y + z)
end

-- A family makes the fields of gr.openpbr_material from an entry of the list. `at` scales points.
local family = {}

--- Rings around an axis below and behind the object, along x, as in a board. early, late: colours; rings in a unit of
--- length; wild: how much they bend; pores: dark streaks in the early wood; figure: light across the fibres.
function family.wood(e, at)
    local function rings(p)
        local y, z = p.y + 1.9, p.z - 0.55
        local bend = e.wild * (noise(0.5 * p.x, 1.1 * y, 1.1 * z) + 0.35 * noise(1.3 * p.x + 4, 2.6 * y, 2.6 * z))
        local r = (sqrt(y * y + z * z) + bend + 0.012 * threads(p, 22, 1.5)) * e.rings
        local t = r - floor(r)
        return smooth(0.25, 0.9, t) * (1 - smooth(0.9, 1, t)), t
    end
    local function pores(p, t)
        local streak = smooth(0.1, 0.32, threads(p, 48, 2)) + 0.6 * smooth(0.2, 0.4, threads(p * 1.7 + 3.1, 46, 1.6))
        return clamp(e.pores * streak * (1 - 0.6 * smooth(0.1, 0.6, t)), 0, 1)
    end
    local function colour(q)
        local p = at(q)
        local late, t = rings(p)
        local fibre = 1 + 0.16 * threads(p, 60, 2) + 0.10 * threads(p, 9, 0.6)
        local figure = 1 + e.figure * noise(7 * p.x, 0.8 * p.y, 0.8 * p.z)
        return mix(mix(e.early, e.late, late) * fibre * figure, e.pore, pores(p, t))
    end
    return { base_color = colour, specular_roughness = e.roughness or 0.4, coat_weight = e.coat or 0, coat_roughness = 0.12,
        geometry_normal = gr.bump(function(q)
            local p = at(q)
            local _, t = rings(p)
            return -pores(p, t) + 0.2 * threads(p, 60, 2)
        end, 0.0016 * at.size) }
end

function family.marble(e, at)
    return { base_color = function(q)
        local p = at(q)
        local base = mix(e.base, e.cloud, smooth(0.35, 0.75, clouds(1.3 * p + 2, 4)))
        local thick = veins(e.size * p + e.part, e.width, 0.55) * smooth(0.30, 0.55, clouds(1.1 * p + e.part, 2))
        local thin = veins(2.4 * e.size * p + e.part, 0.06, 0.4)
        return mix(mix(base, e.vein, e.strong * thick), e.vein, 0.6 * e.strong * thin)
    end, specular_roughness = 0.08 }
end

function family.granite(e, at)
    return { base_color = function(q)
        local p = at(q)
        local _, _, id = gr.cells(9 * p + 0.35 * vec(noise(20 * p), noise(20 * p + 5), noise(20 * p + 9)))
        local _, _, speck = gr.cells(17 * p + 4)
        local shade = 0.8 + 0.4 * clouds(30 * p, 2)
        local stone = mix(e.stone, e.grain, smooth(0.42, 0.46, id))
        stone = mix(stone, e.quartz, smooth(0.74, 0.78, id))
        return mix(stone * shade, e.mica, smooth(0.80, 0.83, speck))
    end, specular_roughness = 0.1 }
end

function family.sandstone(e, at)
    local function layers(p) return p.y + 0.12 * noise(1.2 * p) + 0.03 * noise(5 * p) end
    return { base_color = function(q)
        local p = at(q)
        local y = layers(p)
        local band = 0.5 + 0.5 * noise(0.1, 6 * y, 0.2) + 0.22 * noise(0.3, 21 * y, 0.7)
        local grain = 1 + 0.3 * noise(55 * p) + 0.2 * noise(110 * p + 3)
        return mix(e.light, e.dark, clamp(band, 0, 1)) * grain
    end, base_diffuse_roughness = 0.7, specular_weight = 0.3, specular_roughness = 0.7,
        geometry_normal = gr.bump(function(q)
            local p = at(q)
            return 0.7 * noise(0.3, 21 * layers(p), 0.7) + noise(45 * p) + 0.6 * noise(90 * p)
        end, 0.010 * at.size) }
end

function family.slate(e, at)
    local function steps(p)
        local y = 7 * (p.y + 0.35 * p.z + 0.16 * noise(1.7 * p) + 0.05 * noise(6 * p))
        local t = y - floor(y)
        return floor(y), smooth(0, 0.12, t)
    end
    return { base_color = function(q)
        local p = at(q)
        local n = steps(p)
        return mix(e.dark, e.light, clamp(0.5 + 0.45 * noise(0.2, n * 0.77 + 0.4, 0.6) + 0.4 * noise(3 * p) + 0.2 * noise(24 * p), 0, 1))
    end, specular_roughness = 0.45, specular_weight = 0.7,
        geometry_normal = gr.bump(function(q)
            local p = at(q)
            local _, edge = steps(p)
            return 1.1 * edge + 0.35 * noise(9 * p) + 0.14 * noise(30 * p)
        end, 0.05 * at.size) }
end

function family.terrazzo(e, at)
    return { base_color = function(q)
        local p = at(q)
        local near, second, id = gr.cells(3.4 * p + 0.2 * vec(noise(5 * p), noise(5 * p + 3), noise(5 * p + 6)))
        local small_near, small_second, small = gr.cells(9 * p + 3)
        local chip = gr.lookup(e.chips, 1 + floor(id * #e.chips * 0.999))
        local shard = gr.lookup(e.chips, 1 + floor(small * #e.chips * 0.999))
        local cement = e.base * (0.92 + 0.16 * clouds(14 * p, 3))
        local with_shards = mix(cement, shard, smooth(0.16, 0.2, small_second - small_near) * (1 - smooth(0.3, 0.33, small_near)))
        return mix(with_shards, chip * (0.9 + 0.2 * clouds(8 * p, 3)), smooth(0.12, 0.15, second - near) * (1 - smooth(0.42, 0.44, near)))
    end, specular_roughness = 0.12 }
end

function family.metal(e, at)
    local out = { base_color = e.colour, specular_color = e.tint, base_metalness = 1, specular_roughness = e.roughness }
    if e.brushed then
        local function scratches(q)
            local p = at(q)
            return noise(2.5 * p.x, 70 * p.y, 2.5 * p.z) + 0.6 * noise(1.2 * p.x + 5, 190 * p.y, 1.2 * p.z)
        end
        out.specular_roughness_anisotropy = e.brushed
        out.geometry_tangent = { 1, 0, 0 }
        out.base_color = function(q) return e.colour * (1 + 0.10 * scratches(q)) end
        out.specular_roughness = function(q) return e.roughness + 0.06 * scratches(q) end
        out.geometry_normal = gr.bump(scratches, 0.0016 * at.size)
    end
    if e.hammered then
        out.geometry_normal = gr.bump(function(q)
            local near = gr.cells(4.6 * at(q))
            return near * near
        end, e.hammered * at.size)
    end
    return out
end

--- Bright where it is touched, dark in the hollows, with scratches.
function family.worn(e, at)
    local function dirt(p) return smooth(0.38, 0.66, clouds(2.1 * p + 1.3, 6) + 0.10 * noise(13 * p)) end
    local function scratch(p)
        local a = abs(noise(1.1 * p.x + 0.3, 14 * p.y + 3 * p.z, 9 * p.z))
        local b = abs(noise(13 * p.x + 5 * p.y, 1.3 * p.y, 10 * p.z + 2))
        return 1 - smooth(0, 0.035, gr.min(a, b))
    end
    return { base_metalness = 1,
        base_color = function(q)
            local p = at(q)
            return mix(mix(e.colour, e.dirt, 0.85 * dirt(p)), e.colour, 0.5 * scratch(p))
        end,
        specular_roughness = function(q)
            local p = at(q)
            return clamp(0.20 + 0.32 * dirt(p) + 0.12 * scratch(p) + 0.08 * noise(6 * p), 0, 1)
        end,
        geometry_normal = gr.bump(function(q)
            local p = at(q)
            return 0.4 * noise(3.1 * p) - 0.12 * scratch(p) - 0.3 * dirt(p)
        end, 0.012 * at.size) }
end

--- A metal under a crust: of rust, or of verdigris.
function family.crust(e, at)
    local function cover(p) return smooth(e.from, e.from + 0.16, clouds(1.9 * p + 4.4, 6) + 0.07 * noise(22 * p)) end
    return { base_metalness = function(q) return 1 - cover(at(q)) end,
        base_color = function(q)
            local p = at(q)
            local crust = mix(e.crust, e.deep, smooth(0.3, 0.7, clouds(6 * p, 5)))
            crust = mix(crust, e.light, 0.8 * smooth(0.55, 0.8, clouds(3.1 * p + 9, 4)))
            return mix(e.colour, crust * (1 + 0.25 * noise(40 * p)), cover(p))
        end,
        specular_roughness = function(q) return 0.32 + 0.5 * cover(at(q)) end, base_diffuse_roughness = 0.6, specular_weight = 1,
        geometry_normal = gr.bump(function(q)
            local p = at(q)
            return cover(p) * (1 + 0.5 * noise(14 * p) + 0.5 * noise(31 * p)) + 0.1 * noise(9 * p)
        end, 0.022 * at.size) }
end

--- Iron from a mould of sand.
function family.cast(e, at)
    return { base_metalness = 0.85, base_color = function(q) return e.colour * (1 + 0.25 * clouds(5 * at(q), 4)) end, specular_roughness = 0.48,
        geometry_normal = gr.bump(function(q)
            local p = at(q)
            return noise(17 * p) + 0.7 * noise(36 * p) + 0.4 * noise(5 * p)
        end, 0.012 * at.size) }
end

--- Flakes of metal in many directions below a clear coat.
function family.car(e, at)
    return { base_color = function(q)
        local _, _, id = gr.cells(70 * at(q))
        return e.colour * (0.72 + 0.65 * id * id)
    end, base_metalness = 0.75, specular_roughness = 0.34, coat_weight = 1, coat_roughness = 0.01, coat_ior = 1.6 }
end

function family.wall(e, at)
    return { base_color = e.colour, base_diffuse_roughness = 0.8, specular_weight = 0.35, specular_roughness = 0.75,
        geometry_normal = gr.bump(function(q)
            local p = at(q)
            return clouds(16 * p, 3)
        end, 0.008 * at.size) }
end

function family.enamel(e, at)
    return { base_color = e.colour, specular_roughness = 0.03, specular_ior = 1.55,
        geometry_normal = gr.bump(function(q) return noise(2.3 * at(q)) end, 0.012 * at.size) }
end

--- Old paint on iron: where it is gone, a rim of rust and bare metal.
function family.chipped(e, at)
    local function gone(p) return clouds(1.6 * p + 2.2, 5) + 0.10 * noise(9 * p) + 0.05 * noise(27 * p) end
    local function paint(p) return 1 - smooth(0.565, 0.58, gone(p)) end
    local function bare(p) return smooth(0.62, 0.68, gone(p)) end
    return { base_metalness = function(q) return 0.9 * bare(at(q)) end,
        base_color = function(q)
            local p = at(q)
            local rust = mix(e.rust, e.rust * 0.35, smooth(0.3, 0.7, clouds(9 * p, 4)))
            local below = mix(rust, e.metal, bare(p))
            return mix(below, e.colour * (0.86 + 0.22 * clouds(4 * p, 3)), paint(p))
        end,
        specular_roughness = function(q) return mix(0.55, 0.22, paint(at(q))) end,
        geometry_normal = gr.bump(function(q)
            local p = at(q)
            return paint(p) + 0.25 * (1 - paint(p)) * noise(24 * p)
        end, 0.014 * at.size) }
end

function family.glaze(e, at)
    local out = { base_color = e.colour, specular_roughness = e.roughness or 0.3, coat_weight = e.glaze or 1, coat_roughness = 0.015, coat_color = e.coat,
        coat_ior = 1.5 }
    if e.crackle then
        out.base_color = function(q)
            local p = at(q)
            local near, second = gr.cells(4.2 * p + 0.25 * vec(noise(4 * p), noise(4 * p + 3), noise(4 * p + 6)))
            local fine_near, fine_second = gr.cells(10 * p + 7)
            local line = gr.max(1 - smooth(0.01, 0.045, second - near), 0.6 * (1 - smooth(0.02, 0.06, fine_second - fine_near)))
            return mix(e.colour * (0.85 + 0.3 * clouds(1.6 * p, 4)), e.crackle, 0.9 * line)
        end
    elseif e.blue then -- painted lines, and a wreath of strokes between them
        out.base_color = function(q)
            local p = at(q)
            local y = abs(p.y + 0.02 * noise(3 * p))
            local line = gr.max(1 - smooth(0.018, 0.03, abs(y - 0.52)), 1 - smooth(0.008, 0.018, abs(y - 0.60)))
            local stroke = smooth(0.30, 0.36, abs(noise(5.5 * p + 2) + 0.4 * noise(11 * p))) * (1 - smooth(0.17, 0.22, abs(y - 0.24)))
            return mix(e.colour, e.blue, gr.max(line, 0.8 * stroke))
        end
    elseif e.specks then
        out.base_color = function(q)
            local p = at(q)
            local near, _, id = gr.cells(13 * p)
            local speck = (1 - smooth(0.2, 0.34, near)) * gr.step(0.3, id)
            local iron = smooth(0.2, 0.9, -p.y + 0.3 * noise(1.5 * p) + 0.2)
            return mix(mix(e.colour, e.foot, 0.8 * iron), e.specks, 0.9 * speck)
        end
    end
    return out
end

function family.clay(e, at)
    return { base_color = function(q)
        local p = at(q)
        return mix(e.colour, e.dark, 0.7 * smooth(0.3, 0.75, clouds(2.4 * p, 5))) * (1 + 0.2 * noise(60 * p))
    end, base_diffuse_roughness = 0.8, specular_weight = 0.3, specular_roughness = 0.7,
        geometry_normal = gr.bump(function(q)
            local p = at(q)
            return 0.6 * noise(0.2 * p.x, 30 * p.y, 0.2 * p.z) + 0.7 * noise(40 * p) + 0.5 * noise(7 * p)
        end, 0.008 * at.size) }
end

function family.velvet(e, at)
    local function lie(p) return 0.6 + 0.9 * clouds(1.6 * p, 3) end
    return { base_color = function(q) return e.colour * 0.25 * lie(at(q)) end, base_diffuse_roughness = 1, specular_weight = 0, fuzz_weight = 1,
        fuzz_color = function(q) return e.fuzz * clamp(lie(at(q)), 0, 1) end, fuzz_roughness = 0.1,
        geometry_normal = gr.bump(function(q)
            local p = at(q)
            return noise(1.9 * p) + 0.06 * noise(70 * p)
        end, 0.05 * at.size) }
end

--- Twill: the warp, in the colour, passes over three threads of the weft and below one.
function family.denim(e, at)
    local function warp(u, v)
        local a, b = 30 * u + 0.25 * noise(9 * u, 3 * v, 0.5), 30 * v
        local t = 0.5 * a + 0.5 * b
        t = t - floor(t)
        local thread = a - floor(a)
        return smooth(0.08, 0.28, t) * (1 - smooth(0.80, 0.98, t)) * (0.55 + 0.45 * sin(math.pi * thread))
    end
    return { base_color = function(q, s)
        local p = at(q)
        local over = triplanar(p, s.normal, warp)
        local faded = clamp(0.6 + 0.7 * noise(9 * p.x, 1.1 * p.y, 9 * p.z) + 0.5 * noise(2 * p), 0, 1.4)
        return mix(e.weft, e.warp * (0.7 + 0.6 * faded), over)
    end, base_diffuse_roughness = 1, specular_weight = 0.2, specular_roughness = 0.7, fuzz_weight = 0.25, fuzz_color = e.weft, fuzz_roughness = 0.6,
        geometry_normal = gr.bump(function(q, s) return triplanar(at(q), s.normal, warp) end, 0.012 * at.size) }
end

function family.silk(e, at)
    return { base_color = e.colour, base_weight = 0.9, base_metalness = 0.5, specular_color = e.shine, specular_weight = 2, specular_roughness = 0.42, specular_roughness_anisotropy = 0.7,
        geometry_tangent = { 0, 1, 0 }, fuzz_weight = 0.25, fuzz_color = e.shine, fuzz_roughness = 0.3,
        geometry_normal = gr.bump(function(q)
            local p = at(q)
            local y = p.y + 0.25 * noise(1.2 * p)
            return 0.55 * noise(2.1 * p.x + 1.4 * y, 0.7 * y, 2.1 * p.z) + 0.25 * noise(4.5 * p.x + 3 * y, 1.5 * y, 4.5 * p.z)
        end, 0.14 * at.size) }
end

function family.felt(e, at)
    local function hairs(p)
        local q = p + 0.08 * vec(noise(9 * p), noise(9 * p + 4), noise(9 * p + 8))
        return noise(60 * q.x, 9 * q.y, 14 * q.z) + noise(9 * q.x + 3, 60 * q.y, 14 * q.z) + noise(14 * q.x, 9 * q.y, 60 * q.z)
    end
    return { base_color = function(q)
        local p = at(q)
        return e.colour * clamp(0.85 + 0.35 * hairs(p) + 0.4 * noise(2.2 * p), 0.3, 1.4)
    end, base_diffuse_roughness = 1, specular_weight = 0, fuzz_weight = 0.6, fuzz_color = e.fuzz, fuzz_roughness = 0.8,
        geometry_normal = gr.bump(function(q) return hairs(at(q)) end, 0.008 * at.size) }
end

--- A clear or tinted solid. depth: the distance after which white light has the colour.
function family.clear(e, at)
    return { transmission_weight = 1, transmission_color = e.colour, transmission_depth = e.colour and e.depth * at.size or nil, specular_ior = e.ior,
        specular_roughness = e.roughness or 0 }
end

--- Milk scatters so much light below its surface that it looks like a diffuse surface of rounded brightness.
function family.milk(e)
    return { base_color = e.colour, base_diffuse_roughness = 0, specular_ior = 1.35, specular_roughness = 0.02, coat_weight = 0 }
end

local list = {
    { 'oak', 'wood', early = c '#b98e58', late = c '#80552c', pore = c '#3c2512', rings = 7, wild = 0.18, pores = 0.95, figure = 0.1 },
    { 'pine', 'wood', early = c '#ecd0a0', late = c '#bf8443', pore = c '#9a6a38', rings = 5, wild = 0.22, pores = 0.06, figure = 0.03 },
    { 'walnut', 'wood', early = c '#86603f', late = c '#46301f', pore = c '#22150d', rings = 4.5, wild = 0.42, pores = 0.6, figure = 0.12 },
    { 'mahogany', 'wood', early = c '#9c4a2a', late = c '#6b2a16', pore = c '#240e08', rings = 3, wild = 0.6, pores = 0.8, figure = 0.4, coat = 1 },
    { 'ebony', 'wood', early = c '#3a2d27', late = c '#191412', pore = c '#0c0a09', rings = 6, wild = 0.3, pores = 0.5, figure = 0.1, coat = 1 },
    { 'white marble', 'marble', base = c '#f2efea', cloud = c '#d9d7d6', vein = c '#4f535b', strong = 0.8, size = 0.9, part = 3.4, width = 0.34 },
    { 'black marble', 'marble', base = c '#161617', cloud = c '#242325', vein = c '#e8d9b0', strong = 0.95, size = 1, part = 0.4, width = 0.12 },
    { 'green marble', 'marble', base = c '#1f4a36', cloud = c '#0f2c21', vein = c '#b8d0bd', strong = 0.75, size = 1.5, part = 8.1, width = 0.12 },
    { 'granite', 'granite', stone = c '#a9a29b', grain = c '#c79a86', quartz = c '#dcd6ce', mica = c '#1d1c1c' },
    { 'sandstone', 'sandstone', light = c '#e0bd8a', dark = c '#a9663c' },
    { 'slate', 'slate', light = c '#6d7379', dark = c '#33383e' },
    { 'terrazzo', 'terrazzo', base = c '#e6e1d8', chips = { c '#b5573f', c '#3f4a4f', c '#d9a441', c '#7f9a8a', c '#f4f0e8', c '#8a8178' } },
    { 'chrome', 'metal', colour = vec(0.78, 0.79, 0.81), tint = vec(0.92, 0.93, 0.96), roughness = 0.02 },
    { 'gold', 'metal', colour = vec(1.0, 0.73, 0.36), tint = vec(0.99, 1.0, 0.98), roughness = 0.14 },
    { 'hammered copper', 'metal', colour = vec(0.93, 0.53, 0.40), tint = vec(0.98, 0.95, 0.94), roughness = 0.2, hammered = 0.022 },
    { 'brushed steel', 'metal', colour = vec(0.62, 0.61, 0.60), tint = vec(0.85, 0.86, 0.88), roughness = 0.34, brushed = 0.85 },
    { 'brushed brass', 'metal', colour = vec(0.90, 0.72, 0.38), tint = vec(0.95, 0.97, 1.0), roughness = 0.36, brushed = 0.8 },
    { 'worn bronze', 'worn', colour = vec(0.80, 0.56, 0.34), dirt = vec(0.11, 0.07, 0.045) },
    { 'verdigris', 'crust', colour = vec(0.55, 0.30, 0.20), crust = c '#4f9a86', deep = c '#2f6f63', light = c '#9cc9b4', from = 0.38 },
    { 'rusty iron', 'crust', colour = vec(0.30, 0.29, 0.28), crust = c '#8a4a22', deep = c '#4a2414', light = c '#c07a3a', from = 0.42 },
    { 'cast iron', 'cast', colour = vec(0.10, 0.10, 0.105) },
    { 'car paint', 'car', colour = vec(0.55, 0.012, 0.02) },
    { 'wall paint', 'wall', colour = c '#9fb0a0' },
    { 'enamel', 'enamel', colour = c '#1f5fa8' },
    { 'chipped paint', 'chipped', colour = c '#3f8f8a', rust = c '#8a4622', metal = vec(0.35, 0.34, 0.33) },
    { 'porcelain', 'glaze', colour = c '#f1f2f0', blue = c '#1c3c8c' },
    { 'celadon', 'glaze', colour = c '#a9c4a8', crackle = c '#3c4636' },
    { 'stoneware', 'glaze', colour = c '#cfc3ad', foot = c '#7a5537', specks = c '#3a2a1e', glaze = 0.6 },
    { 'terracotta', 'clay', colour = c '#c0693f', dark = c '#9c4f2e' },
    { 'velvet', 'velvet', colour = c '#7a0f24', fuzz = c '#ff7088' },
    { 'denim', 'denim', warp = c '#1d2f5c', weft = c '#8f9bb4' },
    { 'silk', 'silk', colour = c '#8f4fa0', shine = c '#f4d8ff' },
    { 'felt', 'felt', colour = c '#4f7a3c', fuzz = c '#a9c590' },
    { 'water', 'clear', colour = c '#dff2f4', depth = 2, ior = 1.333 },
    { 'red wine', 'clear', colour = c '#6a0a1e', depth = 2.2, ior = 1.345 },
    { 'honey', 'clear', colour = c '#e8a020', depth = 2, ior = 1.49 },
    { 'milk', 'milk', colour = c '#f6f2e8' },
    { 'clear glass', 'clear', ior = 1.5 },
    { 'bottle glass', 'clear', colour = c '#3f8a50', depth = 0.9, ior = 1.52 },
    { 'frosted glass', 'clear', colour = c '#e6f4f2', depth = 2, ior = 1.5, roughness = 0.42 },
}

local families = { wood = 'wood', metal = 'metal', worn = 'metal', crust = 'metal', cast = 'metal', car = 'paint', wall = 'paint', enamel = 'paint',
    chipped = 'paint', glaze = 'ceramic', clay = 'ceramic', velvet = 'fabric', denim = 'fabric', silk = 'fabric', felt = 'fabric', milk = 'liquid' }
local by_name, liquids = {}, { water = true, ['red wine'] = true, honey = true }

--- The family of each material: wood, stone, metal, paint, ceramic, fabric, liquid or glass.
---@type table<string, string>
M.families = {}
for _, entry in ipairs(list) do
    by_name[entry[1]] = entry
    M.families[entry[1]] = families[entry[2]] or entry[2] == 'clear' and (liquids[entry[1]] and 'liquid' or 'glass') or 'stone'
end

--- The names of all materials, by family.
---@return string[]
function M.names()
    local out = {}
    for k, entry in ipairs(list) do out[k] = entry[1] end
    return out
end

--- The number of letters that differ, counted from both ends.
local function difference(a, b)
    local from, to = 1, 0
    while from <= #a and a:byte(from) == b:byte(from) do from = from + 1 end
    while to <= #a - from and to <= #b - from and a:byte(#a - to) == b:byte(#b - to) do to = to + 1 end
    return math.max(#a, #b) - from + 1 - to
end

local function unknown(where, name)
    local best, least = nil, 4
    for _, other in ipairs(M.names()) do
        local far = difference(name:lower(), other)
        if far < least then best, least = other, far end
    end
    check.fail(where, ("there is no material '%s'; %s"):format(name:sub(1, 40),
        best and ("did you mean '%s'?"):format(best) or 'there are ' .. table.concat(M.names(), ', ')))
end

--- A material of the list.
---@param name string  'oak', 'white marble', ...
---@param options table?  scale 1: factor of the pattern's size; offset {0, 0, 0}: another part of the pattern
---@return gr.material
function M.named(name, options)
    local where = 'materials.named'
    local entry = by_name[check.text(where, 'name', name)]
    if not entry then unknown(where, name) end
    options = check.options(where, options, 'scale offset')
    local scale = check.above(where, 'scale', options.scale, 0, 1)
    local offset = check.tuple(where, 'offset', options.offset, 3, { 0, 0, 0 })
    local at = setmetatable({ size = scale }, { __call = function(_, p) return vec(p) / scale + vec(offset) end })
    return gr.openpbr_material(family[entry[2]](entry, at))
end

return M
