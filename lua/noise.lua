-- noise: Perlin's improved noise of 2002 and sums of it, the same function the renderer's patterns use.
-- (K. Perlin, "Improving Noise", SIGGRAPH 2002; the permutation is that of the reference program.)
--
--   local noise = require 'noise'
--   local height = noise.sum(x, 0, z, 5)            -- five octaves

local check = require 'check'

local M = {}

local permutation = {
    151, 160, 137, 91, 90, 15, 131, 13, 201, 95, 96, 53, 194, 233, 7, 225, 140, 36, 103, 30, 69, 142, 8, 99, 37, 240,
    21, 10, 23, 190, 6, 148, 247, 120, 234, 75, 0, 26, 197, 62, 94, 252, 219, 203, 117, 35, 11, 32, 57, 177, 33, 88,
    237, 149, 56, 87, 174, 20, 125, 136, 171, 168, 68, 175, 74, 165, 71, 134, 139, 48, 27, 166, 77, 146, 158, 231, 83,
    111, 229, 122, 60, 211, 133, 230, 220, 105, 92, 41, 55, 46, 245, 40, 244, 102, 143, 54, 65, 25, 63, 161, 1, 216,
    80, 73, 209, 76, 132, 187, 208, 89, 18, 169, 200, 196, 135, 130, 116, 188, 159, 86, 164, 100, 109, 198, 173, 186,
    3, 64, 52, 217, 226, 250, 124, 123, 5, 202, 38, 147, 118, 126, 255, 82, 85, 212, 207, 206, 59, 227, 47, 16, 58, 17,
    182, 189, 28, 42, 223, 183, 170, 213, 119, 248, 152, 2, 44, 154, 163, 70, 221, 153, 101, 155, 167, 43, 172, 9, 129,
    22, 39, 253, 19, 98, 108, 110, 79, 113, 224, 232, 178, 185, 112, 104, 218, 246, 97, 228, 251, 34, 242, 193, 238,
    210, 144, 12, 191, 179, 162, 241, 81, 51, 145, 235, 249, 14, 239, 107, 49, 192, 214, 31, 181, 199, 106, 157, 184,
    84, 204, 176, 115, 121, 50, 45, 127, 4, 150, 254, 138, 236, 205, 93, 222, 114, 67, 29, 24, 72, 243, 141, 128, 195,
    78, 66, 215, 61, 156, 180,
}
local p = {}
for i = 0, 511 do p[i] = permutation[i % 256 + 1] end

local function fade(t) return t * t * t * (t * (t * 6 - 15) + 10) end

local function gradient(hash, x, y, z)
    local h = hash & 15
    local u = h < 8 and x or y
    local v = h < 4 and y or (h == 12 or h == 14) and x or z
    return (h & 1 == 0 and u or -u) + (h & 2 == 0 and v or -v)
end

--- Noise in about -1..1, zero at whole numbers.
---@param x number
---@param y number
---@param z number
---@return number
function M.noise(x, y, z)
    local fx, fy, fz = math.floor(x), math.floor(y), math.floor(z)
    local i, j, k = fx & 255, fy & 255, fz & 255
    x, y, z = x - fx, y - fy, z - fz
    local u, v, w = fade(x), fade(y), fade(z)
    local a, b = p[i] + j, p[i + 1] + j
    local aa, ab, ba, bb = p[a] + k, p[a + 1] + k, p[b] + k, p[b + 1] + k
    local function lerp(t, q, r) return q + t * (r - q) end
    return lerp(w,
        lerp(v, lerp(u, gradient(p[aa], x, y, z), gradient(p[ba], x - 1, y, z)),
            lerp(u, gradient(p[ab], x, y - 1, z), gradient(p[bb], x - 1, y - 1, z))),
        lerp(v, lerp(u, gradient(p[aa + 1], x, y, z - 1), gradient(p[ba + 1], x - 1, y, z - 1)),
            lerp(u, gradient(p[ab + 1], x, y - 1, z - 1), gradient(p[bb + 1], x - 1, y - 1, z - 1))))
end

--- Sum of octaves: noise(p) + noise(2p)/2 + ...
---@param x number
---@param y number
---@param z number
---@param octaves integer?  default 4
---@return number
function M.sum(x, y, z, octaves)
    octaves = check.whole('noise.sum', 'octaves', octaves, 1, 64, 4)
    local total, scale = 0, 1
    for _ = 1, octaves do
        total = total + M.noise(x * scale, y * scale, z * scale) / scale
        scale = scale * 2
    end
    return total
end

return M
