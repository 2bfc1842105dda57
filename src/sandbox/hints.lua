-- Hints for messages. When an argument is nil, or Lua calls or indexes nil, the text of the running line is read again:
-- names in it that are neither local nor global are likely errors, and the nearest name that has a value is suggested.
-- Habits from other languages are a table of the words of Lua's message and the tokens where it stopped. All of this
-- runs in a Lua state of its own (hints.c), only when a message is printed, and once for each line that creates a shape
-- without a material.
local sub, find, match, format = string.sub, string.find, string.match, string.format
local TEXT, FILE, NAME = 4096, 1 << 20, 64

local function set(text)
    local out = {}
    for word in string.gmatch(text, '%S+') do out[word] = true end
    return out
end

-- Tokens: {name =, string =, number = or symbol = TEXT, line =, at =}; begins: it stands at the start of its line.

local none = {}
local function tokens_of(text, is_statement)
    return setmetatable(tokens(text or '', is_statement), {__index = function() return none end})
end

local function following(t, i)
    local token = rawget(t, i + 1)
    if token then return i + 1, token end
end
local function each(t) return following, t, 0 end

local function text_of(token) return token.name or token.string or token.number or token.symbol or '' end

local keywords = set[[and break do else elseif end false for function goto if in local nil not or repeat return then
    true until while]]
local function is_name(token) return token.name and #token.name < NAME and not keywords[token.name] end
local function is_dot(token) return token.symbol == '.' or token.symbol == ':' end

-- The running function with the tokens from its line on, or nil.
local function run_now()
    local path, line, is_whole = running()
    if not path then return nil end
    local text = read(path, line, TEXT)
    return text and {path = path, line = line, is_whole = is_whole, tokens = tokens_of(text, true)}
end

local function visible(run)
    run.variables = run.variables or variables()
    return run.variables
end

local begins, ends = set'function if do repeat', set'end until'

-- Visits the tokens of the running line, and of the following lines while a bracket is open, until `visit` has a
-- result. Functions on the line are skipped, because they do not run: their names have other values. If the running
-- function begins on this line, nothing is skipped.
local function visit_line(run, visit)
    local t, depth, inside = run.tokens, 0, 0
    for i, token in each(t) do
        if not run.is_whole and (inside > 0 or token.name == 'function') then
            inside = inside + (begins[token.name] and 1 or ends[token.name] and -1 or 0)
        else
            local found = visit(t, i)
            if found then return found end
        end
        if token.symbol == '(' or token.symbol == '{' then depth = depth + 1 end
        if token.symbol == ')' or token.symbol == '}' then depth = depth - 1 end
        if depth <= 0 and t[i + 1].line ~= 1 then return nil end
    end
end

-- Whether the line declares the name: a parameter, a local variable, a variable of a loop. If the running function
-- begins on the line, this may find names of other functions of the line.
local function is_declared(run, name)
    local parameters, names
    return run.is_whole and visit_line(run, function(t, i)
        local word, symbol = t[i].name, t[i].symbol
        if word == 'function' or word == 'local' or word == 'for' then
            parameters = word == 'function'
            names = not parameters
            return false
        end
        parameters = parameters and symbol ~= ')'
        names = names and (symbol == ',' or word and word ~= 'in')
        return (parameters or names) and word == name
    end)
end

