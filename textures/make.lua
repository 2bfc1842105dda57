-- TITLE: The textures
-- Makes every picture in this folder: rug, painting, panels, tiles, label, letters, skies, the globe, the ball.
-- Author: gray project
--
-- Run it with `lua5.4 textures/make.lua [name ...]` from the root of the repository (or `./gray --allow-write textures --script-time 600 textures/make.lua`); without names
-- all are made. The same script gives the same bytes, always: the only noise is Perlin's.

local here = (debug.getinfo(1, 'S').source:match('^@(.*/)') or './')
package.path = here .. '../lua/?.lua;' .. package.path

local picture = require 'picture'
local noise = require 'noise'
local teapot = require 'teapot'
local meshes = require 'meshes'
local png = require 'png'

local sin, cos, abs, floor, sqrt, pi = math.sin, math.cos, math.abs, math.floor, math.sqrt, math.pi

local function mix(a, b, t)
    return { a[1] + (b[1] - a[1]) * t, a[2] + (b[2] - a[2]) * t, a[3] + (b[3] - a[3]) * t }
end

local function times(a, k) return { a[1] * k, a[2] * k, a[3] * k } end

local function smoothstep(a, b, x)
    local t = (x - a) / (b - a)
    t = t < 0 and 0 or t > 1 and 1 or t
    return t * t * (3 - 2 * t)
end

