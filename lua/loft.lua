-- loft: a surface through cross sections.
-- Idea: every section is resampled at equal steps of its length, so that sections with any number of points fit;
-- the lines from section to section are centripetal Catmull-Rom splines (lathe.spline).
-- Invariant: sections that run counter-clockwise seen from the last one give faces seen from outside; with caps, or as a
-- ring, the mesh is closed.
--
--   local loft = require 'loft'
--   local verts, normals, faces, face_normals = loft.mesh({square, circle, star}, {heights = {0, 1, 2.5}})

local check = require 'check'
local lathe = require 'lathe'
local meshes = require 'meshes'

local M = {}

local sqrt = math.sqrt

local function distance(p, q)
    local s = 0
    for k = 1, #p do s = s + (p[k] - q[k]) ^ 2 end
    return sqrt(s)
end

--- A closed outline resampled at equal steps of its length.
---@param outline number[][]  points of two or three numbers
---@param n integer  how many points
---@param start number?  where the first lies, 0..1 along it; default 0
---@return number[][]
function M.resample(outline, n, start)
    local where = 'loft.resample'
    check.list(where, 'outline', outline, 3)
    local size = type(outline[1]) == 'table' and #outline[1] == 2 and 2 or 3
    check.points(where, 'outline', outline, size, 3)
    check.whole(where, 'n', n, 3, 100000)
    check.number(where, 'start', start, 0, 1, 0)
    local count, at = #outline, { 0 }
    for k = 1, count do at[k + 1] = at[k] + distance(outline[k], outline[k % count + 1]) end
    local total = at[count + 1]
    if total == 0 then check.fail(where, 'outline has no length') end
    local out, k = {}, 1
    for i = 0, n - 1 do
        local s = ((start or 0) + i / n) % 1 * total
        if s < at[k] then k = 1 end
        while k < count and at[k + 1] <= s do k = k + 1 end
        local p, q = outline[k], outline[k % count + 1]
        local t, r = at[k + 1] > at[k] and (s - at[k]) / (at[k + 1] - at[k]) or 0, {}
        for d = 1, size do r[d] = p[d] + (q[d] - p[d]) * t end
        out[i + 1] = r
    end
    return out
end

