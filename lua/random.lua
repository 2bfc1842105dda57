-- random: numbers from a seed, the same on every machine and independent of math.random.
-- Source: the generator PCG XSH RR 64/32 (M. O'Neill, "PCG: A Family of Simple Fast Space-Efficient Statistically Good
-- Algorithms for Random Number Generation", Harvey Mudd College HMC-CS-2014-0905).
-- Invariant: two generators with the same seed and stream give the same sequence; nothing else affects it.
--
--   local random = require 'random'
--   local dice = random.new(7)
--   local height = dice:range(1.5, 2)            -- a number between
--   local face = dice:whole(1, 6)                -- a whole number, both ends included
--   local colour = dice:pick(palette)            -- an entry of a list

local check = require 'check'

local M = {}

---@class random.generator
local Generator = {}
Generator.__index = Generator

local MULTIPLIER <const> = 6364136223846793005

--- A generator.
---@param seed integer?  default 1
---@param stream integer?  another sequence for each, default 0
---@return random.generator
function M.new(seed, stream)
    seed = check.whole('random.new', 'seed', seed, nil, nil, 1)
    stream = check.whole('random.new', 'stream', stream, nil, nil, 0)
    local self = setmetatable({ state = 0, step = stream << 1 | 1 }, Generator)
    self:bits()
    self.state = self.state + seed
    self:bits()
    return self
end

--- 32 random bits as a whole number.
---@return integer
function Generator:bits()
    local old = self.state
    self.state = old * MULTIPLIER + self.step
    local word, turn = ((old >> 18) ~ old) >> 27 & 0xffffffff, old >> 59
    return (word >> turn | word << (32 - turn)) & 0xffffffff
end

--- A number in [0, 1).
---@return number
function Generator:number() return self:bits() / 4294967296 end

--- A number in [low, high).
---@param low number
---@param high number
---@return number
function Generator:range(low, high) return low + (high - low) * (self:bits() / 4294967296) end

--- A whole number from low to high, both included.
---@param low integer
---@param high integer
---@return integer
function Generator:whole(low, high)
    check.whole('random:whole', 'low', low)
    check.whole('random:whole', 'high', high, low, low + 4294967295)
    return math.tointeger(low) + self:bits() * (math.tointeger(high) - math.tointeger(low) + 1) // 4294967296
end

--- true with a probability.
---@param probability number
---@return boolean
function Generator:chance(probability) return self:bits() < probability * 4294967296 end

--- An entry of a list.
function Generator:pick(list)
    check.list('random:pick', 'list', list, 1)
    return list[1 + self:bits() * #list // 4294967296]
end

--- A copy of a list in random order (Fisher and Yates).
function Generator:shuffle(list)
    check.list('random:shuffle', 'list', list, 0)
    local out = table.move(list, 1, #list, 1, {})
    for i = #out, 2, -1 do
        local j = 1 + self:bits() * i // 4294967296
        out[i], out[j] = out[j], out[i]
    end
    return out
end

--- A number of the normal distribution (Box and Muller 1958).
---@param mean number?  default 0
---@param deviation number?  default 1
---@return number
function Generator:normal(mean, deviation)
    local radius = math.sqrt(-2 * math.log(1 - self:number()))
    return (mean or 0) + (deviation or 1) * radius * math.cos(2 * math.pi * self:number())
end

--- A direction, uniform on the unit sphere.
---@return number[]
function Generator:direction()
    local z = self:range(-1, 1)
    local angle, r = self:range(0, 2 * math.pi), math.sqrt(1 - z * z)
    return { r * math.cos(angle), r * math.sin(angle), z }
end

return M
