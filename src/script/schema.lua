-- The JSON Schema of scenes in JSON: a definition for each function that makes an object, one for each kind of argument, and
-- one for each kind of object, which is any of its functions or a reference. What a schema cannot say (a sorted interval,
-- rows of equal length) remains to the reader.
local concat, format, gmatch, gsub, upper, huge = table.concat, string.format, string.gmatch, string.gsub, string.upper, math.huge

-- Beside the table of functions, from which the words with @ are made.
local SCHEMA = [==[
{"$schema": "https://json-schema.org/draft/2020-12/schema",
"title": "A scene of gray", "type": "object", "required": ["gray", "nodes"],
"additionalProperties": false, "properties": {
 "gray": {"const":
@version
 },
 "define": {"type": "object", "additionalProperties": {"type": "object", "required": ["type"]}},
 "nodes": {"type": "array", "minItems": 1, "items": {"$ref": "#/$defs/node"}},
 "transform_order": {"enum": [
@orders
 ]},
 "defaults": {"enum": ["light", "classic"]},
 "time": {"type": "number", "minimum": 0},
 "picture": {"type": "object", "properties": {
@picture
 }, "additionalProperties": false}},
"$defs": {
 "ref": {"type": "object", "properties": {"ref": {"type": "string"}}, "required": ["ref"], "additionalProperties": false},
 "list": {"type": "array", "items": {"type": "number"}},
 "triple": {"anyOf": [{"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3},
  {"type": "object", "minProperties": 3, "maxProperties": 3, "additionalProperties": {"type": "number"}}]},
 "compass": {"type": "object", "required": ["azimuth", "elevation"]},
 "kind.number": {"type": "number"},
 "kind.boolean": {"type": "boolean"},
 "kind.text": {"type": ["string", "number"]},
 "kind.file": {"type": "string"},
 "kind.output": {"type": "string"},
 "kind.point": {"$ref": "#/$defs/triple"},
 "kind.direction": {"$ref": "#/$defs/triple"},
 "kind.triple": {"$ref": "#/$defs/triple"},
 "kind.colour": {"anyOf": [{"$ref": "#/$defs/triple"}, {"type": "string"}]},
 "kind.size": {"anyOf": [{"type": "number"}, {"$ref": "#/$defs/triple"}, {"type": "string"}]},
 "kind.interval": {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2},
 "kind.quaternion": {"type": "array", "items": {"type": "number"}, "minItems": 4, "maxItems": 4},
 "kind.pair": {"anyOf": [{"type": "number"}, {"$ref": "#/$defs/kind.interval"}]},
 "kind.node": {"$ref": "#/$defs/node"},
 "kind.material": {"$ref": "#/$defs/material"},
 "kind.materials": {"anyOf": [{"type": "array", "items": {"$ref": "#/$defs/material"}},
  {"type": "object", "additionalProperties": {"$ref": "#/$defs/material"}}]},
 "kind.image": {"anyOf": [{"type": "string"}, {"$ref": "#/$defs/texture"}]},
 "kind.background": {"anyOf": [{"$ref": "#/$defs/triple"}, {"type": "string"}, {"$ref": "#/$defs/sky"}, {"$ref": "#/$defs/texture"}]},
 "kind.fog": {"$ref": "#/$defs/fog"},
 "kind.medium": {"$ref": "#/$defs/medium"},
 "kind.caustics": {"anyOf": [{"type": "number"}, {"type": "object", "additionalProperties": false,
  "properties": {"photons": {"type": "number"}, "radius": {"type": "number"}}}]},
 "kind.nodes": {"type": "array", "items": {"$ref": "#/$defs/node"}},
 "kind.lights": {"type": "array", "items": {"$ref": "#/$defs/light"}},
 "kind.points": {"type": "array", "items": {"$ref": "#/$defs/triple"}},
 "kind.pairs": {"type": "array", "items": {"$ref": "#/$defs/kind.interval"}},
 "kind.stops": {"type": "array", "items": {"$ref": "#/$defs/kind.quaternion"}},
 "kind.faces": {"type": "array", "items": {"type": "array", "items": {"type": "number", "minimum": 0}}},
 "kind.numbers": {"anyOf": [{"type": "number"}, {"$ref": "#/$defs/list"}]},
 "kind.rows": {"type": "array", "items": {"$ref": "#/$defs/list"}},
 "kind.curves": {"type": "array", "items": {"$ref": "#/$defs/kind.pairs"}},
 "kind.function": {"$ref": "#/$defs/texture"},
 "kind.callback": false,
 "transform": {"type": "array", "items": {"type": "object", "minProperties": 1, "maxProperties": 1,
  "additionalProperties": false, "properties": {
@methods
  }}},
@results
}}
]==]

local function reference(name)
    return format('{"$ref": "#/$defs/%s"}', name)
end

local function words_of(p)
    local out = {}
    for word in gmatch(p.choices, '%S+') do
        out[#out + 1] = quote(word)
        if p.kind == 'axis' then out[#out + 1] = quote(upper(word)) end
    end
    return concat(out, ', ')
end

local function number_of(p)
    local out = {format('"type": "%s"', p.kind == 'whole' and 'integer' or 'number')}
    if p.low ~= 0 or p.high ~= 0 then
        out[2] = format('"%s": %.17g', p.low_open and 'exclusiveMinimum' or 'minimum', p.low)
        out[3] = p.high < huge and format('"%s": %.17g', p.high_open and 'exclusiveMaximum' or 'maximum', p.high) or nil
    end
    return '{' .. concat(out, ', ') .. '}'
end

-- What else a parameter accepts, by its flags.
local OTHERS = {{'or_texture', 'texture'}, {'or_profile', 'texture'}, {'or_function', 'texture'}, {'or_number', 'kind.number'},
    {'or_file', 'kind.file'}, {'or_compass', 'compass'}, {'or_pair', 'kind.interval'}, {'or_sky', 'sky'}}

local function parameter(p)
    local any, is_word = {}, p.kind == 'choice' or p.kind == 'axis'
    local is_number = p.kind == 'number' or p.kind == 'whole'
    if not is_word then any[1] = is_number and number_of(p) or reference('kind.' .. p.kind) end
    if (is_number or is_word) and (p.choices or '') ~= '' then any[#any + 1] = '{"enum": [' .. words_of(p) .. ']}' end
    for _, other in ipairs(OTHERS) do
        if p[other[1]] then any[#any + 1] = reference(other[2]) end
    end
    return format('%s: {"anyOf": [%s], "description": %s}', quote(p.name == 'type' and 'field_type' or p.name),
        concat(any, ', '), quote(p.help))
end

-- The fields, then what every node has, then `last`.
local function members(f, first, without)
    local out, has_children = {first}, false
    for k = f.first, #f do
        local p = f[k]
        has_children = has_children or p.name == 'children'
        if p.name ~= without then out[#out + 1] = parameter(p) end
    end
    if f.result == 'node' and not has_children then out[#out + 1] = '"children": ' .. reference 'kind.nodes' end
    if f.result == 'node' then out[#out + 1] = '"transform": ' .. reference 'transform' end
    return concat(out, ',\n   ')
end

local function definition(f)
    local required = {'"type"'}
    for k = f.first, #f do
        if not f[k].optional and not f.rest then required[#required + 1] = quote(f[k].name) end
    end
    return format(' "gr.%s": {"type": "object", "properties": {\n   %s},\n  "additionalProperties": false, "required": [%s]}',
        f.name, members(f, format('"type": {"const": %s}', quote(f.name))), concat(required, ', '))
end

-- A kind of object: a reference, or one of the functions that make it. The type chooses its definition, so a checker tries
-- no other.
local function add_result(out, result, functions)
    local names, cases, definitions = {}, {}, {}
    for _, f in ipairs(functions) do
        if f.owner == 'gr' and f.result == result then
            names[#names + 1] = quote(f.name)
            cases[#cases + 1] = format('\n  {"if": {"properties": {"type": {"const": "%s"}}}, "then": %s}', f.name,
                reference('gr.' .. f.name))
            definitions[#definitions + 1] = definition(f)
        end
    end
    out[#out + 1] = format(' "%s": {"if": {"required": ["ref"]}, "then": %s, "else": {"type": "object", "required": ["type"], ' ..
        '"properties": {"type": {"enum": [%s]}}, "allOf": [%s]}}',
        result, reference 'ref', concat(names, ',\n   '), concat(cases, ','))
    out[#out + 1] = concat(definitions, ',\n')
end

return function(functions, version)
    local results, pictures, methods, render, orders = {}, {}, {}, nil, nil
    for _, f in ipairs(functions) do
        if f.renders and f.owner == 'gr' then pictures[#pictures + 1] = quote(f.name) end
        if f.owner == 'node' and f.result == 'self' then methods[#methods + 1] = quote(f.name) .. ': true' end
        if f.owner == 'gr' and f.name == 'render' then render = f end
        if f.owner == 'gr' and f.name == 'transform_order' then orders = words_of(f[1]) end
    end
    for word in gmatch('node material light texture fog medium sky', '%a+') do add_result(results, word, functions) end
    local texts = {
        version = format('%d', version), orders = orders,
        picture = members(render, format('"type": {"enum": [%s]}', concat(pictures, ', ')), 'node'),
        methods = concat(methods, ',\n   '), results = concat(results, ',\n')
    }
    return (gsub(SCHEMA, '@(%a+)', texts))
end
