-- noise: Perlin's improved noise of 2002, which is gr.noise, and sums of it; for numbers and for recorded functions.
-- (K. Perlin, "Improving Noise", SIGGRAPH 2002.)
--
--   local noise = require 'noise'
--   local height = noise.sum(x, 0, z, 5)            -- five octaves

local check = require 'check'

local M = {}

--- Noise in about -1..1, zero at whole numbers.
---@param x number
---@param y number
---@param z number
---@return number
function M.noise(x, y, z) return gr.noise(x, y, z) end

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

