-- words: short words for light and materials: gr.studio, gr.daylight, gr.mirror, gr.glass, gr.metal, gr.plastic, gr.paint,
-- gr.cloth. gray has checked the arguments by its table of functions, and calls these functions with them in a table.
-- Sources: R. Kasten and A. Young, "Revised optical air mass tables", Applied Optics 28(22), 1989; the transmittances of
-- air and haze and the brightness of the sun of A. Preetham, P. Shirley and B. Smits, "A Practical Analytic Model for
-- Daylight", SIGGRAPH 1999, here at one wavelength each for red, green and blue.
-- Invariant: everything in a studio is a multiple of the size of the node, so that a scaled scene has the same picture.

local check = require 'check'

local M = {}

local sin, cos, rad, max = math.sin, math.cos, math.rad, math.max

--- The fields of gr.render that the user gave, without those of the word itself.
local function further(fields, own)
    local out = {}
    for name, value in pairs(fields) do out[name] = value end
    for name in own:gmatch '%S+' do out[name] = nil end
    return out
end

local function or_else(value, default)
    if value == nil then return default end
    return value
end

--- The middle, half of the height and the radius of a node; nil if it is endless or empty.
local function extent(node)
    local found, low, high = pcall(node.bounds, node)
    if not found then return nil end
    local middle, half = {}, {}
    for k = 1, 3 do
        middle[k], half[k] = (low[k] + high[k]) / 2, (high[k] - low[k]) / 2
        if not (half[k] >= 0 and half[k] < 1e29) then return nil end
    end
    local radius = math.sqrt(half[1] ^ 2 + half[2] ^ 2 + half[3] ^ 2)
    if radius > 0 then return middle, half[2], radius end
end

--- A floor through the origin and a wall behind it, where the view goes to; both are endless, so that they do not change
--- the camera. `bend`: the radius between them.
local function sweep(material, behind, bend)
    local floor = gr.plane { normal = { 0, 1, 0 }, material = material }
    local wall = gr.plane { normal = { 0, 0, 1 }, distance = -behind, material = material }
    local corner = gr.intersection(gr.plane { normal = { 0, 1, 0 }, distance = bend, material = material },
        gr.plane { normal = { 0, 0, 1 }, distance = bend - behind, material = material })
    local round = gr.quadric { yy = 1, zz = 1, y = -2 * bend, z = 2 * (behind - bend), constant = (behind - bend) ^ 2, material = material }
    return gr.union { floor, wall, gr.difference(corner, round) }
end

--- integrator: that of the command line, or nil.
function M.studio(fields, _, integrator)
    local out = further(fields, 'node sweep floor intensity key fill rim turn')
    local middle, height, radius = extent(fields.node)
    local is_endless = not middle
    if is_endless then middle, height, radius = { 0, 0, 0 }, 1, 2 end

    -- The camera looks along `view`; its direction on the floor is the front of the studio.
    local view = fields.view or { -0.4, -0.35, -1 }
    local target, eye = fields.target, fields.eye
    if eye and not fields.view then
        local at = target or middle
        view = { at[1] - eye[1], at[2] - eye[2], at[3] - eye[3] }
    end
    local x, z = view[1] or view.x, view[3] or view.z
    local around = (x == 0 and z == 0) and 0 or math.deg(math.atan(-x, -z))

    local root = gr.node { name = 'studio', children = { fields.node } }
    if or_else(fields.sweep, true) and not is_endless then
        local sheet = gr.openpbr_material { base_color = fields.floor or { 0.6, 0.6, 0.6 }, specular_weight = 0, classic = true }
        root:add_child(sweep(sheet, 4 * radius, 2.5 * radius):rotate('y', around):translate(middle[1], middle[2] - height, middle[3]))
    end
    out.node, out.model = root, fields.model or fields.node

    -- A soft box: a square towards the middle, from `azimuth` to the right of the camera, whose light on a white surface
    -- that faces it is `light`.
    local turn = around + (fields.turn or 0)
    local intensity = fields.intensity or 1
    local function box(azimuth, elevation, distance, side, light, samples)
        local a, e = rad(turn + azimuth), rad(elevation)
        local to = { sin(a) * cos(e), sin(e), cos(a) * cos(e) }
        local right, up = { cos(a), 0, -sin(a) }, { -sin(a) * sin(e), cos(e), -cos(a) * sin(e) }
        local corner, v1, v2 = {}, {}, {}
        for k = 1, 3 do
            v1[k], v2[k] = right[k] * side * radius, up[k] * side * radius
            corner[k] = middle[k] + to[k] * distance * radius - (v1[k] + v2[k]) / 2
        end
        local radiance = light * intensity * math.pi * (distance / side) ^ 2
        return gr.area_light { corner = corner, v1 = v2, v2 = v1, samples = samples, emission = { radiance, radiance, radiance }, visible = true, one_sided = true }
    end
    out.lights = fields.lights or {
        box(-48, 42, 5, 3.2, 0.75 * (fields.key or 1)),
        box(62, 20, 6, 3.2, 0.2 * (fields.fill or 1)),
        box(155, 58, 6, 2.4, 0.45 * (fields.rim or 1)),
    }
    if fields.sky == nil and fields.background == nil then
        out.background = gr.sky_gradient { stops = { { -1, 0.1, 0.1, 0.1 }, { 0, 0.3, 0.3, 0.3 }, { 1, 0.16, 0.16, 0.16 } }, intensity = intensity }
        -- Under Whitted the light of the sky is even: few of its shadow rays would be noise in every pixel.
        if (integrator or fields.integrator) ~= 'path' and fields.ambient == nil then
            out.ambient = { 0.2 * intensity, 0.2 * intensity, 0.2 * intensity }
        elseif not fields.lights then
            table.insert(out.lights, gr.sky_light { sky = out.background })
        end
    end
    return out
