-- expect: SCRIPT:2: node:rotate_quat: the quaternion must not be 0 (node 'ball')
gr.sphere('ball'):rotate_quat(0, 0, 0, 0)