--- A colour from a list of { place, colour }.
local function ramp(list, x)
    if x <= list[1][1] then return list[1][2] end
    for i = 2, #list do
        if x <= list[i][1] then
            return mix(list[i - 1][2], list[i][2], smoothstep(list[i - 1][1], list[i][1], x))
        end
    end
    return list[#list][2]
end

local make = {}

-- An oriental rug: borders with running ornament, corner fans, a medallion.
function make.rug()
    local w, h = 384, 256
    local red, dark, blue, cream, gold = { .44, .10, .08 }, { .25, .05, .05 }, { .10, .15, .27 }, { .58, .46, .32 },
        { .72, .48, .17 }
    local p = picture.new(w, h, red)
    p:paint(function(x, y)
        local ax, ay = abs(x - w / 2), abs(y - h / 2)
        local edge = math.min(w / 2 - ax, h / 2 - ay)
        local along = (w / 2 - ax) < (h / 2 - ay) and ay or ax
        local c
        if edge < 3 then
            c = dark
        elseif edge < 9 then
            c = mix(blue, dark, .3)
        elseif edge < 12 then
            c = gold
        elseif edge < 38 then
            c = blue
            local q, s = (edge - 25) / 13, along / 32
            local cell = abs(s % 1 - 0.5) * 2
            if abs(q) * 0.9 + cell < 0.82 then c = red end
        elseif edge < 41 then
            c = gold
        elseif edge < 48 then
            c = mix(blue, dark, .3)
        else
            local fx, fy = w / 2 - 48 - ax, h / 2 - 48 - ay
            -- the field: small flowers on a lattice
            local lx, ly = (ax + ay) / 22 % 1 - 0.5, (ax - ay) / 22 % 1 - 0.5
            local r = sqrt(lx * lx + ly * ly)
            c = red
            if r < 0.22 then c = mix(red, gold, 0.3) end
            if abs(lx) < 0.035 or abs(ly) < 0.035 then c = mix(c, dark, 0.35) end
            -- fans in the corners
            local d, a = sqrt(fx * fx * 0.8 + fy * fy), math.atan(fy, fx)
            local rim = 58 + 4 * cos(a * 16)
            if d < rim then c = blue end
            if d < rim and d > rim - 4 then c = gold end
            if d < rim - 10 and floor(a / (pi / 12)) % 2 == 0 then c = cream end
            if d < rim - 26 then c = red end
            -- the medallion
            local mx, my = ax / 1.45, ay
            local md, ma = sqrt(mx * mx + my * my), math.atan(my, mx)
            local lobe = 62 + 5 * abs(cos(ma * 8))
            if md < lobe + 5 then c = gold end
            if md < lobe + 2 then c = blue end
            if md < lobe - 9 then c = cream end
            if md < lobe - 13 then c = red end
            local petal = 34 + 12 * cos(ma * 8)
            if md < petal then c = cream end
            if md < petal - 4 then c = blue end
            local inner = 15 + 4 * cos(ma * 8 + pi)
            if md < inner then c = gold end
            if md < inner - 5 then c = dark end
        end
        -- knots and worn dye
        local wear = 1 + 0.05 * noise.noise(x / 2.1, y / 1.3, 4.5) + 0.08 * noise.sum(x / 60, y / 60, 9.3, 3)
        return times(mix(c, { .36, .22, .16 }, 0.36), wear)
    end)
    p:write(here .. 'rug.png', 8)
end

-- The joke: a teapot, painted with its own mesh, and a caption that denies it.
function make.painting()
    local w, h = 352, 264
    local p = picture.new(w, h)
    p:paint(function(x, y)
        local g = ramp({ { 0, { .80, .70, .50 } }, { .62, { .88, .79, .60 } }, { 1, { .76, .64, .44 } } }, y / h)
        return times(g, 1 + 0.05 * noise.sum(x / 40, y / 40, .7, 3) + .02 * noise.noise(x / 3, y / 1.7, 2.2))
    end)
    local mesh = { teapot.mesh(14) }
    mesh = meshes.rotate(meshes.rotate(mesh, 'y', 12), 'x', 22)
    local scale, cx, cy = 42, w / 2 - 6, 168
    local ss = 3
    local sw, sh = w * ss, h * ss
    local depth, shade = {}, {}
    local lx, ly, lz = meshes.unit(-0.5, 0.8, 0.7)
    local verts, normals, faces = mesh[1], mesh[2], mesh[3]
    for k, face in ipairs(faces) do
        for i = 2, #face - 1 do
            local corner = { face[1], face[i], face[i + 1] }
            local index = { mesh[4][k][1], mesh[4][k][i], mesh[4][k][i + 1] }
            local s = {}
            for c = 1, 3 do
                local q = verts[corner[c] + 1]
                s[c] = { (cx + q[1] * scale) * ss, (cy - q[2] * scale) * ss, q[3] }
            end
            local area = (s[2][1] - s[1][1]) * (s[3][2] - s[1][2]) - (s[3][1] - s[1][1]) * (s[2][2] - s[1][2])
            if area ~= 0 then
                local x0, x1 = math.min(s[1][1], s[2][1], s[3][1]), math.max(s[1][1], s[2][1], s[3][1])
                local y0, y1 = math.min(s[1][2], s[2][2], s[3][2]), math.max(s[1][2], s[2][2], s[3][2])
                for y = floor(y0), floor(y1) do
                    for x = floor(x0), floor(x1) do
                        local px, py = x + 0.5, y + 0.5
                        local b = ((px - s[1][1]) * (s[3][2] - s[1][2]) - (s[3][1] - s[1][1]) * (py - s[1][2])) / area
                        local g = ((s[2][1] - s[1][1]) * (py - s[1][2]) - (px - s[1][1]) * (s[2][2] - s[1][2])) / area
                        local a = 1 - b - g
                        if a >= -1e-9 and b >= -1e-9 and g >= -1e-9 and x >= 0 and y >= 0 and x < sw and y < sh then
                            local z = a * s[1][3] + b * s[2][3] + g * s[3][3]
                            local at = y * sw + x
                            if not depth[at] or z > depth[at] then
                                local nx, ny, nz = 0, 0, 0
                                for c, weight in ipairs { a, b, g } do
                                    local n = normals[index[c] + 1]
                                    nx, ny, nz = nx + n[1] * weight, ny + n[2] * weight, nz + n[3] * weight
                                end
                                nx, ny, nz = meshes.unit(nx, ny, nz)
                                depth[at] = z
                                shade[at] = { nx, ny, nz }
                            end
                        end
                    end
                end
            end
        end
    end
    local function tone(n)
        if n[3] < 0 then return { .12, .07, .05 } end
        local d = math.max(0, n[1] * lx + n[2] * ly + n[3] * lz)
        local r = math.max(0, 2 * (n[1] * lx + n[2] * ly + n[3] * lz) * n[3] - lz)
        -- banded like brush strokes
        local level = floor(d * 9 + 0.5) / 9
        local c = ramp({ { 0, { .20, .10, .07 } }, { .5, { .47, .24, .12 } }, { 1, { .74, .45, .22 } } }, level)
        return mix(c, { 1, .95, .82 }, 0.8 * r ^ 18)
    end
    -- a soft shadow on the table
    p:paint(function(x, y)
        local d = ((x - cx + 8) / 120) ^ 2 + ((y - cy - 10) / 24) ^ 2
        if d < 1 then return { .35, .24, .14 }, 0.65 * (1 - d) end
    end)
    p:paint(function(x, y)
        local r, g, b, cover = 0, 0, 0, 0
        for j = 0, ss - 1 do
            for i = 0, ss - 1 do
                local at = (floor(y) * ss + j) * sw + floor(x) * ss + i
                if depth[at] then
                    local c = tone(shade[at])
                    r, g, b, cover = r + c[1], g + c[2], b + c[3], cover + 1
                end
            end
        end
        if cover > 0 then return { r / cover, g / cover, b / cover }, cover / (ss * ss) end
    end)
    p:text("Ceci n'est pas une théière.", w / 2, 226, 17, { .16, .09, .07 }, 1.8)
    p:write(here .. 'painting.png', 4)
end

-- Oak panel: long grain with a few knots, no letters.
function make.panel()
    local w, h = 256, 256
    local p = picture.new(w, h)
    p:paint(function(x, y)
        local bend = 5 * noise.sum(x / 90, y / 300, 1.7, 2)
        local ring = sin((x + bend * 4) / 5.5 + 3 * noise.sum(x / 40, y / 220, 3.1, 2))
        local pore = noise.noise(x / 1.2, y / 26, 7.7)
        local c = mix({ .40, .24, .12 }, { .55, .36, .19 }, 0.5 + 0.35 * ring + 0.25 * noise.sum(x / 70, y / 200, 5, 2))
        return times(c, 1 - 0.16 * smoothstep(0.1, 0.6, pore))
    end)
    p:write(here .. 'panel.png', 8)
end

-- Parquet in herringbone.
function make.parquet()
    local w, h = 384, 384
    local p = picture.new(w, h)
    local unit, length = 24, 4
    p:paint(function(x, y)
        local i, j = x / unit, y / unit
        local a, b = floor(i), floor(j)
        -- the herringbone: blocks of 1 x 4 along both axes, shifted by one per row
        local k = (a - b) % (2 * length)
        local flat = k < length
        local u, v
        if flat then
            u, v = i - (a - k), j - b
        else
            local m = (b - a + 2 * length - 1) % (2 * length)
            m = m % length
            u, v = j - (b - m), i - a
        end
        local period = w / unit
        local id = (floor(flat and (a - k) or a) % period) * 7.31 + (floor(flat and b or (b - u // 1)) % period) * 3.77
        local tone = 0.5 + 0.5 * sin(id * 12.9898)
        local grain = noise.sum(u * 1.3 + tone * 40, v * 7 + tone * 90, tone * 10, 3)
        local c = mix({ .40, .24, .13 }, { .52, .33, .18 }, 0.35 * tone + 0.4 + 0.3 * grain)
        local gap = math.min(u, length - u, v, 1 - v) * unit
        return times(c, 0.72 + 0.28 * smoothstep(0, 1.4, gap))
    end)
    p:write(here .. 'parquet.png', 8)
end

-- Kitchen tiles: four to the picture, blue on white.
function make.tiles()
    local w = 256
    local p = picture.new(w, w)
    p:paint(function(x, y)
        local u, v = x % 128 - 64, y % 128 - 64
        local odd = (floor(x / 128) + floor(y / 128)) % 2 == 0
        local ax, ay = abs(u), abs(v)
        local c = { .90, .90, .86 }
        local blue = { .10, .20, .50 }
        local r, a = sqrt(u * u + v * v), math.atan(v, u)
        if odd then
            if r < 38 + 12 * cos(4 * a) and r > 33 + 12 * cos(4 * a) then c = blue end
            if r < 20 + 8 * cos(8 * a) then c = mix(c, blue, 0.6) end
            if r < 7 then c = blue end
        else
            local d = ax + ay
            if d > 44 and d < 50 or d < 16 then c = blue end
            if d > 22 and d < 38 then c = mix(c, blue, 0.4) end
        end
        local corner = sqrt((64 - ax) ^ 2 + (64 - ay) ^ 2)
        if corner < 22 and corner > 16 or corner < 9 then c = blue end
        local grout = math.min(64 - ax, 64 - ay)
        c = times(c, 1 + 0.03 * noise.sum(x / 30, y / 30, .3, 3))
        return mix({ .55, .53, .50 }, c, smoothstep(1.5, 3, grout))
    end)
    p:write(here .. 'tiles.png', 4)
end

-- A tin label.
function make.label()
    local w, h = 256, 256
    local p = picture.new(w, h, { .10, .20, .17 })
    local gold = { .80, .63, .30 }
    p:box(10, 10, 246, 246, gold)
    p:box(14, 14, 242, 242, { .10, .20, .17 })
    p:box(20, 20, 236, 236, gold)
    p:box(22, 22, 234, 234, { .86, .80, .66 })
    p:disc(128, 92, 52, { .10, .20, .17 })
    p:disc(128, 92, 46, { .93, .72, .36 })
    for i = 0, 11 do
        local a = 2 * pi * i / 12
        p:line({ { 128 + 30 * cos(a), 92 + 30 * sin(a) }, { 128 + 40 * cos(a), 92 + 40 * sin(a) } }, 4, { .10, .20, .17 })
    end
    p:disc(128, 92, 22, { .10, .20, .17 })
    p:text('EARL', 128, 172, 26, { .10, .20, .17 })
    p:text('GRAY', 128, 209, 26, { .55, .13, .10 })
    p:write(here .. 'label.png', 8)
end

-- A checker whose letter cannot be read in a mirror.
function make.checker()
    local p = picture.new(256, 256, { .92, .90, .84 })
    p:paint(function(x, y)
        if (floor(x / 32) + floor(y / 32)) % 2 == 0 then return { .25, .42, .55 } end
    end)
    p:disc(128, 128, 76, { .95, .93, .88 })
    p:text('R', 132, 128, 96, { .62, .14, .12 }, 16)
    p:disc(16, 16, 9, { .8, .2, .15 })
    p:write(here .. 'checker.png')
end

-- A sticker with alpha: a star that lets the base colour through round it.
function make.star()
    local w = 128
    local bytes = {}
    for y = 0, w - 1 do
        for x = 0, w - 1 do
            local u, v = x + 0.5 - w / 2, y + 0.5 - w / 2
            local r, a = sqrt(u * u + v * v), (math.atan(u, -v) / (2 * pi / 5) + 0.5) % 1 - 0.5
            local edge = 56 / (1 + 3.2 * abs(a))
            local cover = math.max(0, math.min(1, edge - r + 0.5))
            local c = r < edge * 0.8 and { 250, 206, 60 } or { 214, 120, 24 }
            local at = #bytes
            bytes[at + 1], bytes[at + 2], bytes[at + 3], bytes[at + 4] = c[1], c[2], c[3], floor(255 * cover + 0.5)
        end
    end
    png.write(here .. 'star.png', w, w, bytes, 4)
end

-- A ball in six colours, for sphere mapping.
function make.ball()
    local w, h = 256, 128
    local colours = { { .85, .16, .12 }, { .95, .93, .88 }, { .12, .30, .66 }, { .95, .93, .88 }, { .95, .72, .12 },
                      { .95, .93, .88 } }
    local p = picture.new(w, h)
    p:paint(function(x, y)
        if y < 7 or y > h - 7 then return { .95, .93, .88 } end
        return colours[floor(x / w * 6) % 6 + 1]
    end)
    p:write(here .. 'ball.png')
end

-- The world as it might have been: noise on the sphere, so there is no seam and no pinch at the poles.
function make.earth()
    local w, h = 512, 256
    local p = picture.new(w, h)
    p:paint(function(x, y)
        local theta, phi = 2 * pi * x / w, pi * y / h
        local nx, ny, nz = sin(phi) * cos(theta), cos(phi), sin(phi) * sin(theta)
        local height = noise.sum(nx * 1.5 + 5.2, ny * 1.5 + 1.3, nz * 1.5 + 8.1, 6) - 0.08
        local cold = abs(ny) + 0.12 * noise.sum(nx * 4, ny * 4, nz * 4, 3)
        local c
        if height < 0 then
            c = mix({ .10, .26, .48 }, { .03, .09, .27 }, math.min(1, -height * 2.2))
        else
            local dry = 0.5 + noise.sum(nx * 2.3 + 3, ny * 2.3, nz * 2.3 + 7, 3) * 0.7 - abs(abs(ny) - 0.35) * 0.8
            c = mix({ .12, .33, .12 }, { .66, .53, .31 }, smoothstep(0.25, 0.65, dry))
            c = mix(c, { .42, .33, .25 }, smoothstep(0.28, 0.5, height))
            c = mix(c, { .92, .93, .95 }, smoothstep(0.5, 0.62, height))
        end
        c = mix(c, { .93, .95, .97 }, smoothstep(0.82, 0.92, cold))
        local cloud = noise.sum(nx * 3 + 9, ny * 5 + 4, nz * 3 + 2, 5)
        return mix(c, { .97, .97, .97 }, 0.85 * smoothstep(0.12, 0.5, cloud))
    end)
    p:write(here .. 'earth.png', 4)
end

-- Directions of the faces of the sky cross; s to the right, t up, both -1..1, seen from inside.
local faces = {
    { 1, 0, 'T', function(s, t) return -s, 1, -t end }, { 0, 1, 'L', function(s, t) return 1, t, s end },
    { 1, 1, 'F', function(s, t) return -s, t, 1 end }, { 2, 1, 'R', function(s, t) return -1, t, -s end },
    { 3, 1, 'K', function(s, t) return s, t, -1 end }, { 1, 2, 'B', function(s, t) return -s, -1, t end },
}

local function sky_cross(size, samples, colour_of)
    local p = picture.new(4 * size, 3 * size)
    for _, face in ipairs(faces) do
        local x0, y0, direction = face[1] * size, face[2] * size, face[4]
        p:paint(function(x, y)
            local r, g, b = 0, 0, 0
            for j = 1, samples do
                for i = 1, samples do
                    local s = 2 * (x - 0.5 + (i - 0.5) / samples - x0) / size - 1
                    local t = 1 - 2 * (y - 0.5 + (j - 0.5) / samples - y0) / size
                    local dx, dy, dz = meshes.unit(direction(s, t))
                    local c = colour_of(dx, dy, dz)
                    r, g, b = r + math.min(1, c[1]), g + math.min(1, c[2]), b + math.min(1, c[3])
                end
            end
            local n = samples * samples
            return { r / n, g / n, b / n }
        end, x0, y0, x0 + size, y0 + size)
    end
    return p
end

-- Letters on the six faces, for tests of the layout.
function make.sky_letters()
    local size = 64
    local p = picture.new(4 * size, 3 * size)
    local colours = { T = { .55, .75, .95 }, L = { .95, .75, .55 }, F = { .95, .60, .60 }, R = { .65, .90, .60 },
                      K = { .95, .92, .55 }, B = { .75, .62, .90 } }
    for _, face in ipairs(faces) do
        local x, y = face[1] * size, face[2] * size
        p:box(x, y, x + size, y + size, times(colours[face[3]], 0.7))
        p:box(x + 2, y + 2, x + size - 2, y + size - 2, colours[face[3]])
        p:text(face[3], x + size / 2, y + size / 2, 34, { .08, .08, .12 }, 5)
    end
    p:write(here .. 'sky_letters.png')
end

-- Evening over a lake between mountains; the sun stands left of F.
local sun = { meshes.unit(0.40, 0.15, 1) }

local function sky_colour(x, y, z)
    local toward = math.max(0, x * sun[1] + y * sun[2] + z * sun[3])
    local flat = (x * sun[1] + z * sun[3]) / sqrt(x * x + z * z + 1e-9)
    local warm = 0.5 + 0.5 * flat
    local horizon = mix({ .62, .62, .74 }, { 1.0, .74, .45 }, warm * warm)
    local middle = mix({ .44, .55, .76 }, { .78, .70, .66 }, warm * warm)
    local c = ramp({ { 0, horizon }, { .16, mix(horizon, middle, 0.7) }, { .38, middle }, { 1, { .20, .36, .66 } } }, y)
    c = mix(c, { 1, .86, .58 }, 0.6 * toward ^ 14)
    c = mix(c, { 1, .97, .85 }, smoothstep(0.9965, 0.9985, toward))
    if y > 0 then
        local k = 1.5 / (y + 0.10)
        local u, v = x * k, z * k
        local d = noise.sum(u * 0.55 + 11, v * 0.9 + 3, 0.5, 4) + 0.35 * noise.noise(u * 0.16, v * 0.2, 7)
        local thick = smoothstep(0.02, 0.75, d) * smoothstep(0.0, 0.14, y)
        local lit = mix({ .80, .76, .82 }, { 1, .80, .62 }, warm ^ 2)
        local shade = noise.sum(u * 0.55 + 11 + sun[1] * 0.4, v * 0.9 + 3 + sun[3] * 0.5, 0.5, 3)
        lit = mix(lit, { .52, .48, .60 }, 0.6 * smoothstep(0.0, 0.7, shade) * (1 - toward ^ 6))
        c = mix(c, lit, 0.85 * thick)
    end
    return c
end

local evening

function evening(x, y, z)
    if y > -0.004 then
        -- far land hides the sky, near land hides far land
        local length = sqrt(x * x + z * z) + 1e-9
        local best
        for layer = 3, 1, -1 do
            local f = 1.2 + layer * 1.3
            local ridge = ({ .13, .07, .03 })[layer]
                + ({ .20, .12, .06 })[layer] * noise.sum(x / length * f + layer * 17, z / length * f, layer * 3.7, 5)
            if y / length < ridge then
                best = layer
                break
            end
        end
        if not best then return sky_colour(x, y, z) end
        local ax, az, slope = x / length, z / length, y / length
        local flat = ax * sun[1] + az * sun[3]
        local haze = mix({ .58, .60, .72 }, { .95, .72, .50 }, (0.5 + 0.5 * flat) ^ 2)
        local rock = mix({ .22, .26, .36 }, { .12, .17, .14 }, (best - 1) / 2)
        if best == 1 then
            local snow = smoothstep(0.09, 0.16, slope + 0.05 * noise.sum(ax * 14, slope * 22, az * 14, 3))
            rock = mix(rock, { .82, .78, .80 }, snow * 0.8)
        end
        local relief = 0.25 * noise.sum(ax * 9 * best, slope * 16, az * 9 * best, 3)
        rock = times(rock, 1 + relief)
        local far = ({ .50, .34, .14 })[best]
        return mix(rock, haze, far + (1 - far) * 0.5 * (1 - smoothstep(0, 0.10, slope)))
    end
    -- the lake: the sky upside down, darker, with ripples that calm down towards the horizon
    local wave = noise.noise(x / -y * 2.2, z / -y * 2.2, 0.4) * 0.05 * smoothstep(0, 0.25, -y)
    local mx, my, mz = meshes.unit(x, -y + 0.02 + abs(wave), z + wave * 0.4)
    local sky = evening(mx, my, mz)
    local fresnel = 0.20 + 0.65 * (1 + y) ^ 4
    return mix({ .06, .12, .16 }, sky, fresnel)
end

function make.sky_evening()
    sky_cross(320, 2, evening):write(here .. 'sky_evening.png', 4)
end

-- The sky alone, for the window of the final scenes: a low sun, streaks of cloud, no land.
local low_sun = { meshes.unit(0.285, 0.085, 1) }

local function dusk(x, y, z)
    local toward = math.max(0, x * low_sun[1] + y * low_sun[2] + z * low_sun[3])
    local flat = (x * low_sun[1] + z * low_sun[3]) / sqrt(x * x + z * z + 1e-9)
    local warm = (0.5 + 0.5 * flat) ^ 2
    local c = ramp({
        { -0.05, mix({ .50, .45, .55 }, { 1, .66, .36 }, warm) }, { 0.05, mix({ .55, .52, .66 }, { 1, .74, .44 }, warm) },
        { 0.13, mix({ .47, .52, .70 }, { .90, .74, .62 }, warm) }, { 0.26, { .50, .58, .74 } }, { 1, { .20, .34, .62 } },
    }, y)
    c = mix(c, { 1, .88, .60 }, 0.75 * toward ^ 160)
    c = mix(c, { 1, .97, .86 }, 0.95 * smoothstep(0.9985, 0.99975, toward))
    if y > -0.02 then
        local a = math.atan(x, z)
        -- long streaks: much finer in height than in width
        local d = noise.sum(a * 7 + 3 * y, y * 46 + 0.8 * noise.noise(a * 5, y * 9, 3), 2.7, 4)
        local thick = smoothstep(0.05, 0.65, d) * smoothstep(0.015, 0.06, y) * (1 - smoothstep(0.5, 0.9, y))
        local lit = mix({ .78, .58, .60 }, { 1, .70, .42 }, warm)
        lit = mix(lit, { .56, .46, .56 }, smoothstep(0.25, 0.8, d))
        c = mix(c, mix(lit, { 1, .93, .75 }, 0.8 * toward ^ 60), 0.75 * thick)
    end
    return c
end

function make.sky_dusk()
    sky_cross(256, 1, dusk):write(here .. 'sky_dusk.png', 3)
end

-- Rough brickwork as heights: black joints, bricks of uneven height with worn edges.
function make.bricks_height()
    local size, rows, columns = 256, 8, 4
    local p = picture.new(size, size, { 0, 0, 0 })
    p:paint(function(x, y)
        local row = floor(y / size * rows)
        local shift = row % 2 * 0.5
        local bx, by = (x / size * columns + shift) % columns, y / size * rows
        local column = floor(bx)
        local fx, fy = bx - column, by - row
        local edge = math.min(fx, 1 - fx, (1 - fy) / 2, fy / 2)
        local rough = noise.sum(x * .06, y * .06, row * 3.1 + column * 7.7, 4)
        local h = smoothstep(.02, .10 + .02 * rough, edge + .015 * rough)
        h = h * (.72 + .10 * noise.noise(column * 5.3, row * 3.7, .5) + .10 * rough)
        return { h, h, h }
    end)
    p:write(here .. 'bricks_height.png', 4)
end

-- A woven band as a normal map: threads over and under each other. x right, y up, z out.
function make.weave_normal()
    local size, threads = 128, 8
    local function height(x, y)
        local u, v = x / size * threads, y / size * threads
        local a = sin(pi * (u % 1)) * (.75 + .25 * cos(pi * (v - .5 + floor(u))))
        local b = sin(pi * (v % 1)) * (.75 - .25 * cos(pi * (u - .5 + floor(v))))
        return 6 * math.max(a, b)
    end
    local p = picture.new(size, size, { 0, 0, 1 })
    p:paint(function(x, y)
        local hx = (height(x + .5, y) - height(x - .5, y)) * .8
        local hy = (height(x, y + .5) - height(x, y - .5)) * .8
        local l = sqrt(1 + hx * hx + hy * hy)
        local function code(c) return (128 + 127 * c) / 255 end
        return { code(-hx / l), code(hy / l), code(1 / l) }
    end)
    p:write(here .. 'weave_normal.png', 1)
end

-- Leaves for cut-outs: what is white is there.
function make.leaves_mask()
    local size = 256
    local p = picture.new(size, size, { 0, 0, 0 })
    p:paint(function(x, y)
        local inside = false
        for k = 0, 6 do
            local angle = k * 2 * pi / 7 + .3
            local cx, cy = size / 2 + 62 * cos(angle), size / 2 + 62 * sin(angle)
            local dx, dy = x - cx, y - cy
            local along, across = dx * cos(angle) + dy * sin(angle), dy * cos(angle) - dx * sin(angle)
            local t = along / 58
            inside = inside or (abs(t) < 1 and abs(across) < 22 * (1 - t * t) * (1 - .35 * t))
        end
        local d = sqrt((x - size / 2) ^ 2 + (y - size / 2) ^ 2)
        inside = inside or d < 14
        local c = inside and 1 or 0
        return { c, c, c }
    end)
    p:write(here .. 'leaves_mask.png', 1)
end

local names = { ... }
if #names == 0 then
    for name in pairs(make) do names[#names + 1] = name end
    table.sort(names)
end
for _, name in ipairs(names) do
    if not make[name] then error('there is no texture ' .. name) end
    make[name]()
end
