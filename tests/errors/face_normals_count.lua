-- expect: SCRIPT:2: gr.vn_mesh: face_normals has 0 entries, but faces has 1 (node 'flag')
gr.vn_mesh('flag', {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 1}}, {{0, 1, 2}}, {})
