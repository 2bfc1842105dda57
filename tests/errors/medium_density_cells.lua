-- expect: SCRIPT:2: gr.medium: density must have 8 numbers, one for each of the cells, not 3
gr.medium{scattering = {1, 1, 1}, corner = {0, 0, 0}, size = 1, cells = {2, 2, 2}, density = {1, 2, 3}}
