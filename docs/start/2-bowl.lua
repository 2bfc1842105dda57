local clay = gr.material{kd = {0.25, 0.45, 0.6}, ks = {0.3, 0.3, 0.3}, shininess = 40}

local ball = gr.sphere{centre = {0, 2, 0}, radius = 2, material = clay}
local foot = gr.cylinder{from = {0, 0, 0}, to = {0, 0.3, 0}, radius = 0.8, material = clay}
local hollow = gr.sphere{centre = {0, 2, 0}, radius = 1.85, material = clay}
local above = gr.box{min = {-3, 1.3, -3}, max = {3, 5, 3}, material = clay}
local bowl = gr.difference{gr.union{ball, foot}, hollow, above}

gr.render{node = bowl, width = 640, height = 400}
