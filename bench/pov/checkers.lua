-- Writes the checkered images of the paired scenes into this folder: lua5.4 checkers.lua
package.path = '../../lua/?.lua;' .. package.path
local png = require 'png'

local function write(name, size, even, odd)
    local bytes = {}
    for y = 1, size do
        for x = 1, size do
            for _, c in ipairs((x + y) % 2 == 0 and even or odd) do
                bytes[#bytes + 1] = math.floor(255 * c + 0.5)
            end
        end
    end
    png.write(name, size, size, bytes, 3)
end

write('checker28.png', 28, {0.72, 0.72, 0.72}, {0.12, 0.12, 0.12})
write('checker28_brown.png', 28, {0.6, 0.576, 0.52}, {0.28, 0.264, 0.24})
write('checker32.png', 32, {0.68, 0.68, 0.68}, {0.24, 0.24, 0.24})
