-- polygon: outlines in the plane: areas, nesting, offsets, triangulation.
-- An outline is a list of points {x, y}, the last joined to the first. Several outlines together fill the points that
-- an odd number of them surrounds (even-odd rule).
-- Sources: G. Meisters, "Polygons have ears", Amer. Math. Monthly 82, 1975; D. Eberly, "Triangulation by Ear Clipping",
-- 2002 (bridges to holes).
-- Invariant: triangles use the outlines' own points and no others, so that a cap fits its sides edge by edge.
--
--   local polygon = require 'polygon'
--   local points, triangles = polygon.triangulate {square, hole}      -- 0-based indices into points
--   local smaller = polygon.offset(square, -0.1)

local check = require 'check'

local M = {}

local sqrt, abs = math.sqrt, math.abs

--- Area inside an outline, positive if it runs counter-clockwise.
---@param outline number[][]
---@return number
function M.area(outline)
    check.points('polygon.area', 'outline', outline, 2, 3)
    local twice, n = 0, #outline
    local o = outline[1]
    for k = 1, n do
        local p, q = outline[k], outline[k % n + 1]
        twice = twice + (p[1] - o[1]) * (q[2] - o[2]) - (p[2] - o[2]) * (q[1] - o[1])
    end
    return twice / 2
end

--- Whether a point is inside.
---@return boolean
function M.contains(outline, x, y)
    local inside, n = false, #outline
    for k = 1, n do
        local p, q = outline[k], outline[k % n + 1]
        if (p[2] > y) ~= (q[2] > y) and x < p[1] + (y - p[2]) * (q[1] - p[1]) / (q[2] - p[2]) then inside = not inside end
    end
    return inside
end

local function reversed(outline)
    local out, n = {}, #outline
    for k = 1, n do out[k] = outline[n + 1 - k] end
    return out
end

