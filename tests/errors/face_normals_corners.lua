-- expect: SCRIPT:2: gr.vn_mesh: face_normals[1] and faces[1] have different numbers of corners (node 'flag')
gr.vn_mesh('flag', {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 1}}, {{0, 1, 2}}, {{0, 0, 0, 0}})
