-- png: writes PNG files in pure Lua, with real compression.
-- Deflate (RFC 1951): matches are found with chains of equal three-byte strings and one step of lazy evaluation; every
-- block gets its own Huffman codes, their lengths limited to 15 by the package-merge method (Larmore, Hirschberg 1990).
-- PNG (RFC 2083): each row takes the filter whose bytes have the smallest sum of magnitudes.
-- Invariant: the same pixels give the same bytes.

local M = {}

local byte, char, pack, concat = string.byte, string.char, string.pack, table.concat

local crc_table = {}
for n = 0, 255 do
    local c = n
    for _ = 1, 8 do c = c & 1 == 1 and 0xEDB88320 ~ (c >> 1) or c >> 1 end
    crc_table[n] = c
end

--- CRC-32 of a string.
---@param data string
---@return integer
function M.crc32(data)
    local c = 0xFFFFFFFF
    for i = 1, #data do c = crc_table[(c ~ byte(data, i)) & 0xFF] ~ (c >> 8) end
    return c ~ 0xFFFFFFFF
end

--- Adler-32 of a string.
---@param data string
---@return integer
function M.adler32(data)
    local a, b = 1, 0
    for i = 1, #data do
        a = (a + byte(data, i)) % 65521
        b = (b + a) % 65521
    end
    return b << 16 | a
end

-- Bits are packed from the low end; Huffman codes are stored with reversed bits.
local function new_writer()
    return { bits = 0, count = 0, out = {} }
end