--- Groups outlines: each group is a counter-clockwise outline with its clockwise holes.
--- Outlines must not cross each other.
---@param outlines number[][][]
---@return table[] bodies  each { outline, holes = { ... } }
function M.bodies(outlines)
    local where = 'polygon.bodies'
    check.list(where, 'outlines', outlines, 1)
    local depth, bodies, owner = {}, {}, {}
    for i, outline in ipairs(outlines) do
        check.points(where, ('outlines[%d]'):format(i), outline, 2, 3)
        depth[i] = 0
        -- the middle of an edge, since corners may touch
        local p, q = outline[1], outline[2]
        local x, y = (p[1] + q[1]) / 2, (p[2] + q[2]) / 2
        for j, other in ipairs(outlines) do
            if i ~= j and M.contains(other, x, y) then depth[i] = depth[i] + 1 end
        end
    end
    for i, outline in ipairs(outlines) do
        if depth[i] % 2 == 0 then
            owner[i] = { M.area(outline) > 0 and outline or reversed(outline), holes = {}, number = i }
            bodies[#bodies + 1] = owner[i]
        end
    end
    for i, outline in ipairs(outlines) do
        if depth[i] % 2 == 1 then
            local p, q, best = outline[1], outline[2], nil
            for j, other in ipairs(outlines) do
                -- a hole belongs to the innermost outline that surrounds it
                if owner[j] and depth[j] == depth[i] - 1 and M.contains(other, (p[1] + q[1]) / 2, (p[2] + q[2]) / 2) then best = owner[j] end
            end
            if best then best.holes[#best.holes + 1] = M.area(outline) < 0 and outline or reversed(outline) end
        end
    end
    for _, body in ipairs(bodies) do body.number = nil end
    return bodies
end

--- Every edge moved to its right by a distance (outwards if the outline runs counter-clockwise; a negative one goes
--- inwards); the number of points stays the same. Sharp corners move by at most `limit` distances.
---@param outline number[][]
---@param distance number
---@param limit number?  default 3
---@return number[][]
function M.offset(outline, distance, limit)
    check.points('polygon.offset', 'outline', outline, 2, 3)
    check.number('polygon.offset', 'distance', distance)
    limit = check.number('polygon.offset', 'limit', limit, 1, nil, 3)
    local out, n = {}, #outline
    for k = 1, n do
        local a, p, b = outline[(k - 2) % n + 1], outline[k], outline[k % n + 1]
        local ux, uy, vx, vy = p[1] - a[1], p[2] - a[2], b[1] - p[1], b[2] - p[2]
        local u, v = sqrt(ux * ux + uy * uy), sqrt(vx * vx + vy * vy)
        if u == 0 then u, ux, uy = v, vx, vy end
        if v == 0 then v, vx, vy = u, ux, uy end
        local mx, my = 0, 0
        if u > 0 then mx, my = uy / u + vy / v, -ux / u - vx / v end
        -- |m| is 2 cos(half the turn), and the corner moves by distance / cos(half)
        local squared = mx * mx + my * my
        local factor = squared > 1e-12 and math.min(2 / squared, limit / sqrt(squared)) or 0
        out[k] = { p[1] + mx * factor * distance, p[2] + my * factor * distance }
    end
    return out
end

local function cross(a, b, c) return (b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1]) end

--- Joins the holes to the outline by bridges: one closed sequence of indices.
local function bridged(points, outline, holes)
    local walk = outline
    -- first the hole that extends furthest to the right
    local order = {}
    for k, hole in ipairs(holes) do
        local best = 1
        for i = 2, #hole do
            if points[hole[i]][1] > points[hole[best]][1] then best = i end
        end
        order[k] = { hole, best, points[hole[best]][1], k }
    end
    table.sort(order, function(a, b) return a[3] > b[3] or (a[3] == b[3] and a[4] < b[4]) end)
    for _, item in ipairs(order) do
        local hole, start = item[1], item[2]
        local m = points[hole[start]]
        -- the edge that a ray to +x from the hole's rightmost point meets first
        local nearest, at, n = math.huge, nil, #walk
        for k = 1, n do
            local p, q = points[walk[k]], points[walk[k % n + 1]]
            if p[2] <= m[2] and q[2] >= m[2] and p[2] ~= q[2] then
                local x = p[1] + (m[2] - p[2]) / (q[2] - p[2]) * (q[1] - p[1])
                if x >= m[1] and x < nearest then
                    nearest = x
                    at = p[1] > q[1] and k or k % n + 1
                end
            end
        end
        if at then
            -- reflex corners in the triangle may hide that end of the edge from m: the one with the smallest
            -- angle to the ray is visible
            local v, hit = points[walk[at]], { nearest, m[2] }
            local best, slope, near = at, math.huge, math.huge
            for k = 1, n do
                local p = points[walk[k]]
                local a, b = points[walk[(k - 2) % n + 1]], points[walk[k % n + 1]]
                local inside
                if v[2] < m[2] then inside = cross(m, v, p) >= 0 and cross(v, hit, p) >= 0 and cross(hit, m, p) >= 0
                else inside = cross(m, hit, p) >= 0 and cross(hit, v, p) >= 0 and cross(v, m, p) >= 0 end
                if inside and p[1] > m[1] and (cross(a, p, b) <= 0 or k == at) then
                    local s, d = abs(p[2] - m[2]) / (p[1] - m[1]), p[1] - m[1]
                    if s < slope - 1e-12 or (abs(s - slope) <= 1e-12 and d < near) then best, slope, near = k, s, d end
                end
            end
            local joined = {}
            for k = 1, best do joined[#joined + 1] = walk[k] end
            for k = 0, #hole do joined[#joined + 1] = hole[(start - 1 + k) % #hole + 1] end
            for k = best, n do joined[#joined + 1] = walk[k] end
            walk = joined
        end
    end
    return walk
end

--- Cuts ears off a sequence until it is empty.
local function clip(points, walk, triangles)
    local n = #walk
    local before, after, alive = {}, {}, n
    for k = 1, n do before[k], after[k] = (k - 2) % n + 1, k % n + 1 end
    local function is_ear(k, patience)
        local ia, ib, ic = walk[before[k]], walk[k], walk[after[k]]
        local a, b, c = points[ia], points[ib], points[ic]
        local turn = cross(a, b, c)
        if turn <= 0 then return patience == 2 and turn == 0 end
        if patience == 2 then return true end
        local low_x, high_x = math.min(a[1], b[1], c[1]), math.max(a[1], b[1], c[1])
        local low_y, high_y = math.min(a[2], b[2], c[2]), math.max(a[2], b[2], c[2])
        local j = after[after[k]]
        while j ~= before[k] do
            local i = walk[j]
            local p = points[i]
            if i ~= ia and i ~= ib and i ~= ic and p[1] >= low_x and p[1] <= high_x and p[2] >= low_y and p[2] <= high_y and
                cross(a, b, p) >= 0 and cross(b, c, p) >= 0 and cross(c, a, p) >= 0 then
                -- a corner that only touches blocks the ear only if it is reflex there
                if patience == 0 or cross(points[walk[before[j]]], p, points[walk[after[j]]]) < 0 then return false end
            end
            j = after[j]
        end
        return true
    end
    local k, idle, patience = 1, 0, 0
    while alive > 3 do
        if is_ear(k, patience) then
            triangles[#triangles + 1] = { walk[before[k]] - 1, walk[k] - 1, walk[after[k]] - 1 }
            after[before[k]], before[after[k]] = after[k], before[k]
            alive, idle, patience = alive - 1, 0, 0
            k = after[after[k]]
        else
            k, idle = after[k], idle + 1
            if idle > alive then
                idle, patience = 0, patience + 1
                if patience > 2 then return end
            end
        end
    end
    triangles[#triangles + 1] = { walk[before[k]] - 1, walk[k] - 1, walk[after[k]] - 1 }
end

--- The filled region as counter-clockwise triangles; outlines must not cross.
---@param outlines number[][][]
---@return number[][] points  those of all outlines, one after another as they were given
---@return integer[][] triangles  0-based
function M.triangulate(outlines)
    local bodies, points, number = M.bodies(outlines), {}, {}
    for _, outline in ipairs(outlines) do
        for _, p in ipairs(outline) do
            points[#points + 1] = p
            number[p] = #points
        end
    end
    local function indices(outline)
        local out = {}
        for k, p in ipairs(outline) do out[k] = number[p] end
        return out
    end
    local triangles = {}
    for _, body in ipairs(bodies) do
        local holes = {}
        for k, hole in ipairs(body.holes) do holes[k] = indices(hole) end
        clip(points, bridged(points, indices(body[1]), holes), triangles)
    end
    return points, triangles
end

--- A solid from outlines in the plane z = 0, extruded to z = `depth`, optionally with bevelled edges.
---@param outlines number[][][]
---@param depth number
---@param options table?  bevel: how far the front edge is cut away (0), steps: pieces of a round bevel (1: flat), back:
---  whether the back edge is bevelled too (false), crease: degrees above which an edge stays sharp (35)
---@return number[][] verts
---@return number[][] normals
---@return integer[][] faces
---@return integer[][] face_normals
function M.extrude(outlines, depth, options)
    local where = 'polygon.extrude'
    check.above(where, 'depth', depth, 0)
    options = check.options(where, options, 'bevel steps back crease')
    local bevel = check.number(where, 'bevel', options.bevel, 0, depth, 0)
    local steps = check.whole(where, 'steps', options.steps, 1, 64, 1)
    local back = check.flag(where, 'back', options.back)
    if back and 2 * bevel > depth then check.fail(where, 'bevel must be at most half the depth when the back has one too') end
    local crease = check.number(where, 'crease', options.crease, 0, 180, 35)
    -- the profile of the side: inset and height, from the back to the front
    local side = {}
    local function round(k) return bevel * (1 - math.cos(math.pi / 2 * k / steps)), bevel * (1 - math.sin(math.pi / 2 * k / steps)) end
    if bevel > 0 and back then
        for k = steps, 1, -1 do
            local inward, up = round(k)
            if steps == 1 then inward, up = bevel, 0 end
            side[#side + 1] = { inward, up }
        end
        side[#side + 1] = { 0, bevel }
    else
        side[1] = { 0, 0 }
    end
    if bevel > 0 then
        side[#side + 1] = { 0, depth - bevel }
        for k = 1, steps do
            local inward, up = round(k)
            if steps == 1 then inward, up = bevel, 0 end
            side[#side + 1] = { inward, depth - up }
        end
    else
        side[2] = { 0, depth }
    end
    if #side > 1 and side[#side][2] - side[#side - 1][2] == 0 and side[#side][1] == side[#side - 1][1] then side[#side] = nil end
    local meshes = require 'meshes'
    local verts, faces, caps = {}, {}, {}
    for _, body in ipairs(M.bodies(outlines)) do
        local all = { body[1], table.unpack(body.holes) }
        local rows = {}
        for level, s in ipairs(side) do
            rows[level] = {}
            for k, outline in ipairs(all) do rows[level][k] = s[1] > 0 and M.offset(outline, -s[1], 2) or outline end
        end
        local first = {}
        for level, row in ipairs(rows) do
            first[level] = {}
            for k, outline in ipairs(row) do
                first[level][k] = #verts
                for _, p in ipairs(outline) do verts[#verts + 1] = { p[1], p[2], side[level][2] } end
            end
        end
        for level = 1, #rows - 1 do
            for k, outline in ipairs(all) do
                local low, high, n = first[level][k], first[level + 1][k], #outline
                for i = 0, n - 1 do
                    local j = (i + 1) % n
                    faces[#faces + 1] = { low + i, low + j, high + j, high + i }
                end
            end
        end
        for _, level in ipairs { 1, #rows } do
            local copies, index, base = {}, {}, 0
            for k, outline in ipairs(rows[level]) do
                copies[k] = {}
                for i, p in ipairs(outline) do copies[k][i] = { p[1], p[2] } end
                for i = 1, #outline do index[base + i - 1] = first[level][k] + i - 1 end
                base = base + #outline
            end
            local _, triangles = M.triangulate(copies)
            for _, t in ipairs(triangles) do
                local a, b, c = index[t[1]], index[t[2]], index[t[3]]
                caps[#caps + 1] = level == 1 and { c, b, a, front = false } or { a, b, c, front = true }
            end
        end
    end
    -- the sides are smooth, the ends flat
    local mesh = meshes.smooth(verts, faces, crease)
    local normals, face_normals = mesh[2], mesh[4]
    local down = #normals
    normals[down + 1], normals[down + 2] = { 0, 0, -1 }, { 0, 0, 1 }
    for _, cap in ipairs(caps) do
        local n = cap.front and down + 1 or down
        cap.front = nil
        faces[#faces + 1], face_normals[#face_normals + 1] = cap, { n, n, n }
    end
    return verts, normals, faces, face_normals
end

return M
