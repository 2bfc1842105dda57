-- Functions shared by the scripts of this folder. A claim is a sentence and a function that raises an error if it is
-- false.

local M = {}

--- Runs a claim; an error is reported with its sentence.
function M.claim(sentence, f)
    local ok, message = xpcall(f, function(e) return debug.traceback(tostring(e), 2) end)
    if not ok then error(('not true: %s: %s'):format(sentence, message), 0) end
end

--- |value - wanted| <= tolerance; NaN is not.
function M.near(value, wanted, tolerance, what)
    if not (math.abs(value - wanted) <= tolerance) then
        error(('%s: %.17g, not %.17g (within %g)'):format(what or 'value', value, wanted, tolerance), 2)
    end
end

--- The function fails with a message that contains a text, at the line of the caller, not at a line of the library.
function M.fails(text, f, ...)
    local ok, message = pcall(f, ...)
    if ok then error('no error; expected: ' .. text, 2) end
    if not tostring(message):find(text, 1, true) then error(('the error is "%s", not "%s"'):format(tostring(message), text), 2) end
end

--- Passes a tree to the program, which builds it (--check) or renders it in a small size.
function M.build(node)
    gr.render { node = node, file = 'claim.png', width = 4, height = 3, eye = { 0, 0, 50 }, lights = {} }
end

return M
