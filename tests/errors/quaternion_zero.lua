-- expect: SCRIPT:2: node:rotate_quat: the quaternion is 0: it says no turn (node 'ball')
gr.sphere('ball'):rotate_quat(0, 0, 0, 0)