local function put(w, value, n)
    w.bits = w.bits | value << w.count
    w.count = w.count + n
    while w.count >= 8 do
        w.out[#w.out + 1] = char(w.bits & 0xFF)
        w.bits = w.bits >> 8
        w.count = w.count - 8
    end
end

--- Code lengths of at most `limit` bits for the symbols that occur.
local function code_lengths(counts, symbols, limit)
    local leaves = {}
    for s = 0, symbols - 1 do
        if (counts[s] or 0) > 0 then leaves[#leaves + 1] = { weight = counts[s], symbol = s } end
    end
    local lengths = {}
    for s = 0, symbols - 1 do lengths[s] = 0 end
    if #leaves == 0 then return lengths end
    if #leaves == 1 then
        lengths[leaves[1].symbol] = 1
        return lengths
    end
    table.sort(leaves, function(a, b)
        if a.weight ~= b.weight then return a.weight < b.weight end
        return a.symbol < b.symbol
    end)
    local list = leaves
    for _ = 2, limit do
        local pairs_of, merged, i, j = {}, {}, 1, 1
        for k = 1, #list - 1, 2 do
            pairs_of[#pairs_of + 1] = { weight = list[k].weight + list[k + 1].weight, list[k], list[k + 1] }
        end
        while i <= #leaves or j <= #pairs_of do
            local a, b = leaves[i], pairs_of[j]
            if a and (not b or a.weight <= b.weight) then
                merged[#merged + 1], i = a, i + 1
            else
                merged[#merged + 1], j = b, j + 1
            end
        end
        list = merged
    end
    local function visit(item)
        if item.symbol then
            lengths[item.symbol] = lengths[item.symbol] + 1
        else
            visit(item[1])
            visit(item[2])
        end
    end
    for k = 1, 2 * #leaves - 2 do visit(list[k]) end
    return lengths
end

--- Canonical codes for code lengths, with reversed bits.
local function codes_of(lengths, symbols)
    local per_length, next_code, codes = {}, {}, {}
    for s = 0, symbols - 1 do per_length[lengths[s]] = (per_length[lengths[s]] or 0) + 1 end
    local code = 0
    per_length[0] = 0
    for bits = 1, 15 do
        code = (code + (per_length[bits - 1] or 0)) << 1
        next_code[bits] = code
    end
    for s = 0, symbols - 1 do
        local n = lengths[s]
        if n > 0 then
            local value, turned = next_code[n], 0
            next_code[n] = value + 1
            for _ = 1, n do
                turned = turned << 1 | value & 1
                value = value >> 1
            end
            codes[s] = turned
        end
    end
    return codes
end

local length_code, length_base, length_extra = {}, {}, {}
do
    local base = 3
    for k = 0, 27 do
        local extra = k < 4 and 0 or (k >> 2) - 1
        length_base[k], length_extra[k] = base, extra
        for n = base, math.min(257, base + (1 << extra) - 1) do length_code[n] = k end
        base = base + (1 << extra)
    end
    length_base[28], length_extra[28], length_code[258] = 258, 0, 28
end

local distance_base, distance_extra = {}, {}
do
    local base = 1
    for k = 0, 29 do
        local extra = k < 2 and 0 or (k >> 1) - 1
        distance_base[k], distance_extra[k] = base, extra
        base = base + (1 << extra)
    end
end

local function distance_code(d)
    local low, high = 0, 29
    while low < high do
        local middle = (low + high + 1) >> 1
        if distance_base[middle] <= d then low = middle else high = middle - 1 end
    end
    return low
end

--- Literals and matches of the data: numbers 0..255, or -(length << 16 | distance).
local function find_matches(data, effort)
    local n, tokens = #data, {}
    local head, previous = {}, {}
    local function key(i)
        local a, b, c = byte(data, i, i + 2)
        return a | b << 8 | c << 16
    end
    local function insert(i)
        if i + 2 > n then return end
        local k = key(i)
        previous[i], head[k] = head[k], i
    end
    local function search(i, at_least)
        if i + 2 > n then return 0, 0 end
        local best, best_distance = at_least, 0
        local candidate, left, most = head[key(i)], effort, math.min(258, n - i + 1)
        while candidate and i - candidate <= 32768 and left > 0 and best < most do
            if byte(data, candidate + best) == byte(data, i + best) then
                local size = 3
                while size < most and byte(data, candidate + size) == byte(data, i + size) do size = size + 1 end
                if size > best then best, best_distance = size, i - candidate end
            end
            candidate, left = previous[candidate], left - 1
        end
        if best_distance == 0 then return 0, 0 end
        return best, best_distance
    end
    local i = 1
    local size, distance = 0, 0
    local fresh = true
    while i <= n do
        if fresh then size, distance = search(i, 2) end
        fresh = true
        if size < 3 then
            tokens[#tokens + 1] = byte(data, i)
            insert(i)
            i = i + 1
        else
            insert(i)
            local later, later_distance = 0, 0
            if size < 64 then later, later_distance = search(i + 1, size) end
            if later > size then
                tokens[#tokens + 1] = byte(data, i)
                i = i + 1
                size, distance, fresh = later, later_distance, false
            else
                tokens[#tokens + 1] = -(size << 16 | distance)
                for k = i + 1, i + size - 1 do insert(k) end
                i = i + size
            end
        end
    end
    return tokens
end

local header_order = { 16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15 }

local function write_block(w, tokens, first, last, final)
    local literals, distances = { [256] = 1 }, {}
    for k = first, last do
        local token = tokens[k]
        if token >= 0 then
            literals[token] = (literals[token] or 0) + 1
        else
            local s, d = 257 + length_code[-token >> 16], distance_code(-token & 0xFFFF)
            literals[s], distances[d] = (literals[s] or 0) + 1, (distances[d] or 0) + 1
        end
    end
    if not next(distances) then distances[0] = 1 end
    local literal_lengths, distance_lengths = code_lengths(literals, 286, 15), code_lengths(distances, 30, 15)
    local literal_count, distance_count = 286, 30
    while literal_lengths[literal_count - 1] == 0 do literal_count = literal_count - 1 end
    while distance_count > 1 and distance_lengths[distance_count - 1] == 0 do distance_count = distance_count - 1 end

    -- the code lengths themselves, with runs: 16 repeats, 17 and 18 are zeros
    local all, runs, counts = {}, {}, {}
    for s = 0, literal_count - 1 do all[#all + 1] = literal_lengths[s] end
    for s = 0, distance_count - 1 do all[#all + 1] = distance_lengths[s] end
    local function add(symbol, extra, bits)
        runs[#runs + 1] = { symbol, extra, bits }
        counts[symbol] = (counts[symbol] or 0) + 1
    end
    local i = 1
    while i <= #all do
        local value, run = all[i], 1
        while all[i + run] == value do run = run + 1 end
        i = i + run
        if value == 0 then
            while run >= 11 do
                local part = math.min(run, 138)
                add(18, part - 11, 7)
                run = run - part
            end
            if run >= 3 then
                add(17, run - 3, 3)
                run = 0
            end
        else
            add(value, 0, 0)
            run = run - 1
            while run >= 3 do
                local part = math.min(run, 6)
                add(16, part - 3, 2)
                run = run - part
            end
        end
        for _ = 1, run do add(value, 0, 0) end
    end
    local header_lengths = code_lengths(counts, 19, 7)
    local header_codes = codes_of(header_lengths, 19)
    local header_count = 19
    while header_count > 4 and header_lengths[header_order[header_count]] == 0 do header_count = header_count - 1 end

    put(w, final and 1 or 0, 1)
    put(w, 2, 2)
    put(w, literal_count - 257, 5)
    put(w, distance_count - 1, 5)
    put(w, header_count - 4, 4)
    for k = 1, header_count do put(w, header_lengths[header_order[k]], 3) end
    for _, run in ipairs(runs) do
        put(w, header_codes[run[1]], header_lengths[run[1]])
        if run[3] > 0 then put(w, run[2], run[3]) end
    end
    local literal_codes, distance_codes = codes_of(literal_lengths, 286), codes_of(distance_lengths, 30)
    for k = first, last do
        local token = tokens[k]
        if token >= 0 then
            put(w, literal_codes[token], literal_lengths[token])
        else
            local size, distance = -token >> 16, -token & 0xFFFF
            local l, d = length_code[size], distance_code(distance)
            put(w, literal_codes[257 + l], literal_lengths[257 + l])
            if length_extra[l] > 0 then put(w, size - length_base[l], length_extra[l]) end
            put(w, distance_codes[d], distance_lengths[d])
            if distance_extra[d] > 0 then put(w, distance - distance_base[d], distance_extra[d]) end
        end
    end
    put(w, literal_codes[256], literal_lengths[256])
end

--- Compresses a string into a zlib stream (RFC 1950).
---@param data string
---@param effort integer?  how many earlier places are tried for each match, default 24
---@return string
function M.deflate(data, effort)
    local tokens, w = find_matches(data, effort or 24), new_writer()
    put(w, 0x78, 8)
    put(w, 0xDA, 8)
    local block = 16384
    local first = 1
    repeat
        local last = math.min(#tokens, first + block - 1)
        write_block(w, tokens, first, last, last == #tokens)
        first = last + 1
    until first > #tokens
    if w.count > 0 then put(w, 0, 8 - w.count) end
    return concat(w.out) .. pack('>I4', M.adler32(data))
end

local function chunk(kind, data)
    return pack('>I4', #data) .. kind .. data .. pack('>I4', M.crc32(kind .. data))
end

local function paeth(a, b, c)
    local p = a + b - c
    local pa, pb, pc = math.abs(p - a), math.abs(p - b), math.abs(p - c)
    if pa <= pb and pa <= pc then return a end
    return pb <= pc and b or c
end

local function filter_row(row, above, step)
    local best, best_sum
    local n = #row
    for kind = 0, 4 do
        local out, sum = {}, 0
        for i = 1, n do
            local a, b, c = row[i - step] or 0, above and above[i] or 0, above and above[i - step] or 0
            local guess = kind == 0 and 0 or kind == 1 and a or kind == 2 and b or kind == 3 and (a + b) // 2
                or paeth(a, b, c)
            local value = (row[i] - guess) & 0xFF
            out[i] = value
            sum = sum + (value < 128 and value or 256 - value)
        end
        if not best_sum or sum < best_sum then
            best_sum, best = sum, { kind, out }
        end
    end
    local parts = { char(best[1]) }
    for i = 1, n, 4096 do parts[#parts + 1] = char(table.unpack(best[2], i, math.min(n, i + 4095))) end
    return concat(parts)
end

--- A PNG file as a string.
---@param width integer
---@param height integer
---@param pixels integer[]  bytes, row by row from the top, `channels` to a pixel
---@param channels 1|2|3|4?  gray, gray and alpha, RGB (default), RGBA
---@return string
function M.encode(width, height, pixels, channels)
    channels = channels or 3
    if #pixels ~= width * height * channels then
        error(('png: %d bytes do not make %d x %d pixels of %d channels'):format(#pixels, width, height, channels), 2)
    end
    local colour_type = ({ 0, 4, 2, 6 })[channels]
    local rows, above, stride = {}, nil, width * channels
    -- few colours: a palette is smaller than any filter result
    if channels == 3 then
        local known, list, indices = {}, {}, {}
        for i = 1, #pixels, 3 do
            local key = pixels[i] << 16 | pixels[i + 1] << 8 | pixels[i + 2]
            local index = known[key]
            if not index then
                if #list == 256 then
                    list = nil
                    break
                end
                list[#list + 1] = char(pixels[i], pixels[i + 1], pixels[i + 2])
                index = #list - 1
                known[key] = index
            end
            indices[#indices + 1] = index
        end
        if list then
            for y = 0, height - 1 do
                local row = {}
                for x = 1, width do row[x] = char(indices[y * width + x]) end
                rows[#rows + 1] = '\0' .. concat(row)
            end
            return '\137PNG\r\n\26\n' .. chunk('IHDR', pack('>I4I4BBBBB', width, height, 8, 3, 0, 0, 0))
                .. chunk('PLTE', concat(list)) .. chunk('IDAT', M.deflate(concat(rows))) .. chunk('IEND', '')
        end
    end
    for y = 0, height - 1 do
        local row = table.move(pixels, y * stride + 1, (y + 1) * stride, 1, {})
        rows[#rows + 1] = filter_row(row, above, channels)
        above = row
    end
    return '\137PNG\r\n\26\n' .. chunk('IHDR', pack('>I4I4BBBBB', width, height, 8, colour_type, 0, 0, 0))
        .. chunk('IDAT', M.deflate(concat(rows))) .. chunk('IEND', '')
end

--- Writes a PNG file.
---@param file string
---@param width integer
---@param height integer
---@param pixels integer[]
---@param channels integer?
function M.write(file, width, height, pixels, channels)
    local handle, why = io.open(file, 'wb')
    if not handle then error('png: ' .. why, 2) end
    handle:write(M.encode(width, height, pixels, channels))
    handle:close()
end

return M
