-- expect: SCRIPT:2: gr.medium: temperature must have 8 numbers, one for each of the cells, not 3
gr.medium{absorption = {1, 1, 1}, corner = {0, 0, 0}, size = 1, cells = {2, 2, 2}, temperature = {1, 2, 3}}
