-- expect: SCRIPT:2: gr.spherical_light comes with version 0.2 (this is 0.1.0)
gr.spherical_light({0, 0, 0}, {1, 1, 1}, {1, 0, 0}, 1)
