-- expect: SCRIPT:2: gr.mesh: lib/broken.obj:4: 'x' is not a corner of a face (7, 7/1, 7//3 or 7/1/3) (node 'cow')
gr.mesh('cow', 'lib/broken.obj')