end

--- The colour of sunlight on the ground over that above the air, by the height of the sun. Rayleigh scattering, haze, ozone.
local function through_air(height, turbidity)
    local zenith = math.deg(math.acos(math.min(height, 1)))
    local mass = 1 / (max(height, 0) + 0.50572 * (96.07995 - zenith) ^ -1.6364)
    local beta, out = 0.04608 * turbidity - 0.04586, {}
    for k, wave in ipairs { { 0.61, 0.0123 }, { 0.55, 0.0085 }, { 0.465, 0.0010 } } do
        local rayleigh, ozone = 0.008735 * wave[1] ^ -4.08, 0.35 * wave[2] * 10
        out[k] = math.exp(-mass * (rayleigh + beta * wave[1] ^ -1.3 + ozone))
    end
    return out
end

-- Cities with latitude, longitude and time zone, without summer time.
local places = {
    berlin = { 52.52, 13.40, 1 }, cairo = { 30.04, 31.24, 2 }, cape_town = { -33.92, 18.42, 2 }, delhi = { 28.61, 77.21, 5.5 },
    london = { 51.51, -0.13, 0 }, los_angeles = { 34.05, -118.24, -8 }, moscow = { 55.76, 37.62, 3 }, nairobi = { -1.29, 36.82, 3 },
    new_york = { 40.71, -74.01, -5 }, oslo = { 59.91, 10.75, 1 }, paris = { 48.86, 2.35, 1 }, rome = { 41.90, 12.50, 1 },
    sao_paulo = { -23.55, -46.63, -3 }, singapore = { 1.35, 103.82, 8 }, sydney = { -33.87, 151.21, 10 }, tokyo = { 35.68, 139.69, 9 },
}

