-- Names in camelCase: gr.nhSphere, node:addChild, node:setMaterial. Every function of gr gets such a name beside its own,
-- and `rt` is another name of gr. docs/dialects.md describes dialects.
local function camel(name)
    return (name:gsub('_(%a)', string.upper))
end

local functions = {}
for name, f in pairs(gr) do
    functions[camel(name)] = f
end
for name, f in pairs(functions) do
    gr[name] = f
end
rt = gr

local methods, node = {}, gr.node('any')
for _, name in ipairs{'add_child', 'set_material', 'set_texture', 'set_bump', 'rotate_axis', 'rotate_quat', 'moves_to'} do
    methods[camel(name)] = node[name]
end
return {methods = methods}