--- The outline with another start point, so that it is nearest to the previous one.
local function aligned(before, points)
    local n, best, least = #points, 0, math.huge
    for shift = 0, n - 1 do
        local sum = 0
        for k = 1, n, math.max(1, n // 32) do
            local p, q = before[k], points[(k + shift - 1) % n + 1]
            sum = sum + (p[1] - q[1]) ^ 2 + (p[2] - q[2]) ^ 2 + (p[3] - q[3]) ^ 2
        end
        if sum < least then best, least = shift, sum end
    end
    local out = {}
    for k = 1, n do out[k] = points[(k + best - 1) % n + 1] end
    return out
end

--- A surface through sections.
---@param sections number[][][]  closed outlines of points {x, y, z}; or of pairs {x, z} with options.heights
---@param options table?  heights: y of each section of pairs; around: points of a section (64), along: pieces between two
---  sections (8), straight: no splines between them (false), ring: the last section is followed by the first (false),
---  caps: flat ends (true), align: start points are chosen to avoid twist (true), crease: degrees above
---  which an edge stays sharp (40)
---@return number[][] verts
---@return number[][] normals
---@return integer[][] faces
---@return integer[][] face_normals
function M.mesh(sections, options)
    local where = 'loft.mesh'
    check.list(where, 'sections', sections, 2)
    options = check.options(where, options, 'heights around along straight ring caps align crease')
    local around = check.whole(where, 'around', options.around, 3, 10000, 64)
    local along = check.whole(where, 'along', options.along, 1, 1000, 8)
    local ring = check.flag(where, 'ring', options.ring)
    local straight = check.flag(where, 'straight', options.straight)
    local align = check.flag(where, 'align', options.align, true)
    local crease = check.number(where, 'crease', options.crease, 0, 180, 40)
    if options.heights ~= nil then
        check.list(where, 'heights', options.heights, #sections)
        for k = 1, #sections do check.number(where, ('heights[%d]'):format(k), options.heights[k]) end
    end
    if ring and #sections < 3 then check.fail(where, 'a ring must have at least 3 sections') end
    local rows = {}
    for s, section in ipairs(sections) do
        check.points(where, ('sections[%d]'):format(s), section, options.heights and 2 or 3, 3)
        local points = {}
        for k, p in ipairs(section) do
            -- pairs are seen from above: x to the right, z towards the viewer, so that counter-clockwise is x, -z
            points[k] = options.heights and { p[1], options.heights[s], p[2] } or { p[1], p[2], p[3] }
        end
        points = M.resample(points, around)
        rows[s] = align and s > 1 and aligned(rows[s - 1], points) or points
    end
    local lines = {}
    for k = 1, around do
        local line = {}
        for s = 1, #rows do line[s] = rows[s][k] end
        if straight then
            lines[k] = line
        else
            lines[k] = lathe.spline(line, along, ring)
        end
    end
    local count = #lines[1]
    local verts, faces = {}, {}
    for i = 1, count do
        for k = 1, around do verts[#verts + 1] = lines[k][i] end
    end
    for i = 0, (ring and count or count - 1) - 1 do
        local here, there = i * around, (i + 1) % count * around
        for k = 0, around - 1 do
            local next_k = (k + 1) % around
            faces[#faces + 1] = { here + k, here + next_k, there + next_k, there + k }
        end
    end
    if not ring and check.flag(where, 'caps', options.caps, true) then
        local first, last = {}, {}
        for k = 0, around - 1 do first[around - k], last[k + 1] = k, (count - 1) * around + k end
        faces[#faces + 1], faces[#faces + 2] = first, last
    end
    local mesh = meshes.smooth(verts, faces, crease)
    return mesh[1], mesh[2], mesh[3], mesh[4]
end

--- Outlines to begin with, as pairs, counter-clockwise seen from above: a regular polygon or a star, a superellipse.
---@param corners integer
---@param radius number?  default 1
---@param inner number?  radius of the corners between: makes a star
---@param turn number?  degrees
function M.polygon(corners, radius, inner, turn)
    check.whole('loft.polygon', 'corners', corners, 3, 10000)
    radius = check.above('loft.polygon', 'radius', radius, 0, 1)
    if inner ~= nil then check.above('loft.polygon', 'inner', inner, 0) end
    check.number('loft.polygon', 'turn', turn, nil, nil, 0)
    local out, n = {}, inner and 2 * corners or corners
    for k = 0, n - 1 do
        local a, r = 2 * math.pi * k / n + math.rad(turn or 0), inner and k % 2 == 1 and inner or radius
        out[k + 1] = { r * math.cos(a), -r * math.sin(a) }
    end
    return out
end

--- |x / a|^e + |z / b|^e = 1: 2 an ellipse, larger ones rounded rectangles.
---@param a number
---@param b number
---@param exponent number?  default 2
---@param n integer?  default 96
function M.superellipse(a, b, exponent, n)
    check.above('loft.superellipse', 'a', a, 0)
    check.above('loft.superellipse', 'b', b, 0)
    exponent = check.number('loft.superellipse', 'exponent', exponent, 0.1, 100, 2)
    n = check.whole('loft.superellipse', 'n', n, 4, 10000, 96)
    local out = {}
    for k = 0, n - 1 do
        local c, s = math.cos(2 * math.pi * k / n), math.sin(2 * math.pi * k / n)
        local function power(x) return x < 0 and -(-x) ^ (2 / exponent) or x ^ (2 / exponent) end
        out[k + 1] = { a * power(c), -b * power(s) }
    end
    return out
end

return M
