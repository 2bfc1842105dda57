-- scatter: points with a minimum distance, in a rectangle, a box or on a mesh.
-- Sources: R. Bridson, "Fast Poisson Disk Sampling in Arbitrary Dimensions", SIGGRAPH sketches 2007 (rectangle and box);
-- D. Cline, S. Jeschke, K. White, A. Razdan, P. Wonka, "Dart Throwing on Surfaces", EGSR 2009 (a mesh, by distance);
-- C. Yuksel, "Sample Elimination for Generating Poisson Disk Sample Sets", EUROGRAPHICS 2015 (a mesh, by number).
-- Invariant: with a radius no two points are nearer to each other (in straight distance); the same
-- seed gives the same points.
--
--   local scatter = require 'scatter'
--   local trees = scatter.mesh(verts, faces, {radius = 0.4, seed = 3, where = function(p, n) return n[2] > 0.8 end})
--   local daisies = scatter.mesh(verts, faces, {count = 500})
--   scene:add_child(scatter.place(trees, {fir, oak}, {scale = {0.7, 1.2}, lean = 0.2}))

local check = require 'check'
local random = require 'random'

local M = {}

local floor, sqrt, min, max = math.floor, math.sqrt, math.min, math.max

--- Bridson's algorithm in 2 or 3 dimensions.
local function bridson(size, radius, tries, dice)
    local d = #size
    local cell = radius / sqrt(d)
    local grid, points, active = {}, {}, {}
    local nx, ny = math.ceil(size[1] / cell) + 1, math.ceil(size[2] / cell) + 1
    local nz = d == 3 and math.ceil(size[3] / cell) + 1 or 1
    local reach, least = 2, radius * radius
    local function add(p)
        points[#points + 1] = p
        local k = d == 3 and floor(p[3] / cell) or 0
        grid[(k * ny + floor(p[2] / cell)) * nx + floor(p[1] / cell)] = p
        active[#active + 1] = p
    end
    local function is_free(p)
        local ci, cj, ck = floor(p[1] / cell), floor(p[2] / cell), d == 3 and floor(p[3] / cell) or 0
        for k = max(0, ck - reach), min(nz - 1, ck + reach) do
            for j = max(0, cj - reach), min(ny - 1, cj + reach) do
                local row = (k * ny + j) * nx
                for i = max(0, ci - reach), min(nx - 1, ci + reach) do
                    local q = grid[row + i]
                    if q then
                        local x, y, z = p[1] - q[1], p[2] - q[2], d == 3 and p[3] - q[3] or 0
                        if x * x + y * y + z * z < least then return false end
                    end
                end
            end
        end
        return true
    end
    local first = {}
    for k = 1, d do first[k] = dice:range(0, size[k]) end
    add(first)
    while #active > 0 do
        local at = 1 + dice:bits() * #active // 4294967296
        local p, found = active[at], false
        for _ = 1, tries do
            local q
            if d == 2 then
                -- uniform in the ring from one to two radii
                local r, angle = radius * sqrt(dice:range(1, 4)), dice:range(0, 2 * math.pi)
                q = { p[1] + r * math.cos(angle), p[2] + r * math.sin(angle) }
            else
                local r, way = radius * dice:range(1, 8) ^ (1 / 3), dice:direction()
                q = { p[1] + r * way[1], p[2] + r * way[2], p[3] + r * way[3] }
            end
            local inside = true
            for k = 1, d do inside = inside and q[k] >= 0 and q[k] <= size[k] end
            if inside and is_free(q) then
                add(q)
                found = true
                break
            end
        end
        if not found then
            active[at] = active[#active]
            active[#active] = nil
        end
    end
    return points
end

--- Points {x, z} in the rectangle from (0, 0) to (width, depth).
---@param width number
---@param depth number
---@param radius number  the smallest distance between two
---@param options table?  seed (1), tries (30)
---@return number[][]
function M.rectangle(width, depth, radius, options)
    local where = 'scatter.rectangle'
    check.above(where, 'width', width, 0)
    check.above(where, 'depth', depth, 0)
    check.above(where, 'radius', radius, 0)
    options = check.options(where, options, 'seed tries')
    if width * depth / (radius * radius) > 4e6 then check.fail(where, 'radius is so small that millions of places would be made') end
    return bridson({ width, depth }, radius, check.whole(where, 'tries', options.tries, 1, 1000, 30),
        random.new(check.whole(where, 'seed', options.seed, nil, nil, 1)))
end

--- Points {x, y, z} in the box from the origin to `size`.
---@param size number[]
---@param radius number
---@param options table?  seed (1), tries (30)
---@return number[][]
function M.box(size, radius, options)
    local where = 'scatter.box'
    check.tuple(where, 'size', size, 3)
    check.above(where, 'radius', radius, 0)
    for k = 1, 3 do check.above(where, ('size[%d]'):format(k), size[k], 0) end
    options = check.options(where, options, 'seed tries')
    if size[1] * size[2] * size[3] / radius ^ 3 > 4e6 then check.fail(where, 'radius is so small that millions of places would be made') end
    return bridson({ size[1], size[2], size[3] }, radius, check.whole(where, 'tries', options.tries, 1, 1000, 30),
        random.new(check.whole(where, 'seed', options.seed, nil, nil, 1)))
end

--- Triangles of a mesh with the sums of their areas, and a function that draws a random point on it.
local function sampler(verts, faces, dice, density)
    local triangles, total = {}, 0
    for f, face in ipairs(faces) do
        local a = verts[face[1] + 1]
        for k = 2, #face - 1 do
            local b, c = verts[face[k] + 1], verts[face[k + 1] + 1]
            local ux, uy, uz = b[1] - a[1], b[2] - a[2], b[3] - a[3]
            local vx, vy, vz = c[1] - a[1], c[2] - a[2], c[3] - a[3]
            local nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
            local twice = sqrt(nx * nx + ny * ny + nz * nz)
            if twice > 0 then
                total = total + twice / 2
                triangles[#triangles + 1] = { a, b, c, total, { nx / twice, ny / twice, nz / twice }, f }
            end
        end
    end
    local function draw()
        local target, low, high = dice:number() * total, 1, #triangles
        while low < high do
            local middle = (low + high) // 2
            if triangles[middle][4] > target then high = middle else low = middle + 1 end
        end
        local t = triangles[low]
        local r, s = sqrt(dice:number()), dice:number()
        local wa, wb, wc = 1 - r, r * (1 - s), r * s
        local a, b, c = t[1], t[2], t[3]
        local p = { wa * a[1] + wb * b[1] + wc * c[1], wa * a[2] + wb * b[2] + wc * c[2], wa * a[3] + wb * b[3] + wc * c[3] }
        if density and not density(p, t[5], t[6]) then return nil end
        return { position = p, normal = t[5], face = t[6] }
    end
    return draw, total
end

--- A lattice of cubes for neighbour searches.
local function lattice(cell)
    local cells = {}
    local function key(i, j, k) return (i * 2097152 + j) * 2097152 + k end
    local self = {}
    function self.add(place)
        local p = place.position
        local at = key(floor(p[1] / cell), floor(p[2] / cell), floor(p[3] / cell))
        local list = cells[at]
        if list then list[#list + 1] = place else cells[at] = { place } end
    end
    --- Calls f(other, squared distance) for all within one cell; stops when it returns true.
    function self.near(p, f)
        local i, j, k = floor(p[1] / cell), floor(p[2] / cell), floor(p[3] / cell)
        for x = i - 1, i + 1 do
            for y = j - 1, j + 1 do
                for z = k - 1, k + 1 do
                    local list = cells[key(x, y, z)]
                    if list then
                        for n = 1, #list do
                            local q = list[n].position
                            local dx, dy, dz = p[1] - q[1], p[2] - q[2], p[3] - q[3]
                            if f(list[n], dx * dx + dy * dy + dz * dz) then return true end
                        end
                    end
                end
            end
        end
        return false
    end
    return self
end

local function throw(draw, total, radius, patience)
    local near, places, least = lattice(radius), {}, radius * radius
    local wanted = total / (radius * radius)
    -- a saturated surface has about 0.7 points per squared radius; with this many candidates gaps are negligible
    for _ = 1, math.ceil(patience * wanted) + 50 do
        local place = draw()
        if place and not near.near(place.position, function(_, squared) return squared < least end) then
            near.add(place)
            places[#places + 1] = place
        end
    end
    return places
end

--- Yuksel's elimination: repeatedly removes the candidate with the greatest weight, i.e. with the nearest neighbours.
local function eliminate(candidates, count, total)
    local radius = sqrt(total / (2 * sqrt(3) * count)) -- no set of this many points has twice this distance
    local smallest = radius * (1 - (count / #candidates) ^ 1.5) * 0.65
    local reach, near, weight, links = 2 * radius, lattice(2 * radius), {}, {}
    for k, place in ipairs(candidates) do
        place.number = k
        near.add(place)
    end
    local function share(squared)
        local d = max(sqrt(squared), 2 * smallest)
        return (1 - min(d, reach) / reach) ^ 8
    end
    for k, place in ipairs(candidates) do
        local sum, list = 0, {}
        near.near(place.position, function(other, squared)
            if other ~= place and squared < reach * reach then
                local w = share(squared)
                sum = sum + w
                list[#list + 1] = { other.number, w }
            end
        end)
        weight[k], links[k] = sum, list
    end
    -- a heap with the heaviest on top; equal weights are ordered by number, so that the result is unique
    local heap, at, size = {}, {}, #candidates
    local function heavier(a, b) return weight[a] > weight[b] or (weight[a] == weight[b] and a < b) end
    local function sink(i)
        local item = heap[i]
        while 2 * i <= size do
            local child = 2 * i
            if child < size and heavier(heap[child + 1], heap[child]) then child = child + 1 end
            if not heavier(heap[child], item) then break end
            heap[i] = heap[child]
            at[heap[i]] = i
            i = child
        end
        heap[i], at[item] = item, i
    end
    for k = 1, size do heap[k], at[k] = k, k end
    for i = size // 2, 1, -1 do sink(i) end
    while size > count do
        local top = heap[1]
        heap[1] = heap[size]
        at[heap[1]], at[top] = 1, nil
        heap[size] = nil
        size = size - 1
        if size > 0 then sink(1) end
        for _, link in ipairs(links[top]) do
            local other = link[1]
            if at[other] then
                weight[other] = weight[other] - link[2] -- its weight only decreases
                sink(at[other])
            end
        end
    end
    local out = {}
    for k, place in ipairs(candidates) do
        if at[k] then out[#out + 1] = place end
        place.number = nil
    end
    return out
end

--- Points on a mesh, by their minimum distance or by their number.
---@param verts number[][]
---@param faces integer[][]
---@param options table  radius or count; seed (1); where: a function of (position, normal, face number) that says whether
---  whether to keep a point there
---@return table[] places  each { position, normal, face: counted from 1 }
function M.mesh(verts, faces, options)
    local where = 'scatter.mesh'
    check.points(where, 'verts', verts, 3)
    check.faces(where, 'faces', faces, #verts)
    options = check.options(where, options, 'radius count seed where')
    if (options.radius == nil) == (options.count == nil) then check.fail(where, 'options must hold either radius or count') end
    if options.where ~= nil then check.callable(where, 'where', options.where) end
    local dice = random.new(check.whole(where, 'seed', options.seed, nil, nil, 1))
    local draw, total = sampler(verts, faces, dice, options.where)
    if not (total > 0) then check.fail(where, 'the mesh has no area') end
    if options.radius then
        check.above(where, 'radius', options.radius, 0)
        if total / options.radius ^ 2 > 2e6 then check.fail(where, 'radius is so small that millions of places would be made') end
        return throw(draw, total, options.radius, 20)
    end
    local count = check.whole(where, 'count', options.count, 1, 200000)
    local candidates, wanted, tried = {}, 5 * count, 0
    while #candidates < wanted do
        local place = draw()
        tried = tried + 1
        if place then candidates[#candidates + 1] = place end
        if tried > 200 * wanted then check.fail(where, "options.where refuses nearly every place") end
    end
    return eliminate(candidates, count, total * #candidates / tried)
end

--- Nodes at points: each with its y axis along the normal, with random rotation about it and random scale.
---@param places table[]  as scatter.mesh returns them; or points {x, y, z}; or pairs {x, z}, at y = 0
---@param nodes gr.node|gr.node[]  one, or several to choose from
---@param options table?  scale: a number or {low, high} (1), lean: how much of the normal counts against straight up, 0 to
---  1 (1), sink: how far they are pushed in (0), spin: whether they are turned about their y (true), seed (1)
---@return gr.node
function M.place(places, nodes, options)
    local where = 'scatter.place'
    check.table(where, 'places', places)
    if type(nodes) ~= 'table' then nodes = { nodes } end
    check.list(where, 'nodes', nodes, 1)
    options = check.options(where, options, 'scale lean sink spin seed')
    local low, high = options.scale, options.scale
    if type(options.scale) == 'table' then low, high = options.scale[1], options.scale[2] end
    low = check.above(where, 'scale', low, 0, 1)
    high = check.number(where, 'scale', high, low, nil, low)
    local lean = check.number(where, 'lean', options.lean, 0, 1, 1)
    local sink = check.number(where, 'sink', options.sink, nil, nil, 0)
    local spin = check.flag(where, 'spin', options.spin, true)
    local dice, all = random.new(check.whole(where, 'seed', options.seed, nil, nil, 1)), gr.node 'scattered'
    for _, place in ipairs(places) do
        local p, n = place.position or place, place.normal or { 0, 1, 0 }
        if #p == 2 then p = { p[1], 0, p[2] } end
        local x, y, z = n[1] * lean, n[2] * lean + (1 - lean), n[3] * lean
        local size, turn = dice:range(low, high), dice:range(0, 360)
        local node = nodes[1 + dice:bits() * #nodes // 4294967296]
        local length = sqrt(x * x + y * y + z * z)
        -- one transform per node, so that the script's transform order does not matter
        local function over(transform, ...)
            local holder = gr.node 'place'
            holder[transform](holder, ...)
            holder:add_child(node)
            node = holder
        end
        if size ~= 1 then over('scale', size, size, size) end
        if sink ~= 0 then over('translate', 0, -sink, 0) end
        if spin then over('rotate', 'y', turn) end
        if length > 0 and y < length then
            over('rotate', 'z', -math.deg(math.acos(max(-1, min(1, y / length)))))
            over('rotate', 'y', math.deg(math.atan(-z, x)))
        end
        over('translate', p[1], p[2], p[3])
        all:add_child(node)
    end
    return all
end

return M
