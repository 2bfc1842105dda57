-- picture: a small canvas for scripts that make textures. Colours are tables of three numbers 0..1, kept as floats until
-- the picture is written; coordinates are pixels, x to the right, y down, pixel centres at halves.

local png = require 'png'
local font = require 'font'

local M = {}
local Picture = {}
Picture.__index = Picture

--- A new picture of one colour.
---@param width integer
---@param height integer
---@param colour number[]?  default black
---@return table picture
function M.new(width, height, colour)
    local self = setmetatable({ width = width, height = height, data = {} }, Picture)
    local c = colour or { 0, 0, 0 }
    for i = 1, 3 * width * height do self.data[i] = c[(i - 1) % 3 + 1] end
    return self
end

--- Mixes a colour into one pixel.
---@param x integer  0 .. width-1
---@param y integer
---@param colour number[]
---@param cover number?  0..1, default 1
function Picture:mix(x, y, colour, cover)
    if x < 0 or y < 0 or x >= self.width or y >= self.height then return end
    local i, c = 3 * (y * self.width + x), cover or 1
    local d = self.data
    d[i + 1] = d[i + 1] + (colour[1] - d[i + 1]) * c
    d[i + 2] = d[i + 2] + (colour[2] - d[i + 2]) * c
    d[i + 3] = d[i + 3] + (colour[3] - d[i + 3]) * c
end

--- Colour of one pixel.
function Picture:get(x, y)
    local i = 3 * (y * self.width + x)
    return { self.data[i + 1], self.data[i + 2], self.data[i + 3] }
end

--- Paints a rectangle pixel by pixel.
---@param paint fun(x: number, y: number, old: number[]): number[]?, number?  colour and cover; coordinates of the centre
function Picture:paint(paint, x0, y0, x1, y1)
    for y = math.max(0, math.floor(y0 or 0)), math.min(self.height, math.ceil(y1 or self.height)) - 1 do
        for x = math.max(0, math.floor(x0 or 0)), math.min(self.width, math.ceil(x1 or self.width)) - 1 do
            local colour, cover = paint(x + 0.5, y + 0.5, self:get(x, y))
            if colour then self:mix(x, y, colour, cover) end
        end
    end
end

--- Fills the shape where a signed distance is negative, with a soft edge of one pixel.
---@param distance fun(x: number, y: number): number  in pixels
---@param colour number[]
function Picture:shape(distance, colour, x0, y0, x1, y1)
    self:paint(function(x, y)
        local cover = 0.5 - distance(x, y)
        if cover > 0 then return colour, math.min(1, cover) end
    end, x0, y0, x1, y1)
end

--- A filled disc.
function Picture:disc(cx, cy, radius, colour)
    self:shape(function(x, y) return math.sqrt((x - cx) ^ 2 + (y - cy) ^ 2) - radius end, colour,
        cx - radius - 1, cy - radius - 1, cx + radius + 1, cy + radius + 1)
end

--- A filled rectangle.
function Picture:box(x0, y0, x1, y1, colour)
    self:shape(function(x, y) return math.max(x0 - x, x - x1, y0 - y, y - y1) end, colour, x0 - 1, y0 - 1, x1 + 1, y1 + 1)
end

--- A line through points with round ends.
---@param points number[][]
---@param thickness number
---@param colour number[]
function Picture:line(points, thickness, colour)
    local half = thickness / 2
    local x0, y0, x1, y1 = math.huge, math.huge, -math.huge, -math.huge
    for _, p in ipairs(points) do
        x0, y0, x1, y1 = math.min(x0, p[1]), math.min(y0, p[2]), math.max(x1, p[1]), math.max(y1, p[2])
    end
    self:shape(function(x, y)
        local best = math.huge
        for i = 1, math.max(1, #points - 1) do
            local a, b = points[i], points[i + 1] or points[i]
            local dx, dy = b[1] - a[1], b[2] - a[2]
            local squared = dx * dx + dy * dy
            local t = squared > 0 and ((x - a[1]) * dx + (y - a[2]) * dy) / squared or 0
            t = t < 0 and 0 or t > 1 and 1 or t
            local ex, ey = x - a[1] - t * dx, y - a[2] - t * dy
            local d = ex * ex + ey * ey
            if d < best then best = d end
        end
        return math.sqrt(best) - half
    end, colour, x0 - half - 1, y0 - half - 1, x1 + half + 1, y1 + half + 1)
end

--- Text centred at x, y (by its width and the height of capitals).
---@param text string
---@param x number
---@param y number
---@param height number  of a capital
---@param colour number[]
---@param thickness number?  default height / 8
function Picture:text(text, x, y, height, colour, thickness)
    local strokes, width = font.strokes(text)
    local k = height / 6
    for _, stroke in ipairs(strokes) do
        local points = {}
        for i, p in ipairs(stroke) do points[i] = { x + (p[1] - width / 2) * k, y + (3 - p[2]) * k } end
        self:line(points, thickness or height / 8, colour)
    end
end

--- The picture as bytes.
---@param step integer?  keep only every step-th level (1: all 256), for smaller files
---@return integer[]
function Picture:bytes(step)
    local out, d = {}, self.data
    step = step or 1
    for i = 1, #d do
        local v = d[i]
        v = v < 0 and 0 or v > 1 and 1 or v
        v = math.floor(255 * v + 0.5)
        if step > 1 then v = math.min(255, (v + step // 2) // step * step) end
        out[i] = v
    end
    return out
end

--- Writes the picture as an 8-bit RGB or palette PNG.
---@param file string
---@param step integer?
function Picture:write(file, step)
    png.write(file, self.width, self.height, self:bytes(step))
end

return M
