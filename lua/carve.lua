-- carve: picture frames with carved leaves, and relief for lathed objects.
-- Idea: a moulding (a curve across the frame) is swept around a rectangle with mitred corners and displaced along the
-- outward direction by ornament. All ornament is a function of the distance to the corner and of the position across
-- the moulding, so both sides of a mitre agree and the mesh closes without a seam.
-- Invariant: the frame is in the plane z = 0 around the origin, its front towards +z; normals point out of the wood.

local meshes = require 'meshes'

local M = {}

local sqrt, sin, cos, abs, pi = math.sqrt, math.sin, math.cos, math.abs, math.pi

local function smoothstep(a, b, x)
    local t = (x - a) / (b - a)
    t = t < 0 and 0 or t > 1 and 1 or t
    return t * t * (3 - 2 * t)
end

--- Height of one acanthus-like leaf along p, which extends to |q| = 1 at its widest.
---@param p number  0 at the stalk, 1 at the tip
---@param q number  across, -1..1
---@return number height  0..1
function M.leaf(p, q)
    if p <= 0 or p >= 1 then return 0 end
    q = abs(q)
    local lobes = 5.5
    local wave = p * lobes - q * 0.9
    local notch = abs(cos(pi * wave))
    local width = sin(pi * p ^ 0.62) ^ 0.8 * (0.72 + 0.28 * notch)
    local r = q / (width + 1e-9)
    if r >= 1 then return 0 end
    local body = sqrt(1 - r * r)
    local veins = 0.80 + 0.20 * notch ^ 0.7
    local rib = 1 - 0.30 * math.exp(-(q / 0.055) ^ 2) + 0.12 * math.exp(-((q - 0.12) / 0.07) ^ 2)
    local curl = 0.55 + 0.45 * sin(pi * p) + 0.25 * smoothstep(0.75, 0.97, p)
    return body * veins * rib * curl
end

--- Height of a row of beads with a period of 1.
---@param s number  along the row
---@param q number  across, -1..1
---@return number height  0..1
function M.beads(s, q)
    local x = (s % 1 - 0.5) * 2
    local r = x * x * 1.15 + q * q
    return r < 1 and sqrt(1 - r) or 0
end

