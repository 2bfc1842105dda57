-- sweep: a profile moved along a curve in space, as a mesh with vertex normals.
-- Idea: the frames have minimal rotation about the curve (Wang, Juettler, Zheng, Liu, "Computation of Rotation
-- Minimizing Frames", ACM TOG 27(1), 2008: double reflection); on a closed curve the angle that remains after one turn
-- is distributed evenly.
-- Invariant: the three vectors of a frame are orthonormal and right-handed: side x up = forward.
--
--   local sweep = require 'sweep'
--   local path = lathe.spline({{0, 0, 0}, {1, 1, 0}, {2, 0, 1}}, 16)
--   scene:add_child(gr.vn_mesh(oak, sweep.profile(path, loft.polygon(5, 0.2, 0.1), {twist = function(t) return 360 * t end})))

local check = require 'check'
local meshes = require 'meshes'

local M = {}

local sqrt, cos, sin, pi = math.sqrt, math.cos, math.sin, math.pi

local function dot(a, b) return a[1] * b[1] + a[2] * b[2] + a[3] * b[3] end

local function cross(a, b)
    return { a[2] * b[3] - a[3] * b[2], a[3] * b[1] - a[1] * b[3], a[1] * b[2] - a[2] * b[1] }
end

local function unit(a)
    local length = sqrt(dot(a, a))
    return { a[1] / length, a[2] / length, a[3] / length }
end

local function reflect(a, axis, squared)
    local f = 2 * dot(axis, a) / squared
    return { a[1] - f * axis[1], a[2] - f * axis[2], a[3] - f * axis[3] }
end

--- Frames along a path.
---@param path number[][]  points; no two in a row are equal
---@param closed boolean?
---@return table[] frames  each { forward, side, up }
function M.frames(path, closed)
    check.points('sweep.frames', 'path', path, 3, 2)
    local count, frames = #path, {}
    local function tangent(i)
        local a = path[i - 1] or (closed and path[count]) or path[i]
        local b = path[i + 1] or (closed and path[1]) or path[i]
        return unit { b[1] - a[1], b[2] - a[2], b[3] - a[3] }
    end
    local forward = tangent(1)
    local help = math.abs(forward[2]) < 0.9 and { 0, 1, 0 } or { 1, 0, 0 }
    local side = unit(cross(help, forward))
    frames[1] = { forward, side }
    local function carry(p, q, from, to, r)
        local v = { q[1] - p[1], q[2] - p[2], q[3] - p[3] }
        local squared = dot(v, v)
        local r1, t1 = reflect(r, v, squared), reflect(from, v, squared)
        local w = { to[1] - t1[1], to[2] - t1[2], to[3] - t1[3] }
        local w2 = dot(w, w)
        if w2 < 1e-24 then return r1 end
        return reflect(r1, w, w2)
    end
    for i = 2, count do
        local t = tangent(i)
        frames[i] = { t, carry(path[i - 1], path[i], frames[i - 1][1], t, frames[i - 1][2]) }
    end
    if closed then
        local back = carry(path[count], path[1], frames[count][1], frames[1][1], frames[count][2])
        local angle = math.atan(dot(cross(back, frames[1][2]), frames[1][1]), dot(back, frames[1][2]))
        for i, frame in ipairs(frames) do
            local a = angle * (i - 1) / count
            local up = cross(frame[1], frame[2])
            local s, u = frame[2], up
            frame[2] = { s[1] * cos(a) + u[1] * sin(a), s[2] * cos(a) + u[2] * sin(a), s[3] * cos(a) + u[3] * sin(a) }
        end
    end
    for _, frame in ipairs(frames) do
        frame[2] = unit(frame[2])
        frame[3] = cross(frame[1], frame[2])
    end
    return frames
end

--- A closed profile moved along a path.
---@param path number[][]  points in space
---@param profile number[][]  points {side, up} of a closed outline, counter-clockwise
---@param options table?  closed: the path is a ring; scale, twist: functions of 0..1 along the path (factor; degrees);
---  open_ends: leave out the two end faces; crease: degrees above which an edge stays sharp
---@return number[][] verts
---@return number[][] normals
---@return integer[][] faces
---@return integer[][] face_normals
function M.profile(path, profile, options)
    options = check.options('sweep.profile', options, 'closed scale twist open_ends crease')
    check.points('sweep.profile', 'path', path, 3, options.closed and 3 or 2)
    check.points('sweep.profile', 'profile', profile, 2, 3)
    if options.scale ~= nil then check.callable('sweep.profile', 'scale', options.scale) end
    if options.twist ~= nil then check.callable('sweep.profile', 'twist', options.twist) end
    local closed, count, around = options.closed, #path, #profile
    local frames = M.frames(path, closed)
    local verts, faces = {}, {}
    for i, p in ipairs(path) do
        local t = (i - 1) / (closed and count or count - 1)
        local k = options.scale and options.scale(t) or 1
        local a = options.twist and math.rad(options.twist(t)) or 0
        local c, s, side, up = cos(a) * k, sin(a) * k, frames[i][2], frames[i][3]
        for _, q in ipairs(profile) do
            local x, y = q[1] * c - q[2] * s, q[1] * s + q[2] * c
            verts[#verts + 1] = { p[1] + x * side[1] + y * up[1], p[2] + x * side[2] + y * up[2],
                                  p[3] + x * side[3] + y * up[3] }
        end
    end
    for i = 0, (closed and count or count - 1) - 1 do
        local here, there = i * around, (i + 1) % count * around
        for j = 0, around - 1 do
            local n = (j + 1) % around
            faces[#faces + 1] = { here + j, here + n, there + n, there + j }
        end
    end
    local mesh = meshes.smooth(verts, faces, options.crease)
    if not closed and not options.open_ends then
        for _, last in ipairs { false, true } do
            local face, face_normal, n = {}, {}, frames[last and count or 1][1]
            local sign = last and 1 or -1
            mesh[2][#mesh[2] + 1] = { sign * n[1], sign * n[2], sign * n[3] }
            for j = 0, around - 1 do
                face[j + 1] = last and (count - 1) * around + j or around - 1 - j
                face_normal[j + 1] = #mesh[2] - 1
            end
            if mesh[4] == mesh[3] then mesh[4] = table.move(mesh[3], 1, #mesh[3], 1, {}) end
            mesh[3][#mesh[3] + 1], mesh[4][#mesh[4] + 1] = face, face_normal
        end
    end
    return mesh[1], mesh[2], mesh[3], mesh[4]
end

--- A round tube along a path.
---@param path number[][]
---@param radius number
---@param around integer?  corners of the round, default 16
---@param options table?  as in profile
---@return number[][] verts
---@return number[][] normals
---@return integer[][] faces
---@return integer[][] face_normals
function M.tube(path, radius, around, options)
    check.above('sweep.tube', 'radius', radius, 0)
    around = check.whole('sweep.tube', 'around', around, 3, 10000, 16)
    local profile = {}
    for j = 0, around - 1 do
        profile[j + 1] = { radius * cos(2 * pi * j / around), radius * sin(2 * pi * j / around) }
    end
    return M.profile(path, profile, options)
end

return M
