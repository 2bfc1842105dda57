-- expect: SCRIPT:2: gr.vn_mesh: face_normals[1][3] is 1, but normals ends with number 0, counted from 0 (node 'flag')
gr.vn_mesh('flag', {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 1}}, {{0, 1, 2}}, {{0, 0, 1}})
