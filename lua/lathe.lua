-- lathe: a profile rotated about the y axis, as a mesh with vertex normals.
-- Idea: the profile is a list of points {radius, height}; the normals come from its tangent, so they are exact around
-- the axis. A repeated point is an edge: its two sides have separate normals.
-- Invariant: the outside is to the right of the profile, i.e. a solid's profile starts at the bottom of
-- the axis, goes up the outside and ends at the axis. Points on the axis (radius 0) give triangles.
--
--   local lathe = require 'lathe'
--   local vase = lathe.spline({{0, 0}, {0.6, 0}, {0.9, 0.8}, {0.4, 1.6}, {0.6, 1.9}, {0, 1.7}}, 8)
--   scene:add_child(gr.vn_mesh(clay, lathe.turn(vase, 64)))

local check = require 'check'
local meshes = require 'meshes'

local M = {}

--- A smooth curve through points (Catmull-Rom, centripetal), for profiles and paths. A repeated point is kept as a
--- corner.
---@param points number[][]  tuples of two or three numbers
---@param n integer?  pieces between two points, default 8
---@param closed boolean?  the curve returns to its first point
---@return number[][] points
function M.spline(points, n, closed)
    check.list('lathe.spline', 'points', points, 2)
    local count, size = #points, type(points[1]) == 'table' and #points[1] or 0
    check.points('lathe.spline', 'points', points, size, 2)
    n = check.whole('lathe.spline', 'n', n, 1, 10000, 8)
    local function distance(p, q)
        local sum = 0
        for k = 1, size do sum = sum + (p[k] - q[k]) ^ 2 end
        return sum ^ 0.25
    end
    local function beyond(p, q)
        local r = {}
        for k = 1, size do r[k] = 2 * p[k] - q[k] end
        return r
    end
    local out = {}
    local last = closed and count or count - 1
    local function at(i) return points[(i - 1) % count + 1] end
    for i = 1, last do
        local b, c = at(i), at(i + 1)
        if distance(b, c) == 0 then
            out[#out + 1] = b
        else
            local a = (closed or i > 1) and at(i - 1) or beyond(b, c)
            local d = (closed or i + 1 < count) and at(i + 2) or beyond(c, b)
            if distance(a, b) == 0 then a = beyond(b, c) end
            if distance(c, d) == 0 then d = beyond(c, b) end
            local t1 = distance(a, b)
            local t2 = t1 + distance(b, c)
            local t3 = t2 + distance(c, d)
            for j = 0, n - 1 do
                local t, p = t1 + (t2 - t1) * j / n, {}
                for k = 1, size do
                    local a1 = (a[k] * (t1 - t) + b[k] * t) / t1
                    local a2 = (b[k] * (t2 - t) + c[k] * (t - t1)) / (t2 - t1)
                    local a3 = (c[k] * (t3 - t) + d[k] * (t - t2)) / (t3 - t2)
                    local b1 = (a1 * (t2 - t) + a2 * t) / t2
                    local b2 = (a2 * (t3 - t) + a3 * (t - t1)) / (t3 - t1)
                    p[k] = (b1 * (t2 - t) + b2 * (t - t1)) / (t2 - t1)
                end
                out[#out + 1] = p
            end
        end
    end
    if not closed then out[#out + 1] = points[count] end
    return out
end

--- Normals of a profile: one before and one after every point (they differ at edges only).
local function profile_normals(profile)
    local count, slopes = #profile, {}
    for i = 1, count - 1 do
        local p, q = profile[i], profile[i + 1]
        local x, y = q[1] - p[1], q[2] - p[2]
        local length = math.sqrt(x * x + y * y)
        slopes[i] = length > 1e-12 and { y / length, -x / length, length } or false
    end
    local before, after = {}, {}
    for i = 1, count do
        local a, b = slopes[i - 1] or nil, slopes[i] or nil
        local n
        if a and b then
            -- the shorter segment approximates the tangent better
            local x, y = a[1] * b[3] + b[1] * a[3], a[2] * b[3] + b[2] * a[3]
            local length = math.sqrt(x * x + y * y)
            n = length > 0 and { x / length, y / length } or { a[1], a[2] }
        else
            n = a or b or { 1, 0 }
        end
        before[i], after[i] = { n[1], n[2] }, { n[1], n[2] }
    end
    -- on the axis a smooth profile is horizontal
    for _, list in ipairs { before, after } do
        for k = 1, count do
            local edge = slopes[k] or slopes[k - 1]
            if profile[k][1] == 0 and edge and math.abs(edge[2]) > 0.9 then
                list[k] = { 0, list[k][2] < 0 and -1 or 1 }
            end
        end
    end
    return before, after, slopes
end

--- Rotates a profile about the y axis.
---@param profile number[][]  points {radius, height}, the outside on the right of the way
---@param segments integer?  default 48
---@return number[][] verts
---@return number[][] normals
---@return integer[][] faces
---@return integer[][] face_normals
function M.turn(profile, segments)
    check.points('lathe.turn', 'profile', profile, 2, 2)
    segments = check.whole('lathe.turn', 'segments', segments, 3, 100000, 48)
    local before, after, slopes = profile_normals(profile)
    local verts, normals, faces, face_normals = {}, {}, {}, {}
    local circle = {}
    for s = 0, segments - 1 do
        local angle = 2 * math.pi * s / segments
        circle[s] = { math.cos(angle), math.sin(angle) }
    end
    local first = {}
    for i, p in ipairs(profile) do
        first[i] = #verts
        if p[1] == 0 then
            verts[#verts + 1] = { 0, p[2], 0 }
        else
            for s = 0, segments - 1 do verts[#verts + 1] = { p[1] * circle[s][1], p[2], p[1] * circle[s][2] } end
        end
    end
    local function ring(n)
        local base = #normals
        for s = 0, segments - 1 do normals[#normals + 1] = { n[1] * circle[s][1], n[2], n[1] * circle[s][2] } end
        return base
    end
    for i = 1, #profile - 1 do
        if slopes[i] then
            local low, high = profile[i][1] == 0, profile[i + 1][1] == 0
            if not (low and high) then
                local n0, n1 = ring(after[i]), ring(before[i + 1])
                local v0, v1 = first[i], first[i + 1]
                for s = 0, segments - 1 do
                    local t = (s + 1) % segments
                    if low then
                        faces[#faces + 1] = { v0, v1 + s, v1 + t }
                        face_normals[#face_normals + 1] = { n0 + s, n1 + s, n1 + t }
                    elseif high then
                        faces[#faces + 1] = { v0 + s, v1, v0 + t }
                        face_normals[#face_normals + 1] = { n0 + s, n1 + s, n0 + t }
                    else
                        faces[#faces + 1] = { v0 + s, v1 + s, v1 + t, v0 + t }
                        face_normals[#face_normals + 1] = { n0 + s, n1 + s, n1 + t, n0 + t }
                    end
                end
            end
        end
    end
    return verts, normals, faces, face_normals
end

--- Rotates a profile and adds ornament: `relief` returns the factor of the radius.
---@param profile number[][]  points {radius, height}
---@param segments integer  cells round the axis
---@param relief fun(angle: number, t: number, height: number): number  factor of the radius; angle 0..2 pi, t 0..1 along the profile
---@return table mesh  { verts, normals, faces, face_normals }
function M.carved(profile, segments, relief)
    check.points('lathe.carved', 'profile', profile, 2, 2)
    check.whole('lathe.carved', 'segments', segments, 3, 100000)
    check.callable('lathe.carved', 'relief', relief)
    local rows = #profile - 1
    return meshes.net(rows, segments, function(i, j)
        local p, angle = profile[i + 1], -2 * math.pi * j / segments
        local radius = p[1] * relief(-angle, i / rows, p[2])
        return radius * math.cos(angle), p[2], radius * math.sin(angle)
    end, false, true)
end

return M