--- The direction to the sun at a place and a time; sun_direction computes it of the day of the year.
local function sun_at(fields, sun_direction)
    local where, place, time = 'gr.daylight', fields.place, fields.time or { 2025, 6, 21, 15, 0 }
    if type(place) == 'string' then
        local names = {}
        for name in pairs(places) do names[#names + 1] = name end
        table.sort(names)
        if not places[place] then
            check.fail(where, ("place '%s' is not known; there are %s, and {latitude, longitude}"):format(place:sub(1, 40), table.concat(names, ', ')))
        end
        place = places[place]
    end
    local latitude, longitude = check.number(where, 'place[1]', place[1], -90, 90), check.number(where, 'place[2]', place[2], -180, 180)
    if type(time) ~= 'table' or #time < 3 or #time > 5 then check.fail(where, 'time must be {year, month, day, hour, minute}') end
    local year, month = check.whole(where, 'time[1], the year,', time[1], 1901, 2099), check.whole(where, 'time[2], the month,', time[2], 1, 12)
    local days = { 31, year % 4 == 0 and 29 or 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31 }
    local day = check.whole(where, 'time[3], the day,', time[3], 1, days[month])
    for k = 1, month - 1 do day = day + days[k] end
    local hour = check.number(where, 'time[4], the hour,', time[4], 0, 24, 12) + check.number(where, 'time[5], the minute,', time[5], 0, 60, 0) / 60
    return { sun_direction(year, day, hour, fields.zone or place[3] or math.floor(longitude / 15 + 0.5), latitude, longitude) }
end

local function sun_of(fields, sun_direction)
    local sun, has_time = fields.sun, fields.time ~= nil or fields.zone ~= nil
    if sun and (fields.place or has_time) then check.fail('gr.daylight', 'sun excludes place, time and zone') end
    if fields.place then return sun_at(fields, sun_direction) end
    if has_time then check.fail('gr.daylight', 'time and zone need place') end
    sun = sun or { azimuth = 140, elevation = 40 }
    local azimuth, elevation = sun.azimuth, sun.elevation
    if azimuth then
        azimuth, elevation = rad(azimuth), rad(elevation)
        return { sin(azimuth) * cos(elevation), sin(elevation), -cos(azimuth) * cos(elevation) }
    end
    local x, y, z = sun[1] or sun.x, sun[2] or sun.y, sun[3] or sun.z
    local length = math.sqrt(x * x + y * y + z * z)
    if length == 0 then check.fail('gr.daylight', 'sun must not be zero') end
    return { x / length, y / length, z / length }
end

function M.daylight(fields, sun_direction)
    local sun = sun_of(fields, sun_direction)
    -- Radiance as in gr.clear_sky: luminance in kcd/m^2 over 20. The disc of the sun is 0.533 degrees wide.
    local SUN <const>, HALF <const>, FAR <const> = 1.6e6 / 20, rad(0.533 / 2), 1e8
    local out = further(fields, 'sun place time zone turbidity ground intensity')
    local intensity = fields.intensity or 1
    local sky = gr.clear_sky { sun = sun, turbidity = fields.turbidity, ground = fields.ground, intensity = intensity }
    local lights = {}
    if sun[2] > 0 then
        local colour = through_air(sun[2], fields.turbidity or 2.5)
        for k = 1, 3 do colour[k] = colour[k] * SUN * intensity end
        lights[1] = gr.spherical_light {
            position = { sun[1] * FAR, sun[2] * FAR, sun[3] * FAR }, radius = FAR * sin(HALF), emission = colour, visible = true }
    end
    out.lights = fields.lights or lights
    if fields.sky == nil and fields.background == nil then out.sky = sky end
    local ending = type(fields.file) == 'string' and fields.file:match '%.(%a+)$'
    if ending ~= 'exr' and ending ~= 'hdr' and ending ~= 'pfm' then out.exposure = or_else(fields.exposure, 'auto') end
    return out
end

function M.mirror(fields)
    return gr.openpbr_material { base_color = fields.colour or { 0.95, 0.95, 0.95 }, base_metalness = 1, specular_roughness = fields.roughness or 0, classic = true }
end

function M.glass(fields)
    local colour = fields.colour
    if fields.glass and fields.ior then check.fail('gr.glass', 'glass has an index of its own: ior is not needed') end
    if type(colour) == 'string' or colour and colour.encoding then colour = gr.linear(colour) end
    return gr.openpbr_material {
        transmission_weight = 1, transmission_color = colour, transmission_depth = colour and not fields.thin and (fields.depth or 1) or nil,
        specular_ior = fields.ior or not fields.glass and 1.5 or nil, glass = fields.glass, specular_roughness = fields.roughness or 0, geometry_thin_walled = fields.thin, classic = true }
end

function M.metal(fields)
    local roughness = fields.roughness or 0.15
    if fields.colour then
        return gr.openpbr_material {
            base_color = fields.colour, base_metalness = 1, specular_roughness = roughness, specular_roughness_anisotropy = fields.brushed,
            classic = true }
    end
    return gr.metal_material { metal = fields.metal or 'aluminium', roughness = roughness, anisotropy = fields.brushed, classic = true }
end

function M.plastic(fields)
    return gr.openpbr_material { base_color = fields.colour, specular_roughness = fields.roughness or 0.15, classic = true }
end

function M.paint(fields)
    local colour, finish = fields.colour, fields.finish or 'satin'
    if finish == 'car' then
        return gr.openpbr_material {
            base_color = colour, base_metalness = 0.5, specular_roughness = 0.45, coat_weight = 1, coat_roughness = 0.02, classic = true }
    end
    local roughness = { matt = 0.8, satin = 0.35, gloss = 0.06 }
    return gr.openpbr_material {
        base_color = colour, base_diffuse_roughness = finish == 'matt' and 0.6 or 0, specular_roughness = roughness[finish], classic = true }
end

function M.cloth(fields)
    local colour, weave = fields.colour, fields.weave or 'cotton'
    if weave == 'silk' then
        return gr.openpbr_material {
            base_color = colour, specular_color = colour, specular_ior = 1.9, specular_roughness = 0.38, specular_roughness_anisotropy = 0.6,
            fuzz_weight = 0.3, fuzz_color = colour, fuzz_roughness = 0.3, classic = true }
    end
    local velvet = weave == 'velvet'
    return gr.openpbr_material {
        base_color = colour, base_weight = velvet and 0.5 or 1, base_diffuse_roughness = 1, specular_weight = 0,
        fuzz_weight = velvet and 1 or 0.5, fuzz_color = colour, fuzz_roughness = velvet and 0.35 or 0.7, classic = true }
end

return M
