-- easing: functions from 0 to 1 over a time from 0 to 1, for frames of an animation and for profiles.
-- Source: R. Penner, "Programming Macromedia Flash MX", 2002, chapter 7 (the equations in their usual normal form).
-- Invariant: every function is 0 at 0 and 1 at 1; other arguments are clamped.
--
--   local easing = require 'easing'
--   ball:translate(0, 3 * (1 - easing.out_bounce(frame / 50)), 0)
--   local between = easing.mix(easing.in_out_cubic, {0, 0, 0}, {4, 1, 0}, 0.3)

local check = require 'check'

local M = {}

local pi = math.pi

-- The `in` variants; `out` and `in_out` follow by symmetry.
local begins = {
    sine = function(t) return 1 - math.cos(t * pi / 2) end,
    quad = function(t) return t * t end,
    cubic = function(t) return t * t * t end,
    quart = function(t) return t * t * t * t end,
    expo = function(t) return (2 ^ (10 * t) - 1) / 1023 end,
    circ = function(t) return 1 - math.sqrt(1 - t * t) end,
    back = function(t) return t * t * (2.70158 * t - 1.70158) end,
    elastic = function(t)
        if t <= 0 or t >= 1 then return t end
        return -2 ^ (10 * t - 10) * math.sin((t * 10 - 10.75) * 2 * pi / 3)
    end,
    bounce = function(t)
        t = 1 - t
        local r
        if t < 1 / 2.75 then r = 7.5625 * t * t
        elseif t < 2 / 2.75 then r = 7.5625 * (t - 1.5 / 2.75) ^ 2 + 0.75
        elseif t < 2.5 / 2.75 then r = 7.5625 * (t - 2.25 / 2.75) ^ 2 + 0.9375
        else r = 7.5625 * (t - 2.625 / 2.75) ^ 2 + 0.984375 end
        return 1 - r
    end,
}

local function clamped(where, t)
    check.number(where, 't', t)
    return t < 0 and 0 or t > 1 and 1 or t
end

--- Constant speed.
function M.linear(t) return clamped('easing.linear', t) end

--- Hermite's smooth step, 3 t^2 - 2 t^3.
function M.smooth(t)
    t = clamped('easing.smooth', t)
    return t * t * (3 - 2 * t)
end

--- Perlin's smoother step, with no acceleration at the ends.
function M.smoother(t)
    t = clamped('easing.smoother', t)
    return t * t * t * (t * (6 * t - 15) + 10)
end

for name, f in pairs(begins) do
    M['in_' .. name] = function(t) return f(clamped('easing.in_' .. name, t)) end
    M['out_' .. name] = function(t) return 1 - f(1 - clamped('easing.out_' .. name, t)) end
    M['in_out_' .. name] = function(t)
        t = clamped('easing.in_out_' .. name, t)
        if t < 0.5 then return f(2 * t) / 2 end
        return 1 - f(2 - 2 * t) / 2
    end
end

--- Interpolates between two numbers or tuples with a function of this module.
---@param ease fun(t: number): number
---@param from number|number[]
---@param to number|number[]
---@param t number
---@return number|number[]
function M.mix(ease, from, to, t)
    check.callable('easing.mix', 'ease', ease)
    local share = ease(t)
    if type(from) == 'number' then
        check.number('easing.mix', 'to', to)
        return from + (to - from) * share
    end
    check.list('easing.mix', 'from', from, 1)
    check.tuple('easing.mix', 'to', to, #from)
    local out = {}
    for k = 1, #from do out[k] = from[k] + (to[k] - from[k]) * share end
    return out
end

--- A value from key frames {{time, value}, ...} with increasing times; values are numbers or tuples.
---@param keys table[]
---@param time number
---@param ease fun(t: number): number|nil  default easing.smooth
---@return number|number[]
function M.keys(keys, time, ease)
    check.list('easing.keys', 'keys', keys, 1)
    check.number('easing.keys', 'time', time)
    if time <= keys[1][1] then return keys[1][2] end
    for k = 2, #keys do
        local from, to = keys[k - 1], keys[k]
        if to[1] <= from[1] then check.fail('easing.keys', ('the time of keys[%d] must be later than the one before'):format(k)) end
        if time <= to[1] then return M.mix(ease or M.smooth, from[2], to[2], (time - from[1]) / (to[1] - from[1])) end
    end
    return keys[#keys][2]
end

return M
