-- The scene of a model on the command line. It has the camera and the lights of the file; else a camera that fits, the
-- light of the studio, and a ground whose unshadowed parts have the colour of the background. Everything is a multiple
-- of the model's size, so that a scaled or moved model has the same picture.
local format, gmatch, match, find, concat, tonumber = string.format, string.gmatch, string.match, string.find, table.concat, tonumber
local sqrt, log, max, min = math.sqrt, math.log, math.max, math.min
local SAMPLES, POSES = 24, 8

local function size_of(low, high)
    local sum = 0.0
    for k = 1, 3 do sum = sum + ((high[k] - low[k]) / 2) ^ 2 end
    return sqrt(sum)
end

local function is_inside(point, low, high)
    for k = 1, 3 do
        if point[k] <= low[k] or point[k] >= high[k] then return false end
    end
    return true
end

local function name_cameras(cameras)
    local words = {}
    for k, camera in ipairs(cameras) do words[k] = format("%d '%s'", k, camera.name) end
    return #words == 0 and 'it has no cameras' or 'it has ' .. concat(words, ', ')
end

-- The camera of --camera, else the first; nil: the file has none.
local function camera_of(path, cameras, wanted)
    if not wanted then return cameras[1] end
    return cameras[wanted] or cameras[tonumber(wanted)] or
        fail(format("--camera: %s has no camera '%s': %s", path, wanted, name_cameras(cameras)), 'usage')
end

-- A level plane a little below the model.
local function ground_below(gr, floor, view)
    local kd = ground(view and view[1], view and view[2], view and view[3])
    return gr.plane{normal = {0, 1, 0}, distance = floor, material = gr.material{kd = {kd, kd, kd}}}
end

-- The model at this time, and the group of its poses from the first frame to the last.
local function animated(gr, file, seconds)
    local poses = {}
    for k = 0, POSES do poses[k + 1] = gr.model{file = file, time = seconds * k / POSES} end
    return gr.model{file = file, time = gr.time}, gr.node{children = poses}
end

return function(gr, path, file, options)
    local model = gr.model{file = file}
    local all = model
    if options.moves and is_animated(model) then model, all = animated(gr, file, options.seconds) end
    local found, low, high = pcall(all.bounds, all)
    if not found then
        local reason = match(low, 'bounds: (.+) %(node')
        fail(path .. ': ' .. (reason and not find(reason, '^no shape') and reason or 'no face of this file has an area'))
    end
    local radius = size_of(low, high)
    local camera = camera_of(path, model.cameras, options.camera)
    local scene = {node = model}
    if all ~= model then fit_to(all) end -- a camera without a place of its own stands still
    for name, value in next, camera or {} do
        if name ~= 'name' then scene[name] = value end
    end

    local inside = camera and is_inside(camera.eye, low, high)
    if options.sky then
        scene.lights, scene.exposure = model.lights, 'auto'
    elseif #model.lights > 0 then
        -- A little light from all around shows what the lights leave in the dark.
        local light = light_in_middle(model, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2, (low[3] + high[3]) / 2, radius)
        local around = light / 10
        scene.lights, scene.background = model.lights, {around, around, around}
        scene.exposure = not inside and light > 0 and max(-100, min(log(1 / light, 2), 100)) or 'auto'
    elseif inside then
        -- The light of the studio does not reach into a room: a lamp at the camera.
        scene.lights = {gr.light{position = camera.eye, colour = {1, 1, 1}, intensity = radius * radius}}
        scene.exposure = 'auto'
    elseif not camera or camera.eye[2] > low[2] then
        fit_to(all) -- the ground is no part of the model
        scene.node = gr.node{children = {model, ground_below(gr, low[2] - radius / 1024, camera and camera.view)}}
    end
    if chosen 'exposure' then scene.exposure = nil end

    if not chosen 'integrator' and not chosen 'style' then
        scene.integrator = 'path'
        if not chosen 'denoise' then scene.denoise = true end
        if not chosen 'spp' and not chosen 'noise' then scene.spp = SAMPLES end
    end
    if options.checks then
        for line in gmatch(contents(model), '[^\n]+') do print(path .. ': ' .. line) end
    end
    gr.render(scene)
end