local function sorted(map)
    local out = {}
    for name, value in next, map do
        if value then out[#out + 1] = name end
    end
    table.sort(out)
    return out
end

local function nil_words(run, name)
    local meant = nearest(name, sorted(visible(run)))
    return "; '" .. name .. "' is nil" .. (meant and ", did you mean '" .. meant .. "'?" or '')
end

local function is_nil(run, token) return is_name(token) and visible(run)[token.name] == nil end

local hints = {}

-- "; 'redd' is nil, did you mean 'red'?": the first single name in the running call that is an undefined global, no
-- field, and not left of an assignment.
function hints.nil_value()
    local run = run_now()
    return run and visit_line(run, function(t, i)
        local is_assigned = t[i + 1].symbol == '=' and t[i + 2].symbol ~= '='
        local found = not is_dot(t[i - 1]) and not is_assigned and is_nil(run, t[i])
        return found and not is_declared(run, t[i].name) and nil_words(run, t[i].name)
    end)
end

-- FIELD = VARIABLE and FIELD = {VARIABLE, ...}, where the variable is nil and a name of its own: not `VARIABLE . name`,
-- VARIABLE(...) or `VARIABLE + 1`. `rest` is the field of entries without names. Returns words, field, entry.
function hints.nil_field(rest, caller, names)
    local run, field, entry, depth, field_of_words = run_now(), nil, 0, 0, nil
    local wanted = {}
    for _, name in ipairs(names) do wanted[name] = true end
    local function whole(t, i)
        local after = t[i + 1].symbol
        return (after == ',' or after == '}' or after == ';') and is_nil(run, t[i]) and nil_words(run, t[i].name)
    end
    local words = run and visit_line(run, function(t, i)
        local before, symbol = t[i - 1], t[i].symbol
        if field then -- in the list of a field, after its brace
            if symbol == '{' or symbol == '(' or symbol == '[' then depth = depth + 1 end
            if symbol == '}' or symbol == ')' or symbol == ']' then depth = depth - 1 end
            if depth == 1 and symbol == ',' then entry = entry + 1 end
            field_of_words = field
            if depth <= 0 then field = nil end
            return depth == 1 and (before.symbol == '{' or before.symbol == ',') and whole(t, i)
        end
        if rest and before.name == caller and symbol == '{' then field, depth, entry = rest, 1, 1 end
        if symbol ~= '=' or not wanted[before.name] then return nil end
        field_of_words, entry = before.name, 0
        local found = whole(t, i + 1)
        if not found and t[i + 1].symbol == '{' then field, depth, entry = before.name, 0, 1 end
        return found
    end)
    return words, field_of_words, entry
end

-- Whether the running call has a colon before the name of this method.
function hints.has_colon(method)
    local run = run_now()
    return run and visit_line(run, function(t, i) return t[i - 1].symbol == ':' and t[i].name == method end) and ''
end

-- Errors of Lua.

local function sandbox_words(library, field)
    return '; the sandbox has no ' .. library .. '.' .. field .. ' (docs/security.md)'
end

-- "; there is no meshes.load, meshes has convert, smooth ...": for tables with functions, as modules are.
local function module_words(names, library, field)
    local shown, used = {}, 0
    for i = 1, #names do
        if i > 16 or used > 440 then break end
        shown[i], used = sub(names[i], 1, 40), used + #names[i] + 2
    end
    local list = table.concat(shown, ', ') .. (#names > 16 and ' ...' or '')
    return #names > 0 and format('; there is no %s.%s; %s has %s', library, field, library, list)
end

-- Of TABLE.FIELD, where TABLE is a variable and the field is nil.
local function field_words(run, field)
    local name = visit_line(run, function(t, i)
        local found = not is_dot(t[i - 1]) and t[i + 1].symbol == '.' and t[i + 2].name == field and is_name(t[i])
        return found and t[i].name
    end)
    local names, is_global = nil, nil
    if name then names, is_global = keys(name) end
    if not names then return nil end
    if is_global and lacks(name, field) then return sandbox_words(name, field) end
    table.sort(names)
    local meant = nearest(field, names)
    return meant and format("; did you mean '%s.%s'?", name, meant) or module_words(names, name, field)
end

-- What the last `NAME = ...` of the file up to the running line says.
local function setting_words(run, name, visit)
    local words
    local t = tokens_of(read(run.path, 1, FILE))
    for i, token in each(t) do
        if token.line > run.line then break end
        if token.name == name and t[i + 1].symbol == '=' then words = visit(t, i + 2) or words end
    end
    return words
end

-- = LIBRARY.FIELD, which the sandbox does not have: `local execute = os.execute`; or = io.open(...), which returned nil
-- and a reason that the script did not read.
local function nil_setting(t, i)
    local library, field, reason = t[i].name, t[i + 2].name, refused()
    if not library or not field or t[i + 1].symbol ~= '.' then return nil end
    if t[i + 3].symbol ~= '(' and lacks(library, field) then return sandbox_words(library, field) end
    return library == 'io' and field == 'open' and reason and '; io.open returned nil, because ' .. reason
end

-- = require 'MODULE', or require('MODULE').
local function require_setting(t, i)
    local module = (t[i + 1].symbol == '(' and t[i + 2] or t[i + 1]).string
    return t[i].name == 'require' and module and #module <= NAME and
        "; the module '" .. module .. "' returns nothing: its last line must return its table"
end

-- "; another program has 'size': --dialect processing": the dialects of the library that set this global.
local function dialect_words(name)
    local found = {}
    for _, path in ipairs(dialects()) do
        local t, sets = tokens_of(read(path, 1, FILE)), false
        for i, token in each(t) do
            sets = sets or token.begins and
                (token.name == 'function' and t[i + 1].name == name and t[i + 2].symbol == '(' or
                token.name == name and t[i + 1].symbol == '=')
        end
        if sets then found[#found + 1] = match(path, '([^/.]*)[^/]*$') end
    end
    return #found > 0 and format("another program has '%s': --dialect %s", name, table.concat(found, ' or '))
end

-- Of a global that is nil: gr has it, a dialect has it, or there is a similar name.
local function global_words(run, name)
    local others, of_gr = dialect_words(name), false
    for _, key in ipairs(keys('gr') or {}) do of_gr = of_gr or key == name end
    if of_gr then return "; did you mean 'gr." .. name .. "'?" .. (others and ' (' .. others .. ')' or '') end
    if others then return '; ' .. others end
    local meant = nearest(name, sorted(visible(run)))
    return meant and "; did you mean '" .. meant .. "'?"
end

-- The name in "... a TYPE value (KIND 'NAME')"; one that a hint follows has had its own.
local function culprit(message, kind, of)
    local name, rest = match(message, ' a ' .. kind .. ' value %(' .. of .. " '([^'\n]+)(.?.?.?)")
    return name and #name < NAME and rest ~= "');" and name or nil
end

local syntax_words

function hints.lua_error(message)
    local field, global = culprit(message, 'nil', 'field'), culprit(message, 'nil', 'global')
    local variable = culprit(message, 'nil', 'local') or culprit(message, 'nil', 'upvalue')
    local module = culprit(message, 'boolean', 'local') or culprit(message, 'boolean', 'upvalue') or
        culprit(message, 'boolean', 'global')
    if not (field or global or variable or module) then return syntax_words(message) end
    local run = run_now()
    return run and (field and field_words(run, field) or not field and
        (global and global_words(run, global) or not global and
        (variable and setting_words(run, variable, nil_setting) or not variable and
        setting_words(run, module, require_setting))))
end

-- Errors of syntax.

-- The words of the message, the token before the one where Lua stopped, that one, the next, and the hint: the first row
-- that fits. A neighbour is one of some words, or *name, *value (the end of one) or *token; '': anything. "@" in a hint
-- is the token before.
local habits = {
    {"'then' expected", '', '=', '', '== compares, = sets a variable'},
    {"'do' expected", '', '=', '', '== compares, = sets a variable'},
    {"'then' expected", '', '{', '', "'then' follows a condition, and 'end' ends its block: no braces"},
    {"'do' expected", '', '{', '', "'do' begins a block and 'end' ends it: no braces"},
    {'', ')', '{', '', "the body of a function has no braces: 'end' ends it"},
    {'', '', '=', '=', '= gives a value, == compares two'},
    {'', '*name', '+ - * / % ^', '=', 'Lua has no such assignment: write @ = @ + ... in full, without +='},
    {'', '*name', '+', '+', 'Lua has no ++: write @ = @ + 1'},
    {'', '', '/', '/ *', 'a comment begins with --'},
    {'', '', '#', '', 'a comment begins with --'},
    {'', '', '!', '=', "'not equal' is ~="},
    {'', '', '!', '', "'!' is not"},
    {'', '', '&', '&', "'&&' is and"},
    {'', '', '|', '|', "'||' is or"},
    {'', '', '?', '', 'Lua has no ?: write condition and a or b'},
    {'', 'var let const int float double auto def', '', '', 'a variable is made by local, as in local n = 3'},
    {'', 'elif elsif', '', '', "'@' is elseif"},
    {'', '', 'elif elsif', '', 'the word is elseif'},
    {'', 'new', '', '', "objects are made by calls, without 'new'"},
    {"')' expected", '*name', '=', '', 'named fields need braces, as in gr.sphere{@ = ...}'},
    {"'}' expected", '', ':', '', 'a field is given by =, as in {@ = ...}, and blocks have no braces'},
    {"'}' expected", '*value', '', '', "a comma is missing after '@'"},
    {"')' expected", '*value', '*token', '', "a comma is missing after '@', or a bracket"},
    {'', ',', ',', '', 'there is one comma too many'},
}

local function fits(token, words)
    local is_word = token.name or token.string or token.number
    if words == '' then return true end
    if words == '*name' then return token.name end
    if words == '*value' then return is_word or match(token.symbol or '', '[]})]') end
    if words == '*token' then return is_word or token.symbol == '{' end
    return not token.string and set(words)[text_of(token)]
end

-- "“" and its like: a character that no program of Lua has outside of texts and comments.
local function strange_character(text, at)
    local character = match(text, '^.[\x80-\xbf]?[\x80-\xbf]?[\x80-\xbf]?', at)
    local first = string.byte(character)
    local whole = first < 0xC2 and 0 or first < 0xE0 and 2 or first < 0xF0 and 3 or first < 0xF5 and 4 or 0
    if set'‘ ’ “ ” „ « »'[character] then
        return '; ' .. character .. " is a curly quotation mark: use the straight ones, \" or '"
    elseif character == '\xC2\xA0' then
        return '; there is a blank that does not break lines: use an ordinary one'
    end
    return #character ~= whole and '; the text is not in UTF-8' or
        '; the character ' .. character .. ' may stand in texts and comments only'
end

local function habit_words(message, before, token, after)
    local given = sub(text_of(before), 1, 40)
    for _, habit in ipairs(habits) do
        if find(message, habit[1], 1, true) and fits(before, habit[2]) and fits(token, habit[3]) and
            fits(after, habit[4]) then
            return not find(given, '\n', 1, true) and '; ' .. string.gsub(habit[5], '@', function() return given end)
        end
    end
end

-- Whether this is the token that the message ends with: "near '='", "near '<\226>'" or "near '"text'".
local function is_near(near, token)
    local code, text = match(near, '^<\\(%d+)'), text_of(token)
    if #text == 0 then return false end
    if code then return string.byte(text) == tonumber(code) end
    if token.string then return sub(near, 2, 1 + math.min(2, #text)) == sub(text, 1, 2) end
    return sub(near, 1, #text) == text
end

function syntax_words(message)
    local path = source_of(message)
    if not path or not find(message, ' near ', 1, true) and not find(message, ' expected', 1, true) then return nil end
    local line, near = tonumber(match(message, '^:(%d+)', #path + 1)), match(message, " near '(.*)")
    local text = read(path, 1, FILE)
    local t = tokens_of(text)
    if find(message, " near <eof>", 1, true) then
        -- An "else if" opens a block of its own, whose `end` is easily forgotten.
        for i, token in each(t) do
            if token.name == 'else' and t[i + 1].name == 'if' and t[i + 1].line == token.line then
                return find(message, "'end' expected", 1, true) and "; 'else if' needs an end of its own: write elseif"
            end
        end
        return nil
    end
    for i, token in each(near and t or {}) do
        local twice = token.symbol == '=' and t[i - 1].symbol == '='
        if token.line == line and not twice and is_near(near, token) then
            if token.symbol and string.byte(token.symbol) >= 0x80 then return strange_character(text, token.at) end
            return habit_words(message, t[i - 1], token, t[i + 1])
        end
    end
end

-- Files that are given as scripts by mistake. The first bytes decide before the ending does.

local picture = 'is a picture, not a scene; -o FILE names the picture to write, and gr.texture(\'FILE\') reads one'
local model = 'is a model, and its name has no ending of models (.glb .gltf .obj .ply .stl); gr.model(\'FILE\') of a script reads it'
local other_model = 'is a model, not a scene; gr.mesh of a script reads OBJ, PLY, STL and glTF files'
local other_scene = 'is a file of another program; gray reads scenes that are Lua scripts (docs/language.md)'
local endings = {
    [set'png jpg jpeg gif hdr exr webp bmp tif tiff tga ppm pfm svg apng mp4 webm y4m mkv mov avi'] = picture,
    [set'gz'] = model,
    [set'fbx 3ds dae off step stp iges 3mf usd usda usdz abc x3d wrl'] = other_model,
    [set'blend pov inc scad pbrt pde py js json xml ma mb max c4d skp html htm md txt pdf doc csv sh zip'] = other_scene,
}
local starts = {
    ['\x89PNG'] = picture, ['\xff\xd8\xff'] = picture, ['GIF8'] = picture, ['#?RADIANCE'] = picture, ['RIFF'] = picture,
    ['glTF'] = model, ['ply\n'] = model, ['solid '] = model, ['Kaydara FBX'] = other_model, ['BLENDER'] = other_scene,
    ['<'] = other_scene, ['PK\x03\x04'] = other_scene,
}

local function ending_words(path)
    local ending = string.lower(match(path, '%.([^./ ]+)$') or '')
    for list, words in next, endings do
        if list[ending] then return words end
    end
end

-- What a file is that Lua cannot compile, and what to do with it; nil: it may be a script with an error.
function hints.other_file(path, text)
    for start, words in next, starts do
        if sub(text, 1, #start) == start then return words end
    end
    return ending_words(path)
end

local commands = {help = 'gray --help lists the options', man = 'gray --man is the manual',
    version = 'gray --version prints the version'}
commands.usage, commands.manual = commands.help, commands.man

-- The name of a file without its folder and its ending.
local function stem_of(path)
    local name = match(path, '[^/]*$')
    return match(name, '^(.*)%.') or name
end

-- Of a scene that is not there: the file `there`, the most similar name among files, or what to type instead of a
-- command.
function hints.missing_scene(path, there, files)
    local name, stems, path_of = match(path, '[^/]*$'), {}, {}
    local words = commands[string.lower(name)] or
        ending_words(name) == picture and '-o FILE names the picture to write, as in gray -o FILE scene.lua'
    for _, file in ipairs(not words and files or {}) do
        local stem = stem_of(file)
        if match(file, '.%.lua$') and not path_of[stem] then stems[#stems + 1], path_of[stem] = stem, file end
    end
    local meant = there or path_of[nearest(stem_of(path), stems) or 0]
    return meant and "; did you mean '" .. meant .. "'?" or words and '; ' .. words
end

function hints.unknown_dialect(name)
    local names = {}
    for _, path in ipairs(dialects()) do names[#names + 1] = match(path, '([^/]*)%.lua$') end
    local meant = nearest(name, names)
    return (meant and "; did you mean '" .. meant .. "'?" or '') .. '; the library has ' ..
        (#names > 0 and table.concat(names, ', ') or 'none')
end

return hints
