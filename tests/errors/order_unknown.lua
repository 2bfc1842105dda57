-- expect: SCRIPT:2: gr.transform_order: order must be 'new', 'old' or 'separate', not 'sideways'
gr.transform_order('sideways')