--- A carved frame around an opening.
---@param width number  of the opening
---@param height number
---@param options table?  breadth of the moulding (0.2 of the smaller side), depth (0.6 of the breadth), along and across:
---  numbers of cells (along counts the whole frame), leaves: desired length of a leaf in breadths
---@return number[][] verts
---@return number[][] normals
---@return integer[][] faces
---@return integer[][] face_normals
function M.frame(width, height, options)
    options = options or {}
    local breadth = options.breadth or 0.2 * math.min(width, height)
    local depth = options.depth or 0.6 * breadth
    local along, across = options.along or 640, options.across or 44
    local leaf_length = (options.leaves or 0.95) * breadth

    -- the moulding: u = 0 at the opening, 1 at the outer edge; offset outwards and height above the wall
    local function moulding(u)
        local rim = 0.30 * math.exp(-((u - 0.90) / 0.055) ^ 2)
        local cove = 0.52 + 0.40 * smoothstep(0.16, 0.80, u) - 0.10 * sin(pi * smoothstep(0.18, 0.85, u))
        local fall = smoothstep(0, 0.03, u) * (1 - smoothstep(0.965, 1, u))
        return u, (cove + rim) * fall
    end

    local perimeter = 2 * (width + height)
    local cells = {}
    for side = 1, 4 do
        local length = side % 2 == 1 and width or height
        cells[side] = math.max(8, 2 * math.floor(along * length / perimeter / 2 + 0.5))
    end
    local total = cells[1] + cells[2] + cells[3] + cells[4]
    local back = 3
    local columns = across + 2 * back

    local function point(i, j)
        i = i % total
        local side = 1
        while i >= cells[side] do
            i = i - cells[side]
            side = side + 1
        end
        local length = side % 2 == 1 and width or height
        local other = side % 2 == 1 and height or width
        local u, relief_on = (j - back) / across, true
        local low = 1
        if u < 0 then
            u, low, relief_on = 0, (j / back), false
        elseif u > 1 then
            u, low, relief_on = 1, (columns - j) / back, false
        end
        local offset, lift = moulding(u)
        local half = length / 2 + offset * breadth
        local a = (2 * i / cells[side] - 1) * half
        local z = lift * depth
        if relief_on then
            local from_corner = half - abs(a)
            local from_middle = abs(a)
            -- main leaves follow each other from the middle of a side to its corners
            local q = (u - 0.50) / 0.27
            local reach = length / 2
            local count = math.max(1, math.floor(reach / leaf_length + 0.5))
            local p = from_middle / reach * count
            local cell = math.floor(p)
            local h = 0
            if cell < count and abs(q) < 1 then
                h = M.leaf(p - cell, q)
                -- the tip of the previous leaf is under the stalk of this one
                if cell > 0 then h = math.max(h, 0.6 * M.leaf(math.min(0.999, 0.78 + (p - cell)), q * 1.3)) end
            end
            -- a flower at the middle of each side
            local mx, my = from_middle / (0.22 * breadth), (u - 0.5) / 0.22
            local r2 = mx * mx + my * my
            if r2 < 1 then
                local petals = 0.72 + 0.28 * abs(cos(3 * math.atan(my, mx + 1e-12)))
                h = math.max(h, 1.15 * sqrt(math.max(0, 1 - r2 / petals)) + 0.3 * math.exp(-r2 * 18))
            end
            -- a large leaf at each corner, along the diagonal
            local diagonal = ((1 - u) * breadth + from_corner) / (1.75 * breadth)
            local aside = (from_corner - (1 - u) * 0.02 * breadth) / (0.62 * breadth)
            local corner = M.leaf(1.24 - diagonal * 1.28, aside * 0.8)
            h = math.max(h, 1.15 * corner * smoothstep(0.14, 0.22, u) * (1 - smoothstep(0.80, 0.88, u)))
            z = z + h * 0.42 * depth * smoothstep(0.13, 0.20, u) * (1 - smoothstep(0.80, 0.86, u))
            -- beads along the opening, a rope along the outside
            local q_beads = (u - 0.085) / 0.05
            if abs(q_beads) < 1 then
                local n = math.floor(length / 2 / (0.115 * breadth) + 0.5)
                z = z + 0.16 * depth * M.beads(from_middle / half * n + 0.5, q_beads)
            end
            local rope = math.exp(-((u - 0.90) / 0.05) ^ 2)
            z = z + 0.055 * depth * rope * cos(2 * pi * (from_corner / (0.16 * breadth) + (u - 0.9) * 5))
        else
            z = 0 - (1 - low) * 0.12 * depth
        end
        local x, y = a, -(other / 2 + offset * breadth)
        if side == 1 then return x, y, z end
        if side == 2 then return -y, x, z end
        if side == 3 then return -x, -y, z end
        return y, -x, z
    end

    local mesh = meshes.net(total, columns, function(i, j) return point(i, j) end, true, false)
    return mesh[1], mesh[2], mesh[3], mesh[4]
end

--- Relief for lathe.carved: gadroons that wind around the axis.
---@param count integer  how many
---@param turns number  how often each goes round from end to end
---@param depth number  share of the radius
---@param from number?  where on the profile they begin, 0..1
---@param to number?  where they end
---@return fun(angle: number, t: number): number
function M.gadroons(count, turns, depth, from, to)
    from, to = from or 0, to or 1
    return function(angle, t)
        local inside = smoothstep(from, from + 0.06, t) * (1 - smoothstep(to - 0.06, to, t))
        local wave = abs(cos(count / 2 * (angle + 2 * pi * turns * (t - from))))
        return 1 + depth * inside * (wave ^ 0.6 - 0.75)
    end
end

--- Relief for lathe.carved: upright acanthus leaves in a ring.
---@param count integer
---@param depth number  share of the radius
---@param from number  where on the profile the stalks stand
---@param to number  where the tips end
---@return fun(angle: number, t: number): number
function M.leaves(count, depth, from, to)
    return function(angle, t)
        local p = (t - from) / (to - from)
        local a = angle * count / (2 * pi)
        local front = M.leaf(p, (a % 1 - 0.5) * 2)
        local behind = M.leaf(p * 0.9, ((a + 0.5) % 1 - 0.5) * 2)
        return 1 + depth * math.max(front, 0.7 * behind)
    end
end

M.smoothstep = smoothstep

return M
