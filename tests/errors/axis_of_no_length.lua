-- expect: SCRIPT:2: node:rotate_axis: axis has length 0 (node 'ball')
gr.sphere('ball'):rotate_axis({0, 0, 0}, 30)
