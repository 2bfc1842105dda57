-- The sky of bench/denoise/mesh_sky.lua as a map of all directions, for programs without its formula.
gr.render {
    node = gr.node('nothing'), file = 'sky.hdr', width = 1024, height = 512, projection = 'panorama',
    eye = { 0, 0, 0 }, target = { 0, 0, -1 }, integrator = 'path', spp = 16,
    background = gr.clear_sky { hour = 16, day = 200, latitude = 48 },
}
