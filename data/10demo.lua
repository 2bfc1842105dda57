-- TITLE: Final scene
-- A room in the evening: a marble table with a carved base, tea things, a mirror in a carved frame, a lamp of CSG, a
-- window. Author: gray project

local room = require 'room'

local place = room.place
local eye = { .50, 1.34, 3.45 }
local root, lights = room.build { eye = eye }

gr.render_skybox {
    node = root, file = '10demo.png', sky = '../textures/sky_dusk.png', width = 1280, height = 960,
    eye = place(eye), view = place { -.10, -.085, -1 }, fov = 39,
    ambient = room.ambient, lights = lights,
    -- the carving and the rug have many edges that do not matter in a draft
    side_tolerance = .015, corner_tolerance = .025,
}
