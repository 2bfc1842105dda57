-- readobj: a Wavefront OBJ file as two tables, as the classic course scripts expect it.
-- Idea: one pass over the lines; only `v` and `f` matter, the four spellings of a corner (7, 7/1, 7//3, 7/1/3) and
-- negative (relative) indices become 0-based vertex numbers. Everything else is ignored.
-- Invariant: every index in `faces` is a whole number in 0 .. #verts-1; a file that breaks this is an error with its line.
-- The module sets the global `readobj`, as scripts for Lua 5.0 expect, and returns the same function.

local io_open, fail, number = io.open, error, tonumber

--- Finds a mesh file by the rules for scenes: as given, in the script's folder, or in an Assets folder.
---@param file string
---@return file* handle
---@return string name
local function open_mesh(file)
    local tried = {}
    for template in package.path:gmatch('[^;]+') do
        local folder = template:match('^(.*/)%?%.lua$')
        if folder then
            tried[#tried + 1] = folder .. file
            tried[#tried + 1] = folder .. 'Assets/' .. file
        end
    end
    local handle, why = io_open(file, 'r')
    if handle then return handle, file end
    for _, name in ipairs(tried) do
        handle = io_open(name, 'r')
        if handle then return handle, name end
    end
    return fail('readobj: ' .. why, 3)
end

--- Reads an OBJ file.
---@param file string  name of the file
---@return number[][] verts  3-tuples
---@return integer[][] faces  tuples of 0-based indices into verts, n-gons as they stand in the file
local function read(file)
    local handle, name = open_mesh(file)
    local verts, faces = {}, {}
    local line_number, pending = 0, ''
    local function broken(what)
        handle:close()
        fail(('readobj: %s:%d: %s'):format(name, line_number, what), 4)
    end
    local function take(line)
        local key, rest = line:match('^%s*(%a+)%s+(.*)$')
        if key == 'v' then
            local x, y, z = rest:match('^(%S+)%s+(%S+)%s+(%S+)')
            x, y, z = number(x), number(y), number(z)
            if not (x and y and z) then broken('a vertex needs three numbers') end
            verts[#verts + 1] = { x, y, z }
        elseif key == 'f' then
            local face = {}
            for corner in rest:gsub('#.*$', ''):gmatch('%S+') do
                local index = number(corner:match('^(%-?%d+)'))
                if not index then broken("'" .. corner .. "' is no face corner") end
                if index < 0 then index = #verts + 1 + index end
                if index < 1 or index > #verts then broken('vertex ' .. corner .. ' does not exist') end
                face[#face + 1] = index - 1
            end
            if #face < 3 then broken('a face needs three corners') end
            faces[#faces + 1] = face
        end
    end
    for line in handle:lines() do
        line_number = line_number + 1
        line = pending .. line:gsub('\r$', '')
        pending = ''
        if line:sub(-1) == '\\' then
            pending = line:sub(1, -2) .. ' '
        else
            take(line)
        end
    end
    if pending ~= '' then take(pending) end
    handle:close()
    return verts, faces
end

_G.readobj = read
return read
